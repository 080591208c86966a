"""Makes the tables of this folder: linear coefficients of boxes, cylinders and spheres afloat in deep water.

python assets/hydrodynamics/make_tables.py [box cylinder sphere]    (needs the extra `bem`; half an hour on one core)

A box, or a cylinder with its axis upright, is to the water only its wet part. So the tables go by draft, and of boxes
by the ratio of their sides. Lengths are in units of half the root of length times width of a box, and of the radius
of the others.
"""

import math
import sys
from pathlib import Path

import numpy as np

from sim.floating.boundary_elements import FREQUENCIES, Solution, solve

ASPECTS = (1.0, 1.5, 2.5, 5.0)  # of the sides of a box
DRAFTS = (0.06, 0.15, 0.3, 0.5, 0.75, 1.1, 1.7, 2.7, 4.2)  # of a box and a cylinder
SPHERE_DRAFTS = (0.15, 0.3, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 1.9)
QUARTER = np.radians(np.arange(0.0, 91.0, 10.0))  # directions of waves; the other three quarters are mirrored
AHEAD = np.zeros(1)  # for what is round seen from above


def clustered(n: int) -> np.ndarray:
    """n + 1 numbers from 0 to 1, closer together towards 1, where a hull has its edge."""
    u = np.linspace(0.0, 1.0, n + 1)
    return 0.5 * u + 0.5 * np.sin(math.pi / 2 * u)


def symmetric(n: int) -> np.ndarray:
    """2 n + 1 numbers from -1 to 1, closer together at both ends."""
    half = clustered(n)
    return np.concatenate([-half[:0:-1], half])


def mesh_of(patches: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and quadrilaterals of patches (rows, columns, 3), each with rows cross columns pointing outward."""
    vertices, faces, start = [], [], 0
    for patch in patches:
        rows, columns = patch.shape[:2]
        i, j = np.meshgrid(np.arange(rows - 1), np.arange(columns - 1), indexing="ij")
        a = (start + i * columns + j).ravel()
        faces.append(np.stack([a, a + columns, a + columns + 1, a + 1], axis=1))
        vertices.append(patch.reshape(-1, 3))
        start += rows * columns
    return np.concatenate(vertices), np.concatenate(faces)


def panels(size: float, least: int, most: int) -> int:
    """Panels along half an edge of this size, about one for each 0.12."""
    return int(min(max(round(size / 0.12), least), most))


def box(aspect: float, draft: float) -> tuple[np.ndarray, np.ndarray]:
    """The wet surface of a box."""
    x, y = math.sqrt(aspect), 1 / math.sqrt(aspect)
    xs, ys = x * symmetric(panels(x, 7, 13)), y * symmetric(panels(y, 5, 8))
    zs = -draft * clustered(panels(draft, 3, 11))

    def side(points: np.ndarray, place) -> np.ndarray:
        return np.array([[place(p, z) for z in zs] for p in points])

    bottom = np.array([[(a, b, -draft) for a in xs] for b in ys])
    return mesh_of([
        bottom,
        side(ys, lambda p, z: (x, p, z))[::-1],
        side(ys, lambda p, z: (-x, p, z)),
        side(xs, lambda p, z: (p, y, z)),
        side(xs, lambda p, z: (p, -y, z))[::-1],
    ])  # fmt: skip


def turned(radius: np.ndarray, z: np.ndarray, spokes: int = 40) -> tuple[np.ndarray, np.ndarray]:
    """The surface of a curve (radius, z), from the waterline down to the axis, turned about z."""
    angle = 2 * math.pi / spokes * np.arange(spokes + 1)
    radius = radius * math.sqrt(2 * math.pi / spokes / math.sin(2 * math.pi / spokes))  # keeps the area of the cuts
    patch = np.stack([np.outer(np.cos(angle), radius), np.outer(np.sin(angle), radius), np.tile(z, (spokes + 1, 1))], 2)
    return mesh_of([patch[::-1]])


def cylinder(_: float, draft: float) -> tuple[np.ndarray, np.ndarray]:
    """The wet surface of an upright cylinder of radius 1."""
    wall = -draft * clustered(panels(draft, 3, 11))
    floor = clustered(9)[::-1][1:]
    return turned(np.concatenate([np.ones(len(wall)), floor]), np.concatenate([wall, np.full(len(floor), -draft)]))


def sphere(_: float, draft: float) -> tuple[np.ndarray, np.ndarray]:
    """The wet surface of a sphere of radius 1."""
    waterline = math.acos(draft - 1.0)  # its angle from the top of the sphere
    polar = waterline + (math.pi - waterline) * np.linspace(0.0, 1.0, 19)
    return turned(np.sin(polar), np.cos(polar) + 1.0 - draft)


def table(name: str) -> dict[str, np.ndarray]:
    """All solutions of one shape."""
    aspects = ASPECTS if name == "box" else (1.0,)
    drafts = SPHERE_DRAFTS if name == "sphere" else DRAFTS
    directions = QUARTER if name == "box" else AHEAD
    shape = {"box": box, "cylinder": cylinder, "sphere": sphere}[name]
    found: list[list[Solution]] = []
    for aspect in aspects:
        found.append([])
        for draft in drafts:
            vertices, faces = shape(aspect, draft)
            found[-1].append(solve(vertices, faces, directions))
            print(f"{name}, sides 1:{aspect:g}, draft {draft:g}: {len(faces)} panels", flush=True)
    stacked = {
        field: np.array([[getattr(solution, field) for solution in row] for row in found]) for field in Solution._fields
    }
    small = {
        key: value.astype(np.complex64 if np.iscomplexobj(value) else np.float32) for key, value in stacked.items()
    }
    return small | {
        "aspect": np.array(aspects), "draft": np.array(drafts), "direction": directions,
        "frequency": np.array(FREQUENCIES),
    }  # fmt: skip


if __name__ == "__main__":
    for asked in sys.argv[1:] or ("box", "cylinder", "sphere"):
        np.savez_compressed(Path(__file__).with_name(f"{asked}.npz"), **table(asked))  # type: ignore[arg-type]
