"""A line that only pulls: tension k (l - d) where it is longer than d, and no force at all where it is not.

That holds for its damping too. A taut line is damped as a spring is, but by no more than its tension where it shortens:
the sum of both is max(0, T + b dl/dt). Its damping begins with the tension: where the line lengthens the force jumps
there, as that of contact does at a touch.
"""

from typing import Any, NamedTuple

from sim.jit import kernel
from sim.springs.laws.record import Law

MOST_OF_PULL = 1.0 - 1e-15  # fraction of the tension that damping may take, so that round-off does not make a line push


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
def without_push(b, pull, rate):
    """The part of a damping b [N s/m] that a line of tension `pull` [N] takes without a push."""
    return min(b, -MOST_OF_PULL * pull / rate) if rate < 0.0 else b


@kernel(inline=True)
def damping(law, k, b, rest, length, rate):
    return without_push(b, k * (length - rest), rate) if length > rest else 0.0


def length(law: Slack, k: float, rest: float, tension: Any) -> Any:
    return rest + tension / k


LAW = Law("slack", "Line: only pulls", Slack(), force_density, stiffness, energy, length, damping)
