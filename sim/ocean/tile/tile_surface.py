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
from sim.ocean.tile.query import bicubic, evaluate_grid, grid_fields, query, sample
from sim.validation import check_positions
from sim.water import Water
from sim.waves import Kinematics

if TYPE_CHECKING:
    from sim.ocean.nonlinear.surface import NonlinearSurface
    from sim.ocean.tile.surface import Surface

LEAST_JACOBIAN = 0.1  # by which slopes are divided where the surface folds


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
        cells. Between grid points fields are bicubic, as those of `height_at`."""
        where, surface, cell = check_positions("points", points), self.surface(t), self.length / self.size
        height, residual, label = query(surface, where)
        fields = (*(f[..., i] for f in (surface.flow, surface.slope) for i in range(2)), surface.rise, surface.lift)
        samples = np.empty((6, len(where)))
        for field, row in zip(fields, samples, strict=True):
            sample(label, np.ascontiguousarray(field), cell, row)
        u, v, hx, hy, w, acceleration = samples
        slope, velocity = np.column_stack([hx, hy]), np.column_stack([u, v, w])
        if surface.choppiness > 0.0:
            turn_slopes(label, grid_fields(surface), slope)
        rise = w - (velocity[:, :2] * slope).sum(axis=1)
        return SurfaceAt(height, slope, velocity, acceleration.copy(), height.copy(), slope.copy(), rise,
                         label, residual)  # fmt: skip

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
    long_energy = below[np.searchsorted(k[order], limit)]
    bands = np.sqrt(long_energy / max(float(below[-1]), 1e-30))
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


@kernel
def turn_slopes(labels, fields, slope):
    """Turn slopes (n, 2) by label into those of the displaced surface: (dz/dx, dz/dy) (I + grad D) = slope."""
    for p in range(labels.shape[0]):
        _, _, _, xx, xy, yx, yy = evaluate_grid(fields, p, labels[p, 0], labels[p, 1])
        hx, hy = slope[p, 0], slope[p, 1]
        inverse = 1.0 / max((1.0 + xx) * (1.0 + yy) - xy * yx, LEAST_JACOBIAN)
        slope[p, 0], slope[p, 1] = ((1.0 + yy) * hx - yx * hy) * inverse, ((1.0 + xx) * hy - xy * hx) * inverse


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
