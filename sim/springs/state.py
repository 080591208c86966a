"""`State` of a moving net, and `advance`, which changes it."""

import dataclasses
import math

import numpy as np
from numpy.typing import NDArray

from sim.interruption import raise_if_stopped
from sim.jit import set_threads
from sim.springs.acceleration import set_acceleration
from sim.springs.analysis.energy import Energy, energies
from sim.springs.analysis.extremes import DIVERGENCE_BOUND, extremes
from sim.springs.integrators import Integrator, integrator_named
from sim.springs.net import Net
from sim.springs.point_system import PointSystem, check_system
from sim.validation import argument_error, check_kind, check_number, is_whole_number

# In one call of a kernel, which a Ctrl-C waits for: hundredths of a second.
POINT_EVALS = 2e6  # force evaluations times points, of a rope
GRID_COST = 4.0  # of a net with links in several directions, in evaluations of a rope's
CONTACT_COST = 300.0  # of a net that touches itself, in evaluations without


@dataclasses.dataclass
class State:
    """Positions and velocities (3, rows, cols), the time, and the running ledger."""

    x: NDArray[np.float64]  # [m]
    v: NDArray[np.float64]  # [m/s], at time t - lag
    t: float = 0.0  # [s]
    lag: float = 0.0  # [s] by which v trails x
    dissipated: float = 0.0  # [J]
    work: float = 0.0  # [J]
    force_evals: int = 0
    steps: int = 0
    left_out: int = 0  # most particles at once that self-contact left out, its list of pairs being full

    @classmethod
    def at_rest(cls, system: PointSystem) -> "State":
        """A net as it was built, or mooring lines in their state of rest, without motion.

        Raises ValueError if it is neither, and ConvergenceError without a state of rest.
        """
        check_system(system)
        return cls.still(system.start())

    @classmethod
    def still(cls, x: NDArray[np.float64]) -> "State":
        """Positions x [m], without motion."""
        return cls(x.copy(), np.zeros_like(x))

    def copy(self) -> "State":
        return dataclasses.replace(self, x=self.x.copy(), v=self.v.copy())

    @property
    def is_bounded(self) -> bool:
        """False once anything is not finite or is out of any sane bound."""
        return extremes(self.x, self.v).max_coordinate < DIVERGENCE_BOUND


def check_net(net: object) -> None:
    """Raises ValueError if it is not a net."""
    check_kind("net", net, Net, "a Net, as `rope` and `cloth` make them")


def check_state(system: PointSystem, state: State) -> None:
    """Raises ValueError unless `state` is one of `system`: kernels check no index, and write into its arrays."""
    check_system(system)
    if not isinstance(state, State):
        raise argument_error("state", type(state), "a State")
    for name, array in (("state.x", state.x), ("state.v", state.v)):
        if array.shape != system.state_shape:
            raise argument_error(name, array.shape, f"the shape of a state of the system, {system.state_shape}")
        if array.dtype != np.float64 or not array.flags.c_contiguous:
            raise argument_error(name, f"{array.dtype}, {array.strides}", "a contiguous array of float64")


def acceleration(system: Net, state: State, lag: float) -> NDArray[np.float64]:
    """Accelerations (3, rows, cols) [m/s^2] of the state as stored; its velocities may trail by half a step."""
    a = np.empty_like(state.x)
    set_acceleration(state.x.reshape(-1), state.v.reshape(-1), state.t, system.kernel_view(2.0 * lag), a.reshape(-1))
    if system.thickness > 0.0:
        raise_if_stopped()
    return a


def set_lag(system: Net, state: State, lag: float) -> None:
    """Move the velocities, in place, to time t - lag [s], for a change of step or of integrator."""
    if lag != state.lag:
        state.v += (state.lag - lag) * acceleration(system, state, max(lag, state.lag))
        state.lag = lag
        state.force_evals += 1


def velocities(system: Net, state: State) -> NDArray[np.float64]:
    """Velocities at time t (3, rows, cols) [m/s], whether or not the integrator's trail by half a step.

    Raises ValueError for a state of another system.
    """
    check_state(system, state)
    if state.lag == 0.0:
        return state.v
    return state.v + state.lag * acceleration(system, state, state.lag)


def check_damping(system: Net, integrator: Integrator) -> None:
    """Raises ValueError where a damped system is given to a method that takes none."""
    if integrator.undamped_only and system.is_damped:
        raise argument_error("integrator", integrator.name, "another, as this net is damped: by links, drag or contact")


def advance(
    system: Net, state: State, integrator: str | Integrator, h: float, steps: int, *, with_account: bool = False
) -> None:
    """Advance `state` in place by `steps` steps of h [s].

    integrator: a name in `INTEGRATORS`, or one of its records.

    Raises ValueError for a net the integrator refuses, for a state of another net, for an unknown integrator, and for a
    step or a number of steps that cannot be. Where the solve is ended early (sim/interruption.py) the state is that
    after some of the steps.

    >>> from sim.springs import State, advance, rope
    >>> net = rope(points=10)
    >>> state = State.at_rest(net)
    >>> advance(net, state, "rk4", h=1e-3, steps=500)
    >>> round(state.t, 6), state.force_evals
    (0.5, 2000)
    """
    check_state(system, state)
    integrator = integrator_named(integrator)
    check_damping(system, integrator)
    check_number("h", h, 0, math.inf, "s", above=True)
    if not is_whole_number(steps) or steps < 0:
        raise argument_error("steps", steps, "a whole number from 0")
    check_kind("with_account", with_account, bool, "True or False")
    set_lag(system, state, integrator.lag * h)
    # The sums go on from where they are, so that they do not depend on how the steps are shared out among the calls.
    ledger, p = np.array([state.dissipated, state.work]), system.kernel_view(h)
    if system.bands > 1:
        set_threads(system.bands)
    each = CONTACT_COST if system.thickness > 0.0 else 1.0 if system.is_rope else GRID_COST
    cost = system.x0[0].size * integrator.evals * each
    most = max(1, int(POINT_EVALS / cost))
    may_end_within_a_step = integrator.implicit or system.thickness > 0.0
    for done in range(0, steps, most):
        count = min(most, steps - done)
        raise_if_stopped()
        # A long step may be ended in its middle, or let others look at the state.
        x, v = (state.x.copy(), state.v.copy()) if may_end_within_a_step else (state.x, state.v)
        evals = integrator.advance(x.reshape(-1), v.reshape(-1), ledger, state.t, h, count, p, with_account)
        if may_end_within_a_step:
            raise_if_stopped()
            state.x[:], state.v[:] = x, v
        if system.thickness > 0.0:
            state.left_out = max(state.left_out, int(p.pairs[-1, 1]))
        state.force_evals += evals
        state.t += count * h
        state.steps += count
        state.dissipated = float(ledger[0])
        state.work = float(ledger[1])


def energy(system: Net, state: State) -> Energy:
    """Stored energies at the state's time [J]."""
    found = Energy(
        *energies(state.x.reshape(-1), velocities(system, state).reshape(-1), state.t, system.kernel_view(1.0))
    )
    if system.thickness > 0.0:
        raise_if_stopped()
    return found


def steps_for(interval: float, step: float) -> int:
    """Steps that fill `interval` [s] with none longer than `step` [s], forgiving round-off in their ratio."""
    return max(1, math.ceil(interval / step * (1.0 - 1e-9)))
