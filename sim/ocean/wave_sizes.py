"""Sizes and phases of a tile's waves in time: they approach those of the conditions, and decay in what they run in.

Full planes (size, size) are in FFT order; a quarter plane is over |kx|, |ky|. No array is changed in place.
"""

import copy
import math
from typing import Any

import numpy as np

from sim.interruption import raise_if_stopped
from sim.ocean.amplitudes import fold, integers
from sim.ocean.medium import Medium
from sim.ocean.spectra import Conditions
from sim.validation import argument_error, check_finite

SETTLED_SHARE = 1e-7  # share of a change still to come below which it counts as done


class WaveSizes:
    """The waves since the last change of the conditions, at time `base` [s]."""

    target: np.ndarray  # sqrt(S dk^2) [m] of the conditions, a full plane
    start: np.ndarray  # the same at the last change
    rate: np.ndarray  # frequency [1/s], a quarter plane
    decay: np.ndarray  # decay rate [1/s], a quarter plane
    decays: bool  # any wave does
    fall: np.ndarray  # -decay in the precision of the planes

    def __init__(self, unit: np.ndarray, real: Any, wide: Any) -> None:
        """unit: amplitudes over their size, a full plane (`unit_amplitudes`). real, wide: types of the planes."""
        size = len(unit)
        self.unit, self.real, self.wide = unit, real, wide
        self.base, self.relax = 0.0, 0.0
        self.past: dict[tuple[Medium, Conditions], float] = {}  # [s] spent in each medium before the last change
        self.lost = np.zeros((size // 2, size // 2))  # -ln of the share of each wave that is left of that time
        self.folded = np.abs(integers(size)) % (size // 2)  # |n|, with the Nyquist index, of amplitude 0, sent to 0

    def copied(self) -> "WaveSizes":
        """An independent copy."""
        other = copy.copy(self)
        other.past = dict(self.past)
        return other

    def set_conditions(self, target: np.ndarray, omega: np.ndarray, decay: np.ndarray) -> None:
        """Take what other conditions ask for: sizes [m], frequencies [rad/s] and decay rates [1/s]."""
        self.target, self.rate = target, omega / (2.0 * np.pi)
        self.decay, self.decays, self.fall = decay, bool(decay.any()), (-decay).astype(self.real)

    def full(self, quarter: np.ndarray) -> np.ndarray:
        """A quarter plane laid out over the full plane."""
        return quarter[self.folded[:, None], self.folded[None, :]]

    def folded_sum(self, plane: np.ndarray) -> np.ndarray:
        """The sum of a full plane over the waves of each |kx|, |ky|: a quarter plane."""
        found = np.zeros_like(self.lost)
        raise_if_stopped()
        np.add.at(found, np.ix_(self.folded, self.folded), plane)
        return found

    def checked_time(self, t: float) -> float:
        """Raises ValueError for a time that is not finite, or before the last change where waves decay or relax."""
        t = check_finite("t", t, "s")
        if t < self.base and (self.relax > 0.0 or self.decays):
            raise argument_error("t", t, f"{self.base:g} s or later: decaying and relaxing waves do not run back")
        return t

    def lost_at(self, t: float) -> np.ndarray:
        """-ln of the share of each wave that is left at time t [s], a quarter plane. Errors as for `checked_time`."""
        t = self.checked_time(t)
        return self.lost + self.decay * (t - self.base) if self.decays else self.lost

    def spend(self, medium: Medium, conditions: Conditions, decay: np.ndarray, duration: float) -> None:
        """Book a time [s] in a medium, where waves have decayed at these rates (a quarter plane, [1/s])."""
        if duration == 0.0 or not decay.any():
            return
        c = conditions
        water = Conditions(gravity=c.gravity, depth=c.depth, tension=c.tension, density=c.density)
        self.past[medium, water] = self.past.get((medium, water), 0.0) + duration
        self.lost = self.lost + decay * duration

    def turn(self, turns: np.ndarray) -> None:
        """h0(k) e^(-i omega t): the phase so far, a quarter plane, goes into the unit amplitudes, in double."""
        self.unit = self.unit * self.full(np.exp(-2j * np.pi * (turns - np.rint(turns))))

    def begin(self, t: float, relax: float, before: np.ndarray) -> None:
        """From time t [s] on, sizes approach their target from those `before` as 1 - exp(-(time - t)/relax)."""
        self.start = before if relax > 0.0 else self.target
        self.base, self.relax = t, relax
        self.set_planes()

    def take_over(self, other: "WaveSizes") -> None:
        """Go on as the waves of a tile of another grid, where this one has them too; `spend` and planes are apart."""
        half = min(len(self.unit), len(other.unit)) // 2
        n = np.arange(1 - half, half)
        shared = np.ix_(n, n)  # negative indices count from the end, as FFT order does
        self.start = self.target.copy()
        self.unit[shared], self.start[shared] = other.unit[shared], other.start[shared]
        self.base, self.relax = other.base, other.relax

    def left_to_come(self, t: float) -> float:
        """Share of the last change that is still to come at time t."""
        share = math.exp(-(t - self.base) / self.relax) if self.relax > 0.0 else 0.0
        return share if share > SETTLED_SHARE else 0.0

    def undecayed(self, t: float) -> np.ndarray:
        """sqrt(S dk^2) of each wave at time t, relaxed, as if nothing had decayed, (size, size) [m]."""
        return self.target + self.left_to_come(t) * (self.start - self.target)

    def magnitude(self, t: float) -> np.ndarray:
        """sqrt(S dk^2) of each wave at time t, relaxed and decayed, (size, size) [m]."""
        lost = self.lost_at(t)
        return self.undecayed(t) * self.full(np.exp(-lost)) if lost.any() else self.undecayed(t)

    def set_planes(self) -> None:
        """Fold the amplitudes into even and odd half planes: of the target, and of the difference start - target."""
        unit = self.unit * self.full(np.exp(-self.lost)) if self.lost.any() else self.unit
        raise_if_stopped()
        self.settled = self.planes(unit * self.target)
        raise_if_stopped()
        self.to_come = self.planes(unit * (self.start - self.target)) if self.relax > 0.0 else None

    def planes(self, h0: np.ndarray) -> list[np.ndarray]:
        """Even and odd half plane of amplitudes, as their real views."""
        return [np.ascontiguousarray(plane, self.wide).view(self.real) for plane in fold(h0)]

    def planes_at(self, t: float) -> list[np.ndarray]:
        """Even and odd half plane at time t [s], without the decay since the last change."""
        share = self.left_to_come(t)
        if self.to_come is None or share == 0.0:
            return self.settled
        weight = self.real(share)
        return [plane + weight * rest for plane, rest in zip(self.settled, self.to_come, strict=True)]
