"""The square sea: a periodic tile of linear waves, evaluated at any time by real FFTs (Tessendorf 2001).

Choose it for a surface that fills a tile; the radial sum of `radial.py` for one that reaches the horizon. Time is
analytic: nothing accumulates, and a frame costs the transforms it reads plus one pass over half the spectrum.
Limits: linear waves, made sharper by the choppy displacement; a tile shorter than the dominant wave loses its energy.

>>> sea = Sea(128, 800.0, "sea_state", hs=3.0, tp=10.0)
>>> sea.surface(t=5.0).height.shape  # [m]
(128, 128)
>>> height, residual = sea.height_at([[100.0, 50.0], [0.0, 0.0]], t=5.0)
>>> flow = sea.kinematics([[0.0, 0.0, -5.0]], t=5.0)
>>> height.shape, flow.velocity.shape, flow.pressure.shape
((2,), (1, 3), (1,))
>>> sea.change(t=10.0, relax=60.0, hs=1.0)  # it calms down
>>> sea.significant_height_at(10.0) > sea.significant_height_at(500.0)
True
"""

import copy
import dataclasses
import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from sim.interruption import raise_if_stopped
from sim.ocean.any_sea import AnySea
from sim.ocean.fluids.fluid_column import FluidColumn
from sim.ocean.fluids.medium import Medium, medium_of
from sim.ocean.spectra import PARAMETERS, Conditions, Spectrum
from sim.ocean.spectra.record import named_spectrum
from sim.ocean.statistics.slope_spectrum import SlopeSpectrum
from sim.ocean.tile.amplitudes import KINDS, resolved, unit_amplitudes, with_line
from sim.ocean.tile.query import query
from sim.ocean.tile.ripples import Ripples
from sim.ocean.tile.surface import Surface
from sim.ocean.tile.tile_heights import TileHeights
from sim.ocean.tile.tile_surface import TileSurface
from sim.ocean.tile.tile_waves import DrawnWaves, TileWaves
from sim.ocean.tile.transforms import PRECISIONS, Transforms
from sim.ocean.tile.wavenumbers import Wavenumbers
from sim.parameters import similar
from sim.validation import argument_error, check_choice, check_kind, check_number, check_positions, is_whole_number
from sim.water import EARTH_GRAVITY
from sim.waves import Waves

SIZES = (8, 4096)
LENGTHS = (1e-3, 1e8)  # [m]


_CONDITIONS = frozenset(f.name for f in dataclasses.fields(Conditions)) | PARAMETERS.keys()
_MEDIUM = frozenset(f.name for f in dataclasses.fields(Medium))


class Sea(TileSurface, AnySea):
    """A tile of sea. Index [i, j] of a field is x = i length/size, y = j length/size. Not for two threads at once."""

    def __init__(
        self,
        size: int = 256,
        length: float = 500.0,
        spectrum: str | Spectrum[Any] = "pierson_moskowitz",
        wind_speed: float = 10.0,
        wind_direction: float = 0.0,
        gravity: float = EARTH_GRAVITY,
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

        spectrum: a name in `SPECTRA`, or a custom record; a regular wave that does not fit the tile is warned of.

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
        self.size, self.length, self.seed = int(size), check_number("length", length, "m", *LENGTHS), int(seed)
        self.precision, self.amplitudes = precision, amplitudes
        self.choppiness = choppiness
        self._wavenumbers = Wavenumbers(self.size, self.length, precision)
        self.k = self._wavenumbers.k  # [rad/m], FFT order
        self._slopes: SlopeSpectrum | None = None  # of the last call of `slope_left`
        conditions = {
            "wind_speed": wind_speed,
            "wind_direction": wind_direction,
            "gravity": gravity,
            "depth": depth,
            "tension": tension,
            "viscosity": viscosity,
        }
        self._given: dict[str, Any] = {}  # conditions as given, those that the spectrum uses
        drawn = self._draw(spectrum, conditions | more, Medium(), unit_amplitudes(self.size, self.seed, amplitudes))
        self._waves = TileWaves(self._wavenumbers, drawn)
        self.transforms = Transforms(self.size, precision)
        self._heights = TileHeights(self._waves, self.transforms)

    def __deepcopy__(self, memo: dict[int, Any]) -> "Sea":
        """An independent copy of the sea.

        It shares arrays that are never changed in place, and the transforms: both seas are for the same thread.
        """
        other = copy.copy(self)
        other._waves = self._waves.copied()
        other._heights = self._heights.copied(other._waves, memo)
        return other

    @property
    def version(self) -> int:
        """Number of changes of the waves so far, by `change` and `expose`."""
        return self._waves.version

    @property
    def choppiness(self) -> float:
        """Factor on the horizontal displacement, 0 or above; 0 costs no transform."""
        return self._choppiness

    @choppiness.setter
    def choppiness(self, value: float) -> None:
        self._choppiness = check_number("choppiness", value, "", 0.0)

    def surface(self, t: float) -> Surface:
        """The surface at time t [s]; each field is computed when first read. Raises ValueError for a time not allowed:
        not finite, or before the last change where waves decay or relax."""
        return self._heights.surface(self._waves.checked_time(t), self._choppiness)

    def height_at(self, points: ArrayLike, t: float, exact: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Height (n,) [m] of the displaced surface above points (n, 2) [m] at time t, and the residual (n,) [m].

        Its mean over the tile is that of still water, 0, see `Surface.mean_height`.

        The residual is the horizontal miss |x + D(x) - point| of the solution found; it is at rounding wherever the
        surface does not fold, and a large one means that the surface above the point is folded. Between grid points
        fields are bicubic; exact: the sum over all waves instead, slow. Raises ValueError for another shape.
        """
        check_kind("exact", exact, bool, "True or False")
        return query(self.surface(t), check_positions("points", points), exact)[:2]

    def waves_at(self, t: float | None = None) -> Waves:
        """The waves of the tile, as high as at time t [s], by default the sea's own; `largest` of them picks a few.

        They hold at all times unless waves decay, relax or are changed. Raises ValueError as `surface`.
        """
        t = self.time if t is None else self._waves.checked_time(t)
        return self._waves.waves_at(t, self.conditions.water)

    def change(self, t: float, relax: float = 0.0, spectrum: str | Spectrum[Any] | None = None, **changes: Any) -> None:
        """From time t [s] on, other conditions: any of the constructor's that describe wind, gravity or the medium.

        Phases continue without a jump; amplitudes approach their new size as 1 - exp(-(time - t)/relax), at once for
        relax = 0. Losses to viscosity stay: the new size is that of the new spectrum times the fraction that is left.
        Another spectrum keeps the conditions that both use. Raises ValueError for a value that is not allowed or a
        condition that the spectrum does not use, TypeError for an unknown name.
        """
        t, relax = self._waves.checked_time(t), check_number("relax", relax, "s", 0.0)
        waves, ripples, chosen = self._waves, self._heights.ripples, self.spectrum if spectrum is None else spectrum
        if ripples is not None:
            ripples.check_time(t)
        medium, conditions = self.medium, self.conditions
        raise_if_stopped()
        drawn = self._draw(chosen, changes, medium, waves.unit)
        waves.change(t, relax, drawn, medium, conditions)
        self._heights.time = max(self.time, t)
        if ripples is not None:
            ripples.set_medium(t, self._wavenumbers.quarter, waves.rate, waves.decay, self.conditions)

    def expose(self, duration: float, medium: Medium | FluidColumn | None = None) -> None:
        """Let the waves decay at once as they would in `duration` [s] in a medium, by default in the sea's own.

        The clock stands still, phases stay as they are, rings are not touched. Raises ValueError for a duration that is
        negative or not finite.
        """
        duration = check_number("duration", duration, "s", 0.0)
        if isinstance(medium, FluidColumn):
            medium = medium_of(medium)
        kinds = "a Medium, a FluidColumn, or None"
        chosen = self.medium if medium is None else check_kind("medium", medium, Medium, kinds)
        if duration == 0.0:
            return
        decay = self._waves.decay if medium is None else self._waves.decay_in(medium, self.conditions)
        self._waves.expose(chosen, self.conditions, decay, duration)

    def resized(self, size: int) -> "Sea":
        """The same sea on a grid of another size: shared waves and rings continue as they are.

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
        other._waves.take_over(self._waves)
        other._heights.time = self.time
        if self._heights.ripples is not None:
            other.ripples.take_over(self._heights.ripples)
        return other

    @property
    def significant_height(self) -> float:
        """Hs = 4 sqrt(m0) [m] of the amplitudes as drawn, at `time`."""
        return self.significant_height_at(self.time)

    @property
    def time(self) -> float:
        """Time [s] of the last surface computed, or of the last change if that is later."""
        return self._heights.time

    def significant_height_at(self, t: float) -> float:
        """Hs = 4 sqrt(m0) [m] of the amplitudes at time t [s]; rings are not counted."""
        return 4.0 * math.sqrt(2.0 * float((np.abs(self.amplitudes_at(t)) ** 2).sum()))

    def amplitudes_at(self, t: float) -> np.ndarray:
        """h0(k), complex (size, size) [m], FFT order: as large as at time t [s], with the phase of the last change.

        The sea is Re sum 2 h0 exp(i(k.x - omega (t - change))); without a change these are the amplitudes as drawn.
        Raises ValueError for a time that `surface` refuses.
        """
        return self._waves.amplitudes(t)

    def energy_at(self, t: float) -> np.ndarray:
        """S(k) dk^2 of each wave at time t, relaxed and decayed, (size, size) [m2], 0 where the tile has no wave."""
        return self._waves.magnitude(t) ** 2 * resolved(self.size)

    def slope_left(self, t: float) -> float:
        """Fraction of the mean square slope that low-pass and viscosity have left at time t [s]; 1 on a level sea.

        It is that of the tile's waves under the present wind, whether or not they have grown yet.
        """
        lost = self._waves.lost_at(t)
        spectrum, unfiltered = self.spectrum, dataclasses.replace(self.conditions, low_pass=0.0)
        slopes = self._slopes
        if slopes is None or (slopes.spectrum, slopes.conditions) != (spectrum, unfiltered):
            slopes = self._slopes = SlopeSpectrum(self._wavenumbers, spectrum, unfiltered)
        return slopes.share_left(self.conditions.low_pass, lost)

    def is_steady(self, t: float) -> bool:
        """True if no wave grows or decays any more after time t [s], unless the conditions change."""
        return self._waves.is_steady(t)

    @property
    def frequencies(self) -> np.ndarray:
        """omega(k) [rad/s] as propagated, (size, size), FFT order; 0 on the mean and the Nyquist lines."""
        return self._waves.frequencies

    @property
    def decay_rates(self) -> np.ndarray:
        """Decay rate [1/s] of each wave, (size, size), FFT order."""
        return self._wavenumbers.full(self._waves.decay) * resolved(self.size)

    @property
    def ripples(self) -> Ripples:
        """The rings on this sea, made on first use."""
        heights, waves, numbers = self._heights, self._waves, self._wavenumbers
        if heights.ripples is None:
            heights.ripples = Ripples(self.size, self.length, numbers.real)
            heights.ripples.set_medium(-math.inf, numbers.quarter, waves.rate, waves.decay, self.conditions)
        return heights.ripples

    def heights_spectrum(self, t: float) -> np.ndarray:
        """h(k, t) with rings on the half plane ky >= 0, as its real view (N, N + 2). Cached for the last t."""
        return self._heights.spectrum(t)

    def mean_height(self, t: float) -> float:
        """Mean height [m] of the displaced points at time t [s], see `Surface.mean_height`. Kept until another t."""
        return self._heights.mean_height(t, self._choppiness)

    def _draw(
        self, spectrum: str | Spectrum[Any], values: dict[str, Any], medium: Medium, unit: np.ndarray
    ) -> DrawnWaves:
        """Check everything, then set spectrum, conditions and medium, and return their waves.

        unit: amplitudes over their size, a full plane.
        """
        chosen, arguments = checked_conditions(spectrum, values, self._given)
        conditions = chosen.conditions(**arguments)
        medium = dataclasses.replace(medium, **{n: v for n, v in values.items() if n in _MEDIUM})
        omega, decay = medium.roots(self._wavenumbers.quarter, conditions)
        raise_if_stopped()
        S = chosen(self.k[:, None], self.k[None, :], conditions)
        dk = 2.0 * math.pi / self.length
        if chosen.line is not None:
            unit = with_line(S, unit, chosen.line(conditions), dk)
        target = np.sqrt(S) * dk
        raise_if_stopped()
        self.spectrum, self.conditions, self.medium, self._given = chosen, conditions, medium, arguments
        return DrawnWaves(unit, target, omega, decay, conditions.depth)


def checked_conditions(
    spectrum: str | Spectrum[Any], values: dict[str, Any], earlier_values: dict[str, Any]
) -> tuple[Spectrum[Any], dict[str, Any]]:
    """A spectrum, and those of the conditions in `earlier_values` and now in `values` that it uses.

    Raises ValueError for an unknown spectrum or a condition that it does not use, TypeError for an unknown name.
    """
    spectrum = named_spectrum(spectrum)
    for name in values:
        if name not in _CONDITIONS | _MEDIUM:
            close = " or ".join(similar(name, _CONDITIONS | _MEDIUM))
            known = f"did you mean {close}?" if close else f"there are {', '.join(sorted(_CONDITIONS | _MEDIUM))}"
            raise TypeError(f"{name}: no such condition; {known}")
    new = {n: v for n, v in values.items() if n in _CONDITIONS}
    spectrum.check_used(new)
    return spectrum, {n: v for n, v in (earlier_values | new).items() if spectrum.uses(n)}
