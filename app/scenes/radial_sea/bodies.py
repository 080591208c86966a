"""The floating bodies of the radial sea: their places, predictions and measured values."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.formats.formatting import largest_force
from app.messages import Pull, vector_of
from app.scenes.radial_sea.meters import BodyMeters
from app.scenes.radial_sea.moorings import BED_DEPTH, BodyMoorings
from sim.floating import (
    SHAPES,
    Body,
    Fleet,
    Hull,
    HydrostaticPrediction,
    MotionCoefficients,
    Shape,
    make_fleet,
    predict,
    pull,
)
from sim.floating.motion.body import pack_linear
from sim.floating.motion.sea_steps import SeaSteps
from sim.floating.shapes import Appearance
from sim.interruption import raise_if_stopped
from sim.ocean.any_sea import AnySea, SurfaceAt
from sim.ocean.fluids.fluid_column import FluidColumn

GRAVITY = 9.81  # [m/s2]
FIRST_PLACES = ((-2.4, 1.0), (-3.0, 4.6), (0.4, -0.8))  # [m] at size 1 of the first three bodies
FILE_PLACE = (-0.2, 2.4)  # [m] at size 1 of a hull from a file that is 2 m wide; a wider one floats farther out
FILE_DIRECTION = (0.35, 0.94)  # in which a wider one is moved
SPIRAL_SPACING = 4.2  # [m] at size 1 between the turns of the spiral of the other bodies
MAX_READINGS = 6  # bodies of the scene's own in the table
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
    """The number of the first box, or None."""
    return next((i for i, kind in enumerate(bodies.body_kinds) if kind.shape.name == "box"), None)


class BodyPull(NamedTuple):
    """The pull of a browser on a body."""

    client: int
    target: tuple[float, float, float]  # [m]


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
        hulls = self.hull_of_each()
        keel = np.array([hull.extents[2, 0] for hull in hulls])
        self.meters = BodyMeters(keel, np.array([kind.shape.is_round for kind in body_kinds], bool))
        self.moorings = BodyMoorings(self.fleet.position[:, :2], self.drafts_at_rest(), hulls)
        self.widths = np.array([np.ptp(hull.extents[0]) for hull in hulls])  # (n,) [m]
        self.steps = self.make_steps()
        self.pulls: dict[int, BodyPull] = {}  # of the bodies that are grabbed
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
            prediction = predict(self.hulls[name], self.densities[i], layers, column.water.density)
            self.known_predictions[key] = prediction
        return self.known_predictions[key]

    def hull_of_each(self) -> list[Hull]:
        """The hull of each body."""
        return [self.hulls[kind.name] for kind in self.body_kinds]

    def drafts_at_rest(self) -> NDArray[np.float64]:
        """(n,) [m] of each body; the height of one that sinks."""
        predictions = map(self.prediction, range(self.count))
        return np.array([p.draft if math.isfinite(p.draft) else p.height for p in predictions])

    def set_fluids(self, density: float, column: FluidColumn, own_densities: tuple[float, ...] = ()) -> None:
        """Take other densities of the bodies [kg/m3], or other fluids; nothing is moved."""
        self.column = column
        self.densities = self.densities_of(density, own_densities)
        self.known_predictions.clear()
        self.fleet.mass[:] *= self.densities / self.fleet.density
        self.fleet.density[:] = self.densities
        hulls = self.hull_of_each()
        linear_hull, linear = pack_linear(hulls, self.densities, column.layers)
        self.fleet = self.fleet._replace(linear_hull=linear_hull, linear=linear)
        self.moorings.tie(self.moorings.places, self.drafts_at_rest(), hulls)
        self.steps = self.make_steps()
        self.meters.restart()

    def set_down(self, i: int, draft: float) -> None:
        """Put body i at rest, with its lowest point this deep [m] below the mean level."""
        self.fleet.position[i, 2] = -self.meters.keel[i] - draft
        self.fleet.velocity[i] = 0.0
        self.meters.restart()

    def make_steps(self) -> SeaSteps:
        """Steps of these bodies in these fluids."""
        bodies = [Body(hull, density) for hull, density in zip(self.hull_of_each(), self.densities, strict=True)]
        return SeaSteps(bodies, self.widths, self.column.layers)

    def grab(self, index: int, target: tuple[float, float, float], limit: float, client: int = 0) -> None:
        """Pull body `index` towards a target [m] for a browser, with at most `limit` weights of the body.

        A body that another browser holds stays with that one. A browser holds one body at a time.
        """
        held = {number: one.client for number, one in self.pulls.items()}
        if not 0 <= index < self.count or held.get(index, client) != client:
            return
        if index not in held:
            self.release(client)
            self.fleet.pull_force[index] = 0.0
        self.pulls[index] = BodyPull(client, target)
        pull(self.fleet, index, (0.0, 0.0, 0.0), target, limit * GRAVITY * float(self.fleet.mass[index]))

    def drawn_pulls(self) -> tuple[Pull, ...]:
        """The pulls of all grabbed bodies."""
        fleet = self.fleet
        return tuple(
            Pull(vector_of(fleet.position[i]), one.target, float(fleet.pull_force[i]) / limit, largest_force(limit))
            for i, one in self.pulls.items()
            if (limit := float(fleet.pull_limit[i]))
        )

    def release(self, client: int = 0) -> None:
        """Release the body that a browser holds; it keeps its velocity."""
        for index in [index for index, one in self.pulls.items() if one.client == client]:
            self.fleet.pull_limit[index] = 0.0
            self.meters.restart_of(index)
            del self.pulls[index]

    def release_all(self) -> None:
        """Release all bodies."""
        for client in {one.client for one in self.pulls.values()}:
            self.release(client)

    def moor(self, h: float, *, moored: bool = True) -> None:
        """Let the lines pull as in the middle of a step of h [s]."""
        self.moorings.pull(self.fleet, h, moored=moored)

    def step(
        self, sea: AnySea, at: SurfaceAt, middle: float, h: float, slick: np.ndarray, coefficients: MotionCoefficients
    ) -> None:
        """One step of h [s] on the sea `at` the bodies in the middle [s] of the step.

        slick (n,) [m]: thickness of oil at each that is no layer. Raises FloatingPointError if a body's state is no
        longer finite.
        """
        if self.count == 0:
            return
        column, self.slick = self.column, slick
        layer = column.thickness + slick  # a slick on top of a layer makes its interface deeper
        oil = column.kind != "mixed" and bool((layer > 0.0).any())
        layers = ((column.oil.density, 1.0), (column.water.density, math.inf)) if oil else column.layers
        self.steps.step(sea, self.fleet, at, middle, h, coefficients, layers, layer if oil else None)
        self.meters.lift.update(self.fleet.lift, h)
        # A body that presses on the water with more or less than the weight it carries makes waves.
        carried = self.fleet.mass * coefficients.gravity
        self.impulse += np.where(self.fleet.buoyancy > 0.0, self.fleet.buoyancy - carried, 0.0) * h
        at_rest = self.fleet.position[:, 2] < -BED_DEPTH
        self.fleet.position[at_rest, 2] = -BED_DEPTH
        self.fleet.velocity[at_rest] = 0.0

    def measure(self, t: float, at: SurfaceAt, duration: float, lead: float = 0.0) -> None:
        """Measure drafts and stains at time t [s], `lead` [s] before the time of the surface `at` the bodies."""
        self.meters.measure(self.fleet, t, at, duration, lead)
        self.meters.wet_with_oil((self.slick > 0.0) | (self.column.kind != "water"))

    def readings(self, t: float, count: int = MAX_READINGS) -> tuple[BodyReading, ...]:
        """The first `count` bodies at time t [s], and the one from a file."""
        meters, offsets = self.meters, np.hypot(*(self.fleet.position[:, :2] - self.moorings.places).T)
        return tuple(
            BodyReading(
                kind.name,
                kind.title,
                density=self.densities[i],
                volume=self.hulls[kind.name].volume,
                mass=float(self.fleet.mass[i]),
                buoyancy=float(self.fleet.buoyancy[i]),
                mean_lift=tuple(meters.lift.of(i).tolist()),
                wet_volume=(float(self.fleet.wet_volume[i, 0]), float(self.fleet.wet_volume[i, 1])),
                draft=float(meters.draft[i]),
                mean_draft=float(meters.heave.mean.of(i)[0]),
                period=meters.heave.period(i, t),
                offset=float(offsets[i]),
                tension=float(self.moorings.tension[i].max()),
                prediction=self.prediction(i),
                has_own_coefficients=bool(kind.shape.linear) or kind.shape.table is not None,
            )
            for i, kind in enumerate(self.body_kinds)
            if i < count or i >= self.count_asked
        )
