"""The kick of lines under water: forces and damping together, positions held, for integrators that split them.

In a time s the velocities follow M v' = F - B v - D(v) with the masses in water M, the forces F at these positions, the
damping B of links, bed and bodies, and the drag D of the water. A damping taken apart from F is stable but wrong once
it is stiff: each step then moves a node as if it were not damped. So both are one implicit step, the L-stable method of
second order with two equal stages (Alexander 1977, SIAM J. Numer. Anal. 14:1006), gamma = 1 - 1/sqrt(2):

  u1 = S(v),  u2 = S(v + (1 + sqrt(2)) (u1 - v)),  (M + tau B) u + tau D(u) = M w + tau F for u = S(w), tau = gamma s.

Without damping that is the plain kick v + s F/M, and where damping is stiff it ends at the terminal velocities.

Axial damping needs one unknown a link, its force f. With E = M + tau (bed, bodies, drag), a matrix of each node and
body, and the rates r = G u at which links grow, f = b r and

  (1/b + tau G E^-1 G^T) f = G E^-1 (M w + tau F).

Drag is c (water's velocity - u) with c = D |water's velocity - u|, by Newton's method in log c: stiff drag has c u
constant, where c alone would never come to rest. A link that only pulls takes f = -tension where b r would be less.

Links turn while the step drifts. A stiff damper would resist a rate that is not there, so each stage has the directions
of its own time, by the velocities of the drift, and the velocities of moved nodes of that time. The kick before a drift
knows these from its first stage, the one after it from its start.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel
from sim.springs.analysis.energy import kinetic_energy, open_damping
from sim.springs.forces.under_water.water import submerged, water_at
from sim.springs.kicks.line_solver import factorise, solve_factorised
from sim.springs.laws import damping, tension
from sim.springs.pins import set_paths
from sim.springs.points.arrays import link_at, span
from sim.springs.points.each_link import TINY, stretch
from sim.springs.points.line_arrays import BODY_MASS, DAMPING
from sim.springs.points.line_points import (
    add_six,
    carried_motion,
    matrix_times,
    moment_of,
    over_mass,
    set_carried,
    set_six,
    six,
    symmetric_times,
    tangent_at,
)
from sim.springs.points.vector_ops import add_scaled

GAMMA, STRETCH = 1.0 - math.sqrt(0.5), 1.0 + math.sqrt(2.0)
SETTLED = 1e-3  # relative change of a node's mass and drag, below which Newton's next one is below its square
NEAR = 0.1  # relative change of a drag, below which its logarithm is linear
MAX_ROUNDS = 40
NONE, ACTS, LIMITED = 0, 1, 2  # damping of a link


class LinesRoom(NamedTuple):
    """Arrays of `kick_lines`: n points, nodes first."""

    flow: NDArray[np.float64]  # (3 n,) water's velocity at nodes
    along: NDArray[np.float64]  # (parts, 3) tangents
    drag: NDArray[np.float64]  # (parts, 4): drag over the square of the speed, across and along, and over the speed
    upright: NDArray[np.float64]  # (n,) damping of the bed [N s/m]
    mobility: NDArray[np.float64]  # (6 n,) E^-1 of nodes
    of_bodies: NDArray[np.float64]  # (bodies, 36) E^-1
    links: NDArray[np.float64]  # (links, 6): direction, 1/b, tension, force of the damping
    state: NDArray[np.int64]  # (links,) NONE, ACTS or LIMITED
    values: NDArray[np.float64]  # of the matrix
    y: NDArray[np.float64]  # (links,)
    start: NDArray[np.float64]  # (3 n,) velocities before the kick
    turning: NDArray[np.float64]  # (3 n,) by which links turn: those of the drift, as far as they are known
    w: NDArray[np.float64]  # (3 n,)
    pushes: NDArray[np.float64]  # (3 n,) impulses on nodes and bodies
    scratch: NDArray[np.float64]  # (3 n,)


@kernel
def make_lines_system(p):
    n, links = p.cols, p.ends.shape[0]
    parts, bodies = p.places.shape[0], p.bodies.shape[0]
    values = np.zeros(links + p.rows_below.shape[0])
    return LinesRoom(
        np.zeros(3 * n), np.zeros((parts, 3)), np.zeros((parts, 4)), np.zeros(n), np.zeros(6 * n),
        np.zeros((bodies, 36)), np.zeros((links, 6)), np.zeros(links, np.int64), values, np.zeros(links),
        np.zeros(3 * n), np.zeros(3 * n), np.zeros(3 * n), np.zeros(3 * n), np.zeros(3 * n),
    )  # fmt: skip


@kernel(noalias=True, allocates=False)
def open_kick(x, v, t, p, room):
    """Set the constants of a kick: water, tangents, bed and links at the positions x. True if anything damps."""
    n = p.cols
    for j in range(n):
        room.upright[j] = 0.0
    drags = False
    for i in range(p.places.shape[0]):
        j = p.places[i, 0]
        room.along[i, 0], room.along[i, 1], room.along[i, 2] = tangent_at(x, p, i)
        room.drag[i, 0] = room.drag[i, 1] = 0.0
        if p.moving[j]:
            if x[2 * n + j] < p.bed:
                room.upright[j] += p.parts[i].bed_area * p.bed_damping
            if p.parts[i].drag_across > 0.0 or p.parts[i].drag_along > 0.0:
                u, w, s, _, _, _, elevation = water_at(x, t, p, j)
                room.flow[j], room.flow[n + j], room.flow[2 * n + j] = u, w, s
                wet = submerged(x, p, i, elevation)
                room.drag[i, 0], room.drag[i, 1] = wet * p.parts[i].drag_across, wet * p.parts[i].drag_along
                drags = drags or wet > 0.0
    set_drag(v, p, room)
    for q in range(p.ends.shape[0]):
        link = link_at(p, q)
        _, _, _, length = stretch(x, p, link)
        b = damping(link.law, link.stiffness, link.damping, link.rest, length, 0.0)
        room.links[q, 3] = 1.0 / b if b > 0.0 else 0.0
        room.links[q, 4] = tension(link.law, link.stiffness, link.rest, length)
        room.state[q] = ACTS if b > 0.0 else NONE
    return drags


@kernel(inline=True)
def speeds(v, p, room, i):
    """Speed of the water across and along part i, relative to its node."""
    n, j = p.cols, p.places[i, 0]
    x, y, z = room.flow[j] - v[j], room.flow[n + j] - v[n + j], room.flow[2 * n + j] - v[2 * n + j]
    along = x * room.along[i, 0] + y * room.along[i, 1] + z * room.along[i, 2]
    return math.sqrt(max(x * x + y * y + z * z - along * along, 0.0)), abs(along)


@kernel(noalias=True, allocates=False)
def set_drag(v, p, room):
    """Set the drag over the speed to that at the velocities v."""
    for i in range(p.places.shape[0]):
        across, along = speeds(v, p, room, i)
        room.drag[i, 2], room.drag[i, 3] = room.drag[i, 0] * across, room.drag[i, 1] * along


@kernel(noalias=True, allocates=False)
def invert(m, b):
    """Turn the symmetric positive definite matrix (6, 6) in row b of m (bodies, 36) into its inverse."""
    for k in range(6):
        over = 1.0 / m[b, 7 * k]
        m[b, 7 * k] = 1.0
        for j in range(6):
            m[b, 6 * k + j] *= over
        for i in range(6):
            if i != k:
                part = m[b, 6 * i + k]
                m[b, 6 * i + k] = 0.0
                for j in range(6):
                    m[b, 6 * i + j] -= part * m[b, 6 * k + j]


@kernel(noalias=True, allocates=False)
def set_mobilities(p, tau, room):
    """Set E^-1 of nodes and bodies. p.inertia holds M^-1 of the nodes."""
    n, m, w = p.cols, room.mobility, p.inertia
    for j in range(6 * n):
        m[j] = 0.0
    for j in range(p.nodes):
        m[5 * n + j] = tau * room.upright[j]
    for i in range(p.places.shape[0]):
        j, qx, qy, qz = p.places[i, 0], room.along[i, 0], room.along[i, 1], room.along[i, 2]
        across, s = tau * room.drag[i, 2], tau * (room.drag[i, 3] - room.drag[i, 2])
        m[j] += across + s * qx * qx
        m[n + j] += s * qx * qy
        m[2 * n + j] += s * qx * qz
        m[3 * n + j] += across + s * qy * qy
        m[4 * n + j] += s * qy * qz
        m[5 * n + j] += across + s * qz * qz
    for b in range(p.bodies.shape[0]):
        for k in range(36):
            room.of_bodies[b, k] = p.bodies[b, BODY_MASS + k] + tau * p.bodies[b, DAMPING + k]
    for i in range(p.carried.shape[0]):
        j, b = p.carried[i, 0], p.carried[i, 1]
        for k in range(6):
            unit = (
                1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0, 1.0 if k == 2 else 0.0,
                1.0 if k == 3 else 0.0, 1.0 if k == 4 else 0.0, 1.0 if k == 5 else 0.0,
            )  # fmt: skip
            ux, uy, uz = carried_motion(p, i, unit)
            fx, fy, fz = symmetric_times(m, n, j, ux, uy, uz)
            mx, my, mz = moment_of(p, i, fx, fy, fz)
            room.of_bodies[b, k] += fx
            room.of_bodies[b, 6 + k] += fy
            room.of_bodies[b, 12 + k] += fz
            room.of_bodies[b, 18 + k] += mx
            room.of_bodies[b, 24 + k] += my
            room.of_bodies[b, 30 + k] += mz
    for b in range(p.bodies.shape[0]):
        invert(room.of_bodies, b)
    for j in range(p.nodes):
        if p.inverse_masses[j] == 0.0:
            continue
        # E^-1 = (I + M^-1 C)^-1 M^-1 with C in m, so that neither M nor a C of 0 is inverted.
        cxx, cxy, cxz, cyy, cyz, czz = m[j], m[n + j], m[2 * n + j], m[3 * n + j], m[4 * n + j], m[5 * n + j]
        wxx, wxy, wxz, wyy, wyz, wzz = w[j], w[n + j], w[2 * n + j], w[3 * n + j], w[4 * n + j], w[5 * n + j]
        a, d, g = over_mass(p, j, cxx, cxy, cxz)
        b, e, h = over_mass(p, j, cxy, cyy, cyz)
        c, f, i = over_mass(p, j, cxz, cyz, czz)
        a, e, i = 1.0 + a, 1.0 + e, 1.0 + i
        aa, ab, ac = e * i - f * h, c * h - b * i, b * f - c * e
        over = 1.0 / (a * aa + d * ab + g * ac)
        ba, bb, bc = f * g - d * i, a * i - c * g, c * d - a * f
        ca, cb, cc = d * h - e * g, b * g - a * h, a * e - b * d
        m[j] = over * (aa * wxx + ab * wxy + ac * wxz)
        m[n + j] = over * (aa * wxy + ab * wyy + ac * wyz)
        m[2 * n + j] = over * (aa * wxz + ab * wyz + ac * wzz)
        m[3 * n + j] = over * (ba * wxy + bb * wyy + bc * wyz)
        m[4 * n + j] = over * (ba * wxz + bb * wyz + bc * wzz)
        m[5 * n + j] = over * (ca * wxz + cb * wyz + cc * wzz)


@kernel(noalias=True, allocates=False)
def set_resistance(y, p, tau, room):
    """Set the impulses of drag, bed and damping of bodies at the velocities y."""
    n, g = p.cols, room.pushes
    for j in range(3 * n):
        g[j] = 0.0
    for j in range(p.nodes):
        g[2 * n + j] = -tau * room.upright[j] * y[2 * n + j]
    for i in range(p.places.shape[0]):
        j, qx, qy, qz = p.places[i, 0], room.along[i, 0], room.along[i, 1], room.along[i, 2]
        rx, ry, rz = room.flow[j] - y[j], room.flow[n + j] - y[n + j], room.flow[2 * n + j] - y[2 * n + j]
        c = tau * room.drag[i, 2]
        s = tau * (room.drag[i, 3] - room.drag[i, 2]) * (rx * qx + ry * qy + rz * qz)
        g[j] += c * rx + s * qx
        g[n + j] += c * ry + s * qy
        g[2 * n + j] += c * rz + s * qz
    for b in range(p.bodies.shape[0]):
        k = p.nodes + 2 * b
        d = matrix_times(p.bodies, b, DAMPING, six(y, n, k))
        set_six(g, n, k, (-tau * d[0], -tau * d[1], -tau * d[2], -tau * d[3], -tau * d[4], -tau * d[5]))


@kernel(inline=True)
def pull_ends(p, room, q, impulse):
    """Add an impulse [N s] of link q to its ends."""
    n, g, a, b = p.cols, room.pushes, p.ends[q, 0], p.ends[q, 1]
    for e in range(3):
        g[e * n + a] += impulse * room.links[q, e]
        g[e * n + b] -= impulse * room.links[q, e]


@kernel(noalias=True, allocates=False)
def set_pushed(v, y, p, room):
    """Set v to y and the changes by the impulses."""
    n, g, w = p.cols, room.pushes, room.scratch
    for j in range(3 * n):
        w[j] = g[j]
    for i in range(p.carried.shape[0]):
        j = p.carried[i, 0]
        fx, fy, fz = g[j], g[n + j], g[2 * n + j]
        mx, my, mz = moment_of(p, i, fx, fy, fz)
        add_six(w, n, p.nodes + 2 * p.carried[i, 1], (fx, fy, fz, mx, my, mz))
    for j in range(p.nodes):
        dx, dy, dz = symmetric_times(room.mobility, n, j, w[j], w[n + j], w[2 * n + j])
        if p.inverse_masses[j] == 0.0:
            dx = dy = dz = 0.0
        v[j], v[n + j], v[2 * n + j] = y[j] + dx, y[n + j] + dy, y[2 * n + j] + dz
    for b in range(p.bodies.shape[0]):
        k = p.nodes + 2 * b
        set_six(v, n, k, six(y, n, k))
        add_six(v, n, k, matrix_times(room.of_bodies, b, 0, six(w, n, k)))
    set_carried(v, p)


@kernel(inline=True)
def rate_of(v, p, room, q):
    """[m/s] at which link q grows."""
    du, dv, dw = span(v, p.cols, p.ends[q, 0], p.ends[q, 1])
    return du * room.links[q, 0] + dv * room.links[q, 1] + dw * room.links[q, 2]


@kernel(noalias=True, allocates=False)
def set_link_matrix(p, tau, room):
    """Set 1/b + tau G E^-1 G^T of the links that act; 1 of the others."""
    for k in range(room.values.shape[0]):
        room.values[k] = 0.0
    for k in range(p.link_order.shape[0]):
        q = p.link_order[k]
        room.values[k] = room.links[q, 3] if room.state[q] == ACTS else 1.0
    for m in range(p.products.shape[0]):
        q, k, j, other = p.products[m, 1], p.products[m, 2], p.products[m, 3], p.products[m, 4]
        if room.state[q] != ACTS or room.state[k] != ACTS:
            continue
        fairlead, sign = p.products[m, 6], tau if (p.ends[q, 0] == j) == (p.ends[k, 0] == other) else -tau
        nx, ny, nz = room.links[k, 0], room.links[k, 1], room.links[k, 2]
        if fairlead < 0:
            nx, ny, nz = symmetric_times(room.mobility, p.cols, j, nx, ny, nz)
        else:
            mx, my, mz = moment_of(p, fairlead, nx, ny, nz)
            moved = matrix_times(room.of_bodies, p.carried[fairlead, 1], 0, (nx, ny, nz, mx, my, mz))
            nx, ny, nz = carried_motion(p, p.products[m, 5], moved)
        room.values[p.products[m, 0]] += sign * (nx * room.links[q, 0] + ny * room.links[q, 1] + nz * room.links[q, 2])


@kernel(noalias=True, allocates=False)
def is_settled(v, p, tau, room):
    """True if drag and links stay as they are at the velocities v; else they are set anew."""
    n, change, same = p.cols, 0.0, True
    for i in range(p.places.shape[0]):
        if room.drag[i, 0] == 0.0 and room.drag[i, 1] == 0.0:
            continue
        j, found = p.places[i, 0], speeds(v, p, room, i)
        w = tau / 3.0 * (p.inertia[j] + p.inertia[3 * n + j] + p.inertia[5 * n + j])
        for e in range(2):
            last, c = room.drag[i, 2 + e], room.drag[i, e] * found[e]
            if last > 0.0 and c > 0.0:
                resists = w * last / (1.0 + w * last)
                if abs(c - last) < NEAR * last:
                    c = last + (c - last) / (1.0 + resists)
                else:
                    c = last * (c / last) ** (1.0 / (1.0 + resists))
            room.drag[i, 2 + e] = c
            change = max(change, w * abs(c - last) / (1.0 + w * last))
    for q in range(p.ends.shape[0]):
        if room.state[q] == ACTS and not p.slack_damping and room.links[q, 5] < -room.links[q, 4]:
            room.state[q], same = LIMITED, False
        elif room.state[q] == LIMITED and rate_of(v, p, room, q) > -room.links[q, 4] * room.links[q, 3]:
            room.state[q], same = ACTS, False
    return same and change < SETTLED


@kernel(noalias=True, allocates=False)
def open_stage(x, t, offset, p, room):
    """Turn the links, and set the velocities of moved nodes, to where they are at a time `offset` [s] from t."""
    n = p.cols
    set_paths(room.scratch, room.w, t + offset, p)
    for q in range(p.ends.shape[0]):
        rx, ry, rz = span(x, n, p.ends[q, 0], p.ends[q, 1])
        du, dv, dw = span(room.turning, n, p.ends[q, 0], p.ends[q, 1])
        rx, ry, rz = rx + offset * du, ry + offset * dv, rz + offset * dw
        over = 1.0 / math.sqrt(rx * rx + ry * ry + rz * rz + TINY)
        room.links[q, 0], room.links[q, 1], room.links[q, 2] = over * rx, over * ry, over * rz


@kernel(noalias=True, allocates=False)
def take_stage(v, a, tau, p, room, rounds):
    """Set v to S(room.w), in at least a number of rounds. Returns 0, or 1 if drag and links have not settled then."""
    y = room.w
    add_scaled(y, tau, a)
    for turn in range(MAX_ROUNDS):
        set_mobilities(p, tau, room)
        set_resistance(y, p, tau, room)
        for q in range(p.ends.shape[0]):
            room.links[q, 5] = 0.0
            if room.state[q] == LIMITED:
                room.links[q, 5] = -room.links[q, 4]
                pull_ends(p, room, q, tau * room.links[q, 5])
        set_pushed(v, y, p, room)
        set_link_matrix(p, tau, room)
        factorise(room.values, p.columns_below, p.rows_below, p.link_targets)
        for k in range(p.link_order.shape[0]):
            q = p.link_order[k]
            room.y[k] = rate_of(v, p, room, q) if room.state[q] == ACTS else 0.0
        solve_factorised(room.values, p.columns_below, p.rows_below, room.y)
        for k in range(p.link_order.shape[0]):
            q = p.link_order[k]
            if room.state[q] == ACTS:
                room.links[q, 5] = room.y[k]
                pull_ends(p, room, q, tau * room.y[k])
        set_pushed(v, y, p, room)
        if is_settled(v, p, tau, room) and turn + 1 >= rounds:
            return 0
    return 1


@kernel(allocates=False)
def holders_work(v, s, p, room):
    """Work [J] of prescribed nodes through the damping of links in a time s [s]."""
    n, work = p.cols, 0.0
    for q in range(p.ends.shape[0]):
        for end in range(2):
            j = p.ends[q, end]
            if room.links[q, 5] != 0.0 and not p.moving[j]:
                along = v[j] * room.links[q, 0] + v[n + j] * room.links[q, 1] + v[2 * n + j] * room.links[q, 2]
                work += (1.0 if end == 1 else -1.0) * s * room.links[q, 5] * along
    return work


@kernel(noalias=True, allocates=False)
def kick_lines(x, v, a, t, s, p, begins, room, ledger):
    """Kick for a time s [s] at the positions x of time t [s], by the accelerations a (3 n,) without damping.

    begins: the kick begins at t, else it ends there. p.inertia is that of `accelerate` at x. Returns the work [J] that
    prescribed nodes did through the damping of links. A kick whose drag or links have not settled counts in ledger[2].
    """
    # The first stage begins with the drag at the velocities before it: a second round makes it of second order. The
    # second stage begins with the drag at velocities extrapolated from the first.
    rounds, begin = 2 if open_kick(x, v, t, p, room) else 1, 0.0 if begins else -s
    for j in range(v.shape[0]):
        room.start[j] = room.turning[j] = room.w[j] = v[j]
    open_stage(x, t, begin + GAMMA * s, p, room)
    unsettled = take_stage(v, a, GAMMA * s, p, room, rounds)
    work = holders_work(v, (1.0 - GAMMA) * s, p, room)
    for j in range(v.shape[0]):
        gained = v[j] - room.start[j]
        room.w[j] = room.start[j] + STRETCH * gained
        v[j] = room.start[j] + gained / GAMMA
        room.turning[j] = v[j] if begins else room.start[j]
    set_drag(v, p, room)
    open_stage(x, t, begin + s, p, room)
    unsettled += take_stage(v, a, GAMMA * s, p, room, 1)
    ledger[2] += min(unsettled, 1)
    return work + holders_work(v, GAMMA * s, p, room)


@kernel(noalias=True, allocates=False)
def kick_lines_with_account(x, v, a, t, s, p, begins, room, before, ledger):
    """`kick_lines`, and book the energy that its damping took: the work of a at the mean velocity, less the gain.

    before: scratch (3 n,).
    """
    kinetic = open_damping(v, p, before)
    put_in = kick_lines(x, v, a, t, s, p, begins, room, ledger)
    lost = kinetic - kinetic_energy(v, p)
    # a M u = 1/4 (K(u + a) - K(u - a)) of the quadratic K = u M u; `kinetic_energy` is half of it.
    for j in range(v.shape[0]):
        before[j] = 0.5 * (before[j] + v[j]) + s * a[j]
    lost += 0.5 * kinetic_energy(before, p)
    add_scaled(before, -2.0 * s, a)
    lost -= 0.5 * kinetic_energy(before, p)
    ledger[0] += lost + put_in
    ledger[1] += put_in
