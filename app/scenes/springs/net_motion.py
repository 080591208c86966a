"""The motion of one spring network: of a rope, of a cloth, and of each rope of a race."""

from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import numpy as np

from app.messages import Vector
from sim.springs import Net
from sim.springs.analysis.accuracy import Motion
from sim.springs.analysis.energy_account import EnergyAccount
from sim.springs.analysis.extremes import Extremes
from sim.springs.integrators import Integrator
from sim.springs.resampling import resample
from sim.springs.stability import Gauge, Mode, gauge
from sim.springs.state import State, advance

Bound: TypeAlias = Callable[[Net, State], float]  # net and state -> its largest reach [m]


class SolverReport(NamedTuple):
    """Steps since the method and the step were chosen, and failures in them."""

    steps: int = 0
    unsettled: int = 0  # steps of an implicit method, or kicks of another one, whose solver had not settled
    slowed: int = 0  # steps in which parts that touch were slowed down to keep them apart
    implicit: bool = False


class NetMotion:
    """A spring network in motion: its last good state, its method and step, its bounds, and the cost of its steps."""

    def __init__(self, net: Net, method: Integrator, step: float, bound: Bound) -> None:
        """Start at rest. step: [s]. bound: distance [m] from the first particle beyond which the net has diverged."""
        self.net, self.method, self.step, self.bound = net, method, step, bound
        self.state = State.at_rest(net)
        self.account = EnergyAccount(net, self.state)
        self.max_reach = bound(net, self.state)  # [m] from the first particle, along an axis
        self.evals, self.corrections = float(method.evals), 0.0  # force evaluations, corrections a step
        self.counted = 0, 0  # force evaluations and steps at the last count
        self.chosen_at = 0, 0, 0  # steps, unsettled ones and slowed ones, when method and step were chosen

    @property
    def integrator(self) -> str:
        """Name of the method."""
        return self.method.name

    @property
    def stiffness(self) -> float:
        """Stiffness [N/m] of the first family of links."""
        return self.net.families[0].stiffness

    def use(self, method: Integrator, step: float) -> None:
        """Continue with this method and step [s]; its cost is counted from here on."""
        if (method, step) == (self.method, self.step):
            return
        if method is not self.method:
            self.evals, self.corrections = float(method.evals), 0.0
        self.method, self.step = method, step
        self.account.start_method(self.net, self.state)
        self.counted = self.state.force_evals, self.state.steps
        self.chosen_at = self.state.steps, self.state.unsettled, self.state.slowed

    def change_net(self, net: Net, *, still_pins: bool = False) -> None:
        """Continue with another net, interpolated if its points are others. The change is work.

        still_pins: pinned particles are at rest from here on.
        """
        stored, before, self.net = self.stored_energy(), self.net, net
        if net.shape != before.shape:
            self.state.x, self.state.v = (resample(values, *net.shape) for values in (self.state.x, self.state.v))
        for row, column in net.pinned if still_pins else ():
            self.state.v[:, row, column] = 0.0
        self.account.book_change(stored, net, self.state)
        self.max_reach = self.bound(net, self.state)

    def restart_account(self) -> None:
        """Begin the energy account here: the steps before were taken without one."""
        self.account = EnergyAccount(self.net, self.state)

    def take_steps(self, net: Net, state: State, steps: int, *, with_account: bool = True) -> None:
        """Advance a copy of the state in place. net: with the motions that a user causes."""
        advance(net, state, self.method, self.step, steps, with_account=with_account)

    def holds(self, extremes: Extremes) -> bool:
        """True if a state with these extremes is within the bounds; False of a NaN."""
        return extremes.reach < self.max_reach

    def place_pin(self, column: int, position: Vector) -> None:
        """Put a particle of the first row to rest at a position [m]."""
        self.state.x[:, 0, column] = position
        self.state.v[:, 0, column] = 0.0

    def count_evals(self) -> None:
        """Update evaluations and corrections a step of an implicit method by the steps since the last count."""
        evals, steps = self.state.force_evals - self.counted[0], self.state.steps - self.counted[1]
        if steps and self.method.implicit:
            self.evals = evals / steps
            self.corrections = max(0.0, self.evals - self.method.evals_outside_corrections)
        self.counted = self.state.force_evals, self.state.steps

    def solver_report(self) -> SolverReport:
        """The failures of this method since it was chosen."""
        steps, unsettled, slowed = self.chosen_at
        state, implicit = self.state, self.method.implicit
        return SolverReport(state.steps - steps, state.unsettled - unsettled, state.slowed - slowed, implicit)

    def gauge(self, modes: list[Mode] | None = None, motion: Motion | None = None) -> Gauge:
        """The step and its limits in the present state. modes, motion: the fastest and the moved ones, if known."""
        return gauge(self.net, self.method, self.step, self.state, modes, motion)

    def stored_energy(self) -> float:
        """Stored energy [J]."""
        return self.account.stored(self.net, self.state)

    def energy_error(self) -> float:
        """Numerical error [J] of the energy since the start."""
        return self.account.error(self.net, self.state)

    def numerical_dissipation(self) -> float:
        """Energy [J] that the method took since it was chosen, negative where it fed the motion."""
        return self.account.numerical_dissipation(self.net, self.state)


def rope_lengths(net: Net) -> tuple[float, float]:
    """Length [m] of a rope at rest, and how much its weight stretches it as it hangs [m]."""
    link = net.families[0]
    carried = np.cumsum(net.masses[0, :0:-1])  # [kg] by each link, from the last one
    return (net.shape[1] - 1) * link.rest, float(carried.sum()) * abs(net.gravity[2]) / link.stiffness
