"""The equations of motion of a nonlinear sea: rates of its waves, and their energy."""

import numpy as np

from sim.ocean.nonlinear.breaking import Eddies, tail_decay
from sim.ocean.nonlinear.expansion import Expansion
from sim.ocean.nonlinear.fade_in import FadeIn
from sim.ocean.nonlinear.march import Propagator
from sim.ocean.nonlinear.modes import Modes
from sim.ocean.nonlinear.padded_transforms import Work


class WaveEquations:
    """The equations on one grid, with the work of their transforms. Not for two threads at once."""

    def __init__(self, modes: Modes, order: int, fade_in: FadeIn, eddy_scale: float | None = None) -> None:
        """order: of nonlinearity, 1 is linear; eddy_scale: omega/k^2 [m2/s] of the main wave where breaking is damped,
        None: it is not."""
        self.modes, self.order, self.fade_in = modes, order, fade_in
        self.eddy_scale, self.work = eddy_scale, Work()
        self.propagator = Propagator(modes, np.zeros_like(modes.k) if eddy_scale is None else tail_decay(modes))
        self.expansion = Expansion(modes, order, self.work) if order > 1 else None
        self.eddies: Eddies | None = None
        if self.expansion is not None and eddy_scale is not None:
            self.eddies = Eddies(self.expansion, eddy_scale)

    def on_grid(self, modes: Modes) -> "WaveEquations":
        """The same equations on another grid."""
        return WaveEquations(modes, self.order, self.fade_in, self.eddy_scale)

    def set_rates(self, t: float, u: np.ndarray, out: np.ndarray) -> float:
        """Set the nonlinear rates of spectra (2, rows, columns) at time t [s].

        Rates of elevation and potential, times the fade-in factor. Returns the loss to breaking [J/m2/s].
        """
        assert self.expansion is not None
        self.expansion.set_rates(u[0], u[1], out)
        faded = self.fade_in.factor(t)
        if self.eddies is None:
            out *= faded
            return 0.0
        return self.modes.water.density * self.eddies.add_damping(u, faded, self.propagator.decay, out)

    def whole_rates(self, u: np.ndarray) -> np.ndarray:
        """Rates (2, rows, columns) of spectra u, without damping and with all nonlinear terms."""
        rates = np.zeros_like(u)
        if self.expansion is not None:
            self.expansion.set_rates(u[0], u[1], rates)
        rates[0] += self.modes.k * self.modes.tanh * u[1]
        rates[1] -= self.modes.water.gravity * u[0]
        return rates

    def energies(self, u: np.ndarray, rates: np.ndarray) -> tuple[float, float]:
        """Kinetic and potential energy [J/m2] of spectra u that have these whole rates."""
        (eta, psi), water = u, self.modes.water
        kinetic = 0.5 * water.density * self.modes.mean_product(psi, rates[0])
        return kinetic, 0.5 * water.density * water.gravity * self.modes.mean_product(eta, eta)
