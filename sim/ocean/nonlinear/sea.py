"""A periodic sea of nonlinear waves, by the high-order spectral method (see `expansion.py` for the equations).

Choose it where waves act on one another: groups that steepen, crests, rogue waves. `Sea` is cheaper and reaches any
time at once. Limits:
- Potential flow under a surface without overhangs: no overturning, no tension, no viscosity, level bottom.
- Steepness by order. The speed of a wave of k a = 0.3 is off by 1.4e-3 at order 3, 1e-4 at 5 and 1e-5 at 7; k a = 0.35
  needs order 7, k a = 0.4 breaks up.
- Short waves on high crests: the series in z diverges where k a of the shortest wave of the grid and the amplitude of
  the sea is above about 5. `breaking` damps what grows there.

    >>> from sim.ocean.nonlinear import stokes_wave
    >>> wave = stokes_wave(height=2.0, wavelength=100.0)
    >>> x = np.arange(64) * 200.0 / 64
    >>> sea = NonlinearSea(length=200.0, order=3, start=(wave.elevation(x), wave.potential(x)))
    >>> sea.surface(10.0).height.shape, sea.kinematics([[0.0, 0.0, -5.0]]).velocity.shape
    ((64, 1), (1, 3))
"""

import copy
import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sim.ocean.nonlinear.breaking import Eddies, tail_decay
from sim.ocean.nonlinear.expansion import Expansion
from sim.ocean.nonlinear.flow import Flow, set_heights
from sim.ocean.nonlinear.march import March, Propagator, propagate, real
from sim.ocean.nonlinear.padded_transforms import PaddedTransforms, Work
from sim.ocean.nonlinear.start import checked_size, free_waves, mean_wavenumber, resized, started
from sim.ocean.nonlinear.surface import NonlinearSurface
from sim.ocean.query import sample
from sim.ocean.radial import SurfaceAt
from sim.ocean.sea import Sea
from sim.validation import (
    argument_error,
    check_finite,
    check_kind,
    check_not_negative,
    check_number,
    check_positions,
    check_positive,
    is_whole_number,
)
from sim.waves import Kinematics, Waves

ORDERS = (1, 7)
FADE_POWER = 4  # of time in the fade-in
FADE_PERIODS = 10.0  # of the mean wave, by default when a linear sea starts
FADED = 40.0 ** (1.0 / FADE_POWER)  # times of the fade-in until the nonlinear part is whole to rounding
FIRST_STEP = 0.05  # periods of the mean wave


class SeaEnergy(NamedTuple):
    """Mean energy per area [J/m2] of a nonlinear sea. kinetic + potential + breaking = start + fade_in + error."""

    kinetic: float
    potential: float
    breaking: float  # lost so far to the damping of breaking waves
    fade_in: float  # brought so far by the fading in of the nonlinear terms
    error: float  # of the steps, since the fade-in ended


class NonlinearSea:
    """A tile of nonlinear sea that moves on in time, with the interface of `Sea` but for changes of the conditions.

    Fields (n, m): [i, j] is at x = i length_x/n, y = j length_y/m. Not for two threads at once. Methods that take a
    time advance to it; they raise what `advance` raises.
    """

    choppiness = 0.0  # the crests are sharp by themselves

    def __init__(
        self,
        size: int | tuple[int, int] | None = None,
        length: float | tuple[float, float] | None = None,
        order: int = 3,
        depth: float | None = None,
        start: Sea | Waves | tuple[ArrayLike, ArrayLike] | None = None,
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
        begin = started(start, size, length, water, check_finite("time", time, "s"))
        modes, u, self.conditions = begin.modes, begin.u, begin.conditions
        self.length, self.depth, self.gravity = modes.length, modes.depth, modes.gravity
        self.density = self.conditions.density
        self._modes, self._start_time = modes, begin.time

        k = mean_wavenumber(modes, u[0])
        period = 2.0 * math.pi / math.sqrt(self.gravity * k * math.tanh(min(k * self.depth, 100.0)))
        if fade is None:
            fade = FADE_PERIODS * period if begin.is_linear else 0.0
        self.fade = check_not_negative("fade", fade, "s")
        self._rtol = check_number("rtol", rtol, 1e-14, 0.1, "") if step is None else None
        chosen = FIRST_STEP * period if step is None else check_positive("step", step, "s")
        self.is_damped = breaking and self.order > 1
        self._eddy_scale = 2.0 * math.pi / period / k**2
        self._lost_before = self._lost = self._fade_in = 0.0
        self._is_faded = self.fade == 0.0
        self._begin(u, begin.time, chosen)
        self._begun = sum(self._energies())

    def _begin(self, u: np.ndarray, t: float, step: float) -> None:
        """Go on from spectra (2, rows, columns) at a time [s], with a first step [s]."""
        modes = self._modes
        self.size, self.transforms = modes.size, Work()
        self._first, self._first_time = u, t
        self._fields = PaddedTransforms((modes.size[1], modes.size[0]), len(modes.kx), self.transforms)
        self._expansion = Expansion(modes, self.order, self.transforms) if self.order > 1 else None
        self._propagator = Propagator(modes, tail_decay(modes) if self.is_damped else np.zeros_like(modes.k))
        self._eddies: Eddies | None = None
        self._march: March | None = None
        self._set_state(u, t)
        if self._expansion is not None:
            if self.is_damped:
                self._eddies = Eddies(self._expansion, self._eddy_scale)
            self._march = March(self._propagator, self._evaluate, t, u, step, self._rtol)

    def _set_state(self, u: np.ndarray, t: float) -> None:
        self._u, self._time = u, t
        self._rates: np.ndarray | None = None  # the whole ones of this time
        self._flow: Flow | None = None
        self._surface = NonlinearSurface(self._modes, self._fields, u[0], t)

    def __deepcopy__(self, memo: dict[int, Any]) -> "NonlinearSea":
        """An independent copy for the same thread, with shared transforms and constant arrays."""
        other = copy.copy(self)
        if self._march is not None:
            other._march = self._march.copied(other._evaluate)
        return other

    def resized(self, size: int | tuple[int, int]) -> "NonlinearSea":
        """The same sea at its time on another grid, but for waves that only one of the grids has.

        Raises ValueError for a size that is not allowed.
        """
        other = copy.copy(self)
        other._modes, u = resized(self._modes, self._u, checked_size(size))
        other._lost_before = self._lost
        other._begin(u, self._time, self._march.step if self._march else 1.0)
        return other

    def advance(self, t: float) -> None:
        """Move on to time t [s]. Raises ValueError for a time before the present one, DivergenceError if the waves
        become too steep for the method; the sea then stays at the last time that could be reached."""
        t = check_finite("t", t, "s")
        if t < self._time:
            raise argument_error("t", t, f"the time of the sea, {self._time:g} s, or later")
        faded = self._start_time + FADED * self.fade
        if not self._is_faded and t >= faded:
            self._move(faded)
            self._fade_in, self._is_faded = sum(self._energies()) + self._lost - self._begun, True
        if t > self._time:
            self._move(t)

    def surface(self, t: float) -> NonlinearSurface:
        """The surface at time t [s]; each field is computed when first read."""
        self.advance(t)
        return self._surface

    @property
    def time(self) -> float:
        """Time [s] of all fields."""
        return self._time

    @property
    def height(self) -> np.ndarray:
        """Elevation (n, m) [m] of the surface."""
        return self._surface.height

    @property
    def potential(self) -> np.ndarray:
        """Velocity potential (n, m) [m2/s] on the surface; its mean is 0."""
        return self._fields.field_of(self._u[1])

    @property
    def slope(self) -> np.ndarray:
        """Slope (n, m, 2) of the surface along x and y."""
        return self._surface.slope

    @property
    def rise(self) -> np.ndarray:
        """Rate (n, m) [m/s] at which the surface rises in place."""
        return self._fields.field_of(self._whole_rates()[0])

    @property
    def significant_height(self) -> float:
        """Hs = 4 sqrt(m0) [m], m0 the variance of the elevation."""
        eta = self._u[0].copy()
        eta[0, 0] = 0.0
        return 4.0 * math.sqrt(self._modes.mean_product(eta, eta))

    def significant_height_at(self, t: float) -> float:
        """The same at time t [s]."""
        self.advance(t)
        return self.significant_height

    @property
    def energy(self) -> SeaEnergy:
        """The energy account at the present time."""
        kinetic, potential = self._energies()
        change = kinetic + potential + self._lost - self._begun
        fade_in = self._fade_in if self._is_faded else change
        return SeaEnergy(kinetic, potential, self._lost, fade_in, change - fade_in)

    @property
    def steps(self) -> int:
        """Steps taken so far; 0 for a linear sea."""
        return self._march.steps if self._march else 0

    def height_at(self, points: ArrayLike, t: float, exact: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Height (n,) [m] of the surface above points (n, 2) [m] at time t [s], and a residual (n,) [m] of 0.

        Between grid points heights are bicubic; exact: the sum over all waves instead. Raises ValueError for another
        shape.
        """
        check_kind("exact", exact, bool, "True or False")
        where = check_positions("points", points)
        self.advance(t)
        height = np.empty(len(where))
        if exact:
            set_heights(where, self._u[0], self._modes.kx, self._modes.ky, height)
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

        They go on as linear waves; moorings take them, and `largest` picks a few.
        """
        self.advance(self._time if t is None else t)
        return free_waves(self._modes, self._u, self._time, self.conditions.water)

    def kinematics(self, points: ArrayLike, t: float | None = None) -> Kinematics:
        """The water at points (n, 3) [m], z up from still water, by the sum over all waves; see `flow.py`.

        t [s]: by default the present time. Above the surface is the water that is on it. The pressure is that beyond
        still water, -rho g z. Raises ValueError for another shape.
        """
        where = check_positions("points", points, 3)
        self.advance(self._time if t is None else t)
        if self._flow is None:
            self._flow = Flow(self._modes, self._expansion, self.density, self._u, self._whole_rates())
        return self._flow.at(where)

    def _cells(self, where: np.ndarray) -> np.ndarray:
        """Points (n, 2) [m] in cells of the grid."""
        return where * (np.array(self.size) / np.array(self.length))

    def _move(self, t: float) -> None:
        """The same as `advance` for a time that is allowed."""
        if self._march is not None:
            try:
                self._march.advance(t)
            finally:  # without the whole way: at the end of the last step
                t = min(t, self._march.end.t)
                self._lost = self._lost_before + self._march.lost(t)
                self._set_state(self._march.at(t), t)
        else:
            moved = np.empty_like(self._u)
            first = real(self._first)
            propagate(self._propagator.turn(t - self._first_time), first, first, 0.0, real(moved))
            self._set_state(moved, t)

    def _evaluate(self, t: float, u: np.ndarray, out: np.ndarray) -> float:
        """Set the nonlinear rates, and return the loss to breaking [J/m2/s]."""
        assert self._expansion is not None
        self._expansion.set_rates(u[0], u[1], out)
        faded = 1.0
        if not self._is_faded:
            faded = -math.expm1(-(((t - self._start_time) / self.fade) ** FADE_POWER))
        if self._eddies is None:
            out *= faded
            return 0.0
        return self.density * self._eddies.add_damping(u, faded, self._propagator.decay, out)

    def _whole_rates(self) -> np.ndarray:
        """Rates (2, rows, columns) of elevation and potential now, without damping and with all nonlinear terms."""
        if self._rates is None:
            rates = np.zeros_like(self._u)
            if self._expansion is not None:
                self._expansion.set_rates(self._u[0], self._u[1], rates)
            rates[0] += self._modes.k * self._modes.tanh * self._u[1]
            rates[1] -= self.gravity * self._u[0]
            self._rates = rates
        return self._rates

    def _energies(self) -> tuple[float, float]:
        """Kinetic and potential energy [J/m2]."""
        eta, psi = self._u
        kinetic = 0.5 * self.density * self._modes.mean_product(psi, self._whole_rates()[0])
        return kinetic, 0.5 * self.density * self.gravity * self._modes.mean_product(eta, eta)
