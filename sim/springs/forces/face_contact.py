"""Penalty contact of a cloth's faces with the sphere, so that it does not pass between particles.

A face is a triangle of the cloth as it is drawn (`sim.springs.points.cells`). It touches a sphere that is smaller by
`FACE_DEPTH` of the radius, beside the contact of points with the whole sphere. So a cloth whose cells are small beside
the sphere rests on its points, and where a sphere comes between these, edges and faces carry it. With k `FACE_PART` of
the contact's stiffness a face stores k/2 depth^2 at its place that is nearest to the sphere's centre. Its corners take
the force by their parts of that place: momentum and angular momentum stay. The nearest place of a triangle is unique
and moves continuously with its corners, so that the force is continuous and the gradient of the energy. The sphere
pushes an edge through the two faces beside it, and a particle through all of its faces. Friction acts at the points
(`sim.springs.forces.friction`).
"""

from sim.jit import kernel
from sim.springs.forces.contact import clipped_flow
from sim.springs.forces.matrices import DAMPING, FRICTION, TRANSVERSE, add_block
from sim.springs.forces.record import WIDE_NETS, Force
from sim.springs.points.arrays import push, span
from sim.springs.points.each_link import TINY
from sim.springs.points.face_places import FACE_PART, each_face, face_motion, face_slip, push_on_face
from sim.springs.points.places import dot


@kernel(inline=True)
def mobility(p, place):
    """Inverse mass [1/kg] of a place of a face."""
    m = p.inverse_masses
    return place.wa * place.wa * m[place.a] + place.wb * place.wb * m[place.b] + place.wc * place.wc * m[place.c]


@kernel(inline=True)
def is_free(p, place):
    """True if a corner of a face is not pinned."""
    m = p.inverse_masses
    return m[place.a] > 0.0 or m[place.b] > 0.0 or m[place.c] > 0.0


@each_face(noalias=True)
def accelerate(place, x, v, t, p, with_damping, f, a):
    fx, fy, fz = push_on_face(v, p, place, with_damping)
    push(p, a, place.a, place.wa * fx, place.wa * fy, place.wa * fz)
    push(p, a, place.b, place.wb * fx, place.wb * fy, place.wb * fz)
    push(p, a, place.c, place.wc * fx, place.wc * fy, place.wc * fz)


@each_face("sum")
def damp(place, x, v, t, s, p, reverse):
    """Normal damping alone for a time s [s], face by face, exact for one. Returns the work [J] of a moving sphere."""
    w, b, most = mobility(p, place), FACE_PART * p.contact_b, FACE_PART * p.contact_k * place.depth
    if b == 0.0 or not is_free(p, place):
        return 0.0
    u, q, r = face_slip(v, p, place)
    before = u * place.nx + q * place.ny + r * place.nz
    if w == 0.0:  # the place is that of a pin
        impulse = -s * min(most, b * before)
    else:
        after, _ = clipped_flow(before, 0.0, -most * w, b * w, 0.0, most / b, s)
        impulse = (after - before) / w
    ix, iy, iz = impulse * place.nx, impulse * place.ny, impulse * place.nz
    push(p, v, place.a, place.wa * ix, place.wa * iy, place.wa * iz)
    push(p, v, place.b, place.wb * ix, place.wb * iy, place.wb * iz)
    push(p, v, place.c, place.wc * ix, place.wc * iy, place.wc * iz)
    return ix * p.svx + iy * p.svy + iz * p.svz


@each_face("sum")
def energy(place, x, t, p):
    """FACE_PART k/2 depth^2 over the touching faces with a corner that is not pinned [J]."""
    return 0.5 * FACE_PART * p.contact_k * place.depth * place.depth if is_free(p, place) else 0.0


@kernel(inline=True)
def supplied(v, p, j, part, fx, fy, fz):
    """Power [W] of a force on a place through one of its corners, if that is pinned."""
    n = p.rows * p.cols
    return part * (fx * v[j] + fy * v[n + j] + fz * v[2 * n + j]) if p.inverse_masses[j] == 0.0 else 0.0


@kernel(inline=True)
def supplied_by_pins(v, p, place, fx, fy, fz):
    """Power [W] that pinned corners put in against the force (fx, fy, fz) [N] on a place."""
    return -(
        supplied(v, p, place.a, place.wa, fx, fy, fz)
        + supplied(v, p, place.b, place.wb, fx, fy, fz)
        + supplied(v, p, place.c, place.wc, fx, fy, fz)
    )


@kernel(inline=True)
def damping_force(v, p, place, fx, fy, fz):
    """The part (3,) [N] of the force (fx, fy, fz) on a place that is not elastic."""
    spring = FACE_PART * p.contact_k * place.depth
    return fx - spring * place.nx, fy - spring * place.ny, fz - spring * place.nz


@each_face("two sums")
def power(place, x, v, t, p, with_damping):
    """(dissipated, put in by a moving sphere and by moving pins) [W] through the touching faces."""
    if not is_free(p, place):
        return 0.0, 0.0
    fx, fy, fz = push_on_face(v, p, place, with_damping)
    dx, dy, dz = damping_force(v, p, place, fx, fy, fz)
    u, q, r = face_slip(v, p, place)
    by_sphere = fx * p.svx + fy * p.svy + fz * p.svz
    return -(dx * u + dy * q + dz * r), by_sphere + supplied_by_pins(v, p, place, fx, fy, fz)


@each_face("sum")
def power_of_pins(place, x, v, t, p):
    if not is_free(p, place):
        return 0.0
    fx, fy, fz = push_on_face(v, p, place, True)
    dx, dy, dz = damping_force(v, p, place, fx, fy, fz)
    return supplied_by_pins(v, p, place, dx, dy, dz)


@kernel(allocates=False)
def pins_power(x, v, t, p):
    """Power [W] that moving pins put in through the damping of the touching faces."""
    return power_of_pins(x, v, t, p) if p.pins.shape[0] > 0 else 0.0


@kernel(inline=True)
def add_corner(out, n, j, part, fx, fy, fz, turn, nx, ny, nz):
    out[j] += part * fx + turn * nx
    out[n + j] += part * fy + turn * ny
    out[2 * n + j] += part * fz + turn * nz


@kernel(inline=True)
def turns(ww, wx, xx, first, second):
    """The solution of [ww wx; wx xx] y = (first, second), of its first row alone where x is no direction."""
    if xx == 0.0:
        return first / (ww + TINY), 0.0
    over = 1.0 / (ww * xx - wx * wx + TINY)
    return over * (xx * first - wx * second), over * (ww * second - wx * first)


@each_face(noalias=True)
def tangent(place, x, u, t, p, part, longest, out):
    """Every touching face: K and D = b n n^T of its place of contact, with the change of the place in K.

    K is k n n^T of the motion w of the place, less k depth times the second derivative of the distance. With R the
    distance, e_a the sides from one corner to the others that share the place, r_a the motions of these relative to the
    first and q_a = n r_a + e_a w / R, that is (|w|^2 - (n w)^2) / R - R q^T (e_a e_b)^-1 q.
    """
    if part in (TRANSVERSE, FRICTION):
        return
    n, nx, ny, nz = p.rows * p.cols, place.nx, place.ny, place.nz
    wx, wy, wz = face_motion(u, p, place)
    along = dot(nx, ny, nz, wx, wy, wz)
    if part == DAMPING:
        pull = FACE_PART * p.contact_b * along
        fx, fy, fz = pull * nx, pull * ny, pull * nz
        add_corner(out, n, place.a, place.wa, fx, fy, fz, 0.0, nx, ny, nz)
        add_corner(out, n, place.b, place.wb, fx, fy, fz, 0.0, nx, ny, nz)
        add_corner(out, n, place.c, place.wc, fx, fy, fz, 0.0, nx, ny, nz)
        return
    # A corner of the place, and up to two others that share it: a side to one that does not is none.
    a, b, c, wa, wb, wc = place.a, place.b, place.c, place.wa, place.wb, place.wc
    if wa == 0.0:
        a, b, wa, wb = b, a, wb, wa
    if wa == 0.0:
        a, c, wa, wc = c, a, wc, wa
    if wb == 0.0:
        b, c, wb, wc = c, b, wc, wb
    k, over = FACE_PART * p.contact_k, FACE_PART * p.contact_k * place.depth
    away = p.sr - p.face_depth - place.depth
    distance = max(away, place.depth)
    bx = by = bz = cx = cy = cz = first = second = 0.0
    if wb > 0.0:
        bx, by, bz = span(x, n, a, b)
        rx, ry, rz = span(u, n, a, b)
        first = dot(nx, ny, nz, rx, ry, rz) + dot(bx, by, bz, wx, wy, wz) / distance
    if wc > 0.0:
        cx, cy, cz = span(x, n, a, c)
        rx, ry, rz = span(u, n, a, c)
        second = dot(nx, ny, nz, rx, ry, rz) + dot(cx, cy, cz, wx, wy, wz) / distance
    first, second = turns(
        dot(bx, by, bz, bx, by, bz), dot(bx, by, bz, cx, cy, cz), dot(cx, cy, cz, cx, cy, cz), first, second
    )  # fmt: skip
    across = -over / distance
    fx = k * along * nx + across * (wx - along * nx) + over * (first * bx + second * cx)
    fy = k * along * ny + across * (wy - along * ny) + over * (first * by + second * cy)
    fz = k * along * nz + across * (wz - along * nz) + over * (first * bz + second * cz)
    turn = over * distance
    add_corner(out, n, a, wa, fx, fy, fz, -turn * (first + second), nx, ny, nz)
    add_corner(out, n, b, wb, fx, fy, fz, turn * first, nx, ny, nz)
    add_corner(out, n, c, wc, fx, fy, fz, turn * second, nx, ny, nz)


@each_face()
def blocks(place, x, v, t, g, p, points):
    """g b + g^2 k of each face that the sphere pushes, by the parts of its corners.

    These sum to 1: between the corners the matrix leaves the face out, and at them it resists no less than the face.
    """
    n = p.rows * p.cols
    u, q, r = face_slip(v, p, place)
    leaving = p.contact_b * (u * place.nx + q * place.ny + r * place.nz)
    if p.contact_k * place.depth > leaving:
        size = FACE_PART * (g * p.contact_b + g * g * p.contact_k)
        add_block(points, place.a, n, place.wa * size, 0.0, place.nx, place.ny, place.nz)
        add_block(points, place.b, n, place.wb * size, 0.0, place.nx, place.ny, place.nz)
        add_block(points, place.c, n, place.wc * size, 0.0, place.nx, place.ny, place.nz)


FORCE = Force(
    "face_contact", rank=41, nets=WIDE_NETS, acts="p.faces_touch", accelerate=accelerate, damp=damp, energy=energy,
    power=power, pins_power=pins_power, tangent=tangent, blocks=blocks, stores="contact",
)  # fmt: skip
