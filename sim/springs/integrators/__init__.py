"""The interchangeable integrators: one file each, found by being here.

To add one, write a module in this folder with

1. `advance(x, v, ledger, t, h, steps, p, with_account) -> evals`, one `kernel` that advances the flat x and v
   (3 rows cols,) in place by `steps` steps of h [s] from time t, calls `accelerate` inside its loop and `set_pins` at
   every time it evaluates forces, and returns how many force evaluations that took. With `with_account` it adds what
   damping took and what pins put in [J] to ledger[0] and ledger[1], by a quadrature of its own order. An implicit one
   counts in ledger[2] the steps that it took before the solver had settled. Each step ends with
   `sim.springs.kicks.apart`, which counts in ledger[3] those in which it slowed down parts that touch.
2. `stable_step(omega, rate)`: the largest stable step [s] of x'' + rate x' + omega^2 x = 0, with omega [rad/s] and
   rate [1/s] from 0 on, in closed form or from the largest step at which the method's amplification stays within 1.
   0 if no step is stable, inf if every step is.
3. `changes(omega, rate, h)`: the two eigenvalues of A - I, complex (2, ...), of the matrix A of one step of the same
   oscillator. The arguments are arrays of one shape. A - I, as a slow mode hardly changes in a short step.
4. `RECORD = Integrator(...)`, which declares what the tests then check.
"""

import functools
import importlib
import pkgutil
from collections.abc import Callable
from typing import Any, NamedTuple

from sim.springs.analysis.amplification import Changes
from sim.validation import check_choice


class Integrator(NamedTuple):
    """Declared properties of an integrator."""

    name: str
    order: int  # of the global error, with damping
    symplectic: bool  # without damping
    evals: int  # force evaluations a step
    stable_step: Callable[[float, float], float]  # omega [rad/s], damping rate [1/s] -> largest stable step [s]
    advance: Callable[..., int]
    summary: str  # when to choose it
    changes: Changes  # omega [rad/s], damping rate [1/s], h [s] -> eigenvalues of A - I, see above
    lag: float = 0.0  # v is stored this part of a step before x
    undamped_order: int = 0  # where it differs from `order`
    implicit: bool = False  # a force evaluation is then one correction of the solver, `evals` the least number
    evals_outside_corrections: int = 0  # of implicit methods: further force evaluations a step
    l_stable: bool = False  # motions that it does not resolve decay within a step
    undamped_only: bool = False  # refuses nets with damping
    march: Callable[..., tuple[int, int, int, float]] | None = None  # adaptive methods: with steps of its own choosing

    def __deepcopy__(self, memo: object) -> "Integrator":
        """The record itself: nothing changes it."""
        return self

    def limit(self, zeta: float) -> float:
        """Largest stable h omega at damping ratio zeta."""
        return self.stable_step(1.0, 2.0 * zeta)

    @property
    def adaptive(self) -> bool:
        """True if it takes rtol and atol instead of a step."""
        return self.march is not None


@functools.cache
def discover() -> dict[str, Integrator]:
    """Every RECORD in this folder by name, the simplest methods first: the one dict that `sim.springs` publishes."""
    records: list[Any] = [
        importlib.import_module(f"{__name__}.{module.name}").RECORD
        for module in pkgutil.iter_modules(__path__)
        if not module.ispkg
    ]
    return {r.name: r for r in sorted(records, key=lambda r: (r.order, r.evals, r.symplectic, r.name))}


def integrator_named(integrator: str | Integrator) -> Integrator:
    """The record of that name, or the record itself. Raises ValueError with the names there are."""
    if isinstance(integrator, Integrator):
        return integrator
    records = discover()
    return records[check_choice("integrator", integrator, records)]
