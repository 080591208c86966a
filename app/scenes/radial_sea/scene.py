"""The radial sea: buoys and a box on water, on oil, or on both mixed, near a rig that may burn."""

import dataclasses
import functools
import math
import time
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.messages import (
    DivergenceError,
    Grab,
    Place,
    PlotRow,
    Release,
    SceneCommand,
    StudentAnswer,
)
from app.scenes.charts import Chart, CurveAxes, PlotAxes
from app.scenes.contract import FramePacking, Pieces, SceneKind
from app.scenes.moments import copied, restore
from app.scenes.packed_surface import SentSurface
from app.scenes.plot_rows import PlotRows
from app.scenes.radial_sea.bodies import FloatingBodies, box_of, kind_of
from app.scenes.radial_sea.charts import BUDGET_LINES, budget_chart
from app.scenes.radial_sea.cutaway import Cutaway, cutaway_at, outline
from app.scenes.radial_sea.frame import (
    JetParcels,
    RadialFrame,
    RadialReadings,
    SurfaceReading,
    pack_frame,
    unpack_frame,
)
from app.scenes.radial_sea.live_values import live_values
from app.scenes.radial_sea.measures import measures
from app.scenes.radial_sea.parameters import (
    ABOUT,
    PRESETS,
    Params,
    column_of,
    conditions_of,
    densities_of,
    exposure_of,
    hidden,
    own_densities_of,
    spectrum_of,
    spill_of,
)
from app.scenes.radial_sea.radiated_waves import LENGTH as RADIATED_WAVES_LENGTH
from app.scenes.radial_sea.radiated_waves import RadiatedWaves
from app.scenes.radial_sea.well_blowout import CROSSING_WAVE, WellBlowout, slick_reach
from sim.floating import Body, Hull, MotionCoefficients, Shape, make_fleet, shape_from_file, step, still_water
from sim.interruption import kept_whole
from sim.ocean import Sea
from sim.ocean.fluid_column import FluidColumn
from sim.ocean.foam import whitecaps
from sim.ocean.gerstner import Waves, draw_waves
from sim.ocean.radial import CLEAN, RadialSea, RadialSurface, lost
from sim.ocean.radial_grid import RadialGrid
from sim.ocean.slick import SlickCover
from sim.ocean.spectra import SPECTRA, Conditions
from sim.ocean.statistics import energy_by_wavenumber, expected
from sim.ocean.tile_sea import TileSea
from sim.ocean.weathering import Weathering, weather
from sim.parameters import Value, check_record
from sim.particles.fire import Fire
from sim.particles.jet import Jet

if TYPE_CHECKING:
    from app.lab.live_code import LiveCode
    from app.scenes.radial_sea.student_sea import StudentRadialSea

PLOTTED_BODIES = 3  # bodies with a plotted draft
BODY_SERIES = tuple(kind_of(i).title.lower() for i in range(PLOTTED_BODIES))
HEIGHT_SERIES = ("surface", f"height of the {BODY_SERIES[0]}")
SERIES = (*BODY_SERIES, *HEIGHT_SERIES)
PLOTS = {
    "plot_draft": PlotAxes("Draft", "m", BODY_SERIES),
    "plot_surface": PlotAxes(f"Surface and {BODY_SERIES[0]}", "m", HEIGHT_SERIES),
}
CURVES = {"plot_budget": CurveAxes("Oil budget", "%", "t [h]", tuple(line.label for line in BUDGET_LINES))}
CHANGING = (  # as time passes
    "time", "age", "column", "wave_choice", "sum", "bodies", "radiated_waves", "well_blowout", "foam_threshold",
)  # fmt: skip
FRAME_INTERVAL = 1 / 30  # [s] between frames
GRID_RADIUS = 5000.0  # [m] of the last ring
FIRST_RING = 0.35  # [m] radius of the first ring
TILE_SIZE, TILE_LENGTH = 128, 256.0  # points a side (as many vertices as the rings have) and side [m] of the square sea
PLOT_INTERVAL = 1 / 15  # [s] of simulated time between plot rows
AGEING_INTERVAL = 1.0  # [s] of simulated time between two decays of the waves
NEGLIGIBLE_ENERGY = 1e-4  # of the largest of all parts of the spectrum: a part with less is left out
COMPARE_INTERVAL = 2.0  # [s] of wall time between two timings of the other surface
COST_MEMORY = 0.9  # share of the old value in the running mean of a surface's cost
SLICK_EDGE = 3.0  # [m] over which the slick of the jet grows to its thickness: a step would kick the bodies
CALMING_STEP = 1.05  # ratio of two thicknesses of the slick for which the decay of waves is found
FOAM_RADIUS = 80.0  # [m] within which the foam threshold is measured
FOAM_GAIN = 0.05  # share of the new value in the running mean of the foam threshold
FOAM_WIDTH = 0.07  # change of the Jacobian over which foam goes from none to full
MAX_FOAM_JACOBIAN = 0.97  # threshold above which nothing is foam: the surface is not pressed together anywhere
MOTION, WAVES, BODIES, FIRE, TILE = "motion of bodies", "waves", "bodies", "fire", "square sea"
# Piece to compile -> the parameters that call all of it.
WARM_UP: dict[str, dict[str, Value]] = {
    WAVES: {"bodies": 0},
    BODIES: {},
    FIRE: {"fire": True, "jet": True, "spill": "layer"},
    TILE: {"surface": "fft"},
}


def warm_up() -> Pieces:
    """Everything to compile that the scene may call."""
    scenes = {name: functools.partial(compile_with, changes) for name, changes in WARM_UP.items()}
    return {MOTION: compile_motion, **scenes}


def needs(params: Params) -> tuple[str, ...]:
    """Compiled pieces that a scene with these parameters runs."""
    fire = (FIRE,) if params.fire or params.jet else ()
    tile = (TILE,) if params.surface == "fft" or params.compare else ()
    return MOTION, WAVES, BODIES, *fire, *tile


def compile_motion() -> None:
    """The step of a body: half of the kernels of bodies. Another process compiles the rest meanwhile."""
    fleet = make_fleet([Body(Hull.box(1.0, 1.0, 1.0), density=500.0)])
    step(fleet, still_water(fleet, [(850.0, 0.2), (1025.0, math.inf)]), 1 / 60)


def compile_with(changes: dict[str, Value]) -> None:
    """Call the kernels of a scene with these parameters changed from their defaults."""
    scene = RadialSeaScene(check_record(Params, changes))
    if scene.params.bodies:
        scene.handle(Grab(0, (0.0, 0.0, 0.0)))
    for _ in range(8):
        scene.advance(1)
    if scene.params.jet:
        scene.sum.slick = SlickCover((0.0, 0.0), 1.0, scene.column)
    scene.frame()
    scene.readings()


class WaveChoice(NamedTuple):
    """Choices that determine the random waves; equal choices have equal waves."""

    spectrum: str
    conditions: Conditions
    wave_count: int


def wave_choice_of(params: Params) -> WaveChoice:
    """Waves of these parameters."""
    return WaveChoice(spectrum_of(params).name, conditions_of(params), params.wave_count)


def draw(choice: WaveChoice) -> Waves:
    """The waves of a choice."""
    return draw_waves(SPECTRA[choice.spectrum], choice.conditions, choice.wave_count)


class RadialSeaScene:
    """The radial sea; used on the simulation thread."""

    frame_interval = FRAME_INTERVAL

    def __init__(self, params: Params, live: "LiveCode | None" = None) -> None:
        """live: runs a student's functions, where there are any.

        Raises ValueError where the parameters name a hull file that is not a closed mesh.
        """
        self.params = params
        self.student: StudentRadialSea | None = None
        if live is not None:
            from app.scenes.radial_sea import student_sea  # only `springtide lab DIR` pays for it

            self.student = student_sea.StudentRadialSea(live.tables)
        self.hull_file, self.file_shape = "", None
        self.grid_choice: tuple[int, int, str] | None = None
        self.known_clean: tuple[Waves, tuple[float, float, float]] | None = None  # what `clean_waves` found, of which
        self.plot_rows = PlotRows(len(SERIES), PLOT_INTERVAL)
        self.reset()

    @property
    def step(self) -> float:
        """Time step [s]."""
        return self.params.time_step

    @property
    def faster(self) -> str:
        """Advice on a faster step: its time goes into bodies, particles and waves."""
        return "fewer bodies, fewer waves or a larger step"

    @property
    def note(self) -> str:
        """Nothing else runs than the parameters ask for."""
        return ""

    def reset(self) -> None:
        """The bodies at rest in their places, and only the oil of the parameters."""
        p = self.params
        self.time = 0.0
        self.column, self.age = self.fluids(p), exposure_of(p)
        self.wave_choice = wave_choice_of(p)
        self.sum = RadialSea(draw(self.wave_choice), self.column, self.age, p.choppiness)
        self.tile: TileSea | None = None
        self.costs: dict[str, float] = {}  # surface -> [s] a frame, a running mean
        self.bodies = self.make_bodies()
        if self.student is not None:
            self.student.want(p, self.bodies)
            self.set_down_box(self.student)
        self.radiated_waves = RadiatedWaves()
        self.well_blowout = WellBlowout(p)
        self.camera = (0.0, 0.0)  # [m] where the browser's camera is
        self.spectrum_energy: tuple[WaveChoice, NDArray[np.float64], NDArray[np.float64]] | None = None
        self.decayed_height: tuple[tuple[object, ...], float] | None = None  # Hs [m] of the spectrum
        self.foam_threshold = 0.0  # Jacobian below which there is foam, a running mean
        self.compared_at = -math.inf
        self.set_grid()
        self.drawn: tuple[object, ...] = ()
        self.plot_rows.restart()

    def keep(self) -> dict[str, object]:
        """Waves, bodies, their waves, fire and oil, as they are now."""
        bodies = self.bodies
        return copied(
            {name: getattr(self, name) for name in CHANGING},
            self.column,
            bodies.column,
            bodies.hulls,
            bodies.body_kinds,
        )

    def resume(self, kept: object) -> None:
        """Go on from a checkpoint of `keep`."""
        restore(self, kept)
        for client in set(self.bodies.holders.values()):
            self.bodies.release(client)
        self.tile, self.drawn = None, ()
        self.plot_rows.resume()
        self.forget_costs()
        if self.student is not None:
            self.student.taken = {}  # the sea is that of another moment
            self.take_student(self.student)

    def make_bodies(self) -> FloatingBodies:
        """The bodies that the parameters ask for, at rest in their places."""
        p = self.params
        return FloatingBodies(p.bodies, p.size, p.density, self.column, self.shape_of_file(), own_densities_of(p))

    def shape_of_file(self) -> Shape | None:
        """The shape in the hull file that the parameters name, which is read once."""
        if self.params.hull != self.hull_file:
            self.file_shape = shape_from_file(self.params.hull) if self.params.hull else None
            self.hull_file = self.params.hull
        return self.file_shape

    def set_grid(self) -> None:
        """Make the radial grid that the parameters ask for, unless it is there."""
        p = self.params
        choice = (p.rings, p.spokes, p.ring_law)
        if choice != self.grid_choice:
            self.grid = RadialGrid(p.rings, p.spokes, FIRST_RING, GRID_RADIUS, p.ring_law)
            self.grid_choice = choice
            self.forget_costs()

    def make_tile(self) -> TileSea:
        """The square sea under the same wind, on the same fluids."""
        p, column = self.params, self.column
        conditions = conditions_of(p)
        sea = Sea(
            TILE_SIZE,
            TILE_LENGTH,
            spectrum_of(p).name,
            choppiness=p.choppiness,
            frequency=lambda k: column.roots(k)[0],
            **{field.name: getattr(conditions, field.name) for field in dataclasses.fields(conditions)},
        )
        return TileSea(sea, self.sum.past)

    def tile_now(self) -> TileSea:
        """The square sea, made where it is not there."""
        if self.tile is None:
            self.tile = self.make_tile()
        return self.tile

    @property
    def sea(self) -> RadialSea | TileSea:
        """The surface in force."""
        return self.sum if self.params.surface == "sum" else self.tile_now()

    def change_forces(self, params: Params) -> None:
        """Take parameters while the sea runs: only the affected parts are replaced."""
        old, self.params = self.params, params
        column, choice = self.fluids(params), wave_choice_of(params)
        other_fluids = column != self.column or exposure_of(params) != exposure_of(old)
        other_waves = choice != self.wave_choice
        self.column, self.wave_choice = column, choice
        # What oil took stays taken; only another age at the start, set by hand, begins anew.
        set_anew = params.spill != "none" and params.exposure != old.exposure
        if other_waves or other_fluids:
            waves = draw(choice) if other_waves else None
            self.sum.change(self.time, waves, column, params.exposure if set_anew else None)
        if set_anew:
            self.age = params.exposure
        elif old.spill == "none" and params.spill != "none":
            self.sum.expose(params.exposure)
            self.age += params.exposure
        if other_waves or other_fluids or params.choppiness != self.sum.choppiness:
            self.tile = None
        self.sum.choppiness = params.choppiness
        if (params.bodies, params.size) != (self.bodies.count_asked, self.bodies.size):
            self.bodies = self.make_bodies()
        elif other_fluids or densities_of(params) != densities_of(old):
            self.bodies.set_fluids(params.density, column, own_densities_of(params))
        if self.student is not None:
            self.student.want(params, self.bodies)
        if old.ripples and not params.ripples:
            self.radiated_waves = RadiatedWaves()
        self.well_blowout.change(params)
        self.forget_costs()

    def fluids(self, params: Params) -> FluidColumn:
        """The fluids that the parameters describe, by a student's functions where the sea runs by them."""
        return column_of(params) if self.student is None else self.student.column(params)

    def take_student(self, student: "StudentRadialSea") -> None:
        """Take the results of a student's functions."""
        changed = student.collect()
        if not changed:
            return
        column = self.fluids(self.params)
        if changed & {"mixture_viscosity", "wave_decay"}:
            self.column, self.tile = column, None
            self.sum.change(self.time, None, column, self.age)  # by the law of the student, as if from the start
            self.bodies.set_fluids(self.params.density, column, own_densities_of(self.params))
        if "draft" in changed:
            self.set_down_box(student)
        self.drawn = ()
        student.report(self.params, self.bodies)

    def set_down_box(self, student: "StudentRadialSea") -> None:
        """Put the box as deep into the water as the student's draft says."""
        box, draft = box_of(self.bodies), student.numbers.draft
        if box is not None and draft is not None:
            self.bodies.set_down(box, draft)

    def forget_costs(self) -> None:
        """Forget the cost of the surfaces: it may have changed."""
        self.costs, self.compared_at = {}, -math.inf

    def handle(self, command: SceneCommand) -> None:
        """Drag bodies, and take the place of the camera."""
        match command:
            case StudentAnswer() if self.student is not None:
                self.take_student(self.student)
            case Grab(index, target, client):
                self.bodies.hold(index, target, self.params.pull, client)
            case Release(client):
                self.bodies.release(client)
            case Place("camera", (x, y, _)):
                self.camera = (x, y)

    @kept_whole()
    def advance(self, steps: int) -> None:
        """Take steps. Raises DivergenceError where a body's state is no longer finite."""
        bodies, sea, h = self.bodies, self.sea, self.step
        coefficients = MotionCoefficients(gravity=self.column.gravity)
        self.calm_waves()
        for _ in range(steps):
            if bodies.count:
                middle = self.time + h / 2
                at = sea.at(bodies.fleet.position[:, :2], middle, bodies.widths)
                slick = self.slick_at(bodies.fleet.position[:, :2])
                bodies.measure(self.time, at, h, h / 2)
                if self.params.mooring:
                    bodies.moor()
                else:
                    bodies.unmoor()
                waves = sea.current(middle) if isinstance(sea, RadialSea) else None
                try:
                    bodies.step(at, h, slick, coefficients, waves)
                except FloatingPointError as error:
                    raise DivergenceError(f"At t = {self.time:.2f} s {error}. Reset, or take a smaller step.") from None
                if self.plot_rows.is_due(self.time):
                    self.add_plot_row(float(at.height[0]))
            self.time += h
        if self.params.ageing and self.column.kind != "water":
            self.age_waves(steps * h)
        if self.params.ripples and bodies.count:
            density = self.column.layers[-1][0]  # of the deep fluid, which the waves move
            self.radiated_waves.press(self.time, bodies.fleet.position[:, :2], bodies.widths, bodies.impulse, density)
        bodies.impulse[:] = 0.0
        self.well_blowout.step(sea, self.time, steps * h)

    def calm_waves(self) -> None:
        """Let the slick of the jet calm the waves of the sum under it."""
        slick = self.well_blowout.slick(self.column)
        self.sum.slick = None
        if slick is not None and self.column.kind != "mixed":
            # Rounded, as the decay of all waves is found again with each thickness.
            steps = round(math.log(slick.thickness) / math.log(CALMING_STEP))
            thickness = self.column.thickness + CALMING_STEP**steps
            column = dataclasses.replace(self.column, thickness=thickness)
            self.sum.slick = SlickCover(slick.centre, slick.radius, column)

    def wave_left(self) -> float:
        """Share of its height that a wave of `CROSSING_WAVE` keeps across the slick; NaN where none calms this sea."""
        slick = self.sum.slick
        if slick is None or self.params.surface != "sum":
            return math.nan
        return math.exp(-2.0 * slick.radius * crossing_loss(slick.column, self.column))

    def age_waves(self, duration: float) -> None:
        """Let the waves decay under the oil for `duration` [s] more."""
        self.age += duration
        due = self.age - sum(self.sum.past.values())
        if due >= AGEING_INTERVAL:
            self.sum.expose(due)
            if self.tile is not None:
                self.tile.expose(due, self.column)

    def slick_at(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Thickness (n,) [m] of the slick at points (n, 2) [m]. It grows from its edge over `SLICK_EDGE`."""
        slick = self.well_blowout.slick(self.column)
        if slick is None or self.column.kind == "mixed":
            return np.zeros(len(points))
        reach = slick_reach(slick, points[:, 0], points[:, 1])
        return slick.thickness * np.clip(reach / SLICK_EDGE, 0.0, 1.0)

    def layer_at(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Thickness (n,) [m] of oil under the surface at points (n, 2) [m]."""
        return self.column.thickness + self.slick_at(points)

    def add_plot_row(self, surface: float) -> None:
        """Add a plot row; `surface` [m] is the height of the sea at the first body."""
        bodies = self.bodies
        draft = np.full(PLOTTED_BODIES, math.nan)  # of a body that is not there
        draft[: min(PLOTTED_BODIES, bodies.count)] = bodies.draft[:PLOTTED_BODIES]
        self.plot_rows.add(self.time, *draft.tolist(), surface, float(bodies.fleet.position[0, 2]))

    def take_plot_rows(self) -> tuple[PlotRow, ...]:
        """The plot rows since the last call."""
        return self.plot_rows.take()

    def frame(self) -> RadialFrame:
        """Frame to draw."""
        p, bodies = self.params, self.bodies
        key = (self.time, p, self.camera)
        if key != self.drawn:
            self.update_surface()
            self.drawn = key
        held = [(bodies.fleet.position[i].tolist(), target) for i, target in bodies.targets.items()]
        fire, jet = self.well_blowout.fire, self.well_blowout.jet
        return RadialFrame(
            params=p,
            time=self.time,
            grid=self.grid,
            surface=self.surface,
            foam=self.foam,
            slick=self.well_blowout.slick(self.column) if self.column.kind == "water" else None,
            cutaway=self.cutaway,
            kinds=bodies.kinds,
            hulls=bodies.hulls,
            positions=bodies.fleet.position.astype(np.float32),
            rotations=bodies.fleet.rotation.astype(np.float32),
            stains=bodies.stain.astype(np.float32),
            pulls=tuple(((x, y, z), target) for (x, y, z), target in held),
            fire=None if fire is None else parcels_of(fire),
            jet=None if jet is None else flying_parcels(jet),
            column=self.column if self.student is None else self.student.drawn(self.column),
            age=self.age,
            sent=self.sent,
        )

    def update_surface(self) -> None:
        """Compute the surface, its foam and the cutaway as they are now."""
        p = self.params
        self.set_grid()
        centre = self.camera if p.centre == "camera" else (0.0, 0.0)
        sea = self.sea
        self.surface = self.timed_surface(p.surface, sea, centre)
        if p.compare:
            self.compare(centre)
        vertices, slopes = self.surface.vertices, self.surface.slope
        if p.ripples:
            # Radiated waves exist near the origin only: the inner rings, and the centre, which is the last vertex.
            near = int((self.grid.radii < RADIATED_WAVES_LENGTH).sum()) * self.grid.spokes
            for part in (slice(0, len(self.grid) - 1 if p.centre == "camera" else near), slice(-1, None)):
                self.radiated_waves.lay(self.time, vertices[part], slopes[part], len(vertices))
        self.foam = self.make_foam()
        self.sent = SentSurface()
        self.cutaway = self.make_cutaway() if p.cutaway else None

    def make_foam(self) -> NDArray[np.float32]:
        """Foam (n,), 0 to 1, where the surface is pressed together most: as much of the sea as Monahan measured.

        Oil reduces it in proportion to the mean square slope that it leaves.
        """
        p, jacobian = self.params, self.surface.jacobian
        clean = self.clean_waves()[1]
        remaining = self.sum.mean_square_slope / clean if clean > 0.0 else 0.0
        share = whitecaps(p.wind_speed) * remaining if p.waves else 0.0
        near = jacobian[: int((self.grid.radii < FOAM_RADIUS).sum()) * self.grid.spokes]
        now = quantile(near, share) if len(near) else 0.0
        self.foam_threshold += FOAM_GAIN * (now - self.foam_threshold) if self.foam_threshold else now
        if self.foam_threshold > MAX_FOAM_JACOBIAN:
            return np.zeros_like(jacobian)
        return np.clip((self.foam_threshold - jacobian) / np.float32(FOAM_WIDTH) + 0.5, 0.0, 1.0).astype(np.float32)

    def clean_waves(self) -> tuple[float, float, float]:
        """(middle period [s], mean square slope, significant height [m]) of the waves on clean water."""
        waves = self.sum.waves
        if self.known_clean is None or self.known_clean[0] is not waves:
            numbers = middle_period(self.sum), mean_square_slope(waves), waves.significant_height
            self.known_clean = waves, numbers
        return self.known_clean[1]

    def timed_surface(self, name: str, sea: RadialSea | TileSea, centre: tuple[float, float]) -> RadialSurface:
        """Surface of a sea on the grid about a centre [m]; its cost is recorded under `name`."""
        start = time.perf_counter()
        surface = sea.on(self.grid, self.time, centre)
        taken = time.perf_counter() - start
        self.costs[name] = COST_MEMORY * self.costs.get(name, taken) + (1.0 - COST_MEMORY) * taken
        return surface

    def compare(self, centre: tuple[float, float]) -> None:
        """Time the surface that is not drawn, every few seconds."""
        wall = time.monotonic()
        if wall - self.compared_at < COMPARE_INTERVAL:
            return
        self.compared_at = wall
        if self.params.surface == "sum":
            self.timed_surface("fft", self.tile_now(), centre)
        else:
            self.timed_surface("sum", self.sum, centre)

    def make_cutaway(self) -> Cutaway:
        """The sea at the walls of a cutaway beside the first body, as drawn there."""
        bodies, size = self.bodies, self.params.size
        x, y = bodies.fleet.position[0, :2].tolist() if bodies.count else (0.0, 0.0)
        points = outline((x, y), size)
        at = self.sea.at(points, self.time)
        walls = np.column_stack([points, at.height]).astype(np.float32)
        if self.params.ripples:
            self.radiated_waves.lay(self.time, walls, np.zeros((len(walls), 2), np.float32), len(walls))
        top = walls[:, 2].astype(np.float64)
        layer = self.layer_at(points)
        has_oil = self.column.kind != "mixed" and bool(layer.max() > 0.0)
        interface = at.interface - layer + (top - at.height) if has_oil else top
        return cutaway_at((x, y), size, points, top, interface, has_oil)

    def readings(self) -> RadialReadings:
        """Numbers for the panel."""
        s = self.sum
        period, clean_slope, clean_height = self.clean_waves()
        return RadialReadings(
            bodies=self.bodies.readings(self.time),
            column=self.column,
            height=s.significant_height,
            clean_height=clean_height,
            slope=s.mean_square_slope,
            clean_slope=clean_slope,
            middle_period=period,
            oil_budget=self.well_blowout.oil_budget(self.column)._replace(wave_left=self.wave_left()),
            surfaces=self.compared_surfaces() if self.params.compare else {},
            age=self.age,
            past=self.sum.past,
            weathering=self.weathering,
        )

    def compared_surfaces(self) -> dict[str, SurfaceReading]:
        """The radial sum and the square sea side by side, as far as they were timed, each as expected of its waves."""
        found, s, grid, tile = {}, self.sum, self.grid, self.tile
        whole = self.spectrum_height() if self.costs else 0.0

        def error(height: float) -> float:
            return height / whole - 1.0 if whole > 0.0 else 0.0

        if "sum" in self.costs:
            found["sum"] = SurfaceReading(
                cost=self.costs["sum"],
                waves=len(s.waves.kx),
                shortest=2 * float(grid.spacing[0]),
                extent=2 * float(grid.radii[-1]),
                height=s.significant_height,
                slope=s.mean_square_slope,
                error=error(s.significant_height),
            )
        if "fft" in self.costs and tile is not None:
            height = expected(tile.sea).significant_height
            found["fft"] = SurfaceReading(
                cost=self.costs["fft"],
                waves=TILE_SIZE * TILE_SIZE // 2,
                shortest=2 * TILE_LENGTH / TILE_SIZE,
                extent=TILE_LENGTH,
                height=height,
                slope=tile.mean_square_slope,
                error=error(height),
            )
        return found

    def spectrum_height(self) -> float:
        """Hs [m] of the whole spectrum after the decay of the sum of waves: an integral over all wavenumbers."""
        key = self.wave_choice, tuple(self.sum.past.items())
        if self.decayed_height is None or self.decayed_height[0] != key:
            if self.spectrum_energy is None or self.spectrum_energy[0] != self.wave_choice:
                choice = self.wave_choice
                self.spectrum_energy = choice, *energy_by_wavenumber(SPECTRA[choice.spectrum], choice.conditions)
            _, k, energy = self.spectrum_energy
            some = energy > NEGLIGIBLE_ENERGY * energy.max()
            kept = np.exp(-2.0 * lost(self.sum.past, k[some]))
            self.decayed_height = key, 4.0 * math.sqrt(float((energy[some] * kept).sum()))
        return self.decayed_height[1]

    @property
    def weathering(self) -> Weathering | None:
        """The spill over five days; None where there is none to follow."""
        spill = spill_of(self.params)
        return None if spill is None else weather(spill)

    def curves(self) -> dict[str, Chart] | None:
        """The chart of the oil budget, where it is open; the same one until spill or time change."""
        spill = spill_of(self.params) if self.params.plot_budget else None
        return None if spill is None else {"plot_budget": budget_chart(spill, self.params.spill_hours)}

    def arrays(self) -> dict[str, tuple[NDArray[np.float64], str]]:
        """The state for a file: name -> (array, unit)."""
        fleet = self.bodies.fleet
        return {
            "position": (fleet.position.copy(), "m"),
            "rotation": (fleet.rotation.copy(), "quaternion (w, x, y, z)"),
            "velocity": (fleet.velocity.copy(), "m/s"),
            "draft": (self.bodies.draft.copy(), "m"),
        }


@functools.lru_cache(maxsize=4)
def crossing_loss(inside: FluidColumn, outside: FluidColumn) -> float:
    """Loss [1/m] of a wave of `CROSSING_WAVE` under a slick; kept, as over thin oil it takes 30 ms to find."""
    k = np.array([2.0 * math.pi / CROSSING_WAVE])
    return float(SlickCover((0.0, 0.0), 0.0, inside).attenuation(k, outside)[0])


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


def parcels_of(fire: Fire) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """(3, n) positions [m], and (4, n) heat 1 to 0, age over life, spread [m], age over the longest life."""
    over = fire.age / np.maximum(fire.life, np.float32(1e-3))
    return fire.position.copy(), np.stack(
        [fire.heat, over, fire.spread, fire.age / fire.longest_life], dtype=np.float32
    )


def flying_parcels(jet: Jet) -> JetParcels:
    """The parcels of a jet that are in the air."""
    number = np.flatnonzero(jet.flying)
    position, velocity = (a[:, number].T.astype(np.float32) for a in (jet.position, jet.velocity))
    return JetParcels(position, velocity, number)


SCENE = SceneKind(
    name="radial_sea",
    title="Radial sea",
    help="<b>Drag a buoy</b> under the water and let go.",
    params=Params,
    presets=PRESETS,
    about=ABOUT,
    make=RadialSeaScene,
    make_with_student=RadialSeaScene,
    hidden=hidden,
    warm_up=warm_up,
    series=SERIES,
    plots=PLOTS,
    curves=CURVES,
    measures=measures,
    frame_units={
        "positions": "m",
        "rotations": "quaternion (w, x, y, z)",
        "surface_vertices": "m",
        "surface_slope": "",
        "foam": "0 to 1",
    },
    packing=FramePacking(pack_frame, unpack_frame),
    live_values=live_values,
    needs=needs,
)
