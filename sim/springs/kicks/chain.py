"""The damped kick of a rope, solved directly for the forces of its dampers, in O(points).

The unknowns are the forces f of the dampers, not velocities: with D v the relative velocities of the links, W = M^-1,
    f/b = D V,  V = U + alpha s W D^T f,  (1/b + alpha s D W D^T) f = D U,
a tridiagonal system, of one number a link where damping is axial, else of one for each component. Its condition does
not grow with b. Velocities change by pairs of opposite impulses, so that a free rope keeps its momentum to round-off.
Drag is divided out of U and W, as (1 + alpha s c w).

Axial damping acts along links that turn. The positions are those between the kick that ends a step and the kick that
begins the next, and a time t after them a link lengthens by u^2 t / l faster than its velocities along its direction
there say, u its velocity across and l its length. With that each damper acts along its own path; else stiff axial
damping would take energy from all that turns, in proportion to the step.

A damping that is limited by the tension of its link is linear, or a constant force: the links change between the two
until none has to (Newton's method for a piecewise linear system).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel
from sim.springs.kicks.formula import ALPHA
from sim.springs.laws import by_damping
from sim.springs.points.arrays import link_at, span
from sim.springs.points.each_link import acting_damping, stretch

MOST_CHANGES = 50  # rounds in which links begin or cease to be limited; a few are enough
SAME = 1e-12  # relative change of a limited force that is round-off


class ChainRoom(NamedTuple):
    """Scratch of kicks of one time s of a rope of n points, and the mean velocities that they leave."""

    mean: NDArray[np.float64]  # (3 n,) mean velocities of the kick [m/s]
    load: NDArray[np.float64]  # (3 n,) accelerations by forces that do not depend on the velocities [m/s2]
    acting: NDArray[np.float64]  # (n,) damping of the link after a point where it is linear [N s/m]
    limited: NDArray[np.float64]  # (3 n,) its constant force on this point where it is not [N]
    along: NDArray[np.float64]  # (3 n,) its direction
    turning: NDArray[np.float64]  # (n,) rate at which its lengthening grows as it turns [m/s2]
    eased: NDArray[np.complex128]  # (n,) 1 / (1 + alpha s c w) of each point
    mobility: NDArray[np.complex128]  # (n,) alpha s w of each point, eased
    force: NDArray[np.complex128]  # (3 n,) forces of the dampers on the points before them [N]
    pivot: NDArray[np.complex128]  # (n,) inverse pivots of the elimination
    back: NDArray[np.complex128]  # (n,) factors of the next force on the way back


@kernel
def make_chain_room(p, s, wanted, mean):
    """Room for kicks of a time s [s]; not wanted: of no points. mean: (3 n,) for the mean velocities."""
    n = p.cols if wanted else 0
    eased, mobility = np.zeros(n, np.complex128), np.zeros(n, np.complex128)
    for j in range(n):
        eased[j] = 1.0 / (1.0 + ALPHA * (s * p.drag * p.inverse_masses[j]))
        mobility[j] = ALPHA * (s * p.inverse_masses[j]) * eased[j]
    room = ChainRoom(
        mean, np.zeros(3 * n), np.full(n, p.families[0, 2]), np.zeros(3 * n), np.zeros(3 * n), np.zeros(n),
        eased, mobility, np.zeros(3 * n, np.complex128), np.zeros(n, np.complex128), np.zeros(n, np.complex128),
    )  # fmt: skip
    if wanted and not p.axial:
        set_isotropic_pivots(room, p)
    return room


@kernel(inline=True)
def turning_time(s, closing):
    """The time of the one step of the formula [s], from that of the positions."""
    return ALPHA * s - (s if closing else 0.0)


@kernel(inline=True)
def drive(v, s, room, j, i):
    """Complex velocity of point j without dampers; i: index of its component."""
    return (v[i] + ALPHA * (s * room.load[i])) * room.eased[j]


@kernel(noalias=True, allocates=False)
def set_isotropic_pivots(room, p):
    """The elimination's factors, which are the same for all three components."""
    back = 0.0j
    for j in range(p.cols - 1):
        b, left, right = room.acting[j], room.mobility[j], room.mobility[j + 1]
        room.pivot[j] = b / (1.0 + b * (left + right) - b * left * back)
        back = right * room.pivot[j]
        room.back[j] = back


@kernel(noalias=True, allocates=False)
def solve_isotropic(v, s, room, p):
    """Set room.force, one component after another."""
    n = p.cols
    for e in range(3):
        o, force = e * n, 0.0j
        left = drive(v, s, room, 0, o)
        for j in range(n - 1):
            right = drive(v, s, room, j + 1, o + j + 1)
            force = room.pivot[j] * (right - left + room.mobility[j] * force)
            room.force[o + j] = force
            left = right
        force = 0.0j
        for turn in range(n - 1):
            j = n - 2 - turn
            force = room.force[o + j] + room.back[j] * force
            room.force[o + j] = force


@kernel(noalias=True, allocates=False)
def set_directions(x, v, room, p):
    """Directions of links, and how fast the lengthening of each grows as it turns."""
    n = p.cols
    for j in range(n - 1):
        rx, ry, rz, length = stretch(x, p, link_at(p, j))
        room.along[j], room.along[n + j], room.along[2 * n + j] = rx / length, ry / length, rz / length
        du, dv, dw = span(v, n, j, j + 1)
        rate = (du * rx + dv * ry + dw * rz) / length
        room.turning[j] = (du * du + dv * dv + dw * dw - rate * rate) / length


@kernel(noalias=True, allocates=False)
def solve_axial(v, s, closing, room, p):
    """Set room.force (3 n,): the forces along the links, times their directions."""
    n, along, time = p.cols, room.along, turning_time(s, closing)
    force, back, cosine = 0.0j, 0.0j, 0.0  # the cosine between a link and the one before it
    for j in range(n - 1):
        b, left, right, speed = room.acting[j], room.mobility[j], room.mobility[j + 1], room.turning[j] * time
        for e in range(3):
            i = e * n + j
            speed += along[i] * (drive(v, s, room, j + 1, i + 1) - drive(v, s, room, j, i))
        pivot = b / (1.0 + b * (left + right) - b * left * cosine * back)
        force = pivot * (speed + left * cosine * force)
        cosine = 0.0
        if j + 2 < n:
            for e in range(3):
                cosine += along[e * n + j] * along[e * n + j + 1]
        back = right * cosine * pivot
        room.force[j], room.back[j] = force, back
    force = 0.0j
    for turn in range(n - 1):
        j = n - 2 - turn
        force = room.force[j] + room.back[j] * force
        room.force[j] = force * along[j]
        room.force[n + j] = force * along[n + j]
        room.force[2 * n + j] = force * along[2 * n + j]


@kernel(noalias=True, allocates=False)
def solve_forces(v, s, closing, room, p):
    """Set room.force, and the mean velocities that follow."""
    n = p.cols
    if p.axial:
        solve_axial(v, s, closing, room, p)
    else:
        solve_isotropic(v, s, room, p)
    for e in range(3):
        o, before = e * n, 0.0j
        for j in range(n):
            force = room.force[o + j] if j + 1 < n else 0.0j
            room.mean[o + j] = (drive(v, s, room, j, o + j) + room.mobility[j] * (force - before)).real
            before = force


@kernel(noalias=True, allocates=False)
def set_loads(a, room, p):
    """Loads from the accelerations a and the limited forces."""
    n = p.cols
    for e in range(3):
        before = 0.0
        for j in range(n):
            force = room.limited[e * n + j] if j + 1 < n else 0.0
            room.load[e * n + j] = a[e * n + j] + p.inverse_masses[j] * (force - before)
            before = force


@kernel(noalias=True, allocates=False)
def limit_anew(x, s, closing, room, p):
    """Decide by the mean velocities which dampers are limited; True if that is not as before."""
    n, changed = p.cols, False
    for j in range(n - 1):
        link = link_at(p, j)
        rx, ry, rz, length = stretch(x, p, link)
        du, dv, dw = span(room.mean, n, j, j + 1)
        rate = (du * rx + dv * ry + dw * rz) / length
        if p.axial:
            rate += room.turning[j] * turning_time(s, closing).real
        acting = acting_damping(link, length, rate)
        linear = acting == link.damping
        if p.axial:
            du, dv, dw = rate * rx / length, rate * ry / length, rate * rz / length
        size = acting * acting * (du * du + dv * dv + dw * dw)
        off = 0.0
        for e in range(3):
            force = 0.0 if linear else acting * (du if e == 0 else dv if e == 1 else dw)
            off += (force - room.limited[e * n + j]) ** 2
            room.limited[e * n + j] = force
        changed = changed or linear != (room.acting[j] > 0.0) or off > SAME * SAME * size
        room.acting[j] = link.damping if linear else 0.0
    return changed


@kernel(noalias=True, inline=True)
def solve_whole(law, x, v, a, s, closing, room, p):
    """Of dampers that always act whole."""
    set_loads(a, room, p)
    solve_forces(v, s, closing, room, p)


@kernel(noalias=True, inline=True)
def solve_limited(law, x, v, a, s, closing, room, p):
    """Of dampers that their tensions limit; all act whole at first."""
    for j in range(p.cols):
        room.acting[j] = p.families[0, 2]
        for e in range(3):
            room.limited[e * p.cols + j] = 0.0
    if not p.axial:
        set_isotropic_pivots(room, p)
    for _ in range(MOST_CHANGES):
        set_loads(a, room, p)
        solve_forces(v, s, closing, room, p)
        if not limit_anew(x, s, closing, room, p):
            break
        if not p.axial:
            set_isotropic_pivots(room, p)


solve = by_damping(whole=solve_whole, limited=solve_limited)


@kernel(noalias=True, allocates=False)
def kick_chain(x, v, a, s, closing, room, p):
    """Kick a rope for a time s [s] by the accelerations a [m/s2] and the damping of links and air.

    closing: True of the kick that ends a step at x, False of the one that begins there. room: of `make_chain_room`; its
    `mean` is left with the mean velocities. Returns the work [J] that moving pins did through the dampers.
    """
    n, work = p.cols, 0.0
    if p.axial:
        set_directions(x, v, room, p)
    solve(p.law, x, v, a, s, closing, room, p)
    for e in range(3):
        o, before = e * n, 0.0
        for j in range(n):
            force = room.force[o + j].real + room.limited[o + j] if j + 1 < n else 0.0
            w = p.inverse_masses[j]
            if w == 0.0:
                work -= s * (force - before) * v[o + j]
            else:
                v[o + j] += s * (a[o + j] + w * (force - before - p.drag * room.mean[o + j]))
            before = force
    return work
