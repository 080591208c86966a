"""A spill over hours: its state from the moment of the spill to five days later, by the laws of `laws.py`."""

import dataclasses
import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.interruption import raise_if_stopped
from sim.ocean.fluids.fluids import Fluid, fluids, mixed_density, oil_index
from sim.ocean.weathering import laws
from sim.ocean.weathering.components import (
    CELSIUS,
    can_weather,
    check_oil,
    density_at,
    oil_records,
    pseudo_components,
    viscosity_at,
)
from sim.validation import argument_error, check_choice, check_kind, check_number

WATERS = ("sea water", "fresh water")
HOUR = 3600.0  # [s]
MAX_HOURS = 120.0  # [h] that a spill is followed
FIRST_STEP, STEP_GROWTH, MAX_STEP = 5.0, 1.06, 900.0  # [s] of the steps of time: short ones first
MAX_DENSITY = 0.999  # of an emulsion, over the water's: heavier ones would sink, for which there is no law here
GONE = 1e-6  # fraction of the oil below which nothing is left
MOUSSE_COLOUR = np.array([0x7A, 0x42, 0x1E])  # of an emulsion with much water: brown, chosen for drawing


@dataclasses.dataclass(frozen=True, kw_only=True)
class Spill:
    """Oil spilled at once.

    Raises ValueError for a value that is not allowed, or an oil without data on evaporation in its record.
    """

    oil: str = "Alaska North Slope 2002"
    volume: float = 100.0  # [m3]
    wind_speed: float = 7.0  # [m/s] 10 m above the sea
    temperature: float = 15.0  # [C] of oil and water
    water: str = "sea water"

    def __post_init__(self) -> None:
        if not can_weather(check_oil(self.oil)):
            raise argument_error("oil", self.oil, "an oil with a distillation in its record, or a crude oil")
        check_choice("water", self.water, WATERS)
        check_number("volume", self.volume, "m3", 0.0, 1e7, above=True)
        check_number("wind_speed", self.wind_speed, "m/s", 0.0, 60.0)
        check_number("temperature", self.temperature, "C", -2.0, 40.0)


class WeatheredOil(NamedTuple):
    """The spill at one moment. Fractions are of the mass spilled; evaporated + dispersed + remaining = 1."""

    hours: float  # [h] since the spill
    evaporated: float
    dispersed: float  # taken down by breaking waves
    remaining: float  # on the sea
    water_content: float  # fraction of water in the emulsion, by volume
    area: float  # [m2]
    thickness: float  # [m] of the emulsion
    oil_density: float  # [kg/m3] without the water in it
    density: float  # [kg/m3] of the emulsion
    viscosity: float  # [m2/s] of the emulsion, kinematic
    drift: float  # [m] downwind

    def fluid(self, oil: str) -> Fluid:
        """The emulsion as a fluid to float on water: tensions are those of the fresh oil, the index that of its oil."""
        fresh = fluids()[oil]
        return fresh._replace(
            name=f"{fresh.name}, {self.hours:g} h old",
            density=self.density,
            viscosity=self.viscosity * self.density,
            refractive_index=oil_index(self.oil_density),
            colour=blend_colour(fresh.colour, self.water_content),
        )


class Weathering(NamedTuple):
    """A spill over time: arrays (n,) over `hours`, named as in `WeatheredOil`."""

    spill: Spill
    hours: NDArray[np.float64]
    evaporated: NDArray[np.float64]
    dispersed: NDArray[np.float64]
    water_content: NDArray[np.float64]
    area: NDArray[np.float64]
    oil_density: NDArray[np.float64]
    fresh_density: float  # [kg/m3]
    fresh_viscosity: float  # [m2/s]
    water_density: float  # [kg/m3]

    @property
    def remaining(self) -> NDArray[np.float64]:
        """Fraction on the sea."""
        return np.maximum(1.0 - self.evaporated - self.dispersed, 0.0)

    def at(self, hours: float) -> WeatheredOil:
        """The spill after a number of hours. Raises ValueError outside 0 to 120 h."""
        h = check_number("hours", hours, "h", 0.0, MAX_HOURS)
        evaporated, dispersed, water, area, oil_density = (
            float(np.interp(h, self.hours, values))
            for values in (self.evaporated, self.dispersed, self.water_content, self.area, self.oil_density)
        )
        remaining = max(1.0 - evaporated - dispersed, 0.0)
        volume = self.spill.volume * self.fresh_density * remaining / oil_density / (1.0 - water)
        density = min(mixed_density(self.water_density, oil_density, water), MAX_DENSITY * self.water_density)
        return WeatheredOil(
            hours=h,
            evaporated=evaporated,
            dispersed=dispersed,
            remaining=remaining,
            water_content=water,
            area=area,
            thickness=volume / area,
            oil_density=oil_density,
            density=density,
            viscosity=self.fresh_viscosity * laws.viscosity_factor(self.fresh_viscosity, evaporated, water),
            drift=laws.drift_speed(self.spill.wind_speed) * h * HOUR,
        )

    def exposure(self, hours: float) -> float:
        """Stiver and Mackay's exposure K A t/V after a number of hours, with the area as it grew."""
        times = np.append(self.hours[self.hours < hours], hours) * HOUR
        areas = np.interp(times, self.hours * HOUR, self.area)
        transfer = 0.0025 * max(self.spill.wind_speed, laws.MIN_WIND) ** 0.78
        return transfer * float(np.trapezoid(areas, times)) / self.spill.volume


def blend_colour(colour: str, water: float) -> str:
    """The colour "#rrggbb" of an oil with a fraction of water in it: it turns brown."""
    fresh = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)])
    red, green, blue = np.rint(fresh + water * (MOUSSE_COLOUR - fresh)).astype(int).tolist()
    return f"#{red:02x}{green:02x}{blue:02x}"


def steps() -> NDArray[np.float64]:
    """The times [s] of the steps, from 0 to 120 h."""
    times, step = [0.0], FIRST_STEP
    while times[-1] < MAX_HOURS * HOUR:
        times.append(min(times[-1] + step, MAX_HOURS * HOUR))
        step = min(step * STEP_GROWTH, MAX_STEP)
    return np.array(times)


class SpillState(NamedTuple):
    """State of the spill at one time."""

    mass: NDArray[np.float64]  # (n,) [kg] of each part of the oil on the sea
    evaporated: float  # [kg]
    dispersed: float  # [kg]
    area: float  # [m2]
    onset: float  # [s] when it began to take up water; inf before


def weather(spill: Spill) -> Weathering:
    """The spill from 0 to 120 h, by exponential midpoint steps: fractions within 0.1 % of the laws' solution.

    Raises ValueError if it is not a spill.

    >>> day = weather(Spill(oil="Alaska North Slope 2002", volume=100.0, wind_speed=7.0)).at(24.0)
    >>> round(day.evaporated, 2), round(day.dispersed, 2)
    (0.33, 0.46)
    """
    return weathered(check_kind("spill", spill, Spill, "a Spill"))


@lru_cache(maxsize=64)
def weathered(spill: Spill) -> Weathering:
    """The same of a checked spill."""
    parts = pseudo_components(spill.oil)
    record, water_density = oil_records()[spill.oil], fluids()[spill.water].density
    fresh_density, viscosity = density_at(spill.oil, spill.temperature), viscosity_at(spill.oil, spill.temperature)
    light = laws.lightness(fresh_density, water_density)
    total = spill.volume * fresh_density
    largest = spill.volume / laws.least_thickness(viscosity)
    first_area, start = laws.initial_area(spill.volume, light)
    scale = fresh_density / float((parts.share * parts.density).sum())
    volatile = laws.volatility(parts, CELSIUS + spill.temperature)

    def water_of(state: SpillState, t: float) -> float:
        return laws.water_content(t - state.onset, spill.wind_speed, record.emulsion_water)

    def step(state: SpillState, rates_of: SpillState, t: float, rates_at: float, h: float) -> SpillState:
        """From `state` at t on by h [s], at the rates of another state at another time [s]."""
        if rates_of.mass.sum() < GONE * total:  # a half step used up all: the earlier rates act on the rest
            rates_of, rates_at = state, t
        left = float(rates_of.mass.sum())
        water = water_of(rates_of, rates_at)
        evaporation = laws.evaporation_rates(parts, volatile, rates_of.mass, rates_of.area, water, spill.wind_speed)
        thick = viscosity * laws.viscosity_factor(viscosity, rates_of.evaporated / total, water)
        loss = laws.dispersion_rate(rates_of.area, thick, water, spill.wind_speed, water_density)
        dispersion = loss / left
        gone = -state.mass * np.expm1(-(evaporation + dispersion) * h)
        share = evaporation / (evaporation + dispersion)
        evaporated = state.evaporated + float((gone * share).sum())
        grows = max(t + h - max(start, t), 0.0)
        area = min(state.area + grows * laws.area_growth(rates_of.area, spill.volume, light), largest)
        onset = state.onset
        if onset == math.inf and evaporated >= record.emulsion_onset * total:
            before, after = state.evaporated, evaporated
            wanted = record.emulsion_onset * total
            onset = t + h * ((wanted - before) / (after - before) if after > before else 0.0)
        dispersed = state.dispersed + float((gone * (1.0 - share)).sum())
        return SpillState(state.mass - gone, evaporated, dispersed, area, onset)

    times = steps()
    state = SpillState(total * parts.share, 0.0, 0.0, min(first_area, largest), math.inf)
    rows = np.empty((len(times), 5))
    for i, t in enumerate(times):
        raise_if_stopped()
        left = float(state.mass.sum())
        if left < GONE * total:
            rows[i:] = rows[i - 1]
            rows[i:, :2] = state.evaporated / total, state.dispersed / total
            break
        dense = scale * float((state.mass * parts.density).sum()) / left
        rows[i] = state.evaporated / total, state.dispersed / total, water_of(state, t), state.area, dense
        if i + 1 < len(times):
            h = float(times[i + 1] - t)
            half = step(state, state, t, t, 0.5 * h)
            state = step(state, half, t, t + 0.5 * h, h)
    evaporated, dispersed, water, area, oil_density = rows.T
    return Weathering(
        spill, times / HOUR, evaporated, dispersed, water, area, oil_density, fresh_density, viscosity, water_density
    )
