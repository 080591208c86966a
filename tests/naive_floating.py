"""Slow, obvious references for floating bodies."""

import itertools
import math

import numpy as np

from sim.floating import Hull, MotionCoefficients, pressure_force, submerged
from sim.floating.linear.hydrodynamics import afloat
from sim.floating.motion.rotation import rotation_matrix


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


def axes_of_heading(turn: np.ndarray) -> np.ndarray:
    """Level axes (3, 3) along the body's x axis seen from above, or its y axis where x is within 30 degrees of up."""
    x, y = turn[:2, 0], np.array([turn[1, 1], -turn[0, 1]])
    ahead = y if abs(turn[2, 0]) > math.cos(math.radians(30.0)) else x
    cosine, sine = ahead / np.linalg.norm(ahead)
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])


def naive_step(
    hull: Hull, density: float, state, upper, lower, flow, lift, law: MotionCoefficients, h: float, given, lines
):
    """One leapfrog step of one body from motion.py's equations, in matrices and the axes of the body's heading.

    state: position, rotation, velocity, spin, the fluid (6,) carried at the last step or None, and the memory (p, 6);
    upper and lower: (density, height at the origin, slope) of the planes z = height + slope . (x, y); flow (3,) and
    lift: velocity and upward acceleration of the surface; given (6,): excitation, or None; lines (6,): of moorings.
    The drag is integrated in many small steps instead of in closed form.
    """
    position, rotation, velocity, spin, before, memory = state
    position, rotation, spin = naive_drift(hull, position, rotation, velocity, spin, h / 2)
    true = rotation_matrix(rotation)
    turn = np.eye(3) if hull.shape.is_round else true
    heading = np.eye(3) if hull.shape.is_round else axes_of_heading(true)
    tilt = heading.T @ turn
    pose = (1.0, 0.0, 0.0, 0.0) if hull.shape.is_round else rotation
    place = hull.vertices @ turn.T + position
    linear = afloat(hull, density)
    force, moment, wet, displaced, volume = np.zeros(3), np.zeros(3), np.zeros(3), 0.0, 0.0
    step = 0.0
    areas = [np.cross(b - a, c - a) / 2 for a, b, c in hull.vertices[hull.faces]]
    for rho, height, slope in (upper, lower):
        heights = height + place[:, :2] @ slope
        f, m = pressure_force(hull, position, pose, heights, rho - step, law.gravity)
        force, moment = force + f, moment + m
        below = submerged(hull, position, pose, heights).volume
        displaced, volume = displaced + (rho - step) * below, max(volume, below)
        for face, area in zip(hull.faces, areas, strict=True):
            wet += (rho - step) * np.abs(area) * wet_share((heights - place[:, 2])[face])
        step = rho
    fluid = displaced / volume if volume > 0 else 0.0
    full = 0.5 * fluid * linear.wet_area
    wetter = np.minimum(wet / full, 1.0) if volume > 0 else np.zeros(3)
    share = tilt**2 @ wetter
    scale = np.sqrt(np.append(share, (np.roll(share, -1) + np.roll(share, -2)) / 2))

    def added_mass(carried):
        """Added mass that the hull carries: motions in turn, each with its couplings, from the rest of A."""
        total, left = np.zeros((6, 6)), linear.linear.infinite.copy()
        for part, shared in zip(range(6), carried, strict=True):
            if left[part, part] > 1e-8 * np.trace(linear.linear.infinite):
                alone = np.outer(left[part], left[part]) / left[part, part]
                total, left = total + shared * alone, left - alone
        return law.added_mass * total

    added = added_mass(fluid * scale**2)
    solid = np.zeros((6, 6))
    solid[:3, :3], solid[3:, 3:] = hull.volume * density * np.eye(3), density * tilt @ hull.inertia @ tilt.T
    v, w, u = heading.T @ velocity, heading.T @ spin, heading.T @ flow
    if before is not None:
        kept = added_mass(np.minimum(before, fluid * scale**2))
        shared = np.linalg.solve(solid + added, (solid + kept) @ np.append(v - u, w))
        v, w = u + shared[:3], shared[3:]
    level = upper[1] + position[:2] @ upper[2] - position[2]
    felt = scale * math.exp(-max(level - np.abs(hull.extents[2]).max(), 0.0) / linear.linear.draft)
    poles = linear.memory.poles * math.sqrt(law.gravity)
    moving = felt * np.append(v - (u if given is None else 0.0), w)
    memory = np.exp(poles * h)[:, None] * memory + ((np.exp(poles * h) - 1) / poles)[:, None] * moving
    load = np.append(heading.T @ (force - [0, 0, hull.volume * density * law.gravity]), heading.T @ moment)
    load = load + np.append(heading.T @ lines[:3], heading.T @ lines[3:])
    carried = hull.volume * min(density, fluid) * felt[2] ** 2
    if given is None:
        load = load + np.append(carried * lift * heading.T @ np.array([*-upper[2], 1.0]), np.zeros(3))
        riding = np.array([*(-(law.gravity + lift) * upper[2]), lift])
        load = load + added @ np.append(heading.T @ riding, np.zeros(3))
    else:
        load = load + np.append(carried * lift * heading.T @ np.array([*-upper[2], 0.0]), np.zeros(3))
        load = load + fluid * felt**2 * np.append(heading.T @ given[:3], heading.T @ given[3:])
    past = 2 * np.einsum("pcd,pd->c", linear.memory.residues, memory).real
    load = load - law.radiation * fluid * law.gravity * felt * past
    change = h * np.linalg.solve(solid + added, load)
    v, w = tilt.T @ (v + change[:3] - u), tilt.T @ (w + change[3:])
    total = solid + added
    mass = np.append(np.diag(tilt.T @ total[:3, :3] @ tilt), np.diag(tilt.T @ total[3:, 3:] @ tilt))

    size = np.linalg.norm(areas, axis=1)
    middles = (hull.vertices[hull.faces] + np.roll(hull.vertices[hull.faces], 1, axis=1)) / 2
    arm = np.sqrt((size[:, None] * (middles**2).mean(axis=1)).sum(axis=0) / size.sum())
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        v[i] = dragged(v[i], wet[i] / 2 / mass[i], wet[i] / 2 / mass[i], law, h)
        wide = (wet[j] * arm[k] ** 2 + wet[k] * arm[j] ** 2) / 2 / mass[3 + i]
        wider = (wet[j] * arm[k] ** 3 + wet[k] * arm[j] ** 3) / 2 / mass[3 + i]
        w[i] = dragged(w[i], wide, wider, law, h)
    velocity, spin = flow + turn @ v, turn @ w
    position, rotation, spin = naive_drift(hull, position, rotation, velocity, spin, h / 2)
    return position, rotation, velocity, spin, fluid * scale**2, memory


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
    """Fraction of a triangle's area where the linear function of these corner values is positive."""
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
