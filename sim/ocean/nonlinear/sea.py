"""A periodic sea of nonlinear waves, by the high-order spectral method (see `expansion.py` for the equations).

Choose it for waves that interact: groups that steepen, crests, rogue waves. `Sea` is cheaper and reaches any
time at once. Limits:
- Potential flow under a surface without overhangs: no overturning, no tension, no viscosity, level bottom.
- Steepness by order. The speed of a wave of k a = 0.3 in deep water is off by 1.4e-3 at order 3, 1e-4 at 5 and 1e-5 at
  7; k a = 0.35 needs order 7, k a = 0.4 breaks up. An even order need not improve on the odd one below it.
- No growth by wind to replace what breaking takes. A sea of 10 m/s over 50 km loses 7.6 % of its Hs in 15 minutes.
- Energy drifts with the error of the steps: -1e-4 in 200 periods of k a = 0.2 at the default rtol.
- Short waves on high crests: the series in z diverges where k_max a exceeds about 5 (k_max: largest wavenumber of
  the grid, a: amplitude of the sea). `breaking` damps what grows there.

    >>> from sim.ocean.nonlinear import stokes_wave
    >>> wave = stokes_wave(height=2.0, wavelength=100.0)
    >>> x = np.arange(64) * 200.0 / 64
    >>> sea = NonlinearSea(length=200.0, order=3, start=(wave.elevation(x), wave.potential(x)))
    >>> sea.surface(10.0).height.shape, sea.kinematics([[0.0, 0.0, -5.0]]).velocity.shape
    ((64, 1), (1, 3))
"""

import copy
import dataclasses
import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from sim.ocean.any_sea import AnySea, RadialSurface, SurfaceAt
from sim.ocean.nonlinear.energy import EnergyBalance, SeaEnergy
from sim.ocean.nonlinear.equations import WaveEquations
from sim.ocean.nonlinear.fade_in import FadeIn
from sim.ocean.nonlinear.instant import NonlinearInstant
from sim.ocean.nonlinear.lattice_sum import parts_of, set_elevations
from sim.ocean.nonlinear.march import LinearMarch, March
from sim.ocean.nonlinear.padded_transforms import PaddedTransforms
from sim.ocean.nonlinear.starts.start import checked_size, free_waves, mean_wavenumber, resized, started
from sim.ocean.nonlinear.surface import NonlinearSurface
from sim.ocean.radial.radial_grid import RadialGrid
from sim.ocean.tile.query import sample
from sim.ocean.tile.sea import Sea
from sim.ocean.tile.tile_surface import sampled, shares
from sim.validation import (
    argument_error,
    check_choice,
    check_kind,
    check_number,
    check_positions,
    check_positive,
    is_whole_number,
)
from sim.water import Water
from sim.waves import STRETCHINGS, Kinematics, Waves

ORDERS = (1, 7)
FADE_PERIODS = 10.0  # of the mean wave, by default when a linear sea starts
FIRST_STEP = 0.05  # periods of the mean wave


class NonlinearSea(AnySea):
    """A tile of nonlinear sea that advances in time, with the interface of all seas (`sim.ocean.any_sea`).

    Fields (n, m): [i, j] is at x = i length_x/n, y = j length_y/m. Not for two threads at once. Methods that take a
    time advance to it; they raise what `advance` raises.
    """

    choppiness = 0.0  # the crests are already sharp
    is_sum_of_waves = False

    def __init__(
        self,
        size: int | tuple[int, int] | None = None,
        length: float | tuple[float, float] | None = None,
        order: int = 3,
        *,
        start: Sea | Waves | tuple[ArrayLike, ArrayLike],
        depth: float | None = None,
        gravity: float | None = None,
        density: float | None = None,
        fade: float | None = None,
        breaking: bool = True,
        step: float | None = None,
        rtol: float = 1e-6,
        time: float = 0.0,
    ) -> None:
        """start: a linear `Sea`, from its time on and without its rings; linear waves; or elevation [m] and surface
        potential [m2/s].

        Both arrays are (n, m), or (n,) for waves along x alone. size: cells (n, m) or one number for both, by default
        those of the start. length [m]: of both sides or (x, y). order: of nonlinearity, 1 to 7; 1 is linear. depth [m],
        gravity [m/s2], density [kg/m3]: those of the start by default, else inf, 9.81 and 1025. fade [s]: nonlinear
        terms grow as 1 - exp(-(t/fade)^4) (Dommermuth 2000, Wave Motion 32:307); by default 10 mean periods after a
        linear start, else 0: they act at once. breaking: damp waves that would break (`breaking.py`). step [s]: of all
        steps; by default the error of each stays below rtol of the waves' amplitude. time [s]: of the start, unless it
        is a sea. Raises ValueError for a value that is not allowed, or is not that of the given start.
        """
        if not is_whole_number(order) or not ORDERS[0] <= order <= ORDERS[1]:
            raise argument_error("order", order, f"a whole number from {ORDERS[0]} to {ORDERS[1]}")
        check_kind("breaking", breaking, bool, "True or False")
        self.order = int(order)
        water = {"depth": depth, "gravity": gravity, "density": density}
        begin = started(start, size, length, water, check_number("time", time, "s"))
        modes, u, self.conditions = begin.modes, begin.u, begin.conditions
        self.length = modes.length

        k = mean_wavenumber(modes, u[0])
        period = 2.0 * math.pi / float(self.water.omega(np.array(k)))
        if fade is None:
            fade = FADE_PERIODS * period if begin.is_linear else 0.0
        self.fade = check_number("fade", fade, "s", 0.0)
        tolerance = check_number("rtol", rtol, "", 1e-14, 0.1) if step is None else None
        chosen = FIRST_STEP * period if step is None else check_positive("step", step, "s")
        self.is_damped = breaking and self.order > 1
        eddy_scale = 2.0 * math.pi / period / k**2 if self.is_damped else None
        fade_in = FadeIn(begin.time, self.fade)
        equations = WaveEquations(modes, self.order, fade_in, eddy_scale)
        self._begin(equations, u, begin.time)
        self._march: March | LinearMarch
        if self.order == 1:
            self._march = LinearMarch(equations.propagator, begin.time, u)
        else:
            self._march = March(equations.propagator, equations.set_rates, begin.time, u, chosen, tolerance)
        self._balance = EnergyBalance(sum(self._now.energies), None if self.fade > 0.0 else 0.0)

    def _begin(self, equations: WaveEquations, u: np.ndarray, t: float) -> None:
        """Continue by the equations on a grid, from spectra (2, rows, columns) at time t [s]."""
        (n, m), columns = equations.modes.size, len(equations.modes.kx)
        self.size, self.transforms, self._equations = (n, m), equations.work, equations
        self._now = NonlinearInstant(equations, PaddedTransforms((m, n), columns, self.transforms), u, t)

    def __deepcopy__(self, memo: dict[int, Any]) -> "NonlinearSea":
        """An independent copy for the same thread, with shared transforms and constant arrays."""
        other = copy.copy(self)
        other._march = self._march.copied()
        return other

    def resized(self, size: int | tuple[int, int]) -> "NonlinearSea":
        """The same sea at its time on another grid; waves not representable on both are dropped.

        Raises ValueError for a size that is not allowed.
        """
        other, t = copy.copy(self), self.time
        modes, u = resized(self._equations.modes, self._now.u, checked_size(size))
        equations = self._equations.on_grid(modes)
        other._begin(equations, u, t)
        other._march = self._march.restarted(equations.propagator, equations.set_rates, t, u)
        other._balance = dataclasses.replace(self._balance, lost=self._balance.lost + self._march.lost(t))
        return other

    def advance(self, t: float) -> None:
        """Move on to time t [s]. Raises ValueError for a time before the present one, DivergenceError if the waves
        become too steep for the method; the sea then stays at the last time that could be reached."""
        t = check_number("t", t, "s")
        if t < self.time:
            raise argument_error("t", t, f"the time of the sea, {self.time:g} s, or later")
        faded = self._equations.fade_in.end
        if self._balance.fade_in is None and t >= faded:
            self._move(faded)
            self._balance = dataclasses.replace(self._balance, fade_in=self.energy.fade_in)
        if t > self.time:
            self._move(t)

    def surface(self, t: float) -> NonlinearSurface:
        """The surface at time t [s]; each field is computed when first read."""
        self.advance(t)
        return self._now.surface

    @property
    def time(self) -> float:
        """Time [s] of all fields."""
        return self._now.t

    @property
    def water(self) -> Water:
        """The water that carries the waves."""
        return self.conditions.water

    @property
    def layers(self) -> tuple[tuple[float, float], ...]:
        """((density [kg/m3], inf),): one fluid."""
        return ((self.conditions.density, math.inf),)

    @property
    def height(self) -> np.ndarray:
        """Elevation (n, m) [m] of the surface."""
        return self._now.surface.height

    @property
    def potential(self) -> np.ndarray:
        """Velocity potential (n, m) [m2/s] on the surface; its mean is 0."""
        return self._now.potential

    @property
    def slope(self) -> np.ndarray:
        """Slope (n, m, 2) of the surface along x and y."""
        return self._now.surface.slope

    @property
    def rise(self) -> np.ndarray:
        """Rate (n, m) [m/s] at which the surface rises in place."""
        return self._now.rise

    @property
    def significant_height(self) -> float:
        """Hs = 4 sqrt(m0) [m], m0 the variance of the elevation."""
        return self._now.significant_height

    def significant_height_at(self, t: float) -> float:
        """Hs [m] at time t [s]."""
        self.advance(t)
        return self.significant_height

    @property
    def energy(self) -> SeaEnergy:
        """The energy account at the present time."""
        return self._balance.account(*self._now.energies, self._march.lost(self.time))

    @property
    def steps(self) -> int:
        """Steps taken so far; 0 for a linear sea."""
        return self._march.steps

    def height_at(self, points: ArrayLike, t: float, exact: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Height (n,) [m] of the surface above points (n, 2) [m] at time t [s], and a residual (n,) [m] of 0.

        Between grid points heights are bicubic; exact: the sum over all waves instead. Raises ValueError for another
        shape.
        """
        check_kind("exact", exact, bool, "True or False")
        where = check_positions("points", points)
        self.advance(t)
        height, modes = np.empty(len(where)), self._equations.modes
        if exact:
            set_elevations(where, np.array(self.length), parts_of(self._now.u[0], modes.weight), height)
        else:
            sample(self._cells(where), self.height, 1.0, height)
        return height, np.zeros(len(where))

    def at(self, points: ArrayLike, t: float, size: ArrayLike = 0.0) -> SurfaceAt:
        """The sea above points (n, 2) [m] at time t [s], for bodies, as `RadialSea.at`: its water is there now.

        `size` is not used: the tile has no shorter waves than its cells.
        """
        height, residual = self.height_at(points, t)
        where = check_positions("points", points)
        slope, cells = np.empty((2, len(where))), self._cells(where)
        for axis in range(2):
            sample(cells, np.ascontiguousarray(self.slope[..., axis]), 1.0, slope[axis])
        flow, nothing = self.kinematics(np.column_stack([where, height])), np.zeros(len(where))
        return SurfaceAt(height, slope.T.copy(), flow.velocity, flow.acceleration[:, 2].copy(), nothing,
                         np.zeros((len(where), 2)), nothing.copy(), where, residual)  # fmt: skip

    def waves_at(self, t: float | None = None) -> Waves:
        """Linear waves with this elevation and potential at time t [s], by default the present one.

        They continue as linear waves; moorings take them, and `largest` selects a few.
        """
        self.advance(self.time if t is None else t)
        return free_waves(self._equations.modes, self._now.u, self.time)

    def on(self, grid: RadialGrid, t: float, centre: tuple[float, float] = (0.0, 0.0)) -> RadialSurface:
        """The sea on a grid about `centre` (x, y) [m] at time t [s]; it does not fold."""
        surface, waves = self.surface(t), self.waves_at(t)
        cell = (self.length[0] / self.size[0], self.length[1] / self.size[1])
        return sampled(surface, cell, shares(waves.k, np.square(waves.amplitude), grid), grid, centre)

    def kinematics(self, points: ArrayLike, t: float | None = None, stretching: str = "constant") -> Kinematics:
        """The water at points (n, 3) [m], z up from still water, by the sum over all waves; see `flow.py`.

        t [s]: by default the present time. Points above the surface, in crests and in troughs, have the values at it.
        This flow reaches its own surface, so that stretching has no effect. The pressure is that beyond still water,
        -rho g z. Raises ValueError for another shape or stretching.
        """
        where = check_positions("points", points, 3)
        check_choice("stretching", stretching, STRETCHINGS)
        self.advance(self.time if t is None else t)
        return self._now.flow.at(where)

    def _cells(self, where: np.ndarray) -> np.ndarray:
        """Points (n, 2) [m] in cells of the grid."""
        return where * (np.array(self.size) / np.array(self.length))

    def _move(self, t: float) -> None:
        """`advance` to a time that has been checked."""
        try:
            self._march.advance(t)
        finally:  # if it stopped early: at the end of the last step
            t = min(t, self._march.reached)
            self._now = self._now.moved_to(self._march.at(t), t)
