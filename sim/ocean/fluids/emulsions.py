"""Viscosity of a mixture of two fluids: emulsions of drops in a continuous fluid, and true solutions.

Oil and water do not dissolve in each other. Stirred, one of them forms drops in the other: oil in water, thin, or
water in oil, the "mousse" of real spills, which is 10 to 1000 times as viscous as the oil. Choose `pal_rhodes` for
either; `mooney` is the older law for water in oil, `taylor` holds for few drops only. The laws of solutions are for
oils among themselves, and for the lab's reading of "entirely mixed".

Each law of emulsions declares the fraction of drops up to which it was found to hold; beyond its pole it raises.
Mooney's and Pal and Rhodes's drops are as stiff as solids, so that they resist too much where they are few and thin.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

from sim.validation import argument_error, check_number, check_positive

MOONEY_CROWDING = 0.65  # of water drops in oil (Mackay and others 1980)
PAL_RHODES_DROPS = 0.84  # drops that make an emulsion 100 times as viscous (NOAA's PyGNOME, for water in oil)
PAL_RHODES_POLE = 1.187


class MixtureLaw(NamedTuple):
    """A law for the viscosity of a mixture."""

    viscosity: Callable[[float, float, float], float]  # (of drops, of the other fluid, fraction of drops) -> viscosity
    is_emulsion: bool  # and no solution, in which neither fluid is the continuous one
    max_drops: float  # fraction of drops, by volume, up to which the law holds


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


def mooney(dispersed: float, continuous: float, fraction: float) -> float:
    """An emulsion of drops that crowd each other (Mooney 1951, J. Colloid Sci. 6:162).

    mu = mu_c exp(2.5 phi/(1 - c phi)), c = 0.65 for water in oil (Mackay and others 1980). The drops count as solid.
    """
    phi = _checked(dispersed, continuous, fraction)
    return continuous * math.exp(2.5 * phi / (1.0 - MOONEY_CROWDING * phi))


def pal_rhodes(dispersed: float, continuous: float, fraction: float) -> float:
    """An emulsion, thick or thin (Pal and Rhodes 1989, J. Rheol. 33:1021).

    mu = mu_c [1 + x/(1.187 - x)]^2.49, x = phi/phi_100; phi_100, which makes it 100 times as viscous, is measured:
    0.84 in PyGNOME for water in oil, taken here for oil in water too. Raises ValueError from x = 1.187 on.
    """
    phi = _checked(dispersed, continuous, fraction)
    return continuous * pal_rhodes_factor(phi)


def pal_rhodes_factor(fraction: float) -> float:
    """Ratio of the emulsion's viscosity to that of the continuous fluid: `pal_rhodes`."""
    x = fraction / PAL_RHODES_DROPS
    if not x < PAL_RHODES_POLE:
        raise argument_error("fraction", fraction, f"below {PAL_RHODES_POLE * PAL_RHODES_DROPS:.3g}")
    return (1.0 + x / (PAL_RHODES_POLE - x)) ** 2.49


MIXTURE_LAWS = {
    "pal_rhodes": MixtureLaw(pal_rhodes, True, PAL_RHODES_DROPS),
    "mooney": MixtureLaw(mooney, True, 0.8),
    "taylor": MixtureLaw(taylor, True, 0.1),
    "arrhenius": MixtureLaw(arrhenius, False, 1.0),
    "kendall_monroe": MixtureLaw(kendall_monroe, False, 1.0),
}


def _checked(first: float, second: float, fraction: float) -> float:
    check_positive("first", first, "")
    check_positive("second", second, "")
    return check_number("fraction", fraction, "", 0.0, 1.0)
