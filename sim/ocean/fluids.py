"""Fluids: water, oils, what a mixture of two amounts to, and how much light they reflect.

Choose `taylor` for oil and water, which do not dissolve in each other; the other laws are for oils among themselves
and for the lab's reading of "entirely mixed". Oil data and their source: assets/oils.csv.
"""

import csv
import math
from functools import cache
from importlib.resources import files
from typing import NamedTuple

import numpy as np

from sim.validation import argument_error, as_array, check_positive, check_within


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
def fluids() -> dict[str, Fluid]:
    """All fluids of assets/oils.csv by name, water first."""
    lines = files("assets").joinpath("oils.csv").read_text(encoding="utf-8").splitlines()
    found = {}
    for row in csv.DictReader(line for line in lines if not line.startswith("#")):
        tensions = [float(row[c]) * 1e-3 if row[c] else None for c in ("surface_tension", "interface_tension")]
        density = float(row["density"])
        index = float(row["refractive_index"]) if row["refractive_index"] else oil_index(density)
        found[row["name"]] = Fluid(
            row["name"], density, float(row["viscosity"]) * 1e-3, tensions[0], tensions[1], index, row["colour"]
        )
    return found


def oil_index(density: float) -> float:
    """Refractive index by the one-third rule (n^2 - 1)/(n^2 + 2) = rho/3, rho [g/cm3] (Vargas and Chapman 2010).

    density [kg/m3], above 0 and under 2000. Raises ValueError otherwise.
    """
    third = check_within("density", density, 1.0, 2000.0, "kg/m3") / 3000.0
    return math.sqrt((1.0 + 2.0 * third) / (1.0 - third))


def mixed_density(first: float, second: float, fraction: float) -> float:
    """rho [kg/m3] = phi rho1 + (1 - phi) rho2, fraction phi by volume of the first."""
    phi = check_within("fraction", fraction, 0.0, 1.0)
    return phi * check_positive("first", first, "kg/m3") + (1.0 - phi) * check_positive("second", second, "kg/m3")


def arrhenius(first: float, second: float, fraction: float) -> float:
    """ln mu = phi ln mu1 + (1 - phi) ln mu2; viscosities in any one unit. Raises ValueError unless above 0."""
    return grunberg_nissan(first, second, fraction, 0.0)


def grunberg_nissan(first: float, second: float, fraction: float, interaction: float) -> float:
    """Arrhenius's law with phi (1 - phi) G12 added (Grunberg and Nissan 1949, Nature 164:799)."""
    phi = _checked(first, second, fraction)
    return math.exp(phi * math.log(first) + (1.0 - phi) * math.log(second) + phi * (1.0 - phi) * interaction)


def kendall_monroe(first: float, second: float, fraction: float) -> float:
    """mu^(1/3) = phi mu1^(1/3) + (1 - phi) mu2^(1/3) (Kendall and Monroe 1917)."""
    phi = _checked(first, second, fraction)
    return (phi * first ** (1.0 / 3.0) + (1.0 - phi) * second ** (1.0 / 3.0)) ** 3


def taylor(dispersed: float, continuous: float, fraction: float) -> float:
    """An emulsion of drops, fraction phi by volume, in the continuous fluid (Taylor 1932, Proc. R. Soc. A 138:41).

    mu = mu_c [1 + 2.5 phi (l + 0.4)/(l + 1)], l = mu_d/mu_c; of first order in phi. Einstein's 1 + 2.5 phi for solids.
    """
    phi = _checked(dispersed, continuous, fraction)
    ratio = dispersed / continuous
    return continuous * (1.0 + 2.5 * phi * (ratio + 0.4) / (ratio + 1.0))


def emulsion(first: float, second: float, fraction: float) -> float:
    """Taylor's law with the more plentiful fluid as the continuous one: what "mixed" oil and water become."""
    if fraction <= 0.5:
        return taylor(first, second, fraction)
    return taylor(second, first, 1.0 - fraction)


MIXTURE_LAWS = {"arrhenius": arrhenius, "kendall_monroe": kendall_monroe, "taylor": emulsion}


def mixed(first: Fluid, second: Fluid, fraction: float, law: str = "taylor") -> Fluid:
    """The two entirely mixed, `fraction` by volume of the first; tensions, index and colour of the more plentiful one.

    law: one of MIXTURE_LAWS. Raises ValueError for another, or a fraction outside 0 to 1.
    """
    if law not in MIXTURE_LAWS:
        raise argument_error("law", law, "one of " + ", ".join(MIXTURE_LAWS))
    more = first if fraction > 0.5 else second
    return more._replace(
        name=f"{fraction:.0%} {first.name} in {second.name}",
        density=mixed_density(first.density, second.density, fraction),
        viscosity=MIXTURE_LAWS[law](first.viscosity, second.viscosity, fraction),
    )


class Reflectance(NamedTuple):
    """Share of light reflected, by polarisation and for unpolarised light."""

    s: np.ndarray
    p: np.ndarray

    @property
    def mean(self) -> np.ndarray:
        return 0.5 * (self.s + self.p)


def fresnel(angle, index: float) -> Reflectance:
    """Exact reflectance of a surface of refractive index (1 or above) at an angle from its normal, 0 to pi/2 [rad].

    Raises ValueError for an index under 1, or an angle that is not allowed.
    Fresnel's equations: Hecht, Optics, eq. 4.34 and 4.40, squared.
    """
    check_within("index", index, 1.0, 10.0)
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
    return ((check_within("index", index, 1.0, 10.0) - 1.0) / (index + 1.0)) ** 2


def diffuse_reflectance(index: float) -> float:
    """Reflectance under light from the whole upper hemisphere: integral of 2 R cos sin over 0 to pi/2."""
    nodes, weights = np.polynomial.legendre.leggauss(64)
    angle = 0.25 * math.pi * (nodes + 1.0)
    return float((weights * 0.25 * math.pi * fresnel(angle, index).mean * np.sin(2.0 * angle)).sum())


def brewster_angle(index: float) -> float:
    """Angle [rad] at which p-polarised light is not reflected: arctan n."""
    return math.atan(check_within("index", index, 1.0, 10.0))


def _checked(first: float, second: float, fraction: float) -> float:
    check_positive("first", first, "")
    check_positive("second", second, "")
    return check_within("fraction", fraction, 0.0, 1.0)
