"""Adapter that gives the FFT sea the interface of `RadialSea`: on a radial grid and at points, to compare the two.

The tile repeats every `length`, which is visible from high up; its shortest wave is two cells everywhere, however near
the viewer. Towards the horizon, where rings are wider apart than waves are long, the surface is lowered to the fraction
of the energy that the rings resolve.
"""

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from sim.jit import kernel
from sim.ocean.fluid_column import FluidColumn
from sim.ocean.medium import Medium
from sim.ocean.query import bicubic, sample
from sim.ocean.radial import RadialSurface, SurfaceAt
from sim.ocean.radial_grid import FADE, RadialGrid
from sim.ocean.sea import Sea
from sim.validation import check_positions

INSTANT = 1 / 60  # [s] between the three heights from which rise and acceleration are differences
REACH = 0.05  # [m] of the differences that give the slope at a point
STEPS = 12  # towards a label: where the surface does not nearly fold, each leaves half the miss or less


class TileSea:
    """A `Sea` with the methods of `RadialSea`."""

    def __init__(self, sea: Sea, past: Mapping[FluidColumn, float] | None = None) -> None:
        """past: the time [s] that the waves have spent on each medium, and decayed, as `RadialSea.past`."""
        self.sea = sea
        self._grid: RadialGrid | None = None
        self._share = np.zeros(0, np.float32)
        self._media: dict[FluidColumn, Medium] = {}
        for column, duration in (past or {}).items():
            self.expose(duration, column)

    def expose(self, duration: float, column: FluidColumn) -> None:
        """Let the waves decay at once as they would in `duration` [s] on a medium. Raises ValueError for a negative
        one."""
        medium = self._media.setdefault(column, Medium(decay=lambda k: column.roots(k)[1]))
        self.sea.expose(duration, medium)
        self._grid = None  # the shares of the grid's rings follow the energy

    def on(self, grid: RadialGrid, t: float, centre: tuple[float, float] = (0.0, 0.0)) -> RadialSurface:
        """The sea on a grid about `centre` (x, y) [m] at time t [s]."""
        if self._grid is not grid:
            self._share = np.repeat(self.shares(grid), np.diff(grid.start.astype(np.int64))).astype(np.float32)
            self._grid = grid
        surface = self.sea.surface(t)
        D, slope = surface.displacement, surface.slope
        n = len(grid)
        vertices, slopes = np.empty((n, 3), np.float32), np.empty((n, 2), np.float32)
        jacobian = np.empty(n, np.float32)
        cell = self.sea.length / self.sea.size
        sample_mesh(grid.x, grid.y, self._share, centre[0], centre[1], cell, surface.mean_height, surface.height,
                    D[..., 0], D[..., 1], slope[..., 0], slope[..., 1], vertices, slopes, jacobian)  # fmt: skip
        return RadialSurface(vertices, slopes, jacobian)

    def shares(self, grid: RadialGrid) -> np.ndarray:
        """Amplitude (bands,) that the rings can show: root of the energy in waves of enough cells."""
        energy = self.sea.energy_at(self.sea.time).ravel()
        k = np.hypot(self.sea.k[:, None], self.sea.k[None, :]).ravel()
        order = np.argsort(k)
        below = np.concatenate([[0.0], np.cumsum(energy[order])])
        limit = 2.0 * math.pi / (0.5 * sum(FADE) * grid.spacing)
        found = below[np.searchsorted(k[order], limit)]
        return np.sqrt(found / max(float(below[-1]), 1e-30))

    @property
    def significant_height(self) -> float:
        """Hs [m] of the amplitudes as drawn."""
        return self.sea.significant_height

    @property
    def mean_square_slope(self) -> float:
        """Mean square slope expected of the tile: sum k^2 S dk^2."""
        k = np.hypot(self.sea.k[:, None], self.sea.k[None, :])
        return float((k**2 * self.sea.energy_at(self.sea.time)).sum())

    def at(self, points: ArrayLike, t: float, size: ArrayLike = 0.0) -> SurfaceAt:
        """The sea above points (n, 2) [m] at time t [s]; `size` is not used, the tile has no shorter waves than its
        cells. Velocity is that of the water that is there now, acceleration that of the surface above the point."""
        where = check_positions("points", points)
        n = len(where)
        around = np.concatenate([where + REACH * np.array(d) for d in ((1, 0), (-1, 0), (0, 1), (0, -1), (0, 0))])
        height, residual = self.sea.height_at(around, t)
        east, west, north, south, now = height.reshape(5, n)
        slope = np.column_stack([east - west, north - south]) / (2 * REACH)
        cell, label = self.sea.length / self.sea.size, where.copy()
        D = self.sea.surface(t).displacement
        find_tile_labels(where, D[..., 0], D[..., 1], cell, label)
        above, moved = [], []
        for instant in (-INSTANT, INSTANT):
            above.append(self.sea.height_at(where, t + instant)[0])
            moved.append(self.particles(label, t + instant, cell))
        velocity = (moved[1] - moved[0]) / (2 * INSTANT)
        rise, acceleration = (above[1] - above[0]) / (2 * INSTANT), (above[1] - 2 * now + above[0]) / INSTANT**2
        return SurfaceAt(now, slope, velocity, acceleration, now.copy(), slope.copy(), rise, label,
                         residual[4 * n :])  # fmt: skip

    def particles(self, label: np.ndarray, t: float, cell: float) -> np.ndarray:
        """Displacement (n, 3) [m] at time t [s] of the water that rests at labels (n, 2) [m]."""
        surface = self.sea.surface(t)
        fields = (surface.displacement[..., 0], surface.displacement[..., 1], surface.height)
        out = np.empty((3, len(label)))
        for field, row in zip(fields, out, strict=True):
            sample(label, np.ascontiguousarray(field), cell, row)
        return out.T


@kernel
def find_tile_labels(points, dx, dy, cell, labels):
    """Set labels (n, 2) [m] of the resting surface that are displaced to points (n, 2) [m], by fixed-point steps."""
    for p in range(points.shape[0]):
        x, y = points[p, 0], points[p, 1]
        for _ in range(STEPS):
            x = points[p, 0] - bicubic(dx, labels[p, 0] / cell, labels[p, 1] / cell)[0]
            y = points[p, 1] - bicubic(dy, labels[p, 0] / cell, labels[p, 1] / cell)[0]
            labels[p, 0], labels[p, 1] = x, y


@kernel
def sample_mesh(x, y, share, x0, y0, cell, mean, height, dx, dy, sx, sy, vertices, slopes, jacobian):
    """The tile's fields at the points of a grid about (x0, y0), each lowered to its share, and the Jacobian.

    mean [m]: of the height; it is of second order, and falls with the square of the share.
    """
    for i in range(x.size):
        X, Y = x[i] + x0, y[i] + y0
        u, v, s = X / cell, Y / cell, share[i]
        a, xx, xy = bicubic(dx, u, v)
        b, yx, yy = bicubic(dy, u, v)
        vertices[i, 0], vertices[i, 1] = X + s * a, Y + s * b
        jacobian[i] = (1.0 + s * xx / cell) * (1.0 + s * yy / cell) - s * s * xy * yx / (cell * cell)
        vertices[i, 2] = s * (bicubic(height, u, v)[0] - mean) + s * s * mean
        slopes[i, 0] = s * bicubic(sx, u, v)[0]
        slopes[i, 1] = s * bicubic(sy, u, v)[0]
