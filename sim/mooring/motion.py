"""Time integration of moorings with the explicit integrators, for `sim.springs.simulate`; coupling with a vessel.

`sim.springs.state.advance` moves a `State` of a mooring, along `paths_to` places of the coupled points, and
`point_forces` are the forces at them.
"""

import warnings
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.frames import Progress, check_steps, equal_steps, run_frames
from sim.mooring.parts import Point
from sim.mooring.rest.statics import at_rest
from sim.mooring.run import MooringRun
from sim.mooring.system import System
from sim.springs.analysis.energy import energies
from sim.springs.analysis.energy_history import energy_history
from sim.springs.forces.under_water.bending import set_line_tensions
from sim.springs.integrators import Integrator, integrator_named
from sim.springs.points.acceleration import set_node_forces
from sim.springs.simulate import SIMULATED, Simulated
from sim.springs.stability import critical_step
from sim.springs.state import State, advance, check_state, velocities
from sim.validation import ApproximationWarning, argument_error, check_positive, check_vector

SAFETY = 0.5  # of the critical step at the start
PIECE = 0.05  # [s] of a moved point's path in one cubic
DIFFERENCE = 1e-4  # [s] between the three places that give the velocity of a motion without one of its own
MOST_STEPS = 1e9
FARTHEST = 1e6  # [m], beyond which a node has diverged

Array = NDArray[np.float64]
Motion = Callable[[float], Any]


def check_motion(system: System, motion: Mapping[int, Motion], t: float) -> None:
    """Raises ValueError for a motion of a point that is not coupled, or that gives no place at time t [s]."""
    coupled = list(system.coupled_nodes)
    for one, function in motion.items():
        if one not in coupled:
            raise argument_error("motion", one, f"the id of a coupled point: {coupled}")
        if not callable(function):
            raise argument_error(f"motion[{one}]", function, "a function of the time [s]")
        check_vector(f"motion[{one}]({t:g})", function(t), "m")


def place_and_velocity(function: Motion, t: float) -> tuple[Array, Array]:
    """Position [m] and velocity [m/s] of a motion at time t [s]. It is not called at times before t."""
    place = np.asarray(function(t), dtype=np.float64)
    velocity = getattr(function, "velocity", None)
    if velocity is not None:
        return place, np.asarray(velocity(t), dtype=np.float64)
    near, far = (np.asarray(function(t + steps * DIFFERENCE), float) for steps in (1, 2))
    return place, (4.0 * near - 3.0 * place - far) / (2.0 * DIFFERENCE)


def cubic(x0: Array, v0: Array, x1: Array, v1: Array, t: float, duration: float) -> Array:
    """The path (5, 3) from time t [s] on for `duration` [s] through places [m] with velocities [m/s] at both ends."""
    gap = (x1 - x0) / duration
    c2, c3 = (3.0 * gap - 2.0 * v0 - v1) / duration, (v0 + v1 - 2.0 * gap) / duration**2
    return np.array((x0, v0, c2, c3, (t, 0.0, 0.0)))


def paths_of(system: System, state: State, motion: Mapping[int, Motion], duration: float) -> Array:
    """Paths (coupled points, 5, 3) of motions for `duration` [s] from a state's time; other points stay in place."""
    coupled = system.coupled_nodes
    paths = np.zeros((len(coupled), 5, 3))
    for q, (one, node) in enumerate(coupled.items()):
        if one in motion:
            (x0, v0), (x1, v1) = (place_and_velocity(motion[one], t) for t in (state.t, state.t + duration))
            paths[q] = cubic(x0, v0, x1, v1, state.t, duration)
        else:
            paths[q, 0] = state.x[:, node]
    return paths


def paths_to(system: System, state: State, ends: Mapping[int, tuple[ArrayLike, ArrayLike]], duration: float) -> Array:
    """Paths (coupled points, 5, 3) for `duration` [s] from the coupled points of a state.

    ends: by the id of a coupled point, its place [m] and velocity [m/s] at the end; the others stop where they are.
    `advance` takes the paths as `driven`; without any, coupled points are at their positions in `System.points`.

    >>> from sim.mooring import Line, LineType, Point, State, System, advance, paths_to, point_forces
    >>> from sim.ocean import Water
    >>> chain = LineType("chain", 0.05, 20.0, 1e8)
    >>> points = (Point(1, "fixed", (-60.0, 0.0, -30.0)), Point(2, "coupled", (0.0, 0.0, 0.0)))
    >>> system = System((Line(1, chain, 1, 2, 75.0, 20),), points, Water(depth=30.0))
    >>> state = State.at_rest(system)
    >>> for i in range(10):  # a vessel that moves by 0.1 m/s, in exchanges of 0.1 s
    ...     place = (0.01 * (i + 1), 0.0, 0.0)
    ...     paths = paths_to(system, state, {2: (place, (0.1, 0.0, 0.0))}, duration=0.1)
    ...     advance(system, state, "leapfrog", h=1e-3, steps=100, driven={"paths": paths})
    ...     force = point_forces(system, state)[2]  # [N] on the vessel
    >>> round(state.t, 6), force.shape
    (1.0, (3,))

    Raises ValueError for a point that is not coupled, and for an invalid place, velocity or duration.
    """
    check_state(system, state)
    check_positive("duration", duration, "s")
    coupled = system.coupled_nodes
    for one in ends:
        if one not in coupled:
            raise argument_error("ends", one, f"the id of a coupled point: {list(coupled)}")
    paths = np.zeros((len(coupled), 5, 3))
    for q, (one, node) in enumerate(coupled.items()):
        place, velocity = ends.get(one, (state.x[:, node], np.zeros(3)))
        x1 = np.array(check_vector(f"ends[{one}]: place", place, "m"))
        v1 = np.array(check_vector(f"ends[{one}]: velocity", velocity, "m/s"))
        paths[q] = cubic(state.x[:, node], state.v[:, node], x1, v1, state.t, duration)
    return paths


def point_forces(system: System, state: State) -> dict[int, Array]:
    """Force (3,) [N] of the mooring on the holder of each fixed or coupled point, by its id.

    It is the pull of the lines with the weight of half a segment of each, the point's own weight, and the force of
    water and bed on these; the inertia of that half and of the point is left out.

    Raises ValueError for a state of another system.
    """
    x, v = state.x.reshape(-1), velocities(system, state).reshape(-1)
    f = np.empty_like(x)
    set_node_forces(x, v, state.t, system.kernel_view(1.0), f)
    forces = f.reshape(3, -1)
    return {point.id: forces[:, i].copy() for i, point in enumerate(system.points) if is_held(point)}


def is_held(point: Point) -> bool:
    """True if something outside the system holds the point."""
    return point.kind in ("fixed", "coupled")


class MooringFrames:
    """Advances a mooring from frame to frame, and collects the results."""

    def __init__(
        self,
        system: System,
        motion: Mapping[int, Motion],
        record: Integrator,
        t: Array,
        step: float,
        start: State,
        with_account: bool,
    ) -> None:
        """t (frames,) [s]: since the start; step: [s] the longest allowed."""
        self.system, self.motion, self.record, self.with_account = system, motion, record, with_account
        self.t, self.evals, self.state, interval = start.t + t, start.force_evals, start.copy(), float(t[1])
        self.unsettled = start.unsettled
        self.place_moved()
        self.pieces, self.piece = equal_steps(interval, PIECE if motion else interval)  # [s] of paths
        self.steps, self.h = equal_steps(self.piece, step)
        self.p = system.kernel_view(self.h)
        self.x = np.full((len(t), *start.x.shape), np.nan)
        self.v, self.force = np.full_like(self.x, np.nan), np.full_like(self.x, np.nan)
        self.tension = np.full((len(t), len(self.p.ends)), np.nan)
        self.end_tension = np.full((len(t), 2 * len(system.lines)), np.nan)
        self.ledger = np.full((len(t), 6), np.nan)

    def advance(self, frame: int) -> None:
        """Advance from the previous frame to this one, along the paths of the coupled points."""
        for _ in range(self.pieces):
            paths = paths_of(self.system, self.state, self.motion, self.piece)
            advance(
                self.system, self.state, self.record, self.h, self.steps,
                with_account=self.with_account, driven={"paths": paths},
            )  # fmt: skip
            self.place_moved()

    def place_moved(self) -> None:
        """Put the moved points where their motions are at the state's time."""
        for i, point in enumerate(self.system.points):
            if point.id in self.motion:
                self.state.x[:, i], self.state.v[:, i] = place_and_velocity(self.motion[point.id], self.state.t)

    @property
    def is_bounded(self) -> bool:
        """False once a value is not finite or out of all sane bounds."""
        return bool(np.abs(self.state.x).max() < FARTHEST)

    def sample(self, frame: int) -> None:
        """Store the state as a frame."""
        state = self.state
        x, v = state.x.reshape(-1), velocities(self.system, state).reshape(-1)
        self.x[frame], self.v[frame] = state.x, v.reshape(state.x.shape)
        set_line_tensions(x, v, self.p, self.tension[frame])
        self.end_tension[frame] = self.system.line_ends.tensions(state.x, v, state.t, self.p)
        set_node_forces(x, v, state.t, self.p, self.force[frame].reshape(-1))
        self.ledger[frame] = *energies(x, v, state.t, self.p), state.dissipated, state.work

    def by_line(self, values: Array) -> dict[int, Array]:
        """(frames, 3, n) of all nodes as (frames, segments + 1, 3) by line."""
        nodes = self.system.nodes_of.items()
        return {one: np.ascontiguousarray(np.moveaxis(values[:, :, at], 1, -1)) for one, at in nodes}

    def by_body(self, values: Array) -> dict[int, Array]:
        """(frames, 3, n) of all points as (frames, 6) by body."""
        m = self.p.nodes
        return {
            body.id: np.concatenate((values[:, :, m + 2 * b], values[:, :, m + 2 * b + 1]), axis=1)
            for b, body in enumerate(self.system.bodies)
        }

    def run(self, diverged_at: float | None) -> MooringRun:
        """All frames."""
        tension = {one: self.tension[:, links] for one, links in self.system.links_of.items()}
        ends = {line.id: self.end_tension[:, 2 * i : 2 * i + 2].copy() for i, line in enumerate(self.system.lines)}
        held = {point.id: self.force[:, :, i].copy() for i, point in enumerate(self.system.points) if is_held(point)}
        return MooringRun(
            self.t,
            self.by_line(self.x),
            self.by_line(self.v),
            tension,
            ends,
            held,
            self.by_body(self.x),
            self.by_body(self.v),
            energy_history(self.ledger, self.with_account),
            self.state.force_evals - self.evals,
            diverged_at,
            self.h,
            self.record.name,
            self.state,
            self.state.unsettled - self.unsettled,
        )


def run_mooring(
    system: System,
    t: Array,
    step: float | None,
    integrator: str | Integrator,
    with_account: bool,
    progress: Progress,
    motion: Mapping[int, Motion] | None = None,
    start: State | None = None,
) -> MooringRun:
    """The run of a mooring at the times t [s] since its start, with the arguments of `simulate`."""
    motion = dict(motion or {})
    if start is not None:
        check_state(system, start, "start")
    check_motion(system, motion, 0.0 if start is None else start.t)
    record = integrator_named(integrator)
    system.check_integrator(record)
    if start is None:
        placed = {one: np.asarray(f(0.0), dtype=np.float64) for one, f in motion.items()}
        start = State.still(at_rest(system, placed).nodes)
    longest = critical_step(system, record, start)
    h = step or SAFETY * longest
    check_steps(float(t[-1]), h, MOST_STEPS, step is not None)
    if h > longest:
        text = (
            f"step: {h:g} s is above the critical step of {record.name} at the start, {longest:g} s: drag and slack "
            "lines may bound a motion that grows, and its tensions are wrong then"
        )
        warnings.warn(text, ApproximationWarning, stacklevel=3)
    history = MooringFrames(system, motion, record, t, h, start, with_account)
    done = run_frames(history, len(t), progress)
    return history.run(None if done == len(t) else float(history.t[done]))


SIMULATED[System] = Simulated(run_mooring, 10.0, 101, "leapfrog", ("motion", "start"))
