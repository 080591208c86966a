"""The radial sea: buoys and a box on water, on oil, or on both mixed, near a rig that may burn."""

import functools
import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from app.messages import GrabTo, Place, PlotRow, Release, SceneCommand, StudentAnswer
from app.scenes.charts import Chart, CurveAxes, PlotAxes
from app.scenes.checkpoints import copied, restore
from app.scenes.contract import Pieces
from app.scenes.plot_rows import PlotRows
from app.scenes.radial_sea.bodies import FloatingBodies, box_of, kind_of
from app.scenes.radial_sea.drawn_surface import DrawnSurface, Foam, tile_of
from app.scenes.radial_sea.frame import JetParcels, RadialFrame, RadialReadings
from app.scenes.radial_sea.oil.charts import BUDGET_LINES, budget_chart
from app.scenes.radial_sea.oil.well_blowout import WellBlowout, slick_reach, wave_left
from app.scenes.radial_sea.parameters import (
    RadialSeaParams,
    column_of,
    densities_of,
    exposure_of,
    own_densities_of,
    reading_of,
    spill_of,
)
from app.scenes.radial_sea.radiated_waves import RadiatedWaves
from app.scenes.radial_sea.wave_choice import draw, wave_choice_of
from sim.floating import Body, Hull, MotionCoefficients, Shape, make_fleet, shape_from_file, step, still_water
from sim.interruption import kept_whole
from sim.ocean.any_sea import AnySea
from sim.ocean.fluids.fluid_column import FluidColumn
from sim.ocean.fluids.slick import SlickCover
from sim.ocean.radial.radial import RadialSea
from sim.ocean.radial.radial_grid import RadialGrid
from sim.ocean.tile.sea import Sea
from sim.ocean.weathering import Weathering, weather
from sim.parameters import Value, check_record
from sim.particles.fire import Fire
from sim.particles.jet import Jet
from sim.validation import DivergenceError

if TYPE_CHECKING:
    from app.lab.student.live_code import LiveCode
    from app.scenes.radial_sea.student_sea import StudentRadialSea

PLOTTED_BODIES = 3  # bodies with a plotted draft
BODY_SERIES = tuple(kind_of(i).title.lower() for i in range(PLOTTED_BODIES))
HEIGHT_SERIES = ("surface", f"height of the {BODY_SERIES[0]}")
SERIES = (*BODY_SERIES, *HEIGHT_SERIES)
PLOTS = {
    "plot_draft": PlotAxes("Draft", "m", BODY_SERIES, least=0.02),
    "plot_surface": PlotAxes(f"Surface and {BODY_SERIES[0]}", "m", HEIGHT_SERIES, least=0.02),
}
CURVES = {"plot_budget": CurveAxes("Oil budget", "%", "t [h]", tuple(line.label for line in BUDGET_LINES))}
CHANGING = (  # as time passes
    "time", "age", "column", "wave_choice", "sum", "bodies", "radiated_waves", "well_blowout", "foam",
)  # fmt: skip
FRAME_INTERVAL = 1 / 30  # [s] between frames
GRID_RADIUS = 5000.0  # [m] of the last ring
FIRST_RING = 0.35  # [m] radius of the first ring
PLOT_INTERVAL = 1 / 15  # [s] of simulated time between plot rows
AGEING_INTERVAL = 1.0  # [s] of simulated time between two decays of the waves
SLICK_EDGE = 3.0  # [m] over which the slick of the jet grows to its thickness: a step would kick the bodies
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


def needs(params: RadialSeaParams) -> tuple[str, ...]:
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
    scene = RadialSeaScene(check_record(RadialSeaParams, changes))
    if scene.params.bodies:
        scene.handle(GrabTo(0, (0.0, 0.0, 0.0)))
    for _ in range(8):
        scene.advance(1)
    if scene.params.jet:
        scene.sum.slick = SlickCover((0.0, 0.0), 1.0, scene.column)
    scene.frame()
    scene.readings()


class RadialSeaScene:
    """The radial sea; used on the simulation thread."""

    frame_interval = FRAME_INTERVAL
    pace = 1.0
    faster = "fewer bodies, fewer waves or a larger step"  # these take the time
    note = ""  # it never departs from the parameters

    def __init__(self, params: RadialSeaParams, live: "LiveCode | None" = None) -> None:
        """live: runs a student's functions, if any.

        Raises ValueError if the parameters name a hull file that is not a closed mesh.
        """
        self.params = params
        self.student: StudentRadialSea | None = None
        if live is not None:
            from app.scenes.radial_sea import student_sea  # only `springtide lab DIR` pays for it

            self.student = student_sea.StudentRadialSea(live.tables)
        self.hull_file, self.file_shape = ("", reading_of(params)), None
        self.grid_choice: tuple[int, int, str] | None = None
        self.plot_rows = PlotRows(PLOT_INTERVAL)
        self.reset()

    @property
    def step(self) -> float:
        """Time step [s]."""
        return self.params.time_step

    def reset(self) -> None:
        """Restart with the bodies at rest in their places, and only the oil of the parameters."""
        p = self.params
        self.time = 0.0
        self.column, self.age = self.fluids(p), exposure_of(p)
        self.wave_choice = wave_choice_of(p)
        self.sum = RadialSea(draw(self.wave_choice), self.column, self.age, p.choppiness)
        self.tile: Sea | None = None
        self.bodies = self.make_bodies()
        if self.student is not None:
            self.student.want(p, self.bodies)
            self.set_down_box(self.student)
        self.radiated_waves = RadiatedWaves()
        self.well_blowout = WellBlowout(p)
        self.camera = (0.0, 0.0)  # [m] place of the browser's camera
        self.foam, self.drawing = Foam(), DrawnSurface()
        self.set_grid()
        self.plot_rows.restart()

    def keep(self) -> dict[str, object]:
        """Checkpoint of waves, bodies, their waves, fire and oil."""
        bodies = self.bodies
        return copied(
            {name: getattr(self, name) for name in CHANGING},
            self.column,
            bodies.column,
            bodies.hulls,
            bodies.body_kinds,
        )

    def resume(self, checkpoint: object) -> None:
        """Resume from a checkpoint of `keep`."""
        restore(self, checkpoint)
        self.bodies.release_all()
        self.tile, self.drawing.drawn = None, ()
        self.plot_rows.resume()
        self.drawing.forget_costs()
        if self.student is not None:
            self.student.taken = {}  # the sea is that of another moment
            self.take_student(self.student)

    def make_bodies(self) -> FloatingBodies:
        """Make the bodies of the parameters, at rest in their places."""
        p = self.params
        return FloatingBodies(p.bodies, p.size, p.density, self.column, self.shape_of_file(), own_densities_of(p))

    def shape_of_file(self) -> Shape | None:
        """The shape in the parameters' hull file, which is read once."""
        file = self.params.hull, reading_of(self.params)
        if file != self.hull_file:
            self.file_shape = shape_from_file(file[0], reading=file[1]) if file[0] else None
            self.hull_file = file
        return self.file_shape

    def set_grid(self) -> None:
        """Make the radial grid of the parameters, unless it exists."""
        p = self.params
        choice = (p.rings, p.spokes, p.ring_law)
        if choice != self.grid_choice:
            self.grid = RadialGrid(p.rings, p.spokes, FIRST_RING, GRID_RADIUS, p.ring_law)
            self.grid_choice = choice
            self.drawing.forget_costs()

    def tile_now(self) -> Sea:
        """The square sea, made on first use."""
        if self.tile is None:
            self.tile = tile_of(self)
        return self.tile

    @property
    def sea(self) -> AnySea:
        """The surface in force."""
        return self.sum if self.params.surface == "sum" else self.tile_now()

    def change_forces(self, params: RadialSeaParams) -> None:
        """Take parameters while the sea runs: only the affected parts are replaced."""
        old, self.params = self.params, params
        column, choice = self.fluids(params), wave_choice_of(params)
        other_fluids = column != self.column or exposure_of(params) != exposure_of(old)
        other_waves = choice != self.wave_choice
        self.column, self.wave_choice = column, choice
        # Energy lost to oil stays lost; only a new age at the start, set by hand, restarts.
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
        self.drawing.forget_costs()

    def fluids(self, params: RadialSeaParams) -> FluidColumn:
        """The fluids of the parameters, by a student's functions if the sea uses them."""
        return column_of(params) if self.student is None else self.student.column(params)

    def take_student(self, student: "StudentRadialSea") -> None:
        """Take the results of a student's functions."""
        changed = student.collect()
        if not changed:
            return
        column = self.fluids(self.params)
        if changed & {"mixture_viscosity", "wave_decay"}:
            self.column, self.tile = column, None
            self.sum.change(self.time, None, column, self.age)  # by the student's law, as if from the start
            self.bodies.set_fluids(self.params.density, column, own_densities_of(self.params))
        if "draft" in changed:
            self.set_down_box(student)
        self.drawing.drawn = ()
        student.report(self.params, self.bodies)

    def set_down_box(self, student: "StudentRadialSea") -> None:
        """Put the box into the water at the student's draft."""
        box, draft = box_of(self.bodies), student.numbers.draft
        if box is not None and draft is not None:
            self.bodies.set_down(box, draft)

    def handle(self, command: SceneCommand) -> None:
        """Drag bodies, and note the place of the camera."""
        match command:
            case StudentAnswer() if self.student is not None:
                self.take_student(self.student)
            case GrabTo(index, target, client):
                self.bodies.grab(index, target, self.params.pull, client)
            case Release(client):
                self.bodies.release(client)
            case Place("camera", (x, y, _)):
                self.camera = (x, y)

    @kept_whole()
    def advance(self, steps: int) -> None:
        """Take steps. Raises DivergenceError if a body's state is no longer finite."""
        bodies, sea, h = self.bodies, self.sea, self.step
        coefficients = MotionCoefficients(gravity=self.column.gravity)
        self.sum.slick = self.well_blowout.cover(self.column)
        for _ in range(steps):
            if bodies.count:
                middle = self.time + h / 2
                at = sea.at(bodies.fleet.position[:, :2], middle, bodies.widths)
                slick = self.slick_at(bodies.fleet.position[:, :2])
                bodies.measure(self.time, at, h, h / 2)
                bodies.moor(h, moored=self.params.mooring)
                try:
                    bodies.step(sea, at, middle, h, slick, coefficients)
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

    def age_waves(self, duration: float) -> None:
        """Let the waves decay under the oil for a further `duration` [s]."""
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

    def add_plot_row(self, surface: float) -> None:
        """Add a plot row; `surface` [m] is the height of the sea at the first body."""
        bodies = self.bodies
        draft = np.full(PLOTTED_BODIES, math.nan)  # of a missing body
        draft[: min(PLOTTED_BODIES, bodies.count)] = bodies.meters.draft[:PLOTTED_BODIES]
        self.plot_rows.add(self.time, *draft.tolist(), surface, float(bodies.fleet.position[0, 2]))

    def take_plot_rows(self) -> tuple[PlotRow, ...]:
        """The plot rows since the last call."""
        return self.plot_rows.take()

    def frame(self) -> RadialFrame:
        """Frame to draw."""
        p, bodies = self.params, self.bodies
        self.set_grid()
        drawing = self.drawing
        drawing.update(self)
        fire, jet = self.well_blowout.fire, self.well_blowout.jet
        return RadialFrame(
            params=p,
            time=self.time,
            grid=self.grid,
            grid_middle=drawing.middle,
            surface=drawing.surface,
            foam=drawing.foam,
            slick=self.well_blowout.slick(self.column) if self.column.kind == "water" else None,
            cutaway=drawing.cutaway,
            kinds=bodies.kinds,
            hulls=bodies.hulls,
            positions=bodies.fleet.position.astype(np.float32),
            rotations=bodies.fleet.rotation.astype(np.float32),
            stains=bodies.meters.stain.astype(np.float32),
            fairleads=bodies.moorings.fairleads(bodies.fleet, moored=p.mooring),
            anchors=bodies.moorings.lines.anchors,
            grabs=bodies.drawn_pulls(),
            fire=None if fire is None else parcels_of(fire),
            jet=None if jet is None else flying_parcels(jet),
            column=self.column if self.student is None else self.student.drawn(self.column),
            age=self.age,
            sent=drawing.sent,
        )

    def readings(self) -> RadialReadings:
        """Numbers for the panel."""
        s = self.sum
        period, clean_slope, clean_height = self.drawing.clean_waves(s)
        left = wave_left(s.slick, self.column) if self.params.surface == "sum" else math.nan
        return RadialReadings(
            bodies=self.bodies.readings(self.time),
            column=self.column,
            height=s.significant_height,
            clean_height=clean_height,
            slope=s.mean_square_slope,
            clean_slope=clean_slope,
            middle_period=period,
            oil_budget=self.well_blowout.oil_budget(self.column)._replace(wave_left=left),
            surfaces=self.drawing.compared(self) if self.params.compare else {},
            age=self.age,
            past=self.sum.past,
            weathering=self.weathering,
        )

    @property
    def weathering(self) -> Weathering | None:
        """The spill over five days; None without a spill."""
        spill = spill_of(self.params)
        return None if spill is None else weather(spill)

    def curves(self) -> dict[str, Chart] | None:
        """The chart of the oil budget, if it is open; the same object until spill or time change."""
        spill = spill_of(self.params) if self.params.plot_budget else None
        return None if spill is None else {"plot_budget": budget_chart(spill, self.params.spill_hours)}

    def arrays(self) -> dict[str, tuple[NDArray[np.float64], str]]:
        """The state for a file: name -> (array, unit)."""
        fleet = self.bodies.fleet
        return {
            "position": (fleet.position.copy(), "m"),
            "rotation": (fleet.rotation.copy(), "quaternion (w, x, y, z)"),
            "velocity": (fleet.velocity.copy(), "m/s"),
            "draft": (self.bodies.meters.draft.copy(), "m"),
        }


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
