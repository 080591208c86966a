"""The dampers of links in a damped kick: where they are limited by their tensions, and how they turn.

A damping that is limited by the tension of its link is linear, or a constant force: the links change between the two
until none has to (Newton's method for a piecewise linear system).

Axial damping acts along links that turn. The positions are those between the kick that ends a step and the kick that
begins the next, and a time t after them a link lengthens by u^2 t / l faster than its velocities along its direction
there say, u its velocity across and l its length. With that each damper acts along its own path; else stiff axial
damping would take energy from all that turns, in proportion to the step.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel
from sim.springs.kicks.formula import ALPHA
from sim.springs.laws import by_damping
from sim.springs.points.arrays import add_pair, link_count, span
from sim.springs.points.each_link import acting_damping, each_link, stretch

MOST_CHANGES = 50  # rounds in which dampers begin or cease to be limited; a few are enough
SAME = 1e-9  # relative change of a limited force that does not count


class Dampers(NamedTuple):
    """The dampers of all links, by their numbers."""

    acting: NDArray[np.float64]  # (links,) damping where it is linear, else 0 [N s/m]
    limited: NDArray[np.float64]  # (3 links,) constant force on its first point where it is not [N]
    along: NDArray[np.float64]  # (3 links,) its direction, of axial damping
    turning: NDArray[np.float64]  # (links,) rate at which its lengthening grows as it turns [m/s2]


@each_link()
def set_whole(link, p, dampers):
    """Let all dampers act whole."""
    n = dampers.acting.shape[0]
    dampers.acting[link.number] = link.damping
    for e in range(3):
        dampers.limited[e * n + link.number] = 0.0


@kernel
def make_dampers(p, wanted):
    """Dampers of a net, all whole; not wanted: none."""
    n = link_count(p) if wanted else 0
    dampers = Dampers(np.zeros(n), np.zeros(3 * n), np.zeros(3 * n), np.zeros(n))
    if wanted:
        set_whole(p, dampers)
    return dampers


@kernel(inline=True)
def turning_time(s, closing):
    """The time of the one step of the formula [s], from that of the positions."""
    return ALPHA * s - (s if closing else 0.0)


@each_link(noalias=True)
def set_directions(link, x, v, p, dampers):
    """Directions of links, and how fast the lengthening of each grows as it turns."""
    n, q = dampers.acting.shape[0], link.number
    rx, ry, rz, length = stretch(x, p, link)
    du, dv, dw = span(v, p.rows * p.cols, link.a, link.b)
    rate = (du * rx + dv * ry + dw * rz) / length
    dampers.along[q], dampers.along[n + q], dampers.along[2 * n + q] = rx / length, ry / length, rz / length
    dampers.turning[q] = (du * du + dv * dv + dw * dw - rate * rate) / length


@each_link(noalias=True)
def add_limited(link, p, dampers, force):
    """Add the constant forces of limited dampers to force (3 points,) [N]."""
    n, q = dampers.acting.shape[0], link.number
    fx, fy, fz = dampers.limited[q], dampers.limited[n + q], dampers.limited[2 * n + q]
    add_pair(force, p.rows * p.cols, link.a, link.b, fx, fy, fz)


@each_link("sum", noalias=True)
def limit_anew(link, x, mean, s, closing, p, dampers):
    """Decide by the mean velocities which dampers are limited; returns how many are not as before."""
    n, q = dampers.acting.shape[0], link.number
    rx, ry, rz, length = stretch(x, p, link)
    du, dv, dw = span(mean, p.rows * p.cols, link.a, link.b)
    rate = (du * rx + dv * ry + dw * rz) / length
    if p.axial:
        rate += dampers.turning[q] * turning_time(s, closing).real
        du, dv, dw = rate * rx / length, rate * ry / length, rate * rz / length
    acting = acting_damping(link, length, rate)
    linear = acting == link.damping
    size = acting * acting * (du * du + dv * dv + dw * dw)
    off = 0.0
    for e in range(3):
        force = 0.0 if linear else acting * (du if e == 0 else dv if e == 1 else dw)
        off += (force - dampers.limited[e * n + q]) ** 2
        dampers.limited[e * n + q] = force
    changed = linear != (dampers.acting[q] > 0.0) or off > SAME * SAME * size
    dampers.acting[q] = link.damping if linear else 0.0
    return 1.0 if changed and link.damping > 0.0 else 0.0


# True if the law of the links may limit their damping.
may_be_limited = by_damping(
    whole=kernel(lambda law: False, inline=True), limited=kernel(lambda law: True, inline=True)
)  # fmt: skip
