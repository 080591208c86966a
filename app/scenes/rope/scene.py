"""The rope of springs: the lab's part 2, with root and points to be dragged; alone, or in a race."""

import dataclasses
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.messages import DivergenceError, Grab, Place, Release, SceneCommand, Vector, WorkCounts
from app.scenes.charts import Chart, PlotAxes
from app.scenes.contract import FRAME_INTERVAL, SceneKind, StabilityMap
from app.scenes.race.race import Race, RaceReadings
from app.scenes.race.race_charts import CURVES, RaceCharts
from app.scenes.race.report import RaceFrame, place_of, race_arrays, race_picture
from app.scenes.rope.measures import measures
from app.scenes.rope.parameters import PRESETS, ROOT, SPHERE, Params, build, hidden, stiffness_parameter
from app.scenes.springs.work_counts import SpringWorkCounts
from sim.springs import INTEGRATORS, Net, rope, simulate
from sim.springs import Grab as Pull
from sim.springs.analysis.extremes import extremes
from sim.springs.analysis.tension import rope_tension
from sim.springs.integrator_fallback import integrator_or_fallback
from sim.springs.resampling import resample
from sim.springs.stability import Gauge, critical_stiffness, gauge, top_modes
from sim.springs.state import State, advance, energy, velocities
from sim.springs.tracking import CriticallyDampedTracker

TITLE = "Rope"
GAUGE_EVERY = 0.5  # [s] of simulated time between two looks at the stability of the state
UNMOVED = 1e-3  # of a link: a rope that has moved by less since the last look is as stable as it was
SWIFT = 0.6  # [m/s] as seen: 10 mm, about two pixels, between pictures at their highest rate
SLOW = 0.075  # [m/s] as seen: 5 mm between pictures at a quarter of it
SAMPLE_EVERY = 1 / 30  # [s] between two plot rows
HELP = "<b>Drag a bead</b> to pull the rope. <b>Drag the arrows</b> to move its root."
SERIES = ("kinetic", "elastic", "gravity", "contact", "dissipated", "error", "tip height")
PLOTS = {
    "plot_energy": PlotAxes("Energy", "J", ("kinetic", "elastic", "gravity", "contact", "dissipated", "error")),
    "plot_tip": PlotAxes("Height of the tip", "m", ("tip height",)),
}


class PullShown(NamedTuple):
    """The drawn pull: from a point to its target [m], and the part of the largest force it takes."""

    particle: int
    target: Vector
    load: float


class RopeFrame(NamedTuple):
    """What the viewer draws of a rope."""

    points: NDArray[np.float32]  # (n, 3) [m]
    tension: NDArray[np.float32]  # (n - 1,) [N]
    full_scale: float  # [N] tension of the colour scale's end
    root: Vector
    sphere: tuple[float, float, float, float] | None
    floor: bool
    grid: bool
    colour: str
    show_points: bool
    pull: PullShown | None
    race: RaceFrame | None


class Paid(NamedTuple):
    """What an implicit method asks for holding at any step, since the parameters last changed."""

    corrections: float  # Newton's, a step, lately
    taken: float  # [J] by the method itself: numerical damping, negative where it feeds
    dissipated: float  # [J] by the rope's own damping


class RopeReadings(NamedTuple):
    """How near to its limit the integrator works, and the largest values that would hold."""

    stability: Gauge
    parameter: str  # the stiffness parameter in force
    largest_stiffness: float  # in that parameter's unit
    note: str  # why another method runs than the one chosen, or ""
    paid: Paid | None  # of implicit methods


UNDAMPED = rope(4, damping=0.0, drag=0.0)


def warm_up() -> Iterator[str]:
    """Compile everything the scene may call, piece by piece; yields what comes next."""
    net = rope(4, floor=-1.0, sphere=(0.0, 0.0, -1.0, 0.2))
    for name, record in INTEGRATORS.items():
        yield name
        simulate(UNDAMPED if record.undamped_only else net, name, 1e-3, 2e-3, 2, with_account=True)
    yield "stability"
    Scene(Params())
    yield "race"
    Scene(Params(ropes=2)).advance(2)


class Scene:
    """The rope on the simulation thread."""

    def __init__(self, params: Params) -> None:
        self.params = params
        self.root = CriticallyDampedTracker(ROOT)
        self.sphere = CriticallyDampedTracker(SPHERE)
        self.held: tuple[int, CriticallyDampedTracker] | None = None
        self.lost = False  # has left its bounds since the last reset
        self.samples: list[tuple[float, ...]] = []
        self.counts = SpringWorkCounts()
        self.reset()

    @property
    def step(self) -> float:
        return self.race.tick if self.race else self.params.time_step

    @property
    def frame_interval(self) -> float:
        """Time [s] between pictures: half as many, or a quarter, where nothing moves so fast that it would show."""
        seen = self.fastest * self.params.speed
        if seen > SWIFT or self.race or self.held or not self.root.at_rest or not self.sphere.at_rest:
            return FRAME_INTERVAL
        return 2.0 * FRAME_INTERVAL if seen > SLOW or self.plotted else 4.0 * FRAME_INTERVAL

    @property
    def plotted(self) -> bool:
        """Whether a plot is open, which a picture each `SAMPLE_EVERY` feeds."""
        return self.params.plot_energy or self.params.plot_tip

    @property
    def time(self) -> float:
        return self.race.t if self.race else self.state.t

    @property
    def note(self) -> str:
        """Why something else runs than the parameters ask for, or ""."""
        return self.fallback_note

    def reset(self) -> None:
        """The rope at rest, level from where its root is going; from home where it was lost, in the floor perhaps."""
        if self.lost:
            self.root.target, self.sphere.target, self.lost = ROOT, SPHERE, False
        self.root.place_at(self.root.target)
        self.sphere.place_at(self.sphere.target)
        self.held = None
        self.net = build(self.params, self.root.position, self.sphere.position)
        self.state = State.at_rest(self.net)
        self.race: Race | None = None
        if self.params.ropes > 1:
            self.race = Race(self.net, self.params)
            self.charts = RaceCharts(self.race)
        self.start_ledger()
        self.samples.append((float("nan"),) * (len(SERIES) + 1))  # a gap in the plots
        self.look()

    def start_ledger(self) -> None:
        self.state.dissipated = self.state.work = 0.0
        self.initial = energy(self.net, self.state)
        # Thrice the hanging length and some room: a picture of what happened, where 1e9 m would show nothing.
        weight = self.net.mass * abs(self.net.gravity[2]) / self.net.families[0].stiffness
        n = self.params.points - 1
        reach = extremes(self.state.x, self.state.v).reach
        self.bound = 4.0 + 3.0 * (self.params.length + 0.5 * weight * n * (n + 1)) + reach
        self.sampled_at = -np.inf
        self.fastest = np.inf  # [m/s] that a point moves at, along an axis: not known yet
        self.counted = self.state.force_evals, self.state.steps
        self.corrections = 0.0

    def change_forces(self, params: Params) -> None:
        """Take new parameters; the motion goes on, resampled where the points change.

        A race on other terms starts anew."""
        old, self.params = self.params, params
        if Race.line_up(params) != Race.line_up(old) and max(params.ropes, old.ropes) > 1:
            self.reset()
            return
        self.net = build(params, self.root.position, self.sphere.position)
        if params.points != old.points:
            self.state.x = resample(self.state.x, 1, params.points)
            self.state.v = resample(self.state.v, 1, params.points)
            self.held = None
        self.start_ledger()
        if self.race:
            self.race.take(self.net)
        self.look()

    def handle(self, command: SceneCommand) -> None:
        match command:
            case Place("root", position):
                self.root.target = position
            case Place("sphere", position):
                self.sphere.target = position
            case Grab(index, target) if 0 <= index < self.params.points * self.params.ropes:
                self.grab(index, target)
            case Release():
                self.held = None

    def grab(self, index: int, target: Vector) -> None:
        """Pull a point, numbered along rope after rope, towards where it is drawn; in a race every rope's alike."""
        lane, particle = divmod(index, self.params.points)
        x, y, z = target
        target = x, y - place_of(lane, self.params), z
        if particle == 0:
            self.root.target = target
            return
        if self.held is None or self.held[0] != index:
            state = self.race.lanes[lane].state if self.race else self.state
            at = state.x[:, 0, particle]
            self.held = index, CriticallyDampedTracker((float(at[0]), float(at[1]), float(at[2])))
        self.held[1].target = target

    def advance(self, steps: int) -> None:
        """Take steps with root, sphere and pull on their ways; raises DivergenceError, keeping the last good state."""
        if self.race:
            self.advance_race(self.race, steps)
            return
        duration = steps * self.step
        good = self.state.copy()
        net = self.net_under_way(self.state.t, duration)
        advance(net, self.state, self.integrator, self.step, steps, with_account=self.with_account)
        self.counts.take(net, self.state.force_evals - good.force_evals, steps, with_account=self.with_account)
        found = extremes(self.state.x, self.state.v)
        if not found.reach < self.bound:  # nor is a NaN
            self.state = good
            self.lost = True
            raise DivergenceError(self.diagnosis())
        self.fastest = found.speed
        if net.pin_paths and self.root.at_rest:  # it has just come to rest
            self.state.x[:, 0, 0] = self.root.position
            self.state.v[:, 0, 0] = 0.0
        self.net = net
        due = self.state.t - self.looked_at >= GAUGE_EVERY and self.has_moved
        self.counts.add("looks at the stability", 1, due)
        if due:
            self.look()
        if self.plotted and self.state.t - self.sampled_at >= SAMPLE_EVERY:
            self.sample()

    @property
    def has_moved(self) -> bool:
        """Whether there is anything new to be said of the stability, or of what an implicit method takes."""
        moved = float(np.abs(self.state.x - self.looked_x).max())
        return self.integrator.implicit or moved > UNMOVED * self.net.families[0].rest

    @property
    def with_account(self) -> bool:
        """Whether to keep account of what damping takes: for the plot, and to see what an implicit method takes."""
        return self.params.plot_energy or self.integrator.implicit

    def advance_race(self, race: Race, ticks: int) -> None:
        """Take ticks of a race, whatever becomes of its ropes."""
        self.net = self.net_under_way(race.t, ticks * race.tick)
        evals, steps = race.advance(self.net, ticks)
        self.counts.take(self.net, evals, steps, with_account=True)
        if self.root.at_rest:
            race.pin(self.root.position)
        if race.t - self.looked_at >= GAUGE_EVERY:
            self.look()
        self.charts.sample()

    def net_under_way(self, t: float, duration: float) -> Net:
        """The net with the motions of root, sphere and pull over the next `duration` [s]."""
        still = self.root.at_rest and self.sphere.at_rest and self.held is None
        if still and not (self.net.pin_paths or self.net.grab or any(self.net.sphere_velocity)):
            return self.net  # as it was in the last frame, when nothing moved either: most of the time
        path = self.root.advance(t, duration)
        before = self.sphere.position
        self.sphere.advance(t, duration)
        velocity = tuple((b - a) / duration for a, b in zip(before, self.sphere.position, strict=True))
        pull = None
        if self.held is not None:
            index, hand = self.held
            hand.advance(t, duration)
            # Critically damped on the point's own mass, slow enough for the step.
            rate = min(30.0, 0.5 / self.step)
            index %= self.params.points
            pull = Pull(0, index, hand.position, self.net.mass * rate**2, 2.0 * self.net.mass * rate, self.params.pull)
        return dataclasses.replace(
            self.net,
            pin_paths=() if path is None else (((0, 0), path),),
            sphere=(*before, self.params.sphere_radius) if self.net.sphere else None,
            sphere_velocity=velocity,
            epoch=t,
            grab=pull,
        )

    def look(self) -> None:
        """Judge the stability of the state as it is, and what an implicit method took."""
        if self.race:
            self.race.look()
            self.fallback_note = ""
            self.looked_at = self.race.t
            return
        self.integrator, self.fallback_note = integrator_or_fallback(self.params.integrator, self.net)
        modes = top_modes(self.net, self.state.x, self.state.t)
        stability = gauge(self.net, self.integrator, self.step, self.state, modes)
        largest = critical_stiffness(self.net, self.integrator, self.step, self.state, modes)
        parameter = "stiffness"
        if self.params.units == "material":
            parameter, largest = "axial_stiffness", largest * self.net.families[0].rest
        self.stability = RopeReadings(stability, parameter, largest, self.fallback_note, self.paid())
        self.looked_at, self.looked_x = self.state.t, self.state.x.copy()

    def paid(self) -> Paid | None:
        """What an implicit method asks for; None of others."""
        if not self.integrator.implicit:
            return None
        steps = self.state.steps - self.counted[1]
        if steps:
            evals = (self.state.force_evals - self.counted[0]) / steps
            self.corrections = max(0.0, evals - self.integrator.evals_outside_newton)
            self.counted = self.state.force_evals, self.state.steps
        return Paid(self.corrections, -self.imbalance(), self.state.dissipated)

    def imbalance(self) -> float:
        """Energy [J] that came from nowhere: numerical error."""
        return energy(self.net, self.state).total + self.state.dissipated - self.state.work - self.initial.total

    def diagnosis(self) -> str:
        """Why the run diverged and what would hold."""
        g = self.stability.stability
        name, h = self.integrator.name, self.step
        start = f"The rope left its bounds at t = {self.state.t:.2f} s: "
        if g.h_omega > g.limit:
            remedy = (
                f"A step below {g.critical_step:.3g} s would hold" if g.critical_step > 0 else "No step holds undamped"
            )
            return (
                f"{start}h ω = {g.h_omega:.3g} is over {name}'s limit {g.limit:.3g} at damping ratio {g.zeta:.3g}. "
                f"{remedy}; so would leapfrog below {2.0 / g.omega:.3g} s."
            )
        return (
            f"{start}h ω = {g.h_omega:.3g} is within the limit {g.limit:.3g} of {name}, so an impact or a pull was too "
            f"sudden for the step. Try h = {h / 4:.3g} s."
        )

    def work(self) -> WorkCounts:
        """Counts of what was computed and what was left out."""
        return self.counts()

    def sample(self) -> None:
        e = energy(self.net, self.state)
        error = self.imbalance()
        tip = float(self.state.x[2, 0, -1])
        row = (e.kinetic, e.elastic, e.gravity - self.initial.gravity, e.contact, self.state.dissipated, error, tip)
        self.samples.append((self.state.t, *row))
        self.sampled_at = self.state.t

    def take_plot_rows(self) -> tuple[tuple[float, ...], ...]:
        taken, self.samples = tuple(self.samples), []
        return taken

    def readings(self) -> "RopeReadings | RaceReadings":
        return self.race.standings() if self.race else self.stability

    def curves(self) -> dict[str, Chart] | None:
        """The race's charts, of `CURVES`."""
        return self.charts.charts() if self.race else None

    def tension(self) -> NDArray[np.float64]:
        """(n - 1,) spring force along each link [N], negative where pressed."""
        return rope_tension(self.net, self.state.x)

    def frame(self) -> RopeFrame:
        weight = self.net.mass * abs(self.net.gravity[2]) * (self.params.points - 1)
        pull = None
        if self.held is not None:
            index, hand = self.held
            lane, particle = divmod(index, self.params.points)
            state = self.race.lanes[lane].state if self.race else self.state
            reach = np.linalg.norm(np.asarray(hand.position) - state.x[:, 0, particle])
            rate = min(30.0, 0.5 / self.step)
            x, y, z = hand.position
            target = x, y + place_of(lane, self.params), z
            pull = PullShown(index, target, min(1.0, float(reach) * self.net.mass * rate**2 / self.params.pull))
        return RopeFrame(
            points=self.state.x[:, 0].T.astype(np.float32),
            tension=self.tension().astype(np.float32),
            full_scale=max(1.25 * weight, 1e-3),
            root=self.root.target,
            sphere=(*self.sphere.position, self.params.sphere_radius) if self.net.sphere else None,
            floor=self.params.floor,
            grid=self.params.grid,
            colour=self.params.colour,
            show_points=self.params.show_points,
            pull=pull,
            race=race_picture(self.race, self.params) if self.race else None,
        )

    def arrays(self) -> dict[str, tuple[NDArray[np.float64], str]]:
        """The state for a file: name -> (array, unit)."""
        if self.race:
            return race_arrays(self.race)
        return {
            "x": (self.state.x[:, 0].T.copy(), "m"),
            "v": (velocities(self.net, self.state)[:, 0].T.copy(), "m/s"),
            "energy": (np.array([*energy(self.net, self.state)]), "J: kinetic, elastic, gravity, contact"),
        }


SCENE = SceneKind(
    name="rope",
    title="Rope",
    help=HELP,
    params=Params,
    presets=PRESETS,
    make=Scene,
    hidden=hidden,
    warm_up=warm_up,
    series=SERIES,
    plots=PLOTS,
    curves=CURVES,
    measures=measures,
    stability_map=StabilityMap(stiffness_parameter, build),
)
