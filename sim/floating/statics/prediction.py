"""Hydrostatic prediction for a hull: the numbers that a scene shows beside its measured ones."""

import math
from typing import NamedTuple

from sim.floating.hulls.hull import Hull
from sim.floating.linear.hydrodynamics import outside_table
from sim.floating.linear.periods import heave_period_at
from sim.floating.statics.equilibrium import Layers, equilibrium_draft
from sim.validation import check_positive


class HydrostaticPrediction(NamedTuple):
    """Hydrostatic prediction for an upright hull at rest."""

    draft: float  # [m] of the lowest point below the surface; inf: it sinks
    draft_in_water: float  # [m] in clean water; inf: it sinks
    height: float  # [m] of the hull
    period: float  # [s] of small heave, with added mass; inf: no force restores
    outside: str = ""  # its place outside the table of linear coefficients, in words


def predict(hull: Hull, density: float, layers: Layers, water_density: float) -> HydrostaticPrediction:
    """The prediction for a hull of `density` [kg/m3] in layers (density [kg/m3], thickness [m]) from the top.

    water_density [kg/m3]: of clean water, for comparison. Raises ValueError as `equilibrium_draft`.
    """
    check_positive("water_density", water_density, "kg/m3")
    draft = equilibrium_draft(hull, density, layers)
    return HydrostaticPrediction(
        draft=draft,
        draft_in_water=equilibrium_draft(hull, density, ((water_density, math.inf),)),
        height=float(hull.extents[2, 1] - hull.extents[2, 0]),
        period=heave_period_at(hull, density, layers, draft),
        outside=outside_table(hull, draft),
    )
