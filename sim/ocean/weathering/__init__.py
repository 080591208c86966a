"""Weathering of an oil spill over hours and days: spreading, evaporation, uptake of water, dispersion into drops.

The laws and constants are those of NOAA's PyGNOME (and its predecessor ADIOS2): `laws.py`, each with its source. An oil
is a mixture of pseudo-components made from its distillation: `components.py`. `spill.py` steps them in time.
"""

from sim.ocean.weathering.components import (
    OilRecord,
    PseudoComponents,
    can_weather,
    oil_at,
    oil_records,
    pseudo_components,
)
from sim.ocean.weathering.spill import Spill, WeatheredOil, Weathering, weather

__all__ = [
    "OilRecord", "PseudoComponents", "Spill", "WeatheredOil", "Weathering", "can_weather", "oil_at", "oil_records",
    "pseudo_components", "weather",
]  # fmt: skip
