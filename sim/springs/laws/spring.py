"""The linear spring, which pulls and pushes: tension k (l - d), the lab's eq. 4."""

from typing import Any, NamedTuple

from sim.jit import kernel
from sim.springs.laws.record import Law


class Spring(NamedTuple):
    """Numbers of the law: none of its own."""


@kernel(inline=True)
def force_density(law, k, rest, length):
    return k - k * rest / length


@kernel(inline=True)
def stiffness(law, k, rest, length):
    return k


@kernel(inline=True)
def energy(law, k, rest, length):
    return 0.5 * k * (length - rest) ** 2


@kernel(inline=True)
def over_step(law, k, rest, before, after):
    """The mean tension of all lengths between two is that of their mean."""
    mean = 0.5 * (before + after)
    return k - k * rest / mean, k * rest / (mean * mean)


def length(law: Spring, k: float, rest: float, tension: Any) -> Any:
    return rest + tension / k


LAW = Law(
    "spring", "Spring: pulls and pushes (lab)", Spring(), force_density, stiffness, energy, length, over_step=over_step
)
