"""The rope of springs, part 2 of the lab: its root and its points can be dragged."""

import functools
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.messages import (
    DivergenceError,
    Grab,
    Place,
    PlotRow,
    Release,
    SceneCommand,
    StudentAnswer,
    Vector,
    vector_of,
)
from app.scenes.charts import PlotAxes
from app.scenes.contract import FRAME_INTERVAL, Pieces, SceneKind, StabilityMap
from app.scenes.moments import copied, restore
from app.scenes.plot_rows import PlotRows
from app.scenes.rope.live_values import live_values
from app.scenes.rope.measures import measures
from app.scenes.rope.parameters import ABOUT, PRESETS, Params, hidden
from app.scenes.springs.divergence import MAX_OVERSHOOT, LastMoments, divergence_text, leapfrog_alternative
from app.scenes.springs.drag import PullFrame
from app.scenes.springs.laws import SPRING, pieces_of_law, pieces_on_use
from app.scenes.springs.rope_handles import RopeHandles
from app.scenes.springs.rope_parameters import ROOT, SPHERE, build_rope, stiffness_parameter
from app.scenes.springs.speed_advice import faster_steps
from app.scenes.springs.warmup import GAUGE, integrator_pieces
from sim.springs import Net, rope
from sim.springs.analysis.energy_account import EnergyAccount
from sim.springs.analysis.extremes import extremes
from sim.springs.analysis.tension import rope_tension
from sim.springs.automatic import AUTO
from sim.springs.integrator_fallback import integrator_or_fallback
from sim.springs.resampling import resample
from sim.springs.stability import Gauge, critical_stiffness, gauge, top_modes
from sim.springs.state import State, advance, energy, velocities

if TYPE_CHECKING:
    from app.lab.live_code import LiveCode
    from app.scenes.rope.student_rope import StudentRope

ASSESSMENT_INTERVAL = 0.5  # [s] of simulated time between two assessments of the stability
MIN_MOVE_TO_ASSESS = 1e-3  # of a link: a rope that has moved by less since the last assessment is as stable as it was
FULL_RATE_SPEED = 0.6  # [m/s] on screen: 10 mm, about two pixels, between frames at the highest rate
QUARTER_RATE_SPEED = 0.075  # [m/s] on screen: 5 mm between frames at a quarter of it
ENERGY_SERIES = ("total", "kinetic", "elastic", "gravity", "contact", "dissipated", "error")
SERIES = (*ENERGY_SERIES, "tip height")
CHANGING = ("net", "state", "account", "handles", "corrections", "max_reach")  # as a rope moves
PLOTS = {
    "plot_energy": PlotAxes("Energy", "J", ENERGY_SERIES),
    "plot_tip": PlotAxes("Height of the tip", "m", ("tip height",)),
}


class RopeFrame(NamedTuple):
    """Drawn state of a rope: the student's if there is one, with the program's beside it."""

    points: NDArray[np.float32]  # (n, 3) [m], C-contiguous
    reference: NDArray[np.float32] | None  # (n, 3) [m] the program's rope beside the student's
    tension: NDArray[np.float32]  # (n - 1,) [N]
    full_scale: float  # [N] tension at the end of the colour scale
    root: Vector  # [m] where the root is going to
    sphere: tuple[float, float, float, float] | None  # x, y, z, radius [m]
    handles: bool
    floor: bool
    grid: bool
    colour: str
    show_points: bool
    pull: PullFrame | None


class NumericalCost(NamedTuple):
    """Cost of an implicit method since it was chosen."""

    corrections: float  # Newton corrections a step, lately
    numerical_dissipation: float  # [J] that the method took, negative where it fed the motion
    damping_dissipation: float  # [J] that the rope's own damping took


class RopeReadings(NamedTuple):
    """The stability of the time step, and the largest values that would be stable."""

    stability: Gauge
    parameter: str  # name of the stiffness parameter in use
    largest_stiffness: float  # in that parameter's unit
    note: str  # why another method runs than the one chosen, or ""
    cost: NumericalCost | None  # None for explicit methods


def build(params: Params, root: Vector = ROOT, sphere: Vector = SPHERE) -> Net:
    """The net that the parameters describe, with root and sphere centre there [m]."""
    return build_rope(params, root, (*sphere, params.sphere_radius) if params.sphere else None)


def warm_up(law: str = SPRING) -> Pieces:
    """Everything to compile that the scene may call with links of a law."""
    net = rope(4, floor=-1.0, sphere=(0.0, 0.0, -1.0, 0.2), law=law)
    gauge = functools.partial(compile_gauge, law)
    return {GAUGE: gauge, **integrator_pieces(net, rope(4, damping=0.0, drag=0.0, law=law))}


def compile_gauge(law: str) -> None:
    """All but the integrators."""
    scene = RopeScene(Params(link=law))
    extremes(scene.state.x, scene.state.v)
    scene.frame()


def needs(params: Params) -> tuple[str, ...]:
    """Compiled pieces that a scene with these parameters runs."""
    method = integrator_or_fallback(params.integrator, build(params), params.time_step)[0].name
    return pieces_of_law((method, GAUGE), params.link)


def rows_of(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Positions or velocities (3, 1, n) of a rope's state as (n, 3)."""
    return np.ascontiguousarray(x[:, 0].T)


def state_of(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points (n, 3) as a rope's state has them, (3, 1, n)."""
    return np.ascontiguousarray(points.T[:, None])


class RopeScene:
    """The rope on the simulation thread."""

    def __init__(self, params: Params, live: "LiveCode | None" = None) -> None:
        """live: runs a student's functions, where there are any."""
        self.params = params
        self.student: StudentRope | None = None
        if live is not None:
            from app.scenes.rope import student_rope  # only `springtide lab DIR` pays for it

            self.student = student_rope.StudentRope(live.rope)
        self.handles = RopeHandles()
        self.plot_rows = PlotRows(len(SERIES))
        self.last_moments = LastMoments()
        self.checks = 0  # of the stability, while it moves
        self.reset()

    @property
    def step(self) -> float:
        """Time step [s]."""
        return self.params.time_step

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.state.t

    @property
    def frame_interval(self) -> float:
        """Time [s] between frames: two or four times the shortest where nothing moves fast enough to be seen."""
        fastest = max(self.max_speed, 0.0 if self.student is None else self.student.max_speed)
        speed_on_screen = fastest * self.params.speed
        if speed_on_screen > FULL_RATE_SPEED or not self.handles.at_rest:
            return FRAME_INTERVAL
        is_plotted = self.params.plot_energy or self.params.plot_tip  # which takes a row each `ROW_INTERVAL`
        return 2.0 * FRAME_INTERVAL if speed_on_screen > QUARTER_RATE_SPEED or is_plotted else 4.0 * FRAME_INTERVAL

    @property
    def note(self) -> str:
        """Why another method runs than the one chosen, or ""."""
        return "" if self.params.integrator == AUTO else self.fallback_note

    @property
    def faster(self) -> str:
        """Advice on a faster step."""
        return faster_steps(self.integrator, self.stability.stability, "points")

    def reset(self) -> None:
        """The rope at rest, level from its root; root and sphere where a new scene has them."""
        self.handles.restart()
        self.net = build(self.params, self.handles.root.position, self.handles.sphere.position)
        self.state = State.at_rest(self.net)
        self.account = EnergyAccount(self.net, self.state)
        self.counted = 0, 0  # force evaluations and steps at the last assessment
        self.corrections = 0.0
        self.plot_rows.restart()
        self.last_moments.clear()
        self.set_bounds()
        self.assess_stability()
        if self.student is not None:
            self.student.restart(rows_of(self.state.x), rows_of(self.state.v))

    def keep(self) -> dict[str, object]:
        """Checkpoint: state, energy account and moved objects."""
        return copied({name: getattr(self, name) for name in CHANGING})

    def resume(self, kept: object) -> None:
        """Go on from a checkpoint of `keep`."""
        restore(self, kept)
        self.handles.drag.clear()
        self.counted = self.state.force_evals, self.state.steps
        self.plot_rows.resume()
        self.last_moments.clear()
        self.max_speed = np.inf
        self.assess_stability()
        if self.student is not None:
            self.student.begin(rows_of(self.state.x), rows_of(self.state.v), self.state.t)

    def set_bounds(self) -> None:
        """How far a rope of these parameters may get; how fast it is going to be is not known."""
        # Three times the length of the hanging rope, and some room. At a bound of 1e9 m nothing could be seen.
        sag = self.net.mass * abs(self.net.gravity[2]) / self.net.families[0].stiffness
        n = self.params.points - 1
        reach = extremes(self.state.x, self.state.v).reach
        self.max_reach = 4.0 + 3.0 * (self.params.length + 0.5 * sag * n * (n + 1)) + reach  # [m] from the root
        self.max_speed = np.inf  # [m/s] along an axis, of the fastest point

    def change_forces(self, params: Params) -> None:
        """Take new parameters. The motion goes on, interpolated where the number of points changes."""
        old, self.params = self.params, params
        stored = self.account.stored(self.net, self.state)
        self.net = build(params, self.handles.root.position, self.handles.sphere.position)
        if params.points != old.points:
            self.state.x = resample(self.state.x, 1, params.points)
            self.state.v = resample(self.state.v, 1, params.points)
            self.handles.drag.clear()
        self.account.book_change(stored, self.net, self.state)
        if (params.integrator, params.time_step) != (old.integrator, old.time_step):
            self.account.start_method(self.net, self.state)
        self.set_bounds()
        self.assess_stability()
        if self.student is not None and (params.points, params.integrator) != (old.points, old.integrator):
            self.student.begin(rows_of(self.state.x), rows_of(self.state.v), self.state.t)

    def handle(self, command: SceneCommand) -> None:
        """Move root or sphere, pull a point, or let go of it."""
        match command:
            case Place("root", position):
                self.handles.move_root(position)
            case Place("sphere", position):
                self.handles.sphere.target = position
            case Grab(0, target, client) if self.handles.drag.may_move(client):
                self.handles.move_root(target)
            case Grab(index, target, client) if 0 < index < self.params.points:
                self.handles.drag.move(client, index, vector_of(self.state.x[:, 0, index]), target)
            case Release(client):
                self.handles.drag.release(client)
            case StudentAnswer() if self.student is not None:
                self.student.collect(self.max_reach)
            case _:
                pass

    def advance(self, steps: int) -> None:
        """Take steps. Raises DivergenceError where the rope leaves its bounds, and keeps the last good state."""
        good, state = self.state, self.state.copy()  # what is shown in the middle of the steps, and what moves
        net = self.handles.net_during(self.net, good.t, steps * self.step, self.step, self.params)
        try:
            advance(net, state, self.integrator, self.step, steps, with_account=True)
        finally:  # where it is ended early the steps that were taken count
            found = extremes(state.x, state.v)
            if found.reach < self.max_reach:  # false of a NaN as well
                self.state = state
        if self.state is good:
            self.repeat_to_divergence(net, good, steps)
            raise DivergenceError(self.diagnosis(), tuple(self.last_moments))
        self.max_speed = found.speed
        if net.pin_paths and self.handles.root.at_rest:  # it has just come to rest
            self.state.x[:, 0, 0] = self.handles.root.position
            self.state.v[:, 0, 0] = 0.0
        self.net = net
        if self.student is not None:
            x, v = rows_of(self.state.x), rows_of(self.state.v)
            self.student.follow_rope(net, good.t, steps, self.params, x, v)
        if self.state.t - self.assessed_at >= ASSESSMENT_INTERVAL and self.has_news():
            self.checks += 1
            self.assess_stability()
        if self.plot_rows.is_due(self.state.t):
            self.add_plot_row()

    def repeat_to_divergence(self, net: Net, good: State, steps: int) -> None:
        """Take the steps that left the bounds once more, keep a frame of each, and go back to the last good state."""
        self.state = good.copy()
        try:
            for _ in range(steps):
                advance(net, self.state, self.integrator, self.step, 1, with_account=True)
                reach = extremes(self.state.x, self.state.v).reach
                if reach < MAX_OVERSHOOT * self.max_reach:  # false of a NaN as well
                    self.frame()
                if not reach < self.max_reach:
                    break
        finally:  # it may be ended early
            self.state = good

    def has_news(self) -> bool:
        """True if the stability, or the cost of an implicit method, may have changed since the last assessment."""
        moved = float(np.abs(self.state.x - self.assessed_x).max())
        return self.integrator.implicit or moved > MIN_MOVE_TO_ASSESS * self.net.families[0].rest

    def assess_stability(self) -> None:
        """Compare the step with the limits at the state as it is, and sum up the cost of an implicit method."""
        self.integrator, self.fallback_note = integrator_or_fallback(self.params.integrator, self.net, self.step)
        modes = top_modes(self.net, self.state.x, self.state.t)
        stability = gauge(self.net, self.integrator, self.step, self.state, modes)
        largest = critical_stiffness(self.net, self.integrator, self.step, self.state, modes)
        parameter = stiffness_parameter(self.params)
        if parameter == "axial_stiffness":
            largest *= self.net.families[0].rest
        self.stability = RopeReadings(stability, parameter, largest, self.fallback_note, self.numerical_cost())
        self.assessed_at, self.assessed_x = self.state.t, self.state.x.copy()

    def numerical_cost(self) -> NumericalCost | None:
        """The cost of an implicit method; None for explicit ones."""
        if not self.integrator.implicit:
            return None
        steps = self.state.steps - self.counted[1]
        if steps:
            evals = (self.state.force_evals - self.counted[0]) / steps
            self.corrections = max(0.0, evals - self.integrator.evals_outside_newton)
            self.counted = self.state.force_evals, self.state.steps
        account = self.account
        taken = account.numerical_dissipation(self.net, self.state)
        return NumericalCost(self.corrections, taken, account.damping_dissipation(self.state))

    def diagnosis(self) -> str:
        """Cause of the divergence, and settings that would hold."""
        g = self.stability.stability
        alternative = leapfrog_alternative(self.integrator, g)
        return divergence_text(self.state.t, self.integrator, self.step, g, alternative)

    def add_plot_row(self) -> None:
        """Add the energy account and the tip's height at the scene's time."""
        e, state, account = energy(self.net, self.state), self.state, self.account
        gained = e.gravity - account.initial.gravity
        error = account.error(self.net, state)
        tip = float(state.x[2, 0, -1])
        total = e.kinetic + e.elastic + gained + e.contact
        self.plot_rows.add(state.t, total, e.kinetic, e.elastic, gained, e.contact, state.dissipated, error, tip)

    def take_plot_rows(self) -> tuple[PlotRow, ...]:
        """The plot rows since the last call."""
        return self.plot_rows.take()

    def readings(self) -> RopeReadings:
        """Stability and cost, as last assessed."""
        return self.stability

    def curves(self) -> None:
        """This scene has charts over time only."""
        return

    def tension(self) -> NDArray[np.float64]:
        """(n - 1,) spring force along each link [N], negative under compression."""
        return rope_tension(self.net, self.state.x)

    def frame(self) -> RopeFrame:
        """Frame to draw; kept for a while, to be shown again if the run diverges."""
        params, handles = self.params, self.handles
        weight = self.net.mass * abs(self.net.gravity[2]) * (params.points - 1)
        both = None if self.student is None else self.student.drawn(rows_of(self.state.x))
        x = self.state.x if both is None else state_of(both[0])
        held = x[:, 0, handles.drag.hold.particle if handles.drag.hold else 0]
        frame = RopeFrame(
            points=np.ascontiguousarray(x[:, 0].T, dtype=np.float32),
            reference=None if both is None else both[1].astype(np.float32),
            tension=rope_tension(self.net, x).astype(np.float32),
            full_scale=max(1.25 * weight, 1e-3),
            root=handles.home,
            sphere=(*handles.sphere.position, params.sphere_radius) if self.net.sphere else None,
            floor=params.floor,
            grid=params.grid,
            handles=params.handles,
            colour=params.colour,
            show_points=params.show_points,
            pull=handles.pull_frame(held, 0.0, self.net.mass, self.step, params.pull),
        )
        self.last_moments.add(self.state.t, frame, frame.points)
        return frame

    def arrays(self) -> dict[str, tuple[NDArray[np.float64], str]]:
        """The state for a file: name -> (array, unit)."""
        return {
            "x": (self.state.x[:, 0].T.copy(), "m"),
            "v": (velocities(self.net, self.state)[:, 0].T.copy(), "m/s"),
            "energy": (np.array([*energy(self.net, self.state)]), "J: kinetic, elastic, gravity, contact"),
        }


SCENE = SceneKind(
    name="rope",
    title="Rope",
    help="<b>Drag the rope</b> to pull it, or the arrows to move its root.",
    params=Params,
    presets=PRESETS,
    about=ABOUT,
    opening="Shaken at the root",
    make=RopeScene,
    make_with_student=RopeScene,
    hidden=hidden,
    warm_up=warm_up,
    needs=needs,
    warm_up_on_use=functools.partial(pieces_on_use, warm_up),
    series=SERIES,
    plots=PLOTS,
    frame_units={"points": "m", "reference": "m, the program's rope beside a student's", "tension": "N"},
    measures=measures,
    stability_map=StabilityMap(stiffness_parameter, build),
    live_values=live_values,
)
