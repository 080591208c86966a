"""The rope of springs: the lab's part 2, with its root on a gizmo and every point to be grabbed."""

import dataclasses
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.follow import Follower
from app.messages import Command, DivergenceError, Grab, Place, Release, Vector
from app.method import method_for
from app.spring_work import SpringWork
from sim.knobs import knob
from sim.springs import INTEGRATORS, Contact, Net, lab_units, rope, simulate
from sim.springs import Grab as Pull
from sim.springs.net import CONTACT_LAWS, DAMPING_MODELS
from sim.springs.stability import Gauge, critical_stiffness, gauge
from sim.springs.state import State, advance, energy, velocities

TITLE = "Rope"
ROOT: Vector = (0.0, 0.0, 3.0)  # [m]
SPHERE: Vector = (-0.45, 0.12, 1.6)  # [m], a little behind the rope, which then slides off in view
THICKNESS = 0.035  # [m] radius of the drawn rope, and of its points for contact
GAUGE_EVERY = 0.5  # [s] of simulated time between two looks at the stability of the state
SAMPLE_EVERY = 1 / 30  # [s] between two plot rows
HELP = "<b>Drag a bead</b> to pull the rope. <b>Drag the arrows</b> to move its root."
SERIES = ("kinetic", "elastic", "gravity", "contact", "dissipated", "error", "tip height")
PLOTS = {
    "plot_energy": ("Energy", "J", ("kinetic", "elastic", "gravity", "contact", "dissipated", "error")),
    "plot_tip": ("Height of the tip", "m", ("tip height",)),
}


@dataclasses.dataclass(frozen=True)
class Params:
    """The rope's knobs; the defaults are the lab's code defaults with a better integrator."""

    integrator: str = knob("leapfrog", choices=tuple(INTEGRATORS), doc="Method of integration", group="Time")
    time_step: float = knob(1 / 60, 1e-5, 0.1, "s", "Step h of the integrator", log_from=1e-5, group="Time")
    speed: float = knob(1.0, 0.01, 8.0, "", "Simulated per real time", log_from=0.01, group="Time")

    units: str = knob(
        "lab",
        choices=("lab", "material"),
        doc="lab: numbers per point and link, so the rope changes with its points; material: per metre",
        group="Rope",
    )
    points: int = knob(10, 2, 1000, "", "Points, the root included", log_from=2, group="Rope")
    length: float = knob(2.0, 0.1, 10.0, "m", "Length at rest", group="Rope")
    stiffness: float = knob(800.0, 1.0, 1e9, "N/m", "Stiffness k of a link", log_from=1.0, group="Rope")
    damping: float = knob(7.0, 0.0, 1e5, "N s/m", "Damping b of a link", log_from=1e-3, group="Rope")
    mass: float = knob(1.0, 1e-3, 1e3, "kg", "Mass of a point", log_from=1e-3, group="Rope")
    drag: float = knob(1.0, 0.0, 1e3, "N s/m", "Air drag c on a point", log_from=1e-3, group="Rope")
    axial_stiffness: float = knob(178.0, 1.0, 1e9, "N", "Stiffness EA", log_from=1.0, group="Rope")
    axial_viscosity: float = knob(1.56, 0.0, 1e5, "N s", "Damping of a metre of rope", log_from=1e-3, group="Rope")
    mass_per_length: float = knob(4.5, 1e-3, 1e3, "kg/m", "Mass of a metre of rope", log_from=1e-3, group="Rope")
    drag_per_length: float = knob(4.5, 0.0, 1e3, "N s/m^2", "Air drag on a metre", log_from=1e-3, group="Rope")
    damping_model: str = knob(
        "isotropic",
        choices=DAMPING_MODELS,
        doc="isotropic: b on the whole relative velocity, the lab's; axial: along the link only",
        group="Rope",
    )

    gravity: float = knob(10.0, 0.0, 100.0, "m/s^2", "Gravity, downwards", group="Surroundings")
    floor: bool = knob(True, doc="Floor at height 0", group="Surroundings")
    sphere: bool = knob(False, doc="Sphere, on a gizmo of its own", group="Surroundings")
    sphere_radius: float = knob(0.75, 0.05, 3.0, "m", "Radius of the sphere", group="Surroundings")
    friction: float = knob(0.3, 0.0, 2.0, "", "Coulomb friction coefficient", group="Surroundings")
    contact_stiffness: float = knob(800.0, 1.0, 1e7, "N/m", "Contact stiffness", log_from=1.0, group="Surroundings")
    contact_damping: float = knob(5.0, 0.0, 1e4, "N s/m", "Contact damping", log_from=1e-2, group="Surroundings")
    contact_law: str = knob(
        "clipped",
        choices=CONTACT_LAWS,
        doc="clipped: never pulls, with friction; lab: the original's, sticky and viscous",
        group="Surroundings",
    )
    pull: float = knob(300.0, 1.0, 1e5, "N", "Largest force of a drag", log_from=1.0, group="Surroundings")

    colour: str = knob("tension", choices=("tension", "plain"), doc="What the rope's colour shows", group="Look")
    show_points: bool = knob(True, doc="Draw the points, to be grabbed", group="Look")
    grid: bool = knob(True, doc="Lines on the floor", group="Look")
    plot_energy: bool = knob(False, doc="Energy ledger over time", group="Plots")
    plot_tip: bool = knob(False, doc="Height of the tip over time", group="Plots")


PRESETS: dict[str, dict[str, Any]] = {
    "Lab code: 10 points": {},
    "Lab scene: 50 points": {"points": 50, "time_step": 1 / 120, "drag": 0.5, "contact_damping": 10.7, "speed": 1.0},
    "Euler explodes": {"integrator": "explicit_euler"},
    "Lab's Euler": {"integrator": "symplectic_euler"},
    "Stiff rope": {
        "units": "material", "points": 60, "axial_stiffness": 2e5, "axial_viscosity": 20.0, "mass_per_length": 0.5,
        "drag_per_length": 0.2, "time_step": 2.5e-5,
    },
    "Pendulum": {
        "points": 2, "length": 1.0, "stiffness": 1e6, "damping": 0.0, "drag": 0.0, "floor": False, "time_step": 1e-3,
    },
    "Over the sphere": {"units": "material", "points": 40, "length": 4.0, "time_step": 1 / 480, "sphere": True},
}  # fmt: skip

LAB_ONLY = {"stiffness", "damping", "mass", "drag"}
MATERIAL_ONLY = {"axial_stiffness", "axial_viscosity", "mass_per_length", "drag_per_length"}


def hidden(params: Params) -> set[str]:
    """The knobs that mean nothing with the others as they are."""
    names = set(MATERIAL_ONLY if params.units == "lab" else LAB_ONLY)
    if not params.sphere:
        names.add("sphere_radius")
    if not (params.sphere or params.floor):
        names |= {"friction", "contact_stiffness", "contact_damping", "contact_law"}
    if params.contact_law == "lab":
        names.add("friction")
    return names


class PullShown(NamedTuple):
    """The drawn pull: from a point to its target [m], and the part of the largest force it takes."""

    particle: int
    target: Vector
    load: float


class RopePicture(NamedTuple):
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


class RopeGauge(NamedTuple):
    """How near to its limit the integrator works, and the largest values that would hold."""

    stability: Gauge
    knob: str  # the stiffness knob in force
    largest_stiffness: float  # in that knob's unit
    note: str  # why another method runs than the one chosen, or ""


def build(params: Params, root: Vector = ROOT, sphere: Vector = SPHERE) -> Net:
    """The net that the knobs describe."""
    lab = lab_units(
        params.points,
        params.length,
        params.axial_stiffness,
        params.mass_per_length,
        params.axial_viscosity,
        params.drag_per_length,
    )
    if params.units == "lab":
        lab = {name: getattr(params, name) for name in LAB_ONLY}
    contact = Contact(params.contact_stiffness, params.contact_damping, params.friction, params.contact_law)
    return rope(
        params.points,
        params.length,
        mass=lab["mass"],
        stiffness=lab["stiffness"],
        damping=lab["damping"],
        drag=lab["drag"],
        gravity=params.gravity,
        root=root,
        floor=0.0 if params.floor else None,
        sphere=(*sphere, params.sphere_radius) if params.sphere else None,
        damping_model=params.damping_model,
        contact=contact,
        radius=THICKNESS,
    )


def resample(values: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """(3, 1, n) along the rope, at `count` points instead."""
    old, new = np.linspace(0.0, 1.0, values.shape[2]), np.linspace(0.0, 1.0, count)
    return np.ascontiguousarray([[np.interp(new, old, row[0])] for row in values])


UNDAMPED = rope(4, damping=0.0, drag=0.0)


def warm_up() -> Iterator[str]:
    """Compile everything the scene may call, piece by piece; yields what comes next."""
    net = rope(4, floor=-1.0, sphere=(0.0, 0.0, -1.0, 0.2))
    for name, record in INTEGRATORS.items():
        yield name
        simulate(UNDAMPED if record.undamped_only else net, name, 1e-3, 2e-3, 2, with_ledger=True)
    yield "stability"
    Scene(Params())


class Scene:
    """The rope on the simulation thread."""

    def __init__(self, params: Params) -> None:
        self.params = params
        self.root = Follower(ROOT)
        self.sphere = Follower(SPHERE)
        self.held: tuple[int, Follower] | None = None
        self.lost = False  # has left its bounds since the last reset
        self.samples: list[tuple[float, ...]] = []
        self.work = SpringWork()
        self.reset()

    @property
    def step(self) -> float:
        return self.params.time_step

    @property
    def time(self) -> float:
        return self.state.t

    def reset(self) -> None:
        """The rope at rest, level from where its root is going; from home where it was lost, in the floor perhaps."""
        if self.lost:
            self.root.target, self.sphere.target, self.lost = ROOT, SPHERE, False
        self.root.put(self.root.target)
        self.sphere.put(self.sphere.target)
        self.held = None
        self.net = build(self.params, self.root.position, self.sphere.position)
        self.state = State.at_rest(self.net)
        self.start_ledger()
        self.samples.append((float("nan"),) * (len(SERIES) + 1))  # a gap in the plots
        self.look()

    def start_ledger(self) -> None:
        self.state.dissipated = self.state.work = 0.0
        self.initial = energy(self.net, self.state)
        # Thrice the hanging length and some room: a picture of what happened, where 1e9 m would show nothing.
        weight = self.net.mass * abs(self.net.gravity[2]) / self.net.families[0].stiffness
        n = self.params.points - 1
        self.bound = 4.0 + 3.0 * (self.params.length + 0.5 * weight * n * (n + 1)) + self.extent()
        self.sampled_at = -np.inf

    def set_params(self, params: Params) -> None:
        """Take new knobs; the motion goes on, resampled where the points change."""
        old, self.params = self.params, params
        self.net = build(params, self.root.position, self.sphere.position)
        if params.points != old.points:
            self.state.x = resample(self.state.x, params.points)
            self.state.v = resample(self.state.v, params.points)
            self.held = None
        self.start_ledger()
        self.look()

    def obey(self, command: Command) -> None:
        match command:
            case Place("root", position):
                self.root.target = position
            case Place("sphere", position):
                self.sphere.target = position
            case Grab(0, target):
                self.root.target = target
            case Grab(index, target) if 0 < index < self.params.points:
                if self.held is None or self.held[0] != index:
                    x = self.state.x[:, 0, index]
                    self.held = index, Follower((float(x[0]), float(x[1]), float(x[2])))
                self.held[1].target = target
            case Release():
                self.held = None

    def advance(self, steps: int) -> None:
        """Take steps with root, sphere and pull on their ways; raises DivergenceError, keeping the last good state."""
        duration = steps * self.step
        good = self.state.copy()
        net = self.net_under_way(self.state.t, duration)
        advance(net, self.state, self.integrator, self.step, steps, with_ledger=self.params.plot_energy)
        self.work.take(net, self.state.force_evals - good.force_evals, steps, with_ledger=self.params.plot_energy)
        if not (self.state.is_sane and self.extent() < self.bound):
            self.state = good
            self.lost = True
            raise DivergenceError(self.diagnosis())
        if self.root.at_rest:
            self.state.x[:, 0, 0] = self.root.position
            self.state.v[:, 0, 0] = 0.0
        self.net = net
        due = self.state.t - self.looked_at >= GAUGE_EVERY
        self.work.add("looks at the stability", 1, due)
        if due:
            self.look()
        if (self.params.plot_energy or self.params.plot_tip) and self.state.t - self.sampled_at >= SAMPLE_EVERY:
            self.sample()

    def extent(self) -> float:
        """Largest distance of a point from the root along an axis [m]."""
        return float(np.abs(self.state.x - self.state.x[:, :, :1]).max())

    def net_under_way(self, t: float, duration: float) -> Net:
        """The net with the motions of root, sphere and pull over the next `duration` [s]."""
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
            pull = Pull(0, index, hand.position, self.net.mass * rate**2, 2.0 * self.net.mass * rate, self.params.pull)
        return dataclasses.replace(
            self.net,
            pin_paths=() if path is None else (((0, 0), path),),
            sphere=(*before, self.params.sphere_radius) if self.params.sphere else None,
            sphere_velocity=velocity,
            epoch=t,
            grab=pull,
        )

    def look(self) -> None:
        """Judge the stability of the state as it is."""
        self.integrator, self.note = method_for(self.params.integrator, self.net)
        stability = gauge(self.net, self.integrator, self.step, self.state)
        largest = critical_stiffness(self.net, self.integrator, self.step, self.state)
        knob = "stiffness"
        if self.params.units == "material":
            knob, largest = "axial_stiffness", largest * self.net.families[0].rest
        self.stability = RopeGauge(stability, knob, largest, self.note)
        self.looked_at = self.state.t

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

    def sample(self) -> None:
        e = energy(self.net, self.state)
        error = e.total + self.state.dissipated - self.state.work - self.initial.total
        tip = float(self.state.x[2, 0, -1])
        row = (e.kinetic, e.elastic, e.gravity - self.initial.gravity, e.contact, self.state.dissipated, error, tip)
        self.samples.append((self.state.t, *row))
        self.sampled_at = self.state.t

    def take_samples(self) -> tuple[tuple[float, ...], ...]:
        taken, self.samples = tuple(self.samples), []
        return taken

    def gauge(self) -> RopeGauge:
        return self.stability

    def tension(self) -> NDArray[np.float64]:
        """(n - 1,) spring force along each link [N], negative where pressed."""
        link = self.net.families[0]
        r = np.diff(self.state.x[:, 0], axis=1)
        return link.stiffness * (np.sqrt((r * r).sum(axis=0)) - link.rest)

    def picture(self) -> RopePicture:
        weight = self.net.mass * abs(self.net.gravity[2]) * (self.params.points - 1)
        pull = None
        if self.held is not None:
            index, hand = self.held
            reach = np.linalg.norm(np.asarray(hand.position) - self.state.x[:, 0, index])
            rate = min(30.0, 0.5 / self.step)
            pull = PullShown(index, hand.position, min(1.0, float(reach) * self.net.mass * rate**2 / self.params.pull))
        return RopePicture(
            points=self.state.x[:, 0].T.astype(np.float32),
            tension=self.tension().astype(np.float32),
            full_scale=max(1.25 * weight, 1e-3),
            root=self.root.target,
            sphere=(*self.sphere.position, self.params.sphere_radius) if self.params.sphere else None,
            floor=self.params.floor,
            grid=self.params.grid,
            colour=self.params.colour,
            show_points=self.params.show_points,
            pull=pull,
        )

    def arrays(self) -> dict[str, tuple[NDArray[np.float64], str]]:
        """The state for a file: name -> (array, unit)."""
        return {
            "x": (self.state.x[:, 0].T.copy(), "m"),
            "v": (velocities(self.net, self.state)[:, 0].T.copy(), "m/s"),
            "energy": (np.array([*energy(self.net, self.state)]), "J: kinetic, elastic, gravity, contact"),
        }
