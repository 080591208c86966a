"""Steps in time of nonlinear waves: only the nonlinear part is integrated, and the linear part is exact.

In the interaction picture, v = E(-t) u with E the linear evolution, linear waves stand still. The classical method of
Runge and Kutta, order 4, integrates the rest. One more evaluation at the end of a step, the first of the next, gives a
solution of order 3, and the difference h/10 (k_4 - k_5) controls the step (Balac and Mahe 2013, Comput. Phys. Commun.
184:1211). Steps run freely past the requested times; Hermite's cubic in the interaction picture interpolates.
"""

import copy
import dataclasses
import math
from collections.abc import Callable

import numpy as np

from sim.interruption import raise_if_stopped
from sim.jit import kernel
from sim.ocean.nonlinear.modes import Modes
from sim.validation import DivergenceError

SAFETY, SHRINK, GROW = 0.9, 0.2, 2.0
SMALLEST = 1e-6  # step over the first one, below which the search is given up
MAX_GROWTH = 1.2  # of the linear energy's root since the start: it is nearly conserved, and more is no solution

Rates = Callable[[float, np.ndarray, np.ndarray], float]  # (t, u, out): sets nonlinear rates, returns the loss


@dataclasses.dataclass
class End:
    """One end of a step."""

    t: float  # [s]
    u: np.ndarray  # (2, rows, columns) spectra of elevation [m] and potential [m2/s]
    rate: np.ndarray  # the nonlinear rates of both
    power: float  # rate of the loss to breaking [J/m2/s]
    lost: float  # [J/m2] so far


class Propagator:
    """Linear evolution over a time: each wave turns by omega t and decays by exp(-decay t)."""

    def __init__(self, modes: Modes, decay: np.ndarray) -> None:
        """decay (rows, columns) [1/s]."""
        self.modes, self.decay = modes, decay
        self._ratio = modes.omega / modes.water.gravity
        self._inverse = np.divide(1.0, self._ratio, out=np.zeros_like(self._ratio), where=self._ratio > 0.0)
        self._latest: tuple[float, np.ndarray] = math.nan, np.empty(0)

    def table(self, t: float) -> np.ndarray:
        """(3, rows, columns): factors of elevation and potential over a time t >= 0. Kept until another t."""
        if self._latest[0] != t:
            self._latest = t, self.turn(t) * np.exp(-self.decay * t)
        return self._latest[1]

    def turn(self, t: float) -> np.ndarray:
        """The same without decay, for any t."""
        # eta' = cos eta + (omega/g) sin psi, psi' = cos psi - (g/omega) sin eta
        sine = np.sin(self.modes.omega * t)
        return np.array([np.cos(self.modes.omega * t), self._ratio * sine, self._inverse * sine])

    def distance(self, u: np.ndarray, v: np.ndarray) -> float:
        """Root of the linear energy of a difference, as an amplitude [m]."""
        return math.sqrt(square_distance(real(u), real(v), self._ratio, self.modes.weight))


class March:
    """The steps of one sea."""

    def __init__(
        self, propagator: Propagator, rates: Rates, t: float, u: np.ndarray, step: float, rtol: float | None
    ) -> None:
        """rates(t, u, out): sets the nonlinear rates and returns the loss [J/m2/s]. step [s]: of all steps, or the
        first one if their error is to be rtol of the waves' amplitude."""
        self.propagator, self.rates, self.step, self.rtol = propagator, rates, step, rtol
        self.smallest = SMALLEST * step
        self.steps = self.evaluations = 0
        self._k = np.empty((3, *u.shape), complex)
        self._u = np.empty((2, *u.shape), complex)
        self._still = np.zeros_like(u)
        self._largest = MAX_GROWTH * propagator.distance(u, self._still)
        self.start, self.end, self._new = (End(t, u.copy(), np.zeros_like(u), 0.0, 0.0) for _ in range(3))
        self.end.power = self._evaluate(t, self.end.u, self.end.rate)

    def copied(self) -> "March":
        """An independent copy for the same thread: it shares arrays that are set before they are read."""
        other = copy.copy(self)
        # The third too: it is the end of the next step.
        other.start, other.end, other._new = (
            dataclasses.replace(end, u=end.u.copy(), rate=end.rate.copy()) for end in (self.start, self.end, self._new)
        )
        return other

    def restarted(self, propagator: Propagator, rates: Rates, t: float, u: np.ndarray) -> "March":
        """A march on another grid, with the step that this one would take next."""
        return March(propagator, rates, t, u, self.step, self.rtol)

    @property
    def reached(self) -> float:
        """End [s] of the last step."""
        return self.end.t

    def advance(self, t: float) -> None:
        """Step until the last step ends at t [s] or later. Raises DivergenceError, see `NonlinearSea.advance`."""
        # Where the waves diverge, the numbers overflow before the step is refused.
        with np.errstate(over="ignore", invalid="ignore"):
            while self.end.t < t:
                raise_if_stopped()
                self._take_step()

    def at(self, t: float) -> np.ndarray:
        """Spectra (2, rows, columns) at a time t [s] within the last step."""
        if t == self.end.t:
            return self.end.u.copy()
        h = self.end.t - self.start.t
        s = (t - self.start.t) / h
        spectra = np.zeros_like(self.end.u)
        weights = ((1 + 2 * s) * (1 - s) ** 2, s * (1 - s) ** 2), (s * s * (3 - 2 * s), s * s * (s - 1))
        for end, (value, slope) in zip((self.start, self.end), weights, strict=True):
            rate = end.rate - self.propagator.decay * end.u
            propagate(self.propagator.turn(t - end.t), value * real(end.u), real(rate), h * slope, real(self._u[0]))
            spectra += self._u[0]
        return spectra

    def lost(self, t: float) -> float:
        """Energy [J/m2] lost to breaking until a time t [s] within the last step."""
        a, b = self.start, self.end
        if t == b.t:
            return b.lost
        h = b.t - a.t
        s = (t - a.t) / h
        slopes = h * s * (1 - s) * ((1 - s) * a.power - s * b.power)
        return a.lost + (b.lost - a.lost) * s * s * (3 - 2 * s) + slopes

    def _evaluate(self, t: float, u: np.ndarray, out: np.ndarray) -> float:
        self.evaluations += 1
        return self.rates(t, u, out)

    def _take_step(self) -> None:
        """One step that keeps the tolerance."""
        while True:
            h = self.step
            new, error = self._tried(h)
            size = self.propagator.distance(new.u, self._still)
            bound = self.rtol * size if self.rtol is not None else math.inf
            # Written so that a NaN fails both.
            is_sane = size <= self._largest
            if self.rtol is not None:
                ratio = error / bound if bound > 0.0 else 0.0
                factor = min(GROW, SAFETY * ratio**-0.25) if ratio > 0.0 else GROW
                self.step = h * (max(SHRINK, factor) if is_sane and factor > 0.0 else SHRINK)
            if is_sane and error <= bound:
                break
            if self.rtol is None or self.step < self.smallest:
                raise DivergenceError(
                    f"the solution fails after t = {self.end.t:.6g} s: the waves are too steep for this order; use "
                    "lower waves, a lower order or a coarser grid"
                )
        # The arrays of the old start serve the next step.
        self.start, self.end, self._new = self.end, new, self.start
        self.steps += 1

    def _tried(self, h: float) -> tuple[End, float]:
        """The end of a step h [s] from the last one, and its estimated error [m]."""
        a, t = self.end, self.end.t
        table = self.propagator.table(0.5 * h)
        (k2, k3, k4), (stage, moved) = self._k, self._u
        u, k1 = real(a.u), real(a.rate)
        propagate(table, u, k1, 0.5 * h, real(stage))
        power2 = self._evaluate(t + 0.5 * h, stage, k2)
        set_third_stage(table, u, real(k2), 0.5 * h, real(moved), real(stage))
        power3 = self._evaluate(t + 0.5 * h, stage, k3)
        propagate(table, real(moved), real(k3), h, real(stage))
        power4 = self._evaluate(t + h, stage, k4)
        new = self._new
        new.t = t + h
        set_end(table, real(moved), k1, real(k2), real(k3), real(k4), h / 6.0, real(new.u))
        new.power = self._evaluate(new.t, new.u, new.rate)
        new.lost = a.lost + h / 6.0 * (a.power + 2.0 * (power2 + power3) + power4)
        return new, 0.1 * h * self.propagator.distance(k4, new.rate)


class LinearMarch:
    """The march of a linear sea: any time is within reach, without steps."""

    steps, reached = 0, math.inf

    def __init__(self, propagator: Propagator, t: float, u: np.ndarray) -> None:
        """From spectra u (2, rows, columns) at time t [s] on."""
        self.propagator, self.start, self.first = propagator, t, u

    def copied(self) -> "LinearMarch":
        """Itself: it does not change."""
        return self

    def restarted(self, propagator: Propagator, rates: Rates, t: float, u: np.ndarray) -> "LinearMarch":
        """A march on another grid."""
        return LinearMarch(propagator, t, u)

    def advance(self, t: float) -> None:
        """Nothing to do."""

    def at(self, t: float) -> np.ndarray:
        """Spectra (2, rows, columns) at time t [s]."""
        moved, first = np.empty_like(self.first), real(self.first)
        propagate(self.propagator.turn(t - self.start), first, first, 0.0, real(moved))
        return moved

    def lost(self, t: float) -> float:
        """0: nothing breaks."""
        return 0.0


def real(spectra: np.ndarray) -> np.ndarray:
    """Spectra (2, rows, columns) as real and imaginary parts side by side."""
    return spectra.view(float)


@kernel
def propagate(table, u, v, factor, out):
    """Set out to u + factor v (2, rows, 2 columns), evolved by a table of `Propagator`. out may be u."""
    for i in range(u.shape[1]):
        for j in range(table.shape[2]):
            c, up, down = table[0, i, j], table[1, i, j], table[2, i, j]
            for part in range(2 * j, 2 * j + 2):
                eta, psi = u[0, i, part] + factor * v[0, i, part], u[1, i, part] + factor * v[1, i, part]
                out[0, i, part] = c * eta + up * psi
                out[1, i, part] = c * psi - down * eta


@kernel
def square_distance(u, v, ratio, weight):
    """Weighted sum of squares of eta and ratio psi of u - v, (2, rows, 2 columns)."""
    total = 0.0
    for i in range(ratio.shape[0]):
        for j in range(ratio.shape[1]):
            square = 0.0
            for part in range(2 * j, 2 * j + 2):
                eta, psi = u[0, i, part] - v[0, i, part], ratio[i, j] * (u[1, i, part] - v[1, i, part])
                square += eta * eta + psi * psi
            total += weight[j] * square
    return total


@kernel(noalias=True)
def set_third_stage(table, u, k, factor, moved, stage):
    """Set moved to u (2, rows, 2 columns), evolved by a table of `Propagator`, and stage to moved + factor k."""
    for i in range(u.shape[1]):
        for j in range(table.shape[2]):
            c, up, down = table[0, i, j], table[1, i, j], table[2, i, j]
            for part in range(2 * j, 2 * j + 2):
                eta, psi = c * u[0, i, part] + up * u[1, i, part], c * u[1, i, part] - down * u[0, i, part]
                moved[0, i, part], moved[1, i, part] = eta, psi
                stage[0, i, part], stage[1, i, part] = eta + factor * k[0, i, part], psi + factor * k[1, i, part]


@kernel(noalias=True)
def set_end(table, moved, k1, k2, k3, k4, sixth, out):
    """Set out (2, rows, 2 columns) to the end of a step, sixth [s] of six; moved: its start, evolved by half a step."""
    for i in range(moved.shape[1]):
        for j in range(table.shape[2]):
            c, up, down = table[0, i, j], table[1, i, j], table[2, i, j]
            for part in range(2 * j, 2 * j + 2):
                eta = moved[0, i, part] + sixth * (
                    c * k1[0, i, part] + up * k1[1, i, part] + 2.0 * (k2[0, i, part] + k3[0, i, part])
                )
                psi = moved[1, i, part] + sixth * (
                    c * k1[1, i, part] - down * k1[0, i, part] + 2.0 * (k2[1, i, part] + k3[1, i, part])
                )
                out[0, i, part] = c * eta + up * psi + sixth * k4[0, i, part]
                out[1, i, part] = c * psi - down * eta + sixth * k4[1, i, part]
