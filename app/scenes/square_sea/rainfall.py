"""Rain on the square sea: a sample of drops over a window of the tile, their splashes, and their rings.

One drop of rain makes a ring too faint to see, and no grid of metres could carry it. A ring is drawn as wide as the
grid needs and steep enough to be seen; `drops_a_ring` says how many drops at one place that would take.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.ocean import Sea
from sim.particles.rain import Hits, Rain

WINDOW = 48.0  # [m] side of the square in the middle of the tile that drops are drawn over
ROOM = 0.6  # of the window's side: how far above the highest waves drops begin
COARSEST = 0.35  # [m] cell above which no ring is drawn
WIDTH = 1.5  # cells: Gaussian width of a ring's beginning
STEEPNESS = 0.3  # depth of the first trough over that width, for an average drop
LARGEST = 3.0  # average drops that a ring is as strong as at most: the largest drops would break the surface
BLOW = (
    0.160  # the trough of an impulse J on a width a is BLOW J/(rho a^(5/2) sqrt(g)) deep, deep water (Lamb, Art. 255)
)
LEAK = 0.5  # [1/s] at which rings fade, for what would have left the tile
LASTING = 0.22  # [s] that a splash is drawn
SPLASHES = 150  # drawn at once at most
DENSITY = 1000.0  # [kg/m3]


class RainFrame(NamedTuple):
    """What is drawn of the rain, float32."""

    drops: NDArray[np.float32]  # (n, 3) [m]
    velocity: NDArray[np.float32]  # (n, 3) [m/s]
    splashes: NDArray[np.float32]  # (SPLASHES, 4): place [m] and age [s]; age < 0 is none
    span: float  # [m] side of the window


class Rainfall:
    """The rain above one sea, on the simulation thread."""

    def __init__(
        self, sea: Sea, rate: float, drops: int, wind: tuple[float, float], highest: float, rings: float, seed: int
    ) -> None:
        """rate [mm/h]; wind [m/s]; highest [m]: wave to begin above; rings: factor on their strength, 0 for none."""
        n = sea.size
        cell = sea.length / n
        self.cells = min(n, max(8, round(WINDOW / cell)))
        self.first = (n - self.cells) // 2
        self.corner = self.first * cell
        self.span = self.cells * cell
        self.rain = Rain(
            rate, self.span, highest + ROOM * self.span, drops, wind, gravity=sea.conditions.gravity, seed=seed
        )
        self.rings = rings if cell <= COARSEST else 0.0
        self.width = WIDTH * cell
        self.splashes = np.full((SPLASHES, 4), -1.0, np.float32)
        self.next = 0
        self.rung = 0
        r = self.rain
        self.momentum = DENSITY * math.pi / 6.0 * float((r.diameter**3 * r.speed).mean())  # [kg m/s] of a drawn drop
        blow = DENSITY * self.width**2.5 * math.sqrt(sea.conditions.gravity) / BLOW  # [N s] a metre of depth
        self.drops_a_ring = self.rings * STEEPNESS * self.width * blow / self.momentum

    def fall(
        self, sea: Sea, t: float, dt: float, height: np.ndarray, displacement: np.ndarray | None, scale: float
    ) -> int:
        """Let it rain for dt [s] up to t [s] on the fields of t; returns how many rings were begun.

        height (n, n) [m], to be multiplied by `scale`; displacement (n, n, 2) [m].
        """
        part = slice(self.first, self.first + self.cells)
        below = np.ascontiguousarray(height[part, part]) * np.float32(scale)
        moved = None
        if displacement is not None:
            planes = np.ascontiguousarray(np.moveaxis(displacement[part, part], -1, 0))
            moved = np.moveaxis(planes, 0, -1)
        hits = self.rain.step(dt, below, moved)
        self.splash(hits, dt)
        if self.rings == 0.0 or not len(hits.label):
            return 0
        momentum = np.minimum(DENSITY * math.pi / 6.0 * hits.diameter**3 * hits.speed, LARGEST * self.momentum)
        sea.ripples.leak = LEAK
        sea.ripples.add(t, hits.label + self.corner, self.width, impulse=self.drops_a_ring * momentum)
        self.rung += len(hits.label)
        return len(hits.label)

    def splash(self, hits: Hits, dt: float) -> None:
        """Age the splashes and add the new ones over the oldest."""
        age = self.splashes[:, 3]
        age[age >= 0.0] += dt
        age[age > LASTING] = -1.0
        for place in hits.position[:SPLASHES]:
            self.splashes[self.next, :3] = place
            self.splashes[self.next, :2] += self.corner
            age[self.next] = 0.0
            self.next = (self.next + 1) % SPLASHES

    def frame(self) -> RainFrame:
        """The drops as they are now."""
        r = self.rain
        drops = r.position.T.astype(np.float32)
        drops[:, :2] += np.float32(self.corner)
        velocity = np.empty_like(drops)
        velocity[:, 0], velocity[:, 1] = r.wind
        velocity[:, 2] = -r.speed
        return RainFrame(drops, velocity, self.splashes.copy(), self.span)
