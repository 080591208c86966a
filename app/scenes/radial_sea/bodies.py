"""The floating bodies of the radial sea: their places, predictions and measured values."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.floating import (
    SHAPES,
    Body,
    Fleet,
    HeaveMeter,
    Hull,
    HydrostaticPrediction,
    MotionCoefficients,
    Shape,
    make_fleet,
    make_water,
    predict,
    pull,
    step,
)
from sim.floating.body import pack_linear
from sim.floating.excitation import LAST_RATES, WaveExcitation, rate_of_change
from sim.floating.heave_meter import WindowMean
from sim.floating.mooring_lines import MooringLines, fairleads, just_taut, pulls
from sim.floating.rotation import body_z_axes
from sim.floating.shapes import Appearance
from sim.interruption import raise_if_stopped
from sim.ocean.fluid_column import FluidColumn
from sim.ocean.radial import RadialSea, SurfaceAt

GRAVITY = 9.81  # [m/s2]
FIRST_PLACES = ((-2.4, 1.0), (-3.0, 4.6), (0.4, -0.8))  # [m] at size 1 of the first three bodies
FILE_PLACE = (-0.2, 2.4)  # [m] at size 1 of a hull from a file that is 2 m wide; a wider one floats farther out
FILE_DIRECTION = (0.35, 0.94)  # in which a wider one is moved
SPIRAL_SPACING = 4.2  # [m] at size 1 between the turns of the spiral of the other bodies
BED_DEPTH = 60.0  # [m] of the anchors, and of what has sunk
LINE_REACH = 180.0  # [m] from a body to its anchors, level
LINE_STIFFNESS = 8e3  # [N] EA of a line, per m3 of its body: an elastic rope, by which bodies surge slower than waves
MAX_READINGS = 6  # bodies of the scene's own in the table
MIN_COSINE = 0.2  # of the angle between a body's axis and the normal of the water, where drafts still mean something
MAX_ACCELERATION = 2.0  # of gravity, of the water; where the sea is exchanged it jumps
SLICK_RESOLUTION = 1e-4  # [m] of a slick's thickness in predictions


class BodyKind(NamedTuple):
    """One kind of body: a shape, and one way in which it is drawn."""

    shape: Shape
    appearance: Appearance

    @property
    def name(self) -> str:
        """Name of the kind, unique among the kinds."""
        return self.appearance.name

    @property
    def title(self) -> str:
        """Name in tables."""
        return self.appearance.title


def kinds_of(shape: Shape) -> list[BodyKind]:
    """The kinds of body of one shape: one for each appearance."""
    return [BodyKind(shape, appearance) for appearance in shape.appearances]


BODY_KINDS = tuple(kind for shape in SHAPES.values() for kind in kinds_of(shape))


def kind_of(index: int) -> BodyKind:
    """The kind of body number `index`: the first three in order, then all of them in turn from the last one on."""
    first = len(FIRST_PLACES)
    return BODY_KINDS[(index if index < first else first - index) % len(BODY_KINDS)]


def place_of(index: int, size: float) -> tuple[float, float]:
    """Position of body `index` [m]: the first three at fixed places, the others on a spiral about them."""
    if index < len(FIRST_PLACES):
        x, y = FIRST_PLACES[index]
        return x * size, y * size
    n = index - len(FIRST_PLACES) + 3
    radius = SPIRAL_SPACING * size * math.sqrt(n / 2.2)
    angle = n * math.pi * (3.0 - math.sqrt(5.0))
    return radius * math.cos(angle), radius * math.sin(angle)


def place_of_file_hull(hull: Hull, size: float) -> tuple[float, float]:
    """Position of a hull from a file [m], beside bodies of this size."""
    farther = max(float(np.abs(hull.extents[:2]).max()) - 1.0, 0.0)
    (x, y), (dx, dy) = FILE_PLACE, FILE_DIRECTION
    return x * size + dx * farther, y * size + dy * farther


def box_of(bodies: "FloatingBodies") -> int | None:
    """The number of the first box, None where there is none."""
    return next((i for i, kind in enumerate(bodies.body_kinds) if kind.shape.name == "box"), None)


class BodyReading(NamedTuple):
    """One body now, as measured and as predicted."""

    kind: str
    title: str
    density: float  # [kg/m3]
    volume: float  # [m3]
    mass: float  # [kg]
    buoyancy: float  # [N] weight of the displaced fluids
    # [N] upward over the last minute: buoyancy, waves, drag, and what the motion through the water meets
    mean_lift: tuple[float, ...]
    wet_volume: tuple[float, float]  # [m3] in oil, or the fluid of both mixed, and in the water below it
    draft: float  # [m] of the body below the surface, along its own axis
    mean_draft: float  # [m] over the last minute
    period: float  # [s] of heave, measured; NaN until it is known
    offset: float  # [m] level, from where its mooring lines hold it
    tension: float  # [N] the largest of its mooring lines'
    prediction: HydrostaticPrediction
    has_own_coefficients: bool  # of linear theory; otherwise those of a box are taken


class FloatingBodies:
    """The bodies of a scene; used on the simulation thread."""

    def __init__(
        self,
        count: int,
        size: float,
        density: float,
        column: FluidColumn,
        file_shape: Shape | None = None,
        own_densities: tuple[float, ...] = (),
    ) -> None:
        """count bodies of `density` [kg/m3], and one of `file_shape` in its own size.

        own_densities [kg/m3]: those of the first bodies, where they differ from the others'.
        """
        self.count_asked, self.size = count, size
        body_kinds = [kind_of(i) for i in range(count)]
        places = [place_of(i, size) for i in range(count)]
        self.hulls = {kind.name: Hull.of_shape(kind.shape, size) for kind in BODY_KINDS}
        if file_shape is not None:
            (kind,) = kinds_of(file_shape)
            self.hulls[kind.name] = Hull.of_shape(file_shape)
            body_kinds.append(kind)
            places.append(place_of_file_hull(self.hulls[kind.name], size))
        self.body_kinds = tuple(body_kinds)
        self.count = len(body_kinds)
        self.column = column
        self.slick = np.zeros(self.count)  # (n,) [m] thickness of the slick at each body
        self.known_predictions: dict[tuple[str, float, float], HydrostaticPrediction] = {}
        self.densities = self.densities_of(density, own_densities)
        bodies = []
        for i, (kind, (x, y)) in enumerate(zip(body_kinds, places, strict=True)):
            prediction, hull = self.prediction(i), self.hulls[kind.name]
            initial_draft = prediction.draft if math.isfinite(prediction.draft) else 0.5 * prediction.height
            bodies.append(Body(hull, self.densities[i], (x, y, -hull.extents[2, 0] - initial_draft)))
        self.fleet: Fleet = make_fleet(bodies, column.layers)
        hulls = [self.hulls[kind.name] for kind in body_kinds]
        self.keel = np.array([hull.extents[2, 0] for hull in hulls])  # (n,) [m] height over the centre, negative
        self.is_round = np.array([kind.shape.is_round for kind in body_kinds], bool)
        self.lines = self.taut_lines(self.fleet.position[:, :2])
        self.tension = np.zeros((self.count, 4))  # [N] of each mooring line
        self.widths = np.array([np.ptp(hull.extents[0]) for hull in hulls])  # (n,) [m]
        self.excitation = self.make_excitation()
        self.rises: tuple[np.ndarray, ...] = ()  # (n,) [m/s] of the water at the bodies, the newest first
        self.heave_meter, self.lift = self.make_meters()
        self.grabbed_by: dict[int, int] = {}  # body -> the browser that has grabbed it
        self.targets: dict[int, tuple[float, float, float]] = {}  # body -> where it is pulled [m]
        self.draft = np.zeros(self.count)  # [m]
        self.stain = np.zeros(self.count)  # [m] of the body above its lowest point that oil has wetted
        self.impulse = np.zeros(self.count)  # [N s] on the water since the scene last took it

    @property
    def kinds(self) -> tuple[str, ...]:
        """Name of the kind of each body."""
        return tuple(kind.name for kind in self.body_kinds)

    def densities_of(self, density: float, own: tuple[float, ...]) -> tuple[float, ...]:
        """Density of each body [kg/m3]."""
        return tuple(own[i] if i < min(len(own), self.count_asked) else density for i in range(self.count))

    def prediction(self, i: int) -> HydrostaticPrediction:
        """Hydrostatic prediction for body i in the fluids at its place, the slick among them."""
        name, column = self.body_kinds[i].name, self.column
        slick = SLICK_RESOLUTION * round(float(self.slick[i]) / SLICK_RESOLUTION)
        key = (name, self.densities[i], slick)
        if key not in self.known_predictions:
            raise_if_stopped()
            layers = column.layers
            if slick > 0.0 and column.kind != "mixed":
                layers = ((column.oil.density, column.thickness + slick), (column.water.density, math.inf))
            found = predict(self.hulls[name], self.densities[i], layers, column.water.density)
            self.known_predictions[key] = found
        return self.known_predictions[key]

    def taut_lines(self, level: NDArray[np.float64]) -> MooringLines:
        """Mooring lines that do not pull at the drafts of rest, about these places (n, 2) [m]."""
        hulls = [self.hulls[kind.name] for kind in self.body_kinds]
        drafts = [p.draft if math.isfinite(p.draft) else p.height for p in map(self.prediction, range(self.count))]
        stiffness = LINE_STIFFNESS * np.array([hull.volume for hull in hulls])
        rest = np.column_stack([level, -np.array(drafts)])
        return just_taut(rest, self.keel, stiffness, BED_DEPTH, LINE_REACH)

    def set_fluids(self, density: float, column: FluidColumn, own_densities: tuple[float, ...] = ()) -> None:
        """Take other densities of the bodies [kg/m3], or other fluids; nothing is moved."""
        self.column = column
        self.densities = self.densities_of(density, own_densities)
        self.known_predictions.clear()
        self.fleet.mass[:] *= self.densities / self.fleet.density
        self.fleet.density[:] = self.densities
        hulls = [self.hulls[kind.name] for kind in self.body_kinds]
        linear_hull, linear = pack_linear(hulls, self.densities, column.layers)
        self.fleet = self.fleet._replace(linear_hull=linear_hull, linear=linear)
        self.lines = self.taut_lines(self.lines.anchors.mean(axis=1)[:, :2])
        self.excitation = self.make_excitation()
        self.heave_meter, self.lift = self.make_meters()

    def set_down(self, i: int, draft: float) -> None:
        """Put body i at rest, with its lowest point this deep [m] below the mean level."""
        self.fleet.position[i, 2] = -self.keel[i] - draft
        self.fleet.velocity[i] = 0.0
        self.heave_meter, self.lift = self.make_meters()

    def make_meters(self) -> tuple[HeaveMeter, WindowMean]:
        """New meters of heave and of the upward forces."""
        return HeaveMeter(self.count), WindowMean(self.count, 4)

    def make_excitation(self) -> WaveExcitation:
        """Wave forces on these bodies in these fluids."""
        hulls = [self.hulls[kind.name] for kind in self.body_kinds]
        bodies = [Body(hull, density) for hull, density in zip(hulls, self.densities, strict=True)]
        return WaveExcitation(bodies, self.widths, self.column.layers)

    def grab(self, index: int, target: tuple[float, float, float], limit: float, client: int = 0) -> None:
        """Pull body `index` towards a target [m] for a browser, with at most `limit` weights of the body.

        A body that another browser holds stays with that one. A browser holds one body at a time.
        """
        if not 0 <= index < self.count or self.grabbed_by.get(index, client) != client:
            return
        if self.grabbed_by.get(index) != client:
            self.release(client)
        self.grabbed_by[index], self.targets[index] = client, target
        pull(self.fleet, index, (0.0, 0.0, 0.0), target, limit * GRAVITY * float(self.fleet.mass[index]))

    def release(self, client: int = 0) -> None:
        """Release the body that a browser holds; it keeps its velocity."""
        for index in [index for index, grabber in self.grabbed_by.items() if grabber == client]:
            self.fleet.pull_limit[index] = 0.0
            self.heave_meter.restart(index)
            self.lift.restart(index)
            del self.grabbed_by[index], self.targets[index]

    def moor(self, h: float, *, moored: bool = True) -> None:
        """Let the lines pull as in the middle of a step of h [s]: by a body's place before it they would drive it."""
        fleet = self.fleet
        if not moored:
            fleet.mooring[:] = self.tension[:] = 0.0
            return
        fleet.mooring[:], self.tension = pulls(self.lines, fleet.position + 0.5 * h * fleet.velocity, fleet.rotation)

    def fairleads(self, *, moored: bool) -> NDArray[np.float32]:
        """Where the lines of each body are fixed to it (n, 3) [m]; (0, 3) without lines."""
        if not moored:
            return np.empty((0, 3), np.float32)
        return fairleads(self.lines, self.fleet.position, self.fleet.rotation).astype(np.float32)

    def step(
        self,
        at: SurfaceAt,
        h: float,
        slick: np.ndarray,
        coefficients: MotionCoefficients,
        forces: np.ndarray | None = None,
    ) -> None:
        """One step of h [s] on the sea `at` the bodies in the middle of the step.

        slick (n,) [m]: thickness of oil at each that is no layer. forces: those of `forces_of`; None for a sea that is
        no sum of waves. Raises FloatingPointError where a body's state is no longer finite.
        """
        if self.count == 0:
            return
        column, self.slick = self.column, slick
        layer = column.thickness + slick
        oil = column.kind != "mixed" and bool((layer > 0.0).any())
        layers = ((column.oil.density, 1.0), (column.water.density, math.inf)) if oil else column.layers
        interface = {}
        if oil:
            # The interface of the fluid column; where a slick is on top of it, it is deeper by the slick.
            interface = {
                "interface": at.interface - layer,
                "interface_slope": at.interface_slope,
                "interface_rise": at.interface_rise,
            }
        water = make_water(
            self.fleet,
            layers,
            at.height,
            slope=at.slope,
            velocity=at.velocity,
            acceleration=at.acceleration if forces is not None else self.acceleration_of(at, h, coefficients.gravity),
            excitation=forces,
            lead=h / 2,
            **interface,
        )
        step(self.fleet, water, h, coefficients)
        self.lift.update(self.fleet.lift, h)
        # A body that presses on the water with more or less than the weight it carries makes waves.
        carried = self.fleet.mass * coefficients.gravity
        self.impulse += np.where(self.fleet.buoyancy > 0.0, self.fleet.buoyancy - carried, 0.0) * h
        at_rest = self.fleet.position[:, 2] < -BED_DEPTH
        self.fleet.position[at_rest, 2] = -BED_DEPTH
        self.fleet.velocity[at_rest] = 0.0

    def acceleration_of(self, at: SurfaceAt, h: float, gravity: float) -> np.ndarray:
        """Upward acceleration (n,) [m/s2] of the water that the bodies meet along their way.

        So it has no mean, as that at places that move with the waves would have (sim/floating/excitation.py).
        """
        self.rises = (at.velocity[:, 2].copy(), *self.rises[: len(LAST_RATES)])
        if len(self.rises) <= len(LAST_RATES):
            return at.acceleration
        return np.clip(rate_of_change(self.rises, h), -MAX_ACCELERATION * gravity, MAX_ACCELERATION * gravity)

    def forces_of(self, sea: RadialSea, at: SurfaceAt, t: float, h: float) -> np.ndarray:
        """Force and moment (n, 6) of waves on the bodies for the next h [s], from the sea in the middle of it."""
        return self.excitation.forces(self.fleet, at.label, sea.waves_at(t), t, h)

    def measure(self, t: float, at: SurfaceAt, duration: float, lead: float = 0.0) -> None:
        """Measure drafts at time t [s]: the length of each body below the plane of the water, along its own axis.

        lead [s]: how long after that time the sea is as it is `at` the bodies.
        That length, times the area of the cross-section, is the wet volume of a hull with straight sides, however it
        leans. Of a sphere every diameter is an axis; it is measured along the normal of the water.
        """
        normal = np.column_stack([-at.slope, np.ones(self.count)])
        normal /= np.sqrt((normal * normal).sum(axis=1, keepdims=True))
        up = np.where(self.is_round[:, None], normal, body_z_axes(self.fleet.rotation))
        keel = self.keel[:, None] * up  # from a body's centre
        rise = at.velocity[:, 2] - (at.velocity[:, :2] * at.slope).sum(axis=1)
        keel[:, 2] += self.fleet.position[:, 2] - (at.height - lead * rise)
        lean = np.maximum((normal * up).sum(axis=1), MIN_COSINE)
        self.draft[:] = -(normal * keel).sum(axis=1) / lean
        self.heave_meter.update(t, self.draft, duration)
        oiled = (self.slick > 0.0) | (self.column.kind != "water")
        np.maximum(self.stain, np.where(oiled, self.draft, 0.0), out=self.stain)

    def readings(self, t: float, count: int = MAX_READINGS) -> tuple[BodyReading, ...]:
        """The first `count` bodies at time t [s], and the one from a file."""
        offsets = np.hypot(*(self.fleet.position - self.lines.anchors.mean(axis=1)).T[:2])
        return tuple(
            BodyReading(
                kind.name,
                kind.title,
                density=self.densities[i],
                volume=self.hulls[kind.name].volume,
                mass=float(self.fleet.mass[i]),
                buoyancy=float(self.fleet.buoyancy[i]),
                mean_lift=tuple(self.lift.of(i).tolist()),
                wet_volume=(float(self.fleet.wet_volume[i, 0]), float(self.fleet.wet_volume[i, 1])),
                draft=float(self.draft[i]),
                mean_draft=float(self.heave_meter.mean.of(i)[0]),
                period=self.heave_meter.period(i, t),
                offset=float(offsets[i]),
                tension=float(self.tension[i].max()),
                prediction=self.prediction(i),
                has_own_coefficients=bool(kind.shape.linear) or kind.shape.table is not None,
            )
            for i, kind in enumerate(self.body_kinds)
            if i < count or i >= self.count_asked
        )
