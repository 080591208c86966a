"""Equilibrium of an upright hull in layered fluids.

Archimedes through layers of densities rho_1, rho_2, ... with tops at depths D_1 = 0, D_2, ... is a sum over
interfaces, since each one adds the pressure (rho_i - rho_{i-1}) g (depth below it):

  rho V = sum_i (rho_i - rho_{i-1}) V(h - D_i),   rho_0 = 0

with V(h) the hull's volume up to h above its lowest point: monotone in h, its derivative is the waterplane's area.
A shape with closed forms (shapes/) uses them, a mesh the exact integrals over its triangles.
"""

import math
from collections.abc import Sequence

import numpy as np

from sim.floating.hulls.closed_mesh import check_hull
from sim.floating.hulls.hull import Hull
from sim.floating.statics.hydrostatics import Submerged, submerged
from sim.numerics.root import narrowed
from sim.validation import argument_error, as_float, check_positive
from sim.water import EARTH_GRAVITY, SEA_DENSITY

Layers = Sequence[tuple[float, float]]
SEA_WATER: Layers = ((SEA_DENSITY, math.inf),)  # the default fluid of the package


def equilibrium_draft(hull: Hull, density: float, layers: Layers = SEA_WATER, gravity: float = EARTH_GRAVITY) -> float:
    """Depth [m] of the lowest point of the upright hull below the top surface, at rest in the layers.

    layers: (density [kg/m3], thickness [m]) from the top, the last of thickness inf; sea water by default. The result
    is inf for a hull denser than the last layer, which sinks without end, and the smallest depth where several are in
    equilibrium. Gravity does not change the result and is only checked. Raises ValueError for a bad density, layers or
    gravity.

    >>> from sim.floating import Hull
    >>> equilibrium_draft(Hull.box(1.0, 1.0, 1.0), 512.5)  # [m] in sea water
    0.5
    """
    check_hull("hull", hull)
    check_positive("density", density, "kg/m3")
    check_positive("gravity", gravity, "m/s2")
    layers = check_layers(layers)
    steps = density_steps(layers)
    if density > layers[-1][0]:
        return math.inf
    weight = density * hull.volume

    def excess(draft: float) -> tuple[float, float]:
        """Mass [kg] of the displaced fluids over the hull's, and its derivative [kg/m]."""
        parts = [(change, upright(hull, float(draft) - top)) for change, top in steps]
        return sum(change * part.volume for change, part in parts) - weight, sum(c * part.area for c, part in parts)

    deepest = steps[-1][1] + float(hull.extents[2, 1] - hull.extents[2, 0])
    return float(narrowed(excess, 0.0, deepest, has_slope=True)[1])


def upright(hull: Hull, height: float) -> Submerged:
    """Part of the true shape, upright, up to `height` [m] above its lowest point, about its centre of mass."""
    bottom, top = hull.extents[2]
    inside = 0 < height < top - bottom
    if hull.shape.immersed is None:
        # Where the surface would coincide with a flat top or bottom it is moved off, so that all or nothing is wet.
        return submerged(hull, surface=bottom + height if inside else (bottom - 1, top + 1)[height > 0])
    part = hull.shape.immersed(hull, min(max(height, 0.0), top - bottom))
    area, second = (part.area, part.second) if inside else (0.0, (0.0, 0.0))
    centre = np.array([0.0, 0.0, bottom + part.centroid]) if part.volume > 0 else np.full(3, np.nan)
    return Submerged(part.volume, centre, area, np.array([*second, 0.0]))


def density_steps(layers: Layers) -> list[tuple[float, float]]:
    """(rho_i - rho_{i-1}, depth of the top of layer i) of each layer. Raises ValueError for bad layers."""
    steps, above, top = [], 0.0, 0.0
    for density, thickness in check_layers(layers):
        steps.append((density - above, top))
        above, top = density, top + thickness
    return steps


def check_layers(layers: Layers) -> tuple[tuple[float, float], ...]:
    """`layers`, in any sequence, as pairs of floats. Raises ValueError for bad ones."""
    wanted = "(density, thickness) pairs from the top, densities not falling, the last thickness inf and only that"
    try:
        sequence = list(layers)
        pairs = tuple((as_float(density), as_float(thickness)) for density, thickness in sequence)
    except (TypeError, ValueError):
        raise argument_error("layers", layers, wanted) from None
    good = bool(pairs) and math.isinf(pairs[-1][1])
    above = 0.0
    for i, (density, thickness) in enumerate(pairs):
        last = i == len(pairs) - 1
        good = good and 0 < density < math.inf and density >= above
        good = good and thickness >= 0 and (last or thickness < math.inf)
        above = density
    if not good:
        raise argument_error("layers", sequence, wanted)
    return pairs
