"""One steep wave of constant form, by Fourier series of the stream function: Rienecker and Fenton 1981, Fenton 1988.

Choose it as the start of a `NonlinearSea` or as a reference: the only approximation is the number of Fourier terms.
Limits: up to about 95 % of the highest wave; the nearer to it, the more terms are needed. No mean Eulerian current
(Stokes's first definition of the speed).

    >>> wave = stokes_wave(height=1.0, wavelength=50.0)
    >>> round(wave.speed, 4)  # [m/s]; 8.8355 of linear theory
    8.8529
    >>> crest, trough = wave.elevation([0.0, 25.0])  # [m]
    >>> round(float(crest - trough), 9)
    1.0

Sources: M. M. Rienecker, J. D. Fenton, J. Fluid Mech. 104:119 (1981); J. D. Fenton, Comput. Geosci. 14:357 (1988).
"""

import dataclasses
import math

import numpy as np
from numpy.typing import ArrayLike

from sim.validation import ConvergenceError, argument_error, as_array, check_positive, is_whole_number, read_only
from sim.water import EARTH_GRAVITY

ORDERS = (1, 60)
HIGHEST = 0.1412  # height over wavelength of the highest wave on deep water (Michell 1893)
MAX_NEWTON_ITERATIONS, TOLERANCE = 40, 1e-9  # convergence is quadratic: the next change would be lost in rounding
HEIGHT_STEP = 0.02  # of the height over the wavelength: each solution starts the search for the next
TINY = 1e-30  # imaginary part of a complex-step derivative


@dataclasses.dataclass(frozen=True, eq=False)
class StokesWave:
    """A wave of constant form with its crest at x = 0 at first; it travels to +x. Made by `stokes_wave`."""

    height: float  # [m] from trough to crest
    wavelength: float  # [m]
    depth: float  # [m], or inf
    gravity: float  # [m/s2]
    speed: float  # [m/s] of the form in water without a mean current
    cosines: np.ndarray  # (order + 1,) [m]: the elevation is sum cosines[j] cos(j k x)
    sines: np.ndarray  # (order,) [m2/s]: amplitudes of the potential, as in `depth_factors`

    @property
    def wavenumber(self) -> float:
        """k [rad/m]."""
        return 2.0 * math.pi / self.wavelength

    def elevation(self, x: ArrayLike, t: float = 0.0) -> np.ndarray:
        """Height [m] of the surface at x [m], any shape, at time t [s]; its mean is 0."""
        theta = self.wavenumber * (as_array("x", x, "numbers [m]") - self.speed * t)
        return np.cos(theta[..., None] * np.arange(len(self.cosines))) @ self.cosines

    def potential(self, x: ArrayLike, t: float = 0.0) -> np.ndarray:
        """Velocity potential [m2/s] on the surface at x [m], any shape, at time t [s]; its mean over x is not 0."""
        theta = self.wavenumber * (as_array("x", x, "numbers [m]") - self.speed * t)
        j = np.arange(1, len(self.cosines))
        C, _ = depth_factors(j, self.wavenumber * self.elevation(x, t)[..., None], self.wavenumber * self.depth)
        return (C * np.sin(j * theta[..., None])) @ self.sines


def stokes_wave(
    height: float, wavelength: float, depth: float = math.inf, order: int = 7, gravity: float = EARTH_GRAVITY
) -> StokesWave:
    """The wave of this height [m] and wavelength [m] on water of this depth [m] or inf; order: Fourier terms, 1 to 60.

    Raises ValueError for a value that is not allowed, as a height that no wave has, and ConvergenceError if Newton's
    method finds none: near the highest wave more terms are needed.
    """
    height = check_positive("height", height, "m")
    k = 2.0 * math.pi / check_positive("wavelength", wavelength, "m")
    kd = k * check_positive("depth", depth, "m", allow_infinite=True)
    gravity = check_positive("gravity", gravity, "m/s2")
    if not is_whole_number(order) or not ORDERS[0] <= order <= ORDERS[1]:
        raise argument_error("order", order, f"a whole number from {ORDERS[0]} to {ORDERS[1]}")
    limit = HIGHEST * wavelength * math.tanh(kd)
    if height >= limit:
        raise argument_error("height", height, f"below the highest wave, here about {limit:.3g} m")
    steps = math.ceil(height / wavelength / HEIGHT_STEP)
    z = linear_wave(k * height / steps, kd, order)
    for step in range(1, steps + 1):
        z = solved(z, k * height * step / steps, kd, order)
    n = np.arange(order + 1)
    ends = np.where((n == 0) | (n == order), 0.5, 1.0)
    cosines = 2.0 / order * ends * (np.cos(np.outer(n, n) * math.pi / order) @ (ends * z[: order + 1])) / k
    sines = z[order + 1 : -3] * math.sqrt(gravity / k**3)
    speed = float(z[-3]) * math.sqrt(gravity / k)
    return StokesWave(height, wavelength, depth, gravity, speed, read_only(cosines), read_only(sines))


def linear_wave(steepness: float, kd: float, order: int) -> np.ndarray:
    """Unknowns of a low wave (2 order + 4,), in units of 1/k and g: k eta at order + 1 points from crest to trough,
    B_j, the speed, the stream function of the surface, Bernoulli's constant. steepness: k times its height."""
    c = math.sqrt(math.tanh(kd))
    eta = 0.5 * steepness * np.cos(np.arange(order + 1) * math.pi / order)
    B = np.zeros(order)
    B[0] = 0.5 * steepness / c
    return np.concatenate([eta, B, [c, 0.0, 0.5 * c * c]])


def depth_factors(j: np.ndarray, z: np.ndarray, kd: float) -> tuple[np.ndarray, np.ndarray]:
    """cosh j(kd + z)/cosh j kd and sinh j(kd + z)/cosh j kd without overflow; e^(jz) in deep water."""
    q = np.exp(-2.0 * j * kd)
    up, down = np.exp(j * z), q * np.exp(-j * z)
    return (up + down) / (1.0 + q), (up - down) / (1.0 + q)


def residuals(z: np.ndarray, steepness: float, kd: float, order: int) -> np.ndarray:
    """The equations (2 order + 4,) of the unknowns; all 0 for the wave. z may be complex."""
    eta, B, (c, psi, R) = z[: order + 1], z[order + 1 : -3], z[-3:]
    j = np.arange(1, order + 1)
    theta = np.arange(order + 1)[:, None] * math.pi / order * j
    C, S = depth_factors(j, eta[:, None], kd)
    u, w = -c + (C * np.cos(theta)) @ (j * B), (S * np.sin(theta)) @ (j * B)
    stream = -c * eta + (S * np.cos(theta)) @ B - psi  # 0 on a streamline
    bernoulli = 0.5 * (u * u + w * w) + eta - R  # 0 at constant pressure
    mean = eta.sum() - 0.5 * (eta[0] + eta[-1])
    return np.concatenate([stream, bernoulli, [mean, eta[0] - eta[-1] - steepness]])


def solved(z: np.ndarray, steepness: float, kd: float, order: int) -> np.ndarray:
    """The unknowns by Newton's method from z, with derivatives by complex steps. Raises ConvergenceError."""
    left, count = math.nan, 0
    while count < MAX_NEWTON_ITERATIONS:
        count += 1
        value = residuals(z, steepness, kd, order)
        left = float(np.abs(value).max())
        slopes = [np.imag(residuals(z + 1j * TINY * unit, steepness, kd, order)) / TINY for unit in np.eye(len(z))]
        try:
            change = np.linalg.solve(np.array(slopes).T, -value)
        except np.linalg.LinAlgError:
            break
        z = z + change
        # Far from a solution the exponentials overflow.
        if not np.abs(z).max() < 10.0:
            break
        if np.abs(change).max() < TOLERANCE:
            return z
    raise ConvergenceError(
        f"wave of constant form, {order} terms, k H = {steepness:.4g}", f"a residual of {left:.3g}", count
    )
