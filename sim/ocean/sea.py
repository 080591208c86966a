"""The square sea: a periodic tile of linear waves, evaluated at any time by real FFTs (Tessendorf 2001).

Choose it for a surface that fills a tile; the radial sum of `radial.py` for one that reaches the horizon. Time is
analytic: nothing accumulates, and a frame costs the transforms it reads plus one pass over half the spectrum.
Limits: linear waves, made sharper by the choppy displacement; a tile shorter than the dominant wave loses its energy.
"""

import copy
import dataclasses
import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from sim.interruption import raise_if_stopped
from sim.ocean.amplitudes import KINDS, fold, integers, resolved, unit_amplitudes
from sim.ocean.evolve import set_heights, weighted_energy
from sim.ocean.kinematics import Components, Kinematics
from sim.ocean.medium import Medium
from sim.ocean.query import query
from sim.ocean.ripples import Ripples
from sim.ocean.spectra import PARAMETERS, SPECTRA, Conditions, Spectrum
from sim.ocean.surface import Surface
from sim.ocean.transforms import PRECISIONS, Transforms
from sim.validation import (
    argument_error,
    check_choice,
    check_finite,
    check_kind,
    check_not_negative,
    check_number,
    check_positions,
    is_whole_number,
)

SETTLED_SHARE = 1e-7  # share of a change still to come below which it counts as done
SIZES = (8, 4096)
LENGTHS = (1e-3, 1e8)  # [m]


_CONDITIONS = frozenset(f.name for f in dataclasses.fields(Conditions)) | PARAMETERS.keys()
_MEDIUM = frozenset(f.name for f in dataclasses.fields(Medium))


class Sea:
    """A tile of sea. Index [i, j] of a field is x = i length/size, y = j length/size. Not for two threads at once."""

    def __init__(
        self,
        size: int = 256,
        length: float = 500.0,
        spectrum: str | Spectrum[Any] = "pierson_moskowitz",
        wind_speed: float = 10.0,
        wind_direction: float = 0.0,
        gravity: float = 9.81,
        depth: float = math.inf,
        tension: float = 0.0,
        viscosity: float = 0.0,
        choppiness: float = 1.0,
        amplitudes: str = "random",
        seed: int = 0,
        precision: str = "single",
        **more: Any,
    ) -> None:
        """size: cells a side, even, 8 to 4096; length [m] of the tile; the wind is U10, U19.5 for pierson_moskowitz.

        spectrum: a name in `SPECTRA`, or a custom record.

        amplitudes: "random" (Gaussian) or "fixed" (random phase only); choppiness: factor on the displacement;
        viscosity [m2/s]: waves decay at their exact rate from t = 0. More: the fields of the spectrum's conditions
        (`sim.ocean.spectra`) and of `Medium`. Raises ValueError for a value that is not allowed or a condition that
        this spectrum does not use, TypeError for an unknown name.
        """
        if not is_whole_number(size) or size % 2 or not SIZES[0] <= size <= SIZES[1]:
            raise argument_error("size", size, f"an even whole number from {SIZES[0]} to {SIZES[1]}")
        check_choice("amplitudes", amplitudes, KINDS)
        if not is_whole_number(seed):
            raise argument_error("seed", seed, "a whole number")
        check_choice("precision", precision, PRECISIONS)
        self.size, self.length, self.seed = int(size), check_number("length", length, *LENGTHS, "m"), int(seed)
        self.precision, self.amplitudes = precision, amplitudes
        self.choppiness = choppiness
        self._real = PRECISIONS[precision][0]
        self._unit = unit_amplitudes(self.size, self.seed, amplitudes)
        self._base, self._last, self._relax = 0.0, 0.0, 0.0
        self._past: dict[tuple[Medium, Conditions], float] = {}  # [s] spent in each medium before the last change
        self.version = 0  # counts changes of the conditions
        self._evolved: tuple | None = None
        self._mean_height: tuple[tuple | None, float] = None, 0.0  # key of time and state, and the mean [m]
        self._latest: tuple[tuple, dict[str, np.ndarray]] | None = None
        self._components: tuple[tuple | None, Components | None] = None, None  # key of the amplitudes, and the waves
        self._ripples: Ripples | None = None

        n = integers(self.size)
        self.k = n * (2.0 * math.pi / self.length)  # [rad/m], FFT order
        self._folded = np.abs(n) % (self.size // 2)  # |n|, with the Nyquist index, where the amplitude is 0, sent to 0
        quarter = self.k[: self.size // 2]
        self._k = np.hypot(quarter[:, None], quarter[None, :])
        inverse = np.divide(1.0, self._k, out=np.zeros_like(self._k), where=self._k > 0.0)
        self.radial = {"1": np.ones_like(self._k, self._real), "1/k": inverse.astype(self._real)}
        self.radial["k"] = self._k.astype(self._real)
        self.rows = {"1": np.ones(self.size, self._real), "k": self.k.astype(self._real)}
        self.rows["k2"] = (self.k**2).astype(self._real)

        self.transforms = Transforms(self.size, precision)
        self._heights: np.ndarray | None = None  # made on first use
        self._scratch = (np.empty(self.size, self._real), np.empty(self.size, self._real))
        given = {
            "wind_speed": wind_speed,
            "wind_direction": wind_direction,
            "gravity": gravity,
            "depth": depth,
            "tension": tension,
            "viscosity": viscosity,
        }
        self._given: dict[str, Any] = {}  # conditions as given, those that the spectrum uses
        self._lost = np.zeros_like(self._k)  # -ln of the share of each wave that is left of that time, a quarter plane
        # ((medium, conditions), decay rates) of the last call of `expose`
        self._other_decay: tuple[tuple[Medium, Conditions], np.ndarray] | None = None
        # for `slope_left`: under which spectrum and conditions, and the slope
        self._sloped_under: tuple[tuple[Spectrum[Any], Conditions] | None, np.ndarray] = None, self._lost
        self._set_conditions(spectrum, given | more, Medium())
        self._start = self._target
        self._set_planes()

    def __deepcopy__(self, memo: dict) -> "Sea":
        """An independent copy of the sea.

        It shares arrays that are never changed in place, and the transforms: both seas are for the same thread.
        """
        other = copy.copy(self)
        other._past, other._ripples = dict(self._past), copy.deepcopy(self._ripples, memo)
        other._heights = other._evolved = other._latest = None
        return other

    @property
    def choppiness(self) -> float:
        """Factor on the horizontal displacement, 0 or above; 0 costs no transform."""
        return self._choppiness

    @choppiness.setter
    def choppiness(self, value: float) -> None:
        self._choppiness = check_not_negative("choppiness", value, "")

    def surface(self, t: float) -> Surface:
        """The surface at time t [s]; each field is computed when first read. Raises ValueError for a time not allowed:
        not finite, or before the last change where waves decay or relax."""
        t = self._checked_time(t)
        key = self._key(t)
        if self._latest is None or self._latest[0] != key:
            self._latest = key, {}
        self._last = t
        return Surface(self, t, self._latest[1])

    def height_at(self, points: ArrayLike, t: float, exact: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Height (n,) [m] of the displaced surface above points (n, 2) [m] at time t, and the residual (n,) [m].

        Its mean over the tile is that of still water, 0, see `Surface.mean_height`.

        The residual is the horizontal miss |x + D(x) - point| of the solution found; it is at rounding wherever the
        surface does not fold, and where it stays large the surface above the point is folded. Between grid points
        fields are bicubic; exact: the sum over all waves instead, slow. Raises ValueError for another shape.
        """
        check_kind("exact", exact, bool, "True or False")
        return query(self.surface(t), check_positions("points", points), exact)

    def kinematics(self, points: ArrayLike, t: float, stretching: str = "constant") -> Kinematics:
        """Velocity, acceleration and pressure of the water at points (n, 3) [m] at time t, by the sum over all waves.

        See `Components.kinematics`, also for the errors raised; `components` gives fewer waves, for many points or
        steps.
        """
        return self.components(t).kinematics(points, t, stretching)

    def components(self, t: float | None = None) -> Components:
        """The waves of the tile, as high as at time t [s], by default the sea's own; `largest` of them picks a few.

        They hold at all times unless waves decay, relax or are changed. Raises ValueError as `surface`.
        """
        t = self._last if t is None else self._checked_time(t)
        key = self.version, None if self.is_steady(t) else t
        known, waves = self._components
        if waves is None or known != key:
            h0, omega = self.amplitudes_at(t), self.frequencies
            there = h0 != 0.0
            h0, omega = h0[there], omega[there]
            kx, ky = (np.broadcast_to(k, there.shape)[there] for k in (self.k[:, None], self.k[None, :]))
            phase = (np.angle(h0) + omega * self._base) / (2.0 * math.pi)
            c = self.conditions
            waves = Components(kx, ky, 2.0 * np.abs(h0), omega, phase - np.rint(phase), c.depth, c.density)
            self._components = key, waves
        return waves

    def change(self, t: float, relax: float = 0.0, spectrum: str | Spectrum[Any] | None = None, **changes: Any) -> None:
        """From time t [s] on, other conditions: any of the constructor's that describe wind, gravity or the medium.

        Phases go on without a jump; amplitudes approach their new size as 1 - exp(-(time - t)/relax), at once for
        relax = 0. Losses to viscosity stay: the new size is that of the new spectrum times the fraction that is left.
        Another spectrum takes what both use. Raises ValueError for a value that is not allowed or a condition that the
        spectrum does not use, TypeError for an unknown name.
        """
        t, relax = self._checked_time(t), check_not_negative("relax", relax, "s")
        if self._ripples is not None:
            self._ripples.check_time(t)
        before, rate = self._undecayed(t), self._rate
        medium, conditions, decay = self.medium, self.conditions, self._decay
        raise_if_stopped()
        self._set_conditions(self.spectrum if spectrum is None else spectrum, changes, self.medium)
        self._add_to_past(medium, conditions, decay, t - self._base)
        turns = rate * (t - self._base)
        # h0(k) e^(-i omega t): the phase so far goes into the unit amplitudes, in double.
        self._unit = self._unit * self._full(np.exp(-2j * np.pi * (turns - np.rint(turns))))
        raise_if_stopped()
        self._start = before if relax > 0.0 else self._target
        self._base, self._relax, self._last = t, relax, max(self._last, t)
        self.version += 1
        self._set_planes()
        if self._ripples is not None:
            self._ripples.set_medium(t, self._rate, self._decay, self._push())

    def expose(self, duration: float, medium: Medium | None = None) -> None:
        """Let the waves decay at once as they would in `duration` [s] in a medium, by default in the sea's own.

        The clock stands still, phases stay as they are, rings are not touched. Raises ValueError for a duration that is
        negative or not finite.
        """
        duration = check_not_negative("duration", duration, "s")
        chosen = self.medium if medium is None else check_kind("medium", medium, Medium, "a Medium, or None")
        if duration == 0.0:
            return
        decay = self._decay if medium is None else self._decay_in(medium)
        self._add_to_past(chosen, self.conditions, decay, duration)
        self.version += 1
        self._set_planes()

    def _decay_in(self, medium: Medium) -> np.ndarray:
        """Decay rates [1/s] in another medium, solved once for the same medium and conditions."""
        asked = medium, self.conditions
        if self._other_decay is None or self._other_decay[0] != asked:
            self._other_decay = asked, medium.roots(self._k, self.conditions)[1]
        return self._other_decay[1]

    def resized(self, size: int) -> "Sea":
        """The same sea on a grid of another size: shared waves and rings go on as they are.

        Raises ValueError for a size that is not allowed.
        """
        other = Sea(
            size,
            self.length,
            self.spectrum,
            choppiness=self.choppiness,
            amplitudes=self.amplitudes,
            seed=self.seed,
            precision=self.precision,
            **self._given,
            **{f.name: getattr(self.medium, f.name) for f in dataclasses.fields(self.medium)},
        )
        half = min(self.size, other.size) // 2
        n = np.arange(1 - half, half)
        shared = np.ix_(n, n)  # negative indices count from the end, as FFT order does
        other._start = other._target.copy()
        other._unit[shared], other._start[shared] = self._unit[shared], self._start[shared]
        other._base, other._relax, other._last = self._base, self._relax, self._last
        for (medium, water), duration in self._past.items():
            other._add_to_past(medium, water, medium.roots(other._k, water)[1], duration)
        other._set_planes()
        if self._ripples is not None:
            other.ripples.take_over(self._ripples)
        return other

    @property
    def significant_height(self) -> float:
        """Hs = 4 sqrt(m0) [m] of the amplitudes as drawn, at `time`."""
        return self.significant_height_at(self._last)

    @property
    def time(self) -> float:
        """Time [s] of the last surface computed, or of the last change if that is later."""
        return self._last

    def significant_height_at(self, t: float) -> float:
        """Hs = 4 sqrt(m0) [m] of the amplitudes at time t [s]; rings are not counted."""
        return 4.0 * math.sqrt(2.0 * float((np.abs(self.amplitudes_at(t)) ** 2).sum()))

    def amplitudes_at(self, t: float) -> np.ndarray:
        """h0(k), complex (size, size) [m], FFT order: as large as at time t [s], with the phase of the last change.

        The sea is Re sum 2 h0 exp(i(k.x - omega (t - change))); without a change these are the amplitudes as drawn.
        Raises ValueError for a time that `surface` does not take either.
        """
        return self._unit * self._magnitude(t)

    def energy_at(self, t: float) -> np.ndarray:
        """S(k) dk^2 of each wave at time t, relaxed and decayed, (size, size) [m2], 0 where the tile has no wave."""
        return self._magnitude(t) ** 2 * resolved(self.size)

    def slope_left(self, t: float) -> float:
        """Share of the mean square slope that low-pass and viscosity have left at time t [s]; 1 on a level sea.

        It is that of the tile's waves under the present wind, whether or not they have grown yet.
        """
        lost = self._checked_lost(t)
        c = dataclasses.replace(self.conditions, low_pass=0.0)
        if (self.spectrum, c) != self._sloped_under[0]:
            S = self.spectrum(self.k[:, None], self.k[None, :], c)
            folded = np.zeros_like(self._k)
            raise_if_stopped()
            np.add.at(folded, np.ix_(self._folded, self._folded), S * resolved(self.size))
            self._sloped_under = (self.spectrum, c), folded * self._k**2
        slope = self._sloped_under[1]
        whole = float(slope.sum())
        return float((slope * self._passed * np.exp(-2.0 * lost)).sum()) / whole if whole > 0.0 else 1.0

    def is_steady(self, t: float) -> bool:
        """True if no wave grows or decays any more after time t [s], unless the conditions change."""
        return not self._decays and self._share(t) == 0.0

    @property
    def frequencies(self) -> np.ndarray:
        """omega(k) [rad/s] as propagated, (size, size), FFT order; 0 on the mean and the Nyquist lines."""
        return self._full(2.0 * np.pi * self._rate) * resolved(self.size)

    @property
    def decay_rates(self) -> np.ndarray:
        """Decay rate [1/s] of each wave, (size, size), FFT order."""
        return self._full(self._decay) * resolved(self.size)

    @property
    def ripples(self) -> Ripples:
        """The rings on this sea, made on first use."""
        if self._ripples is None:
            self._ripples = Ripples(self.size, self.length, self._real)
            self._ripples.set_medium(-math.inf, self._rate, self._decay, self._push())
        return self._ripples

    def heights_spectrum(self, t: float) -> np.ndarray:
        """h(k, t) with rings on the half plane ky >= 0, as its real view (N, N + 2). Cached for the last t."""
        key = self._key(t)
        if self._heights is None:
            self._heights = np.zeros((self.size, self.size + 2), self._real)
        if self._evolved != key:
            even, odd = self._planes_at(t)
            fade = self.radial["1"]
            if self._decays:
                fade = np.exp(self._fall * self._real(t - self._base))
            copy = self.transforms.spectrum.view(self._real)
            set_heights(even, odd, self._rate, fade, t - self._base, *self._scratch, self._heights, copy)
            if self._ripples is not None:
                self._ripples.add_to(self._heights, t)
            self._evolved = self._key(t)
        return self._heights

    def mean_height(self, t: float) -> float:
        """Mean height [m] of the displaced points at time t [s], see `Surface.mean_height`. Kept until another t."""
        if self._choppiness == 0.0:
            return 0.0
        key = self._key(t)
        if self._mean_height[0] != key:
            found = self._choppiness * float(weighted_energy(self.heights_spectrum(t), self.radial["k"]))
            self._mean_height = key, found
        return self._mean_height[1]

    def set_input(self, t: float) -> None:
        """The transform's input: `heights_spectrum` and the mean height. Evolving has left a copy there where there are
        no rings."""
        before = self._evolved
        heights, there = self.heights_spectrum(t), self.transforms.spectrum.view(self._real)
        if self._evolved is before or self._ripples is not None:
            there[...] = heights
        there[0, 0] = heights[0, 0] + self.mean_height(t)  # that of rings is the water they brought

    def _key(self, t: float) -> tuple:
        return t, self.version, self._choppiness, self._ripples.version if self._ripples is not None else -1

    def _set_conditions(self, spectrum: str | Spectrum[Any], values: dict[str, Any], medium: Medium) -> None:
        """Check everything, then set spectrum, conditions, medium, and all arrays that depend on them."""
        if not isinstance(spectrum, Spectrum):
            spectrum = SPECTRA[check_choice("spectrum", spectrum, SPECTRA)]
        for name in values:
            if name not in _CONDITIONS | _MEDIUM:
                raise TypeError(f"{name}: no such condition; there are {', '.join(sorted(_CONDITIONS | _MEDIUM))}")
        new = {n: v for n, v in values.items() if n in _CONDITIONS}
        spectrum.check_used(new)
        given = {n: v for n, v in (self._given | new).items() if spectrum.uses(n)}
        conditions = spectrum.conditions(**given)
        medium = dataclasses.replace(medium, **{n: v for n, v in values.items() if n in _MEDIUM})
        omega, decay = medium.roots(self._k, conditions)
        self.spectrum, self.conditions, self.medium, self._given = spectrum, conditions, medium, given
        self._rate, self._decay, self._decays = omega / (2.0 * np.pi), decay, bool(decay.any())
        self._fall = (-decay).astype(self._real)
        raise_if_stopped()
        S = self.spectrum(self.k[:, None], self.k[None, :], conditions)
        dk = 2.0 * math.pi / self.length
        self._passed = np.exp(-((self._k * conditions.low_pass) ** 2))
        if self.spectrum.line is not None:
            self._add_line(S, self.spectrum.line(conditions), dk)
        self._target = np.sqrt(S) * dk
        raise_if_stopped()

    def _add_line(self, S: np.ndarray, line: tuple[float, float, float], dk: float) -> None:
        """Give the energy of one regular wave to the tile's wave that is nearest to it, which is drawn as high as that.

        A wave that is longer than the tile, or too short for its grid, is left out.
        """
        kx, ky, m0 = line
        i, j = round(kx / dk), round(ky / dk)
        if max(abs(i), abs(j)) >= self.size // 2 or i == j == 0:
            return
        S[i, j] += m0 / dk**2
        self._unit = self._unit.copy()  # as copies of this sea share it
        self._unit[i, j] *= math.sqrt(0.5) / abs(self._unit[i, j])

    def _checked_time(self, t: float) -> float:
        """Raises ValueError for a time that is not finite, or before the last change where waves decay or relax."""
        t = check_finite("t", t, "s")
        if t < self._base and (self._relax > 0.0 or self._decays):
            raise argument_error("t", t, f"{self._base:g} s or later: decaying and relaxing waves do not run back")
        return t

    def _checked_lost(self, t: float) -> np.ndarray:
        """-ln of the share of each wave that is left at time t [s], a quarter plane. Errors as for `_checked_time`."""
        t = self._checked_time(t)
        return self._lost + self._decay * (t - self._base) if self._decays else self._lost

    def _add_to_past(self, medium: Medium, conditions: Conditions, decay: np.ndarray, duration: float) -> None:
        """Book a time [s] in a medium, where waves have decayed at these rates (a quarter plane, [1/s])."""
        if duration == 0.0 or not decay.any():
            return
        c = conditions
        water = Conditions(gravity=c.gravity, depth=c.depth, tension=c.tension, density=c.density)
        self._past[medium, water] = self._past.get((medium, water), 0.0) + duration
        self._lost = self._lost + decay * duration

    def _undecayed(self, t: float) -> np.ndarray:
        """sqrt(S dk^2) of each wave at time t, relaxed, as if nothing had decayed, (size, size) [m]."""
        return self._target + self._share(t) * (self._start - self._target)

    def _magnitude(self, t: float) -> np.ndarray:
        """sqrt(S dk^2) of each wave at time t, relaxed and decayed, (size, size) [m]."""
        lost = self._checked_lost(t)
        return self._undecayed(t) * self._full(np.exp(-lost)) if lost.any() else self._undecayed(t)

    def _share(self, t: float) -> float:
        """Share of the last change that is still to come at time t."""
        share = math.exp(-(t - self._base) / self._relax) if self._relax > 0.0 else 0.0
        return share if share > SETTLED_SHARE else 0.0

    def _set_planes(self) -> None:
        """Fold the amplitudes into even and odd half planes: of the target, and of the difference start - target."""
        unit = self._unit * self._full(np.exp(-self._lost)) if self._lost.any() else self._unit
        raise_if_stopped()
        self._settled = self._planes(unit * self._target)
        raise_if_stopped()
        self._to_come = self._planes(unit * (self._start - self._target)) if self._relax > 0.0 else None

    def _planes(self, h0: np.ndarray) -> list[np.ndarray]:
        wide = PRECISIONS[self.precision][1]
        return [np.ascontiguousarray(plane, wide).view(self._real) for plane in fold(h0)]

    def _planes_at(self, t: float) -> list[np.ndarray]:
        share = self._share(t)
        if self._to_come is None or share == 0.0:
            return self._settled
        weight = self._real(share)
        return [plane + weight * rest for plane, rest in zip(self._settled, self._to_come, strict=True)]

    def _push(self) -> np.ndarray:
        """k tanh(kh)/(rho omega) of the quarter plane: the response to an impulse, see ripples.py."""
        c, omega = self.conditions, 2.0 * np.pi * self._rate
        tanh = np.tanh(self._k * c.depth) if math.isfinite(c.depth) else 1.0
        return np.divide(self._k * tanh, c.density * omega, out=np.zeros_like(omega), where=omega > 0.0)

    def _full(self, quarter: np.ndarray) -> np.ndarray:
        """A quarter plane of |kx|, |ky| laid out over the full plane."""
        return quarter[self._folded[:, None], self._folded[None, :]]
