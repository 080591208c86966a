"""`State` of a net or of mooring lines in motion, and `advance`, which changes it."""

import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.interruption import raise_if_stopped
from sim.jit import set_threads
from sim.springs.analysis.energy import Energy, energies
from sim.springs.analysis.extremes import DIVERGENCE_BOUND, extremes
from sim.springs.integrators import Integrator, integrator_named
from sim.springs.net import Net
from sim.springs.points.acceleration import set_acceleration
from sim.springs.points.arrays import LISTS, StrandArrays
from sim.springs.points.point_system import PointSystem, check_system
from sim.validation import argument_error, check_kind, check_positive, is_whole_number

# In one call of a kernel, which a Ctrl-C waits for: hundredths of a second.
POINT_EVALS = 2e6  # force evaluations times points, of a rope
LIST_SIZES = ("rows", "cols", "thickness", "row_spacing", "col_spacing")  # of a view, that its lists depend on


@dataclasses.dataclass(eq=False)
class State:
    """Positions and velocities, (3, rows, cols) of a net and (3, n) of lines, the time, and the running ledger.

    Of lines the points are all nodes, then two a body: its displacement [m] and its small rotation [rad].
    """

    x: NDArray[np.float64]  # [m]
    v: NDArray[np.float64]  # [m/s], at time t - lag
    t: float = 0.0  # [s]
    lag: float = 0.0  # [s] by which v trails x
    dissipated: float = 0.0  # [J]
    work: float = 0.0  # [J]
    force_evals: int = 0
    steps: int = 0
    left_out: int = 0  # most particles at once that self-contact left out, its list of pairs being full
    unsettled: int = 0  # steps of implicit methods, and kicks of damped nets and lines, whose solver had not settled
    slowed: int = 0  # steps in which parts that touch were slowed down, as impulses alone did not keep them apart
    # (pairs, 5): links of a chain that touched in the last step, by their first points, and friction on the second [N]
    rubs: NDArray[np.float64] = dataclasses.field(default_factory=lambda: np.empty((0, 5)), repr=False)
    lists: dict[str, NDArray[Any]] | None = dataclasses.field(default=None, repr=False)  # see `view_with_lists`

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
        return cls(np.array(x, dtype=np.float64, order="C"), np.zeros(x.shape))

    def copy(self) -> "State":
        return dataclasses.replace(self, x=self.x.copy(), v=self.v.copy(), lists=None)

    @property
    def is_bounded(self) -> bool:
        """False once anything is not finite or is out of any sane bound."""
        return extremes(self.x, self.v).max_coordinate < DIVERGENCE_BOUND


def check_state(system: PointSystem, state: State, name: str = "state") -> None:
    """Raises ValueError unless `state` is one of `system`: kernels check no index, and write into its arrays."""
    check_system(system)
    if not isinstance(state, State):
        raise argument_error(name, type(state), "a State")
    for field, array in ((f"{name}.x", state.x), (f"{name}.v", state.v)):
        if array.shape != system.state_shape:
            raise argument_error(field, array.shape, f"the shape of a state of the system, {system.state_shape}")
        if array.dtype != np.float64 or not array.flags.c_contiguous:
            raise argument_error(field, f"{array.dtype}, {array.strides}", "a contiguous array of float64")
        if not array.flags.writeable:
            raise argument_error(field, "a read-only array", "one that can be changed, as `State.copy` makes")
    rubs = state.rubs
    if not isinstance(rubs, np.ndarray) or rubs.shape[1:] != (5,) or rubs.dtype != np.float64:
        raise argument_error(f"{name}.rubs", getattr(rubs, "shape", rubs), "an array of float64 of shape (pairs, 5)")
    if np.may_share_memory(state.x, state.v):
        raise argument_error(f"{name}.v", f"the memory of {name}.x", "an array of its own")


Driven = Mapping[str, NDArray[np.float64]] | None


def view_of(system: PointSystem, h: float, driven: Driven) -> Any:
    """The kernels' view of a system for steps of h [s], with the arrays of `driven` for its own.

    Raises ValueError for one that the view does not have, or of another shape: kernels check no index.
    """
    p = system.kernel_view(h)
    if driven is None:
        return p
    check_kind("driven", driven, Mapping, "arrays by their names, or None")
    for name, array in driven.items():
        own = getattr(p, name, None)
        if not isinstance(own, np.ndarray) or own.dtype != np.float64:
            known = [one for one, value in p._asdict().items() if getattr(value, "dtype", None) == np.float64]
            raise argument_error("driven", name, f"one of {', '.join(known)}")
        if not isinstance(array, np.ndarray) or array.dtype != np.float64 or array.shape != own.shape:
            shape = getattr(array, "shape", type(array))
            raise argument_error(f"driven: {name}", shape, f"an array of float64 of shape {own.shape}")
    return p._replace(**{name: np.ascontiguousarray(array) for name, array in driven.items()})


def view_with_lists(p: Any, state: State) -> Any:
    """`p` with the lists of near parts from the last call of `advance` for this state.

    Kernels make them anew if positions have changed. Those for another thickness or spacing are not used.
    """
    lists, state.lists = state.lists, None  # a cancelled solve leaves incomplete lists
    if lists is None or any(lists[name] != getattr(p, name) for name in LIST_SIZES):
        return p
    p = p._replace(**{name: lists[name] for name in LISTS if name in lists})
    if "moved" in lists:
        p.moved[2:] = np.inf
    return p


def lists_of(p: Any) -> dict[str, Any]:
    return {name: getattr(p, name) for name in (*LISTS, *LIST_SIZES) if hasattr(p, name)}


def set_rubs(p: Any, rubs: NDArray[np.float64]) -> None:
    """Have the kernels begin with the friction of a state."""
    count = min(len(rubs), len(p.last_rubs))
    p.last_rubs[:count] = rubs[:count]
    p.touching[-1, 1] = count


def rubs_of(p: Any) -> NDArray[np.float64]:
    return p.last_rubs[: max(0, p.touching[-1, 1])].copy()


def touches_itself(system: PointSystem) -> bool:
    """True if a look for contacts may end a solve early."""
    return isinstance(system, Net) and system.thickness > 0.0


def acceleration(system: PointSystem, state: State, lag: float, driven: Driven = None) -> NDArray[np.float64]:
    """Accelerations [m/s^2] of the state as stored; its velocities may trail by half a step."""
    a, p = np.empty_like(state.x), view_of(system, 2.0 * lag, driven)
    set_acceleration(state.x.reshape(-1), state.v.reshape(-1), state.t, p, a.reshape(-1))
    if touches_itself(system):
        raise_if_stopped()
    return a


def set_lag(system: PointSystem, state: State, lag: float, driven: Driven = None) -> None:
    """Move the velocities, in place, to time t - lag [s], for a change of step or of integrator."""
    if lag != state.lag:
        state.v += (state.lag - lag) * acceleration(system, state, max(lag, state.lag), driven)
        state.lag = lag
        state.force_evals += 1


def velocities(system: PointSystem, state: State) -> NDArray[np.float64]:
    """Velocities [m/s] at time t, of the shape of `state.x`, whether or not the integrator's trail by half a step.

    Raises ValueError for a state of another system.
    """
    check_state(system, state)
    if state.lag == 0.0:
        return state.v
    return state.v + state.lag * acceleration(system, state, state.lag)


def advance(
    system: PointSystem,
    state: State,
    integrator: str | Integrator,
    h: float,
    steps: int,
    *,
    with_account: bool = False,
    driven: Driven = None,
) -> None:
    """Advance `state` of a net or of mooring lines in place by `steps` steps of h [s].

    integrator: a name in `INTEGRATORS`, or one of its records.
    driven: arrays that stand for those of the same name and shape in the kernels' view, as `paths` of coupled points
    from `paths_to`.

    Raises ValueError for a system the integrator refuses, for a state of another system, for an unknown integrator, and
    for a step or a number of steps that cannot be. Where the solve is ended early (sim/interruption.py) the state is
    that after some of the steps.

    >>> from sim.springs import State, advance, rope
    >>> net = rope(points=10)
    >>> state = State.at_rest(net)
    >>> advance(net, state, "rk4", h=1e-3, steps=500)
    >>> round(state.t, 6), state.force_evals
    (0.5, 2000)
    """
    check_state(system, state)
    integrator = integrator_named(integrator)
    system.check_integrator(integrator)
    check_positive("h", h, "s")
    if not is_whole_number(steps) or steps < 0:
        raise argument_error("steps", steps, "a whole number of at least 0")
    check_kind("with_account", with_account, bool, "True or False")
    p = view_of(system, h, driven)
    set_lag(system, state, integrator.lag * h, driven)
    # The sums continue from where they are, so that they do not depend on how the steps are shared out among the calls.
    ledger = np.array([state.dissipated, state.work, state.unsettled, state.slowed])
    if isinstance(system, Net) and system.bands > 1:
        set_threads(system.bands)
    most = max(1, int(POINT_EVALS / (system.evaluation_cost * integrator.evals)))
    touches = touches_itself(system)
    if touches:
        p = view_with_lists(p, state)
    has_strands = isinstance(p, StrandArrays)
    if has_strands:
        set_rubs(p, state.rubs)
    may_end_within_a_step = integrator.implicit or touches
    for done in range(0, steps, most):
        count = min(most, steps - done)
        raise_if_stopped()
        # A long step may be ended in its middle, or let others look at the state.
        x, v = (state.x.copy(), state.v.copy()) if may_end_within_a_step else (state.x, state.v)
        evals = integrator.advance(x.reshape(-1), v.reshape(-1), ledger, state.t, h, count, p, with_account)
        if may_end_within_a_step:
            raise_if_stopped()
            state.x[:], state.v[:] = x, v
        if touches:
            state.left_out = max(state.left_out, int(p.pairs[-1, 1]))
        state.force_evals += evals
        state.t += count * h
        state.steps += count
        state.dissipated = float(ledger[0])
        state.work = float(ledger[1])
        state.unsettled = int(ledger[2])
        state.slowed = int(ledger[3])
    if touches:
        state.lists = lists_of(p)
    if has_strands:
        state.rubs = rubs_of(p)


def energy(system: PointSystem, state: State) -> Energy:
    """Stored energies at the state's time [J]."""
    x, v = state.x.reshape(-1), velocities(system, state).reshape(-1)
    energy_parts = Energy(*energies(x, v, state.t, system.kernel_view(1.0)))
    if touches_itself(system):
        raise_if_stopped()
    return energy_parts
