"""The cloth: curtain, flag, drape, trampoline. Arrows move its pins and a sphere; every particle can be dragged."""

import dataclasses
import functools
import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from app.messages import GrabTo, Place, Release, SceneCommand, StudentAnswer, Vector
from app.scenes.charts import PlotAxes
from app.scenes.cloth.frame import ClothFrame, ClothReadings
from app.scenes.cloth.parameters import MAX_ACCOUNTED_PARTICLES, ClothParams
from app.scenes.cloth.pins import Pins
from app.scenes.cloth.start import build, sphere_home
from app.scenes.contract import FRAME_INTERVAL, Pieces
from app.scenes.springs.grab import GrabSpring, ParticleGrab
from app.scenes.springs.laws import SPRING, pieces_of_law
from app.scenes.springs.methods import FEW_POINTS, method_that_runs
from app.scenes.springs.net_scene import NetScene
from app.scenes.springs.speed_advice import faster_steps
from app.scenes.springs.thread_tuner import ThreadTuner
from app.scenes.springs.tracking import CriticallyDampedTracker
from app.scenes.springs.warmup import GAUGE, integrator_pieces, pieces_of_methods
from sim.springs import Air, Net, cloth
from sim.springs.analysis.accuracy import STILL
from sim.springs.analysis.extremes import Extremes, extremes
from sim.springs.analysis.strain import structural_strain
from sim.springs.stability import Mode, gershgorin
from sim.springs.state import State, energy

if TYPE_CHECKING:
    from app.lab.student.live_code import LiveCode
    from app.scenes.cloth.student_cloth import StudentCloth

MAX_ASSESSED_PARTICLES = 1100  # above this an assessment takes too long, and Gershgorin's bound is shown
MAX_SPHERE_SPEED = 3.0  # [m/s] along an axis, however fast it is dragged: faster, it would pass through the cloth
MIN_PARTICLES_FOR_TWO_THREADS = 2000
MAX_REACH = 60.0  # [m] of a particle from the first one along an axis; beyond it the run has diverged
GRAB_LENGTH = 0.1  # [m] at which a grab has its largest force, if the step allows
MAX_GRAB_STIFFNESS_STEP = 0.1  # stiffness of a grab over mass / step^2, for explicit methods: its part of (h omega)^2
MIN_PULL = 2.0  # weights of the cloth that the mouse can pull at least
BOB_RATE = 4.0  # [rad/s] of the sphere's motion up and down
ENERGY_SERIES = ("total", "kinetic", "elastic", "gravity", "contact")
SERIES = (*ENERGY_SERIES, "dissipated", "largest strain")
PLOTS = {
    "plot_energy": PlotAxes("Energy", "J", ENERGY_SERIES, least=0.01),
    "plot_losses": PlotAxes("Dissipated energy", "J", ("dissipated",), least=0.01),
    "plot_strain": PlotAxes("Largest strain", "%", ("largest strain",), least=0.5),
}


def gusty_wind(params: ClothParams, t: float) -> Vector:
    """The wind at time t [m/s]: three slow waves along it, across it and upwards."""
    along = params.wind * (1.0 + params.gust * (0.3 * math.sin(1.7 * t) + 0.2 * math.sin(4.3 * t + 1.0)))
    across = params.wind * params.gust * 0.35 * math.sin(2.3 * t + 0.5)
    bearing = math.radians(params.wind_direction)
    c, s = math.cos(bearing), math.sin(bearing)
    return c * along - s * across, s * along + c * across, params.wind * params.gust * 0.15 * math.sin(3.1 * t)


def warm_up(law: str = SPRING) -> Pieces:
    """Everything to compile that the scene may call with links of a law."""
    net = cloth(4, 4, floor=-1.0, sphere=(0.0, 0.0, -1.0, 0.2), thickness=0.1, law=law)
    methods = integrator_pieces(net, cloth(4, 4, damping=0.0, law=law))
    return {**methods, GAUGE: functools.partial(compile_gauge, law)}


def compile_gauge(law: str) -> None:
    """All but the integrators."""
    scene = ClothScene(ClothParams(rows=4, cols=4, law=law))
    extremes(scene.state.x, scene.state.v)
    gershgorin(cloth(4, 4, thickness=0.1, law=law), scene.state.x)


def needs(params: ClothParams) -> tuple[str, ...]:
    """Compiled pieces that a scene with these parameters runs."""
    method = method_that_runs(params.integrator, params.time_step, lambda: build(small(params), sphere_home(params)))
    return pieces_of_law((*pieces_of_methods([method]), GAUGE), params.law)


def small(params: ClothParams) -> ClothParams:
    """A cloth of a few points that has the links of this one: its frequencies and damping have the same bounds."""
    rows, cols = min(params.rows, FEW_POINTS), min(params.cols, FEW_POINTS)
    width, length = params.width * (cols - 1) / (params.cols - 1), params.length * (rows - 1) / (params.rows - 1)
    return dataclasses.replace(params, rows=rows, cols=cols, width=width, length=length)


def cloth_bound(net: Net, state: State) -> float:
    """Largest reach [m] of a cloth."""
    return MAX_REACH


class ClothScene(NetScene[ClothParams]):
    """The cloth on the simulation thread."""

    CHANGING = ("motion", "account_kept", "sphere", "pins")
    ASSESSMENT_INTERVAL = 1.0
    frame_interval = FRAME_INTERVAL
    student: "StudentCloth | None" = None
    stability: ClothReadings

    def __init__(self, params: ClothParams, live: "LiveCode | None" = None) -> None:
        """live: runs a student's functions, if any."""
        if live is not None:
            from app.scenes.cloth import student_cloth  # only `springtide lab DIR` pays for it

            self.student = student_cloth.StudentCloth(live.cloth)
        self.tuner = ThreadTuner()
        self.grab = ParticleGrab()
        super().__init__(params)

    @property
    def faster(self) -> str:
        """Advice on a faster step."""
        touches_itself = self.params.thickness > 0.0
        return faster_steps(
            self.motion.method, self.stability.stability, "rows and columns", touches_itself=touches_itself
        )

    @property
    def particles(self) -> int:
        """Number of particles."""
        return self.params.rows * self.params.cols

    @property
    def with_account(self) -> bool:
        """True if the energy account is kept: always, except for large cloths with the plot of losses closed."""
        return self.params.plot_losses or self.particles <= MAX_ACCOUNTED_PARTICLES

    def build(self, params: ClothParams, sphere: Vector) -> Net:
        """The net that the parameters describe; beside a student's, only its points touch the sphere."""
        return build(params, sphere, of_tasks=self.student is not None)

    def reset(self) -> None:
        """The cloth, its pins and the sphere where the parameters start them."""
        self.sphere = CriticallyDampedTracker(sphere_home(self.params), MAX_SPHERE_SPEED)
        self.place_at_rest(self.build(self.params, self.sphere.position), cloth_bound)
        self.account_kept = self.with_account
        self.grab.clear()
        self.pins = Pins(self.net, self.state)
        self.assess_stability()
        if self.student is not None:
            self.student.start(self.params, self.state)

    def resume(self, checkpoint: object) -> None:
        """Resume from a checkpoint of `keep`."""
        super().resume(checkpoint)
        self.tuner.restart()
        self.assess_stability()
        if self.student is not None:
            self.student.set_up(self.params)
            self.student.begin(self.student.rows_of(self.state.x), self.student.rows_of(self.state.v), self.state.t)

    def change_forces(self, params: ClothParams) -> None:
        """Take new parameters. The motion continues, interpolated where the grid changes."""
        old, self.params = self.params, params
        self.tuner.restart()
        net = self.build(params, self.sphere_at(self.state.t))
        other_pins = (net.shape, net.pinned) != (self.net.shape, self.net.pinned)
        self.take_net(net, still_pins=other_pins)
        if other_pins:
            self.pins = Pins(net, self.state)
        self.assess_stability()
        if self.student is not None:
            self.student.change(params, old, self.state)

    def handle(self, command: SceneCommand) -> None:
        """Move pins or sphere, pull a particle, or let go of it."""
        match command:
            case Place("pin a", position):
                self.pins.handles[0].target = position
            case Place("pin b", position):
                self.pins.handles[1].target = position
            case Place("sphere", position):
                self.sphere.target = position
            case GrabTo(index, target, client) if 0 <= index < self.particles:
                x, y, z = (float(c) for c in self.state.x.reshape(3, -1)[:, index])
                self.grab.move(client, index, (x, y, z), target)
            case Release(client):
                self.grab.release(client)
            case StudentAnswer() if self.student is not None:
                self.student.collect(MAX_REACH)
            case _:
                pass

    def take_steps(self, net: Net, state: State, steps: int) -> Net:
        """Take steps of `net` in place, on one or two threads. Returns the net that took the last one."""
        with_account = self.with_account
        if with_account and not self.account_kept:
            self.motion.restart_account()
        self.account_kept = with_account

        def take(threads: int, count: int) -> None:
            nonlocal net
            if net.threads != threads:  # a net is checked as a whole each time that one is made
                net = dataclasses.replace(net, threads=threads)
            self.motion.take_steps(net, state, count, with_account=with_account)

        self.tuner.advance(steps, take, large=self.particles >= MIN_PARTICLES_FOR_TWO_THREADS)
        return net

    def moved(self, good: State, steps: int, extremes: Extremes) -> None:
        """Count the corrections, and let the student's cloth follow."""
        self.motion.count_evals()
        if self.student is not None:
            self.student.follow_cloth(self.net, good, self.state, self.step)

    def has_news(self) -> bool:
        """True if an assessment is quick."""
        return self.particles <= MAX_ASSESSED_PARTICLES

    def net_during(self, t: float, duration: float) -> Net:
        """The net with the motions of pins, sphere and grab, and the wind, over the next `duration` [s] from time t."""
        before = self.sphere_at(t)
        self.sphere.advance(t, duration)
        after = self.sphere_at(t + duration)
        return dataclasses.replace(
            self.net,
            pin_paths=self.pins.paths(t, duration),
            sphere=(*before, self.params.sphere_radius) if self.params.sphere else None,
            sphere_velocity=tuple((b - a) / duration for a, b in zip(before, after, strict=True)),
            epoch=t,
            grab=self.grab.pull(t, duration, self.net.shape, self.grab_spring),
            air=Air(gusty_wind(self.params, t), self.params.air) if self.params.air > 0.0 else None,
        )

    def grab_spring(self, particle: int) -> GrabSpring:
        """The spring of a grab of a particle."""
        mass, p = float(self.net.masses.flat[particle]), self.params
        largest = max(p.pull, MIN_PULL * float(self.net.masses.sum()) * p.gravity)
        stiffness = largest / GRAB_LENGTH
        if not self.motion.method.implicit:
            stiffness = min(stiffness, MAX_GRAB_STIFFNESS_STEP * mass / self.step**2)
        return GrabSpring(stiffness, 0.5 * math.sqrt(stiffness * mass), largest)

    def sphere_at(self, t: float) -> Vector:
        """Centre of the sphere at time t [m]."""
        x, y, z = self.sphere.position
        return x, y, z + self.params.bob * math.sin(BOB_RATE * t)

    def assess_stability(self) -> None:
        """Compare the step with its limit: at the state as it is where that is quick, else by a bound for all."""
        exact, modes, motion = self.particles <= MAX_ASSESSED_PARTICLES, None, None
        if not exact:
            omega, rate = gershgorin(self.net, self.state.x)
            modes, motion = [Mode(omega**2, omega**2, rate)], STILL  # accuracy is not assessed
        stability, corrections = self.motion.gauge(modes, motion), self.motion.corrections
        if not exact:
            stability = stability._replace(landed_step=math.inf)  # the bound counts floor and sphere already
        readings = ClothReadings(stability, exact, corrections, self.fallback_note, self.tuner.threads)
        self.stability = self.recent.worst(self.state.t, readings)
        self.assessed_at = self.state.t

    def alternative(self) -> str:
        """A method that would hold."""
        return "" if self.motion.method.implicit else "implicit Euler, which is stable at every step"

    def add_plot_row(self) -> None:
        """Add the energies and the largest strain at the scene's time."""
        e, state = energy(self.net, self.state), self.state
        dissipated = state.dissipated if self.account_kept else math.nan
        strain = 100.0 * float(structural_strain(self.net, self.state.x).max())
        self.plot_rows.add(state.t, e.total, e.kinetic, e.elastic, e.gravity, e.contact, dissipated, strain)

    def readings(self) -> ClothReadings:
        """The worst stability of the last assessments, and the cost of the last steps."""
        return self.stability._replace(
            corrections=self.motion.corrections,
            threads=self.tuner.threads,
            left_out=self.state.left_out,
            solver=self.motion.solver_report(),
        )

    def frame(self) -> ClothFrame:
        """Frame to draw; kept for a while, to be shown again if the run diverges."""
        params = self.params
        x, student = self.state.x, None
        both = None if self.student is None else self.student.pictured(x)
        if both is not None:
            x, student = both
        frame = ClothFrame(
            params=params,
            points=np.ascontiguousarray(np.moveaxis(x, 0, -1), dtype=np.float32),
            strain=structural_strain(self.net, x).astype(np.float32),
            pins=None if params.pinned == "free" else self.pins.targets,
            sphere=(*self.sphere_at(self.time), params.sphere_radius) if params.sphere else None,
            sphere_home=self.sphere.target,
            grab=self.grab.frame(self.state.x, self.grab_spring),
            student=student,
        )
        self.last_moments.add(self.state.t, frame, frame.points)
        return frame

    def laid_out(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Positions or velocities (3, rows, cols) as (rows, cols, 3)."""
        return np.moveaxis(values, 0, -1).copy()
