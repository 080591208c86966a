"""How many steps lead a scene to a time."""

import math
from typing import Protocol


class Running(Protocol):
    """Protocol with a time [s] and a step [s]."""

    @property
    def time(self) -> float: ...

    @property
    def step(self) -> float: ...


def steps_to(running: Running, until: float) -> int:
    """Steps from a scene's time to the first whole step at or after `until` [s], round-off allowed for."""
    return max(0, math.ceil((until - running.time) / running.step * (1.0 - 1e-9) - 1e-6))
