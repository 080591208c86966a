"""TR-BDF2: a trapezoidal stage to t + gamma h, then BDF2 to t + h, gamma = 2 - sqrt 2 (Hosea & Shampine 1996).

Both stages have the same g = gamma h/2. L-stable and second order: what a mode loses a step is 0.0037 (h omega)^4 of
its amplitude, where implicit Euler takes (h omega)^2/2. A step that Newton's method cannot take whole is taken in
halves, quarters, ..., in longer parts again after an easy one.
"""

import math
from functools import partial

import numpy as np
from numpy.typing import NDArray

from sim.springs.analysis.amplification import changes_of_function
from sim.springs.integrators import Integrator
from sim.springs.integrators.implicit.steps import TR_BDF2, advance_implicit


def stable_step(omega: float, rate: float) -> float:
    """No limit: A-stable, and R -> 0 at infinity."""
    return math.inf


def change(s: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """R(s) - 1 of R(s) = (1 + (sqrt 2 - 1) s) / (1 - g s)^2, g = 1 - 1/sqrt 2: both stages divide by 1 - g s."""
    g = 1.0 - math.sqrt(0.5)
    return s * (1.0 - g * g * s) / (1.0 - g * s) ** 2


RECORD = Integrator(
    "tr_bdf2", 2, False, 3, stable_step, partial(advance_implicit, TR_BDF2),
    "For stiff ropes with some accuracy: L-stable and second order.",
    changes_of_function(change),
    implicit=True, l_stable=True, evals_outside_corrections=1,
)  # fmt: skip
