"""An oil as a mixture of pseudo-components, each with a share, a boiling point, a molar mass and a density.

The method and its constants are those of NOAA's adios_db 1.2.7 (`make_gnome_oil`), which makes the oils of PyGNOME: the
distillation curve of the record, cut at eight temperatures; saturates, aromatics, resins and asphaltenes in each cut.
Crude oils without a distillation get one from their density (Jones 1997, Proc. 20th AMOP 43-62). Molar masses and
densities: Riazi, Characterization and Properties of Petroleum Fractions, eq. 2.48 with table 2.6, and eq. 2.13.
"""

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.ocean.fluids.fluids import Fluid, fluids, oil_rows
from sim.validation import check_choice, check_number

CELSIUS = 273.15  # [K]
WARM, COLD = 15.0, 0.0  # [C] of the two measurements of density and viscosity
CUT_BOUNDS = np.array([266.0, 310.0, 353.0, 483.0, 563.0, 650.0, 800.0, 950.0, 1050.0])  # [K]
SATURATE_OFFSET, SATURATE_SLOPE = 124.1069, 0.0877  # [%], [%/K] fraction of saturates in a cut, by its boiling point
RESIN_MOLAR_MASS, ASPHALTENE_MOLAR_MASS = 0.8, 1.0  # [kg/mol]
INERT_DENSITY, MAX_DENSITY = 1100.0, 1090.0  # [kg/m3] of resins and asphaltenes, and at most of the others
WATSON_SATURATES, WATSON_AROMATICS = 12.0, 10.0  # Watson's factor
WATER_60_F = 999.016  # [kg/m3], which degrees API refer to
JONES_CUTS = 5


class OilRecord(NamedTuple):
    """Data of an oil in oils.csv beyond its properties at 15 C."""

    record: str  # in NOAA's database
    is_crude: bool
    cold_density: float  # [kg/m3] at 0 C
    cold_viscosity: float  # dynamic [Pa s] at 0 C
    saturates: float | None  # shares by mass; None: not measured
    resins: float
    asphaltenes: float
    emulsion_onset: float  # share evaporated from which it takes up water; inf: it never does
    emulsion_water: float  # largest fraction of water in its emulsion; 0: it forms none
    distillation: tuple[tuple[float, float], ...]  # (share by mass that has boiled off, temperature [K])


class PseudoComponents(NamedTuple):
    """An oil's parts, (n,) each."""

    share: NDArray[np.float64]  # by mass; they sum to 1
    boiling_point: NDArray[np.float64]  # [K]
    molar_mass: NDArray[np.float64]  # [kg/mol]
    density: NDArray[np.float64]  # [kg/m3]


@cache
def oil_records() -> dict[str, OilRecord]:
    """The records of all oils by name."""
    records = {}
    for row in oil_rows():
        if not row["record"]:
            continue
        cuts = [cut.split("@") for cut in row["distillation"].split()]
        records[row["name"]] = OilRecord(
            record=row["record"],
            is_crude=row["kind"] == "crude",
            cold_density=float(row["density_0"]),
            cold_viscosity=float(row["viscosity_0"]) * 1e-3,
            saturates=float(row["saturates"]) / 100.0 if row["saturates"] else None,
            resins=float(row["resins"] or 0.0) / 100.0,
            asphaltenes=float(row["asphaltenes"] or 0.0) / 100.0,
            emulsion_onset=float(row["emulsion_onset"] or math.inf),
            emulsion_water=float(row["emulsion_water"]),
            distillation=tuple((float(share) / 100.0, float(at) + CELSIUS) for share, at in cuts),
        )
    return records


def check_oil(oil: object) -> str:
    """The name of an oil in oils.csv. Raises ValueError for another."""
    return check_choice("oil", oil, oil_records())


def density_at(oil: str, temperature: float) -> float:
    """Density [kg/m3] at -2 to 40 C: linear through those at 0 and 15 C. Raises ValueError for another oil or range."""
    warm, cold = fluids()[check_oil(oil)].density, oil_records()[oil].cold_density
    t = check_number("temperature", temperature, "C", -2.0, 40.0)
    return warm + (cold - warm) * (WARM - t) / (WARM - COLD)


def viscosity_at(oil: str, temperature: float) -> float:
    """Kinematic viscosity [m2/s] at -2 to 40 C: A exp(B/T), T [K], through those at 0 and 15 C.

    Raises ValueError for another oil or range.
    """
    record, warm = oil_records()[check_oil(oil)], fluids()[oil].kinematic_viscosity
    t = check_number("temperature", temperature, "C", -2.0, 40.0)
    inverse = [1.0 / (CELSIUS + value) for value in (COLD, WARM, t)]
    slope = math.log(record.cold_viscosity / record.cold_density / warm) / (inverse[0] - inverse[1])
    return warm * math.exp(slope * (inverse[2] - inverse[1]))


def oil_at(oil: str, temperature: float) -> Fluid:
    """The fresh oil at -2 to 40 C; its tensions, index and colour are those at 15 C. Raises as `viscosity_at` does."""
    fresh = fluids()[check_oil(oil)]
    if temperature == WARM:
        return fresh
    density = density_at(oil, temperature)
    return fresh._replace(density=density, viscosity=viscosity_at(oil, temperature) * density)


def api_gravity(oil: str) -> float:
    """Degrees API, 141.5/d - 131.5 with the density d over that of water, both at 60 F."""
    return 141.5 / (density_at(oil, 15.556) / WATER_60_F) - 131.5


def can_weather(oil: str) -> bool:
    """True if the record is enough for evaporation: a distillation, or a crude oil's density."""
    record = oil_records()[check_oil(oil)]
    return record.is_crude or bool(record.distillation)


def distillation_of(oil: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Shares by mass that have boiled off, and the temperatures [K], both (n,) and rising from 0 to 1.

    Below and above what was measured the curve continues straight, within 266 and 1050 K.
    Raises ValueError for an oil without a record.
    """
    record = oil_records()[check_oil(oil)]
    low, high = CUT_BOUNDS[0], CUT_BOUNDS[-1]
    if record.distillation:
        share, at = np.array(record.distillation).T
        low = max(low, at[0] - share[0] * (at[1] - at[0]) / (share[1] - share[0]))
        high = min(high, at[-1] + (1.0 - share[0]) * (at[-1] - at[0]) / (share[-1] - share[0]))
    else:
        check_choice("oil", oil, [name for name in oil_records() if can_weather(name)])
        api = api_gravity(oil)
        start, slope = 457.0 - 3.34 * api, 1357.0 - 247.7 * math.log(api)
        share = np.arange(1, JONES_CUTS + 1) / JONES_CUTS
        at = start + slope * np.arange(JONES_CUTS) / JONES_CUTS
    if share[-1] < 1.0:
        share, at = np.append(share, 1.0), np.append(at, high)
    if share[0] > 0.0:
        share, at = np.insert(share, 0, 0.0), np.insert(at, 0, low)
    return share, at


def boiled_off(oil: str, temperature: float) -> float:
    """Share by mass that has boiled off at a temperature [K]."""
    share, at = distillation_of(oil)
    return float(np.interp(temperature, at, share))


@cache
def pseudo_components(oil: str) -> PseudoComponents:
    """The parts of an oil. Raises ValueError for an oil without a record."""
    record = oil_records()[check_oil(oil)]
    share, at = distillation_of(oil)
    boiled = np.interp(CUT_BOUNDS, at, share)
    boiled[-1] = 1.0
    last = int(np.argmax(boiled >= 1.0))  # the cut with which all has boiled off
    cut = np.diff(boiled[: last + 1], prepend=0.0)[1:]
    cut[0] = boiled[1]  # the part that boils below the first bound counts with the first cut
    boiling = 0.5 * (CUT_BOUNDS[1:] + CUT_BOUNDS[:-1])[:last]
    boiling, cut = boiling[boiled[1 : last + 1] > 0.0], cut[boiled[1 : last + 1] > 0.0]

    slope = SATURATE_SLOPE
    if record.saturates is not None:
        slope = (SATURATE_OFFSET * cut.sum() - 100.0 * record.saturates) / (cut * boiling).sum()
    saturates = np.clip(cut * (SATURATE_OFFSET - slope * boiling) / 100.0, 0.0, cut)
    aromatics = cut - saturates
    resins, asphaltenes = np.zeros_like(cut), np.zeros_like(cut)
    if record.resins + record.asphaltenes <= aromatics.sum():
        # They are in the last cut, and count as aromatics in no cut: they are taken from the last ones.
        resins[-1], asphaltenes[-1] = record.resins, record.asphaltenes
        left = record.resins + record.asphaltenes
        for i in reversed(range(len(cut))):
            taken = min(left, aromatics[i])
            aromatics[i] -= taken
            left -= taken

    parts = np.stack([saturates, aromatics, resins, asphaltenes], axis=1).ravel()
    temperature = np.repeat(boiling, 4)
    full = np.full_like(cut, 1.0)
    molar = [
        1e-3 * (49.677 * (6.98291 - np.log(1070.0 - boiling))) ** 1.5,
        1e-3 * (44.504 * (6.911 - np.log(1015.0 - boiling))) ** 1.5,
        full * RESIN_MOLAR_MASS,
        full * ASPHALTENE_MOLAR_MASS,
    ]
    cubic = 1000.0 * (1.8 * boiling) ** (1.0 / 3.0)
    dense = [
        np.minimum(cubic / WATSON_SATURATES, MAX_DENSITY),
        np.minimum(cubic / WATSON_AROMATICS, MAX_DENSITY),
        full * INERT_DENSITY,
        full * INERT_DENSITY,
    ]
    there = parts > 0.0
    return PseudoComponents(
        parts[there],
        temperature[there],
        np.stack(molar, axis=1).ravel()[there],
        np.stack(dense, axis=1).ravel()[there],
    )
