"""Implicit midpoint: x+ = x + h vm, v+ = v + h a(xm, vm) with xm = (x + x+)/2, vm = (v + v+)/2, by Newton's method.

A-stable: modes of any stiffness keep their energy, only their frequency is wrong, (2/h) atan(h omega/2). Damping
therefore takes next to nothing of a mode that is far too stiff for the step. Tensions are those of the mean lengths
(`sim.springs.integrators.implicit.mean_length`), so that links that turn far within a step keep their energy as well:
without damping and contact energy and angular momentum stay to round-off at any stiffness. For that the method gives up
being symplectic. If Newton's method cannot solve a whole step, the step is taken in halves, quarters, ..., and in
longer parts again after an easy one.
"""

import math
from functools import partial

from sim.springs.analysis.amplification import changes_of_function
from sim.springs.integrators import Integrator
from sim.springs.integrators.implicit.steps import MIDPOINT, advance_implicit


def stable_step(omega: float, rate: float) -> float:
    """No limit: |1 + s/2| <= |1 - s/2| for every s of negative real part."""
    return math.inf


RECORD = Integrator(
    "implicit_midpoint", 2, False, 1, stable_step, partial(advance_implicit, MIDPOINT),
    "For energy at any stiffness: keeps it, damps nothing.",
    changes_of_function(lambda s: s / (1.0 - 0.5 * s)),
    implicit=True,
)  # fmt: skip
