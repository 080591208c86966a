"""The motion of one rigid body over a substep, given its forces: rotation, translation, drag and pulls.

Vectors named v (velocity) and w (angular velocity) are in body axes. R (3, 3) is the rotation from body to world axes.
"""

import math
from typing import NamedTuple

import numpy as np

from sim.jit import kernel


class Scratch(NamedTuple):
    """Arrays that the kernels of one body write before they read them; allocated once for all bodies."""

    R: np.ndarray  # (3, 3) rotation from body to world axes
    inertia: np.ndarray  # (3, 3) [kg m2] inertia with added inertia
    inverse_inertia: np.ndarray  # (3, 3) inverse of it, or of the inertia of the solid alone
    mass: np.ndarray  # (3,) [kg] with added mass, along each body axis
    v: np.ndarray  # (3,) [m/s] velocity in body axes
    w: np.ndarray  # (3,) [rad/s] angular velocity in body axes
    momentum: np.ndarray  # (3,) angular momentum of the solid at unit density, in world axes
    force: np.ndarray  # (3,) [N] of the fluids, in body axes
    moment: np.ndarray  # (3,) [N m] of the fluids, in body axes
    wetted: np.ndarray  # (3,) [kg/m] wetted area across each body axis times density
    pressure: np.ndarray  # (9,) what `add_pressure` adds to


@kernel
def make_scratch():
    """Arrays for the kernels of one body, uninitialised."""
    return Scratch(
        np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty(3), np.empty(3), np.empty(3), np.empty(3),
        np.empty(3), np.empty(3), np.empty(3), np.empty(9),
    )  # fmt: skip


@kernel
def set_rotation(rotation, i, R):
    """Set R (3, 3), from body to world axes, of the quaternion rotation[i] of (n, 4)."""
    w, x, y, z = rotation[i, 0], rotation[i, 1], rotation[i, 2], rotation[i, 3]
    R[0, 0], R[0, 1], R[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    R[1, 0], R[1, 1], R[1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    R[2, 0], R[2, 1], R[2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)


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
    decay = math.exp(-linear * h)
    integral = -math.expm1(-linear * h) / linear if linear * h > 1e-9 else h
    return v * decay / (1.0 + quadratic * abs(v) * integral)


@kernel
def add_pull(fleet, i, h, rate, scratch):
    """Add to v and w the impulse that draws the pulled point of body i to its target, critically damped.

    With K = 1/m - [p] I^-1 [p] the inverse mass of the point, an implicit step of x'' = -rate^2 x - 2 rate x' is the
    impulse P = -s/(1 + s) K^-1 (x' + x rate/(2 + h rate)), s = h rate (2 + h rate) (Catto, Soft Constraints, GDC 2011).
    """
    R, inverse_inertia, mass, v, w = scratch.R, scratch.inverse_inertia, scratch.mass, scratch.v, scratch.w
    p, K, K_inv = fleet.pull_point[i], np.empty((3, 3)), np.empty((3, 3))
    cross = np.zeros((3, 3))  # [p]: cross @ a = p x a
    cross[0, 1], cross[0, 2], cross[1, 2] = -p[2], p[1], -p[0]
    cross[1, 0], cross[2, 0], cross[2, 1] = p[2], -p[1], p[0]
    for a in range(3):
        for b in range(3):
            total = 1.0 / mass[a] if a == b else 0.0
            for c in range(3):
                for d in range(3):
                    total -= cross[a, c] * inverse_inertia[c, d] * cross[d, b]
            K[a, b] = total
    set_inverse(K, K_inv)
    s = h * rate * (2.0 + h * rate)
    velocity_change = np.empty(3)  # of the pulled point, in body axes
    for c in range(3):
        offset = p[c]
        for a in range(3):
            offset += R[a, c] * (fleet.position[i, a] - fleet.pull_target[i, a])
        speed = v[c] + w[(c + 1) % 3] * p[(c + 2) % 3] - w[(c + 2) % 3] * p[(c + 1) % 3]
        velocity_change[c] = -s / (1.0 + s) * (speed + offset * rate / (2.0 + h * rate))
    px = K_inv[0, 0] * velocity_change[0] + K_inv[0, 1] * velocity_change[1] + K_inv[0, 2] * velocity_change[2]
    py = K_inv[1, 0] * velocity_change[0] + K_inv[1, 1] * velocity_change[1] + K_inv[1, 2] * velocity_change[2]
    pz = K_inv[2, 0] * velocity_change[0] + K_inv[2, 1] * velocity_change[1] + K_inv[2, 2] * velocity_change[2]
    size = np.sqrt(px * px + py * py + pz * pz)
    limit = fleet.pull_limit[i] * h
    if size > limit:
        px, py, pz = px * limit / size, py * limit / size, pz * limit / size
    tx, ty, tz = p[1] * pz - p[2] * py, p[2] * px - p[0] * pz, p[0] * py - p[1] * px
    v[0] += px / mass[0]
    v[1] += py / mass[1]
    v[2] += pz / mass[2]
    for c in range(3):
        w[c] += inverse_inertia[c, 0] * tx + inverse_inertia[c, 1] * ty + inverse_inertia[c, 2] * tz


@kernel
def drift(fleet, i, h, scratch):
    """Move and rotate body i for h [s] without forces; R becomes the new rotation.

    The solid keeps its angular momentum L: w = R I^-1 R^T L at the middle of the rotation, and again at its end.
    """
    R, inverse_inertia, momentum, body_spin = scratch.R, scratch.inverse_inertia, scratch.momentum, scratch.w
    solid_inertia = fleet.hulls.inertia[fleet.hull[i]]
    spin, q = fleet.spin[i], fleet.rotation[i]
    for c in range(3):
        fleet.position[i, c] += h * fleet.velocity[i, c]
        body_spin[c] = R[0, c] * spin[0] + R[1, c] * spin[1] + R[2, c] * spin[2]
    for c in range(3):
        momentum[c] = 0.0
        for d in range(3):
            for e in range(3):
                momentum[c] += R[c, d] * solid_inertia[d, e] * body_spin[e]
    set_inverse(solid_inertia, inverse_inertia)
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
