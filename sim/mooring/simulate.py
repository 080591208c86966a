"""`simulate`: a mooring in time, by any explicit integrator of ropes."""

import math
import warnings
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.interruption import raise_if_stopped
from sim.mooring.statics import Rest, at_rest
from sim.mooring.system import System
from sim.springs import INTEGRATORS
from sim.springs.acceleration import set_acceleration
from sim.springs.analysis.energy import energies
from sim.springs.analysis.energy_history import EnergyHistory, energy_history
from sim.springs.forces.bending import set_line_tensions
from sim.springs.integrators import Integrator, integrator_named
from sim.springs.line_arrays import LineArrays
from sim.springs.stability import critical_step
from sim.springs.state import State
from sim.validation import argument_error, check_number, check_vector, is_whole_number

SAFETY = 0.5  # of the critical step at rest
PIECE = 0.05  # [s] of a moved point's path that is one cubic
DIFFERENCE = 1e-4  # [s] either side, of a motion without a velocity of its own
MOST_STEPS = 1e9
MOST_FRAMES = 1_000_000
FARTHEST = 1e6  # [m]: a node that is farther has diverged

Motion = Callable[[float], Any]


class MooringRun(NamedTuple):
    """A simulated motion."""

    t: NDArray[np.float64]  # (frames,) [s]
    x: dict[int, NDArray[np.float64]]  # by line: (frames, segments + 1, 3) [m]
    tension: dict[int, NDArray[np.float64]]  # by line: (frames, segments) [N], internal damping included
    bodies: dict[int, NDArray[np.float64]]  # by body: (frames, 6) [m, rad] from its place
    energy: EnergyHistory  # by name, (frames,) each [J]; `contact` is the bed's
    force_evals: int
    diverged_at: float | None  # [s]
    step: float  # [s] that was taken
    integrator: str


class LineState:
    """Positions and velocities (3, n) of a system at time t [s], and the sums of the energy account [J]."""

    def __init__(self, system: System, rest: Rest) -> None:
        self.system = system
        self.x = rest.nodes.copy()
        self.v = np.zeros_like(self.x)
        self.t = 0.0
        self.lag = 0.0
        self.ledger = np.zeros(2)
        self.force_evals = 0

    @property
    def is_bounded(self) -> bool:
        """False once anything is not finite or is out of any sane bound."""
        return bool(np.abs(self.x).max() < FARTHEST)

    def advance(
        self,
        integrator: Integrator,
        h: float,
        steps: int,
        paths: NDArray[np.float64],
        with_account: bool = False,
        driven: Mapping[str, NDArray[np.float64]] | None = None,
    ) -> None:
        """Advance by `steps` steps of h [s]; coupled points follow `paths`, (coupled points, 5, 3) of `PinPath`s.

        driven: other fields of `LineArrays` that a caller changes as time passes, as `steady` or `waves`.
        """
        p = self.system.kernel_view(h)._replace(paths=paths, **(driven or {}))
        x, lag = self.x.reshape(-1), integrator.lag * h
        v = self.v.reshape(-1)
        v[:], self.lag = self.velocities(p, lag), lag
        raise_if_stopped()
        self.force_evals += integrator.advance(x, v, self.ledger, self.t, h, steps, p, with_account)
        self.t += steps * h

    def velocities(self, p: LineArrays, lag: float) -> NDArray[np.float64]:
        """Velocities (3 n,) at time t - lag [s]: those stored, where they are of that time."""
        v = self.v.reshape(-1)
        if lag == self.lag:
            return v
        a = np.empty_like(v)
        set_acceleration(self.x.reshape(-1), v, self.t, p, a)
        return v + (self.lag - lag) * a


def check_motion(system: System, motion: Mapping[int, Motion]) -> None:
    """Raises ValueError for a motion of a point that is not coupled, or that is no function."""
    coupled = [point.id for point in system.points if point.kind == "coupled"]
    for one, function in motion.items():
        if one not in coupled:
            raise argument_error("motion", one, f"the id of a coupled point: {coupled}")
        if not callable(function):
            raise argument_error(f"motion[{one}]", function, "a function of the time [s]")
        check_vector(f"motion[{one}](0)", function(0.0), "m")


def place_and_velocity(function: Motion, t: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Position [m] and velocity [m/s] of a motion at time t [s]."""
    place = np.asarray(function(t), dtype=np.float64)
    velocity = getattr(function, "velocity", None)
    if velocity is not None:
        return place, np.asarray(velocity(t), dtype=np.float64)
    before, after = np.asarray(function(t - DIFFERENCE), float), np.asarray(function(t + DIFFERENCE), float)
    return place, (after - before) / (2.0 * DIFFERENCE)


def paths_of(system: System, motion: Mapping[int, Motion], t: float, duration: float) -> NDArray[np.float64]:
    """Paths of the coupled points from t on for `duration` [s]: cubics through places and velocities at both ends."""
    coupled = [point for point in system.points if point.kind == "coupled"]
    paths = np.zeros((len(coupled), 5, 3))
    for q, point in enumerate(coupled):
        paths[q, 4] = t
        if point.id not in motion:
            paths[q, 0] = point.position
            continue
        (x0, v0), (x1, v1) = (place_and_velocity(motion[point.id], s) for s in (t, t + duration))
        gap = (x1 - x0) / duration
        paths[q, :4] = x0, v0, (3.0 * gap - 2.0 * v0 - v1) / duration, (v0 + v1 - 2.0 * gap) / duration**2
    return paths


def simulate(
    system: System,
    motion: Mapping[int, Motion] | None = None,
    duration: float = 10.0,
    frames: int = 101,
    step: float | None = None,
    *,
    integrator: str | Integrator = "leapfrog",
    with_account: bool = False,
    start: Rest | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> MooringRun:
    """Integrate `system` from rest and sample it at `frames` equal times from 0 to `duration` [s].

    motion: by the id of a coupled point, a function of the time [s] that gives its place (3,) [m]; its velocity is that
    of `function.velocity(t)` where there is one, else by differences. Points without one stay where they are.
    step: [s], half the critical step at rest by default, shortened equally so that it divides a frame interval.
    start: a state to begin with, None: `at_rest` with the moved points where they begin.
    with_account: also integrate what damping takes and what moved points and water put in.
    A run that diverges ends there: later frames are NaN, and a RuntimeWarning says so.

    Raises ValueError, naming the argument, its value and what is allowed, and ConvergenceError without a state of rest.
    """
    if not isinstance(system, System):
        raise argument_error("system", type(system), "a System, as `read_moordyn` makes it")
    motion = dict(motion or {})
    check_motion(system, motion)
    check_number("duration", duration, 0, math.inf, "s", above=True)
    if not is_whole_number(frames) or not 2 <= frames <= MOST_FRAMES:
        raise argument_error("frames", frames, f"a whole number from 2 to {MOST_FRAMES}")
    record = integrator_named(integrator)
    if record.implicit or record.undamped_only:
        usable = [one.name for one in INTEGRATORS.values() if not (one.implicit or one.undamped_only)]
        allowed = f"one of {', '.join(usable)}: implicit methods know no water, bed or bodies, and pefrl no damping"
        raise argument_error("integrator", record.name, allowed)
    if step is not None:
        check_number("step", step, 0, math.inf, "s", above=True)
    start = start or at_rest(system, {one: np.asarray(f(0.0), dtype=np.float64) for one, f in motion.items()})
    h = step or SAFETY * critical_step(system, record, State.still(start.nodes))
    if not h > 0.0 or duration / h > MOST_STEPS:
        raise argument_error("step", h, f"at least duration / {MOST_STEPS:g} = {duration / MOST_STEPS:g} s")
    return run_of(system, motion, record, np.linspace(0.0, duration, int(frames)), h, start, with_account, progress)


def run_of(
    system: System,
    motion: Mapping[int, Motion],
    record: Integrator,
    t: NDArray[np.float64],
    h: float,
    start: Rest,
    with_account: bool,
    progress: Callable[[int, int], None] | None,
) -> MooringRun:
    """The run at times `t` [s] in equal steps of at most h [s]."""
    interval = float(t[1])
    pieces = max(1, math.ceil(interval / PIECE - 1e-9)) if motion else 1
    steps = max(1, math.ceil(interval / pieces / h * (1.0 - 1e-9)))
    h = interval / (pieces * steps)
    state, p = LineState(system, start), system.kernel_view(h)
    xs = np.full((len(t), *state.x.shape), np.nan)
    tensions, ledger = np.full((len(t), len(p.ends)), np.nan), np.full((len(t), 6), np.nan)
    diverged_at = None
    for frame in range(len(t)):
        if frame:
            for piece in range(pieces):
                begin = float(t[frame - 1]) + piece * interval / pieces
                state.t = begin
                paths = paths_of(system, motion, begin, interval / pieces)
                state.advance(record, h, steps, paths, with_account)
            if not state.is_bounded:
                diverged_at = float(t[frame])
                warnings.warn(
                    f"the run with {record.name} in steps of {h:g} s diverged before t = {diverged_at:g} s: later "
                    "frames are NaN; critical_step(system, integrator) is the longest step that is stable at rest",
                    RuntimeWarning,
                    stacklevel=3,
                )
                break
        x, v = state.x.reshape(-1), state.velocities(p, 0.0)
        xs[frame] = state.x
        set_line_tensions(x, v, p, tensions[frame])
        ledger[frame] = *energies(x, v, state.t, p), *state.ledger
        if progress:
            progress(frame + 1, len(t))
    x_of = {one: np.ascontiguousarray(np.moveaxis(xs[:, :, nodes], 1, -1)) for one, nodes in system.nodes_of.items()}
    tension_of = {one: tensions[:, links] for one, links in system.links_of.items()}
    m = p.nodes
    bodies = {
        body.id: np.concatenate((xs[:, :, m + 2 * b], xs[:, :, m + 2 * b + 1]), axis=1)
        for b, body in enumerate(system.bodies)
    }
    return MooringRun(
        t,
        x_of,
        tension_of,
        bodies,
        energy_history(ledger, with_account),
        state.force_evals,
        diverged_at,
        h,
        record.name,
    )
