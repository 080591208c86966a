"""Lines about a mesh: its size, its volume, its draft, and a warning about an unlikely size."""

import math

import numpy as np

from sim.floating import Hull, equilibrium_draft
from sim.floating.hulls.hull import MeshReading
from sim.inputs.bounds import beyond


def hull_line(name: str, hull: Hull, density: float) -> str:
    """Size, volume and draft of a hull of a density [kg/m3] in sea water, in one line."""
    draft = equilibrium_draft(hull, density)
    rest = "sinks" if math.isinf(draft) else f"floats {draft:.3g} m deep"
    return f"{name}: {size_text(hull.size)}, {hull.volume:.4g} m3, {rest} at {density:g} kg/m3"


def size_text(size: np.ndarray) -> str:
    """Length, width and height (3,) [m] in words."""
    x, y, z = size
    return f"{x:.4g} m long, {y:.4g} m wide, {z:.4g} m high"


def size_warning(name: str, size: np.ndarray, reading: MeshReading) -> str:
    """A sentence about a hull of unlikely size (3,) [m], "" for any other."""
    longest = float(size.max())
    said = f"{name}, {longest:.4g} m long, read in {reading.unit or 'm'},"
    return "".join(
        f"{text}; --hull-unit takes m, cm, mm or ft" for text in beyond("hull", "length", longest, said=said)
    )
