"""The places at which two edges of a net, or a point and a face, are nearest to each other."""

import math
from typing import NamedTuple

from sim.jit import kernel
from sim.springs.points.arrays import span
from sim.springs.points.each_link import TINY
from sim.springs.points.link_pairs import closest_parts


class Four(NamedTuple):
    """The points of two edges, a b and c d, or of a point a and a face b c d."""

    is_face: bool
    a: int
    b: int
    c: int
    d: int


class NearestPlaces(NamedTuple):
    """Two places of a net that are nearest to each other, the second less the first as a sum over their four points."""

    a: int
    b: int
    c: int
    d: int
    wa: float  # factors of the sum
    wb: float
    wc: float
    wd: float
    distance: float  # [m] between the places
    nx: float  # direction from the first place to the second
    ny: float
    nz: float


@kernel(inline=True)
def point_of(four, e):
    """Point e, from 0 to 3."""
    return four.a if e == 0 else four.b if e == 1 else four.c if e == 2 else four.d


@kernel(inline=True)
def dot(ax, ay, az, bx, by, bz):
    return ax * bx + ay * by + az * bz


@kernel(inline=True)
def face_parts(pb, pc, bb, bc, cc):
    """(v, w) of the place a + v B + w C of a face that is nearest to a point a + P, from products of P, B and C.

    Ericson, Real-Time Collision Detection, section 5.1.5.
    """
    if pb <= 0.0 and pc <= 0.0:
        return 0.0, 0.0
    qb, qc = pb - bb, pc - bc  # from the end of B
    if qb >= 0.0 and qc <= qb:
        return 1.0, 0.0
    of_c = pb * qc - qb * pc
    if of_c <= 0.0 and pb >= 0.0 and qb <= 0.0:
        return pb / (bb + TINY), 0.0
    rb, rc = pb - bc, pc - cc  # from the end of C
    if rc >= 0.0 and rb <= rc:
        return 0.0, 1.0
    of_b = rb * pc - pb * rc
    if of_b <= 0.0 and pc >= 0.0 and rc <= 0.0:
        return 0.0, pc / (cc + TINY)
    of_a = qb * rc - rb * qc
    if of_a <= 0.0 and qc >= qb and rb >= rc:
        part = (qc - qb) / (qc - qb + rb - rc + TINY)
        return 1.0 - part, part
    scale = 1.0 / (of_a + of_b + of_c + TINY)
    return of_b * scale, of_c * scale


@kernel(inline=True)
def places_at(x, n, four):
    """The `NearestPlaces` of two edges, or of a point and a face, of a net of n points at x (3 n,)."""
    a, b, c, d = four.a, four.b, four.c, four.d
    if four.is_face:
        px, py, pz = span(x, n, b, a)
        ux, uy, uz = span(x, n, b, c)
        tx, ty, tz = span(x, n, b, d)
        v, w = face_parts(
            dot(px, py, pz, ux, uy, uz), dot(px, py, pz, tx, ty, tz), dot(ux, uy, uz, ux, uy, uz),
            dot(ux, uy, uz, tx, ty, tz), dot(tx, ty, tz, tx, ty, tz),
        )  # fmt: skip
        wa, wb, wc, wd = -1.0, 1.0 - v - w, v, w
        dx, dy, dz = v * ux + w * tx - px, v * uy + w * ty - py, v * uz + w * tz - pz
    else:
        tx, ty, tz = span(x, n, a, b)
        ux, uy, uz = span(x, n, c, d)
        rx, ry, rz = span(x, n, c, a)
        s, t = closest_parts(
            dot(tx, ty, tz, tx, ty, tz), dot(ux, uy, uz, ux, uy, uz), dot(tx, ty, tz, ux, uy, uz),
            dot(tx, ty, tz, rx, ry, rz), dot(ux, uy, uz, rx, ry, rz),
        )  # fmt: skip
        wa, wb, wc, wd = s - 1.0, -s, 1.0 - t, t
        dx, dy, dz = t * ux - s * tx - rx, t * uy - s * ty - ry, t * uz - s * tz - rz
    distance = math.sqrt(dx * dx + dy * dy + dz * dz)
    scale = 1.0 / distance if distance > 0.0 else 0.0
    return NearestPlaces(a, b, c, d, wa, wb, wc, wd, distance, scale * dx, scale * dy, scale * dz)


@kernel(inline=True)
def along(v, n, places, j):
    """The part of the motion v (3 n,) of point j along the line between the places."""
    return places.nx * v[j] + places.ny * v[n + j] + places.nz * v[2 * n + j]


@kernel(inline=True)
def rate_between(v, n, places):
    """The motion of the second place relative to the first along the line between them."""
    return (
        places.wa * along(v, n, places, places.a)
        + places.wb * along(v, n, places, places.b)
        + places.wc * along(v, n, places, places.c)
        + places.wd * along(v, n, places, places.d)
    )


@kernel(inline=True)
def mobility_between(p, places):
    """Inverse mass [1/kg] of the distance of two places."""
    m = p.inverse_masses
    return (
        places.wa * places.wa * m[places.a]
        + places.wb * places.wb * m[places.b]
        + places.wc * places.wc * m[places.c]
        + places.wd * places.wd * m[places.d]
    )


@kernel(inline=True)
def kick_point(out, p, j, size, places):
    n, change = p.rows * p.cols, size * p.inverse_masses[j]
    out[j] += change * places.nx
    out[n + j] += change * places.ny
    out[2 * n + j] += change * places.nz


@kernel(inline=True)
def kick_between(out, p, places, size):
    """Change of velocities by an impulse `size` [N s] that pushes two places apart."""
    kick_point(out, p, places.a, places.wa * size, places)
    kick_point(out, p, places.b, places.wb * size, places)
    kick_point(out, p, places.c, places.wc * size, places)
    kick_point(out, p, places.d, places.wd * size, places)


@kernel(allocates=False)
def closing_bound(x, last, n, four):
    """Largest change of the distance [m] in the straight motion from `last` to x: twice that of any point about the
    mean of the four."""
    mx = my = mz = most = 0.0
    for e in range(4):
        j = point_of(four, e)
        mx += 0.25 * (x[j] - last[j])
        my += 0.25 * (x[n + j] - last[n + j])
        mz += 0.25 * (x[2 * n + j] - last[2 * n + j])
    for e in range(4):
        j = point_of(four, e)
        dx, dy, dz = x[j] - last[j] - mx, x[n + j] - last[n + j] - my, x[2 * n + j] - last[2 * n + j] - mz
        most = max(most, dx * dx + dy * dy + dz * dz)
    return 2.0 * math.sqrt(most)
