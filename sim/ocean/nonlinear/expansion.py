"""The high-order spectral method: rates of surface elevation and surface potential up to an order M in steepness.

With psi(x, t) the velocity potential on the surface z = eta(x, t) and W the vertical velocity there (Zakharov 1968):

  eta_t = -grad psi . grad eta + (1 + |grad eta|^2) W
  psi_t = -g eta - |grad psi|^2/2 + (1 + |grad eta|^2) W^2/2

The potential is a sum phi_1 + ... + phi_M; phi_m is of order m in steepness and harmonic below z = 0. Taylor's series
about z = 0 gives each from those before (Dommermuth and Yue 1987, J. Fluid Mech. 184:267):

  phi_1 = psi,  phi_m = -sum_{j=1}^{m-1} eta^j/j! d^j phi_{m-j}/dz^j
  W_m = sum_{j=0}^{m-1} eta^j/j! d^{j+1} phi_{m-j}/dz^{j+1}       at z = 0

Products of series are cut at order M (West et al. 1987, J. Geophys. Res. 92:11803): (1 + |grad eta|^2) W becomes
W_1 + ... + W_M + |grad eta|^2 (W_1 + ... + W_{M-2}), W^2 the sum of W_i W_j with i + j <= M, or <= M - 2. These are
Hamilton's equations of an energy that is cut at the same order, which is therefore conserved.

Rates are truncated to the sea's wavenumbers; phi_m keeps min(m, M - m + 1) times as many along each axis, those that
later products can fold back. The terms of W for short waves on a high crest are large and cancel only with these
wavenumbers: without them a wave of k a = 0.3 on 32 cells breaks up within two periods at order 7.
"""

import numpy as np

from sim.jit import kernel
from sim.ocean.nonlinear.modes import Modes, make_modes
from sim.ocean.nonlinear.padded_transforms import (
    PaddedTransforms,
    Work,
    add_multiple,
    aligned,
    padded_size,
    set_derivative,
    set_multiple,
    set_truncated,
)

BLOCK = 256  # points at a time: the sums of a block stay in the fastest cache


class Expansion:
    """The rates of one sea, of order 2 or above. Not for two threads at once."""

    def __init__(self, modes: Modes, order: int, work: Work) -> None:
        self.modes, self.order = modes, order
        (n, m), axes = modes.size, 1 if modes.size[1] == 1 else 2
        shape = padded_size(m, order), padded_size(n, order)
        self.widths = [min(j, order - j + 1) for j in range(1, order + 1)]  # of phi_j, over the sea's
        sizes = {width: (width * n, width * m if m > 1 else 1) for width in self.widths}
        self._transforms = {width: PaddedTransforms(shape, sizes[width][0] // 2, work) for width in sizes}
        # d^j phi/dz^j at z = 0 is k^j phi, and for odd j times tanh(k depth). Twice: for real and imaginary parts.
        self._factors = {}
        for width, size in sizes.items():
            wide = make_modes(size, modes.length, modes.water)
            factors = [wide.k**j * (wide.tanh if j % 2 else 1.0) for j in range(order + 1)]
            self._factors[width] = [np.repeat(factor, 2, axis=1) for factor in factors]
        rows, columns = np.ones_like(modes.ky), np.ones_like(modes.kx)
        self.axes = ((rows, modes.kx), (modes.ky, columns))[:axes]
        self.phi = [np.zeros_like(self._factors[width][0]).view(complex) for width in self.widths]
        # Derivatives of phi_j follow each other; d phi_M/dz has no product and stays a spectrum.
        counts = [order - j for j in range(order)]
        self._first = np.cumsum([0, *counts[:-1]])
        self._derivatives = self.planes(sum(counts) - 1)
        self.eta, self._product = self.planes(2)
        self.steepest = 0.0  # |grad eta|^2 of the last rates
        self.slope, self.flow, self._rate = (self.planes(count) for count in (axes, axes, 2))
        self._block = np.empty((2 * order + 4, BLOCK))

    def planes(self, count: int) -> np.ndarray:
        """Grids (count, points) of padded size."""
        rows, cells = self._transforms[1].shape
        return aligned((count, rows * cells), np.float64)

    def set_surface(self, eta: np.ndarray) -> None:
        """Set the elevation, a spectrum."""
        self.set_field(eta, self.eta)
        for axis, plane in zip(self.axes, self.slope, strict=True):
            self._set_derivative(eta, axis, plane)

    def set_flow(self, psi: np.ndarray) -> None:
        """Set the gradient of the surface potential, a spectrum."""
        for axis, plane in zip(self.axes, self.flow, strict=True):
            self._set_derivative(psi, axis, plane)

    def set_potentials(self, surface_value: np.ndarray) -> None:
        """Set `phi` to the spectra of a harmonic function at z = 0, in parts by order, and their vertical derivatives.

        surface_value: its spectrum on the surface; `set_surface` comes first.
        """
        self.phi[0][...] = surface_value
        for m, (phi, width) in enumerate(zip(self.phi, self.widths, strict=True), 1):
            if m > 1:
                set_potential(m, self.eta, self._derivatives, self._first, self._product)
                self.set_spectrum(self._product, phi, width)
            for j in range(self.order - m + 1 if m < self.order else 0):
                self.set_field(phi, self._derivatives[self._first[m - 1] + j], j + 1, width)

    def set_rates(self, eta: np.ndarray, psi: np.ndarray, out: np.ndarray) -> None:
        """Set out (2, rows, columns) to the rates of the spectra eta, psi without their linear part."""
        self.set_surface(eta)
        self.set_flow(psi)
        self.set_potentials(psi)
        self.steepest = set_surface_rates(self.order, self.eta, self.slope, self.flow, self._derivatives, self._first,
                                          self._block, self._rate[0], self._rate[1])  # fmt: skip
        self.set_spectrum(self._rate[0], out[0])
        self.set_spectrum(self._rate[1], out[1])
        add_multiple(self.phi[-1].view(float), self._factors[1][1], out[0].view(float))
        out[1, 0, 0] = 0.0  # a constant of the potential moves nothing

    def set_field(self, spectrum: np.ndarray, plane: np.ndarray, derivative: int = 0, width: int = 1) -> None:
        """Set a plane to the field of a spectrum, `width` times as wide as the sea's, or to its vertical derivative."""
        transforms, factor = self._transforms[width], self._factors[width][derivative]
        set_multiple(spectrum.view(float), factor, transforms.spectrum.view(float))
        transforms.set_grid(plane)

    def set_spectrum(self, plane: np.ndarray, out: np.ndarray, width: int = 1) -> None:
        """Set a spectrum, `width` times as wide as the sea's, to that of a plane."""
        transforms = self._transforms[width]
        transforms.set_result(plane)
        set_truncated(transforms.result.view(float), 1.0 / plane.size, out.view(float))

    def _set_derivative(self, spectrum: np.ndarray, axis: tuple[np.ndarray, np.ndarray], plane: np.ndarray) -> None:
        transforms = self._transforms[1]
        set_derivative(spectrum.view(float), *axis, transforms.spectrum.view(float))
        transforms.set_grid(plane)


@kernel(noalias=True, inline=True)
def set_to(value, out):
    for i in range(out.size):
        out[i] = value


@kernel(noalias=True, inline=True)
def set_product(x, y, factor, out):
    for i in range(out.size):
        out[i] = factor * x[i] * y[i]


@kernel(noalias=True, inline=True)
def add_product(x, y, out):
    for i in range(out.size):
        out[i] += x[i] * y[i]


@kernel(noalias=True, inline=True)
def scale_by(x, factor, out):
    for i in range(out.size):
        out[i] *= factor * x[i]


@kernel(noalias=True, inline=True)
def set_series(x, eta, factor, y, out):
    """One level of a power series: out = y + factor eta x."""
    for i in range(out.size):
        out[i] = y[i] + factor * eta[i] * x[i]


@kernel(noalias=True, inline=True)
def raise_series(eta, factor, y, out):
    """The same with x in out."""
    for i in range(out.size):
        out[i] = y[i] + factor * eta[i] * out[i]


@kernel(noalias=True, inline=True)
def set_sum(x, y, out):
    for i in range(out.size):
        out[i] = x[i] + y[i]


@kernel(noalias=True)
def set_potential(m, eta, derivatives, first, out):
    """Set phi_m on the grid: -sum_{j=1}^{m-1} eta^j/j! d^j phi_{m-j}/dz^j, from the last term on."""
    for start in range(0, eta.size, BLOCK):
        stop = min(start + BLOCK, eta.size)
        height, here = eta[start:stop], out[start:stop]
        last = derivatives[first[0] + m - 2, start:stop]
        if m == 2:
            set_product(last, height, -1.0, here)
            continue
        set_series(last, height, 1.0 / (m - 1), derivatives[first[1] + m - 3, start:stop], here)
        for j in range(m - 3, 0, -1):
            raise_series(height, 1.0 / (j + 1), derivatives[first[m - j - 1] + j - 1, start:stop], here)
        scale_by(height, -1.0, here)


@kernel(noalias=True)
def set_surface_rates(order, eta, slope, flow, derivatives, first, scratch, elevation, potential):
    """Set the rates on the grid without their linear part and without d phi_M/dz; returns the largest |grad eta|^2.

    slope, flow (axes, points): grad eta, grad psi; scratch (2 order + 4, BLOCK).
    """
    # Rows of scratch: W_1 ... W_M, their sums S_2 ... S_M, and three more. One-dimensional rows only: loops over them
    # are vectorised.
    M, steepest = order, 0.0
    for start in range(0, eta.size, BLOCK):
        stop = min(start + BLOCK, eta.size)
        n, height = stop - start, eta[start:stop]
        square, outer, steep = scratch[2 * M, :n], scratch[2 * M + 1, :n], scratch[2 * M + 2, :n]
        set_to(1.0, steep)
        set_product(derivatives[first[0], start:stop], steep, 1.0, scratch[0, :n])
        for m in range(1, M):
            W, last = scratch[m, :n], derivatives[first[0] + m, start:stop]
            for j in range(m - 1, -1, -1):
                # d phi_M/dz, of the last W at j = 0, is left out.
                if j == 0 and m == M - 1:
                    if m == 1:
                        set_product(last, height, 1.0, W)
                    else:
                        scale_by(height, 1.0, W)
                elif j == m - 1:
                    set_series(last, height, 1.0 / m, derivatives[first[1] + j, start:stop], W)
                else:
                    raise_series(height, 1.0 / (j + 1), derivatives[first[m - j] + j, start:stop], W)
        for m in range(1, M):
            set_sum(scratch[sum_row(m, M), :n], scratch[m, :n], scratch[sum_row(m + 1, M), :n])
        # Sums of W_i W_j with i + j <= M, and with i + j <= M - 2.
        set_product(scratch[0, :n], scratch[sum_row(M - 1, M), :n], 1.0, square)
        for m in range(1, M - 1):
            add_product(scratch[m, :n], scratch[sum_row(M - 1 - m, M), :n], square)
        set_to(0.0, outer)
        for m in range(M - 3):
            add_product(scratch[m, :n], scratch[sum_row(M - 3 - m, M), :n], outer)
        rise, push = elevation[start:stop], potential[start:stop]
        set_linear(scratch[sum_row(M, M), :n], scratch[0, :n], square, rise, push)
        lower = scratch[sum_row(M - 2, M), :n] if M > 2 else outer
        set_to(0.0, steep)
        for a in range(slope.shape[0]):
            add_axis(lower, outer, slope[a, start:stop], flow[a, start:stop], steep, rise, push)
        steepest = max(steepest, largest(steep))
    return steepest


@kernel(inline=True)
def sum_row(count, order):
    """Row of scratch with W_1 + ... + W_count."""
    return 0 if count == 1 else order + count - 2


@kernel(noalias=True, inline=True)
def set_linear(total, first, square, elevation, potential):
    """Set the terms without gradients; first: W_1, in which the rate is linear."""
    for i in range(elevation.size):
        elevation[i] = total[i] - first[i]
        potential[i] = 0.5 * square[i]


@kernel(noalias=True, inline=True)
def largest(x):
    """The largest of numbers from 0; NaN counts as 0."""
    maximum = 0.0
    for i in range(x.size):
        maximum = max(maximum, x[i])
    return maximum


@kernel(noalias=True, inline=True)
def add_axis(lower, outer, slope, flow, square, elevation, potential):
    """Add one axis' part of the products of gradients, and of |grad eta|^2 to `square`.

    lower, outer: sums of W and of W_i W_j to order M - 2.
    """
    for i in range(elevation.size):
        steepness = slope[i] * slope[i]
        square[i] += steepness
        elevation[i] += steepness * lower[i] - slope[i] * flow[i]
        potential[i] += 0.5 * (steepness * outer[i] - flow[i] * flow[i])
