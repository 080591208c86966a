"""Dormand-Prince 8(5,3), adaptive: steps of its own choosing for a given tolerance, ended on the frames.

Twelve force evaluations a step of eighth order: the reference that the others are held against, and the cheapest way to
errors below 1e-8.
"""

from typing import Any

from sim.springs.analysis.amplification import limit_of_polynomial, polynomial_of
from sim.springs.integrators import Integrator
from sim.springs.integrators.embedded.dop853 import METHOD, A, B
from sim.springs.integrators.embedded.march import march as march_to_frames
from sim.springs.integrators.embedded.stages import take_steps

POLYNOMIAL = polynomial_of(A, B)


def limit(zeta: float) -> float:
    """Limit at which the stability polynomial of its twelve stages exceeds 1 on the ray of s = h lambda."""
    return limit_of_polynomial(POLYNOMIAL, zeta)


def advance(*arguments: Any) -> int:
    return take_steps(METHOD, *arguments)


def march(*arguments: Any) -> tuple[int, int, int, float]:
    return march_to_frames(METHOD, *arguments)


RECORD = Integrator(
    "dop853", 8, False, 12, limit, advance, "For the truth: eighth order, chooses its own steps, errors to 1e-12.",
    march=march,
)  # fmt: skip
