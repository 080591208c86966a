"""Waves that each band of a radial grid shows, and their sums at its vertices."""

import math

import numpy as np

from sim.ocean.fluids.slick import SlickCover
from sim.ocean.radial.radial_grid import RadialGrid
from sim.ocean.radial.wave_sum import Bands, Calm, VertexSums, add_waves, calm_waves, wave_rows
from sim.waves import Waves


class BandPlan:
    """The waves of one set of wavenumbers on one grid: the longest first, in pairs."""

    def __init__(self, grid: RadialGrid, k: np.ndarray) -> None:
        """k (n,) [rad/m]: of the waves that `sums` takes, in their order."""
        self.grid, self.order = grid, np.argsort(k, kind="stable")
        factors = grid.weights(k[self.order])
        weight = np.zeros((len(factors), len(k) + len(k) % 2), np.float32)
        weight[:, : len(k)] = factors
        count = (factors > 0.0).sum(axis=1)
        self.vertices = np.diff(grid.start.astype(np.int64))  # of each band
        self.bands = Bands(grid.x, grid.y, grid.start, (count + count % 2).astype(np.uint64), weight)
        self.evaluated = int((count * self.vertices).sum())  # (wave, vertex) pairs of one sum
        self.skipped = len(grid) * len(k) - self.evaluated

    def sums(
        self,
        waves: Waves,
        turns: np.ndarray,
        choppiness: float,
        centre: tuple[float, float],
        slick: tuple[SlickCover, np.ndarray] | None,
    ) -> VertexSums:
        """The sums at the vertices about `centre` (x, y) [m], whose mean level in place is that of still water.

        turns (n,): phases of the waves at the origin. slick: what calms the waves, and the loss (n,) [1/m] of each
        under it.
        """
        kx, ky, a = waves.kx[self.order], waves.ky[self.order], waves.amplitude[self.order]
        k = np.maximum(np.hypot(kx, ky), 1e-30)
        at_centre = turns[self.order] + (kx * centre[0] + ky * centre[1]) / (2.0 * math.pi)
        weight = self.bands.weight
        count = weight.shape[1]
        rows = wave_rows(kx, ky, at_centre, a, choppiness, count)
        sums = VertexSums(*np.zeros((8, len(self.grid)), np.float32))
        mean = 0.5 * choppiness * np.square(weight[:, : len(a)] * a) @ k
        sums.z[:] = np.repeat(mean, self.vertices)
        add_waves(self.bands, rows, sums)
        if slick is not None:
            cover, loss = slick
            place = np.zeros((3, count), np.float32)
            place[:, : len(k)] = kx / k, ky / k, loss[self.order]
            x, y, radius = np.array([*cover.centre, cover.radius]) - (*centre, 0.0)
            calm_waves(self.bands, rows, Calm(np.float32(x), np.float32(y), np.float32(radius), *place), sums)
        return sums
