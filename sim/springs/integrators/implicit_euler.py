"""Implicit Euler: v+ = v + h a(x+, v+), x+ = x + h v+, by Newton's method.

L-stable: holds at any stiffness, and pays for it with numerical damping, 1/(1 + (h omega)^2) of a mode's energy a step.
A step that Newton's method cannot take whole is taken in halves, quarters, ..., and in longer parts after an easy one.
"""

import math
from functools import partial

from sim.springs.analysis.amplification import changes_of_function
from sim.springs.integrators import Integrator
from sim.springs.integrators.implicit.steps import EULER, advance_implicit


def stable_step(omega: float, rate: float) -> float:
    """No limit: |1 - s| >= 1 for every s of negative real part."""
    return math.inf


RECORD = Integrator(
    "implicit_euler", 1, False, 1, stable_step, partial(advance_implicit, EULER),
    "For appearance at any stiffness: damps what its step does not resolve.",
    changes_of_function(lambda s: s / (1.0 - s)),
    implicit=True, l_stable=True,
)  # fmt: skip
