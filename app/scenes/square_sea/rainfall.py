"""Rain on the square sea: a sample of drops over a window of the tile, their splashes, and their rings.

The ring of one real drop is too faint to see, and too small for a grid of metres. A ring is therefore drawn as wide as
the grid needs, and steep enough to be seen; `drops_per_ring` says how many real drops at one place would make it.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.scenes.square_sea.parameters import RainSettings
from sim.ocean import Sea
from sim.particles.rain import Hits, Rain

MAX_WINDOW_SIDE = 48.0  # [m] side of the square in the middle of the tile over which drops are drawn
DROP_START_HEIGHT = 0.6  # of the window's side: how far above the highest waves drops start
MAX_RING_CELL = 0.35  # [m] grid spacing above which no ring is drawn
RING_WIDTH_CELLS = 1.5  # Gaussian width of a new ring, in grid spacings
RING_STEEPNESS = 0.3  # depth of the first trough of an average drop's ring over that width
MAX_RING_STRENGTH = 3.0  # in average drops: the rings of the largest drops would break the surface
# An impulse J on a Gaussian of width a makes a trough TROUGH_COEFFICIENT J/(density a^(5/2) sqrt(g)) deep in deep
# water (Lamb, Hydrodynamics, Art. 255).
TROUGH_COEFFICIENT = 0.160
RING_DECAY_RATE = 0.5  # [1/s]: it stands for the waves that would have left the tile
SPLASH_DURATION = 0.22  # [s] for which a splash is drawn
MAX_SPLASHES = 150  # drawn at the same time
DROP_DENSITY = 1000.0  # [kg/m3] of rain, which falls on sea water


class RainFrame(NamedTuple):
    """Drawn state of the rain, float32."""

    drops: NDArray[np.float32]  # (n, 3) [m]
    velocity: NDArray[np.float32]  # (n, 3) [m/s]
    splashes: NDArray[np.float32]  # (MAX_SPLASHES, 4): place [m] and age [s]; an age below 0 is no splash
    span: float  # [m] side of the window


class RainReadings(NamedTuple):
    """Fraction of the rain that is drawn."""

    rate: float  # [mm/h]
    drawn: int  # drops in the air that are drawn
    weight: float  # real drops that each of them stands for
    fallen: float  # real drops that have fallen on the window so far
    drops_per_ring: float  # real drops, all at one place, that would make a ring as drawn; 0 where no rings are drawn


class SeaRain:
    """The rain above one sea, on the simulation thread."""

    def __init__(self, sea: Sea, settings: RainSettings, highest: float, seed: int) -> None:
        """highest: [m] of the waves; drops start above it. settings.rate must be above 0."""
        n = sea.size
        cell = sea.length / n
        self.cells = min(n, max(8, round(MAX_WINDOW_SIDE / cell)))
        self.first = (n - self.cells) // 2
        self.corner = self.first * cell  # [m] of the window, in x and y
        self.span = self.cells * cell
        gravity = sea.conditions.gravity
        start = highest + DROP_START_HEIGHT * self.span
        self.rain = Rain(settings.rate, self.span, start, settings.drops, settings.wind, gravity=gravity, seed=seed)
        self.ring_strength = settings.ring_strength if cell <= MAX_RING_CELL else 0.0
        self.ring_width = RING_WIDTH_CELLS * cell
        self.splashes = np.full((MAX_SPLASHES, 4), -1.0, np.float32)
        self.next_splash = 0
        mean_cube = float((self.rain.diameter**3 * self.rain.speed).mean())
        self.momentum = DROP_DENSITY * math.pi / 6.0 * mean_cube  # [kg m/s] of an average drawn drop
        per_depth = sea.conditions.density * self.ring_width**2.5 * math.sqrt(gravity) / TROUGH_COEFFICIENT  # [N s/m]
        self.drops_per_ring = self.ring_strength * RING_STEEPNESS * self.ring_width * per_depth / self.momentum

    def advance(
        self, sea: Sea, t: float, dt: float, height: np.ndarray, displacement: np.ndarray | None, scale: float
    ) -> int:
        """Let it rain for dt [s] until t [s] on the fields of t; returns the number of new rings.

        height: (n, n) [m], to be multiplied by `scale`. displacement: (n, n, 2) [m].
        """
        window = slice(self.first, self.first + self.cells)
        heights = np.ascontiguousarray(height[window, window]) * np.float32(scale)
        moved = None
        if displacement is not None:
            planes = np.ascontiguousarray(np.moveaxis(displacement[window, window], -1, 0))
            moved = np.moveaxis(planes, 0, -1)
        hits = self.rain.step(dt, heights, moved)
        self.update_splashes(hits, dt)
        if self.ring_strength == 0.0 or not len(hits.label):
            return 0
        momentum = DROP_DENSITY * math.pi / 6.0 * hits.diameter**3 * hits.speed
        momentum = np.minimum(momentum, MAX_RING_STRENGTH * self.momentum)
        sea.ripples.leak = RING_DECAY_RATE
        sea.ripples.add(t, hits.label + self.corner, self.ring_width, impulse=self.drops_per_ring * momentum)
        return len(hits.label)

    def update_splashes(self, hits: Hits, dt: float) -> None:
        """Let the splashes age by dt [s], and put the new ones in the place of the oldest."""
        age = self.splashes[:, 3]
        age[age >= 0.0] += dt
        age[age > SPLASH_DURATION] = -1.0
        for place in hits.position[:MAX_SPLASHES]:
            self.splashes[self.next_splash, :3] = place
            self.splashes[self.next_splash, :2] += self.corner
            age[self.next_splash] = 0.0
            self.next_splash = (self.next_splash + 1) % MAX_SPLASHES

    def frame(self) -> RainFrame:
        """The drops as they are now."""
        r = self.rain
        drops = r.position.T.astype(np.float32)
        drops[:, :2] += np.float32(self.corner)
        velocity = np.empty_like(drops)
        velocity[:, 0], velocity[:, 1] = r.wind
        velocity[:, 2] = -r.speed
        return RainFrame(drops, velocity, self.splashes.copy(), self.span)

    def readings(self) -> RainReadings:
        """Numbers for the panel."""
        r = self.rain
        return RainReadings(r.rate, r.diameter.size, r.weight, r.fallen, self.drops_per_ring)
