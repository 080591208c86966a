"""The rope of springs, part 2 of the lab: its root and its points can be dragged."""

import dataclasses
import functools
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from app.messages import SceneCommand, StudentAnswer, Vector, vector_of
from app.scenes.charts import Columns, CurveAxes, PlotAxes
from app.scenes.contract import FRAME_INTERVAL, Pieces
from app.scenes.rope.frame import NumericalCost, RopeFrame, RopeReadings
from app.scenes.rope.parameters import RopeParams
from app.scenes.rope.start import root_home, start_points
from app.scenes.springs.divergence import leapfrog_alternative
from app.scenes.springs.grab import ParticleGrab
from app.scenes.springs.laws import SPRING, pieces_of_law, pieces_on_use
from app.scenes.springs.methods import FEW_POINTS, method_that_runs
from app.scenes.springs.net_motion import rope_lengths
from app.scenes.springs.net_scene import NetScene
from app.scenes.springs.rope_handles import RopeHandles, grab_spring
from app.scenes.springs.rope_parameters import ROOT, ROPE_RADIUS, SPHERE, build_rope, stiffness_parameter
from app.scenes.springs.speed_advice import faster_steps
from app.scenes.springs.warmup import GAUGE, integrator_pieces, pieces_of_methods
from sim.springs import LAWS, Net, rope
from sim.springs.analysis.extremes import Extremes, extremes
from sim.springs.analysis.tension import rope_tension
from sim.springs.stability import critical_stiffness, top_modes
from sim.springs.state import State, energy

if TYPE_CHECKING:
    from app.lab.student.live_code import LiveCode
    from app.scenes.rope.student_rope import StudentRope

MIN_MOVE_TO_ASSESS = 1e-3  # of a link: a rope that has moved by less since the last assessment is as stable as it was
TOUCH = 0.25  # links from the surface of the sphere within which a point turns with it: a link touches between its ends
FULL_RATE_SPEED = 0.6  # [m/s] on screen: 10 mm, about two pixels, between frames at the highest rate
QUARTER_RATE_SPEED = 0.075  # [m/s] on screen: 5 mm between frames at a quarter of it
ENERGY_SERIES = ("total", "kinetic", "elastic", "gravity", "contact")
LOSS_SERIES = ("dissipated", "error")
SERIES = (*ENERGY_SERIES, *LOSS_SERIES, "tip height")
PLOTS = {
    "plot_energy": PlotAxes("Energy", "J", ENERGY_SERIES, least=0.1),
    "plot_losses": PlotAxes("Dissipated energy", "J", LOSS_SERIES, least=0.1),
    "plot_tip": PlotAxes("Height of the tip", "m", ("tip height",), least=0.02),
}

CURVES = {
    "plot_along": CurveAxes(
        "Tension along the rope",
        "N",
        "Distance from the root [m]",
        ("tension", "root\u2019s \u00d7 exp(\u03bc\u03b8), most that friction holds without the rope\u2019s weight"),
        least=0.1,
    )
}


def build(params: RopeParams, root: Vector = ROOT, sphere: Vector = SPHERE, *, of_tasks: bool = False) -> Net:
    """The net that the parameters describe, with root and sphere centre there [m], see `build_rope`.

    of_tasks: only what the tasks' functions have: points that touch, one held root, equal masses.
    """
    ball = (*sphere, params.sphere_radius) if params.sphere else None
    net = build_rope(params, root, ball, self_contact=params.self_contact, of_tasks=of_tasks)
    if params.start != "level":
        net = dataclasses.replace(net, x0=state_of(start_points(params, root)))
    if params.end_held and not of_tasks:
        net = dataclasses.replace(net, pinned=net.pinned | {(0, params.points - 1)})
    if params.tip_mass > 0.0 and not of_tasks:
        ratios = net.masses / net.mass
        ratios[0, -1] += params.tip_mass / net.mass
        net = dataclasses.replace(net, mass_ratios=ratios)
    return net


def warm_up(law: str = SPRING, *, touching: bool = False) -> Pieces:
    """Everything to compile that the scene may call with links of a law. touching: of ropes that touch themselves."""
    rope_of = functools.partial(rope, 4, law=law, radius=ROPE_RADIUS, self_contact=touching)
    net = rope_of(floor=-1.0, sphere=(0.0, 0.0, -1.0, 0.2))
    methods = integrator_pieces(net, rope_of(damping=0.0, drag=0.0))
    return {**methods, GAUGE: functools.partial(compile_gauge, law, touching)}


def pieces_of_touch(names: tuple[str, ...]) -> tuple[str, ...]:
    """Names of the pieces for ropes that touch themselves."""
    return tuple(f"{name}, touching itself" for name in names)


def warm_up_on_use() -> Pieces:
    """The pieces of ropes with other laws, and of those that touch themselves."""
    others = dict(pieces_on_use(warm_up))
    for law in LAWS:
        own = warm_up(law, touching=True)
        others |= zip(pieces_of_touch(pieces_of_law(tuple(own), law)), own.values(), strict=True)
    return others


def compile_gauge(law: str, touching: bool) -> None:
    """All but the integrators."""
    scene = RopeScene(RopeParams(law=law, self_contact=touching))
    extremes(scene.state.x, scene.state.v)
    scene.frame()


def needs(params: RopeParams) -> tuple[str, ...]:
    """Compiled pieces that a scene with these parameters runs."""
    method = method_that_runs(params.integrator, params.time_step, lambda: build(small(params)))
    names = pieces_of_law((*pieces_of_methods([method]), GAUGE), params.law)
    return pieces_of_touch(names) if params.self_contact else names


def small(params: RopeParams) -> RopeParams:
    """A rope of a few points that has the links of this one: its frequencies and damping have the same bounds."""
    points = min(params.points, FEW_POINTS)
    return dataclasses.replace(params, points=points, length=params.length * (points - 1) / (params.points - 1))


def rows_of(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Positions or velocities (3, 1, n) of a rope's state as (n, 3)."""
    return np.ascontiguousarray(x[:, 0].T)


def state_of(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points (n, 3) as a rope's state has them, (3, 1, n)."""
    return np.ascontiguousarray(points.T[:, None])


def rope_bound(net: Net, state: State) -> float:
    """Largest reach [m] of a rope: three times the length at which it hangs, its present reach, and a margin."""
    # At a bound of 1e9 m nothing could be seen.
    return 4.0 + 3.0 * sum(rope_lengths(net)) + extremes(state.x, state.v).reach


class RopeScene(NetScene[RopeParams]):
    """The rope on the simulation thread."""

    CHANGING = ("motion", "handles")
    ASSESSMENT_INTERVAL = 0.5
    student: "StudentRope | None" = None
    stability: RopeReadings

    def __init__(self, params: RopeParams, live: "LiveCode | None" = None) -> None:
        """live: runs a student's functions, if any."""
        if live is not None:
            from app.scenes.rope import student_rope  # only `springtide lab DIR` pays for it

            self.student = student_rope.StudentRope(live.rope)
        self.handles = RopeHandles()
        super().__init__(params)

    @property
    def grab(self) -> ParticleGrab:  # type: ignore[override]
        """The drag of a point."""
        return self.handles.grab

    @property
    def frame_interval(self) -> float:
        """Time [s] between frames: two or four times the shortest where nothing moves fast enough to be seen."""
        fastest = max(self.max_speed, 0.0 if self.student is None else self.student.max_speed)
        speed_on_screen = fastest * self.params.speed
        if speed_on_screen > FULL_RATE_SPEED or not self.handles.at_rest:
            return FRAME_INTERVAL
        is_plotted = any(getattr(self.params, name) for name in PLOTS)  # which take a row each `ROW_INTERVAL`
        return 2.0 * FRAME_INTERVAL if speed_on_screen > QUARTER_RATE_SPEED or is_plotted else 4.0 * FRAME_INTERVAL

    @property
    def faster(self) -> str:
        """Advice on a faster step."""
        touches = self.net.thickness > 0.0
        return faster_steps(self.motion.method, self.stability.stability, "points", touches_itself=touches)

    def build(self, params: RopeParams) -> Net:
        """The net that the parameters describe. Beside a student's rope only points touch, as the tasks have it."""
        handles = self.handles
        return build(params, handles.root.position, handles.sphere.position, of_tasks=self.student is not None)

    def reset(self) -> None:
        """The rope at rest, in the shape in which it begins; root and sphere where a new scene has them."""
        params, root = self.params, root_home(self.params)
        is_held = params.end_held and self.student is None
        self.handles.restart(root, vector_of(start_points(params, root)[-1]) if is_held else None)
        self.place_at_rest(self.build(params), rope_bound)
        self.max_speed = np.inf  # [m/s] of the fastest point along an axis; how fast it is going to be is not known
        self.assess_stability()
        if self.student is not None:
            self.student.restart(rows_of(self.state.x), rows_of(self.state.v))

    def resume(self, checkpoint: object) -> None:
        """Resume from a checkpoint of `keep`."""
        super().resume(checkpoint)
        self.max_speed = np.inf
        self.assess_stability()
        if self.student is not None:
            self.student.begin(rows_of(self.state.x), rows_of(self.state.v), self.state.t)

    def change_forces(self, params: RopeParams) -> None:
        """Take new parameters. The motion continues, interpolated where the number of points changes."""
        old, self.params = self.params, params
        self.take_net(self.build(params))
        self.max_speed = np.inf
        self.assess_stability()
        if self.student is not None and (params.points, params.integrator) != (old.points, old.integrator):
            self.student.begin(rows_of(self.state.x), rows_of(self.state.v), self.state.t)

    def handle(self, command: SceneCommand) -> None:
        """Move root or sphere, pull a point, or let go of it."""
        match command:
            case StudentAnswer() if self.student is not None:
                self.student.collect(self.motion.max_reach)
            case _:
                self.handles.handle(command, [self.state])

    def net_during(self, t: float, duration: float) -> Net:
        """The net with the motions of root, sphere and pull over the next `duration` [s] from time t [s]."""
        return self.handles.net_during(self.net, t, duration, self.step, self.params)

    def moved(self, good: State, steps: int, extremes: Extremes) -> None:
        """Put an end that has just come to rest in its place, and let the student's rope follow."""
        self.max_speed = extremes.speed
        for (_, column), _ in self.net.pin_paths:
            held = self.handles.root if column == 0 else self.handles.end
            if held is not None and held.at_rest:
                self.motion.place_pin(column, held.position)
        if self.student is not None:
            x, v = rows_of(self.state.x), rows_of(self.state.v)
            self.student.follow_rope(self.net, good.t, steps, self.params, x, v)

    def has_news(self) -> bool:
        """True if the stability, or the cost of an implicit method, may have changed since the last assessment."""
        moved = float(np.abs(self.state.x - self.assessed_x).max())
        return self.motion.method.implicit or moved > MIN_MOVE_TO_ASSESS * self.net.families[0].rest

    def assess_stability(self) -> None:
        """Compare the step with the limits at the state as it is, and sum up the cost of an implicit method."""
        motion = self.motion
        modes = top_modes(motion.net, motion.state.x, motion.state.t)
        largest = critical_stiffness(motion.net, motion.method, motion.step, motion.state, modes)
        parameter = stiffness_parameter(self.params)
        if parameter == "axial_stiffness":
            largest *= self.net.families[0].rest
        cost = self.numerical_cost()
        readings = RopeReadings(motion.gauge(modes), parameter, largest, self.fallback_note, cost)
        solver = motion.solver_report()
        self.stability = self.recent.worst(self.state.t, readings)._replace(cost=cost, solver=solver)
        self.assessed_at, self.assessed_x = self.state.t, self.state.x.copy()

    def numerical_cost(self) -> NumericalCost | None:
        """The cost of an implicit method; None for explicit ones."""
        motion = self.motion
        motion.count_evals()
        if not motion.method.implicit:
            return None
        by_damping = motion.account.damping_dissipation(motion.state)
        return NumericalCost(motion.corrections, motion.numerical_dissipation(), by_damping)

    def alternative(self) -> str:
        """The step at which leapfrog would hold."""
        return leapfrog_alternative(self.motion.method, self.stability.stability)

    def add_plot_row(self) -> None:
        """Add the energy account and the tip's height at the scene's time."""
        e, state = energy(self.net, self.state), self.state
        gained = e.gravity - self.motion.account.initial.gravity
        error = self.motion.energy_error()
        tip = float(state.x[2, 0, -1])
        total = e.kinetic + e.elastic + gained + e.contact
        self.plot_rows.add(state.t, total, e.kinetic, e.elastic, gained, e.contact, state.dissipated, error, tip)

    def curves(self) -> dict[str, Columns] | None:
        """The tension along the rope, beside the most that friction on the sphere holds without the rope's weight."""
        sphere = self.net.sphere
        if not self.params.plot_along or sphere is None:
            return None
        tension = self.tension()
        middle = self.net.families[0].rest * (np.arange(tension.size) + 0.5)
        return {"plot_along": (middle, tension, tension[0] * self.capstan_ratios(sphere))}

    def capstan_ratios(self, sphere: tuple[float, float, float, float]) -> NDArray[np.float64]:
        """(n - 1,) exp(mu theta) of each link, theta [rad] the angle by which the rope has turned on the sphere."""
        x, y, z, radius = sphere
        points = rows_of(self.state.x)
        links = np.diff(points, axis=0)
        links /= np.maximum(np.linalg.norm(links, axis=1), 1e-12)[:, None]
        turn = np.arccos(np.clip((links[1:] * links[:-1]).sum(axis=1), -1.0, 1.0))
        touches = (
            np.linalg.norm(points[1:-1] - (x, y, z), axis=1)
            < radius + self.net.radius + TOUCH * self.net.families[0].rest
        )
        return np.exp(self.params.friction * np.concatenate([[0.0], np.where(touches, turn, 0.0).cumsum()]))

    def readings(self) -> RopeReadings:
        """The worst stability of the last assessments, and the cost, as last assessed."""
        return self.stability

    def tension(self) -> NDArray[np.float64]:
        """(n - 1,) spring force along each link [N], negative under compression."""
        return rope_tension(self.net, self.state.x)

    def frame(self) -> RopeFrame:
        """Frame to draw; kept for a while, to be shown again if the run diverges."""
        params, handles = self.params, self.handles
        weight = float(self.net.masses[0, 1:].sum()) * abs(self.net.gravity[2])
        both = None if self.student is None else self.student.drawn(rows_of(self.state.x))
        x = self.state.x if both is None else state_of(both[0])
        frame = RopeFrame(
            params=params,
            points=np.ascontiguousarray(x[:, 0].T, dtype=np.float32),
            reference=None if both is None else both[1].astype(np.float32),
            tension=rope_tension(self.net, x).astype(np.float32),
            full_scale=max(1.25 * weight, 1e-3),
            root=handles.home,
            sphere=(*handles.sphere.position, params.sphere_radius) if self.net.sphere else None,
            grab=handles.grab_frame([x], grab_spring(self.net, self.step, params.pull)),
        )
        self.last_moments.add(self.state.t, frame, frame.points)
        return frame

    def laid_out(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Positions or velocities (3, 1, points) as (points, 3)."""
        return values[:, 0].T.copy()
