"""Hydrostatics of a closed mesh in any pose under any surface: volume, centre, waterplane, pressure force and moment.

The surface is given as its height above each vertex and is linear over each triangle, so that the depth d of a
point on the hull is linear there too. Each triangle is cut where d = 0, and the integrand over the wet part is a
polynomial: the integrals are exact. Two fluids are two such sums, since the pressure is
p = rho1 g d1 + (rho2 - rho1) g d2, each term only where its depth is positive: d1 below the surface, d2 below the
interface.

A cut triangle has one corner on one side. Over that corner (vertices q0, q0 + t1 e1, q0 + t2 e2, t = d0/(d0 - di))
the integral is taken as it is; the part left is the whole minus the corner. Nothing is allocated.

Sources: divergence theorem on the wet surface closed by the water surface, where d = 0 (Newman, Marine
Hydrodynamics, 1977, section 6.15 and 6.16).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sim.floating.hulls.closed_mesh import ClosedMesh, area_vectors, check_hull
from sim.floating.motion.rotation import rotation_matrix
from sim.jit import kernel
from sim.records import equal_to_itself
from sim.validation import argument_error, as_array, check_number
from sim.water import EARTH_GRAVITY, SEA_DENSITY

AT_SURFACE = 1e-9  # fraction of the height of a hull within which a vertex lies in the surface


@kernel(inline=True)
def turned(i, j, k, a, b, c):
    """The corners of a triangle across the surface and their depths, in the same order from the one that is alone."""
    if (a > 0.0) == (b > 0.0):
        return k, i, j, c, a, b
    if (a > 0.0) == (c > 0.0):
        return j, k, i, b, c, a
    return i, j, k, a, b, c


@kernel(noalias=True)
def add_pressure(x, faces, area, first, last, depth, weight, out):
    """Add weight times the wet integrals of triangles first to last to out (9,).

    x (3, n) [m], faces (3, m), area (3, m) [m2], depth (n,) [m] below the surface, negative above it.
    out[0:3] += int d n dA [m3]; out[3:6] += int d x cross n dA [m4]; out[6:9] += int |n_i| dA [m2].
    """
    fx = fy = fz = mx = my = mz = wx = wy = wz = 0.0
    for f in range(first, last):
        i, j, k = faces[0, f], faces[1, f], faces[2, f]
        a, b, c = depth[i], depth[j], depth[k]
        if a <= 0.0 and b <= 0.0 and c <= 0.0:
            continue
        # whole triangle, per area: mean of d is (a+b+c)/3, mean of d x is (sum d sum x + sum d x)/12
        s = a + b + c
        px = (s * (x[0, i] + x[0, j] + x[0, k]) + a * x[0, i] + b * x[0, j] + c * x[0, k]) / 12.0
        py = (s * (x[1, i] + x[1, j] + x[1, k]) + a * x[1, i] + b * x[1, j] + c * x[1, k]) / 12.0
        pz = (s * (x[2, i] + x[2, j] + x[2, k]) + a * x[2, i] + b * x[2, j] + c * x[2, k]) / 12.0
        s /= 3.0
        wet = 1.0
        if a < 0.0 or b < 0.0 or c < 0.0:
            i, j, k, a, b, c = turned(i, j, k, a, b, c)
            t1 = a / (a - b)
            t2 = a / (a - c)
            t = t1 * t2
            e = t * a / 12.0
            qx = e * (4.0 * x[0, i] + t1 * (x[0, j] - x[0, i]) + t2 * (x[0, k] - x[0, i]))
            qy = e * (4.0 * x[1, i] + t1 * (x[1, j] - x[1, i]) + t2 * (x[1, k] - x[1, i]))
            qz = e * (4.0 * x[2, i] + t1 * (x[2, j] - x[2, i]) + t2 * (x[2, k] - x[2, i]))
            if a > 0.0:
                s, px, py, pz, wet = 4.0 * e, qx, qy, qz, t
            else:
                s, px, py, pz, wet = s - 4.0 * e, px - qx, py - qy, pz - qz, 1.0 - t
        nx, ny, nz = area[0, f], area[1, f], area[2, f]
        fx += s * nx
        fy += s * ny
        fz += s * nz
        mx += py * nz - pz * ny
        my += pz * nx - px * nz
        mz += px * ny - py * nx
        wx += wet * abs(nx)
        wy += wet * abs(ny)
        wz += wet * abs(nz)
    out[0] += weight * fx
    out[1] += weight * fy
    out[2] += weight * fz
    out[3] += weight * mx
    out[4] += weight * my
    out[5] += weight * mz
    out[6] += weight * wx
    out[7] += weight * wy
    out[8] += weight * wz


@kernel
def mean_product(a0, a1, a2, b0, b1, b2):
    """Mean over a triangle of the product of two linear functions given at its corners."""
    return ((a0 + a1 + a2) * (b0 + b1 + b2) + a0 * b0 + a1 * b1 + a2 * b2) / 12.0


@kernel
def add_displaced_triangle(x0, y0, z0, d0, x1, y1, z1, d1, x2, y2, z2, d2, nz, out):
    """Add the integrals of one wholly wet triangle of vertical area nz [m2] to out (10,): see `add_displaced`."""
    out[0] -= nz * (d0 + d1 + d2) / 3.0
    out[1] -= nz * mean_product(x0, x1, x2, d0, d1, d2)
    out[2] -= nz * mean_product(y0, y1, y2, d0, d1, d2)
    out[3] -= nz * mean_product(z0 + d0 / 2.0, z1 + d1 / 2.0, z2 + d2 / 2.0, d0, d1, d2)
    out[4] -= nz
    out[5] -= nz * (x0 + x1 + x2) / 3.0
    out[6] -= nz * (y0 + y1 + y2) / 3.0
    out[7] -= nz * mean_product(x0, x1, x2, x0, x1, x2)
    out[8] -= nz * mean_product(y0, y1, y2, y0, y1, y2)
    out[9] -= nz * mean_product(x0, x1, x2, y0, y1, y2)


@kernel(noalias=True)
def add_displaced(x, faces, nz, depth, out):
    """Add the integrals of the part below the surface to out (10,): V, V x, V y, V z, A, A x, A y, A xx, A yy, A xy.

    x (3, n) [m] in world axes, faces (3, m), nz (m,) [m2] vertical part of the areas, depth (n,) [m].
    Each is an integral over the wet surface of a field of the right divergence that vanishes at d = 0 (volume) or
    is carried by the waterplane alone (area), with d = eta - z:
      V = -int d nz,  V x = -int x d nz,  V z = -int (eta^2 - z^2)/2 nz = -int (z + d/2) d nz,  A xx = -int x^2 nz
    """
    for f in range(faces.shape[1]):
        i, j, k = faces[0, f], faces[1, f], faces[2, f]
        a, b, c = depth[i], depth[j], depth[k]
        if a <= 0.0 and b <= 0.0 and c <= 0.0:
            continue
        cut = a < 0.0 or b < 0.0 or c < 0.0
        if cut:
            i, j, k, a, b, c = turned(i, j, k, a, b, c)
        x0, y0, z0 = x[0, i], x[1, i], x[2, i]
        x1, y1, z1 = x[0, j], x[1, j], x[2, j]
        x2, y2, z2 = x[0, k], x[1, k], x[2, k]
        n = nz[f]
        if not cut:
            add_displaced_triangle(x0, y0, z0, a, x1, y1, z1, b, x2, y2, z2, c, n, out)
            continue
        t1, t2 = a / (a - b), a / (a - c)
        p1, q1, r1 = x0 + t1 * (x1 - x0), y0 + t1 * (y1 - y0), z0 + t1 * (z1 - z0)
        p2, q2, r2 = x0 + t2 * (x2 - x0), y0 + t2 * (y2 - y0), z0 + t2 * (z2 - z0)
        if a > 0.0:
            add_displaced_triangle(x0, y0, z0, a, p1, q1, r1, 0.0, p2, q2, r2, 0.0, n * t1 * t2, out)
        else:
            add_displaced_triangle(p1, q1, r1, 0.0, x1, y1, z1, b, x2, y2, z2, c, n * (1.0 - t1), out)
            add_displaced_triangle(p1, q1, r1, 0.0, x2, y2, z2, c, p2, q2, r2, 0.0, n * t1 * (1.0 - t2), out)


def displaced(x: np.ndarray, faces: np.ndarray, nz: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """The integrals (10,) of `add_displaced`, with its arguments.

    A level face at the surface, within `AT_SURFACE`, is dry, and the waterplane is the one just below it: hulls of
    panel files end at the surface, and would have no waterplane.
    """
    out, near = np.zeros(10), AT_SURFACE * float(np.ptp(x[2]))
    add_displaced(x, faces, nz, np.where(np.abs(depth) <= near, 0.0, depth), out)
    return out


@equal_to_itself
class Submerged(NamedTuple):
    """The part of a hull below a surface. The waterplane is the surface inside the hull, seen from above."""

    volume: float  # [m3]
    centre: np.ndarray  # (3,) [m] centre of buoyancy, in world axes; NaN where nothing is submerged
    area: float  # [m2] of the waterplane
    second: np.ndarray  # (3,) [m4] int x^2, int y^2, int x y over the waterplane, about the hull's centre of mass


def check_pose(
    hull: ClosedMesh, position: ArrayLike, rotation: ArrayLike, surface: ArrayLike
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Position (3,), rotation matrix and surface height per vertex as arrays. Raises ValueError for bad ones."""
    check_hull("hull", hull)
    place = as_array("position", position, "three finite numbers [m]")
    turn = as_array("rotation", rotation, "a quaternion (w, x, y, z) that is not zero")
    if place.shape != (3,) or not np.isfinite(place).all():
        raise argument_error("position", place.tolist(), "three finite numbers [m]")
    if turn.shape != (4,) or not np.isfinite(turn).all() or not np.linalg.norm(turn) > 0:
        raise argument_error("rotation", turn.tolist(), "a quaternion (w, x, y, z) that is not zero")
    allowed = f"a finite height [m], or one for each of {len(hull.vertices)} vertices"
    heights = as_array("surface", surface, allowed)
    if heights.shape not in ((), (len(hull.vertices),)) or not np.isfinite(heights).all():
        raise argument_error("surface", surface, allowed)
    return place, rotation_matrix(turn), np.broadcast_to(heights, len(hull.vertices))


def submerged(
    hull: ClosedMesh,
    position: ArrayLike = (0.0, 0.0, 0.0),
    rotation: ArrayLike = (1.0, 0.0, 0.0, 0.0),
    surface: ArrayLike = 0.0,
) -> Submerged:
    """The part of the hull below `surface`, a height or heights above each vertex (n,) [m].

    position (3,) [m] of the centre of mass, rotation a quaternion (w, x, y, z). Raises ValueError for bad arguments.

    >>> from sim.floating import Hull
    >>> round(submerged(Hull.box(1.0, 1.0, 1.0), position=(0.0, 0.0, 0.2)).volume, 6)  # [m3]
    0.3
    """
    place, turn, heights = check_pose(hull, position, rotation, surface)
    x = np.ascontiguousarray(turn @ hull.vertices.T)
    nz = np.ascontiguousarray(area_vectors(x.T, hull.faces)[:, 2])
    out = displaced(x, np.ascontiguousarray(hull.faces.T), nz, heights - place[2] - x[2])
    volume = max(float(out[0]), 0.0)
    centre = place + out[1:4] / volume if volume > 0 else np.full(3, np.nan)
    return Submerged(volume, centre, float(out[4]), out[7:10].copy())


def pressure_force(
    hull: ClosedMesh,
    position: ArrayLike = (0.0, 0.0, 0.0),
    rotation: ArrayLike = (1.0, 0.0, 0.0, 0.0),
    surface: ArrayLike = 0.0,
    density: float = SEA_DENSITY,
    gravity: float = EARTH_GRAVITY,
) -> tuple[np.ndarray, np.ndarray]:
    """Force (3,) [N] and moment (3,) [N m] about the centre of mass of a fluid of `density` [kg/m3] below `surface`.

    For two fluids add the force of the upper below its surface and that of the difference of the densities below
    the interface. Arguments as in `submerged`. Raises ValueError for bad arguments.
    """
    place, turn, heights = check_pose(hull, position, rotation, surface)
    density, gravity = check_number("density", density, "kg/m3", 0.0), check_number("gravity", gravity, "m/s2", 0.0)
    x = np.ascontiguousarray(turn @ hull.vertices.T)
    area = np.ascontiguousarray(area_vectors(x.T, hull.faces).T)
    out = np.zeros(9)
    faces = np.ascontiguousarray(hull.faces.T)
    # force = -int p n
    add_pressure(x, faces, area, 0, len(hull.faces), heights - place[2] - x[2], -density * gravity, out)
    return out[0:3].copy(), out[3:6].copy()
