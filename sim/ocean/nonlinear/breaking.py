"""Breaking, as damping of the waves that would overturn, which surfaces without overhangs cannot follow.

It has two parts, as in Chalikov, Babanin and Sanina (2014, Ocean Dyn. 64:1469). The shortest waves of the grid decay at
a rate that rises steeply towards its limit: energy that reaches them by steepening leaves there. Where the surface is
steeper than a limit, an eddy viscosity smooths elevation and potential. It rises from 0 at the limit to the size that
Tian, Perlin and Choi (2010, Phys. Fluids 22:036602) measured: 0.02 times height, length and frequency of the breaker.
Limits and sizes are choices; the energy that one breaker loses was not compared with experiments.
"""

import math

import numpy as np

from sim.jit import kernel
from sim.ocean.nonlinear.expansion import Expansion
from sim.ocean.nonlinear.modes import Modes

TAIL_RATE, TAIL_POWER = 0.5, 20  # decay over omega at the grid's limit, and power of k over it
SLOPE_LIMIT = 0.5  # of the surface; the highest wave on deep water has 0.577 at its crest
EDDY_VISCOSITY = 0.02  # over omega/k^2 of the main wave, at a slope of sqrt(2) times the limit
MAX_EDDY_VISCOSITY = 0.1  # the same, of the largest


def tail_decay(modes: Modes) -> np.ndarray:
    """Decay rate (rows, columns) [1/s] of the shortest waves."""
    limit_x = math.pi * modes.size[0] / modes.length[0]
    limit_y = math.pi * modes.size[1] / modes.length[1] if modes.size[1] > 1 else math.inf
    ratio = np.hypot(modes.kx[None, :] / limit_x, modes.ky[:, None] / limit_y)
    return TAIL_RATE * modes.omega * np.minimum(ratio, 1.0) ** TAIL_POWER


class Eddies:
    """Eddy viscosity where the surface is too steep."""

    def __init__(self, expansion: Expansion, scale: float) -> None:
        """scale: omega/k^2 [m2/s] of the main wave."""
        self.expansion, self.scale = expansion, scale
        self.viscosity, self._gradient = expansion.planes(2)
        self.damping = np.zeros((2, *expansion.modes.k.shape), complex)
        self._divergence = np.zeros_like(self.damping[0])

    def add_damping(self, u: np.ndarray, faded: float, decay: np.ndarray, out: np.ndarray) -> float:
        """Multiply the nonlinear rates `out` of the spectra u by `faded`, and add the eddies' damping to them.

        Returns the rate of loss over the density [m3/s3] by the eddies and by the decay rates (rows, columns). The
        expansion has just computed these rates.
        """
        modes = self.expansion.modes
        damping = self.damping if self._set_damping() else out[:0]
        return damp(u.view(float), out.view(float), damping.view(float), modes.omega, modes.water.gravity,
                    decay, modes.weight, faded)  # fmt: skip

    def _set_damping(self) -> bool:
        """Set `damping` to the eddies' rates of elevation and potential.

        Returns False, and sets nothing, if the surface is nowhere too steep.
        """
        e = self.expansion
        if e.steepest <= SLOPE_LIMIT**2:
            return False
        set_eddy_viscosity(e.slope, SLOPE_LIMIT, EDDY_VISCOSITY * self.scale, MAX_EDDY_VISCOSITY * self.scale,
                           self.viscosity)  # fmt: skip
        self.damping[...] = 0.0
        for gradient, out in zip((e.slope, e.flow), self.damping, strict=True):
            for axis, plane in zip(e.axes, gradient, strict=True):
                np.multiply(self.viscosity, plane, out=self._gradient)
                e.set_spectrum(self._gradient, self._divergence)
                out += 1j * axis[0][:, None] * axis[1] * self._divergence
        return True


@kernel
def damp(u, rates, damping, omega, gravity, decay, weight, faded):
    """Set rates (2, rows, 2 columns) to faded rates + damping, and return the loss over the density [m3/s3].

    The energy H has dH/d eta = -psi_t and dH/d psi = eta_t, so that damping rates (a, b) of elevation and potential
    take mean(psi_t a - eta_t b) of it; in the fade-in H is that of the faded terms. damping may be empty.
    """
    lost = 0.0
    is_damped = damping.size > 0
    for i in range(decay.shape[0]):
        for j in range(decay.shape[1]):
            ratio = omega[i, j] * omega[i, j] / gravity
            for part in range(2 * j, 2 * j + 2):
                rates[0, i, part] *= faded
                rates[1, i, part] *= faded
                eta_rate = ratio * u[1, i, part] + rates[0, i, part]
                psi_rate = -gravity * u[0, i, part] + rates[1, i, part]
                a, b = -decay[i, j] * u[0, i, part], -decay[i, j] * u[1, i, part]
                if is_damped:
                    a += damping[0, i, part]
                    b += damping[1, i, part]
                    rates[0, i, part] += damping[0, i, part]
                    rates[1, i, part] += damping[1, i, part]
                lost += weight[j] * (psi_rate * a - eta_rate * b)
    return lost


@kernel(noalias=True)
def set_eddy_viscosity(slope, limit, scale, largest, out):
    """Set out (points,) [m2/s]: scale ((slope/limit)^2 - 1), between 0 and `largest`."""
    for i in range(out.size):
        square = 0.0
        for a in range(slope.shape[0]):
            square += slope[a, i] * slope[a, i]
        out[i] = min(max(scale * (square / (limit * limit) - 1.0), 0.0), largest)
