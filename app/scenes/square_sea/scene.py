"""The square sea: wind waves on a tile that repeats to the horizon, on any planet, in calm, storm and rain."""

import collections
import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.messages import Point, SceneCommand, WorkCount
from app.scenes.charts import CurveAxes, PlotAxes
from app.scenes.contract import SceneKind
from app.scenes.square_sea.measures import measures
from app.scenes.square_sea.parameters import Params, conditions, gravity, hidden
from app.scenes.square_sea.rainfall import Rainfall, RainFrame
from app.scenes.square_sea.report import Report, Theory, measure, theory
from sim.ocean import Sea
from sim.ocean.foam import pace, threshold, whitecaps
from sim.ocean.tile_mesh import set_mesh
from sim.ocean.wave_gauge import WaveGauge, where_hit
from sim.parameters import effect_of_change

TITLE = "Square sea"
HELP = "<b>Click the water</b> to place the probe. Drag to look around, scroll to fly."
SERIES = ("probe",)
PLOTS = {"plot_probe": PlotAxes("Height at the probe", "m", ("probe",))}
CURVES = {"plot_spectrum": CurveAxes("Spectrum at the probe [m²/Hz]", "f [Hz]", ("measured", "theory"))}
STEP = 1 / 60  # [s] of the clock; nothing is integrated over it
STARTS = {"calm": 3.0, "storm": 24.0}  # [m/s] wind of the sea that a reset may begin with
SOFT = 0.35  # how far below the threshold the Jacobian of full foam is, in parts of the sea's own spread
MEASURE_EVERY = 0.5  # [s] between two looks at the statistics of the sea
SETTLED = 16.0  # transition times after which nothing is left of a change
SAMPLE_EVERY = 0.1  # [s] between two plot rows
AHEAD = (0.06, 12.0), (-0.015, -3.0)  # of the tile, but no more than [m]: where the probe is before it is placed
PACE_EVERY = 0.5  # [s] between two looks at how steep and how fast the sea is
LEARN = 0.15  # [1/s] spreads by which the threshold of foam moves where e times too little is drawn
TRIM = 0.5  # spreads it begins above the formula
LEAST_FOAM = 1e-4  # share of the sea below which nobody counts
EVERY_FIELD = 8  # transforms of a height, its displacement, slope and Jacobian
SEEN = 1.2  # part of the fading time for which foam counts as seen

PRESETS: dict[str, dict[str, Any]] = {
    "Earth breeze": {},
    "Storm arriving": {
        "spectrum": "jonswap", "wind_speed": 24.0, "fetch": 200e3, "start": "calm", "transition": 20.0, "rain": 15.0,
        "length": 600.0, "choppiness": 1.2, "clouds": 1.0, "daylight": 0.7, "visibility": 1200.0, "drops": 3000,
        "view": "bridge",
    },
    "Storm over": {
        "wind_speed": 7.0, "start": "storm", "transition": 20.0, "length": 384.0, "sky": "sunset", "clouds": 0.45,
    },
    "Light planet": {
        "planet_mass": 0.01, "length": 1024.0, "wind_speed": 10.0, "visibility": 6000.0, "sky": "dawn", "view": "mast",
    },
    "Heavy planet": {"planet_mass": 100.0, "length": 128.0, "wind_speed": 10.0, "visibility": 1500.0, "view": "mast"},
    "Rain shower": {
        "rain": 30.0, "length": 32.0, "wind_speed": 0.5, "wind_direction": 70.0, "mesh": "256", "rings": 2.5,
        "frame_rate": 24.0, "view": "swimmer", "drops": 600, "visibility": 500.0, "foam": False, "sky": "dawn",
        "clouds": 0.8, "sun": 8.0,
    },
}  # fmt: skip


class SeaFrame(NamedTuple):
    """What the viewer draws of a sea."""

    params: Params
    time: float  # [s]
    vertices: NDArray[np.float32]  # (n, n, 3) [m]
    slopes: NDArray[np.float32]  # (n, n, 2)
    foam: NDArray[np.float32]  # (n, n), 0 to 1
    slope_resolved: float  # mean square slope of the solved waves
    rain: RainFrame | None
    probe: tuple[float, float, float] | None  # [m]


class RainReadings(NamedTuple):
    """How much of the rain is drawn."""

    rate: float  # [mm/h]
    drawn: int  # drops in the air that are drawn
    weight: float  # drops that each of them stands for
    hits: int  # of drawn drops so far
    fallen: float  # drops that have fallen on the window by now
    span: float  # [m] side of the window
    drops_a_ring: float  # at one place, that a ring as drawn would take; 0 where the grid is too coarse for rings


class SeaReadings(NamedTuple):
    """What was found."""

    foam: float  # share of the drawn sea
    foam_asked: float  # share that Monahan's law gives
    threshold: float  # Jacobian below which there is foam
    age: float  # [s] since the last change of weather or water
    residual: float | None  # [m] of the probe
    rain: RainReadings | None
    report: Report | None


def warm_up() -> Iterator[str]:
    """Compile everything the scene may call, and plan its transforms; yields what comes next."""
    for size in (64, 128, 256, 512):
        yield f"waves on {size} x {size}"
        Sea(size)
    yield "the drawn sea"
    for choppiness in (0.0, 1.0):
        scene = Scene(Params(choppiness=choppiness, size="64", mesh="32", length=64.0, rain=50.0, plot_spectrum=True))
        for _ in range(4):
            scene.advance(30)
            scene.frame()


def rain_of(params: Params) -> tuple[Any, ...]:
    """What the rain depends on."""
    p = params
    return p.rain, p.drops, p.rings, p.wind_speed, p.wind_direction, gravity(p), p.size, p.amplitude


class Scene:
    """The sea on the simulation thread. Time is analytic: a step moves the clock, a picture evaluates the surface."""

    step = STEP

    def __init__(self, params: Params) -> None:
        self.params = params
        self.counts: collections.Counter[str] = collections.Counter()
        self.samples: list[tuple[float, ...]] = []
        self.probe = WaveGauge()
        self.placed = False
        L = params.length
        x, y = (math.copysign(min(abs(part) * L, abs(most)), most) for part, most in AHEAD)
        self.probe.put((0.5 * L + x, 0.5 * L + y))
        self.reset()

    @property
    def time(self) -> float:
        return self.steps * STEP

    @property
    def frame_interval(self) -> float:
        """Time between pictures [s]."""
        return 1.0 / self.params.frame_rate

    @property
    def note(self) -> str:
        """Why something else runs than the parameters ask for, or ""."""
        return ""

    def reset(self) -> None:
        """The sea at time 0."""
        self.steps = 0
        self.begin_plots()
        self.make_sea()

    def begin_plots(self) -> None:
        self.samples.append((math.nan,) * (len(SERIES) + 1))  # a gap in the plots
        self.sampled_at = -math.inf
        self.curve: dict[str, tuple[NDArray[np.floating], ...]] | None = None
        self.probe.trace.clear()

    def make_sea(self) -> None:
        """A new sea at the present time; it grows or calms from what `start` says."""
        p = self.params
        wind = STARTS.get(p.start) if self.steps == 0 else None
        self.sea = Sea(int(p.size), p.length, seed=p.seed, **conditions(p, wind))
        self.sea.choppiness = p.choppiness * p.amplitude
        self.white_before = whitecaps(p.wind_speed if wind is None else wind)
        if wind is not None:
            self.sea.change(self.time, p.transition, **conditions(p))
        self.changed_at = self.time
        self.report: Report | None = None
        self.theory: Theory | None = None
        self.clear_mesh()
        self.make_shower()

    def make_shower(self) -> None:
        """New rain, as the parameters have it; nothing where there is none."""
        p = self.params
        self.shower: Rainfall | None = None
        if p.rain > 0.0:
            bearing = math.radians(p.wind_direction)
            wind = p.wind_speed * math.cos(bearing), p.wind_speed * math.sin(bearing)
            highest = max(p.amplitude * self.sea.significant_height_at(self.time), 1.0)
            self.shower = Rainfall(self.sea, p.rain, p.drops, wind, highest, p.rings, p.seed)

    def clear_mesh(self) -> None:
        """Begin the mesh anew, without foam."""
        n = min(int(self.params.mesh), self.sea.size)
        self.foam = np.zeros((n, n), np.float32)
        self.drawn: SeaFrame | None = None
        self.drawn_at = self.time
        self.paced_at = -math.inf
        self.measured_at = -math.inf
        self.earlier: NDArray[np.floating] | None = None
        self.covered, self.trim, self.spread = 0.0, TRIM, 0.0

    def change_forces(self, params: Params) -> None:
        """Take new parameters: new weather grows out of the sea as it is, another grid shows the same sea."""
        old, white = self.params, self.whiteness(self.time)
        self.params = params
        self.theory = None
        if params.length != old.length:
            x, y = self.probe.at
            middle = 0.5 * (params.length - old.length)
            self.probe.put((x + middle, y + middle))
        if (params.length, params.seed) != (old.length, old.seed):
            self.make_sea()
            return
        if params.size != old.size:
            self.sea = self.sea.resized(int(params.size))
        if params.size != old.size or params.mesh != old.mesh:
            self.clear_mesh()
        if conditions(params) != conditions(old):
            self.white_before = white
            self.sea.change(self.time, params.transition, **conditions(params))
            self.changed_at = self.time
            self.counts["changes"] += 1
            self.paced_at = self.measured_at = -math.inf
        self.sea.choppiness = params.choppiness * params.amplitude
        if rain_of(params) != rain_of(old):
            self.make_shower()

    def handle(self, command: SceneCommand) -> None:
        match command:
            case Point(origin, direction):
                at = where_hit(self.sea, self.time, origin, direction, self.params.amplitude)
                if at is not None:
                    self.probe.put(at)
                    self.placed = True
                    self.begin_plots()
                    self.drawn = None

    def advance(self, steps: int) -> None:
        """Move the clock."""
        self.steps += steps
        self.counts["steps"] += steps

    def frame(self) -> SeaFrame:
        """The sea as it is now; what has not changed is handed out again."""
        p, drawn = self.params, self.drawn
        if drawn is None or drawn.time != self.time or effect_of_change(drawn.params, p) not in (None, "look"):
            drawn = self.draw()
        elif drawn.params != p:
            drawn = drawn._replace(params=p)
            self.counts["pictures kept"] += 1
        self.drawn = drawn
        return drawn

    def draw(self) -> SeaFrame:
        """Evaluate the surface once, and let foam, rain, probe and statistics catch up with it."""
        p, t = self.params, self.time
        dt = max(t - self.drawn_at, 0.0)
        self.drawn_at = t
        before = self.sea.transforms.count
        surface = self.sea.surface(t)
        height = surface.height
        displacement = surface.displacement if self.sea.choppiness > 0.0 else None
        picture = self.mesh_of(height, displacement, dt)
        rain = None
        if self.shower is not None:
            self.counts["rings"] += self.shower.fall(self.sea, t, dt, height, displacement, p.amplitude)
            self.counts["showers"] += 1
            rain = self.shower.frame()
        probe = None
        if self.placed or p.plot_probe or p.plot_spectrum:
            self.probe.read(self.sea, t, p.amplitude)
            self.counts["probe readings"] += 1
            probe = (*self.probe.at, self.probe.height)
        self.look(height)
        self.earlier = height if p.statistics else None
        self.counts["pictures"] += 1
        self.counts["transforms"] += self.sea.transforms.count - before
        return picture._replace(rain=rain, probe=probe)

    def mesh_of(self, height: NDArray[np.floating], displacement: NDArray[np.floating] | None, dt: float) -> SeaFrame:
        """The drawn mesh of these fields, with the foam of the last one faded over dt [s]."""
        p, n = self.params, len(self.foam)
        D = np.empty((1, 1, 2), np.float32) if displacement is None else displacement
        limit, soft = self.foam_limit(self.time, dt)
        vertices, slopes = np.empty((n, n, 3), np.float32), np.empty((n, n, 2), np.float32)
        self.foam = self.foam.copy()
        self.covered, self.spread = set_mesh(
            height, D[..., 0], D[..., 1], displacement is not None, p.amplitude, self.sea.size // n,
            self.sea.length / self.sea.size, limit, soft, math.exp(-dt / p.foam_fade), vertices, slopes, self.foam,
        )  # fmt: skip
        return SeaFrame(p, self.time, vertices, slopes, self.foam, self.pace[0], None, None)

    def look(self, height: NDArray[np.floating]) -> None:
        """Statistics and the probe's spectrum, at a few hertz and only where they are shown; plot rows."""
        p, t = self.params, self.time
        if abs(t - self.measured_at) >= MEASURE_EVERY:
            self.measured_at = t
            if p.statistics:
                if self.theory is None or p.viscosity > 0.0 or t - self.changed_at < SETTLED * p.transition:
                    self.theory = theory(self.sea, t, p)
                self.report = Report(measure(self.sea, height, self.earlier, p), self.theory)
                self.counts["statistics"] += 1
            if p.plot_spectrum:
                columns = self.probe.spectrum(self.sea, t, p.amplitude)
                self.curve = {"plot_spectrum": columns} if columns[0].size else None
                self.counts["probe spectra"] += 1
        if p.plot_probe and t - self.sampled_at >= SAMPLE_EVERY:
            self.sampled_at = t
            self.samples.append((t, self.probe.height))

    def whiteness(self, t: float) -> float:
        """Share of the sea that is to be foam; takes to new weather as the waves do."""
        new = whitecaps(self.params.wind_speed)
        if self.params.transition == 0.0:
            return new
        return new + (self.white_before - new) * math.exp(-(t - self.changed_at) / self.params.transition)

    def foam_limit(self, t: float, dt: float) -> tuple[float, float]:
        """(Jacobian below which there is foam, how far below it is full)."""
        p = self.params
        if abs(t - self.paced_at) >= PACE_EVERY:
            self.paced_at = t
            self.pace = pace(self.sea, t)
        spread = self.spread or max(self.sea.choppiness * math.sqrt(self.pace[0]), 1e-6)
        self.threshold = p.foam_threshold
        if not p.foam:
            self.threshold = -math.inf
        elif p.foam_by_wind:
            asked = self.whiteness(t)
            # The formula is for small slopes; what it misses is learned slowly from the foam as drawn.
            missing = math.log((asked + LEAST_FOAM) / (self.covered + LEAST_FOAM))
            self.trim = min(max(self.trim + LEARN * dt * min(max(missing, -1.0), 1.0), -1.0), 2.0)
            guess = threshold(asked, spread, self.pace[1], SEEN * p.foam_fade)
            self.threshold = guess + self.trim * spread if asked > 0.0 and guess > 0.0 else -math.inf
        return self.threshold, SOFT * spread

    def take_plot_rows(self) -> tuple[tuple[float, ...], ...]:
        taken, self.samples = tuple(self.samples), []
        return taken

    def readings(self) -> SeaReadings:
        p = self.params
        rain = None
        if self.shower is not None:
            r = self.shower.rain
            rain = RainReadings(
                r.rate, r.diameter.size, r.weight, r.hits, r.fallen, self.shower.span, self.shower.drops_a_ring
            )
        return SeaReadings(
            foam=self.covered,
            foam_asked=self.whiteness(self.time),
            threshold=self.threshold,
            age=self.time - self.changed_at,
            residual=self.probe.residual if self.drawn is not None and self.drawn.probe is not None else None,
            rain=rain,
            report=self.report if p.statistics else None,
        )

    def work(self) -> dict[str, WorkCount]:
        """For the ledger: each against every field, and everything that may be shown, in every picture."""
        c = self.counts
        pictures = c["pictures"]
        return {
            "transforms": WorkCount(c["transforms"], max(EVERY_FIELD * pictures - c["transforms"], 0)),
            "new looks on the same sea": WorkCount(0, c["pictures kept"]),
            "showers": WorkCount(c["showers"], pictures - c["showers"]),
            "rings of rain begun": WorkCount(c["rings"]),
            "probe readings": WorkCount(c["probe readings"], pictures - c["probe readings"]),
            "probe spectra": WorkCount(c["probe spectra"], pictures - c["probe spectra"]),
            "statistics": WorkCount(c["statistics"], pictures - c["statistics"]),
        }

    def curves(self) -> dict[str, tuple[NDArray[np.floating], ...]] | None:
        """The columns of `CURVES`."""
        return self.curve

    def arrays(self) -> dict[str, tuple[NDArray[np.floating], str]]:
        """The state for a file: name -> (array, unit)."""
        picture = self.frame()
        return {
            "vertices": (picture.vertices, "m"),
            "slopes": (picture.slopes, ""),
            "foam": (picture.foam, "0 to 1"),
        }


SCENE = SceneKind(
    name="square_sea",
    title="Square sea",
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
)
