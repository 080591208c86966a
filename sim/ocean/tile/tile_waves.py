"""Sizes and phases of a tile's waves in time: they approach those of the conditions, and decay in the medium.

Full and quarter planes are as in `wavenumbers.py`. No array is changed in place.
"""

import copy
import dataclasses
import math
from typing import NamedTuple

import numpy as np

from sim.dispersion import tanh_depth
from sim.interruption import raise_if_stopped
from sim.ocean.fluids.medium import Medium
from sim.ocean.spectra import Conditions
from sim.ocean.tile.amplitudes import fold, resolved, waves_of_tile
from sim.ocean.tile.wavenumbers import Wavenumbers
from sim.validation import argument_error, check_number
from sim.water import Water
from sim.waves import Waves

SETTLED_SHARE = 1e-7  # fraction of a change still to come below which it counts as done


class DrawnWaves(NamedTuple):
    """The waves under given conditions."""

    unit: np.ndarray  # amplitudes over their size, a full plane (`unit_amplitudes`)
    target: np.ndarray  # sqrt(S dk^2) [m], a full plane
    omega: np.ndarray  # [rad/s], a quarter plane
    decay: np.ndarray  # decay rate [1/s], a quarter plane
    depth: float  # [m] of the water


class TileWaves:
    """The waves since the last change of the conditions, at time `base` [s]."""

    unit: np.ndarray  # amplitudes over their size with the phases at `base`, a full plane
    target: np.ndarray  # sqrt(S dk^2) [m] of the conditions, a full plane
    start: np.ndarray  # the same at the last change
    rate: np.ndarray  # frequency [1/s], a quarter plane
    decay: np.ndarray  # decay rate [1/s], a quarter plane
    decays: bool  # any wave does
    fall: np.ndarray  # -decay in the precision of the planes
    # Factors on heights and on their quadrature, quarter planes in the precision of the planes.
    rise: np.ndarray  # omega [rad/s]
    flow: np.ndarray  # omega coth(kh)/k [m/s]
    lift: np.ndarray  # -omega^2 [rad2/s2]

    def __init__(self, numbers: Wavenumbers, drawn: DrawnWaves) -> None:
        """The waves from time 0 on."""
        self.numbers = numbers
        self.version = 0  # counts changes
        self.past: dict[tuple[Medium, Conditions], float] = {}  # [s] spent in each medium before the last change
        self.lost = np.zeros_like(numbers.quarter)  # -ln of the fraction of each wave that is left of that time
        # ((medium, conditions), decay rates) of the last call of `decay_in`
        self.other_decay: tuple[tuple[Medium, Conditions], np.ndarray] | None = None
        self.listed: tuple[tuple | None, Waves | None] = None, None  # key of the amplitudes, and the waves
        self.unit = drawn.unit
        self._set_drawn(drawn)
        self._begin(0.0, 0.0, self.target)

    def copied(self) -> "TileWaves":
        """An independent copy."""
        other = copy.copy(self)
        other.past = dict(self.past)
        return other

    def change(self, t: float, relax: float, drawn: DrawnWaves, medium: Medium, conditions: Conditions) -> None:
        """From time t [s] on, sizes approach those of other conditions as 1 - exp(-(time - t)/relax).

        medium, conditions: those until then. Phases do not jump, losses stay. drawn.unit: with the phases at the last
        change.
        """
        duration, before = t - self.base, self.undecayed(t)
        self._spend(medium, conditions, self.decay, duration)
        # h0(k) e^(-i omega t): the phase so far goes into the unit amplitudes, in double.
        turns = self.rate * duration
        self.unit = drawn.unit * self.numbers.full(np.exp(-2j * np.pi * (turns - np.rint(turns))))
        self._set_drawn(drawn)
        raise_if_stopped()
        self.version += 1
        self._begin(t, relax, before)

    def expose(self, medium: Medium, conditions: Conditions, decay: np.ndarray, duration: float) -> None:
        """Let the waves decay at once as they would in `duration` [s] at these rates, those of the medium."""
        self._spend(medium, conditions, decay, duration)
        self.version += 1
        self._set_planes()

    def decay_in(self, medium: Medium, conditions: Conditions) -> np.ndarray:
        """Decay rates [1/s] in a medium, a quarter plane, solved once for the same medium and conditions."""
        asked = medium, conditions
        if self.other_decay is None or self.other_decay[0] != asked:
            self.other_decay = asked, medium.roots(self.numbers.quarter, conditions)[1]
        return self.other_decay[1]

    def _set_drawn(self, drawn: DrawnWaves) -> None:
        self.target, self.rate, self.decay = drawn.target, drawn.omega / (2.0 * np.pi), drawn.decay
        self.decays, self.fall = bool(self.decay.any()), (-self.decay).astype(self.numbers.real)
        k, omega = self.numbers.quarter, drawn.omega
        below = k * tanh_depth(k, drawn.depth)
        flow = np.divide(omega, below, out=np.zeros_like(k), where=below > 0.0)
        self.rise, self.flow, self.lift = (each.astype(self.numbers.real) for each in (omega, flow, -np.square(omega)))

    def checked_time(self, t: float) -> float:
        """Raises ValueError for a time that is not finite, or before the last change where waves decay or relax."""
        t = check_number("t", t, "s")
        if t < self.base and (self.relax > 0.0 or self.decays):
            raise argument_error(
                "t", t, f"{self.base:g} s or later: decaying and relaxing waves cannot go back in time"
            )
        return t

    def lost_at(self, t: float) -> np.ndarray:
        """-ln of the fraction left of each wave at time t [s], a quarter plane. Errors as for `checked_time`."""
        t = self.checked_time(t)
        return self.lost + self.decay * (t - self.base) if self.decays else self.lost

    def _spend(self, medium: Medium, conditions: Conditions, decay: np.ndarray, duration: float) -> None:
        """Book a time [s] in a medium, where waves have decayed at these rates (a quarter plane, [1/s])."""
        if duration == 0.0 or not decay.any():
            return
        water = Conditions(**dataclasses.asdict(conditions.water), tension=conditions.tension)
        self.past[medium, water] = self.past.get((medium, water), 0.0) + duration
        self.lost = self.lost + decay * duration

    def _begin(self, t: float, relax: float, before: np.ndarray) -> None:
        """From time t [s] on, sizes approach their target from those `before`."""
        self.start = before if relax > 0.0 else self.target
        self.base, self.relax = t, relax
        self._set_planes()

    def take_over(self, other: "TileWaves") -> None:
        """Continue as the waves of a tile of another grid, where this one has them too."""
        half = min(len(self.unit), len(other.unit)) // 2
        n = np.arange(1 - half, half)
        shared = np.ix_(n, n)  # negative indices count from the end, as FFT order does
        self.start = self.target.copy()
        self.unit[shared], self.start[shared] = other.unit[shared], other.start[shared]
        self.base, self.relax = other.base, other.relax
        for (medium, water), duration in other.past.items():
            self._spend(medium, water, medium.roots(self.numbers.quarter, water)[1], duration)
        self._set_planes()

    def left_to_come(self, t: float) -> float:
        """Fraction of the last change that is still to come at time t."""
        share = math.exp(-(t - self.base) / self.relax) if self.relax > 0.0 else 0.0
        return share if share > SETTLED_SHARE else 0.0

    def is_steady(self, t: float) -> bool:
        """True if no wave grows or decays any more after time t [s]."""
        return not self.decays and self.left_to_come(t) == 0.0

    def undecayed(self, t: float) -> np.ndarray:
        """sqrt(S dk^2) of each wave at time t, relaxed, as if nothing had decayed, (size, size) [m]."""
        return self.target + self.left_to_come(t) * (self.start - self.target)

    def magnitude(self, t: float) -> np.ndarray:
        """sqrt(S dk^2) of each wave at time t, relaxed and decayed, (size, size) [m]."""
        lost = self.lost_at(t)
        return self.undecayed(t) * self.numbers.full(np.exp(-lost)) if lost.any() else self.undecayed(t)

    def amplitudes(self, t: float) -> np.ndarray:
        """h0(k), complex, a full plane [m]: as large as at time t [s], with the phases at `base`."""
        return self.unit * self.magnitude(t)

    @property
    def frequencies(self) -> np.ndarray:
        """omega(k) [rad/s], a full plane; 0 on the mean and the Nyquist lines."""
        return self.numbers.full(2.0 * np.pi * self.rate) * resolved(self.numbers.size)

    def waves_at(self, t: float, water: Water) -> Waves:
        """The waves that have an amplitude, as high as at time t [s]. Kept until they change."""
        key = self.version, None if self.is_steady(t) else t
        known, waves = self.listed
        if waves is None or known != key:
            waves = waves_of_tile(self.numbers.k, self.amplitudes(t), self.frequencies, self.base, water)
            self.listed = key, waves
        return waves

    def _set_planes(self) -> None:
        """Fold the amplitudes into even and odd half planes: of the target, and of the difference start - target."""
        unit = self.unit * self.numbers.full(np.exp(-self.lost)) if self.lost.any() else self.unit
        raise_if_stopped()
        self.settled = self._planes(unit * self.target)
        raise_if_stopped()
        self.to_come = self._planes(unit * (self.start - self.target)) if self.relax > 0.0 else None

    def _planes(self, h0: np.ndarray) -> list[np.ndarray]:
        """Even and odd half plane of amplitudes, as their real views."""
        return [np.ascontiguousarray(plane, self.numbers.wide).view(self.numbers.real) for plane in fold(h0)]

    def planes_at(self, t: float) -> list[np.ndarray]:
        """Even and odd half plane at time t [s], without the decay since the last change."""
        share = self.left_to_come(t)
        if self.to_come is None or share == 0.0:
            return self.settled
        weight = self.numbers.real(share)
        return [plane + weight * rest for plane, rest in zip(self.settled, self.to_come, strict=True)]
