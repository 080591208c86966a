"""The motion of one rigid body over a substep, given its forces: rotation, translation, drag and pulls.

R (3, 3) is the rotation from body to world axes. The scratch's v (velocity) and w (angular velocity), and what acts on
them, are in the axes of the body's heading: x and y level, turned about z, which is up.
"""

import math
from typing import NamedTuple

import numpy as np

from sim.jit import kernel

PULL_TOLERANCE, MAX_PULL_ITERATIONS = 1e-3, 12  # of the largest pull, before it is cut to it exactly


class Scratch(NamedTuple):
    """Arrays that the kernels of one body write before they read them; allocated once for all bodies."""

    R: np.ndarray  # (3, 3) rotation from body to world axes
    T: np.ndarray  # (3, 3) rotation from body axes to those of its heading, with z up
    H: np.ndarray  # (3, 3) rotation from the axes of the heading to those of the world
    inertia: np.ndarray  # (3, 3) [m5] of the solid about its own axes, half turned to those of the heading
    mass: np.ndarray  # (6, 6) [kg, kg m, kg m2] of the solid with added mass, in the axes of the heading
    factor: np.ndarray  # (6, 6) lower Cholesky factor of it
    wet: np.ndarray  # (6,) share of the body that is wet for each motion: 1 as at rest, 0 in air
    share: np.ndarray  # (6,) factor on its waves, felt and made: the root of `wet`, less if it is below the surface
    load: np.ndarray  # (6,) [N, N m] of all forces, and what they change
    substep: np.ndarray  # (s,) [s] for which decay and gain hold, of each linear hull
    decay: np.ndarray  # (s, p) complex: what a substep leaves of the memory
    gain: np.ndarray  # (s, p) [s] complex: what a substep adds of a unit velocity
    pull_point: np.ndarray  # (3,) [m] where the body is pulled, in the axes in which its forces are
    v: np.ndarray  # (3,) [m/s] velocity
    w: np.ndarray  # (3,) [rad/s] angular velocity
    flow: np.ndarray  # (3,) [m/s] velocity of the fluid
    momentum: np.ndarray  # (3,) angular momentum of the solid at unit density, in world axes
    force: np.ndarray  # (3,) [N] of the fluids at rest
    moment: np.ndarray  # (3,) [N m] of the fluids at rest
    wetted: np.ndarray  # (3,) [kg/m] wetted area across each body axis times density
    pressure: np.ndarray  # (9,) what `add_pressure` adds to


@kernel
def make_scratch(hulls, poles):
    """Arrays for the kernels of one body, of so many linear hulls with so many poles; all but substep uninitialised."""
    return Scratch(
        np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((6, 6)), np.empty((6, 6)),
        np.empty(6), np.empty(6), np.empty(6), np.zeros(hulls),
        np.empty((hulls, poles), np.complex128), np.empty((hulls, poles), np.complex128),
        np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3),
        np.empty(9),
    )  # fmt: skip


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


@kernel
def set_rotation(rotation, i, R):
    """Set R (3, 3), from body to world axes, of the quaternion rotation[i] of (n, 4)."""
    w, x, y, z = rotation[i, 0], rotation[i, 1], rotation[i, 2], rotation[i, 3]
    R[0, 0], R[0, 1], R[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    R[1, 0], R[1, 1], R[1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    R[2, 0], R[2, 1], R[2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)


@kernel
def heading_of(rotation, i):
    """Cosine and sine of the heading of the quaternion rotation[i] of (n, 4), whichever side of the body is up.

    It is that of the body's x axis, seen from above. Where that stands within 30 degrees of the vertical, its y axis is
    a quarter turn to the left of the heading.
    """
    w, x, y, z = rotation[i, 0], rotation[i, 1], rotation[i, 2], rotation[i, 3]
    cosine, sine = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z)
    if cosine * cosine + sine * sine < 0.25:
        cosine, sine = 1.0 - 2.0 * (x * x + z * z), -2.0 * (x * y - w * z)
    size = math.sqrt(cosine * cosine + sine * sine)
    return cosine / size, sine / size


@kernel
def set_inverse(a, out):
    """out = a^-1 of (3, 3), by cofactors."""
    for r in range(3):
        for c in range(3):
            r1, r2, c1, c2 = (r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3
            out[c, r] = a[r1, c1] * a[r2, c2] - a[r1, c2] * a[r2, c1]
    scale = 1.0 / (a[0, 0] * out[0, 0] + a[0, 1] * out[1, 0] + a[0, 2] * out[2, 0])
    for r in range(3):
        for c in range(3):
            out[r, c] *= scale


@kernel
def after_drag(v, linear, quadratic, h):
    """v after h [s] of dv/dt = -linear v - quadratic |v| v, exactly: e v/(1 + quadratic |v| (1 - e)/linear).

    With e = exp(-linear h). v is a number; linear [1/s], quadratic [1/m].
    """
    if linear <= 0.0:
        return v / (1.0 + quadratic * abs(v) * h)
    decay = math.exp(-linear * h)
    integral = -math.expm1(-linear * h) / linear if linear * h > 1e-9 else h
    return v * decay / (1.0 + quadratic * abs(v) * integral)


@kernel
def add_pull(fleet, i, h, rate, scratch):
    """Add to v and w the impulse that draws the pulled point of body i to its target, critically damped.

    With K the mobility of the point, an implicit step of x'' = -rate^2 x - 2 rate x' is the impulse
    P = -s/(1 + s) K^-1 (x' + x rate/(2 + h rate)), s = h rate (2 + h rate) (Catto, Soft Constraints, GDC 2011).
    An impulse above the limit uses (K + m)^-1 in place of K^-1, with m such that its size is the limit. The further
    above, the straighter it points to the target. An impulse that is only scaled down keeps the direction of K^-1, and
    a body that is pulled upwards at a corner would run aside. m by the iteration of More and Sorensen 1983.
    """
    H, v, w, p, change = scratch.H, scratch.v, scratch.w, scratch.pull_point, scratch.load
    K, K_inv, wanted, impulse = np.empty((3, 3)), np.empty((3, 3)), np.empty(3), np.empty(3)
    for c in range(3):  # column c of K: the velocity of the point after a unit impulse along c
        set_impulse(change, p, c == 0, c == 1, c == 2)
        solve_factorised(scratch.factor, change)
        for a in range(3):
            K[a, c] = change[a] + change[3 + (a + 1) % 3] * p[(a + 2) % 3] - change[3 + (a + 2) % 3] * p[(a + 1) % 3]
    s = h * rate * (2.0 + h * rate)
    for c in range(3):
        offset = p[c]
        for a in range(3):
            offset += H[a, c] * (fleet.position[i, a] - fleet.pull_target[i, a])
        speed = v[c] + w[(c + 1) % 3] * p[(c + 2) % 3] - w[(c + 2) % 3] * p[(c + 1) % 3]
        wanted[c] = -s / (1.0 + s) * (speed + offset * rate / (2.0 + h * rate))
    limit, size = fleet.pull_limit[i] * h, 0.0
    for _ in range(MAX_PULL_ITERATIONS):
        set_inverse(K, K_inv)
        set_product(K_inv, wanted, impulse)
        size = np.sqrt(impulse[0] * impulse[0] + impulse[1] * impulse[1] + impulse[2] * impulse[2])
        if not size > limit * (1.0 + PULL_TOLERANCE):
            break
        set_product(K_inv, impulse, change)
        bend = impulse[0] * change[0] + impulse[1] * change[1] + impulse[2] * change[2]
        for c in range(3):
            K[c, c] += (size / limit - 1.0) * size * size / bend
    scale = limit / size if size > limit else 1.0
    set_impulse(change, p, scale * impulse[0], scale * impulse[1], scale * impulse[2])
    solve_factorised(scratch.factor, change)
    for c in range(3):
        v[c] += change[c]
        w[c] += change[3 + c]


@kernel(inline=True)
def set_product(matrix, vector, out):
    """Set the first three of out to matrix (3, 3) times vector (3,)."""
    for c in range(3):
        out[c] = matrix[c, 0] * vector[0] + matrix[c, 1] * vector[1] + matrix[c, 2] * vector[2]


@kernel
def set_impulse(out, p, x, y, z):
    """Set out (6,) to the impulse (x, y, z) at the point p (3,) and its moment."""
    out[0], out[1], out[2] = x, y, z
    out[3], out[4], out[5] = p[1] * z - p[2] * y, p[2] * x - p[0] * z, p[0] * y - p[1] * x


@kernel(inline=True)
def drift(fleet, i, h, scratch):
    """Move and rotate body i for h [s] without forces; R becomes the new rotation.

    The solid keeps its angular momentum L: w = R I^-1 R^T L at the middle of the rotation, and again at its end.
    """
    R, momentum, body_spin, hull = scratch.R, scratch.momentum, scratch.w, fleet.hull[i]
    solid_inertia, inverse_inertia = fleet.hulls.inertia[hull], fleet.hulls.inverse_inertia[hull]
    spin, q = fleet.spin[i], fleet.rotation[i]
    for c in range(3):
        fleet.position[i, c] += h * fleet.velocity[i, c]
        body_spin[c] = R[0, c] * spin[0] + R[1, c] * spin[1] + R[2, c] * spin[2]
    for c in range(3):
        momentum[c] = 0.0
        for d in range(3):
            for e in range(3):
                momentum[c] += R[c, d] * solid_inertia[d, e] * body_spin[e]
    q0, q1, q2, q3 = q[0], q[1], q[2], q[3]
    rotate(q, spin, h / 2.0)
    set_rotation(fleet.rotation, i, R)
    set_spin(R, inverse_inertia, momentum, body_spin, spin)
    q[0], q[1], q[2], q[3] = q0, q1, q2, q3
    rotate(q, spin, h)
    set_rotation(fleet.rotation, i, R)
    set_spin(R, inverse_inertia, momentum, body_spin, spin)


@kernel
def set_spin(R, inverse_inertia, momentum, body_momentum, spin):
    """spin (3,) = R I^-1 R^T L of the angular momentum L (3,); body_momentum (3,) is scratch."""
    for c in range(3):
        body_momentum[c] = R[0, c] * momentum[0] + R[1, c] * momentum[1] + R[2, c] * momentum[2]
    for c in range(3):
        spin[c] = 0.0
        for d in range(3):
            for e in range(3):
                spin[c] += R[c, d] * inverse_inertia[d, e] * body_momentum[e]


@kernel
def rotate(q, spin, h):
    """Rotate the quaternion q (4,) by spin (3,) [rad/s] for h [s]: q <- exp(h spin/2) q."""
    speed = np.sqrt(spin[0] * spin[0] + spin[1] * spin[1] + spin[2] * spin[2])
    c = math.cos(speed * h / 2.0)
    k = math.sin(speed * h / 2.0) / speed if speed > 0.0 else h / 2.0
    x, y, z = k * spin[0], k * spin[1], k * spin[2]
    q0 = c * q[0] - x * q[1] - y * q[2] - z * q[3]
    q1 = c * q[1] + x * q[0] + y * q[3] - z * q[2]
    q2 = c * q[2] + y * q[0] + z * q[1] - x * q[3]
    q3 = c * q[3] + z * q[0] + x * q[2] - y * q[1]
    size = np.sqrt(q0 * q0 + q1 * q1 + q2 * q2 + q3 * q3)
    q[0], q[1], q[2], q[3] = q0 / size, q1 / size, q2 / size, q3 / size
