"""Measured spectra: densities over frequency, or over frequency and direction, as a spectrum of both seas.

    >>> import numpy as np
    >>> from sim.ocean import Sea
    >>> f = np.linspace(0.05, 0.4, 71)
    >>> swell = measured_spectrum(f, 2.0 * np.exp(-(((f - 0.1) / 0.02) ** 2)))  # [m2/Hz]
    >>> sea = Sea(256, 1500.0, swell, spreading="cos2s", wind_direction=0.5)
    >>> f"{swell.moments().significant_height:.2f} m, {sea.significant_height:.1f} m"
    '1.06 m, 1.1 m'

Between its frequencies and directions a spectrum is linear, outside them it is 0: a buoy that stops at 0.485 Hz has no
shorter waves, and directions over a part of the circle have none in the rest of it. Directions are where waves go to,
as everywhere in the library; `read_spectrum` turns those of files.

A buoy knows four numbers of the directions at each frequency, those of the first two terms of Fourier's series. The
spreading with these four and the greatest entropy is that of Lygre and Krogstad (1986, J. Phys. Oceanogr. 16:2052).
"""

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from sim.numerics.angles import once_around, within_turn
from sim.ocean.spectra.record import Conditions, Spectrum, SpreadConditions, from_frequency
from sim.validation import argument_error, as_array

LOWEST, HIGHEST = 1e-4, 100.0  # [Hz]
MIN_DIRECTIONS = 4
MAX_FIRST = 0.998  # of r1: the spreading of a single direction has no finite density
GAP = 1.9  # of the widest step between directions: a wider one is no step, but the part of the circle without waves
EDGE = 1e-9  # [rad] in which the density falls to 0 at the ends of a sector
SLACK = 1e-6  # by which the second term stays inside what the first one allows


class Measured:
    """Densities over frequency and optionally direction, with the functions of a `Spectrum`."""

    def __init__(self, frequency: np.ndarray, density: np.ndarray, direction: np.ndarray | None = None) -> None:
        """frequency (n,) [Hz] rising, density (n,) [m2/Hz], or (n, m) [m2/Hz/rad] at directions (m,) [rad], rising."""
        self.frequencies, self.directions = frequency, direction
        self.both: np.ndarray | None = None  # (n, k) over one turn, from one direction to itself
        self.density = density
        if direction is not None:
            self.directions, self.both = around(direction, density)
            steps = np.diff(self.directions)
            self.density = 0.5 * (steps * (self.both[:, :-1] + self.both[:, 1:])).sum(axis=1)

    def of_frequency(self, w: np.ndarray, _: Conditions) -> np.ndarray:
        """S(omega) [m2 s] over all directions."""
        f = np.asarray(w) / (2.0 * math.pi)
        return np.interp(f, self.frequencies, self.density, left=0.0, right=0.0) / (2.0 * math.pi)

    def of_waves(self, kx: np.ndarray, ky: np.ndarray, c: Any) -> np.ndarray:
        """S(kx, ky) [m4]: spread over directions as measured, or else by the formula of the conditions."""
        if self.both is None or self.directions is None:
            return from_frequency(self.of_frequency, self.peak, kx, ky, c)
        k = np.hypot(kx, ky)
        f = c.omega(k) / (2.0 * math.pi)
        inside = (f >= self.frequencies[0]) & (f <= self.frequencies[-1])
        i, u = place_in(self.frequencies, f)
        theta = self.directions[0] + within_turn(np.arctan2(ky, kx) - self.directions[0])
        j, v = place_in(self.directions, theta)
        E = self.both
        low, high = (1.0 - v) * E[i, j] + v * E[i, j + 1], (1.0 - v) * E[i + 1, j] + v * E[i + 1, j + 1]
        spread = ((1.0 - u) * low + u * high) / (2.0 * math.pi)
        return np.where(inside, spread * c.group_speed(k) / k, 0.0)

    def significant_height(self, _: Conditions | None = None) -> float:
        """Hs = 4 sqrt(m0) [m]."""
        middles = 0.5 * (self.density[1:] + self.density[:-1])
        return 4.0 * math.sqrt(float((middles * np.diff(self.frequencies)).sum()))

    def peak(self, _: Conditions | None = None) -> float:
        """Angular frequency [rad/s] of the largest density."""
        return 2.0 * math.pi * float(self.frequencies[self.density.argmax()])


def around(direction: np.ndarray, density: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Directions (k,) [rad] of one turn, the last one the first, and densities (n, k) there.

    Given are directions (m,) [rad], rising within a turn, and densities (n, m). A gap of more than GAP of the widest
    other step makes them a sector: its ends reach half a step farther, and the gap has no waves.
    """
    turn = 2.0 * math.pi
    steps = np.diff(direction, append=direction[0] + turn)
    last = int(steps.argmax())
    if steps[last] <= GAP * np.delete(steps, last).max():
        return np.append(direction, direction[0] + turn), np.concatenate([density, density[:, :1]], axis=1)
    direction, density = np.roll(direction, -last - 1), np.roll(density, -last - 1, axis=1)
    direction = direction[0] + within_turn(direction - direction[0])
    first, end = (
        direction[0] - 0.5 * (direction[1] - direction[0]),
        direction[-1] + 0.5 * (direction[-1] - direction[-2]),
    )
    none = np.zeros((len(density), 1))
    return (
        np.concatenate([[first], direction, [end, end + EDGE, first + turn - EDGE, first + turn]]),
        np.concatenate([density[:, :1], density, density[:, -1:], none, none, density[:, :1]], axis=1),
    )


def place_in(nodes: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Index of the interval of rising nodes (n,) that x lies in, or is nearest to, and the share of it before x."""
    i = np.clip(np.searchsorted(nodes, x, side="right") - 1, 0, len(nodes) - 2)
    return i, np.clip((x - nodes[i]) / (nodes[i + 1] - nodes[i]), 0.0, 1.0)


def measured_spectrum(
    frequency: ArrayLike, density: ArrayLike, direction: ArrayLike | None = None, name: str = "measured"
) -> Spectrum[Any]:
    """The spectrum of densities (n,) [m2/Hz] at rising frequencies (n,) [Hz], for `Sea` and `draw_waves`.

    With directions (m,) [rad], where waves go to, the densities are (n, m) [m2/Hz/rad]; without them waves spread about
    the wind's direction by the formula of the conditions, as those of `sea_state`. name: its title.

    Raises ValueError for other shapes, values that are not finite or below 0, and a spectrum without waves.
    """
    allowed = f"at least three rising numbers from {LOWEST:g} to {HIGHEST:g} Hz"
    f = as_array("frequency", frequency, allowed)
    if f.ndim != 1 or len(f) < 3:
        raise argument_error("frequency", f.shape, allowed)
    bad = ~((f >= LOWEST) & (f <= HIGHEST) & (np.diff(f, prepend=-1.0) > 0.0))
    if bad.any():
        i = int(bad.argmax())
        raise argument_error("frequency", f"{f[i]:g} Hz, after {f[i - 1]:g}" if i else f"{f[0]:g} Hz", allowed)
    theta, order, shape, unit = None, np.zeros(0, int), f.shape, "m2/Hz"
    if direction is not None:
        allowed = f"at least {MIN_DIRECTIONS} angles [rad] within one turn, each once"
        theta = as_array("direction", direction, allowed)
        if theta.ndim != 1 or len(theta) < MIN_DIRECTIONS or not np.isfinite(theta).all():
            raise argument_error("direction", theta.tolist() if theta.ndim == 1 else theta.shape, allowed)
        count = len(theta)
        theta, order = once_around(theta)
        if len(theta) < count:
            raise argument_error("direction", direction, allowed)
        shape, unit = (*f.shape, *theta.shape), "m2/Hz/rad"
    allowed = f"finite numbers, 0 or above [{unit}], of shape {shape}, some above 0"
    S = as_array("density", density, allowed)
    if S.shape != shape:
        raise argument_error("density", S.shape, allowed)
    bad = ~(np.isfinite(S) & (S >= 0.0))
    if bad.any() or not S.any():
        raise argument_error("density", float(S[bad][0]) if bad.any() else 0.0, allowed)
    densities = Measured(f, S if theta is None else S[:, order], theta)
    return Spectrum(
        name,
        f"{name}: measured",
        densities.of_waves,
        densities.significant_height,
        densities.peak,
        SpreadConditions if theta is None else Conditions,
        densities.of_frequency,
        by_wind=False,
    )


def spread_by_moments(
    direction: np.ndarray, mean: np.ndarray, first: np.ndarray, second_mean: np.ndarray, second: np.ndarray
) -> np.ndarray:
    """D (n, m) [1/rad] of the greatest entropy at directions (m,) [rad] of equal spacing, its sum over them being 1.

    mean, second_mean (n,) [rad]: alpha1 and alpha2; first, second (n,): r1 and r2, the lengths of the first two terms
    of Fourier's series (Lygre and Krogstad, eq. 13). Terms that no spreading has are brought to the nearest that have.
    """
    c1 = np.minimum(first, MAX_FIRST) * np.exp(1j * mean)
    c2 = second * np.exp(2j * second_mean)
    # |c2 - c1^2| <= 1 - |c1|^2, or the density would be negative
    room, away = (1.0 - SLACK) * (1.0 - np.abs(c1) ** 2), c2 - c1**2
    c2 = c1**2 + away * np.minimum(room / np.maximum(np.abs(away), 1e-300), 1.0)
    phi1 = (c1 - c2 * c1.conj()) / (1.0 - np.abs(c1) ** 2)
    phi2 = c2 - c1 * phi1
    turned = np.exp(-1j * direction)
    below = np.abs(1.0 - phi1[:, None] * turned - phi2[:, None] * turned**2) ** 2
    D = (1.0 - phi1 * c1.conj() - phi2 * c2.conj()).real[:, None] / below
    return normalised(D, direction)


def spread_by_mean(direction: np.ndarray, mean: np.ndarray, first: np.ndarray) -> np.ndarray:
    """D (n, m) [1/rad] as cos^2s about a mean direction (n,) [rad], with r1 (n,) = s/(s + 1); the rest as above."""
    first = np.minimum(first, MAX_FIRST)
    s = first / (1.0 - first)
    return normalised(np.abs(np.cos(0.5 * (direction - mean[:, None]))) ** (2.0 * s[:, None]), direction)


def normalised(D: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """D (n, m) divided by its sum over directions (m,) [rad] of equal spacing."""
    return D / (D.sum(axis=1, keepdims=True) * (2.0 * math.pi / len(direction)))
