"""The high-order spectral method as a user would write it from the papers, in numpy and scipy.fft.

Half planes of `rfft2`, products of whole fields on a padded grid, and the classical method of Runge and Kutta with a
fixed step on the whole equations: no exact linear part, no compiled code.
"""

import math

import numpy as np


class PlainSea:
    """Nonlinear waves on deep water, from elevation and surface potential (n, m), n and m > 1 or m = 1."""

    def __init__(
        self, elevation: np.ndarray, potential: np.ndarray, length: tuple[float, float], order: int, gravity: float
    ) -> None:
        from scipy import fft  # type: ignore[import-not-found]

        self.fft = fft
        self.order, self.gravity = order, gravity
        self.shape = n, m = elevation.shape
        self.wide = [1 if c == 1 else int(fft.next_fast_len(-(-c * (order + 1) // 2), True) or c) for c in (n, m)]
        # x last: the half plane is that of x.
        kx = 2.0 * math.pi * fft.rfftfreq(n, length[0] / n)
        ky = 2.0 * math.pi * fft.fftfreq(m, length[1] / m)
        self.kx, self.ky = np.meshgrid(kx, ky)
        self.k = np.hypot(self.kx, self.ky)
        self.rows = np.concatenate([np.arange((m + 1) // 2), np.arange(-(m // 2), 0)])
        self.eta, self.psi = (np.asarray(fft.rfft2(field.T)) for field in (elevation, potential))

    @property
    def height(self) -> np.ndarray:
        """Elevation (n, m) [m]."""
        return np.asarray(self.fft.irfft2(self.eta, self.shape[::-1])).T

    def field(self, spectrum: np.ndarray) -> np.ndarray:
        """A spectrum on the padded grid."""
        padded = np.zeros((self.wide[1], self.wide[0] // 2 + 1), complex)
        padded[self.rows, : self.k.shape[1] - 1] = spectrum[:, :-1]  # without the Nyquist waves
        return np.asarray(self.fft.irfft2(padded, self.wide[::-1])) * (
            self.wide[0] * self.wide[1] / (self.shape[0] * self.shape[1])
        )

    def spectrum(self, field: np.ndarray) -> np.ndarray:
        """The waves of the sea of a field on the padded grid."""
        out = np.zeros(self.k.shape, complex)
        out[:, :-1] = np.asarray(self.fft.rfft2(field))[self.rows, : self.k.shape[1] - 1]
        return out / (self.wide[0] * self.wide[1] / (self.shape[0] * self.shape[1]))

    def rates(self, eta: np.ndarray, psi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """d eta/dt and d psi/dt, spectra (West et al. 1987)."""
        M, height = self.order, self.field(eta)
        slope = [self.field(1j * k * eta) for k in (self.kx, self.ky)]
        flow = [self.field(1j * k * psi) for k in (self.kx, self.ky)]
        power = [height**j / math.factorial(j) for j in range(M)]
        phi = [psi]
        W = [np.zeros_like(height) for _ in range(M)]
        for m in range(1, M + 1):
            if m > 1:
                terms = [power[j] * self.field(self.k**j * phi[m - j - 1]) for j in range(1, m)]
                phi.append(self.spectrum(-np.sum(terms, axis=0)))
            for j in range(m):
                W[m - 1] = W[m - 1] + power[j] * self.field(self.k ** (j + 1) * phi[m - j - 1])
        steepness, both = slope[0] ** 2 + slope[1] ** 2, flow[0] * slope[0] + flow[1] * slope[1]
        total, lower = sum(W), sum(W[: M - 2]) if M > 2 else 0.0
        square = sum(W[i] * W[j] for i in range(M) for j in range(M) if i + j + 2 <= M)
        outer = sum(W[i] * W[j] for i in range(M) for j in range(M) if i + j + 4 <= M) if M > 3 else 0.0
        rise = total + steepness * lower - both
        push = 0.5 * (square + steepness * outer - flow[0] ** 2 - flow[1] ** 2)
        return self.spectrum(rise), self.spectrum(push) - self.gravity * eta

    def advance(self, duration: float, steps: int) -> None:
        """Take equal steps over a duration [s]."""
        h = duration / steps
        for _ in range(steps):
            a = self.rates(self.eta, self.psi)
            b = self.rates(self.eta + 0.5 * h * a[0], self.psi + 0.5 * h * a[1])
            c = self.rates(self.eta + 0.5 * h * b[0], self.psi + 0.5 * h * b[1])
            d = self.rates(self.eta + h * c[0], self.psi + h * c[1])
            self.eta, self.psi = (
                value + h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]) for i, value in enumerate((self.eta, self.psi))
            )
