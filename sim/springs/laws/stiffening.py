"""A spring that stiffens with its strain e = l/d - 1: tension k d (e + c e^3), of Duffing's equation.

DLMF 22.19(ii) has the free motion of a mass on it in closed form.
"""

from typing import Any, NamedTuple

import numpy as np

from sim.jit import kernel
from sim.springs.laws.record import Law


class Stiffening(NamedTuple):
    """Number of the stiffening law."""

    cubic: float = 100.0  # c: at a strain of 0.1 it pulls twice as hard as a linear spring


@kernel(inline=True)
def force_density(law, k, rest, length):
    strain = length / rest - 1.0
    return (k - k * rest / length) * (1.0 + law.cubic * strain * strain)


@kernel(inline=True)
def stiffness(law, k, rest, length):
    strain = length / rest - 1.0
    return k + 3.0 * k * law.cubic * strain * strain


@kernel(inline=True)
def energy(law, k, rest, length):
    strain = length / rest - 1.0
    return 0.5 * k * (length - rest) ** 2 * (1.0 + 0.5 * law.cubic * strain * strain)


def length(law: Stiffening, k: float, rest: float, tension: Any) -> Any:
    """The real root of c e^3 + e = T/(k d), by the hyperbolic sine (DLMF 1.11(iii))."""
    load = tension / (k * rest)
    if law.cubic == 0.0:
        return rest * (1.0 + load)
    scale = np.sqrt(3.0 * law.cubic)
    return rest * (1.0 + 2.0 / scale * np.sinh(np.arcsinh(1.5 * scale * load) / 3.0))


LAW = Law("stiffening", "Stiffens with its strain", Stiffening(), force_density, stiffness, energy, length)
