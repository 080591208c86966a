"""The Nystroem pair 8(6) of Dormand, El-Mikkawy and Prince, adaptive, for nets that are stiff or weakly damped.

Eight force evaluations a step where dop853 takes twelve, and eighth order without damping. With damping it is of fifth
order, in small terms. Where stiffness limits the steps, or damping is weak, it takes half to three quarters of dop853's
evaluations at equal error. A soft net with strong damping, as the lab's default rope, costs it 1.4 times as many at
1e-9 m and three times as many at 1e-12 m: choose dop853 there.
"""

import functools
from typing import Any

from sim.springs.analysis.amplification import limit_of, nystroem_growth
from sim.springs.integrators import Integrator
from sim.springs.integrators.embedded.march import march as march_to_frames
from sim.springs.integrators.embedded.rkn8 import METHOD, POSITION, VELOCITY, C
from sim.springs.integrators.embedded.stages import take_steps

STEP = C, VELOCITY[: len(C) + 1, :-1], POSITION[: len(C) + 1, :-1]


@functools.lru_cache(maxsize=1000)
def limit(zeta: float) -> float:
    """Limit at which the step matrix of its eight stages has an eigenvalue above 1."""
    return limit_of(nystroem_growth(*STEP, zeta))


def advance(*arguments: Any) -> int:
    return take_steps(METHOD, *arguments)


def march(*arguments: Any) -> tuple[int, int, int, float]:
    return march_to_frames(METHOD, *arguments)


RECORD = Integrator(
    "rkn8", 5, False, 8, limit, advance, "For the truth of stiff or weakly damped nets: chooses its own steps.",
    undamped_order=8, march=march,
)  # fmt: skip
