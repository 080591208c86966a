"""Shapes of floating bodies: one file each, found by being in this folder.

To add one, write a file here with `SHAPE = Shape(name, build, lengths)`: `build(*lengths)` returns a `ClosedMesh`
(see `closed_mesh`), and `lengths` [m] are those of a body of size 1. The radial sea, its command line, table and
sweeps then have it. Everything else that `Shape` (record.py) holds is optional: closed forms instead of integrals
over the mesh, the form for collisions, and a GLB model to draw instead of the mesh.
"""

import importlib
import pkgutil

from sim.floating.shapes.record import Appearance, Immersed, Shape

__all__ = ["SHAPES", "Appearance", "Immersed", "Shape"]


def _discover() -> dict[str, Shape]:
    """Name -> shape of every file of this folder, in the order that the shapes declare."""
    shapes: list[Shape] = []
    for module in pkgutil.iter_modules(__path__):
        shape = getattr(importlib.import_module(f"{__name__}.{module.name}"), "SHAPE", None)
        if isinstance(shape, Shape):
            shapes.append(shape)
    return {shape.name: shape for shape in sorted(shapes, key=lambda shape: (shape.order, shape.name))}


SHAPES = _discover()
