"""Fluids under the waves: clean water, a layer of oil on water, or a mixture; dispersion and decay of waves on them.

Choose a thickness for oil on water, as in nature; `mixed` for the lab's other reading. Limits: only the surface mode
is excited (the interfacial one, slow and hidden, is not), and both fluids are at rest except for the waves.
"""

import dataclasses
import functools
import math
from collections.abc import Callable

import numpy as np

from sim.ocean.dispersion import damped_root, mode_ratios, omega, two_layer, viscous_two_layer
from sim.ocean.fluids.emulsions import MIXTURE_LAWS
from sim.ocean.fluids.fluids import Fluid, fluids, mixed
from sim.validation import argument_error, check_choice, check_number, check_positive
from sim.water import EARTH_GRAVITY

CONTINUOUS = ("plentiful", "oil", "water")


@dataclasses.dataclass(frozen=True, kw_only=True)
class FluidColumn:
    """Oil on, or in, deep water. Raises ValueError for a value that is not allowed, or oil heavier than the water."""

    oil: Fluid = fluids()["Alaska North Slope 2002"]
    water: Fluid = fluids()["sea water"]
    thickness: float = 0.0  # [m] of the layer; 0: clean water
    fraction: float = 0.0  # of oil by volume, entirely mixed; above 0 there is no layer
    law: str = "pal_rhodes"  # of the mixture's viscosity
    continuous: str = "plentiful"  # fluid that an emulsion's drops are in: "plentiful", "oil" or "water"
    film: bool = False  # an inextensible film on top
    gravity: float = EARTH_GRAVITY  # [m/s2]
    mixture_viscosity: float | None = None  # [Pa s] in place of the law's
    decay: Callable[[np.ndarray], np.ndarray] | None = None  # decay rate (k) [1/s] in place of the exact one

    def __post_init__(self) -> None:
        check_number("thickness", self.thickness, "m", 0.0)
        check_number("fraction", self.fraction, "", 0.0, 1.0)
        check_positive("gravity", self.gravity, "m/s2")
        if self.mixture_viscosity is not None:
            check_positive("mixture_viscosity", self.mixture_viscosity, "Pa s")
        if self.law not in MIXTURE_LAWS:
            raise argument_error("law", self.law, "one of " + ", ".join(MIXTURE_LAWS))
        check_choice("continuous", self.continuous, CONTINUOUS)
        if self.kind == "mixed":
            mixed(self.oil, self.water, self.fraction, self.law, self.continuous_fluid)  # refuses too many drops
        if self.oil.density > self.water.density:
            raise argument_error("oil", self.oil.name, f"an oil lighter than the water, {self.water.density:g} kg/m3")

    @property
    def kind(self) -> str:
        """ "water", "layer" or "mixed"."""
        return "mixed" if self.fraction > 0.0 else "layer" if self.thickness > 0.0 else "water"

    @property
    def continuous_fluid(self) -> Fluid:
        """The fluid that the drops of an emulsion are in."""
        is_oil = self.continuous == "oil" or (self.continuous == "plentiful" and self.fraction > 0.5)
        return self.oil if is_oil else self.water

    @property
    def drops(self) -> float:
        """Fraction of the drops in an emulsion, by volume."""
        return 1.0 - self.fraction if self.continuous_fluid is self.oil else self.fraction

    @property
    def surface(self) -> Fluid:
        """The fluid on top."""
        if self.kind == "mixed":
            mixture = mixed(self.oil, self.water, self.fraction, self.law, self.continuous_fluid)
            return mixture if self.mixture_viscosity is None else mixture._replace(viscosity=self.mixture_viscosity)
        return self.oil if self.kind == "layer" else self.water

    @property
    def layers(self) -> tuple[tuple[float, float], ...]:
        """(density [kg/m3], thickness [m]) from the top, for `sim.floating`."""
        if self.kind == "layer":
            return ((self.oil.density, self.thickness), (self.water.density, math.inf))
        return ((self.surface.density, math.inf),)

    def omega(self, k: np.ndarray) -> np.ndarray:
        """Angular frequency [rad/s] of surface waves of wavenumber k [rad/m]; the exact surface mode over a layer."""
        if self.kind != "layer":
            f = self.surface
            return np.asarray(omega(k, self.gravity, math.inf, f.surface_tension or 0.0, f.density))
        return np.asarray(two_layer(k, *self._two())[0])

    def interface_ratio(self, k: np.ndarray) -> np.ndarray:
        """Height of the interface over the surface's in these waves; e^(-kd) without tension."""
        if self.kind != "layer":
            return np.ones_like(np.asarray(k, np.float64))
        return np.asarray(mode_ratios(k, *self._two()).surface)

    def roots(self, k: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """omega [rad/s] and decay rate [1/s] of waves of wavenumber k [rad/m], from the exact linear problem.

        With a custom `decay`, the frequency is that without viscosity.
        """
        k = np.asarray(k, np.float64)
        if self.decay is not None:
            return self.omega(k), np.asarray(self.decay(k))
        if self.kind != "layer":
            return damped_root(self.omega(k), self.surface.kinematic_viscosity * k**2, self.film)
        omega, rate = _layer_roots(self, k.tobytes(), k.shape)
        return omega.copy(), rate.copy()

    def _two(self) -> tuple[float, float, float, float, float, float, float]:
        o = self.oil
        tensions = (o.surface_tension or 0.0, o.interface_tension or 0.0)
        return (o.density, self.thickness, self.water.density, self.gravity, math.inf, *tensions)


@functools.lru_cache(maxsize=32)
def _layer_roots(column: FluidColumn, wavenumbers: bytes, shape: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray]:
    """`FluidColumn.roots` of a layer; cached, because decaying waves need them again and they take up to a second."""
    k = np.frombuffer(wavenumbers).reshape(shape)
    upper, thickness, lower, gravity, _, *tensions = column._two()
    return viscous_two_layer(
        k, upper, column.oil.viscosity, thickness, lower, column.water.viscosity, gravity, *tensions, film=column.film
    )
