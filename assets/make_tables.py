"""Makes sim/floating/tables: linear coefficients of boxes, cylinders and spheres afloat in deep water.

python -m assets.make_tables [box cylinder sphere]    (needs the extra `bem`; half an hour on one core)

A box, or a cylinder with its axis upright, is to the water only its wet part. So the tables go by draft, and of boxes
by the ratio of their sides. Lengths are in units of half the root of length times width of a box, and of the radius
of the others.
"""

import sys
from pathlib import Path

import numpy as np

from assets.shape_panels import PANELS
from sim.floating.linear.boundary_elements import FREQUENCIES, Solution, solve

TABLES = Path(__file__).parents[1] / "sim" / "floating" / "tables"
ASPECTS = (1.0, 1.5, 2.5, 5.0)  # of the sides of a box
DRAFTS = (0.06, 0.15, 0.3, 0.5, 0.75, 1.1, 1.7, 2.7, 4.2)  # of a box and a cylinder
SPHERE_DRAFTS = (0.15, 0.3, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 1.9)
QUARTER = np.radians(np.arange(0.0, 91.0, 10.0))  # directions of waves; the other three quarters are mirrored
AHEAD = np.zeros(1)  # for what is round seen from above


def table(name: str) -> dict[str, np.ndarray]:
    """All solutions of one shape."""
    aspects = ASPECTS if name == "box" else (1.0,)
    drafts = SPHERE_DRAFTS if name == "sphere" else DRAFTS
    directions = QUARTER if name == "box" else AHEAD
    found: list[list[Solution]] = []
    for aspect in aspects:
        found.append([])
        for draft in drafts:
            vertices, faces = PANELS[name](aspect, draft)
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
        np.savez_compressed(TABLES / f"{asked}.npz", **table(asked))  # type: ignore[arg-type]
