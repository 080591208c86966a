"""Rubber, with the stretch s = l/d: tension k d/3 (s - 1/s^2) (Treloar 1975, The Physics of Rubber Elasticity)."""

from typing import Any, NamedTuple

from sim.jit import kernel
from sim.springs.laws.record import Law


class Rubber(NamedTuple):
    """Numbers of the law: none of its own."""


@kernel(inline=True)
def force_density(law, k, rest, length):
    s = length / rest
    return k / 3.0 * (1.0 - 1.0 / (s * s * s))


@kernel(inline=True)
def stiffness(law, k, rest, length):
    s = length / rest
    return k / 3.0 * (1.0 + 2.0 / (s * s * s))


@kernel(inline=True)
def energy(law, k, rest, length):
    s = length / rest
    return k * rest * rest / 3.0 * (0.5 * s * s + 1.0 / s - 1.5)


def length(law: Rubber, k: float, rest: float, tension: Any) -> Any:
    load = 3.0 * tension / (k * rest)
    s = 1.0 + load
    for _ in range(20):  # Newton
        s = s - (s - s**-2 - load) / (1.0 + 2.0 * s**-3)
    return rest * s


LAW = Law("rubber", "Rubber", Rubber(), force_density, stiffness, energy, length)
