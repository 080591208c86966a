"""The water below nonlinear waves: velocity, acceleration and pressure at points, from the expansion of the potential.

The potential is phi = sum_m phi_m, each a sum of waves phi_m(k) e^(ik.x) cosh k(z + h)/cosh kh. That holds below z = 0.
Above, the exponentials of short waves would be far larger than the water's motion. There Taylor's series about z = 0 is
cut at order M in steepness, as in the surface conditions, so that the flow at the surface is that of the method.

The time derivative phi_t is harmonic too. Its value on the surface is psi_t - W eta_t, and the same expansion gives it
below. The acceleration in place is grad phi_t, the pressure beyond that of still water -rho (phi_t + |grad phi|^2/2).
"""

import math

import numpy as np

from sim.ocean.nonlinear.expansion import Expansion
from sim.ocean.nonlinear.lattice_sum import parts_of, set_flow
from sim.ocean.nonlinear.modes import Modes
from sim.ocean.nonlinear.padded_transforms import set_truncated
from sim.waves import Kinematics


class Flow:
    """The flow at one moment."""

    def __init__(self, modes: Modes, expansion: Expansion | None, u: np.ndarray, rate: np.ndarray) -> None:
        """u, rate (2, rows, columns): spectra of elevation and potential, and their whole rates; expansion: None for
        linear waves."""
        self.modes, depth = modes, modes.water.depth
        self.eta = parts_of(u[0], modes.weight)
        self.highest = float(np.hypot(*self.eta).sum())  # [m]: no crest or trough reaches farther
        # cosh k(z + h)/cosh kh = (e^kz + e^-k(z + 2h))/(1 + e^-2kh)
        echo = np.zeros_like(modes.k) if math.isinf(depth) else np.exp(-2.0 * modes.k * depth)
        self.decay = 1.0 / (1.0 + echo), echo / (1.0 + echo)
        flow, change = (u[1][None], rate[1][None]) if expansion is None else self._expanded(expansion, u, rate)
        self.parts = parts_of(np.stack([flow, change], axis=1), modes.weight)

    def _expanded(self, expansion: Expansion, u: np.ndarray, rate: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """`_sums` of the potential and of its rate."""
        # W = (eta_t + grad psi . grad eta)/(1 + |grad eta|^2), exactly
        expansion.set_surface(u[0])
        psi_rate, rise = expansion.planes(2)
        expansion.set_flow(u[1])
        expansion.set_field(rate[0], rise)
        expansion.set_field(rate[1], psi_rate)
        W = (rise + (expansion.slope * expansion.flow).sum(0)) / (1.0 + np.square(expansion.slope).sum(0))
        surface_change = np.empty_like(u[0])
        expansion.set_spectrum(psi_rate - W * rise, surface_change)
        return self._sums(expansion, u[1]), self._sums(expansion, surface_change)

    def _sums(self, expansion: Expansion, surface_value: np.ndarray) -> np.ndarray:
        """(order, rows, columns): sums over m <= order - j of phi_m, for the power j of z."""
        expansion.set_potentials(surface_value)
        sums = np.zeros((expansion.order, *surface_value.shape), complex)
        for phi, out in zip(expansion.phi, sums, strict=True):
            set_truncated(phi.view(float), 1.0, out.view(float))
        return np.ascontiguousarray(np.cumsum(sums, axis=0)[::-1])

    def at(self, points: np.ndarray) -> Kinematics:
        """The water at points (n, 3) [m]; above the surface that on it, below the bottom that at the bottom."""
        m, out = self.modes, np.empty((len(points), 2, 4))
        set_flow(points, np.array(m.length), self.eta, self.highest, self.parts, m.kx, m.ky, m.k, m.tanh, *self.decay,
                 m.water.depth, out)  # fmt: skip
        velocity = np.ascontiguousarray(out[:, 0, 1:])
        pressure = -m.water.density * (out[:, 1, 0] + 0.5 * np.square(velocity).sum(1))
        return Kinematics(velocity, np.ascontiguousarray(out[:, 1, 1:]), pressure)
