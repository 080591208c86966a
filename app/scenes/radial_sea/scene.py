"""The radial sea: buoys and a box on water, on oil, or on both mixed, near a rig that may burn."""

import collections
import dataclasses
import math
import time
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from app.messages import DivergenceError, Grab, Place, Release, SceneCommand, Vector, WorkCount
from app.scenes.charts import PlotAxes
from app.scenes.contract import SceneKind
from app.scenes.radial_sea.bodies import FloatingBodies
from app.scenes.radial_sea.cutaway import Section, outline, section_at
from app.scenes.radial_sea.frame import Compared, RadialFrame, RadialReadings
from app.scenes.radial_sea.measures import measures
from app.scenes.radial_sea.parameters import PRESETS, Params, column_of, conditions_of, exposure_of, hidden
from app.scenes.radial_sea.well_blowout import WellBlowout, slick_reach
from sim.floating import Hull, Laws
from sim.ocean import Sea
from sim.ocean.gerstner import Waves, draw_waves
from sim.ocean.radial import RadialSea, RadialSurface
from sim.ocean.radial_grid import RadialGrid
from sim.ocean.radiated_waves import LENGTH as WAKES_LENGTH
from sim.ocean.radiated_waves import RadiatedWaves
from sim.ocean.spectra import SPECTRA
from sim.ocean.tile_sea import TileSea
from sim.parameters import check_record

TITLE = "Radial sea"
HELP = (
    "<b>Drag</b> a buoy or the box under and let go, or throw it. <b>Pour oil</b> and compare each draft with "
    "Archimedes' in the table."
)
SERIES = ("red buoy", "yellow buoy", "box", "surface", "red buoy's height")
PLOTS = {
    "plot_draft": PlotAxes("Draft", "m", ("red buoy", "yellow buoy", "box")),
    "plot_surface": PlotAxes("Surface and red buoy", "m", ("surface", "red buoy's height")),
}
FRAME_INTERVAL = 1 / 30  # [s] between frames
RADIUS = 5000.0  # [m] of the grid
INNER = 0.35  # [m] its first ring
TILE, TILE_LENGTH = 128, 256.0  # the square sea: as many vertices as the rings
SAMPLE_EVERY = 1 / 15  # [s] between plot rows
AGE_EVERY = 1.0  # [s] between two decays of the sum of waves
AGE_TILE = 0.2  # growth of the age at which the square sea, which takes longer, is made anew
COMPARE_EVERY = 2.0  # [s] of wall time between two timings of the other surface
FOAM_NEAR = 80.0  # [m] within which the Jacobian is looked at for foam
FOAM_OVER = 0.07  # of the Jacobian, over which foam fills up
FOAM_CALM = 0.97  # Jacobian above which nothing is foam
WARM = {"bodies": {}, "fire": {"fire": True, "jet": True, "spill": "layer"}, "square sea": {"surface": "fft"}}


def warm_up() -> Iterator[str]:
    """Compile everything the scene may call, piece by piece; yields what comes next."""
    for name, changes in WARM.items():
        yield name
        scene = RadialSeaScene(check_record(Params, changes))
        scene.handle(Grab(0, (0.0, 0.0, 0.0)))
        for _ in range(8):
            scene.advance(1)
        scene.frame()
        scene.readings()


class RadialSeaScene:
    """The radial sea on the simulation thread."""

    frame_interval = FRAME_INTERVAL

    def __init__(self, params: Params) -> None:
        self.params = params
        self.own = Hull.load(params.hull) if params.hull else None
        self.samples: list[tuple[float, ...]] = []
        self.counts: collections.Counter[str] = collections.Counter()
        self.reset()

    @property
    def step(self) -> float:
        return self.params.time_step

    @property
    def note(self) -> str:
        """Why something else runs than the parameters ask for, or ""."""
        return ""

    def reset(self) -> None:
        """The bodies at rest in their places, and no oil but the layer the parameters ask for."""
        p = self.params
        self.time = 0.0
        self.column, self.age = column_of(p), exposure_of(p)
        self.sum = RadialSea(self.waves(), self.column, self.age, p.choppiness)
        self.tile: TileSea | None = None
        self.tile_age = 0.0
        self.grid = self.make_grid()
        self.crowd = FloatingBodies(p.bodies, p.size, p.density, self.column, self.own)
        self.wakes = RadiatedWaves()
        self.blowout = WellBlowout(p)
        self.eye = (0.0, 0.0)
        self.target: Vector | None = None
        self.threshold = 0.0  # Jacobian below which there is foam, a running mean
        self.costs: dict[str, float] = {}
        self.compared_at = self.sampled_at = -math.inf
        self.drawn: tuple[object, ...] = ()
        self.samples.append((math.nan,) * (len(SERIES) + 1))

    def waves(self) -> Waves:
        """The waves that the parameters ask for."""
        p = self.params
        return draw_waves(SPECTRA[p.spectrum], conditions_of(p), p.wave_count)

    def make_grid(self) -> RadialGrid:
        p = self.params
        return RadialGrid(p.rings, p.spokes, INNER, RADIUS, p.ring_law)

    def make_tile(self) -> TileSea:
        """The square sea under the same wind and oil; what oil took of a wave, exp(-2 nu k^2 T), is its low-pass."""
        p, fluid = self.params, self.column.surface
        low_pass = 2.0 * math.sqrt(fluid.kinematic_viscosity * self.age)
        self.tile_age = self.age
        conditions = dataclasses.replace(conditions_of(p), low_pass=low_pass)
        wind = {name: getattr(conditions, name) for name in ("wind_speed", "wind_direction", "low_pass")}
        sea = Sea(TILE, TILE_LENGTH, p.spectrum, choppiness=p.choppiness, frequency=self.column.omega, **wind)
        return TileSea(sea)

    @property
    def sea(self) -> RadialSea | TileSea:
        """The surface in force."""
        if self.params.surface == "sum":
            return self.sum
        if self.tile is None:
            self.tile = self.make_tile()
        return self.tile

    def change_forces(self, params: Params) -> None:
        """Take new parameters; what need not start over goes on."""
        old, self.params = self.params, params

        def changed(*names: str) -> bool:
            return any(getattr(params, name) != getattr(old, name) for name in names)

        self.column = column_of(params)
        sea = changed("waves", "wind_speed", "wind_direction", "spectrum", "wave_count")
        fluids = changed("spill", "oil", "thickness", "fraction", "mixture_law", "film", "exposure")
        if fluids:
            self.age = exposure_of(params)
        if sea or fluids:
            self.sum.change(self.time, self.waves() if sea else None, self.column, self.age)
        self.sum.choppiness = params.choppiness
        if sea or fluids or changed("choppiness"):
            self.tile = None
        if changed("rings", "spokes", "ring_law"):
            self.grid = self.make_grid()
        if changed("bodies", "size"):
            self.crowd = FloatingBodies(params.bodies, params.size, params.density, self.column, self.own)
            self.target = None
        elif fluids or changed("density"):
            self.crowd.restate(params.density, self.column)
        if not params.ripples and old.ripples:
            self.wakes = RadiatedWaves()
        self.blowout.set_params(params, old)
        self.costs = {}

    def handle(self, command: SceneCommand) -> None:
        match command:
            case Grab(index, target):
                self.crowd.release()
                self.crowd.hold(index, target, self.params.pull)
                self.target = target if self.crowd.held else None
            case Release():
                self.crowd.release()
                self.target = None
            case Place("eye", (x, y, _)):
                self.eye = (x, y)

    def advance(self, steps: int) -> None:
        """Take steps; raises DivergenceError where a body's state is no longer finite."""
        crowd, sea, h = self.crowd, self.sea, self.step
        laws = Laws()
        touched = crowd.touched
        for _ in range(steps):
            if crowd.count:
                at = sea.at(crowd.fleet.position[:, :2], self.time, crowd.widths)
                layer = self.layer_at(crowd.fleet.position[:, :2])
                crowd.measure(self.time, at, h)
                if self.params.mooring:
                    crowd.moor()
                try:
                    crowd.step(self.column, at, self.time, h, layer, laws)
                except FloatingPointError as error:
                    raise DivergenceError(f"At t = {self.time:.2f} s {error}. Reset, or take a smaller step.") from None
                plotted = self.params.plot_draft or self.params.plot_surface
                if plotted and self.time - self.sampled_at >= SAMPLE_EVERY:
                    self.sample(float(at.height[0]))
            self.time += h
        if self.params.ageing and self.column.kind != "water":
            self.grow_old(steps * h)
        n = crowd.count
        done = {"body steps": steps * n, "pairs": steps * n * (n - 1) // 2, "touches": crowd.touched - touched}
        self.counts.update(done)
        if self.params.ripples and crowd.count:
            self.wakes.press(self.time, crowd.fleet.position[:, :2], crowd.widths, crowd.impulse)
        crowd.impulse[:] = 0.0
        self.blowout.step(sea, self.time, steps * h)

    def grow_old(self, duration: float) -> None:
        """Let the waves decay under the oil for `duration` [s] more."""
        self.age += duration
        if self.age - self.sum.exposure >= AGE_EVERY:
            self.sum.age(self.age)
        if self.tile is not None and self.age > (1.0 + AGE_TILE) * self.tile_age + AGE_EVERY:
            self.tile = None

    def layer_at(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Thickness (n,) [m] of oil under the surface at points (n, 2) [m]."""
        found = np.full(len(points), self.column.thickness)
        slick = self.blowout.slick(self.column)
        if slick is not None and self.column.kind != "mixed":
            found[slick_reach(slick, points[:, 0], points[:, 1]) > 0.0] += slick.thickness
        return found

    def sample(self, surface: float) -> None:
        draft = np.zeros(3)  # of bodies that are not there: a NaN may reach no browser
        draft[: min(3, self.crowd.count)] = self.crowd.draft[:3]
        self.samples.append((self.time, *draft.tolist(), surface, float(self.crowd.fleet.position[0, 2])))
        self.sampled_at = self.time

    def take_plot_rows(self) -> tuple[tuple[float, ...], ...]:
        taken, self.samples = tuple(self.samples), []
        return taken

    def frame(self) -> RadialFrame:
        p, crowd = self.params, self.crowd
        key = (self.time, self.grid, p, self.eye)
        if key != self.drawn:
            self.draw()
            self.drawn = key
        pull = None
        if self.target is not None and crowd.held:
            x, y, z = crowd.fleet.position[next(iter(crowd.held))].tolist()
            pull = ((x, y, z), self.target)
        fire, jet = self.blowout.fire, self.blowout.jet
        flames = None
        if fire is not None:
            flames = (
                fire.position.copy(),
                np.stack([fire.heat, fire.age / np.maximum(fire.life, np.float32(1e-3))]).astype(np.float32),
            )
        return RadialFrame(
            params=p,
            time=self.time,
            grid=self.grid,
            surface=self.surface,
            foam=self.foam,
            slick=self.blowout.slick(self.column) if self.column.kind == "water" else None,
            section=self.section,
            kinds=tuple(crowd.kinds),
            own=self.own,
            positions=crowd.fleet.position.astype(np.float32),
            rotations=crowd.fleet.rotation.astype(np.float32),
            pull=pull,
            fire=flames,
            jet=None if jet is None else jet.position[:, jet.flying].T.astype(np.float32),
            column=self.column,
            age=self.age,
        )

    def draw(self) -> None:
        """The surface, its foam and the window into it, as they are now."""
        p = self.params
        centre = self.eye if p.centre == "camera" else (0.0, 0.0)
        self.surface = self.timed(p.surface, self.sea, centre)
        wall = time.monotonic()
        if wall - self.compared_at > COMPARE_EVERY:
            self.compared_at = wall
            other = "fft" if p.surface == "sum" else "sum"
            if other == "fft" and self.tile is None:
                self.tile = self.make_tile()
            other_sea = self.tile if other == "fft" else self.sum
            assert other_sea is not None
            self.timed(other, other_sea, centre)
        vertices, slopes = self.surface.vertices, self.surface.slope
        if p.ripples:
            near = int((self.grid.radii < WAKES_LENGTH).sum()) * self.grid.spokes
            for part in (slice(0, len(self.grid) - 1 if p.centre == "camera" else near), slice(-1, None)):
                self.wakes.lay(self.time, vertices[part], slopes[part], len(vertices))
        self.foam = self.whitecaps()
        self.section = self.cut() if p.section else None
        rings = p.ripples and self.wakes.sea.ripples.alive
        self.counts.update({"surfaces": 1, "rings": int(rings), "windows": int(p.section)})

    def whitecaps(self) -> NDArray[np.float32]:
        """Foam (n,), 0 to 1, where the surface is pressed together most: as much of the sea as Monahan measured.

        W = 3.84e-6 U^3.41 (Monahan and O'Muircheartaigh 1980), less by what oil took of the mean square slope.
        """
        p, jacobian = self.params, self.surface.jacobian
        clean = 0.5 * float(np.square(self.sum.waves.k * self.sum.waves.amplitude).sum())
        kept = self.sum.mean_square_slope / clean if clean > 0.0 else 0.0
        share = 3.84e-6 * p.wind_speed**3.41 * kept if p.waves else 0.0
        near = jacobian[: int((self.grid.radii < FOAM_NEAR).sum()) * self.grid.spokes]
        now = float(np.quantile(near, share)) if len(near) else 0.0
        self.threshold += 0.05 * (now - self.threshold) if self.threshold else now
        if self.threshold > FOAM_CALM:
            return np.zeros_like(jacobian)
        return np.clip((self.threshold - jacobian) / np.float32(FOAM_OVER) + 0.5, 0.0, 1.0).astype(np.float32)

    def timed(self, name: str, sea: RadialSea | TileSea, centre: tuple[float, float]) -> RadialSurface:
        before = sea.evaluated, sea.skipped
        start = time.perf_counter()
        surface = sea.on(self.grid, self.time, centre)
        taken = time.perf_counter() - start
        self.counts.update({"waves": sea.evaluated - before[0], "waves left out": sea.skipped - before[1]})
        self.costs[name] = taken if name not in self.costs else 0.9 * self.costs[name] + 0.1 * taken
        return surface

    def cut(self) -> Section:
        """The sea at the walls of a window before the first body, as drawn there."""
        crowd, size = self.crowd, self.params.size
        x, y = crowd.fleet.position[0, :2].tolist() if crowd.count else (0.0, 0.0)
        points = outline((x, y), size)
        at = self.sea.at(points, self.time)
        walls = np.column_stack([points, at.height]).astype(np.float32)
        if self.params.ripples:
            self.wakes.lay(self.time, walls, np.zeros((len(walls), 2), np.float32), len(walls))
        top = walls[:, 2].astype(np.float64)
        layer = self.layer_at(points)
        oiled = self.column.kind != "mixed" and bool(layer.max() > 0.0)
        interface = at.interface - layer + (top - at.height) if oiled else top
        return section_at((x, y), size, points, top, interface, oiled)

    def readings(self) -> RadialReadings:
        s, grid = self.sum, self.grid
        clean = s.waves
        compared, tile = {}, self.tile
        if "sum" in self.costs:
            shortest, extent = 2 * float(grid.spacing[0]), 2 * float(grid.radii[-1])
            numbers = shortest, extent, s.significant_height, s.mean_square_slope
            compared["sum"] = Compared(
                self.costs["sum"], len(clean.kx), *numbers, 0.0
            )  # of equal energy by their making
        if "fft" in self.costs and tile is not None:
            numbers = 2 * TILE_LENGTH / TILE, TILE_LENGTH, tile.significant_height, tile.mean_square_slope
            error = tile.significant_height / s.significant_height - 1.0 if s.significant_height > 0.0 else 0.0
            compared["fft"] = Compared(self.costs["fft"], TILE * TILE // 2, *numbers, error)
        return RadialReadings(
            readings=self.crowd.readings(self.time),
            column=self.column,
            height=s.significant_height,
            height_clean=clean.significant_height,
            slope=s.mean_square_slope,
            slope_clean=0.5 * float(np.square(clean.k * clean.amplitude).sum()),
            peak_period=2 * math.pi / float(s.rate[len(s.rate) // 2]),
            tally=self.blowout.tally(self.column),
            compared=compared,
            age=self.age,
        )

    def curves(self) -> None:
        """No chart but over time."""
        return

    def work(self) -> dict[str, WorkCount]:
        """For the ledger: each wave at each vertex, each pair of bodies, and what may be laid on every surface."""
        c = self.counts
        return {
            "waves summed at vertices": WorkCount(c["waves"], c["waves left out"]),
            "steps of bodies": WorkCount(c["body steps"]),
            "pairs of bodies in touch": WorkCount(c["touches"], max(c["pairs"] - c["touches"], 0)),
            "surfaces with rings of bodies": WorkCount(c["rings"], c["surfaces"] - c["rings"]),
            "surfaces with a window": WorkCount(c["windows"], c["surfaces"] - c["windows"]),
        }

    def arrays(self) -> dict[str, tuple[NDArray[np.float64], str]]:
        """The state for a file: name -> (array, unit)."""
        fleet = self.crowd.fleet
        return {
            "position": (fleet.position.copy(), "m"),
            "rotation": (fleet.rotation.copy(), "quaternion (w, x, y, z)"),
            "velocity": (fleet.velocity.copy(), "m/s"),
            "draft": (self.crowd.draft.copy(), "m"),
        }


SCENE = SceneKind(
    name="radial_sea",
    title="Radial sea",
    help=HELP,
    params=Params,
    presets=PRESETS,
    make=RadialSeaScene,
    hidden=hidden,
    warm_up=warm_up,
    series=SERIES,
    plots=PLOTS,
    measures=measures,
)
