"""Laws of forces on one point in plain Python: kernels compile them, and a student's rope calls them as they are.

They read their numbers from a record `p` with the names of `sim.springs.points.arrays`. Each stands by itself, as a
kernel can call no plain function.
"""

import math
from typing import Any


def touching(x: float, y: float, z: float, t: float, p: Any, on_sphere: bool) -> tuple[float, float, float, float]:
    """(depth, nx, ny, nz) of a point against the floor or the sphere; depth <= 0 is no contact."""
    if on_sphere:
        s = t - p.epoch
        dx, dy, dz = x - p.sx - s * p.svx, y - p.sy - s * p.svy, z - p.sz - s * p.svz
        distance = math.sqrt(dx * dx + dy * dy + dz * dz)
        if distance == 0.0:
            return p.sr, 0.0, 0.0, 1.0
        return p.sr - distance, dx / distance, dy / distance, dz / distance
    return p.floor - z, 0.0, 0.0, 1.0


def contact_force(
    depth: float, nx: float, ny: float, nz: float, u: float, v: float, w: float, p: Any, on_sphere: bool,
    with_damping: bool,
) -> tuple[float, float, float]:  # fmt: skip
    """Force (fx, fy, fz) on a point at `depth` that moves at (u, v, w) relative to the surface, without friction."""
    k, b = p.contact_k, p.contact_b
    if not with_damping:
        return k * depth * nx, k * depth * ny, k * depth * nz
    if p.lab_contact:
        if on_sphere:
            b *= depth
        return k * depth * nx - b * u, k * depth * ny - b * v, k * depth * nz - b * w
    vn = u * nx + v * ny + w * nz
    normal = max(0.0, k * depth - b * vn)
    return normal * nx, normal * ny, normal * nz


def stopping(
    nx: float, ny: float, nz: float, u: float, v: float, w: float, ax: float, ay: float, az: float,
    grip: float, stop_rate: float,
) -> tuple[float, float, float, float]:  # fmt: skip
    """Deceleration s that stops a point along its surface within a step, and the fraction of it that friction gives.

    n: normal of the surface; (u, v, w): velocity relative to it; (ax, ay, az): acceleration by all other forces; grip:
    mu N / m, the most that friction gives; stop_rate: 1/h. s = v_t / h + a_t. For a point that friction cannot stop
    within two steps it is v_t / h, so that friction acts against the motion, with a continuous change between.
    """
    if not grip > 0.0:
        return 0.0, 0.0, 0.0, 0.0
    vn, an = u * nx + v * ny + w * nz, ax * nx + ay * ny + az * nz
    sx, sy, sz = stop_rate * (u - vn * nx), stop_rate * (v - vn * ny), stop_rate * (w - vn * nz)
    share = min(1.0, max(0.0, 2.0 - math.sqrt(sx * sx + sy * sy + sz * sz) / grip))
    sx, sy, sz = sx + share * (ax - an * nx), sy + share * (ay - an * ny), sz + share * (az - an * nz)
    size = math.sqrt(sx * sx + sy * sy + sz * sz)
    return sx, sy, sz, grip / size if size > grip else 1.0


def secant(dx: float, dy: float, dz: float, stiffness: float, most: float) -> float:
    """Secant stiffness [N/m] of a pull over (dx, dy, dz) [m]: its own within reach, most / distance beyond."""
    distance = math.sqrt(dx * dx + dy * dy + dz * dz)
    return most / distance if stiffness * distance > most else stiffness
