"""One rigid body without a fluid: its motion without forces, its mass matrix (6, 6), and the pull at one of its points.

Velocities and forces of six numbers are a linear part and one of rotation, in the axes of the body's heading: x and y
level, turned about z, which is up.
"""

import math

import numpy as np

from sim.floating.motion.rotation import (
    axes_of,
    columns,
    cross,
    dot,
    four,
    plus,
    rotated,
    scaled,
    set_three,
    solve_three,
    three,
    to_heading,
    turn,
    turn_back,
)
from sim.jit import kernel

PULL_TOLERANCE, MAX_PULL_ITERATIONS = 1e-3, 12  # of the largest pull, before it is cut to it exactly


@kernel
def factorise(a, out):
    """Set out to the lower Cholesky factor of a (6, 6), symmetric and positive definite."""
    for r in range(6):
        for c in range(r + 1):
            total = a[r, c]
            for k in range(c):
                total -= out[r, k] * out[c, k]
            out[r, c] = np.sqrt(total) if r == c else total / out[c, c]


@kernel
def solve_factorised(factor, b):
    """Replace b (6,) by x of A x = b, of the lower Cholesky factor of A."""
    for r in range(6):
        for k in range(r):
            b[r] -= factor[r, k] * b[k]
        b[r] /= factor[r, r]
    for r in range(5, -1, -1):
        for k in range(r + 1, 6):
            b[r] -= factor[k, r] * b[k]
        b[r] /= factor[r, r]


@kernel(inline=True)
def set_six(out, linear, angular):
    """Set out (6,) to its two parts."""
    out[0], out[1], out[2] = linear
    out[3], out[4], out[5] = angular


@kernel(inline=True)
def linear_part(six):
    """The first three of six numbers."""
    return six[0], six[1], six[2]


@kernel(inline=True)
def angular_part(six):
    """The last three of six numbers."""
    return six[3], six[4], six[5]


@kernel(inline=True)
def velocity_at(six, place):
    """Velocity [m/s] of the place of a body with these six velocities, from its centre [m]."""
    return plus(linear_part(six), 1.0, cross(angular_part(six), place))


@kernel(inline=True)
def add_pull(fleet, i, h, rate, factor, heading, place, change, six):
    """Add to the velocities (6,) the impulse that draws the pulled point of body i to its target, critically damped.

    factor: of the mass. place: of the point, in the axes of the heading. change (6,): scratch.
    With K the mobility of the point, an implicit step of x'' = -rate^2 x - 2 rate x' is the impulse
    P = -s/(1 + s) K^-1 (x' + x rate/(2 + h rate)), s = h rate (2 + h rate) (Catto, Soft Constraints, GDC 2011).
    An impulse above the limit uses (K + m)^-1 in place of K^-1, with m such that its size is the limit. The further
    above, the straighter it points to the target. An impulse that is only scaled down keeps the direction of K^-1, and
    a body that is pulled upwards at a corner would move sideways. m by the iteration of More and Sorensen 1983.
    """
    kx = pushed(factor, (1.0, 0.0, 0.0), place, change)
    ky = pushed(factor, (0.0, 1.0, 0.0), place, change)
    kz = pushed(factor, (0.0, 0.0, 1.0), place, change)
    s = h * rate * (2.0 + h * rate)
    away = plus(three(fleet.position, i), -1.0, three(fleet.pull_target, i))
    offset = plus(place, 1.0, to_heading(heading, away))
    wanted = scaled(-s / (1.0 + s), plus(velocity_at(six, place), rate / (2.0 + h * rate), offset))
    limit, size, impulse = fleet.pull_limit[i] * h, 0.0, wanted
    for _ in range(MAX_PULL_ITERATIONS):
        K = kx, ky, kz
        impulse = solve_three(K, wanted)
        size = math.sqrt(dot(impulse, impulse))
        if not size > limit * (1.0 + PULL_TOLERANCE):
            break
        more = (size / limit - 1.0) * size * size / dot(impulse, solve_three(K, impulse))
        kx, ky, kz = (kx[0] + more, kx[1], kx[2]), (ky[0], ky[1] + more, ky[2]), (kz[0], kz[1], kz[2] + more)
    fleet.pull_force[i] = min(size, limit) / h
    pushed(factor, scaled(limit / size if size > limit else 1.0, impulse), place, change)
    for c in range(6):
        six[c] += change[c]


@kernel(inline=True)
def pushed(factor, impulse, place, change):
    """The velocity that an impulse at a place gives to the body there; change (6,) becomes that of all of it."""
    set_six(change, impulse, cross(place, impulse))
    solve_factorised(factor, change)
    return velocity_at(change, place)


@kernel(inline=True)
def drift(fleet, i, h):
    """Move and rotate body i for h [s] without forces; returns its new axes.

    The solid keeps its angular momentum L: w = R I^-1 R^T L at the middle of the rotation, and again at its end.
    """
    hull, q, spin = fleet.hull[i], four(fleet.rotation, i), three(fleet.spin, i)
    inverse = columns(fleet.hulls.inverse_inertia, hull)
    set_three(fleet.position, i, plus(three(fleet.position, i), h, three(fleet.velocity, i)))
    axes = axes_of(q)
    momentum = turn(axes, turn(columns(fleet.hulls.inertia, hull), turn_back(axes, spin)))  # of unit density
    axes = axes_of(rotated(q, spin, h / 2.0))
    q = rotated(q, turn(axes, turn(inverse, turn_back(axes, momentum))), h)
    axes = axes_of(q)
    set_three(fleet.spin, i, turn(axes, turn(inverse, turn_back(axes, momentum))))
    fleet.rotation[i, 0], fleet.rotation[i, 1], fleet.rotation[i, 2], fleet.rotation[i, 3] = q
    return axes
