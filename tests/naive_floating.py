"""Slow, obvious references for floating bodies."""

import itertools
import math

import numpy as np

from sim.floating import Hull, MotionCoefficients, pressure_force
from sim.floating.rotation import rotation_matrix


def sliced(vertices: np.ndarray, faces: np.ndarray, depth: np.ndarray) -> tuple[float, np.ndarray, float]:
    """Volume below the surface, the integrals of x, y and -depth over it, and the waterplane area, by slicing.

    The mesh is sheared so that its surface lies at height 0 (z = -depth, which keeps volumes and x, y), cut by
    horizontal planes into segments, and the area of each slice is the shoelace sum over them. Between the heights
    of vertices area and moments are polynomials of degree 2 and 3 of z, which two Gauss points integrate exactly.
    """
    corners = np.column_stack([vertices[:, :2], -depth])[faces]
    levels = np.unique(np.append(corners[..., 2], 0.0))
    levels = levels[levels <= 0.0]
    volume, moment = 0.0, np.zeros(3)
    for low, high in itertools.pairwise(levels):
        for side in (-1, 1):
            z = (low + high) / 2 + side * (high - low) / 2 / math.sqrt(3)
            area, first = slice_at(corners, z)
            volume += (high - low) / 2 * area
            moment += (high - low) / 2 * np.append(first, z * area)
    below = float(levels[-2]) if len(levels) > 1 else 0.0
    return volume, moment, slice_at(corners, below * 1e-9)[0] if len(levels) > 1 else 0.0


def slice_at(corners: np.ndarray, z: float) -> tuple[float, np.ndarray]:
    """Area and first moments of the slice at height z of triangles (m, 3, 3): sums over its outline."""
    area, first = 0.0, np.zeros(2)
    for triangle in corners[(corners[..., 2].min(axis=1) < z) & (corners[..., 2].max(axis=1) > z)]:
        up = down = np.zeros(2)
        for p, q in zip(triangle, np.roll(triangle, -1, axis=0), strict=True):
            if (p[2] < z) != (q[2] < z):
                crossing = p[:2] + (z - p[2]) / (q[2] - p[2]) * (q[:2] - p[:2])
                if p[2] < z:
                    up = crossing
                else:
                    down = crossing
        # faces counterclockwise seen from outside: seen from above, the outline runs from `down` to `up`
        cross = down[0] * up[1] - down[1] * up[0]
        area += cross / 2
        first += cross * (up + down) / 6
    return area, first


def pressure_by_points(
    vertices: np.ndarray, faces: np.ndarray, depth: np.ndarray, parts: int
) -> tuple[np.ndarray, np.ndarray]:
    """Integrals of max(d, 0) n and its moment about the origin: each triangle in parts^2, the middle of each."""
    force, moment = np.zeros(3), np.zeros(3)
    weights = []
    for i in range(parts):
        for j in range(parts - i):
            weights.append(((i + 1 / 3) / parts, (j + 1 / 3) / parts))
            if i + j < parts - 1:
                weights.append(((i + 2 / 3) / parts, (j + 2 / 3) / parts))
    u, v = np.array(weights).T
    share = np.stack([1 - u - v, u, v])
    for face in faces:
        a, b, c = vertices[face]
        area = np.cross(b - a, c - a) / 2 / parts**2
        points = share.T @ vertices[face]
        d = np.maximum(share.T @ depth[face], 0.0)
        force += d.sum() * area
        moment += np.cross(d @ points, area)
    return force, moment


def quaternion(rng: np.random.Generator) -> np.ndarray:
    """A rotation drawn uniformly."""
    q = rng.normal(size=4)
    return q / np.linalg.norm(q)


def lumpy(rng: np.random.Generator, vertices: np.ndarray) -> np.ndarray:
    """Vertices of a mesh moved along their radius at random: closed, star-shaped, not convex."""
    return vertices * rng.uniform(0.6, 1.4, size=(len(vertices), 1))


def naive_step(hull: Hull, density: float, state, upper, lower, flow, lift, law: MotionCoefficients, h: float):
    """One leapfrog step of one body from motion.py's equations, in matrices and world axes.

    state: position, rotation, velocity, spin, and the wet skin of the last step or None; upper and lower: (density,
    height at the origin, slope) of the planes z = height + slope . (x, y); flow (3,) and lift: velocity and upward
    acceleration of the surface.
    The drag is integrated in many small steps instead of in closed form.
    """
    position, rotation, velocity, spin, before = state
    position, rotation, spin = naive_drift(hull, position, rotation, velocity, spin, h / 2)
    turn = rotation_matrix(rotation)
    place = hull.vertices @ turn.T + position
    g = law.gravity + lift
    force, moment, wet = np.zeros(3), np.zeros(3), np.zeros(3)
    step = 0.0
    areas = [np.cross(b - a, c - a) / 2 for a, b, c in hull.vertices[hull.faces]]
    for rho, height, slope in (upper, lower):
        heights = height + place[:, :2] @ slope
        f, m = pressure_force(hull, position, rotation, heights, rho - step, g)
        force, moment = force + f, moment + m
        for face, area in zip(hull.faces, areas, strict=True):
            wet += (rho - step) * np.abs(area) * wet_share((heights - place[:, 2])[face])
        step = rho
    skin = np.abs(areas).sum(axis=0)
    along, about = hull.added_mass()
    share = wet / skin
    mass = hull.volume * density + law.added_mass * along * share
    fluid = np.array([*(-g * upper[2]), lift])
    carried = turn @ np.diag(mass - hull.volume * density) @ turn.T
    total = force + hull.volume * density * np.array([0, 0, -law.gravity]) + carried @ fluid
    if before is not None:
        kept = hull.volume * density + law.added_mass * along * np.minimum(before, wet) / skin
        velocity = flow + turn @ np.diag(kept / mass) @ turn.T @ (velocity - flow)
    velocity = velocity + h * turn @ np.diag(1 / mass) @ turn.T @ total
    inertia = density * hull.inertia + law.added_mass * np.diag(about * (np.roll(share, 1) + np.roll(share, 2)) / 2)
    spin = spin + h * turn @ np.linalg.inv(inertia) @ turn.T @ moment

    size = np.linalg.norm(areas, axis=1)
    middles = (hull.vertices[hull.faces] + np.roll(hull.vertices[hull.faces], 1, axis=1)) / 2
    arm = np.sqrt((size[:, None] * (middles**2).mean(axis=1)).sum(axis=0) / size.sum())
    v, w = turn.T @ (velocity - flow), turn.T @ spin
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        v[i] = dragged(v[i], wet[i] / 2 / mass[i], wet[i] / 2 / mass[i], law, h)
        wide = (wet[j] * arm[k] ** 2 + wet[k] * arm[j] ** 2) / 2 / inertia[i, i]
        wider = (wet[j] * arm[k] ** 3 + wet[k] * arm[j] ** 3) / 2 / inertia[i, i]
        w[i] = dragged(w[i], wide, wider, law, h)
    velocity, spin = flow + turn @ v, turn @ w
    position, rotation, spin = naive_drift(hull, position, rotation, velocity, spin, h / 2)
    return position, rotation, velocity, spin, wet


def naive_drift(hull: Hull, position, rotation, velocity, spin, h: float):
    """Motion without forces: the angular momentum stays, the turn is by the spin at its middle."""
    turn = rotation_matrix(rotation)
    momentum = turn @ hull.inertia @ turn.T @ spin
    for length in (h / 2, h):
        angle = np.linalg.norm(spin) * length
        half = np.append(math.cos(angle / 2), math.sin(angle / 2) * spin / np.linalg.norm(spin))
        new = hamilton(half, rotation)
        turn = rotation_matrix(new)
        spin = turn @ np.linalg.inv(hull.inertia) @ turn.T @ momentum
    return position + h * velocity, new, spin


def wet_share(depth: np.ndarray) -> float:
    """Share of a triangle's area where the linear function of these corner values is positive."""
    low, middle, high = np.sort(depth)
    if low >= 0 or high <= 0:
        return float(high > 0)
    if middle <= 0:
        return high**2 / ((high - low) * (high - middle))
    return 1 - low**2 / ((low - high) * (low - middle))


def dragged(v: float, linear: float, quadratic: float, law: MotionCoefficients, h: float, parts: int = 2000) -> float:
    """v after h of dv/dt = -b linear v - C/2 quadratic |v| v, by the midpoint rule."""
    for _ in range(parts):
        half = v - h / parts / 2 * (law.linear_drag * linear + law.quadratic_drag / 2 * quadratic * abs(v)) * v
        v -= h / parts * (law.linear_drag * linear + law.quadratic_drag / 2 * quadratic * abs(half)) * half
    return v


def hamilton(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Product of two quaternions (w, x, y, z)."""
    scalar = a[0] * b[0] - a[1:] @ b[1:]
    return np.append(scalar, a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:]))
