"""The cloth: curtain, flag, drape, trampoline; pins and a sphere on gizmos, every particle to be grabbed."""

import dataclasses
import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.messages import DivergenceError, Grab, Place, Release, SceneCommand, Vector, WorkCounts
from app.scenes.charts import PlotAxes
from app.scenes.cloth.parameters import PRESETS, Params, hidden
from app.scenes.cloth.start import build, sphere_home
from app.scenes.contract import FRAME_INTERVAL, SceneKind
from app.scenes.springs.thread_tuner import ThreadTuner
from app.scenes.springs.work_counts import SpringWorkCounts
from sim.springs import INTEGRATORS, Air, Net, cloth, simulate
from sim.springs import Grab as Pull
from sim.springs.analysis.extremes import extremes
from sim.springs.analysis.strain import structural_strain
from sim.springs.integrator_fallback import integrator_or_fallback
from sim.springs.net import PinPath
from sim.springs.resampling import resample
from sim.springs.stability import Gauge, gauge, gershgorin
from sim.springs.state import State, advance, energy, velocities
from sim.springs.tracking import CriticallyDampedTracker

TITLE = "Cloth"
LOOK_EVERY = 0.5  # [s] of simulated time between two looks at the stability of the state
LOOKED_THROUGH = 1100  # particles up to which that is quick; of larger cloths Gershgorin's bound is shown
SAMPLE_EVERY = 1 / 30  # [s]
TOP_SPEED = 3.0  # [m/s] of the sphere along an axis, however fast it is dragged: what the cloth can keep clear of
LARGE = 2000  # particles from which two threads may be quicker
BOUND = 60.0  # [m] from the origin, beyond which the run has diverged
HELP = "<b>Drag the cloth</b> anywhere to pull it. <b>Drag the arrows</b> to move its pins and the sphere."
SERIES = ("kinetic", "elastic", "gravity", "contact", "dissipated", "largest strain")
PLOTS = {
    "plot_energy": PlotAxes("Energy", "J", ("kinetic", "elastic", "gravity", "contact", "dissipated")),
    "plot_strain": PlotAxes("Largest strain", "%", ("largest strain",)),
}


class PullShown(NamedTuple):
    """The drawn pull: from a particle to its target [m], and the part of the largest force it takes."""

    particle: int
    target: Vector
    load: float


class ClothFrame(NamedTuple):
    """What the viewer draws of a cloth."""

    points: NDArray[np.float32]  # (rows, cols, 3) [m]
    strain: NDArray[np.float32]  # (rows, cols), of the structural springs at a particle
    full_strain: float
    pins: tuple[Vector, Vector] | None  # where the two handles are going [m]
    pole: bool
    sphere: tuple[float, float, float, float] | None
    sphere_home: Vector
    floor: bool
    grid: bool
    colour: str
    pull: PullShown | None


class ClothReadings(NamedTuple):
    """How near to its limit the integrator works."""

    stability: Gauge
    exact: bool  # of the state as it is; else a bound for any
    corrections: float  # of Newton's method a step, of implicit methods
    note: str  # why another method runs than the one chosen, or ""
    threads: int  # that the forces are worked out on


def gusty(params: Params, t: float) -> Vector:
    """The wind at time t [m/s]: three slow waves along, across and up."""
    along = params.wind * (1.0 + params.gust * (0.3 * math.sin(1.7 * t) + 0.2 * math.sin(4.3 * t + 1.0)))
    across = params.wind * params.gust * 0.35 * math.sin(2.3 * t + 0.5)
    c, s = math.cos(params.wind_direction), math.sin(params.wind_direction)
    return c * along - s * across, s * along + c * across, params.wind * params.gust * 0.15 * math.sin(3.1 * t)


def warm_up() -> Iterator[str]:
    """Compile everything the scene may call, piece by piece; yields what comes next."""
    net = cloth(4, 4, floor=-1.0, sphere=(0.0, 0.0, -1.0, 0.2), thickness=0.1)
    for name, record in INTEGRATORS.items():
        yield name
        quiet = cloth(4, 4, damping=0.0)
        simulate(quiet if record.undamped_only else net, name, 1e-4, 2e-4, 2, with_account=True)
    yield "stability"
    Scene(Params(rows=4, cols=4))


class Scene:
    """The cloth on the simulation thread."""

    def __init__(self, params: Params) -> None:
        self.params = params
        self.samples: list[tuple[float, ...]] = []
        self.counts = SpringWorkCounts()
        self.cores = ThreadTuner()
        self.reset()

    @property
    def step(self) -> float:
        return self.params.time_step

    frame_interval = FRAME_INTERVAL

    @property
    def time(self) -> float:
        return self.state.t

    @property
    def note(self) -> str:
        """Why something else runs than the parameters ask for, or ""."""
        return self.fallback_note

    def reset(self) -> None:
        """The cloth, its pins and the sphere where the parameters start them."""
        self.sphere = CriticallyDampedTracker(sphere_home(self.params), TOP_SPEED)
        self.net = build(self.params, self.sphere.position)
        self.state = State.at_rest(self.net)
        self.held: tuple[int, CriticallyDampedTracker] | None = None
        self.hold()
        self.corrections = 0.0
        self.samples.append((float("nan"),) * (len(SERIES) + 1))  # a gap in the plots
        self.sampled_at = -np.inf
        self.look()

    def hold(self) -> None:
        """Hold the pinned particles where they are, with a handle at each end of the first row."""
        x = self.state.x
        self.ends = [x[:, 0, 0].copy(), x[:, 0, -1].copy()]
        self.handles = [CriticallyDampedTracker(tuple(float(c) for c in end)) for end in self.ends]  # type: ignore[arg-type]
        self.anchors = {pin: x[:, pin[0], pin[1]].copy() for pin in self.net.pinned}

    def change_forces(self, params: Params) -> None:
        """Take new parameters; the motion goes on, resampled where the grid changes, unless it is another start."""
        old, self.params = self.params, params
        self.cores.forget()
        self.net = build(params, self.sphere.position)
        if (params.rows, params.cols) != (old.rows, old.cols):
            self.state.x = resample(self.state.x, params.rows, params.cols)
            self.state.v = resample(self.state.v, params.rows, params.cols)
            self.held = None
        if (params.rows, params.cols, params.pinned) != (old.rows, old.cols, old.pinned):
            self.hold()
            for i, j in self.net.pinned:
                self.state.v[:, i, j] = 0.0
        self.state.dissipated = self.state.work = 0.0
        self.look()

    def handle(self, command: SceneCommand) -> None:
        match command:
            case Place("pin a", position):
                self.handles[0].target = position
            case Place("pin b", position):
                self.handles[1].target = position
            case Place("sphere", position):
                self.sphere.target = position
            case Grab(index, target) if 0 <= index < self.params.rows * self.params.cols:
                if self.held is None or self.held[0] != index:
                    x = self.state.x.reshape(3, -1)[:, index]
                    self.held = index, CriticallyDampedTracker((float(x[0]), float(x[1]), float(x[2])))
                self.held[1].target = target
            case Release():
                self.held = None

    def advance(self, steps: int) -> None:
        """Take steps with pins, sphere and pull on their ways; raises DivergenceError, keeping the last good state."""
        duration = steps * self.step
        good = self.state.copy()
        net = self.net_under_way(self.state.t, duration)

        def take(threads: int, count: int) -> None:
            shared = dataclasses.replace(net, threads=threads)
            advance(shared, self.state, self.integrator, self.step, count, with_account=self.params.plot_energy)
            self.counts.add("steps on two threads", count, threads == 2)

        self.cores.advance(steps, take, large=self.params.rows * self.params.cols >= LARGE)
        self.counts.take(net, self.state.force_evals - good.force_evals, steps, with_account=self.params.plot_energy)
        if not extremes(self.state.x, self.state.v).max_coordinate < BOUND:  # nor is a NaN
            self.state = good
            raise DivergenceError(self.diagnosis())
        if self.integrator.implicit:
            self.corrections = (self.state.force_evals - good.force_evals) / steps
        self.net = net
        due = self.params.rows * self.params.cols <= LOOKED_THROUGH and self.state.t - self.looked_at >= LOOK_EVERY
        self.counts.add("looks at the stability", 1, due)
        if due:
            self.look()
        if (self.params.plot_energy or self.params.plot_strain) and self.state.t - self.sampled_at >= SAMPLE_EVERY:
            self.sample()

    def net_under_way(self, t: float, duration: float) -> Net:
        """The net with the motions of pins, sphere and pull, and the wind, over the next `duration` [s]."""
        before = self.sphere_at(t)
        self.sphere.advance(t, duration)
        after = self.sphere_at(t + duration)
        pull = None
        if self.held is not None:
            index, hand = self.held
            hand.advance(t, duration)
            row, col = divmod(index, self.params.cols)
            stiffness, damping = self.grip()
            pull = Pull(row, col, hand.position, stiffness, damping, self.params.pull)
        return dataclasses.replace(
            self.net,
            pin_paths=self.paths(t, duration),
            sphere=(*before, self.params.sphere_radius) if self.params.sphere else None,
            sphere_velocity=tuple((b - a) / duration for a, b in zip(before, after, strict=True)),
            epoch=t,
            grab=pull,
            air=Air(gusty(self.params, t), self.params.air) if self.params.air > 0.0 else None,
        )

    def grip(self) -> tuple[float, float]:
        """Stiffness [N/m] and damping [N s/m] of a pull: all its force within 0.1 m, if the step allows."""
        stiffest = 0.1 * self.net.mass / self.step**2
        stiffness = min(10.0 * self.params.pull, stiffest)
        return stiffness, 0.5 * math.sqrt(stiffness * self.net.mass)

    def sphere_at(self, t: float) -> Vector:
        x, y, z = self.sphere.position
        return x, y, z + self.params.bob * math.sin(4.0 * t)

    def paths(self, t: float, duration: float) -> tuple[tuple[tuple[int, int], PinPath], ...]:
        """Each pinned particle moves with the handles: by its place along the first row, less far down."""
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

    def look(self) -> None:
        """Judge the stability: of the state as it is where that is quick, else by a bound for all states."""
        self.integrator, self.fallback_note = integrator_or_fallback(self.params.integrator, self.net)
        record = self.integrator
        exact = self.params.rows * self.params.cols <= LOOKED_THROUGH
        if exact:
            stability = gauge(self.net, record, self.step, self.state)
        else:
            omega, rate = gershgorin(self.net)
            zeta = 0.5 * rate / omega if omega > 0.0 else 0.0
            limit = record.limit(zeta)
            stability = Gauge(omega, zeta, self.step * omega, limit, limit / omega if omega > 0.0 else math.inf)
        self.stability = ClothReadings(stability, exact, self.corrections, self.fallback_note, self.cores.threads)
        self.looked_at = self.state.t

    def diagnosis(self) -> str:
        """Why the run diverged and what would hold."""
        g = self.stability.stability
        name, h = self.integrator.name, self.step
        start = f"The cloth left its bounds at t = {self.state.t:.2f} s: h ω = {g.h_omega:.3g} "
        if g.h_omega > g.limit:
            holds = f"A step below {g.critical_step:.3g} s would hold" if g.critical_step > 0 else "No step holds"
            return f"{start}is over {name}'s limit {g.limit:.3g}. {holds}; so would implicit_euler at any."
        return (
            f"{start}is within the limit {g.limit:.3g} of {name}, so an impact or a pull was too sudden for the step. "
            f"Try h = {h / 4:.3g} s."
        )

    def work(self) -> WorkCounts:
        """Counts of what was computed and what was left out."""
        return self.counts()

    def curves(self) -> None:
        """No chart but over time."""
        return

    def sample(self) -> None:
        e = energy(self.net, self.state)
        largest_strain = 100.0 * float(structural_strain(self.net, self.state.x).max())
        row = (e.kinetic, e.elastic, e.gravity, e.contact, self.state.dissipated, largest_strain)
        self.samples.append((self.state.t, *row))
        self.sampled_at = self.state.t

    def take_plot_rows(self) -> tuple[tuple[float, ...], ...]:
        taken, self.samples = tuple(self.samples), []
        return taken

    def readings(self) -> ClothReadings:
        return self.stability._replace(corrections=self.corrections, threads=self.cores.threads)

    def frame(self) -> ClothFrame:
        params = self.params
        pull = None
        if self.held is not None:
            index, hand = self.held
            reach = float(np.linalg.norm(np.asarray(hand.position) - self.state.x.reshape(3, -1)[:, index]))
            pull = PullShown(index, hand.position, min(1.0, reach * self.grip()[0] / params.pull))
        return ClothFrame(
            points=np.ascontiguousarray(np.moveaxis(self.state.x, 0, -1), dtype=np.float32),
            strain=structural_strain(self.net, self.state.x).astype(np.float32),
            full_strain=0.01 * params.full_strain,
            pins=None if params.pinned == "free" else (self.handles[0].target, self.handles[1].target),
            pole=params.start == "flag" and params.pinned in ("corners", "edge"),
            sphere=(*self.sphere_at(self.time), params.sphere_radius) if params.sphere else None,
            sphere_home=self.sphere.target,
            floor=params.floor,
            grid=params.grid,
            colour=params.colour,
            pull=pull,
        )

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
    help=HELP,
    params=Params,
    presets=PRESETS,
    make=Scene,
    hidden=hidden,
    warm_up=warm_up,
    series=SERIES,
    plots=PLOTS,
)
