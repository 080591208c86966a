"""The cloth: curtain, flag, drape, trampoline. Arrows move its pins and a sphere; every particle can be dragged."""

import dataclasses
import functools
import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.messages import DivergenceError, Grab, Place, PlotRow, Release, SceneCommand, StudentAnswer, Vector
from app.scenes.charts import PlotAxes
from app.scenes.cloth.live_values import live_values
from app.scenes.cloth.parameters import ABOUT, MAX_ACCOUNTED_PARTICLES, PRESETS, Params, hidden
from app.scenes.cloth.start import build, sphere_home
from app.scenes.contract import FRAME_INTERVAL, Pieces, SceneKind
from app.scenes.moments import copied, restore
from app.scenes.plot_rows import PlotRows
from app.scenes.springs.divergence import MAX_OVERSHOOT, LastMoments, divergence_text
from app.scenes.springs.drag import Drag, PullFrame
from app.scenes.springs.laws import SPRING, pieces_of_law, pieces_on_use
from app.scenes.springs.speed_advice import faster_steps
from app.scenes.springs.thread_tuner import ThreadTuner
from app.scenes.springs.tracking import CriticallyDampedTracker
from app.scenes.springs.warmup import GAUGE, integrator_pieces
from sim.springs import Air, Net, cloth
from sim.springs import Grab as Pull
from sim.springs.analysis.energy_account import EnergyAccount
from sim.springs.analysis.extremes import extremes
from sim.springs.analysis.strain import structural_strain
from sim.springs.automatic import AUTO
from sim.springs.integrator_fallback import integrator_or_fallback
from sim.springs.net import PinPath
from sim.springs.resampling import resample
from sim.springs.stability import Gauge, gauge, gershgorin
from sim.springs.state import State, advance, energy, velocities

if TYPE_CHECKING:
    from app.lab.live_code import LiveCode
    from app.scenes.cloth.student_cloth import StudentCloth

ASSESSMENT_INTERVAL = 1.0  # [s] of simulated time between two assessments of the stability
MAX_ASSESSED_PARTICLES = 1100  # above this an assessment takes too long, and Gershgorin's bound is shown
MAX_SPHERE_SPEED = 3.0  # [m/s] along an axis, however fast it is dragged: faster, it would pass through the cloth
MIN_PARTICLES_FOR_TWO_THREADS = 2000
MAX_DISTANCE = 60.0  # [m] from the origin; farther out the run has diverged
PULL_LENGTH = 0.1  # [m] at which a pull has its largest force, if the step allows
MAX_PULL_STIFFNESS_STEP = 0.1  # stiffness of a pull over mass / step^2, so that the pull is stable at any step
BOB_RATE = 4.0  # [rad/s] of the sphere's motion up and down
ENERGY_SERIES = ("total", "kinetic", "elastic", "gravity", "contact", "dissipated")
SERIES = (*ENERGY_SERIES, "largest strain")
CHANGING = (  # as a cloth moves
    "net", "state", "account", "account_kept", "sphere", "handles", "ends", "anchors", "corrections",
)  # fmt: skip
PLOTS = {
    "plot_energy": PlotAxes("Energy", "J", ENERGY_SERIES),
    "plot_strain": PlotAxes("Largest strain", "%", ("largest strain",)),
}


class ClothFrame(NamedTuple):
    """Drawn state of a cloth."""

    points: NDArray[np.float32]  # (rows, cols, 3) [m], C-contiguous
    strain: NDArray[np.float32]  # (rows, cols), largest of the structural springs at a particle
    full_strain: float  # strain at the end of the colour scale
    pins: tuple[Vector, Vector] | None  # [m] where the two ends of the first row are going to
    pole: bool
    sphere: tuple[float, float, float, float] | None  # x, y, z, radius [m]
    sphere_home: Vector  # [m] where the sphere's arrows are
    handles: bool
    floor: bool
    grid: bool
    colour: str
    pull: PullFrame | None
    student: NDArray[np.float32] | None  # (r, c, 3) [m] the student's cloth beside the program's


class ClothReadings(NamedTuple):
    """The stability of the time step, and the cost of a step."""

    stability: Gauge
    exact: bool  # the gauge is that of the state; otherwise a bound for all states
    corrections: float  # Newton corrections a step, of implicit methods
    note: str  # why another method runs than the one chosen, or ""
    threads: int  # that compute the forces
    left_out: int = 0  # most particles that self-collision has left out, its list of pairs being full


def gusty_wind(params: Params, t: float) -> Vector:
    """The wind at time t [m/s]: three slow waves along it, across it and upwards."""
    along = params.wind * (1.0 + params.gust * (0.3 * math.sin(1.7 * t) + 0.2 * math.sin(4.3 * t + 1.0)))
    across = params.wind * params.gust * 0.35 * math.sin(2.3 * t + 0.5)
    bearing = math.radians(params.wind_direction)
    c, s = math.cos(bearing), math.sin(bearing)
    return c * along - s * across, s * along + c * across, params.wind * params.gust * 0.15 * math.sin(3.1 * t)


def warm_up(law: str = SPRING) -> Pieces:
    """Everything to compile that the scene may call with links of a law."""
    net = cloth(4, 4, floor=-1.0, sphere=(0.0, 0.0, -1.0, 0.2), thickness=0.1, law=law)
    gauge = functools.partial(compile_gauge, law)
    return {GAUGE: gauge, **integrator_pieces(net, cloth(4, 4, damping=0.0, law=law))}


def compile_gauge(law: str) -> None:
    """All but the integrators."""
    scene = ClothScene(Params(rows=4, cols=4, link=law))
    extremes(scene.state.x, scene.state.v)
    gershgorin(cloth(4, 4, thickness=0.1, law=law), scene.state.x)


def needs(params: Params) -> tuple[str, ...]:
    """Compiled pieces that a scene with these parameters runs."""
    net = build(params, sphere_home(params))
    return pieces_of_law((integrator_or_fallback(params.integrator, net, params.time_step)[0].name, GAUGE), params.link)


class ClothScene:
    """The cloth on the simulation thread."""

    frame_interval = FRAME_INTERVAL

    def __init__(self, params: Params, live: "LiveCode | None" = None) -> None:
        """live: runs a student's functions, where there are any."""
        self.params = params
        self.student: StudentCloth | None = None
        if live is not None:
            from app.scenes.cloth import student_cloth  # only `springtide lab DIR` pays for it

            self.student = student_cloth.StudentCloth(live.cloth)
        self.plot_rows = PlotRows(len(SERIES))
        self.last_moments = LastMoments()
        self.tuner = ThreadTuner()
        self.drag = Drag()
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
    def note(self) -> str:
        """Why another method runs than the one chosen, or ""."""
        return "" if self.params.integrator == AUTO else self.fallback_note

    @property
    def faster(self) -> str:
        """Advice on a faster step."""
        touches_itself = self.params.thickness > 0.0
        return faster_steps(
            self.integrator, self.stability.stability, "rows and columns", touches_itself=touches_itself
        )

    @property
    def particles(self) -> int:
        """Number of particles."""
        return self.params.rows * self.params.cols

    @property
    def with_account(self) -> bool:
        """True if the energy account is kept: always, except for large cloths with the plot of energies closed."""
        return self.params.plot_energy or self.particles <= MAX_ACCOUNTED_PARTICLES

    def reset(self) -> None:
        """The cloth, its pins and the sphere where the parameters start them."""
        self.sphere = CriticallyDampedTracker(sphere_home(self.params), MAX_SPHERE_SPEED)
        self.net = build(self.params, self.sphere.position)
        self.state = State.at_rest(self.net)
        self.account = EnergyAccount(self.net, self.state)
        self.account_kept = self.with_account
        self.drag.clear()
        self.hold_pins()
        self.corrections = 0.0
        self.plot_rows.restart()
        self.last_moments.clear()
        self.assess_stability()
        if self.student is not None:
            self.student.start(self.params, self.state)

    def keep(self) -> dict[str, object]:
        """Checkpoint: state, energy account and moved objects."""
        return copied({name: getattr(self, name) for name in CHANGING})

    def resume(self, kept: object) -> None:
        """Go on from a checkpoint of `keep`."""
        restore(self, kept)
        self.drag.clear()
        self.tuner.restart()
        self.plot_rows.resume()
        self.last_moments.clear()
        self.assess_stability()
        if self.student is not None:
            self.student.set_up(self.params)
            self.student.begin(self.student.rows_of(self.state.x), self.student.rows_of(self.state.v), self.state.t)

    def hold_pins(self) -> None:
        """Hold the pinned particles where they are, with a handle at each end of the first row."""
        x = self.state.x
        self.ends = [x[:, 0, 0].copy(), x[:, 0, -1].copy()]
        self.handles = [CriticallyDampedTracker(tuple(float(c) for c in end)) for end in self.ends]  # type: ignore[arg-type]
        self.anchors = {pin: x[:, pin[0], pin[1]].copy() for pin in self.net.pinned}

    def change_forces(self, params: Params) -> None:
        """Take new parameters. The motion goes on, interpolated where the grid changes."""
        old, self.params = self.params, params
        stored = self.account.stored(self.net, self.state)
        self.tuner.restart()
        self.net = build(params, self.sphere_at(self.state.t))
        if (params.rows, params.cols) != (old.rows, old.cols):
            self.state.x = resample(self.state.x, params.rows, params.cols)
            self.state.v = resample(self.state.v, params.rows, params.cols)
            self.drag.clear()
        if (params.rows, params.cols, params.pinned) != (old.rows, old.cols, old.pinned):
            self.hold_pins()
            for i, j in self.net.pinned:
                self.state.v[:, i, j] = 0.0
        self.account.book_change(stored, self.net, self.state)
        self.assess_stability()
        if self.student is not None:
            self.student.change(params, old, self.state)

    def handle(self, command: SceneCommand) -> None:
        """Move pins or sphere, pull a particle, or let go of it."""
        match command:
            case Place("pin a", position):
                self.handles[0].target = position
            case Place("pin b", position):
                self.handles[1].target = position
            case Place("sphere", position):
                self.sphere.target = position
            case Grab(index, target, client) if 0 <= index < self.particles:
                x, y, z = (float(c) for c in self.state.x.reshape(3, -1)[:, index])
                self.drag.move(client, index, (x, y, z), target)
            case Release(client):
                self.drag.release(client)
            case StudentAnswer() if self.student is not None:
                self.student.collect(MAX_DISTANCE)
            case _:
                pass

    def advance(self, steps: int) -> None:
        """Take steps. Raises DivergenceError where the cloth leaves its bounds, and keeps the last good state."""
        duration = steps * self.step
        with_account = self.with_account
        if with_account and not self.account_kept:
            self.account = EnergyAccount(self.net, self.state)
        self.account_kept = with_account
        good, state = self.state, self.state.copy()  # what is shown in the middle of the steps, and what moves
        net = self.net_during(good.t, duration)

        def take(threads: int, count: int) -> None:
            nonlocal net
            if net.threads != threads:  # a net is checked as a whole each time that one is made
                net = dataclasses.replace(net, threads=threads)
            advance(net, state, self.integrator, self.step, count, with_account=with_account)

        try:
            self.tuner.advance(steps, take, large=self.particles >= MIN_PARTICLES_FOR_TWO_THREADS)
        finally:  # where it is ended early the steps that were taken count
            if extremes(state.x, state.v).max_coordinate < MAX_DISTANCE:  # false of a NaN as well
                self.state = state
        if self.state is good:
            self.repeat_to_divergence(net, good, steps)
            raise DivergenceError(self.diagnosis(), tuple(self.last_moments))
        if self.integrator.implicit:
            self.corrections = (self.state.force_evals - good.force_evals) / steps
        self.net = net
        if self.student is not None:
            self.student.follow_cloth(net, good, self.state, self.step)
        if self.particles <= MAX_ASSESSED_PARTICLES and self.state.t - self.assessed_at >= ASSESSMENT_INTERVAL:
            self.assess_stability()
        if self.plot_rows.is_due(self.state.t):
            self.add_plot_row()

    def repeat_to_divergence(self, net: Net, good: State, steps: int) -> None:
        """Take the steps that left the bounds once more, keep a frame of each, and go back to the last good state."""
        self.state = good.copy()
        try:
            for _ in range(steps):
                advance(net, self.state, self.integrator, self.step, 1, with_account=False)
                distance = extremes(self.state.x, self.state.v).max_coordinate
                if distance < MAX_OVERSHOOT * MAX_DISTANCE:  # false of a NaN as well
                    self.frame()
                if not distance < MAX_DISTANCE:
                    break
        finally:  # it may be ended early
            self.state = good

    def net_during(self, t: float, duration: float) -> Net:
        """The net with the motions of pins, sphere and pull, and the wind, over the next `duration` [s] from time t."""
        before = self.sphere_at(t)
        self.sphere.advance(t, duration)
        after = self.sphere_at(t + duration)
        pull = None
        if self.drag.hold is not None:
            _, index, hand = self.drag.hold
            hand.advance(t, duration)
            row, col = divmod(index, self.params.cols)
            stiffness, damping = self.pull_spring(index)
            pull = Pull(row, col, hand.position, stiffness, damping, self.params.pull)
        return dataclasses.replace(
            self.net,
            pin_paths=self.pin_paths(t, duration),
            sphere=(*before, self.params.sphere_radius) if self.params.sphere else None,
            sphere_velocity=tuple((b - a) / duration for a, b in zip(before, after, strict=True)),
            epoch=t,
            grab=pull,
            air=Air(gusty_wind(self.params, t), self.params.air) if self.params.air > 0.0 else None,
        )

    def pull_spring(self, index: int) -> tuple[float, float]:
        """Stiffness [N/m] and damping [N s/m] of a pull on a particle."""
        mass = float(self.net.masses.flat[index])
        stiffest = MAX_PULL_STIFFNESS_STEP * mass / self.step**2
        stiffness = min(self.params.pull / PULL_LENGTH, stiffest)
        return stiffness, 0.5 * math.sqrt(stiffness * mass)

    def sphere_at(self, t: float) -> Vector:
        """Centre of the sphere at time t [m]."""
        x, y, z = self.sphere.position
        return x, y, z + self.params.bob * math.sin(BOB_RATE * t)

    def pin_paths(self, t: float, duration: float) -> tuple[tuple[tuple[int, int], PinPath], ...]:
        """The motion of each pinned particle: that of the two handles, by its place along the first row, and less the
        farther down it is."""
        starts = [handle.position for handle in self.handles]
        moves = [handle.advance(t, duration) for handle in self.handles]
        if moves == [None, None]:
            return ()
        still = ((0.0, 0.0, 0.0),) * 3
        cubics = [
            np.array(move.coefficients if move else (start, *still)) for move, start in zip(moves, starts, strict=True)
        ]
        for cubic, end in zip(cubics, self.ends, strict=True):
            cubic[0] -= end
        found = []
        for (i, j), anchor in self.anchors.items():
            along, down = j / (self.params.cols - 1), 1.0 - i / (self.params.rows - 1)
            c = down * ((1.0 - along) * cubics[0] + along * cubics[1])
            c[0] += anchor
            found.append(((i, j), PinPath(t, tuple(tuple(row) for row in c.tolist()))))  # type: ignore[arg-type]
        return tuple(found)

    def assess_stability(self) -> None:
        """Compare the step with its limit: at the state as it is where that is quick, else by a bound for all."""
        self.integrator, self.fallback_note = integrator_or_fallback(self.params.integrator, self.net, self.step)
        record = self.integrator
        exact = self.particles <= MAX_ASSESSED_PARTICLES
        if exact:
            stability = gauge(self.net, record, self.step, self.state)
        else:
            omega, rate = gershgorin(self.net, self.state.x)
            zeta = 0.5 * rate / omega if omega > 0.0 else 0.0
            limit = record.limit(zeta)
            stability = Gauge(omega, zeta, self.step * omega, limit, limit / omega if omega > 0.0 else math.inf)
        self.stability = ClothReadings(stability, exact, self.corrections, self.fallback_note, self.tuner.threads)
        self.assessed_at = self.state.t

    def diagnosis(self) -> str:
        """Cause of the divergence, and settings that would hold."""
        alternative = "" if self.integrator.implicit else "implicit Euler, which is stable at every step"
        return divergence_text(self.state.t, self.integrator, self.step, self.stability.stability, alternative)

    def curves(self) -> None:
        """This scene has charts over time only."""
        return

    def add_plot_row(self) -> None:
        """Add the energies and the largest strain at the scene's time."""
        e, state = energy(self.net, self.state), self.state
        dissipated = state.dissipated if self.account_kept else math.nan
        strain = 100.0 * float(structural_strain(self.net, self.state.x).max())
        self.plot_rows.add(state.t, e.total, e.kinetic, e.elastic, e.gravity, e.contact, dissipated, strain)

    def take_plot_rows(self) -> tuple[PlotRow, ...]:
        """The plot rows since the last call."""
        return self.plot_rows.take()

    def readings(self) -> ClothReadings:
        """Stability as last assessed, and the cost of the last steps."""
        threads, left_out = self.tuner.threads, self.state.left_out
        return self.stability._replace(corrections=self.corrections, threads=threads, left_out=left_out)

    def frame(self) -> ClothFrame:
        """Frame to draw; kept for a while, to be shown again if the run diverges."""
        params = self.params
        pull = None
        if self.drag.hold is not None:
            _, index, hand = self.drag.hold
            distance = float(np.linalg.norm(np.asarray(hand.position) - self.state.x.reshape(3, -1)[:, index]))
            pull = PullFrame(index, hand.position, min(1.0, distance * self.pull_spring(index)[0] / params.pull))
        x, student = self.state.x, None
        both = None if self.student is None else self.student.pictured(x)
        if both is not None:
            x, student = both
        frame = ClothFrame(
            points=np.ascontiguousarray(np.moveaxis(x, 0, -1), dtype=np.float32),
            strain=structural_strain(self.net, x).astype(np.float32),
            full_strain=0.01 * params.full_strain,
            pins=None if params.pinned == "free" else (self.handles[0].target, self.handles[1].target),
            pole=params.start == "flag" and params.pinned in ("corners", "edge"),
            sphere=(*self.sphere_at(self.time), params.sphere_radius) if params.sphere else None,
            sphere_home=self.sphere.target,
            floor=params.floor,
            grid=params.grid,
            handles=params.handles,
            colour=params.colour,
            pull=pull,
            student=student,
        )
        self.last_moments.add(self.state.t, frame, frame.points)
        return frame

    def arrays(self) -> dict[str, tuple[NDArray[np.float64], str]]:
        """The state for a file: name -> (array, unit)."""
        return {
            "x": (np.moveaxis(self.state.x, 0, -1).copy(), "m"),
            "v": (np.moveaxis(velocities(self.net, self.state), 0, -1).copy(), "m/s"),
            "energy": (np.array([*energy(self.net, self.state)]), "J: kinetic, elastic, gravity, contact"),
        }


SCENE = SceneKind(
    name="cloth",
    title="Cloth",
    help="<b>Drag the cloth</b> to pull it, or the arrows to move its pins and the sphere.",
    params=Params,
    presets=PRESETS,
    about=ABOUT,
    make=ClothScene,
    make_with_student=ClothScene,
    hidden=hidden,
    warm_up=warm_up,
    needs=needs,
    warm_up_on_use=functools.partial(pieces_on_use, warm_up),
    series=SERIES,
    plots=PLOTS,
    frame_units={"points": "m", "strain": "", "student": "m, a student's cloth beside the program's"},
    live_values=live_values,
)
