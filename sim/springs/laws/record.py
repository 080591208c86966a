"""`Law`: the declaration of a file of `sim.springs.laws`."""

from collections.abc import Callable
from typing import Any, NamedTuple

from sim.jit import kernel


@kernel(inline=True)
def at_any_length(law, rest, length):
    """True: the damping of the law acts at any length."""
    return True


class Law(NamedTuple):
    """The law of a link. k is its stiffness [N/m], rest its rest length [m] and length its length [m]."""

    name: str
    title: str  # in the panel
    numbers: Any  # a NamedTuple of a class of its own: the law's numbers, all floats of at least 0, with their defaults
    force_density: Callable[..., Any]  # (numbers, k, rest, length) -> tension over length [N/m]
    stiffness: Callable[..., Any]  # (numbers, k, rest, length) -> derivative of the tension by the length [N/m]
    energy: Callable[..., Any]  # (numbers, k, rest, length) -> stored energy [J]
    length: Callable[..., Any]  # (numbers, k, rest, tension) -> length [m] at a tension above 0 [N], of arrays
    damps: Callable[..., Any] = at_any_length  # (numbers, rest, length) -> whether the link's damping acts
    over_step: Callable[..., Any] | None = None  # the function of this name in `sim.springs.laws`, where it is simpler
