"""Rings and wakes: impulses added to spectral amplitudes and propagated exactly, with dispersion, tension and decay.

A ring is height(k, t) = e^(-gamma t) (even cos(omega t) + odd sin(omega t)) on the half plane of the sea's own
wavenumbers, so it costs one pass over the spectrum and no further transform, is stable at any step, and obeys the
sea's gravity, depth and tension (Cauchy and Poisson; Lamb, Hydrodynamics, Art. 238-241 and 255).

    >>> from sim.ocean import Sea
    >>> pond = Sea(64, 8.0, wind_speed=0.0, tension=0.073)
    >>> pond.ripples.add(0.0, [[4.0, 4.0]], width=0.2, volume=1e-3)  # [m], [m3]
    >>> round(float(pond.surface(0.0).height.max()), 4)  # [m]: volume/(2 pi width^2)
    0.004

Limits: the tile is periodic, so a ring that leaves comes back; `leak` is a uniform decay standing for what would have
left. A disturbance narrower than two cells is cut off by the grid and shows the cut as fine ringing.
"""

import copy
import math

import numpy as np
from numpy.typing import ArrayLike

from sim.dispersion import tanh_depth
from sim.jit import kernel
from sim.ocean.spectra import Conditions
from sim.ocean.tile.evolve import add_heights, shift_time
from sim.validation import argument_error, as_array, check_number, check_positions, check_positive

QUIET = 1e-6  # [m] root mean square height below which rings are dropped
EVALUATIONS_BETWEEN_CHECKS = 64


class Ripples:
    """The rings on one tile, made by `Sea.ripples`. Times are the sea's and do not run back before the last impulse."""

    def __init__(self, size: int, length: float, real: type[np.floating]) -> None:
        """size: cells a side; length [m]; real: float32 or float64."""
        self.size, self.length, self.real = size, length, real
        self.time = 0.0  # [s] at which even and odd are the height and its rate over omega
        self.version = 0  # counts changes of the state
        self.alive = False  # False: nothing but the mean is left, and no pass is made
        self.leak = 0.0  # [1/s] uniform decay of the amplitudes
        self.mean = 0.0  # [m] level raised by the volumes dropped so far
        self._even = np.zeros((size, size + 2), real)
        self._odd = np.zeros((size, size + 2), real)
        self._scratch = (np.empty(size, real), np.empty(size, real))
        self._checks = 0

    def __deepcopy__(self, memo: object) -> "Ripples":
        """An independent copy of the rings."""
        other = copy.copy(self)
        other._even, other._odd = self._even.copy(), self._odd.copy()
        return other

    def set_medium(self, t: float, k: np.ndarray, rate: np.ndarray, decay: np.ndarray, conditions: Conditions) -> None:
        """From time t [s] propagate with quarter planes k [rad/m], rate [turns/s] and decay [1/s]."""
        if self.alive:
            self.advance(t)
        self.time = t
        self._rate, self._fall = rate, (-decay).astype(self.real)
        # The response to an impulse, k tanh(kh)/(rho omega).
        omega = 2.0 * np.pi * rate
        tanh = tanh_depth(k, conditions.depth)
        push = np.divide(k * tanh, conditions.density * omega, out=np.zeros_like(omega), where=omega > 0.0)
        self._push = push.astype(self.real)

    def add(
        self, t: float, points: ArrayLike, width: ArrayLike, volume: ArrayLike = 0.0, impulse: ArrayLike = 0.0
    ) -> None:
        """Disturb the surface at time t [s], at points (n, 2) [m], each spread as a Gaussian of width [m].

        volume [m3]: put onto the surface at rest; its integral stays on the tile to rounding.
        impulse [N s]: pushed down onto the level surface within no time, as by a blow or by a weight during a step.
        width, volume and impulse are one number or one a point. Raises ValueError for shapes that do not fit, a width
        not above 0, anything not finite, or a time before that of the last change.
        """
        at = check_positions("points", points)
        n = len(at)
        widths, volumes, impulses = (
            _one_a_point(name, value, n) for name, value in (("width", width), ("volume", volume), ("impulse", impulse))
        )
        if n and not widths.min() > 0.0:
            raise argument_error("width", float(widths.min()), "a number above 0 m")
        if n == 0:
            return
        self.advance(t)
        self.version += 1
        shape = (n, self.size // 2)
        waves = [np.empty(shape, self.real) for _ in range(4)]
        dk = 2.0 * math.pi / self.length
        set_shapes(at[:, 0].copy(), widths, dk, waves[0], waves[1])
        set_shapes(at[:, 1].copy(), widths, dk, waves[2], waves[3])
        sums = [np.empty(self.size // 2, self.real) for _ in range(4)]
        ones = np.ones_like(self._push)
        if volumes.any():
            add_shapes(*waves, (volumes / self.length**2).astype(self.real), ones, *sums, self._even)
            self._even[0, 0] = self._even[0, 1] = 0.0
            self.mean += math.fsum(volumes) / self.length**2
            self.alive = True
        if impulses.any():
            # eta_t = k tanh(kh) phi with phi = -J/rho: odd = eta_t/omega = -push J
            add_shapes(*waves, (-impulses / self.length**2).astype(self.real), self._push, *sums, self._odd)
            self._odd[0, 0] = self._odd[0, 1] = 0.0
            self.alive = True

    def advance(self, t: float) -> None:
        """Bring the state to time t [s]. Raises ValueError for a time before that of the last change."""
        t = self.check_time(t)
        if self.alive and t != self.time:
            shift_time(self._even, self._odd, self._rate, self._fade(t), t - self.time, *self._scratch)
            self.version += 1
        self.time = t

    def add_quadrature(self, q: np.ndarray, t: float) -> None:
        """Add the rings to the spectrum of `TileHeights.quadrature` at time t [s]."""
        t = self.check_time(t)
        if self.alive:
            add_heights(self._odd, self._even, self._rate, self._fade(t), self.time - t, *self._scratch, q)

    def add_to(self, h: np.ndarray, t: float) -> None:
        """Add the rings at time t [s] to a half spectrum given as its real view (N, N + 2)."""
        t = self.check_time(t)
        if self.alive:
            self._checks += 1
            if self._checks % EVALUATIONS_BETWEEN_CHECKS == 0:
                self.advance(t)
                self.drop_if_quiet()
        if self.alive:
            add_heights(self._even, self._odd, self._rate, self._fade(t), t - self.time, *self._scratch, h)
        h[0, 0] += self.mean

    def drop_if_quiet(self) -> None:
        """Forget rings that are too low to be visible; the mean stays."""
        if self.rms < QUIET:
            self.clear()

    def clear(self, level: bool = False) -> None:
        """Forget the rings, and the level they raised too where `level`."""
        self._even[...] = self._odd[...] = 0.0
        self.alive = False
        self.version += 1
        if level:
            self.mean = 0.0

    def take_over(self, other: "Ripples") -> None:
        """Continue with the rings of another size of the same tile, as far as wavenumbers are shared."""
        half = min(self.size, other.size) // 2
        n = np.arange(1 - half, half)
        for mine, theirs in ((self._even, other._even), (self._odd, other._odd)):
            mine[n, : 2 * half] = theirs[n, : 2 * half]
        self.time, self.alive, self.mean, self.leak = other.time, other.alive, other.mean, other.leak
        self.version += 1

    @property
    def rms(self) -> float:
        """Root mean square height [m] of the rings at `time`, over a period: it only falls between impulses."""
        # Column 0 (ky = 0) holds both of a pair, the others one of two.
        squares = np.square(self._even, dtype=np.float64) + np.square(self._odd, dtype=np.float64)
        return math.sqrt(squares[:, 2:].sum() + 0.5 * squares[:, :2].sum())

    def _fade(self, t: float) -> np.ndarray:
        return np.exp((self._fall - self.real(self.leak)) * self.real(t - self.time))

    def check_time(self, t: float) -> float:
        """t [s] as a float. Raises ValueError for a time before that of the last change of the rings."""
        t = check_number("t", t, "s")
        if t < self.time and (self.alive or self.mean):
            raise argument_error("t", t, f"{self.time:g} s or later: rings cannot go back before the last impulse")
        check_number("leak", self.leak, "1/s", 0.0)
        return t


def gaussian_volume(depth: float, width: float) -> float:
    """Volume [m3] of a Gaussian of width [m] that is `depth` [m] high at its middle: 2 pi depth width^2."""
    return 2.0 * math.pi * depth * check_positive("width", width, "m") ** 2


def _one_a_point(name: str, value: ArrayLike, n: int) -> np.ndarray:
    array = as_array(name, value, f"one finite number, or {n} of them")
    if array.shape not in ((), (n,)) or not np.isfinite(array).all():
        raise argument_error(name, value, f"one finite number, or {n} of them")
    return np.ascontiguousarray(np.broadcast_to(array, (n,)))


@kernel(noalias=True)
def set_shapes(position, width, dk, cosine, sine):
    """cos(n dk x) and sin(n dk x), times exp(-(n dk a)^2/2), for each drop (rows) and n = 0 ... N/2 - 1.

    z_(n+1) = z_n e^(i dk x); exp(-b n^2) = g_n by g_(n+1) = g_n r_n, r_(n+1) = r_n exp(-2b).
    """
    for d in range(position.shape[0]):
        zr, zi = np.cos(dk * position[d]), np.sin(dk * position[d])
        b = 0.5 * (width[d] * dk) ** 2
        r, q = np.exp(-b), np.exp(-2.0 * b)
        c, s, g = 1.0, 0.0, 1.0
        for n in range(cosine.shape[1]):
            cosine[d, n], sine[d, n] = g * c, g * s
            c, s = c * zr - s * zi, s * zr + c * zi
            g *= r
            r *= q


@kernel(noalias=True)
def add_shapes(cx, sx, cy, sy, weight, filter, cc, cs, sc, ss, h):
    """h(k) += filter(|k|) sum over drops of weight e^(-i(kx x + ky y)); rows i and N - i differ by the sign of sx.

    cc, cs, sc, ss: scratch (N/2,).
    """
    half, n = cx.shape[1], h.shape[0]
    for i in range(half):
        for j in range(half):
            cc[j] = cs[j] = sc[j] = ss[j] = 0.0
        for d in range(cx.shape[0]):
            c, s = weight[d] * cx[d, i], weight[d] * sx[d, i]
            for j in range(half):
                cc[j] += c * cy[d, j]
                cs[j] += c * sy[d, j]
                sc[j] += s * cy[d, j]
                ss[j] += s * sy[d, j]
        for j in range(half):
            f = filter[i, j]
            h[i, 2 * j] += f * (cc[j] - ss[j])
            h[i, 2 * j + 1] -= f * (sc[j] + cs[j])
        if i > 0:
            for j in range(half):
                f = filter[i, j]
                h[n - i, 2 * j] += f * (cc[j] + ss[j])
                h[n - i, 2 * j + 1] += f * (sc[j] - cs[j])
