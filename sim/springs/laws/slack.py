"""A line that only pulls: tension k (l - d) where it is longer than d, and no force at all where it is not.

That holds for its damping too. A taut line is damped as a spring is, so that one that closes fast may push for as long
as it is taut. Its damping begins and ends with the tension: the force jumps there, as that of contact does at a touch.
"""

from typing import Any, NamedTuple

from sim.jit import kernel
from sim.springs.laws.record import Law


class Slack(NamedTuple):
    """Numbers of the law: none of its own."""


@kernel(inline=True)
def force_density(law, k, rest, length):
    return k - k * rest / length if length > rest else 0.0


@kernel(inline=True)
def stiffness(law, k, rest, length):
    return k if length > rest else 0.0


@kernel(inline=True)
def energy(law, k, rest, length):
    return 0.5 * k * max(0.0, length - rest) ** 2


@kernel(inline=True)
def damps(law, rest, length):
    return length > rest


def length(law: Slack, k: float, rest: float, tension: Any) -> Any:
    return rest + tension / k


LAW = Law("slack", "Line: only pulls", Slack(), force_density, stiffness, energy, length, damps)
