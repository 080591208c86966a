"""Weathering of an oil spill over hours and days: spreading, evaporation, uptake of water, dispersion into drops.

from sim.ocean.weathering import Spill, weather
day = weather(Spill(oil="Alaska North Slope 2002", volume=100.0, wind_speed=7.0)).at(24.0)
day.evaporated, day.dispersed, day.remaining, day.water_content, day.area, day.viscosity

The laws and constants are those of NOAA's PyGNOME (and its predecessor ADIOS2): `laws.py`, each with its source. An oil
is a mixture of pseudo-components made from its distillation: `components.py`. `spill.py` lets time pass.
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
    "OilRecord",
    "PseudoComponents",
    "Spill",
    "WeatheredOil",
    "Weathering",
    "can_weather",
    "oil_at",
    "oil_records",
    "pseudo_components",
    "weather",
]
