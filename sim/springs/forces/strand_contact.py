"""A chain against itself: links are capsules, and push each other apart where they are nearer than the thickness.

Two links store k/2 depth^2 at their places that are nearest to each other (`sim.springs.points.link_pairs`). The force
acts along the line between these places and goes to the ends of each link by its place, (1 - s, s): momentum and
angular momentum stay. Where two links of a strand touch another at their common point, both push. The places of two
parallel links may lie anywhere along their overlap: there the force is not continuous in the angle between them.

Damping acts along the same line, and never pulls. Friction is a force of its own (`strand_friction`).
"""

import math

from sim.jit import kernel
from sim.springs.forces.contact import clipped_flow
from sim.springs.forces.link_contact import add_at, mobility
from sim.springs.forces.matrices import DAMPING, FRICTION, TRANSVERSE, add_block
from sim.springs.forces.record import Force
from sim.springs.near.near_pairs import are_neighbours, refresh_pairs
from sim.springs.points.arrays import StrandArrays, span
from sim.springs.points.link_pairs import LinkPair, opening_of, pair_at, rate_of
from sim.springs.points.order import in_turn
from sim.springs.points.places import dot

MOBILITY = 6  # column of p.rubs, after those of `LinkPair` but its points


@kernel(inline=True)
def depth_of(p, pair):
    """Depth [m] of a touching pair, 0 if it does not touch or its places coincide."""
    return max(0.0, p.thickness - pair.distance) if pair.distance > 0.0 else 0.0


@kernel(inline=True)
def pushes(p, q):
    """False of pair q if its links are neighbours, which only must not pass each other."""
    return not are_neighbours(p, p.pairs[q, 0], p.pairs[q, 1])


@kernel(inline=True)
def pair_number(x, p, q):
    return pair_at(x, p.cols, p.pairs[q, 0], p.pairs[q, 1])


@kernel(inline=True)
def pair_mobility(p, pair):
    """Inverse mass [1/kg] of the distance of two places."""
    return mobility(p, pair.a, pair.s) + mobility(p, pair.b, pair.t)


@kernel(inline=True)
def push_of(v, p, pair, depth, with_damping):
    """Force [N] that pushes two places apart."""
    damping = p.contact_b * rate_of(v, p.cols, pair) if with_damping else 0.0
    return max(0.0, p.contact_k * depth - damping)


@kernel(inline=True)
def add_opposite(out, p, pair, size, fx, fy, fz):
    """Add the change by an impulse `size` (fx, fy, fz) [N s] on the second link, and by its opposite on the first."""
    n, w = p.cols, p.inverse_masses
    add_at(out, pair.a, n, -(1.0 - pair.s) * w[pair.a] * size, fx, fy, fz)
    add_at(out, pair.a + 1, n, -pair.s * w[pair.a + 1] * size, fx, fy, fz)
    add_at(out, pair.b, n, (1.0 - pair.t) * w[pair.b] * size, fx, fy, fz)
    add_at(out, pair.b + 1, n, pair.t * w[pair.b + 1] * size, fx, fy, fz)


@kernel(inline=True)
def add_kick(out, p, pair, size):
    """Change of velocities by an impulse `size` [N s] that pushes two places apart."""
    add_opposite(out, p, pair, size, pair.nx, pair.ny, pair.nz)


@kernel(allocates=False)
def set_touching(x, p):
    """List the pairs that touch, with their places; returns their number."""
    count = 0
    for q in range(refresh_pairs(x, p)):
        if not pushes(p, q):
            continue
        pair = pair_number(x, p, q)
        if depth_of(p, pair) > 0.0:
            row = p.rubs[count]
            p.touching[count, 0], p.touching[count, 1] = pair.a, pair.b
            row[0], row[1], row[2] = pair.s, pair.t, pair.distance
            row[3], row[4], row[5] = pair.nx, pair.ny, pair.nz
            row[MOBILITY] = pair_mobility(p, pair)
            count += 1
    p.touching[p.touching.shape[0] - 1, 0] = count
    return count


@kernel(inline=True)
def touching_at_hand(x, p):
    """Number of touching pairs in the list, which `accelerate` has made at these x, if it has been called at all."""
    count = p.touching[p.touching.shape[0] - 1, 0]
    return count if count >= 0 else set_touching(x, p)


@kernel(inline=True)
def touching_pair(p, i):
    """Touching pair i, as `set_touching` has seen it."""
    r = p.rubs
    return LinkPair(p.touching[i, 0], p.touching[i, 1], r[i, 0], r[i, 1], r[i, 2], r[i, 3], r[i, 4], r[i, 5])


@kernel(allocates=False)
def accelerate(x, v, t, p, with_damping, f, a):
    for i in range(set_touching(x, p)):
        pair = touching_pair(p, i)
        add_kick(a, p, pair, push_of(v, p, pair, depth_of(p, pair), with_damping))


@kernel(allocates=False)
def damp_strands_kicked(x, v, a, mean, s, p, reverse):
    """Normal damping in a kick for a time s [s] by the accelerations a, after these have changed v: pair by pair.

    For one pair kick and damping together are exact at its depth, and so is the mean velocity, if there is room for it:
    the distance follows u' = pull - b w u from its rate before the kick, w its mobility. The accelerations are those at
    x, so that the list of pairs is, too.
    """
    n, count = p.cols, touching_at_hand(x, p)
    for turn in range(count):
        i = in_turn(turn, count, reverse)
        pair, w = touching_pair(p, i), p.rubs[i, MOBILITY]
        depth = depth_of(p, pair)
        if w == 0.0:
            continue
        kicked, most = rate_of(v, n, pair), p.contact_k * depth
        pull = rate_of(a, n, pair) if a.shape[0] > 0 else 0.0
        edge, before = most / p.contact_b if p.contact_b > 0.0 else math.inf, kicked - s * pull
        after, normal = clipped_flow(before, pull, pull - most * w, p.contact_b * w, 0.0, edge, s)
        add_kick(v, p, pair, (after - kicked) / w)
        if mean.shape[0] > 0:
            add_kick(mean, p, pair, (normal - before - 0.5 * s * pull) / w)


@kernel(allocates=False)
def damp(x, v, t, s, p, reverse):
    """Normal damping alone for a time s [s], pair by pair, exact for one."""
    damp_strands_kicked(x, v, v[:0], v[:0], s, p, reverse)
    return 0.0


@kernel(allocates=False)
def energy(x, t, p):
    """1/2 k depth^2 over the touching pairs [J]."""
    total = 0.0
    for q in range(refresh_pairs(x, p)):
        depth = depth_of(p, pair_number(x, p, q)) if pushes(p, q) else 0.0
        total += 0.5 * p.contact_k * depth * depth
    return total


@kernel(inline=True)
def pinned_velocity(v, p, a, s):
    """The part of the velocity of a place on the link from point a that pins give it."""
    n, w, ux, uy, uz = p.cols, p.inverse_masses, 0.0, 0.0, 0.0
    for e in range(2):
        j, part = a + e, s if e == 1 else 1.0 - s
        if w[j] == 0.0:
            ux, uy, uz = ux + part * v[j], uy + part * v[n + j], uz + part * v[2 * n + j]
    return ux, uy, uz


@kernel(inline=True)
def pinned_rate(v, p, a, s, pair):
    """The same along the line between the places."""
    ux, uy, uz = pinned_velocity(v, p, a, s)
    return ux * pair.nx + uy * pair.ny + uz * pair.nz


@kernel(allocates=False)
def power(x, v, t, p, with_damping):
    """(dissipated, put in by moving pins) [W] through the touching pairs."""
    dissipated = work = 0.0
    if not with_damping and p.pins.shape[0] == 0:
        return dissipated, work
    for q in range(refresh_pairs(x, p)):
        if not pushes(p, q):
            continue
        pair = pair_number(x, p, q)
        depth = depth_of(p, pair)
        if depth > 0.0:
            force = push_of(v, p, pair, depth, with_damping)
            dissipated -= (force - p.contact_k * depth) * rate_of(v, p.cols, pair)
            work += force * (pinned_rate(v, p, pair.a, pair.s, pair) - pinned_rate(v, p, pair.b, pair.t, pair))
    return dissipated, work


@kernel
def pins_power(x, v, t, p):
    """Power [W] that moving pins put in through the damping of the touching pairs."""
    if p.pins.shape[0] == 0:
        return 0.0
    return power(x, v, t, p, True)[1] - power(x, v, t, p, False)[1]


@kernel(inline=True)
def turning(tt, uu, tu, first, second, pair):
    """Motion of both places along their links, as parts of these, from the slopes of half the squared distance."""
    of_first, of_second = 0.0 < pair.s < 1.0, 0.0 < pair.t < 1.0
    square = tt * uu - tu * tu
    if of_first and of_second and square > 1e-12 * tt * uu:
        return (uu * first + tu * second) / square, (tu * first + tt * second) / square
    if of_first:
        return first / tt, 0.0
    return 0.0, second / uu if of_second else 0.0


@kernel(inline=True)
def add_force(out, n, j, fx, fy, fz):
    out[j] += fx
    out[n + j] += fy
    out[2 * n + j] += fz


@kernel(noalias=True, allocates=False)
def tangent(x, u, t, p, part, longest, out):
    """Every touching pair: K and D = b n n^T of the distance of its places, with the change of these places in K.

    With w the motion of the second place relative to the first, d n the vector between them, and T, U the links, half
    the squared distance has the second derivative |w|^2 - g M^-1 g. Here g = (d n r_a + T w, -d n r_b - U w) with r the
    motion of the second end of a link relative to its first, and M = [T T, -T U; -T U, U U], for the places that are
    no ends. K follows from k/2 (thickness - d)^2.
    """
    if part in (TRANSVERSE, FRICTION):
        return
    n = p.cols
    for q in range(refresh_pairs(x, p)):
        if not pushes(p, q):
            continue
        pair = pair_number(x, p, q)
        depth = depth_of(p, pair)
        if depth == 0.0:
            continue
        nx, ny, nz = pair.nx, pair.ny, pair.nz
        wx, wy, wz = opening_of(u, n, pair)
        along = dot(nx, ny, nz, wx, wy, wz)
        if part == DAMPING:
            size, ex, ey, ez = p.contact_b * along, 0.0, 0.0, 0.0
            first = second = 0.0
        else:
            # -k depth/d of the second derivative of half the squared distance, less its part along the line.
            d, over = pair.distance, -p.contact_k * depth / pair.distance
            tx, ty, tz = span(x, n, pair.a, pair.a + 1)
            ux, uy, uz = span(x, n, pair.b, pair.b + 1)
            ax, ay, az = span(u, n, pair.a, pair.a + 1)
            bx, by, bz = span(u, n, pair.b, pair.b + 1)
            first, second = turning(
                dot(tx, ty, tz, tx, ty, tz), dot(ux, uy, uz, ux, uy, uz), dot(tx, ty, tz, ux, uy, uz),
                d * dot(nx, ny, nz, ax, ay, az) + dot(tx, ty, tz, wx, wy, wz),
                -d * dot(nx, ny, nz, bx, by, bz) - dot(ux, uy, uz, wx, wy, wz), pair,
            )  # fmt: skip
            size = (p.contact_k - over) * along
            ex = over * (wx - first * tx + second * ux)
            ey = over * (wy - first * ty + second * uy)
            ez = over * (wz - first * tz + second * uz)
            first, second = over * d * first, over * d * second
        fx, fy, fz = size * nx + ex, size * ny + ey, size * nz + ez
        s, r = pair.s, pair.t
        add_force(out, n, pair.a, first * nx - (1.0 - s) * fx, first * ny - (1.0 - s) * fy, first * nz - (1.0 - s) * fz)
        add_force(out, n, pair.a + 1, -first * nx - s * fx, -first * ny - s * fy, -first * nz - s * fz)
        add_force(
            out, n, pair.b, (1.0 - r) * fx - second * nx, (1.0 - r) * fy - second * ny, (1.0 - r) * fz - second * nz
        )
        add_force(out, n, pair.b + 1, r * fx + second * nx, r * fy + second * ny, r * fz + second * nz)


@kernel(allocates=False)
def blocks(x, v, t, g, p, points):
    """g^2 k n n^T of touching pairs, and their damping, each place by itself.

    Points of two strands have no block in common, so that a quasi-Newton method learns what pairs do together.
    """
    for i in range(set_touching(x, p)):
        pair = touching_pair(p, i)
        depth = depth_of(p, pair)
        along = g * g * p.contact_k
        if p.contact_k * depth > p.contact_b * rate_of(v, p.cols, pair):
            along += g * p.contact_b
        for e in range(2):
            a, s = (pair.a, pair.s) if e == 0 else (pair.b, pair.t)
            add_block(points, a, p.cols, (1.0 - s) * along, 0.0, pair.nx, pair.ny, pair.nz)
            add_block(points, a + 1, p.cols, s * along, 0.0, pair.nx, pair.ny, pair.nz)


FORCE = Force(
    "strand_contact", rank=31, nets=(StrandArrays,), accelerate=accelerate, damp=damp, energy=energy, power=power,
    pins_power=pins_power, tangent=tangent, blocks=blocks, stores="contact",
)  # fmt: skip
