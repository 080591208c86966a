"""The foam of the drawn mesh, and the waves' slope and frequency, from which it is expected."""

import math

import numpy as np
from numpy.typing import NDArray

from app.scenes.square_sea.foam_limit import FoamLimit
from app.scenes.square_sea.parameters import SquareSeaParams
from app.scenes.square_sea.tile_mesh import Fields, set_mesh_of
from sim.ocean import Sea
from sim.ocean.statistics.foam import slope_and_frequency

SLOPE_INTERVAL = 0.5  # [s] of simulated time between two calculations of the sea's slope and frequency


class WaveSlope:
    """Slope of the waves and the frequency at which it changes, recomputed now and then."""

    def __init__(self) -> None:
        self.slope = self.frequency = 0.0  # mean square, [rad/s]
        self.slope_left = 1.0  # fraction of the mean square slope that damping and a small height factor leave
        self.found_at = -math.inf  # [s]
        self.found_of: tuple[int, float] | None = None  # the waves that they are of, where these are steady

    def update(self, sea: Sea, t: float, amplitude: float) -> bool:
        """Find them at time t [s] if they are out of date; True if it was necessary."""
        if abs(t - self.found_at) < SLOPE_INTERVAL:
            return False
        waves = (sea.version, amplitude) if sea.is_steady(t) else None
        is_new = waves is None or waves != self.found_of
        if is_new:
            self.slope, self.frequency = slope_and_frequency(sea, t)
            self.slope_left = sea.slope_left(t) * min(amplitude, 1.0) ** 2
        self.found_at, self.found_of = t, waves
        return is_new


class MeshFoam:
    """Foam at the points of the mesh, which forms where the water is pressed together and fades."""

    def __init__(self, points: int) -> None:
        """points: along a side of the mesh."""
        self.values = np.zeros((points, points), np.float32)  # 0 to 1; another array after each change
        self.cover, self.limit = 0.0, FoamLimit()  # fraction of the mesh that is foam

    def make_mesh(
        self, fields: Fields, p: SquareSeaParams, dt: float, waves: WaveSlope, expected: float
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Vertices (n, n, 3) [m] and slopes (n, n, 2) of a sea, dt [s] after the last one, with its foam.

        expected: fraction of the sea that is foam.
        """
        n = len(self.values)
        full_depth = self.limit.update(p, dt, waves.slope, waves.frequency, expected, self.cover)
        vertices, slopes = np.empty((n, n, 3), np.float32), np.empty((n, n, 2), np.float32)
        self.values = self.values.copy()
        self.cover, self.limit.deviation = set_mesh_of(
            fields, p.amplitude, p.length, self.limit.value, full_depth, math.exp(-dt / p.foam_fade), vertices, slopes,
            self.values,
        )  # fmt: skip
        return vertices, slopes
