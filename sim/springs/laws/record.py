"""`Law`: the declaration of a file of `sim.springs.laws`."""

from collections.abc import Callable
from typing import Any, NamedTuple

from sim.jit import kernel


@kernel(inline=True)
def always_whole(law, k, b, rest, length, rate):
    """b: the damping of the law acts at any length and rate."""
    return b


class Law(NamedTuple):
    """The law of a link. k is its stiffness [N/m], rest its rest length [m] and length its length [m]."""

    name: str
    title: str  # in the panel
    numbers: Any  # a NamedTuple of a class of its own: the law's numbers, all floats of at least 0, with their defaults
    force_density: Callable[..., Any]  # (numbers, k, rest, length) -> tension over length [N/m]
    stiffness: Callable[..., Any]  # (numbers, k, rest, length) -> derivative of the tension by the length [N/m]
    energy: Callable[..., Any]  # (numbers, k, rest, length) -> stored energy [J]
    length: Callable[..., Any]  # (numbers, k, rest, tension) -> length [m] at a tension above 0 [N], of arrays
    # (numbers, k, b, rest, length, rate) -> the part of a damping b [N s/m] that acts where the length grows by `rate`
    # [m/s].
    damping: Callable[..., Any] = always_whole
    over_step: Callable[..., Any] | None = None  # the function of this name in `sim.springs.laws`, where it is simpler
