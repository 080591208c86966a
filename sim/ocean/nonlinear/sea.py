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
    >>> sea.advance(10.0)
    >>> sea.height.shape, sea.kinematics([[0.0, 0.0, -5.0]]).velocity.shape
    ((64, 1), (1, 3))
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sim.ocean.kinematics import Kinematics
from sim.ocean.nonlinear.breaking import Eddies, tail_decay
from sim.ocean.nonlinear.expansion import Expansion
from sim.ocean.nonlinear.flow import Flow
from sim.ocean.nonlinear.march import March, Propagator, propagate, real
from sim.ocean.nonlinear.padded_transforms import PaddedTransforms
from sim.ocean.nonlinear.start import mean_wavenumber, started
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

ORDERS = (1, 7)
FADE_POWER = 4  # of time in the fade-in
FADE_PERIODS = 10.0  # of the mean wave, by default when a linear sea starts
FADED = 40.0 ** (1.0 / FADE_POWER)  # times of the fade-in until the nonlinear part is whole to rounding
FIRST_STEP = 0.05  # periods of the mean wave


class Energy(NamedTuple):
    """Mean energy per area [J/m2] of a nonlinear sea. kinetic + potential + breaking = start + fade_in + error."""

    kinetic: float
    potential: float
    breaking: float  # lost so far to the damping of breaking waves
    fade_in: float  # brought so far by the fading in of the nonlinear terms
    error: float  # of the steps, since the fade-in ended


class NonlinearSea:
    """A tile of nonlinear sea at one time. Fields (n, m): [i, j] is at x = i length_x/n, y = j length_y/m."""

    def __init__(
        self,
        size: int | tuple[int, int] | None = None,
        length: float | tuple[float, float] | None = None,
        order: int = 3,
        depth: float | None = None,
        start: Sea | tuple[ArrayLike, ArrayLike] | None = None,
        gravity: float | None = None,
        density: float | None = None,
        fade: float | None = None,
        breaking: bool = True,
        step: float | None = None,
        rtol: float = 1e-6,
    ) -> None:
        """start: a linear `Sea`, from its time on and without its rings, or elevation [m] and surface potential [m2/s].

        Both arrays are (n, m), or (n,) for waves along x alone. size: cells (n, m) or one number for both, by default
        those of the start. length [m]: of both sides or (x, y). order: of nonlinearity, 1 to 7; 1 is linear. depth [m],
        gravity [m/s2], density [kg/m3]: those of the sea by default, else inf, 9.81 and 1025. fade [s]: nonlinear terms
        grow as 1 - exp(-(t/fade)^4) (Dommermuth 2000, Wave Motion 32:307); by default 10 mean periods after a linear
        sea, else 0: they act at once. breaking: damp waves that would break (`breaking.py`). step [s]: of all steps; by
        default the error of each stays below rtol of the waves' amplitude. Raises ValueError for a value that is not
        allowed, or is not that of a given sea.
        """
        if not is_whole_number(order) or not ORDERS[0] <= order <= ORDERS[1]:
            raise argument_error("order", order, f"a whole number from {ORDERS[0]} to {ORDERS[1]}")
        check_kind("breaking", breaking, bool, "True or False")
        self.order = int(order)
        time = start.time if isinstance(start, Sea) else 0.0
        water = {"depth": depth, "gravity": gravity, "density": density}
        modes, u, conditions = started(start, size, length, water)
        self._modes, self._time, self._start_time = modes, time, time
        self._first = self._u = u
        self.size, self.length, self.depth, self.gravity = modes.size, modes.length, modes.depth, modes.gravity
        self.density = conditions.density

        k = mean_wavenumber(modes, u[0])
        period = 2.0 * math.pi / math.sqrt(self.gravity * k * math.tanh(min(k * self.depth, 100.0)))
        if fade is None:
            fade = FADE_PERIODS * period if isinstance(start, Sea) else 0.0
        self.fade = check_not_negative("fade", fade, "s")
        rtol = check_number("rtol", rtol, 1e-14, 0.1, "")
        chosen = FIRST_STEP * period if step is None else check_positive("step", step, "s")
        self._fields = PaddedTransforms((modes.size[1], modes.size[0]), len(modes.kx))
        self._expansion = Expansion(modes, self.order) if self.order > 1 else None
        is_damped = breaking and self.order > 1
        self._propagator = Propagator(modes, tail_decay(modes) if is_damped else np.zeros_like(modes.k))
        self._eddies: Eddies | None = None
        self._march: March | None = None
        self._lost, self._fade_in, self._is_faded = 0.0, 0.0, self.fade == 0.0
        self._rates: tuple[float, np.ndarray] = math.nan, u  # time, and the whole rates then
        self._flow: tuple[float, Flow | None] = math.nan, None
        if self._expansion is not None:
            if is_damped:
                self._eddies = Eddies(self._expansion, 2.0 * math.pi / period / k**2)
            self._march = March(self._propagator, self._evaluate, time, u, chosen, rtol if step is None else None)
        self._begun = sum(self._energies())

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
        self._move(t)

    @property
    def time(self) -> float:
        """Time [s] of all fields."""
        return self._time

    @property
    def height(self) -> np.ndarray:
        """Elevation (n, m) [m] of the surface."""
        return self._fields.field_of(self._u[0])

    @property
    def potential(self) -> np.ndarray:
        """Velocity potential (n, m) [m2/s] on the surface; its mean is 0."""
        return self._fields.field_of(self._u[1])

    @property
    def slope(self) -> np.ndarray:
        """Slope (n, m, 2) of the surface along x and y."""
        modes = self._modes
        return np.stack([self._fields.field_of(1j * k * self._u[0]) for k in (modes.kx, modes.ky[:, None])], axis=-1)

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

    @property
    def energy(self) -> Energy:
        """The energy account at the present time."""
        kinetic, potential = self._energies()
        change = kinetic + potential + self._lost - self._begun
        fade_in = self._fade_in if self._is_faded else change
        return Energy(kinetic, potential, self._lost, fade_in, change - fade_in)

    @property
    def steps(self) -> int:
        """Steps taken so far; 0 for a linear sea."""
        return self._march.steps if self._march else 0

    @property
    def transforms(self) -> int:
        """Transforms run so far."""
        return self._fields.count + (self._expansion.transform_count if self._expansion else 0)

    def kinematics(self, points: ArrayLike) -> Kinematics:
        """The water at points (n, 3) [m], z up from still water, by the sum over all waves; see `flow.py`.

        Above the surface is the water that is on it. The pressure is that beyond still water, -rho g z. Raises
        ValueError for another shape.
        """
        where = check_positions("points", points, 3)
        made, flow = self._flow
        if flow is None or made != self._time:
            flow = Flow(self._modes, self._expansion, self.density, self._u, self._whole_rates())
            self._flow = self._time, flow
        return flow.at(where)

    def _move(self, t: float) -> None:
        """The same as `advance` for a time that is allowed."""
        if self._march is not None:
            try:
                self._march.advance(t)
            finally:  # without the whole way: at the end of the last step
                t = min(t, self._march.end.t)
                self._u, self._lost, self._time = self._march.at(t), self._march.lost(t), t
        else:
            moved = np.empty_like(self._u)
            first = real(self._first)
            propagate(self._propagator.turn(t - self._start_time), first, first, 0.0, real(moved))
            self._u, self._time = moved, t

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
        if self._rates[0] != self._time:
            rates = np.zeros_like(self._u)
            if self._expansion is not None:
                self._expansion.set_rates(self._u[0], self._u[1], rates)
            rates[0] += self._modes.k * self._modes.tanh * self._u[1]
            rates[1] -= self.gravity * self._u[0]
            self._rates = self._time, rates
        return self._rates[1]

    def _energies(self) -> tuple[float, float]:
        """Kinetic and potential energy [J/m2]."""
        eta, psi = self._u
        kinetic = 0.5 * self.density * self._modes.mean_product(psi, self._whole_rates()[0])
        return kinetic, 0.5 * self.density * self.gravity * self._modes.mean_product(eta, eta)
