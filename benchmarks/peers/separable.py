"""The flow of waves on a periodic rectangle of deep water, with separable phases: the loops that one writes first."""

import math

import numpy as np

from sim.jit import kernel


@kernel
def set_separable(points, real, imaginary, kx, ky, k, out):
    """Set out (n, 4): a potential and its derivatives along x, y and z at points (n, 3), all below z = 0.

    real, imaginary (rows, columns): parts of its spectrum at z = 0, of a half plane.
    """
    cos, sin, decay = np.empty(kx.size), np.empty(kx.size), np.empty(kx.size)
    for p in range(points.shape[0]):
        x, y, z = points[p, 0], points[p, 1], points[p, 2]
        for j in range(kx.size):
            cos[j], sin[j] = math.cos(kx[j] * x), math.sin(kx[j] * x)
        value = along = across = up = 0.0
        for i in range(ky.size):
            c, s = math.cos(ky[i] * y), math.sin(ky[i] * y)
            for j in range(kx.size):
                decay[j] = math.exp(k[i, j] * z)
            for j in range(kx.size):
                a, b = cos[j] * c - sin[j] * s, sin[j] * c + cos[j] * s
                weight = decay[j] * (1.0 if j == 0 else 2.0)
                r = weight * (real[i, j] * a - imaginary[i, j] * b)
                m = weight * (real[i, j] * b + imaginary[i, j] * a)
                value += r
                along -= kx[j] * m
                across -= ky[i] * m
                up += k[i, j] * r
        out[p, 0], out[p, 1], out[p, 2], out[p, 3] = value, along, across, up


def separable_flow(points: np.ndarray, spectrum: np.ndarray, length: float) -> np.ndarray:
    """(n, 4) at points (n, 3) [m] of a potential; spectrum (n, n/2) of a square of this length [m], rows by ky."""
    rows, columns = spectrum.shape
    kx = np.arange(columns) * (2.0 * math.pi / length)
    ky = np.fft.fftfreq(rows, 1.0 / rows) * (2.0 * math.pi / length)
    out = np.empty((len(points), 4))
    real, imaginary = np.ascontiguousarray(np.real(spectrum)), np.ascontiguousarray(np.imag(spectrum))
    set_separable(points, real, imaginary, kx, ky, np.hypot(ky[:, None], kx), out)
    return out
