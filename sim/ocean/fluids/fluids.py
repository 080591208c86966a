"""Fluids: water, oils and mixtures of two, with their reflectance.

Viscosity of mixtures: `sim.ocean.fluids.emulsions`. Oil data and their source: oils.csv.
"""

import csv
import math
from functools import cache
from importlib.resources import files
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sim.ocean.fluids.emulsions import MIXTURE_LAWS
from sim.validation import argument_error, as_array, check_number, check_positive


class Fluid(NamedTuple):
    """A liquid at 15 C."""

    name: str
    density: float  # [kg/m3]
    viscosity: float  # dynamic [Pa s]
    surface_tension: float | None  # against air [N/m]; None: not measured
    interface_tension: float | None  # against sea water [N/m]
    refractive_index: float
    colour: str  # "#rrggbb" of a thick layer, for drawing

    @property
    def kinematic_viscosity(self) -> float:
        """nu = mu/rho [m2/s]."""
        return self.viscosity / self.density


@cache
def oil_rows() -> list[dict[str, str]]:
    """The rows of oils.csv."""
    lines = files("sim.ocean").joinpath("oils.csv").read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


@cache
def fluids() -> dict[str, Fluid]:
    """All fluids of oils.csv by name, water first."""
    by_name = {}
    for row in oil_rows():
        tensions = [float(row[c]) * 1e-3 if row[c] else None for c in ("surface_tension", "interface_tension")]
        density = float(row["density"])
        index = float(row["refractive_index"]) if row["refractive_index"] else oil_index(density)
        by_name[row["name"]] = Fluid(
            row["name"], density, float(row["viscosity"]) * 1e-3, tensions[0], tensions[1], index, row["colour"]
        )
    return by_name


def oil_index(density: float) -> float:
    """Refractive index by the one-third rule (n^2 - 1)/(n^2 + 2) = rho/3, rho [g/cm3] (Vargas and Chapman 2010).

    density [kg/m3], above 0 and under 2000. Raises ValueError otherwise.
    """
    third = check_number("density", density, "kg/m3", 1.0, 2000.0) / 3000.0
    return math.sqrt((1.0 + 2.0 * third) / (1.0 - third))


def mixed_density(first: float, second: float, fraction: float) -> float:
    """rho [kg/m3] = phi rho1 + (1 - phi) rho2, fraction phi by volume of the first."""
    phi = check_number("fraction", fraction, "", 0.0, 1.0)
    return phi * check_positive("first", first, "kg/m3") + (1.0 - phi) * check_positive("second", second, "kg/m3")


def mixed(
    first: Fluid, second: Fluid, fraction: float, law: str = "pal_rhodes", continuous: Fluid | None = None
) -> Fluid:
    """The two entirely mixed, `fraction` by volume of the first; index and colour of the more plentiful one.

    law: one of MIXTURE_LAWS. continuous: the fluid that an emulsion's drops are in, which has its tensions; by default
    the more plentiful one. Raises ValueError for another law or fluid, a fraction outside 0 to 1, or more drops than
    the law has numbers for.
    """
    if law not in MIXTURE_LAWS:
        raise argument_error("law", law, "one of " + ", ".join(MIXTURE_LAWS))
    if continuous not in (None, first, second):
        raise argument_error("continuous", continuous.name, f"{first.name} or {second.name}")
    more = first if fraction > 0.5 else second
    outside = continuous or more
    inside, drops = (second, 1.0 - fraction) if outside is first else (first, fraction)
    return more._replace(
        name=f"{fraction:.0%} {first.name} in {second.name}",
        density=mixed_density(first.density, second.density, fraction),
        viscosity=MIXTURE_LAWS[law].viscosity(inside.viscosity, outside.viscosity, drops),
        surface_tension=outside.surface_tension,
        interface_tension=outside.interface_tension,
    )


class Reflectance(NamedTuple):
    """Fraction of light reflected, by polarisation and for unpolarised light."""

    s: np.ndarray
    p: np.ndarray

    @property
    def mean(self) -> np.ndarray:
        return 0.5 * (self.s + self.p)


def fresnel(angle: ArrayLike, index: float) -> Reflectance:
    """Exact reflectance of a surface of refractive index (1 or above) at an angle from its normal, 0 to pi/2 [rad].

    Raises ValueError for an index under 1, or an angle that is not allowed.
    Fresnel's equations: Hecht, Optics, eq. 4.34 and 4.40, squared.
    """
    check_number("index", index, "", 1.0, 10.0)
    allowed = "0 to pi/2 rad"
    angles = as_array("angle", angle, allowed)
    bad = ~((angles >= 0.0) & (angles <= 0.5 * math.pi))
    if bad.any():
        raise argument_error("angle", float(angles[bad].flat[0]), allowed)
    cosine = np.cos(angles)
    inner = np.sqrt(1.0 - (1.0 - cosine**2) / index**2)
    s = ((cosine - index * inner) / (cosine + index * inner)) ** 2
    p = ((index * cosine - inner) / (index * cosine + inner)) ** 2
    return Reflectance(s[()], p[()])


def normal_reflectance(index: float) -> float:
    """R0 = ((n - 1)/(n + 1))^2."""
    return ((check_number("index", index, "", 1.0, 10.0) - 1.0) / (index + 1.0)) ** 2


def diffuse_reflectance(index: float) -> float:
    """Reflectance under light from the whole upper hemisphere: integral of 2 R cos sin over 0 to pi/2."""
    nodes, weights = np.polynomial.legendre.leggauss(64)
    angle = 0.25 * math.pi * (nodes + 1.0)
    return float((weights * 0.25 * math.pi * fresnel(angle, index).mean * np.sin(2.0 * angle)).sum())
