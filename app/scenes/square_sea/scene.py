"""The square sea: wind waves on a tile that repeats to the horizon, on any planet, in calm, storm and rain."""

import collections
import dataclasses
import functools
import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from app.messages import PlotRow, PointAlong, SceneCommand, Snapshot, StudentAnswer
from app.scenes.charts import CurveAxes, PlotAxes
from app.scenes.checkpoints import copied, restore
from app.scenes.contract import Pieces
from app.scenes.packed_surface import SentSurface
from app.scenes.plot_rows import PlotRows
from app.scenes.square_sea.foam import MeshFoam, WaveSlope
from app.scenes.square_sea.frame import SeaFrame, SeaReadings
from app.scenes.square_sea.parameters import (
    DRAUPNER,
    SquareSeaParams,
    acting,
    conditions,
    gauge_home,
    is_draupner,
    marches,
    rain_settings,
    solved_points,
)
from app.scenes.square_sea.rainfall import SeaRain
from app.scenes.square_sea.statistics import INTERVAL, LiveStatistics
from app.scenes.square_sea.tile_mesh import Fields
from app.scenes.square_sea.weather_change import WeatherChange
from sim.ocean import Sea
from sim.ocean.records.wave_gauge import WaveGauge, where_hit
from sim.ocean.statistics.foam import whitecaps
from sim.parameters import effect_of_change

if TYPE_CHECKING:
    from app.lab.student.live_code import LiveCode
    from app.scenes.square_sea.nonlinear import Marching
    from app.scenes.square_sea.student_sea import StudentSea
    from sim.ocean.nonlinear import NonlinearSea

SERIES = ("wave gauge", "crest measured in 1995")
CHANGING = (  # as time passes
    "steps", "sea", "rainfall", "foam", "drawn_at", "waves", "change", "marching",
)  # fmt: skip
PLOTS = {"plot_wave_gauge": PlotAxes("Height at the wave gauge", "m", SERIES)}
CURVES = {"plot_wave_spectrum": CurveAxes("Spectrum at the wave gauge", "m²/Hz", "f [Hz]", ("measured", "theory"))}
HIGH_CREST = 1.25  # over Hs
AWAITED_HINT = "Of the significant height Hs, as high as a rogue wave. The lab pauses then"
NONLINEAR = "nonlinear waves"
STEP = 1 / 60  # [s] of the clock; nothing is integrated over it
START_WIND_SPEEDS = {"calm": 3.0, "storm": 24.0}  # [m/s] wind of the sea at a reset, by the parameter `start`
PLOT_ROW_INTERVAL = 0.1  # [s] of simulated time between two plot rows


def warm_up() -> Pieces:
    """Everything to compile that the scene may call, and its transforms to plan."""
    waves = {f"waves on {size} x {size}": functools.partial(Sea, size) for size in (64, 128, 256, 512)}
    return {**waves, "the drawn sea": compile_drawn_sea}


def compile_drawn_sea() -> None:
    """Call all kernels of a small sea with rain."""
    small = SquareSeaParams(size="64", mesh="32", length=64.0, rain=50.0, plot_wave_spectrum=True)
    call_kernels(small, dataclasses.replace(small, choppiness=0.0))


def compile_nonlinear_sea() -> None:
    """Call all kernels of both kinds of nonlinear sea."""
    small = SquareSeaParams(size="64", mesh="32", length=64.0, order=3, wind_speed=15.0)
    call_kernels(small, dataclasses.replace(small, start="breather", spectrum="regular"))


def call_kernels(*seas: SquareSeaParams) -> None:
    """Advance seas by some frames."""
    for params in seas:
        scene = SquareSeaScene(params)
        for _ in range(4):
            scene.advance(30)
            scene.frame()


def pieces_on_use() -> Pieces:
    """Pieces that only nonlinear waves need."""
    return {NONLINEAR: compile_nonlinear_sea}


def needs(params: SquareSeaParams) -> tuple[str, ...]:
    """The pieces that these parameters run."""
    return (*warm_up(), *((NONLINEAR,) if marches(params) else ()))


class SquareSeaScene:
    """The sea on the simulation thread.

    Linear waves are analytic in time: a step only moves the clock. Nonlinear waves are solved step by step; `sea` is
    then the linear sea of the same conditions, for theory.
    """

    faster = "a smaller grid"
    note = ""  # it never departs from the parameters

    def __init__(self, params: SquareSeaParams, live: "LiveCode | None" = None, step: float = STEP) -> None:
        """live: runs a student's functions, if any. step: of the clock [s]."""
        self.params, self.step = params, step
        self.student: StudentSea | None = None
        if live is not None:
            from app.scenes.square_sea import student_sea  # only `springtide lab DIR` pays for it

            self.student = student_sea.StudentSea(live.tables)
        self.counts: collections.Counter[str] = collections.Counter()
        self.plot_rows = PlotRows(PLOT_ROW_INTERVAL)
        self.gauge = WaveGauge()
        self.reset()

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.steps * self.step

    @property
    def frame_interval(self) -> float:
        """Time [s] between two frames."""
        return 1.0 / self.params.frame_rate

    def reset(self) -> None:
        """Restart the sea at time 0, with the wave gauge at its initial place."""
        self.steps, self.gauge_placed = 0, False  # placed: by a click
        self.gauge.put(gauge_home(self.params))
        self.begin_plots()
        self.make_sea()
        self.read_gauge()  # for the row of the start

    def keep(self) -> dict[str, object]:
        """Checkpoint of sea, foam and rain."""
        return copied({name: getattr(self, name) for name in CHANGING}, self.foam.values)

    def resume(self, checkpoint: object) -> None:
        """Resume from a checkpoint of `keep`; the wave gauge keeps its place and drops later values."""
        restore(self, checkpoint)
        while self.gauge.trace and self.gauge.trace[-1][0] > self.time:
            self.gauge.trace.pop()
        self.plot_rows.resume()
        self.spectrum_at, self.drawn, self.statistics = -math.inf, None, LiveStatistics()
        if self.student is not None:
            self.student.taken = {}  # the sea is that of another moment
            self.take_student(self.student)

    def begin_plots(self) -> None:
        """Clear the plots."""
        self.plot_rows.restart()
        self.spectrum_at = -math.inf
        self.curve_columns: dict[str, tuple[NDArray[np.floating], ...]] | None = None
        self.gauge.trace.clear()

    def make_sea(self) -> None:
        """Make the sea at time 0. If `start` is a calm or a storm, it begins so and changes to the set weather."""
        p = self.params
        start_wind = None if marches(p) else START_WIND_SPEEDS.get(p.start)
        self.sea = Sea(int(p.size), p.length, seed=p.seed, **conditions(p, start_wind))
        self.sea.choppiness = acting(p).choppiness * p.amplitude
        if self.student is not None:
            self.student.want(p)
        transition = 0.0 if start_wind is None else p.transition
        if start_wind is not None or self.student is not None:
            self.sea.change(self.time, transition, **self.conditions())
        foam_cover = whitecaps(p.wind_speed if start_wind is None else start_wind)
        self.change = WeatherChange(self.time, transition, foam_cover, 0.0)
        self.statistics = LiveStatistics()
        self.begin_marching()
        self.clear_mesh()
        self.make_rainfall()

    def begin_marching(self) -> None:
        """Begin a nonlinear sea at the present time, if the parameters need one."""
        self.marching: Marching | None = None
        if marches(self.params):
            from app.scenes.square_sea import nonlinear  # only nonlinear waves pay for it

            self.marching = nonlinear.Marching(self.params, self.sea, self.time, self.gauge.at)

    @property
    def pace(self) -> float:
        """Factor on the speed: below 1 while a high crest passes the wave gauge of a nonlinear sea."""
        p = self.params
        if self.marching is None or not (p.slow_motion and self.gauge_shown):
            return 1.0
        return self.marching.pace(self.gauge.trace, p)

    @property
    def water(self) -> "tuple[Sea | NonlinearSea, float]":
        """The drawn sea, and its time [s]: a nonlinear one may have stopped before the clock."""
        return (self.sea, self.time) if self.marching is None else (self.marching.sea, self.marching.sea.time)

    def make_rainfall(self) -> None:
        """Make the rain of the parameters."""
        p = self.params
        self.rainfall: SeaRain | None = None
        if p.rain > 0.0:
            highest = max(p.amplitude * self.sea.significant_height_at(self.time), 1.0)
            self.rainfall = SeaRain(self.sea, rain_settings(p), highest, p.seed)

    def clear_mesh(self) -> None:
        """Start a new drawn mesh, without foam."""
        n = min(int(self.params.mesh), solved_points(self.params))
        self.foam, self.waves = MeshFoam(n), WaveSlope()
        self.drawn: SeaFrame | None = None
        self.drawn_at = self.time
        self.statistics.measured_at, self.statistics.earlier_height = -math.inf, None

    def change_forces(self, params: SquareSeaParams) -> None:
        """Take new parameters: new weather grows out of the present sea, another grid shows the same sea."""
        old, foam_cover = self.params, self.change.foam_cover_at(self.time, self.params.wind_speed)
        self.params = params
        self.statistics.theory = None
        if params.size != old.size:
            self.sea = self.sea.resized(int(params.size))
            if self.marching is not None:
                self.marching.resize(params)
        if params.size != old.size or params.mesh != old.mesh:
            self.clear_mesh()
        if conditions(params) != conditions(old):
            if self.student is not None:
                self.student.want(params)
            self.change_sea(acting(params).transition, foam_cover, acting(old).viscosity)
        elif self.student is not None and params.size != old.size:
            self.student.want(params)
        self.sea.choppiness = acting(params).choppiness * params.amplitude
        if rain_settings(params) != rain_settings(old):
            self.make_rainfall()

    def change_sea(self, transition: float, foam_cover: float, viscosity: float) -> None:
        """Let the sea adapt to its conditions in this time [s]; a nonlinear one restarts with them.

        foam_cover: present fraction of foam without damping. viscosity: [m2/s] until now.
        """
        self.sea.change(self.time, transition, **self.conditions())
        self.begin_marching()
        viscous_area = self.change.viscous_area_at(self.time, viscosity)
        self.change = WeatherChange(self.time, transition, foam_cover, viscous_area)
        self.waves.found_at = self.statistics.measured_at = -math.inf

    def conditions(self) -> dict[str, Any]:
        """The arguments of `Sea.change`, from a student's functions if the sea uses them."""
        return conditions(self.params) if self.student is None else self.student.conditions(self.params)

    def take_student(self, student: "StudentSea") -> None:
        """Take the results of a student's functions."""
        transition = student.collect(self.params)
        if transition is None:
            return
        before = self.sea.conditions.gravity
        self.change_sea(transition, self.change.foam_cover, acting(self.params).viscosity)
        self.statistics.theory = self.drawn = None
        if self.sea.conditions.gravity != before:
            self.make_rainfall()
            student.want(self.params)
        student.report(self.params)

    def handle(self, command: SceneCommand) -> None:
        """Place the wave gauge at a click on the water."""
        match command:
            case StudentAnswer() if self.student is not None:
                self.take_student(self.student)
            case PointAlong(origin, direction):
                at = where_hit(*self.water, origin, direction, self.params.amplitude)
                if at is not None:
                    self.gauge.put(at)
                    self.gauge_placed = True
                    self.begin_plots()
                    self.drawn = None

    def advance(self, steps: int) -> None:
        """Move the clock, and a nonlinear sea with it."""
        if self.marching is not None:
            self.marching.advance((self.steps + steps) * self.step)
        self.steps += steps
        self.counts["steps"] += steps

    def read_gauge(self) -> None:
        """Have the wave gauge read the sea as it is now, and add a plot row if one is due."""
        self.gauge.read(*self.water, self.params.amplitude)
        self.counts["gauge readings"] += 1
        self.plot_rows.add_due(self.time, self.gauge.height, DRAUPNER.crest if is_draupner(self.params) else math.nan)

    @property
    def gauge_shown(self) -> bool:
        """True if the wave gauge is drawn and read."""
        p = self.params
        return self.gauge_placed or p.gauge or p.plot_wave_gauge or p.plot_wave_spectrum

    def frame(self) -> SeaFrame:
        """Frame of the present sea; an unchanged surface is not evaluated again."""
        p, drawn = self.params, self.drawn
        if (
            drawn is None
            or drawn.time != self.time
            or effect_of_change(drawn.params, p) not in (None, "look")
            or self.statistics.is_due(p, self.time)
            or (self.gauge_shown and drawn.gauge is None)
        ):
            drawn = self.draw()
        elif drawn.params != p:
            drawn = drawn._replace(params=p)
        self.drawn = drawn
        return drawn

    def draw(self) -> SeaFrame:
        """Evaluate the surface once, and bring foam, rain, wave gauge and statistics up to date with it."""
        p, t = self.params, self.time
        dt, self.drawn_at = max(t - self.drawn_at, 0.0), t
        transforms_before = self.water[0].transforms.count
        fields = self.fields()
        frame = self.make_frame(fields, dt)
        rain = None
        if self.rainfall is not None:
            self.counts["rings"] += self.rainfall.advance(self.sea, t, dt, *fields[:2], p.amplitude)
            self.counts["rainfall steps"] += 1
            rain = self.rainfall.frame()
        if self.gauge_shown or self.plot_rows.is_due(t):
            self.read_gauge()
        gauge = (*self.gauge.at, self.gauge.height) if self.gauge_shown else None
        changing = acting(p).viscosity > 0.0 or self.change.is_under_way(t)
        new = self.statistics.update(self.sea, p, t, fields.height, dt, changing=changing, marching=self.marching)
        self.counts["statistics"] += new
        self.update_spectrum()
        self.counts["frames"] += 1
        self.counts["transforms"] += self.water[0].transforms.count - transforms_before
        return frame._replace(rain=rain, gauge=gauge, highest=fields.highest)

    def fields(self) -> Fields:
        """The fields of the present sea."""
        if self.marching is not None:
            return self.marching.fields(self.params)
        surface = self.sea.surface(self.time)
        return Fields(surface.height, surface.displacement if self.sea.choppiness > 0.0 else None)

    def make_frame(self, fields: Fields, dt: float) -> SeaFrame:
        """The mesh of these fields with the foam of the last one faded over dt [s]."""
        p = self.params
        self.counts["slopes"] += self.waves.update(self.sea, self.time, p.amplitude)
        vertices, slopes = self.foam.make_mesh(fields, acting(p), dt, self.waves, self.expected_foam_cover(self.time))
        return SeaFrame(p, self.time, vertices, slopes, self.foam.values, self.waves.slope, None, None, SentSurface())

    def update_spectrum(self) -> None:
        """Update the spectrum at the wave gauge, if it is shown and out of date."""
        p, t = self.params, self.time
        if p.plot_wave_spectrum and abs(t - self.spectrum_at) >= INTERVAL:
            columns = self.gauge.spectrum(self.sea, t, p.amplitude)
            self.spectrum_at = t
            self.curve_columns = {"plot_wave_spectrum": columns} if columns[0].size else None
            self.counts["gauge spectra"] += 1

    def expected_foam_cover(self, t: float) -> float:
        """Fraction of the sea that is foam by Monahan's law, times the slope that damping left."""
        return self.change.foam_cover_at(t, self.params.wind_speed) * self.waves.slope_left

    def take_plot_rows(self) -> tuple[PlotRow, ...]:
        """The plot rows since the last call."""
        return self.plot_rows.take()

    def readings(self) -> SeaReadings:
        """Numbers for the panel at the time of the last frame."""
        return SeaReadings(
            foam_cover=self.foam.cover,
            expected_foam_cover=self.expected_foam_cover(self.time),
            slope_left=self.waves.slope_left,
            foam_limit=self.foam.limit.value,
            is_choppy=self.marching is not None or self.sea.choppiness > 0.0,
            viscous_area=self.change.viscous_area_at(self.time, acting(self.params).viscosity),
            rain=None if self.rainfall is None else self.rainfall.readings(),
            report=self.statistics.report if self.params.statistics else None,
        )

    def curves(self) -> dict[str, tuple[NDArray[np.floating], ...]] | None:
        """The columns of `CURVES`, where it is open."""
        return self.curve_columns if self.params.plot_wave_spectrum else None

    def arrays(self) -> dict[str, tuple[NDArray[np.floating], str]]:
        """The state for a file: name -> (array, unit)."""
        frame = self.frame()
        return {"vertices": (frame.vertices, "m"), "slopes": (frame.slopes, ""), "foam": (frame.foam, "0 to 1")}


def has_high_crest(snapshot: Snapshot) -> bool:
    """True if a drawn crest is 1.25 times Hs high or more: a rogue wave, by a usual definition."""
    height = snapshot.frame.vertices[..., 2]
    return bool(height.max() >= HIGH_CREST * 4.0 * height.std() > 0.0)
