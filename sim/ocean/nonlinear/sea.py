"""A periodic sea of nonlinear waves, by the high-order spectral method (see `expansion.py` for the equations).

Choose it where waves steepen one another: groups, crests, rogue waves. `Sea` is cheaper and reaches any time at once.
Limits: potential flow without overturning; a surface without overhangs; no tension, no viscosity. A single wave can be
followed to k a = 0.4 at order 7, 0.35 at order 5, 0.3 at order 3; a sea to about k_p Hs/2 = 0.2, beyond which breaking
takes the excess. The shortest wave of the grid should be no shorter than 1/(3 Hs) times ... of Taylor's series.

    >>> wave = stokes_wave(height=2.0, wavelength=100.0)
    >>> x = np.arange(64) * 200.0 / 64
    >>> sea = NonlinearSea(length=200.0, order=3, start=(wave.elevation(x), wave.potential(x)))
    >>> sea.advance(10.0)
    >>> sea.height.shape, sea.kinematics([[0.0, 0.0, -5.0]]).velocity.shape
    ((64, 1), (1, 3))
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sim.ocean.kinematics import Kinematics
from sim.ocean.medium import Medium
from sim.ocean.nonlinear.breaking import Eddies, tail_decay
from sim.ocean.nonlinear.expansion import Expansion
from sim.ocean.nonlinear.flow import Flow
from sim.ocean.nonlinear.march import March, Propagator, propagate, real
from sim.ocean.nonlinear.modes import Modes, field_of, make_modes, spectrum_of
from sim.ocean.sea import LENGTHS, SIZES, Sea
from sim.validation import (
    argument_error,
    as_array,
    check_finite,
    check_kind,
    check_not_negative,
    check_number,
    check_positions,
    check_positive,
    is_whole_number,
)

ORDERS = (1, 7)
FADE_POWER = 4  # of time in the fade-in (Dommermuth 2000, eq. 19)
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
        """start: a linear `Sea`, whose waves begin at its time, or elevation [m] and surface potential [m2/s].

        Both arrays are (n, m), or (n,) for waves along x alone. size: cells (n, m) or one number for both, by default
        those of the start. length [m]: of both sides or (x, y); that of a sea by default. order: of the
        nonlinearity, 1 to 7; 1 is linear. depth [m], gravity [m/s2], density [kg/m3]: those of the sea by default, else
        inf, 9.81 and 1025. fade [s]: the nonlinear terms grow as 1 - exp(-(t/fade)^4) (Dommermuth 2000); by default 10
        mean periods after a linear sea, else 0, at once. breaking: damp waves that would break. step [s]: of all steps;
        by default steps keep their error below rtol of the waves' amplitude. Raises ValueError for a value that is not
        allowed, or another length, depth or gravity than that of a given sea.
        """
        if not is_whole_number(order) or not ORDERS[0] <= order <= ORDERS[1]:
            raise argument_error("order", order, f"a whole number from {ORDERS[0]} to {ORDERS[1]}")
        check_kind("breaking", breaking, bool, "True or False")
        self.order = int(order)
        time = start.time if isinstance(start, Sea) else 0.0
        modes, u, self.density = started(start, size, length, depth, gravity, density)
        self._modes, self._time, self._start_time = modes, time, time
        self._first = self._u = u
        self.size, self.length, self.depth, self.gravity = modes.size, modes.length, modes.depth, modes.gravity

        k = mean_wavenumber(modes, u[0])
        period = 2.0 * math.pi / math.sqrt(self.gravity * k * math.tanh(min(k * self.depth, 100.0)))
        if fade is None:
            fade = FADE_PERIODS * period if isinstance(start, Sea) else 0.0
        self.fade = check_not_negative("fade", fade, "s")
        rtol = check_number("rtol", rtol, 1e-14, 0.1, "")
        chosen = FIRST_STEP * period if step is None else check_positive("step", step, "s")
        self._expansion = Expansion(modes, self.order) if self.order > 1 else None
        is_damped = breaking and self.order > 1
        self._propagator = Propagator(modes, tail_decay(modes) if is_damped else np.zeros_like(modes.k))
        self._eddies: Eddies | None = None
        self._march: March | None = None
        self._fade_in, self._is_faded = 0.0, self.fade == 0.0
        self._rates: tuple[float, np.ndarray] = math.nan, u  # time, and the whole rates then
        self._flow: tuple[float, Flow | None] = math.nan, None
        if self._expansion is not None:
            if is_damped:
                self._eddies = Eddies(self._expansion, 2.0 * math.pi / period / k**2)
            self._nonlinear = np.empty_like(u)
            self._march = March(self._propagator, self._evaluate, time, u, chosen, rtol if step is None else None)
        self._begun = sum(self._energies())

    def advance(self, t: float) -> None:
        """Move on to time t [s]. Raises ValueError for a time before the present one, DivergenceError if the waves
        become too steep for the method; the sea then stays at its last time."""
        t = check_finite("t", t, "s")
        if t < self._time:
            raise argument_error("t", t, f"the time of the sea, {self._time:g} s, or later")
        faded = self._start_time + FADED * self.fade
        if not self._is_faded and t >= faded:
            self._move(faded)
            self._fade_in, self._is_faded = sum(self._energies()) + self._lost() - self._begun, True
        self._move(t)

    @property
    def time(self) -> float:
        """Time [s] of all fields."""
        return self._time

    @property
    def height(self) -> np.ndarray:
        """Elevation (n, m) [m] of the surface."""
        return field_of(self._u[0])

    @property
    def potential(self) -> np.ndarray:
        """Velocity potential (n, m) [m2/s] on the surface; its mean is 0."""
        return field_of(self._u[1])

    @property
    def slope(self) -> np.ndarray:
        """Slope (n, m, 2) of the surface along x and y."""
        modes = self._modes
        return np.stack([field_of(1j * k * self._u[0]) for k in (modes.kx[None, :], modes.ky[:, None])], axis=-1)

    @property
    def rise(self) -> np.ndarray:
        """Rate (n, m) [m/s] at which the surface rises in place."""
        return field_of(self._whole_rates()[0])

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
        lost = self._lost()
        change = kinetic + potential + lost - self._begun
        fade_in = self._fade_in if self._is_faded else change
        return Energy(kinetic, potential, lost, fade_in, change - fade_in)

    @property
    def steps(self) -> int:
        """Steps taken so far; 0 for a linear sea."""
        return self._march.steps if self._march else 0

    @property
    def transforms(self) -> int:
        """Transforms run so far."""
        return self._expansion.transform_count if self._expansion else 0

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
            self._march.advance(t)
            self._u = self._march.at(t)
        else:
            moved = np.empty_like(self._u)
            first = real(self._first)
            propagate(self._propagator.turn(t - self._start_time), first, first, 0.0, real(moved))
            self._u = moved
        self._time = t

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

    def _lost(self) -> float:
        """Energy [J/m2] lost to breaking so far."""
        return self._march.lost(self._time) if self._march else 0.0


def started(
    start: object, size: object, length: object, depth: object, gravity: object, density: object
) -> tuple[Modes, np.ndarray, float]:
    """Waves, spectra (2, rows, columns) and density [kg/m3] of a start; arguments as of `NonlinearSea`."""
    if isinstance(start, Sea):
        own = start.conditions
        if start.medium != Medium() or own.tension != 0.0:
            raise argument_error("start", start, "a sea without tension, viscosity, film or a dispersion of its own")
        wanted = (start.length, start.length)
        for name, given, value in (("depth", depth, own.depth), ("gravity", gravity, own.gravity)):
            if given is not None and given != value:
                raise argument_error(name, given, f"that of the sea it starts from, {value:g}")
        if length is not None and pair("length", length) != wanted:
            raise argument_error("length", length, f"that of the sea it starts from, {start.length:g} m")
        cells = checked_size(start.size if size is None else size)
        modes = make_modes(cells, wanted, own.depth, own.gravity)
        return modes, linear_start(start, modes), own.density if density is None else check_density(density)
    allowed = "a Sea, or elevation and potential, two finite arrays (n, m) or (n,) of one shape"
    if not isinstance(start, tuple | list) or len(start) != 2:
        raise argument_error("start", start, allowed)
    elevation, potential = (as_array("start", field, allowed) for field in start)
    if elevation.shape != potential.shape or elevation.ndim not in (1, 2):
        raise argument_error("start", (elevation.shape, potential.shape), allowed)
    if not (np.isfinite(elevation).all() and np.isfinite(potential).all()):
        raise argument_error("start", start, allowed)
    fields = [field.reshape(len(elevation), -1) for field in (elevation, potential)]
    shape = checked_size(fields[0].shape)
    if size is not None and checked_size(size) != shape:
        raise argument_error("size", size, f"that of the arrays, {shape}")
    sides = pair("length", length)
    depth = math.inf if depth is None else check_positive("depth", depth, "m", allow_infinite=True)
    gravity = 9.81 if gravity is None else check_positive("gravity", gravity, "m/s2")
    u = np.array([spectrum_of(field) for field in fields])
    u[1, 0, 0] = 0.0  # a constant of the potential moves nothing
    return make_modes(shape, sides, depth, gravity), u, check_density(1025.0 if density is None else density)


def check_density(density: object) -> float:
    """`density` as a float. Raises ValueError unless it is above 0."""
    return check_positive("density", density, "kg/m3")


def checked_size(size: Any) -> tuple[int, int]:
    """`size` as cells along x and y. Raises ValueError otherwise."""
    low, high = SIZES
    allowed = f"even whole numbers (n, m), n from {low} to {high}, m from 4 to {high} or 1, or one number for both"
    cells = (size, size) if is_whole_number(size) else size
    if not isinstance(cells, tuple | list) or len(cells) != 2 or not all(is_whole_number(c) for c in cells):
        raise argument_error("size", size, allowed)
    n, m = (int(c) for c in cells)
    if n % 2 or not low <= n <= high or (m != 1 and (m % 2 or not 4 <= m <= high)):
        raise argument_error("size", size, allowed)
    return n, m


def pair(name: str, value: object) -> tuple[float, float]:
    """One length or two as two [m]. Raises ValueError otherwise."""
    sides = value if isinstance(value, tuple | list) else (value, value)
    if len(sides) != 2:
        raise argument_error(name, value, "one length or two, along x and y")
    return check_number(name, sides[0], *LENGTHS, "m"), check_number(name, sides[1], *LENGTHS, "m")


def linear_start(sea: Sea, modes: Modes) -> np.ndarray:
    """Spectra (2, rows, columns) of elevation and potential at z = 0 of a linear sea at its time, without its rings.

    Waves that only one of the two grids has are left out.
    """
    waves = sea.components(sea.time)
    n, m = modes.size
    i, j = (np.rint(k * (sea.length / (2.0 * math.pi))).astype(int) for k in (waves.kx, waves.ky))
    # a cos(k.x - omega t + 2 pi phase), and its potential (g/omega) a sin(...)
    wave = 0.5 * waves.amplitude * np.exp(1j * (2.0 * math.pi * waves.phase - waves.omega * sea.time))
    spectra = wave, -1j * modes.gravity / waves.omega * wave
    u = np.zeros((2, m, n // 2), complex)
    there = (np.abs(i) < n // 2) & (np.abs(j) < max(m // 2, 1))
    for field, values in zip(u, spectra, strict=True):
        # A real field has the conjugate at -k; the half plane has kx >= 0.
        for column, row, value in ((i, j, values), (-i, -j, values.conj())):
            inside = there & (column >= 0)
            np.add.at(field, (row[inside], column[inside]), value[inside])
    return u


def mean_wavenumber(modes: Modes, eta: np.ndarray) -> float:
    """Mean wavenumber [rad/m] by energy; the smallest of the tile for still water."""
    weight = (np.abs(eta) ** 2 * modes.weight) * (modes.k > 0.0)
    smallest = 2.0 * math.pi / max(modes.length)
    return max(float((weight * modes.k).sum() / weight.sum()), smallest) if weight.sum() > 0.0 else smallest
