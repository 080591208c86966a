"""The floating bodies of a scene: two buoys, a box, then more, with what theory says of each and what is measured."""

import dataclasses
import math
from typing import NamedTuple

import numpy as np

from sim.floating import Body, Fleet, Hull, Laws, equilibrium_draft, heave_period, make_fleet, make_water, pull, step
from sim.ocean.fluid_column import FluidColumn
from sim.ocean.radial import SurfaceAt

KINDS = ("buoy_red", "buoy_yellow", "crate", "ball")
OWN = "hull"  # the kind of the one that came from a file
OWN_PLACE = (-0.2, 2.4)  # [m] at size 1, for one of 2 m; a greater one lies beyond
PLACES = ((-2.4, 1.0), (-3.0, 4.6), (0.4, -0.8))  # [m] at size 1 of the first three
RING = 4.2  # [m] at size 1: from one turn of the spiral of the others to the next
DEEPEST = -60.0  # [m] where what sinks comes to rest
SLACK = 1.5  # [m] at size 1 of a mooring line
MEAN_OVER = 8.0  # [s] over which drafts are averaged
PERIODS = 4  # over how many a heave period is measured


def hull_of(kind: str, size: float) -> Hull:
    """The hull of a body [m]; drum, box and ball lie stably whatever their density."""
    if kind == "crate":
        return Hull.box(1.2 * size, 1.2 * size, 0.7 * size)
    if kind == "ball":
        return Hull.sphere(0.5 * size, 5)
    return Hull.cylinder(0.6 * size, 0.7 * size)


def kind_of(index: int) -> str:
    """Which body is number `index`."""
    return KINDS[index] if index < 3 else KINDS[(index * 7 + 3) % 4]


def place_of(index: int, size: float) -> tuple[float, float]:
    """Where body `index` lies [m]: the first three by name, the others on a spiral about them."""
    if index < len(PLACES):
        x, y = PLACES[index]
        return x * size, y * size
    n = index - len(PLACES) + 3
    radius = RING * size * math.sqrt(n / 2.2)
    angle = n * math.pi * (3.0 - math.sqrt(5.0))
    return radius * math.cos(angle), radius * math.sin(angle)


class Theory(NamedTuple):
    """What Archimedes says of a kind of body."""

    draft: float  # [m] at rest; inf: it sinks
    in_water: float  # [m] in clean water
    height: float  # [m] of the hull
    period: float  # [s] of heave, added mass and all


class BodyReading(NamedTuple):
    """One body now."""

    kind: str
    draft: float  # [m] of the keel below the plane of the water there
    mean_draft: float  # [m] over the last seconds
    period: float  # [s] of heave, measured; nan until known
    theory: Theory


@dataclasses.dataclass
class HeaveMeter:
    """Drafts averaged, and upward crossings of the average timed, for n bodies."""

    n: int

    def __post_init__(self) -> None:
        self.mean, self.age = np.zeros(self.n), 0.0
        self.low = np.zeros(self.n, bool)  # has been clearly below the mean since the last crossing
        self.spread = np.zeros(self.n)  # [m] running mean deviation
        self.crossed: list[list[float]] = [[] for _ in range(self.n)]

    def take(self, t: float, draft: np.ndarray, duration: float) -> None:
        self.age += duration
        share = min(duration / min(MEAN_OVER, max(self.age, duration)), 1.0)
        self.mean += share * (draft - self.mean)
        off = draft - self.mean
        self.spread += share * (np.abs(off) - self.spread)
        trip = np.maximum(0.3 * self.spread, 2e-4)
        for i in np.flatnonzero(self.low & (off > trip)):
            self.crossed[i] = [*self.crossed[i][-PERIODS:], t]
            self.low[i] = False
        self.low |= off < -trip

    def period(self, i: int, t: float) -> float:
        """Measured period [s] of body i, nan until two crossings, or when the last is long ago."""
        times = self.crossed[i]
        if len(times) < 2:
            return math.nan
        period = (times[-1] - times[0]) / (len(times) - 1)
        return period if t - times[-1] < 4.0 * period else math.nan


class FloatingBodies:
    """The bodies on the simulation thread."""

    def __init__(self, count: int, size: float, density: float, column: FluidColumn, own: Hull | None = None) -> None:
        """own: a hull that floats besides, as large as it is."""
        self.size, self.density = size, density
        self.kinds = [kind_of(i) for i in range(count)]
        hulls = {kind: hull_of(kind, size) for kind in KINDS}
        places = [place_of(i, size) for i in range(count)]
        if own is not None:
            hulls[OWN] = own
            self.kinds.append(OWN)
            beyond = max(float(np.abs(own.extents[:2]).max()) - 1.0, 0.0)
            places.append((OWN_PLACE[0] * size + 0.35 * beyond, OWN_PLACE[1] * size + 0.94 * beyond))
        self.count = len(self.kinds)
        self.hulls = hulls
        self.theory = theory_of(hulls, density, column)
        bodies = []
        for kind, (x, y) in zip(self.kinds, places, strict=True):
            t = self.theory[kind]
            hull = hulls[kind]
            sunk = t.draft if math.isfinite(t.draft) else 0.5 * t.height
            bodies.append(Body(hull, density, (x, y, -hull.extents[2, 0] - sunk)))
        self.fleet: Fleet = make_fleet(bodies)
        self.home = self.fleet.position[:, :2].copy()
        self.keel = np.array([hulls[kind].extents[2, 0] for kind in self.kinds])  # [m], negative
        self.round = np.array([kind == "ball" for kind in self.kinds], bool)
        self.widths = np.array([np.ptp(hulls[kind].extents[0]) for kind in self.kinds])
        self.meter = HeaveMeter(self.count)
        self.held: dict[int, np.ndarray] = {}
        self.draft = np.zeros(self.count)
        self.impulse = np.zeros(self.count)  # [N s] pressed on the water since last taken
        self.touched = self.stepped = 0

    def restate(self, density: float, column: FluidColumn) -> None:
        """Other density or fluids: theory anew, masses changed under way, nothing moved."""
        self.density = density
        self.theory = theory_of(self.hulls, density, column)
        self.fleet.mass[:] *= density / self.fleet.density
        self.fleet.density[:] = density
        self.meter = HeaveMeter(self.count)

    def hold(self, index: int, target: tuple[float, float, float], limit: float) -> None:
        """Pull body `index` towards a target [m] with at most `limit` weights of its own."""
        if 0 <= index < self.count:
            self.held[index] = np.array(target)
            pull(self.fleet, index, (0.0, 0.0, 0.0), target, limit * 9.81 * float(self.fleet.mass[index]))

    def release(self) -> None:
        """Let go of all; what is thrown flies on."""
        for index in self.held:
            self.fleet.pull_limit[index] = 0.0
        self.held.clear()

    def moor(self) -> None:
        """Pull back, weakly and level, what has gone beyond its slack."""
        offset = self.home - self.fleet.position[:, :2]
        beyond = np.maximum(np.hypot(offset[:, 0], offset[:, 1]) - SLACK * self.size, 0.0)
        for i in np.flatnonzero(beyond > 0.0):
            if i not in self.held:
                x, y = self.home[i]
                weight = 9.81 * float(self.fleet.mass[i])
                target = (float(x), float(y), float(self.fleet.position[i, 2]))
                pull(
                    self.fleet, int(i), (0.0, 0.0, 0.0), target, min(0.06 * float(beyond[i]) / self.size, 0.6) * weight
                )
        for i in np.flatnonzero(beyond == 0.0):
            if i not in self.held:
                self.fleet.pull_limit[i] = 0.0

    def step(self, column: FluidColumn, at: SurfaceAt, t: float, h: float, layer: np.ndarray, laws: Laws) -> None:
        """One step of h [s] from t on the sea `at` the bodies; layer (n,) [m]: thickness of oil at each.

        Raises FloatingPointError where a body's state is no longer finite.
        """
        if self.count == 0:
            return
        oil = column.kind != "mixed" and bool((layer > 0.0).any())
        layers = ((column.oil.density, 1.0), (column.water.density, math.inf)) if oil else column.layers
        more = {}
        if oil:
            # The interface of the fluid column; where a slick adds oil, the interface lies that much deeper.
            more = {
                "interface": at.interface - layer,
                "interface_slope": at.interface_slope,
                "interface_rise": at.interface_rise,
            }
        water = make_water(
            self.fleet, layers, at.height, slope=at.slope, velocity=at.velocity, acceleration=at.acceleration, **more
        )
        self.touched += step(self.fleet, water, h, laws)
        self.stepped += self.count
        # What presses on the water beyond riding along with it makes waves.
        carried = self.fleet.mass * np.maximum(laws.gravity + at.acceleration, 0.0)
        self.impulse += np.where(self.fleet.buoyancy > 0.0, self.fleet.buoyancy - carried, 0.0) * h
        sunk = self.fleet.position[:, 2] < DEEPEST
        self.fleet.position[sunk, 2] = DEEPEST
        self.fleet.velocity[sunk] = 0.0

    def measure(self, t: float, at: SurfaceAt, duration: float) -> None:
        """Take drafts: how deep each keel lies below the plane of the water, which a body on a wave leans with."""
        normal = np.column_stack([-at.slope, np.ones(self.count)])
        normal /= np.sqrt((normal * normal).sum(axis=1, keepdims=True))
        up = np.where(self.round[:, None], normal, upward(self.fleet.rotation))
        below = self.keel[:, None] * up  # from a body's centre to its keel
        below[:, 2] += self.fleet.position[:, 2] - at.height
        self.draft[:] = -(normal * below).sum(axis=1)
        self.meter.take(t, self.draft, duration)

    def readings(self, t: float, most: int = 6) -> tuple[BodyReading, ...]:
        """The first few bodies now, and the one from a file."""
        shown = [i for i, kind in enumerate(self.kinds) if i < most or kind == OWN]
        return tuple(
            BodyReading(
                kind, float(self.draft[i]), float(self.meter.mean[i]), self.meter.period(i, t), self.theory[kind]
            )
            for i, kind in ((i, self.kinds[i]) for i in shown)
        )


def upward(rotation: np.ndarray) -> np.ndarray:
    """The bodies' own z axes (n, 3) in the world, of unit quaternions (n, 4): the matrices' last columns."""
    w, x, y, z = rotation.T
    return np.stack([2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)], axis=1)


def theory_of(hulls: dict[str, Hull], density: float, column: FluidColumn) -> dict[str, Theory]:
    """Archimedes for each kind of body."""
    clean = ((column.water.density, math.inf),)
    found = {}
    for kind, hull in hulls.items():
        height = float(hull.extents[2, 1] - hull.extents[2, 0])
        draft = equilibrium_draft(hull, density, column.layers)
        in_water = equilibrium_draft(hull, density, clean)
        found[kind] = Theory(draft, in_water, height, heave_period(hull, density, column.layers))
    return found
