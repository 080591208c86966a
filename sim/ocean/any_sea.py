"""The interface of all seas, for bodies, moorings and scenes.

Choose the sea by its waves: `Sea` and `NonlinearSea` fill a periodic tile, `RadialSea` is a sum of single waves. Code
that takes a sea takes an `AnySea` and asks nothing else of it. Times are in s; a nonlinear sea moves on to the time it
is asked for and does not go back.
"""

from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from sim.ocean.radial.radial_grid import RadialGrid
from sim.records import equal_to_itself
from sim.water import Water
from sim.waves import Kinematics, Waves


@equal_to_itself
class RadialSurface(NamedTuple):
    """The sea on a grid of n points at one moment."""

    vertices: np.ndarray  # (n, 3) float32 [m] from the origin of the sea
    slope: np.ndarray  # (n, 2) float32: dz/dx, dz/dy of the displaced surface
    jacobian: np.ndarray  # (n,) float32: below 0 the surface folds


@equal_to_itself
class SurfaceAt(NamedTuple):
    """The sea above n points at one moment, and the interface below it (if there is one, of mean height 0)."""

    height: np.ndarray  # (n,) [m]
    slope: np.ndarray  # (n, 2)
    # The motion of the water that is there now: of its waves, without their growth or decay. That of linear waves is
    # `kinematics` at z = 0 where this water rests, at `label`, whatever the choppiness.
    velocity: np.ndarray  # (n, 3) [m/s]
    acceleration: np.ndarray  # (n,) [m/s2], upwards
    interface: np.ndarray  # (n,) [m] about its mean
    interface_slope: np.ndarray  # (n, 2)
    interface_rise: np.ndarray  # (n,) [m/s]
    label: np.ndarray  # (n, 2) [m] the points of the resting surface that are there now
    residual: np.ndarray  # (n,) [m] horizontal miss, at rounding unless the surface folds


@runtime_checkable
class AnySea(Protocol):
    """A sea. Methods raise ValueError for points of another shape, and for points or times that are not allowed."""

    is_sum_of_waves: bool  # `waves_at` has few waves, and `at` their labels: forces on bodies are summed wave by wave

    @property
    def time(self) -> float:
        """Time [s] of the last evaluation, or of the last change if that is later."""
        ...

    @property
    def water(self) -> Water:
        """Depth, gravity and density of the fluid under the surface."""
        ...

    @property
    def layers(self) -> tuple[tuple[float, float], ...]:
        """(density [kg/m3], thickness [m]) of the fluids from the top, the last of thickness inf."""
        ...

    @property
    def significant_height(self) -> float:
        """Hs = 4 sqrt(m0) [m]."""
        ...

    def at(self, points: ArrayLike, t: float, size: ArrayLike = 0.0) -> SurfaceAt:
        """The surface above points (n, 2) [m]; size [m], one number or (n,): diameter over which waves are averaged,
        where they can be shorter than that."""
        ...

    def height_at(self, points: ArrayLike, t: float) -> tuple[np.ndarray, np.ndarray]:
        """Height (n,) [m] of the surface above points (n, 2) [m], and the residual (n,) [m]."""
        ...

    def kinematics(self, points: ArrayLike, t: float, stretching: str = "constant") -> Kinematics:
        """The water at points (n, 3) [m]; stretching of linear waves: see `Waves.kinematics`."""
        ...

    def waves_at(self, t: float | None = None) -> Waves:
        """Linear waves with this surface, as high as at time t [s], by default the sea's own."""
        ...

    def on(self, grid: RadialGrid, t: float, centre: tuple[float, float] = (0.0, 0.0)) -> RadialSurface:
        """The surface on a grid about `centre` (x, y) [m]."""
        ...
