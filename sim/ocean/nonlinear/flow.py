"""The water below nonlinear waves: velocity, acceleration and pressure at points, from the expansion of the potential.

The potential is phi = sum_m phi_m, each a sum of waves phi_m(k) e^(ik.x) cosh k(z + h)/cosh kh. That holds below z = 0.
Above, the exponentials of short waves would be far larger than the water's motion. There Taylor's series about z = 0 is
cut at order M in steepness, as in the surface conditions, so that the flow at the surface is that of the method.

The time derivative phi_t is harmonic too. Its value on the surface is psi_t - W eta_t, and the same expansion gives it
below. The acceleration in place is grad phi_t, the pressure beyond that of still water -rho (phi_t + |grad phi|^2/2).
"""

import math

import numpy as np

from sim.jit import kernel
from sim.ocean.nonlinear.expansion import Expansion
from sim.ocean.nonlinear.modes import Modes
from sim.ocean.nonlinear.padded_transforms import set_truncated
from sim.waves import Kinematics


class Flow:
    """The flow at one moment."""

    def __init__(
        self, modes: Modes, expansion: Expansion | None, density: float, u: np.ndarray, rate: np.ndarray
    ) -> None:
        """u, rate (2, rows, columns): spectra of elevation and potential, and their whole rates; expansion: None for
        linear waves."""
        self.modes, self.density, self.eta = modes, density, u[0]
        if expansion is None:
            self.flow, self.change = u[1][None], rate[1][None]
            return
        # W = (eta_t + grad psi . grad eta)/(1 + |grad eta|^2), exactly
        expansion.set_surface(u[0])
        psi_rate, rise = expansion.planes(2)
        expansion.set_flow(u[1])
        expansion.set_field(rate[0], rise)
        expansion.set_field(rate[1], psi_rate)
        W = (rise + (expansion.slope * expansion.flow).sum(0)) / (1.0 + np.square(expansion.slope).sum(0))
        surface_change = np.empty_like(u[0])
        expansion.set_spectrum(psi_rate - W * rise, surface_change)
        self.flow, self.change = (self._sums(expansion, value) for value in (u[1], surface_change))

    def _sums(self, expansion: Expansion, surface_value: np.ndarray) -> np.ndarray:
        """(order, rows, columns): sums over m <= order - j of phi_m, for the power j of z."""
        expansion.set_potentials(surface_value)
        sums = np.zeros((expansion.order, *surface_value.shape), complex)
        for phi, out in zip(expansion.phi, sums, strict=True):
            set_truncated(phi.view(float), 1.0, out.view(float))
        return np.ascontiguousarray(np.cumsum(sums, axis=0)[::-1])

    def at(self, points: np.ndarray) -> Kinematics:
        """The water at points (n, 3) [m]; above the surface that on it, below the bottom that at the bottom."""
        m, n = self.modes, len(points)
        values = np.empty((2, n, 4))
        for sums, out in zip((self.flow, self.change), values, strict=True):
            set_flow(points, self.eta, sums, m.kx, m.ky, m.k, m.tanh, m.depth, out)
        velocity = np.ascontiguousarray(values[0, :, 1:])
        pressure = -self.density * (values[1, :, 0] + 0.5 * np.square(velocity).sum(1))
        return Kinematics(velocity, np.ascontiguousarray(values[1, :, 1:]), pressure)


@kernel
def height_at(x, y, eta, kx, ky):
    """Elevation [m] at a point, by the sum over all waves."""
    height = 0.0
    for i in range(ky.size):
        for j in range(kx.size):
            theta = kx[j] * x + ky[i] * y
            c = eta[i, j].real * math.cos(theta) - eta[i, j].imag * math.sin(theta)
            height += c if j == 0 else 2.0 * c
    return height


@kernel
def set_heights(points, eta, kx, ky, out):
    """Set out (n,) [m] to the elevation above points (n, 2) [m]."""
    for p in range(points.shape[0]):
        out[p] = height_at(points[p, 0], points[p, 1], eta, kx, ky)


@kernel
def set_flow(points, eta, sums, kx, ky, k, tanh, depth, out):
    """Set out (n, 4): a harmonic function and its derivatives along x, y, z at points (n, 3).

    sums: see `Flow._sums`.
    """
    for p in range(points.shape[0]):
        x, y, z = points[p, 0], points[p, 1], max(points[p, 2], -depth)
        if z > 0.0:
            z = min(z, max(height_at(x, y, eta, kx, ky), 0.0))
        value = along = across = up = 0.0
        for i in range(ky.size):
            for j in range(kx.size):
                K = k[i, j]
                theta = kx[j] * x + ky[i] * y
                c, s = math.cos(theta), math.sin(theta)
                # a: the potential's amplitude at z, b: that of its vertical derivative
                if z > 0.0:
                    a = b = 0.0j
                    power = 1.0
                    for n in range(sums.shape[0]):
                        even, odd = (tanh[i, j], 1.0) if n % 2 else (1.0, tanh[i, j])
                        a += power * even * sums[n, i, j]
                        b += power * odd * K * sums[n, i, j]
                        power *= K * z / (n + 1)
                else:
                    # cosh k(z + h)/cosh kh = (e^kz + e^-k(z + 2h))/(1 + e^-2kh)
                    near, far = math.exp(K * z), math.exp(-K * (z + 2.0 * depth)) if K > 0.0 else 1.0
                    both = 1.0 + math.exp(-2.0 * K * depth) if K > 0.0 else 2.0
                    a = sums[0, i, j] * ((near + far) / both)
                    b = sums[0, i, j] * (K * (near - far) / both)
                twice = 1.0 if j == 0 else 2.0
                real, imaginary = twice * (a.real * c - a.imag * s), twice * (a.real * s + a.imag * c)
                value += real
                along -= kx[j] * imaginary
                across -= ky[i] * imaginary
                up += twice * (b.real * c - b.imag * s)
        out[p, 0], out[p, 1], out[p, 2], out[p, 3] = value, along, across, up
