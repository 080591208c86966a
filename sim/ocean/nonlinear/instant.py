"""Nonlinear waves at one time."""

import functools
import math

import numpy as np

from sim.ocean.nonlinear.equations import WaveEquations
from sim.ocean.nonlinear.flow import Flow
from sim.ocean.nonlinear.padded_transforms import PaddedTransforms
from sim.ocean.nonlinear.surface import NonlinearSurface


class NonlinearInstant:
    """Spectra at one time and their results, computed when first read."""

    def __init__(self, equations: WaveEquations, transforms: PaddedTransforms, u: np.ndarray, t: float) -> None:
        """u (2, rows, columns): spectra of elevation [m] and surface potential [m2/s], at time t [s]."""
        self.equations, self.transforms, self.u, self.t = equations, transforms, u, t
        self.surface = NonlinearSurface(equations.modes, transforms, u[0], t)

    def moved_to(self, u: np.ndarray, t: float) -> "NonlinearInstant":
        """The waves of the same sea with other spectra, at time t [s]."""
        return NonlinearInstant(self.equations, self.transforms, u, t)

    @functools.cached_property
    def rates(self) -> np.ndarray:
        """Rates (2, rows, columns) of the spectra, without damping and with all nonlinear terms."""
        return self.equations.whole_rates(self.u)

    @functools.cached_property
    def flow(self) -> Flow:
        """The water below."""
        return Flow(self.equations.modes, self.equations.expansion, self.u, self.rates)

    @property
    def energies(self) -> tuple[float, float]:
        """Kinetic and potential energy [J/m2]."""
        return self.equations.energies(self.u, self.rates)

    @property
    def potential(self) -> np.ndarray:
        """Velocity potential (n, m) [m2/s] on the surface."""
        return self.transforms.field_of(self.u[1])

    @property
    def rise(self) -> np.ndarray:
        """Rate (n, m) [m/s] at which the surface rises in place."""
        return self.transforms.field_of(self.rates[0])

    @property
    def significant_height(self) -> float:
        """Hs = 4 sqrt(m0) [m], m0 the variance of the elevation."""
        eta = self.u[0].copy()
        eta[0, 0] = 0.0
        return 4.0 * math.sqrt(self.equations.modes.mean_product(eta, eta))
