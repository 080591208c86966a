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
    depth: float, nx: float, ny: float, nz: float, u: float, v: float, w: float, mass: float, p: Any,
    on_sphere: bool, with_damping: bool,
) -> tuple[float, float, float]:  # fmt: skip
    """Force (fx, fy, fz) on a point of `mass` at `depth` that moves at (u, v, w) relative to the surface."""
    k, b = p.contact_k, p.contact_b
    if not with_damping:
        return k * depth * nx, k * depth * ny, k * depth * nz
    if p.lab_contact:
        if on_sphere:
            b *= depth
        return k * depth * nx - b * u, k * depth * ny - b * v, k * depth * nz - b * w
    vn = u * nx + v * ny + w * nz
    normal = max(0.0, k * depth - b * vn)
    fx, fy, fz = normal * nx, normal * ny, normal * nz
    if p.friction > 0.0:
        tx, ty, tz = u - vn * nx, v - vn * ny, w - vn * nz
        speed = math.sqrt(tx * tx + ty * ty + tz * tz)
        # F_t = -mu N t/|t|, at most what stops the point within the step
        grip = mass * p.stop_rate
        if p.friction * normal < grip * speed:
            grip = p.friction * normal / speed
        fx -= grip * tx
        fy -= grip * ty
        fz -= grip * tz
    return fx, fy, fz


def secant(dx: float, dy: float, dz: float, stiffness: float, most: float) -> float:
    """Secant stiffness [N/m] of a pull over (dx, dy, dz) [m]: its own within reach, most / distance beyond."""
    distance = math.sqrt(dx * dx + dy * dy + dz * dz)
    return most / distance if stiffness * distance > most else stiffness
