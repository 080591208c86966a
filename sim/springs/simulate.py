"""`simulate`: a net of springs or a mooring from its start to the end, sampled at equal times."""

import dataclasses
import math
import warnings
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.frames import Progress, check_steps, equal_steps, frame_times, run_frames, warn_of_divergence
from sim.interruption import raise_if_stopped
from sim.springs.analysis.energy import energies
from sim.springs.analysis.energy_history import energy_history
from sim.springs.analysis.extremes import DIVERGENCE_BOUND
from sim.springs.automatic import AUTO, choose_for_step, choose_for_tolerance
from sim.springs.integrators import Integrator, integrator_named
from sim.springs.net import PAIRS, Net
from sim.springs.points.point_system import PointSystem, RunT, check_system
from sim.springs.run import Run
from sim.springs.stability import critical_step, gershgorin
from sim.springs.state import State, advance, check_state, energy, set_lag, velocities
from sim.validation import ApproximationWarning, argument_error, as_array, check_kind, check_number

CALM = 1e-3 * DIVERGENCE_BOUND  # [m]: a net within this has not yet been out of the sane bound
STEP = 1 / 1200  # [s], or SAFETY of the critical step where that is shorter
SAFETY = 0.5
RTOL, ATOL = 1e-6, 1e-9  # of adaptive methods
LEAST_RTOL, LEAST_ATOL = 1e-14, 1e-18  # below, round-off would demand shorter and shorter steps
MOST_STEPS = 1e10  # of a run: hours of a rope
FRICTION_STEP = 1e-3  # [s] within which friction stops a point in adaptive methods


class Simulated(NamedTuple):
    """The way in which `simulate` runs the systems of one class."""

    run: Callable[..., Any]  # (system, t, step, integrator, with_account, progress, **options) -> record of the run
    duration: float  # [s] by default
    frames: int
    integrator: str
    options: tuple[str, ...]  # names of arguments for these systems only


SIMULATED: dict[type[PointSystem[Any]], Simulated] = {}  # each class of systems adds its own


def simulate(
    system: PointSystem[RunT],
    duration: float | None = None,
    frames: int | None = None,
    step: float | None = None,
    integrator: str | Integrator | None = None,
    *,
    x: ArrayLike | None = None,
    v: ArrayLike | None = None,
    rtol: float | None = None,
    atol: float | None = None,
    motion: Mapping[int, Callable[[float], Any]] | None = None,
    start: State | None = None,
    with_account: bool = False,
    progress: Progress = None,
) -> RunT:
    """Integrate a net or a mooring for `duration` [s] and sample it at `frames` equal times from its start on.

    Returns a `Run` of a net, a `MooringRun` of a mooring.

    duration, frames: 2 s and 61 of a net by default, 10 s and 101 of a mooring.
    step: [s], by default half the critical step at the start, for a net at most 1/1200; shortened if it does not divide
    a frame interval (`step` of the run is the one used). A given step is used, however long: see
    `sim.springs.critical_step`, and `accurate_step` for what is stable but not right.
    integrator: a name in `INTEGRATORS`, "rk4" of a net and "leapfrog" of a mooring by default. For a net also "auto",
    which chooses an adaptive method by the net's damping and the tolerance, or by the step (sim/springs/automatic.py);
    `integrator` of the run names it.
    with_account: also integrate the energy dissipated by damping and put in by moved points and water; stored energies
    are always computed.
    progress: called with (frames done, frames).
    start: the `State` to start from, at its time, with which the run's times begin. None: time 0, a net as it was built
    and a mooring at rest, its moved points at their first places. `state` of a run is the last one: with equal steps, a
    run that continues from it is bitwise the run in one piece, if it has the same `step`.

    Of a net only:
    x, v: positions [m] and velocities [m/s] at the start, (points, 3) of a rope, (rows, cols, 3) of another net, as a
    run has them; None: as the net was built, at rest. Pinned points stay at their places in x.
    rtol, atol: adaptive methods choose steps with an error within atol + rtol |value| of each position [m] and velocity
    [m/s], 1e-6 and 1e-9 by default; with `step` they use that instead.

    Of a mooring only:
    motion: by the id of a coupled point, a function of the time [s] that gives its place (3,) [m]; its velocity is that
    from `function.velocity(t)` if it exists, else from differences. It is never called at times before the start.
    Other points stay in place.

    A run that diverges ends there: `diverged_at` is the time of the first step of a net, or the first frame of a
    mooring, outside all sane bounds, or at which an adaptive method found no step short enough. Later frames are NaN,
    with a RuntimeWarning.

    Raises ValueError, naming the argument, its value and what is allowed, and ConvergenceError for a mooring without a
    state of rest.

    >>> from sim.springs import rope, simulate
    >>> run = simulate(rope(points=10), duration=1.0, frames=31, step=1 / 240, integrator="leapfrog")
    >>> run.x.shape, run.energy.kinetic.shape
    ((31, 10, 3), (31,))
    """
    check_system(system)
    how = next(SIMULATED[kind] for kind in type(system).__mro__ if kind in SIMULATED)
    options = {"x": x, "v": v, "rtol": rtol, "atol": atol, "motion": motion, "start": start}
    options = {name: value for name, value in options.items() if value is not None}
    for name, value in options.items():
        if name not in how.options:
            has = " and ".join((", ".join(how.options[:-1]), how.options[-1]))
            raise argument_error(name, value, f"None, as a {type(system).__name__} has {has} instead")
    duration = how.duration if duration is None else duration
    t = frame_times(duration, how.frames if frames is None else frames, step, progress)
    check_kind("with_account", with_account, bool, "True or False")
    run = how.run(
        system, t, step, how.integrator if integrator is None else integrator, with_account, progress, **options
    )
    warn_of_divergence(run.integrator, run.step, run.diverged_at)
    for words in approximations(system, run):
        warnings.warn(words, ApproximationWarning, stacklevel=2)
    return run


def approximations(system: PointSystem, run: Any) -> list[str]:
    """Warnings of a run with steps that are `unsettled` or `slowed`."""
    words = []

    def steps_of(count: int) -> str:
        return f"{count} step{'' if count == 1 else 's'}" + ("" if run.step is None else f" of {run.step:g} s")

    if run.unsettled > 0:
        steps = steps_of(run.unsettled)
        words.append(f"the solver of {run.integrator} had not settled in {steps}: their error is that of the solver")
    if isinstance(run, Run) and run.slowed > 0:
        parts = "strands" if isinstance(system, Net) and system.is_strand else "parts of the net"
        steps = steps_of(run.slowed)
        words.append(f"{parts} that touch were slowed down in {steps}, as impulses alone did not keep them apart")
    return words


def run_net(
    system: Net,
    t: NDArray[np.float64],
    step: float | None,
    integrator: str | Integrator,
    with_account: bool,
    progress: Progress,
    x: ArrayLike | None = None,
    v: ArrayLike | None = None,
    rtol: float | None = None,
    atol: float | None = None,
    start: State | None = None,
) -> Run:
    """The run of a net at the times t [s] since its start, with the arguments of `simulate`."""
    if start is not None:
        check_state(system, start, "start")
        if x is not None or v is not None:
            raise argument_error("start", "a State beside x or v", "a State alone, or x and v")
    net, velocity = begun(system, x, v)
    state = State(net.x0.copy(), velocity) if start is None else start.copy()
    record = None if isinstance(integrator, str) and integrator == AUTO else integrator_named(integrator)
    for name, value, least in (("rtol", rtol, LEAST_RTOL), ("atol", atol, LEAST_ATOL)):
        if value is not None:
            check_number(name, value, "", least, 1)
            adaptive = record is None or record.adaptive
            if not adaptive or step is not None:
                raise argument_error(name, value, "None, as the step is given" if adaptive else "adaptive methods only")
    duration = float(t[-1])
    if record is None:
        choice = (
            choose_for_step(net, step) if step else choose_for_tolerance(net, rtol or RTOL, duration / (len(t) - 1))
        )
        record = choice.integrator
    net.check_integrator(record)
    if record.undamped_only and net.grab is not None and net.grab.damping > 0.0:
        raise argument_error("grab.damping", net.grab.damping, f"0, as {record.name} takes no damping")
    if record.adaptive and step is None:
        may_be_endless = duration * max(gershgorin(net)) > MOST_STEPS
        longest = (may_be_endless and critical_step(net, record)) or math.inf  # 0 where no step stays stable
        check_steps(duration, longest, MOST_STEPS, False)
        run = marched(net, state, record, t, rtol or RTOL, atol or ATOL, with_account, progress)
    else:
        h = step or default_step(net, record)
        check_steps(duration, h, MOST_STEPS, step is not None)
        run = stepped(net, state, record, t, h, with_account, progress)
    if run.left_out > 0:
        text = (
            f"self-contact left out up to {run.left_out} particles: more than {PAIRS} pairs a particle were within "
            "reach"
        )
        warnings.warn(text, ApproximationWarning, stacklevel=3)
    return run


SIMULATED[Net] = Simulated(run_net, 2.0, 61, "rk4", ("x", "v", "rtol", "atol", "start"))


def begun(net: Net, x: ArrayLike | None, v: ArrayLike | None) -> tuple[Net, NDArray[np.float64]]:
    """The net with the positions x, and the velocities v (3, rows, cols), of `simulate`'s arguments."""
    shape = (net.shape[1], 3) if net.is_rope else (*net.shape, 3)
    arrays = {"x": net.x0, "v": np.zeros_like(net.x0)}
    for name, values in (("x", x), ("v", v)):
        if values is None:
            continue
        array = as_array(name, values, f"numbers of shape {shape}")
        if array.shape != shape:
            raise argument_error(name, array.shape, f"finite numbers of shape {shape}")
        if not np.isfinite(array).all():
            raise argument_error(name, float(array[~np.isfinite(array)][0]), f"finite numbers of shape {shape}")
        arrays[name] = np.ascontiguousarray(np.moveaxis(array, -1, 0).reshape(3, *net.shape), dtype=np.float64)
    if v is not None:
        for i, j in net.pinned:
            arrays["v"][:, i, j] = 0.0
    return net if x is None else dataclasses.replace(net, x0=arrays["x"]), arrays["v"]


def default_step(net: Net, record: Integrator) -> float:
    """STEP [s], or shorter if the net needs it."""
    fastest, strongest = gershgorin(net)
    # The bounds are quick, and enough for most nets: a method that holds undamped holds in such short steps.
    if record.limit(0.0) > 0.0 and STEP * max(fastest, strongest) < 0.1:
        return STEP
    longest = critical_step(net, record)
    return min(STEP, SAFETY * longest) if longest > 0.0 else STEP


class NetFrames:
    """Advances a net from frame to frame, and collects the results."""

    def __init__(
        self, net: Net, start: State, record: Integrator, t: NDArray[np.float64], step: float, with_account: bool
    ) -> None:
        """start: it is advanced; t (frames,) [s]: since the start; step: [s] the longest allowed."""
        self.net, self.state, self.record, self.t, self.with_account = net, start, record, start.t + t, with_account
        interval = float(t[-1]) / (len(t) - 1)
        self.steps, self.h = equal_steps(interval, step)
        self.calm, self.calm_frame = start.copy(), 0
        self.x = np.full((len(t), *net.x0.shape), np.nan)
        self.v = np.full_like(self.x, np.nan)
        self.ledger = np.full((len(t), 6), np.nan)

    def advance(self, frame: int) -> None:
        """Advance from the previous frame to this one."""
        if np.abs(self.state.x).max() < CALM:
            self.calm, self.calm_frame = self.state.copy(), frame - 1
        advance(self.net, self.state, self.record, self.h, self.steps, with_account=self.with_account)

    @property
    def is_bounded(self) -> bool:
        """False once a value is not finite or out of all sane bounds."""
        return self.state.is_bounded

    def sample(self, frame: int) -> None:
        """Store the state as a frame."""
        self.x[frame], self.v[frame] = self.state.x, velocities(self.net, self.state)
        self.ledger[frame] = *energy(self.net, self.state), self.state.dissipated, self.state.work

    def end_at_divergence(self, frame: int) -> float:
        """The time [s] of the first bad step before a frame; all results from then on become NaN."""
        steps = self.steps * (frame - self.calm_frame)
        diverged_at = first_insane_time(self.net, self.calm, self.record, self.h, steps)
        # A diverging run may have left the bounds between frames and returned for one.
        for rows in (self.x, self.v, self.ledger):
            rows[self.t >= diverged_at] = np.nan
        return diverged_at


def stepped(
    net: Net,
    state: State,
    record: Integrator,
    t: NDArray[np.float64],
    step: float,
    with_account: bool,
    progress: Progress,
) -> Run:
    """The run at times `t` [s] since the state's, which is advanced in equal steps of at most `step` [s]."""
    evals, unsettled, slowed = state.force_evals, state.unsettled, state.slowed
    history = NetFrames(net, state, record, t, step, with_account)
    done = run_frames(history, len(t), progress)
    diverged_at = None if done == len(t) else history.end_at_divergence(done)
    return Run(
        history.t,
        per_point(net, history.x),
        per_point(net, history.v),
        energy_history(history.ledger, with_account or is_closed(net)),
        state.force_evals - evals,
        diverged_at,
        history.h,
        record.name,
        state.left_out,
        state.unsettled - unsettled,
        state.slowed - slowed,
        state,
    )


def marched(
    net: Net,
    state: State,
    record: Integrator,
    t: NDArray[np.float64],
    rtol: float,
    atol: float,
    with_account: bool,
    progress: Progress,
) -> Run:
    """The run at times `t` [s] since the state's, in steps of an adaptive method's own choosing."""
    assert record.march is not None
    set_lag(net, state, 0.0)
    t = state.t + t
    xs = np.full((len(t), net.x0.size), np.nan)
    vs = np.full_like(xs, np.nan)
    taken = np.zeros((len(t), 3))
    x, v = state.x.reshape(-1).copy(), state.v.reshape(-1).copy()
    p = net.kernel_view(FRICTION_STEP)
    evals, _, filled, stopped_at = record.march(x, v, t, rtol, atol, p, with_account, xs, vs, taken)
    raise_if_stopped()
    taken[:, :2] += state.dissipated, state.work
    shape = (len(t), *net.x0.shape)
    xs[filled:], vs[filled:] = np.nan, np.nan
    ledger = np.full((len(t), 6), np.nan)
    for frame in range(filled):
        ledger[frame] = *energies(xs[frame], vs[frame], float(t[frame]), p), *taken[frame, :2]
        if progress:
            progress(frame + 1, len(t))
    diverged_at = None if filled == len(t) else float(stopped_at)
    x_frames, v_frames = per_point(net, xs.reshape(shape)), per_point(net, vs.reshape(shape))
    left_out = max(0, int(p.pairs[-1, 1])) if net.thickness > 0.0 else 0
    energies_of = energy_history(ledger, with_account or is_closed(net))
    last = max(filled - 1, 0)
    state.x[:], state.v[:], state.t = xs[last].reshape(net.x0.shape), vs[last].reshape(net.x0.shape), float(t[last])
    state.dissipated, state.work, slowed = taken[last].tolist()
    state.slowed += int(slowed)
    state.force_evals += evals
    state.left_out = max(state.left_out, left_out)
    return Run(
        t, x_frames, v_frames, energies_of, evals, diverged_at, None, record.name, state.left_out, 0, int(slowed), state
    )  # fmt: skip


def is_closed(net: Net) -> bool:
    """True if no energy leaves or enters the net."""
    moved = net.pin_paths or net.grab is not None or any(net.sphere_velocity)
    return not (net.is_damped or moved)


def first_insane_time(net: Net, state: State, integrator: Integrator, h: float, steps: int) -> float:
    """Repeat, step by step, the end of a run that diverged, and return the time of the first bad step [s]."""
    for _ in range(steps):
        advance(net, state, integrator, h, 1)
        if not state.is_bounded:
            break
    return state.t


def per_point(net: Net, frames: NDArray[np.float64]) -> NDArray[np.float64]:
    """(frames, 3, rows, cols) as the caller's (frames, points, 3) or (frames, rows, cols, 3)."""
    moved = np.moveaxis(frames, 1, -1)
    return np.ascontiguousarray(moved[:, 0] if net.is_rope else moved)
