"""Sums over the waves of a periodic rectangle at single points: elevation, and harmonic functions with their gradients.

A phase is that of the column times that of the row, so that each wave costs a few products: the sum over a row is
turned by the phase of the row as a whole. Rows at ky and -ky have equal wavenumbers and share their factors of depth.
"""

import numpy as np

from sim.jit import kernel
from sim.numerics.turns import cos_sin_turns
from sim.waves import DEEPEST, exponential


def parts_of(spectra: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Real and imaginary parts (..., 2, rows, columns) of spectra (..., rows, columns) times weight (columns,)."""
    weighted = spectra * weight
    return np.ascontiguousarray(np.stack([np.real(weighted), np.imag(weighted)], axis=-3))


@kernel
def set_phases(turns, cos, sin):
    """Set cos and sin (columns,) of the phases 0, 1, 2, ... times a number of turns."""
    for j in range(cos.size):
        cos[j], sin[j] = cos_sin_turns(j * turns)


@kernel
def elevation_at(parts, turns_y, cos, sin):
    """Elevation at a point with these phases of the columns; parts (2, rows, columns) of its spectrum."""
    rows, height = parts.shape[1], 0.0
    for i in range(rows):
        real = imaginary = 0.0
        for j in range(cos.size):
            real += parts[0, i, j] * cos[j] - parts[1, i, j] * sin[j]
            imaginary += parts[0, i, j] * sin[j] + parts[1, i, j] * cos[j]
        c, s = cos_sin_turns((i if 2 * i < rows else i - rows) * turns_y)
        height += real * c - imaginary * s
    return height


@kernel(noalias=True)
def set_elevations(points, length, parts, out):
    """Set out (n,) [m] to the elevation above points (n, 2) [m]; length (2,) [m] of the sides."""
    cos, sin = np.empty(parts.shape[2]), np.empty(parts.shape[2])
    for p in range(points.shape[0]):
        set_phases(points[p, 0] / length[0], cos, sin)
        out[p] = elevation_at(parts, points[p, 1] / length[1], cos, sin)


@kernel(noalias=True)
def add_row(parts, term, i, kx, ky, c, s, cos, sin, value, slope, out):
    """Add the waves of row i to out (functions, 4): the functions and their derivatives along x, y and z.

    parts (terms, functions, 2, rows, columns), here one term; c, s: phase of the row; value, slope (columns,):
    factors of depth on the functions and on their vertical derivatives.
    """
    for f in range(out.shape[0]):
        a = b = along_a = along_b = up_a = up_b = 0.0
        for j in range(kx.size):
            real, imaginary = parts[term, f, 0, i, j], parts[term, f, 1, i, j]
            r, m = real * cos[j] - imaginary * sin[j], real * sin[j] + imaginary * cos[j]
            a += value[j] * r
            b += value[j] * m
            along_a += kx[j] * value[j] * r
            along_b += kx[j] * value[j] * m
            up_a += slope[j] * r
            up_b += slope[j] * m
        out[f, 0] += a * c - b * s
        out[f, 1] -= along_a * s + along_b * c
        out[f, 2] -= ky * (a * s + b * c)
        out[f, 3] += up_a * c - up_b * s


@kernel(noalias=True)
def set_flow(points, length, eta, highest, parts, kx, ky, k, tanh, near, far, depth, out):
    """Set out (n, functions, 4) to harmonic functions and their derivatives along x, y and z at points (n, 3) [m].

    eta (2, rows, columns), highest [m]: of the surface, above which are the values on it. parts (terms, functions, 2,
    rows, columns): the functions at z = 0 in term 0, which decay as cosh k(z + h)/cosh kh = near e^kz + far e^-kz;
    above z = 0, in term n, the part that goes with z^n (see `flow.py`).
    """
    rows, columns = k.shape
    cos, sin = np.empty(columns), np.empty(columns)
    value, slope, power = np.empty(columns), np.empty(columns), np.empty(columns)
    for p in range(points.shape[0]):
        turns_y, z = points[p, 1] / length[1], max(points[p, 2], -depth)
        set_phases(points[p, 0] / length[0], cos, sin)
        if z > -highest:
            z = min(z, max(elevation_at(eta, turns_y, cos, sin), -depth))
        out[p, :, :] = 0.0
        for i in range(rows // 2 + 1):
            c, s = cos_sin_turns(i * turns_y)
            mirrored = 0 < i < rows - i  # the row at -ky
            if z <= 0.0:
                for j in range(columns):
                    e = exponential(max(k[i, j] * z, -DEEPEST))
                    down, up = near[i, j] * e, far[i, j] / e
                    value[j], slope[j] = down + up, k[i, j] * (down - up)
                add_row(parts, 0, i, kx, ky[i], c, s, cos, sin, value, slope, out[p])
                if mirrored:
                    add_row(parts, 0, rows - i, kx, -ky[i], c, -s, cos, sin, value, slope, out[p])
                continue
            power[:] = 1.0
            for n in range(parts.shape[0]):
                for j in range(columns):
                    odd = n % 2 == 1
                    value[j] = power[j] * (tanh[i, j] if odd else 1.0)
                    slope[j] = power[j] * k[i, j] * (1.0 if odd else tanh[i, j])
                    power[j] *= k[i, j] * z / (n + 1)
                add_row(parts, n, i, kx, ky[i], c, s, cos, sin, value, slope, out[p])
                if mirrored:
                    add_row(parts, n, rows - i, kx, -ky[i], c, -s, cos, sin, value, slope, out[p])
