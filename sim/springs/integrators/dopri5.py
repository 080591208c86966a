"""Dormand-Prince 5(4), adaptive: it chooses its steps for a given tolerance, and fills frames in between.

Six force evaluations a step of fifth order. Undamped modes hold to h omega = 1 only, so that it is expensive on stiff
nets. Choose it for soft nets and tolerances of 1e-5 to 1e-8.
"""

from typing import Any

from sim.springs.analysis.amplification import limit_of_polynomial, polynomial_of
from sim.springs.integrators import Integrator
from sim.springs.integrators.embedded.dopri5 import METHOD, A, B
from sim.springs.integrators.embedded.march import march as march_to_frames
from sim.springs.integrators.embedded.stages import take_steps

POLYNOMIAL = polynomial_of(A, B)


def limit(zeta: float) -> float:
    """Limit: the stability polynomial, 1 + s + ... + s^5/120 + s^6/600, exceeds 1 on the ray of s = h lambda."""
    return limit_of_polynomial(POLYNOMIAL, zeta)


def advance(*arguments: Any) -> int:
    return take_steps(METHOD, *arguments)


def march(*arguments: Any) -> tuple[int, int, int, float]:
    return march_to_frames(METHOD, *arguments)


RECORD = Integrator(
    "dopri5", 5, False, 6, limit, advance, "For a known error: chooses its own steps, errors of 1e-5 to 1e-8.",
    march=march,
)  # fmt: skip
