"""The motion of one rigid body over a substep, given its forces: turning, moving, drag and pulls.

Vectors named v, w are in body axes; `turn` takes body to world axes.
"""

import math

import numpy as np

from sim.jit import kernel


@kernel
def set_turn(rotation, i, turn):
    """turn (3, 3): from body to world axes."""
    w, x, y, z = rotation[i, 0], rotation[i, 1], rotation[i, 2], rotation[i, 3]
    turn[0, 0], turn[0, 1], turn[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    turn[1, 0], turn[1, 1], turn[1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    turn[2, 0], turn[2, 1], turn[2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)


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
def slowed(v, linear, quadratic, h):
    """v after h [s] of dv/dt = -linear v - quadratic |v| v, exactly: e v/(1 + quadratic |v| (1 - e)/linear)."""
    fade = math.exp(-linear * h)
    spent = -math.expm1(-linear * h) / linear if linear * h > 1e-9 else h
    return v * fade / (1.0 + quadratic * abs(v) * spent)


@kernel
def add_pull(fleet, i, h, rate, turn, mass, light, v, w):
    """Add to v and w (body axes) the impulse that draws the pulled point to its target, critically damped.

    With K = 1/m - [p] I^-1 [p] the point's lightness, an implicit step of x'' = -rate^2 x - 2 rate x' is the impulse
    P = -s/(1 + s) K^-1 (x' + x rate/(2 + h rate)), s = h rate (2 + h rate) (Catto, Soft Constraints, GDC 2011).
    """
    p, soft, hard = fleet.pull_point[i], np.empty((3, 3)), np.empty((3, 3))
    cross = np.zeros((3, 3))
    cross[0, 1], cross[0, 2], cross[1, 2] = -p[2], p[1], -p[0]
    cross[1, 0], cross[2, 0], cross[2, 1] = p[2], -p[1], p[0]
    for a in range(3):
        for b in range(3):
            total = 1.0 / mass[a] if a == b else 0.0
            for c in range(3):
                for d in range(3):
                    total -= cross[a, c] * light[c, d] * cross[d, b]
            soft[a, b] = total
    set_inverse(soft, hard)
    s = h * rate * (2.0 + h * rate)
    want = np.empty(3)
    for c in range(3):
        offset = p[c]
        for a in range(3):
            offset += turn[a, c] * (fleet.position[i, a] - fleet.pull_target[i, a])
        speed = v[c] + w[(c + 1) % 3] * p[(c + 2) % 3] - w[(c + 2) % 3] * p[(c + 1) % 3]
        want[c] = -s / (1.0 + s) * (speed + offset * rate / (2.0 + h * rate))
    px = hard[0, 0] * want[0] + hard[0, 1] * want[1] + hard[0, 2] * want[2]
    py = hard[1, 0] * want[0] + hard[1, 1] * want[1] + hard[1, 2] * want[2]
    pz = hard[2, 0] * want[0] + hard[2, 1] * want[1] + hard[2, 2] * want[2]
    size = np.sqrt(px * px + py * py + pz * pz)
    limit = fleet.pull_limit[i] * h
    if size > limit:
        px, py, pz = px * limit / size, py * limit / size, pz * limit / size
    tx, ty, tz = p[1] * pz - p[2] * py, p[2] * px - p[0] * pz, p[0] * py - p[1] * px
    v[0] += px / mass[0]
    v[1] += py / mass[1]
    v[2] += pz / mass[2]
    for c in range(3):
        w[c] += light[c, 0] * tx + light[c, 1] * ty + light[c, 2] * tz


@kernel
def drift(fleet, i, h, turn, light, work):
    """Move and turn body i for h [s] without forces; turn becomes the new one, light and work (3, 3) are scratch.

    The solid keeps its angular momentum L: w = R I^-1 R^T L at the middle of the turn, and again at its end.
    """
    inertia = fleet.shapes.inertia[fleet.hull[i]]
    w, r = fleet.spin[i], fleet.rotation[i]
    momentum, body = work[0], work[1]
    for c in range(3):
        fleet.position[i, c] += h * fleet.velocity[i, c]
        body[c] = turn[0, c] * w[0] + turn[1, c] * w[1] + turn[2, c] * w[2]
    for c in range(3):
        momentum[c] = 0.0
        for d in range(3):
            for e in range(3):
                momentum[c] += turn[c, d] * inertia[d, e] * body[e]
    set_inverse(inertia, light)
    r0, r1, r2, r3 = r[0], r[1], r[2], r[3]
    add_turn(r, w, h / 2.0)
    set_turn(fleet.rotation, i, turn)
    set_spin(turn, light, momentum, body, w)
    r[0], r[1], r[2], r[3] = r0, r1, r2, r3
    add_turn(r, w, h)
    set_turn(fleet.rotation, i, turn)
    set_spin(turn, light, momentum, body, w)


@kernel
def set_spin(turn, light, momentum, body, w):
    """w = R I^-1 R^T L with light = I^-1; body (3,) is scratch."""
    for c in range(3):
        body[c] = turn[0, c] * momentum[0] + turn[1, c] * momentum[1] + turn[2, c] * momentum[2]
    for c in range(3):
        w[c] = 0.0
        for d in range(3):
            for e in range(3):
                w[c] += turn[c, d] * light[d, e] * body[e]


@kernel
def add_turn(r, w, h):
    """Turn the quaternion r by w h: r <- exp(h w/2) r."""
    speed = np.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
    c = math.cos(speed * h / 2.0)
    k = math.sin(speed * h / 2.0) / speed if speed > 0.0 else h / 2.0
    x, y, z = k * w[0], k * w[1], k * w[2]
    q0 = c * r[0] - x * r[1] - y * r[2] - z * r[3]
    q1 = c * r[1] + x * r[0] + y * r[3] - z * r[2]
    q2 = c * r[2] + y * r[0] + z * r[1] - x * r[3]
    q3 = c * r[3] + z * r[0] + x * r[2] - y * r[1]
    size = np.sqrt(q0 * q0 + q1 * q1 + q2 * q2 + q3 * q3)
    r[0], r[1], r[2], r[3] = q0 / size, q1 / size, q2 / size, q3 / size
