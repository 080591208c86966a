"""The square sea: wind waves on a tile that repeats to the horizon, on any planet, in calm, storm and rain."""

import collections
import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.messages import Command
from app.sea_knobs import Params, conditions, gravity, hidden
from app.sea_mesh import set_mesh
from sim.ocean import Sea
from sim.ocean.foam import pace, threshold, whitecaps

__all__ = ["HELP", "PLOTS", "PRESETS", "SERIES", "TITLE", "Params", "Scene", "hidden", "warm_up"]

TITLE = "Square sea"
HELP = "<b>Click the water</b> to place the probe. <b>G</b> shows the grid. Drag to look around, scroll to fly."
SERIES = ("probe",)
PLOTS = {"plot_probe": ("Height at the probe", "m", ("probe",))}
STEP = 1 / 60  # [s] of the clock; nothing is integrated over it
STARTS = {"calm": 3.0, "storm": 24.0}  # [m/s] wind of the sea that a reset may begin with
SOFT = 0.35  # how far below the threshold the Jacobian of full foam is, in parts of the sea's own spread
SEEN = 1.2  # part of the fading time for which foam counts as seen

PRESETS: dict[str, dict[str, Any]] = {
    "Earth breeze": {},
    "Storm arriving": {
        "wind_speed": 21.0, "start": "calm", "transition": 20.0, "length": 512.0, "rain": 8.0, "clouds": 0.9,
        "sky": "dawn",
    },
    "Storm over": {
        "wind_speed": 5.0, "start": "storm", "transition": 20.0, "length": 512.0, "sky": "sunset", "clouds": 0.5,
    },
    "Light planet": {"planet_mass": 0.01, "length": 1024.0, "wind_speed": 10.0},
    "Heavy planet": {"planet_mass": 100.0, "length": 64.0, "wind_speed": 10.0},
    "Rain shower": {"rain": 30.0, "length": 32.0, "wind_speed": 4.0, "clouds": 0.8},
}  # fmt: skip


class SeaPicture(NamedTuple):
    """What the viewer draws of a sea."""

    params: Params
    time: float  # [s]
    vertices: NDArray[np.float32]  # (n, n, 3) [m]
    slopes: NDArray[np.float32]  # (n, n, 2)
    foam: NDArray[np.float32]  # (n, n), 0 to 1
    slope_resolved: float  # mean square slope of the solved waves


class SeaGauge(NamedTuple):
    """What was done and what was skipped."""

    gravity: float  # [m/s2]
    foam: float  # share of the drawn sea
    foam_asked: float  # share that Monahan's law gives
    threshold: float  # Jacobian below which there is foam
    counts: dict[str, int]


def warm_up() -> Iterator[str]:
    """Compile everything the scene may call, and plan its transforms; yields what comes next."""
    for size in (64, 128, 256, 512):
        yield f"waves on {size} x {size}"
        Sea(size)
    yield "the drawn sea"
    for choppiness in (0.0, 1.0):
        scene = Scene(Params(choppiness=choppiness, size="64", mesh="32"))
        scene.advance(1)
        scene.picture()


class Scene:
    """The sea on the simulation thread. Time is analytic: a step moves the clock, a picture evaluates the surface."""

    step = STEP

    def __init__(self, params: Params) -> None:
        self.params = params
        self.counts: collections.Counter[str] = collections.Counter()
        self.samples: list[tuple[float, ...]] = []
        self.reset()

    @property
    def time(self) -> float:
        return self.steps * STEP

    @property
    def frame(self) -> float:
        """Time between pictures [s]."""
        return 1.0 / self.params.frame_rate

    def reset(self) -> None:
        """The sea at time 0."""
        self.steps = 0
        self.samples.append((math.nan,) * (len(SERIES) + 1))  # a gap in the plots
        self.make_sea()

    def make_sea(self) -> None:
        """A new sea at the present time; it grows or calms from what `start` says."""
        p = self.params
        wind = STARTS.get(p.start) if self.steps == 0 else None
        self.sea = Sea(int(p.size), p.length, seed=p.seed, **conditions(p, wind))
        self.sea.choppiness = p.choppiness * p.amplitude
        if wind is not None:
            self.sea.change(self.time, p.transition, **conditions(p))
        self.clear_foam()

    def clear_foam(self) -> None:
        n = min(int(self.params.mesh), self.sea.size)
        self.foam = np.zeros((n, n), np.float32)
        self.drawn: SeaPicture | None = None
        self.drawn_at = self.time
        self.paced_at = -math.inf
        self.covered = 0.0

    def set_params(self, params: Params) -> None:
        """Take new knobs: new weather grows out of the sea as it is, another grid shows the same sea."""
        old, self.params = self.params, params
        if (params.length, params.seed) != (old.length, old.seed):
            self.make_sea()
            return
        if params.size != old.size:
            self.sea = self.sea.resized(int(params.size))
        if params.size != old.size or params.mesh != old.mesh:
            self.clear_foam()
        if conditions(params) != conditions(old):
            self.sea.change(self.time, params.transition, **conditions(params))
            self.counts["changes"] += 1
            self.paced_at = -math.inf
        self.sea.choppiness = params.choppiness * params.amplitude

    def obey(self, command: Command) -> None:
        pass

    def advance(self, steps: int) -> None:
        """Move the clock."""
        self.steps += steps
        self.counts["steps"] += steps

    def picture(self) -> SeaPicture:
        """The sea as it is now; what has not changed is handed out again."""
        p = self.params
        if self.drawn is None or (self.drawn.params, self.drawn.time) != (p, self.time):
            self.drawn = self.draw()
        return self.drawn

    def draw(self) -> SeaPicture:
        """Evaluate the surface once, and let foam and rain catch up with it."""
        p, t = self.params, self.time
        self.counts["pictures"] += 1
        before = self.sea.transforms.count
        surface = self.sea.surface(t)
        height = surface.height
        choppy = self.sea.choppiness > 0.0
        D = surface.displacement if choppy else np.empty((1, 1, 2), np.float32)
        limit, soft = self.foam_limit(t)
        n = len(self.foam)
        vertices, slopes = np.empty((n, n, 3), np.float32), np.empty((n, n, 2), np.float32)
        foam = self.foam.copy()
        fade = math.exp(-(t - self.drawn_at) / p.foam_fade)
        self.covered, self.crest = set_mesh(
            height, D[..., 0], D[..., 1], choppy, p.amplitude, self.sea.size // n, self.sea.length / self.sea.size,
            limit, soft, fade, vertices, slopes, foam,
        )  # fmt: skip
        self.foam, self.drawn_at = foam, t
        self.counts["transforms"] += self.sea.transforms.count - before
        return SeaPicture(p, t, vertices, slopes, foam, self.pace[0])

    def foam_limit(self, t: float) -> tuple[float, float]:
        """(Jacobian below which there is foam, how far below it is full); looked at twice a second at most."""
        p = self.params
        if t - self.paced_at >= 0.5 or t < self.paced_at:
            self.paced_at = t
            self.pace = pace(self.sea, t)
        spread = max(p.choppiness * p.amplitude * math.sqrt(self.pace[0]), 1e-6)
        self.threshold = p.foam_threshold
        if not p.foam:
            self.threshold = -math.inf
        elif p.foam_by_wind:
            self.threshold = threshold(
                whitecaps(p.wind_speed), self.pace[0], self.pace[1], p.choppiness * p.amplitude, SEEN * p.foam_fade
            )
        return self.threshold, SOFT * spread

    def take_samples(self) -> tuple[tuple[float, ...], ...]:
        taken, self.samples = tuple(self.samples), []
        return taken

    def gauge(self) -> SeaGauge:
        p = self.params
        return SeaGauge(gravity(p), self.covered, whitecaps(p.wind_speed), self.threshold, dict(self.counts))

    def arrays(self) -> dict[str, tuple[NDArray[np.float64], str]]:
        """The state for a file: name -> (array, unit)."""
        picture = self.picture()
        return {
            "vertices": (picture.vertices, "m"),
            "slopes": (picture.slopes, ""),
            "foam": (picture.foam, "0 to 1"),
        }
