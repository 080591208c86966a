"""Medium of the waves, apart from their spectrum's conditions: decay, and the lab's changes of the dispersion."""

import dataclasses
import functools
import math
from collections.abc import Callable

import numpy as np

from sim.ocean.dispersion import damped_root
from sim.ocean.fluids.fluid_column import FluidColumn
from sim.ocean.spectra import Conditions
from sim.validation import argument_error, check_kind, check_number


@dataclasses.dataclass(frozen=True, kw_only=True)
class Medium:
    """A medium. Raises ValueError for a value that is not allowed. The bottom takes no energy."""

    viscosity: float = 0.0  # [m2/s] kinematic
    film: bool = False  # the surface cannot be stretched; else it is clean
    dispersion_scale: float = 1.0  # factor on every frequency, after rounding
    # [s] after which the sea repeats at scale 1: omega is rounded down to multiples of 2 pi/period, as in the lab.
    loop_period: float | None = None
    frequency: Callable[[np.ndarray], np.ndarray] | None = None  # omega(k) [rad/s] in place of the conditions' own
    decay: Callable[[np.ndarray], np.ndarray] | None = None  # decay rate (k) [1/s] in place of the viscosity's

    def __post_init__(self) -> None:
        check_number("viscosity", self.viscosity, "m2/s", 0.0, 1e6)
        check_number("dispersion_scale", self.dispersion_scale, "", 0.0, 1e6)
        check_kind("film", self.film, bool, "True or False")
        for name in ("frequency", "decay"):
            function = getattr(self, name)
            if function is not None and not callable(function):
                raise argument_error(name, function, "a function of the wavenumber, or None")
        if self.loop_period is not None:
            check_number("loop_period", self.loop_period, "s", 1e-6, 1e12)

    def roots(self, k: np.ndarray, conditions: Conditions) -> tuple[np.ndarray, np.ndarray]:
        """omega [rad/s] and decay rate [1/s] of wavenumbers k [rad/m].

        Raises ValueError if a function for either returns another shape than that of k, or values that are negative or
        not finite.
        """
        natural = conditions.omega(k) if self.frequency is None else self._given("frequency", k)
        omega, decay = damped_root(natural, self.viscosity * k**2, self.film)
        if self.decay is not None:
            omega, decay = natural, self._given("decay", k)
        if self.loop_period is not None:
            base = 2.0 * math.pi / self.loop_period
            omega = np.floor(omega / base) * base
        return omega * self.dispersion_scale, decay

    def _given(self, name: str, k: np.ndarray) -> np.ndarray:
        """Checked values at k of the user's function of this name."""
        values = np.asarray(getattr(self, name)(k), np.float64)
        if values.shape != k.shape:
            raise argument_error(name, values.shape, f"a function that returns the shape of k, {k.shape}")
        if not (np.isfinite(values) & (values >= 0.0)).all():
            raise argument_error(name, float(values[~(values >= 0.0) | ~np.isfinite(values)][0]), "0 or above, finite")
        return values


@functools.lru_cache(maxsize=64)
def medium_of(column: FluidColumn) -> Medium:
    """The medium in which waves decay as on a column. The same for the same column, so that its roots are kept."""
    return Medium(decay=lambda k: column.roots(k)[1])
