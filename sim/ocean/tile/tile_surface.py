"""The interface of all seas (`any_sea.py`) for tiles: on a radial grid and at points.

The tile repeats every `length`, which is visible from high up; its shortest wave is two cells everywhere, however near
the viewer. Towards the horizon, where rings are wider apart than waves are long, the surface is lowered to the fraction
of the energy that the rings resolve.
"""

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from sim.jit import kernel
from sim.ocean.any_sea import RadialSurface, SurfaceAt
from sim.ocean.radial.radial_grid import FADE, RadialGrid
from sim.ocean.tile.query import bicubic, query, sample
from sim.validation import check_positions
from sim.water import Water
from sim.waves import Kinematics

if TYPE_CHECKING:
    from sim.ocean.nonlinear.surface import NonlinearSurface
    from sim.ocean.tile.surface import Surface

INSTANT = 1 / 60  # [s] between the three heights from which rise and acceleration are differences
REACH = 0.05  # [m] of the differences that give the slope at a point


class TileSurface:
    """The interface of all seas on a linear tile."""

    is_sum_of_waves = False

    # The last grid, the version of the sea, and the fraction of each point.
    _grid_shares: tuple[RadialGrid | None, int, np.ndarray] = None, 0, np.zeros(0, np.float32)

    def on(self: Any, grid: RadialGrid, t: float, centre: tuple[float, float] = (0.0, 0.0)) -> RadialSurface:
        """The sea on a grid about `centre` (x, y) [m] at time t [s]."""
        if self._grid_shares[:2] != (grid, self.version):
            k = np.hypot(self.k[:, None], self.k[None, :])
            share = shares(k.ravel(), self.energy_at(self.time).ravel(), grid)
            self._grid_shares = grid, self.version, share
        cell = self.length / self.size
        return sampled(self.surface(t), (cell, cell), self._grid_shares[2], grid, centre)

    @property
    def water(self: Any) -> Water:
        """The water that carries the waves, without its tension."""
        return self.conditions.water

    @property
    def layers(self: Any) -> tuple[tuple[float, float], ...]:
        """((density [kg/m3], inf),): one fluid."""
        return ((self.conditions.density, math.inf),)

    @property
    def mean_square_slope(self: Any) -> float:
        """Mean square slope expected of the tile: sum k^2 S dk^2."""
        k = np.hypot(self.k[:, None], self.k[None, :])
        return float((k**2 * self.energy_at(self.time)).sum())

    def at(self: Any, points: ArrayLike, t: float, size: ArrayLike = 0.0) -> SurfaceAt:
        """The sea above points (n, 2) [m] at time t [s]; `size` is not used, the tile has no shorter waves than its
        cells. Velocity is that of the water that is there now, acceleration that of the surface above the point."""
        where = check_positions("points", points)
        n = len(where)
        around = np.concatenate([where + REACH * np.array(d) for d in ((1, 0), (-1, 0), (0, 1), (0, -1))])
        east, west, north, south = self.height_at(around, t)[0].reshape(4, n)
        slope = np.column_stack([east - west, north - south]) / (2 * REACH)
        now, residual, label = query(self.surface(t), where)
        above, moved = [], []
        for instant in (-INSTANT, INSTANT):
            above.append(self.height_at(where, t + instant)[0])
            moved.append(particles(self.surface(t + instant), self.length / self.size, label))
        velocity = (moved[1] - moved[0]) / (2 * INSTANT)
        rise, acceleration = (above[1] - above[0]) / (2 * INSTANT), (above[1] - 2 * now + above[0]) / INSTANT**2
        return SurfaceAt(now, slope, velocity, acceleration, now.copy(), slope.copy(), rise, label, residual)

    def kinematics(self: Any, points: ArrayLike, t: float, stretching: str = "constant") -> Kinematics:
        """Velocity, acceleration and pressure of the water at points (n, 3) [m] at time t, by the sum over all waves.

        See `Waves.kinematics`, also for the errors raised. `waves_at(t).largest(n)` is faster for many points.
        """
        return self.waves_at(t).kinematics(points, t, stretching)


def shares(k: np.ndarray, energy: np.ndarray, grid: RadialGrid) -> np.ndarray:
    """Fraction (points,) float32 of the amplitude that the rings of a grid resolve: root of the energy in long waves.

    k [rad/m], energy: of n waves, (n,). Long enough are those of four cells.
    """
    order = np.argsort(k)
    below = np.concatenate([[0.0], np.cumsum(energy[order])])
    limit = 2.0 * math.pi / (0.5 * sum(FADE) * grid.spacing)
    found = below[np.searchsorted(k[order], limit)]
    bands = np.sqrt(found / max(float(below[-1]), 1e-30))
    return np.repeat(bands, np.diff(grid.start.astype(np.int64))).astype(np.float32)


def sampled(
    surface: "Surface | NonlinearSurface",
    cell: tuple[float, float],
    share: np.ndarray,
    grid: RadialGrid,
    centre: tuple[float, float],
) -> RadialSurface:
    """A tile's surface on a grid about `centre` [m]; cell [m] along x and y, share: see `shares`."""
    n = len(grid)
    vertices, slopes, jacobian = np.empty((n, 3), np.float32), np.empty((n, 2), np.float32), np.empty(n, np.float32)
    planes = [np.ascontiguousarray(f[..., i]) for f in (surface.displacement, surface.slope) for i in range(2)]
    sample_mesh(grid.x, grid.y, share, *centre, *cell, surface.mean_height, surface.height, *planes,
                vertices, slopes, jacobian)  # fmt: skip
    return RadialSurface(vertices, slopes, jacobian)


def particles(surface: "Surface", cell: float, label: np.ndarray) -> np.ndarray:
    """Displacement (n, 3) [m] of the water that rests at labels (n, 2) [m], by a surface of cells of `cell` [m]."""
    fields = (surface.displacement[..., 0], surface.displacement[..., 1], surface.height)
    out = np.empty((3, len(label)))
    for field, row in zip(fields, out, strict=True):
        sample(label, np.ascontiguousarray(field), cell, row)
    return out.T


@kernel
def sample_mesh(x, y, share, x0, y0, cell_x, cell_y, mean, height, dx, dy, sx, sy, vertices, slopes, jacobian):
    """The tile's fields at the points of a grid about (x0, y0), each lowered to its share, and the Jacobian.

    mean [m]: of the height; it is of second order, and falls with the square of the share.
    """
    for i in range(x.size):
        X, Y = x[i] + x0, y[i] + y0
        u, v, s = X / cell_x, Y / cell_y, share[i]
        a, xx, xy = bicubic(dx, u, v)
        b, yx, yy = bicubic(dy, u, v)
        vertices[i, 0], vertices[i, 1] = X + s * a, Y + s * b
        jacobian[i] = (1.0 + s * xx / cell_x) * (1.0 + s * yy / cell_y) - s * s * xy * yx / (cell_x * cell_y)
        vertices[i, 2] = s * (bicubic(height, u, v)[0] - mean) + s * s * mean
        slopes[i, 0] = s * bicubic(sx, u, v)[0]
        slopes[i, 1] = s * bicubic(sy, u, v)[0]
