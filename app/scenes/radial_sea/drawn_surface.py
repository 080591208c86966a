"""The drawn surface of the radial sea, its foam and its cutaway, and the cost of the two ways to compute it."""

import dataclasses
import math
import time
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from app.scenes.packed_surface import SentSurface
from app.scenes.radial_sea.bodies import FloatingBodies
from app.scenes.radial_sea.cutaway import Cutaway, cutaway_at, outline
from app.scenes.radial_sea.frame import SurfaceReading
from app.scenes.radial_sea.parameters import RadialSeaParams, conditions_of, spectrum_of
from app.scenes.radial_sea.radiated_waves import LENGTH as RADIATED_WAVES_LENGTH
from app.scenes.radial_sea.radiated_waves import RadiatedWaves
from app.scenes.radial_sea.wave_choice import WaveChoice
from sim.ocean import Sea
from sim.ocean.any_sea import AnySea, RadialSurface
from sim.ocean.fluids.fluid_column import FluidColumn
from sim.ocean.radial.radial import CLEAN, RadialSea, lost
from sim.ocean.radial.radial_grid import RadialGrid
from sim.ocean.statistics.foam import whitecaps
from sim.ocean.statistics.statistics import energy_by_wavenumber, expected
from sim.waves import Waves

NEGLIGIBLE_ENERGY = 1e-4  # of the largest of all parts of the spectrum: a part with less is left out
COMPARE_INTERVAL = 2.0  # [s] of wall time between two timings of the other surface
COST_MEMORY = 0.9  # fraction of the old value in the running mean of a surface's cost
FOAM_RADIUS = 80.0  # [m] within which the foam threshold is measured
FOAM_GAIN = 0.05  # fraction of the new value in the running mean of the foam threshold
FOAM_WIDTH = 0.07  # change of the Jacobian over which foam goes from none to full
MAX_FOAM_JACOBIAN = 0.97  # threshold above which nothing is foam: the surface is not compressed anywhere
TILE_SIZE, TILE_LENGTH = 128, 256.0  # points a side (as many vertices as the rings have) and side [m] of the square sea


class Foam:
    """Foam where the surface is pressed together most: as much of the sea as Monahan measured."""

    def __init__(self) -> None:
        self.threshold = 0.0  # Jacobian below which there is foam, a running mean

    def on(self, jacobian: NDArray[np.float32], near: int, share: float) -> NDArray[np.float32]:
        """Foam (n,), 0 to 1, on vertices with this Jacobian.

        near: how many of them, from the first, the threshold is measured on. share: of the sea that is foam.
        """
        now = quantile(jacobian[:near], share) if near else 0.0
        self.threshold += FOAM_GAIN * (now - self.threshold) if self.threshold else now
        if self.threshold > MAX_FOAM_JACOBIAN:
            return np.zeros_like(jacobian)
        return np.clip((self.threshold - jacobian) / np.float32(FOAM_WIDTH) + 0.5, 0.0, 1.0).astype(np.float32)


class SeaNow(Protocol):
    """The parts of the scene that the surface is drawn from."""

    params: RadialSeaParams
    time: float  # [s]
    camera: tuple[float, float]  # x, y [m]
    grid: RadialGrid
    column: FluidColumn
    wave_choice: WaveChoice
    sum: RadialSea
    tile: Sea | None
    bodies: FloatingBodies
    radiated_waves: RadiatedWaves
    foam: Foam

    @property
    def sea(self) -> AnySea:
        """The surface in force."""
        ...

    def tile_now(self) -> Sea:
        """The square sea, made if it is not there."""
        ...

    def slick_at(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Thickness (n,) [m] of the slick at points (n, 2) [m]."""
        ...


class DrawnSurface:
    """Surface, foam and cutaway of the latest frame."""

    surface: RadialSurface
    foam: NDArray[np.float32]  # (n,) 0 to 1
    middle: tuple[float, float]  # x, y [m] of the middle of the grid
    cutaway: Cutaway | None
    sent: SentSurface

    def __init__(self) -> None:
        self.drawn: tuple[object, ...] = ()  # time, parameters and camera of the surface
        self.known_clean: tuple[Waves, tuple[float, float, float]] | None = None  # waves, and their `clean_waves`
        self.spectrum_energy: tuple[WaveChoice, NDArray[np.float64], NDArray[np.float64]] | None = None
        self.decayed_height: tuple[tuple[object, ...], float] | None = None  # Hs [m] of the spectrum
        self.forget_costs()

    def forget_costs(self) -> None:
        """Forget the cost of the surfaces: it may have changed."""
        self.costs: dict[str, float] = {}  # surface -> [s] a frame, a running mean
        self.compared_at = -math.inf  # [s] of wall time

    def update(self, scene: SeaNow) -> None:
        """Compute surface, foam and cutaway of the scene as it is now, unless they are of it."""
        p, grid = scene.params, scene.grid
        key = (scene.time, p, scene.camera)
        if key == self.drawn:
            return
        centre = self.middle = scene.camera if p.centre == "camera" else (0.0, 0.0)
        self.surface = self.timed_surface(p.surface, scene.sea, scene, centre)
        if p.compare:
            self.compare(scene, centre)
        vertices, slopes = self.surface.vertices, self.surface.slope
        if p.ripples:
            # Radiated waves exist near the origin only: the inner rings, and the centre, which is the last vertex.
            near = int((grid.radii < RADIATED_WAVES_LENGTH).sum()) * grid.spokes
            for part in (slice(0, len(grid) - 1 if p.centre == "camera" else near), slice(-1, None)):
                scene.radiated_waves.lay(scene.time, vertices[part], slopes[part], len(vertices))
        near = int((grid.radii < FOAM_RADIUS).sum()) * grid.spokes
        self.foam = scene.foam.on(self.surface.jacobian, near, self.foam_share(scene))
        self.sent = SentSurface()
        self.cutaway = make_cutaway(scene) if p.cutaway else None
        self.drawn = key

    def foam_share(self, scene: SeaNow) -> float:
        """Fraction of the sea that is foam. Oil reduces it in proportion to the mean square slope that it leaves."""
        clean = self.clean_waves(scene.sum)[1]
        remaining = scene.sum.mean_square_slope / clean if clean > 0.0 else 0.0
        return whitecaps(scene.params.wind_speed) * remaining if scene.params.waves else 0.0

    def clean_waves(self, sea: RadialSea) -> tuple[float, float, float]:
        """(middle period [s], mean square slope, significant height [m]) of the waves on clean water."""
        waves = sea.waves
        if self.known_clean is None or self.known_clean[0] is not waves:
            numbers = middle_period(sea), mean_square_slope(waves), waves.significant_height
            self.known_clean = waves, numbers
        return self.known_clean[1]

    def timed_surface(self, name: str, sea: AnySea, scene: SeaNow, centre: tuple[float, float]) -> RadialSurface:
        """Surface of a sea on the scene's grid about a centre [m]; its cost is recorded under `name`."""
        start = time.perf_counter()
        surface = sea.on(scene.grid, scene.time, centre)
        taken = time.perf_counter() - start
        self.costs[name] = COST_MEMORY * self.costs.get(name, taken) + (1.0 - COST_MEMORY) * taken
        return surface

    def compare(self, scene: SeaNow, centre: tuple[float, float]) -> None:
        """Time the surface that is not drawn, every few seconds."""
        wall = time.monotonic()
        if wall - self.compared_at < COMPARE_INTERVAL:
            return
        self.compared_at = wall
        if scene.params.surface == "sum":
            self.timed_surface("fft", scene.tile_now(), scene, centre)
        else:
            self.timed_surface("sum", scene.sum, scene, centre)

    def compared(self, scene: SeaNow) -> dict[str, SurfaceReading]:
        """The radial sum and the square sea side by side, as far as they were timed, each as expected of its waves."""
        readings, s, grid, tile = {}, scene.sum, scene.grid, scene.tile
        whole = self.spectrum_height(scene.wave_choice, s) if self.costs else 0.0

        def error(height: float) -> float:
            return height / whole - 1.0 if whole > 0.0 else 0.0

        if "sum" in self.costs:
            readings["sum"] = SurfaceReading(
                cost=self.costs["sum"],
                waves=len(s.waves.kx),
                shortest=2 * float(grid.spacing[0]),
                extent=2 * float(grid.radii[-1]),
                height=s.significant_height,
                slope=s.mean_square_slope,
                error=error(s.significant_height),
            )
        if "fft" in self.costs and tile is not None:
            height = expected(tile).significant_height
            readings["fft"] = SurfaceReading(
                cost=self.costs["fft"],
                waves=TILE_SIZE * TILE_SIZE // 2,
                shortest=2 * TILE_LENGTH / TILE_SIZE,
                extent=TILE_LENGTH,
                height=height,
                slope=tile.mean_square_slope,
                error=error(height),
            )
        return readings

    def spectrum_height(self, choice: WaveChoice, sea: RadialSea) -> float:
        """Hs [m] of the whole spectrum after the decay of the sum of waves: an integral over all wavenumbers."""
        key = choice, tuple(sea.past.items())
        if self.decayed_height is None or self.decayed_height[0] != key:
            if self.spectrum_energy is None or self.spectrum_energy[0] != choice:
                self.spectrum_energy = choice, *energy_by_wavenumber(choice.spectrum, choice.conditions)
            _, k, energy = self.spectrum_energy
            some = energy > NEGLIGIBLE_ENERGY * energy.max()
            energy_fraction = np.exp(-2.0 * lost(sea.past, k[some]))
            self.decayed_height = key, 4.0 * math.sqrt(float((energy[some] * energy_fraction).sum()))
        return self.decayed_height[1]


def tile_of(scene: SeaNow) -> Sea:
    """The square sea under the same wind, on the same fluids."""
    p, column = scene.params, scene.column
    conditions = conditions_of(p)
    sea = Sea(
        TILE_SIZE,
        TILE_LENGTH,
        spectrum_of(p),
        choppiness=p.choppiness,
        frequency=lambda k: column.roots(k)[0],
        **{field.name: getattr(conditions, field.name) for field in dataclasses.fields(conditions)},
    )
    for past, duration in scene.sum.past.items():
        sea.expose(duration, past)
    return sea


def make_cutaway(scene: SeaNow) -> Cutaway:
    """The sea at the walls of a cutaway beside the first body, as drawn there."""
    bodies, size = scene.bodies, scene.params.size
    x, y = bodies.fleet.position[0, :2].tolist() if bodies.count else (0.0, 0.0)
    points = outline((x, y), size)
    at = scene.sea.at(points, scene.time)
    walls = np.column_stack([points, at.height]).astype(np.float32)
    if scene.params.ripples:
        scene.radiated_waves.lay(scene.time, walls, np.zeros((len(walls), 2), np.float32), len(walls))
    top = walls[:, 2].astype(np.float64)
    layer = scene.column.thickness + scene.slick_at(points)
    has_oil = scene.column.kind != "mixed" and bool(layer.max() > 0.0)
    interface = at.interface - layer + (top - at.height) if has_oil else top
    return cutaway_at((x, y), size, points, top, interface, has_oil)


def middle_period(sea: RadialSea) -> float:
    """Period [s] on clean water above which half of the energy of the waves is; the longest waves come first.

    In thick oil waves may creep, and have no period.
    """
    energy = np.cumsum(np.square(sea.waves.amplitude))
    return 2.0 * math.pi / float(CLEAN.omega(sea.waves.k[np.searchsorted(energy, 0.5 * energy[-1])]))


def quantile(values: NDArray[np.float32], share: float) -> float:
    """The number below which a share, 0 to 1, of the values is; linear between two of them.

    numpy's own takes three times as long, most of it for shapes that are not needed here.
    """
    place = share * (len(values) - 1)
    low = int(place)
    high = min(low + 1, len(values) - 1)
    sorted_there = np.partition(values, (low, high))
    return float(sorted_there[low]) + (place - low) * float(sorted_there[high] - sorted_there[low])


def mean_square_slope(waves: Waves) -> float:
    """Mean square slope of waves on clean water."""
    return 0.5 * float(np.square(waves.k * waves.amplitude).sum())
