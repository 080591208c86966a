"""What waves propagate in, apart from their spectrum's conditions: decay, and the lab's ways to bend dispersion."""

import dataclasses
import math
from collections.abc import Callable

import numpy as np

from sim.ocean.dispersion import damped_root
from sim.ocean.spectra import Conditions
from sim.validation import check_not_negative, check_positive


@dataclasses.dataclass(frozen=True, kw_only=True)
class Medium:
    """A medium. Raises ValueError for a value that is not allowed. The bottom takes no energy."""

    viscosity: float = 0.0  # [m2/s] kinematic
    film: bool = False  # decay as under an inextensible film instead of a clean surface
    dispersion_scale: float = 1.0  # factor on every frequency
    loop_period: float | None = None  # [s] after which the sea repeats: omega is floored to multiples of 2 pi/period
    frequency: Callable[[np.ndarray], np.ndarray] | None = None  # omega(k) in place of the conditions' own

    def __post_init__(self) -> None:
        check_not_negative("viscosity", self.viscosity, "m2/s")
        check_not_negative("dispersion_scale", self.dispersion_scale, "")
        if self.loop_period is not None:
            check_positive("loop_period", self.loop_period, "s")

    def roots(self, k: np.ndarray, conditions: Conditions) -> tuple[np.ndarray, np.ndarray]:
        """omega [rad/s] and decay rate [1/s] of wavenumbers k [rad/m]."""
        natural = conditions.omega(k) if self.frequency is None else np.asarray(self.frequency(k), np.float64)
        if self.film:
            # Lamb, Art. 351: gamma = k sqrt(nu omega/8)
            omega, decay = natural, k * np.sqrt(self.viscosity * natural / 8.0)
        else:
            omega, decay = damped_root(natural, self.viscosity * k**2)
        omega = omega * self.dispersion_scale
        if self.loop_period is not None:
            base = 2.0 * math.pi / self.loop_period
            omega = np.floor(omega / base) * base
        return omega, decay
