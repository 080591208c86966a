"""The sum of Gerstner waves for drawing: over blocks of vertices, in single precision.

A wave of phase p [turns] at label X lifts z by a cos 2 pi p and moves the label by -chop (k/|k|) a sin 2 pi p
(Gerstner; Lamb, Hydrodynamics, Art. 251). Accumulated at each vertex are z, the displacement (X, Y), the slope of z
along labels, and the three strains, from which normals follow.

**Precision.** The phase of a wave at the grid's centre is reduced to a turn in double once a frame; what is added per
vertex is a few turns in single precision, since waves short against the distance are not drawn there. So the error
does not grow with time.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel
from sim.numerics.turns import single_cos_sin_turns

Array = NDArray[np.float32]
# Of a wave: its wavenumber [turns/m], its phase at the centre [turns], and what each sum is multiplied by.
WAVE = np.dtype([(name, np.float32) for name in ("kx", "ky", "phase", "z", "X", "Y", "hx", "hy", "xx", "yy", "xy")])


class Bands(NamedTuple):
    """Vertices in bands that show the same waves."""

    x: Array  # (n,) [m]
    y: Array  # (n,) [m]
    start: NDArray[np.uint64]  # (bands + 1,) first vertex of each, and n
    active: NDArray[np.uint64]  # (bands,) how many waves it shows, the first of all: an even number
    weight: Array  # (bands, waves) factor on each


class VertexSums(NamedTuple):
    """The sums at the vertices, (n,) each."""

    z: Array  # [m]
    X: Array  # [m] displacement
    Y: Array
    hx: Array  # slope of z along labels
    hy: Array
    xx: Array  # strains
    yy: Array
    xy: Array


class Calm(NamedTuple):
    """A round slick that calms waves."""

    x: np.float32  # [m] centre
    y: np.float32
    radius: np.float32  # [m]
    ex: Array  # (waves,) direction of each wave
    ey: Array
    loss: Array  # (waves,) [1/m] of each under the slick


def wave_rows(
    kx: NDArray[np.float64], ky: NDArray[np.float64], turns: NDArray[np.float64], a: NDArray[np.float64],
    choppiness: float, count: int,
) -> NDArray[np.void]:  # fmt: skip
    """Rows (count,) of WAVE of waves of amplitudes a (n,) [m], kx, ky [rad/m] and phases at the centre, then zeros."""
    k, rows = np.maximum(np.hypot(kx, ky), 1e-30), np.zeros(count, WAVE)
    ex, ey = choppiness * kx / k, choppiness * ky / k
    values = {
        "kx": kx / (2.0 * math.pi), "ky": ky / (2.0 * math.pi), "phase": turns - np.rint(turns),
        "z": a, "X": -ex * a, "Y": -ey * a, "hx": -kx * a, "hy": -ky * a,
        "xx": -ex * kx * a, "yy": -ey * ky * a, "xy": -ex * ky * a,
    }  # fmt: skip
    for name, value in values.items():
        rows[name][: len(a)] = value
    return rows


class Factors(NamedTuple):
    """Factors, one for each sum, on a wave's cosine or sine at a vertex, times its weight."""

    z: np.float32
    X: np.float32
    Y: np.float32
    hx: np.float32
    hy: np.float32
    xx: np.float32
    yy: np.float32
    xy: np.float32


@kernel(inline=True)
def factors_of(w, a):
    """The factors of a wave of WAVE with weight a."""
    return Factors(a * w.z, a * w.X, a * w.Y, a * w.hx, a * w.hy, a * w.xx, a * w.yy, a * w.xy)


@kernel(noalias=True, inline=True)
def add_pair(bands, band, w, waves, sums):
    """Add waves w and w + 1 to the vertices of a band; two at a time halve the traffic of the eight sums.

    Inlined, as a call copies the records.
    """
    one = np.uint64(1)
    u, v = waves[w], waves[w + one]
    f, g = factors_of(u, bands.weight[band, w]), factors_of(v, bands.weight[band, w + one])
    kx, ky, phase, other_kx, other_ky, other_phase = u.kx, u.ky, u.phase, v.kx, v.ky, v.phase
    for i in range(bands.start[band], bands.start[band + one]):
        cos, sin = single_cos_sin_turns(kx * bands.x[i] + ky * bands.y[i] + phase)
        other_cos, other_sin = single_cos_sin_turns(other_kx * bands.x[i] + other_ky * bands.y[i] + other_phase)
        sums.z[i] += f.z * cos + g.z * other_cos
        sums.X[i] += f.X * sin + g.X * other_sin
        sums.Y[i] += f.Y * sin + g.Y * other_sin
        sums.hx[i] += f.hx * sin + g.hx * other_sin
        sums.hy[i] += f.hy * sin + g.hy * other_sin
        sums.xx[i] += f.xx * cos + g.xx * other_cos
        sums.yy[i] += f.yy * cos + g.yy * other_cos
        sums.xy[i] += f.xy * cos + g.xy * other_cos


@kernel(noalias=True, allocates=False)
def add_waves(bands, waves, sums):
    """Add to each band the waves (count,) of WAVE that it shows, each times its weight."""
    for band in range(np.uint64(0), np.uint64(bands.active.size)):
        for w in range(np.uint64(0), bands.active[band], np.uint64(2)):
            add_pair(bands, band, w, waves, sums)


@kernel(noalias=True, allocates=False)
def calm_waves(bands, waves, calm, sums):
    """Subtract from the sums of `add_waves` the losses of the waves under a slick before they reach a vertex."""
    zero, one, two, radius = np.float32(0.0), np.float32(1.0), np.float32(2.0), calm.radius
    for band in range(np.uint64(0), np.uint64(bands.active.size)):
        for w in range(np.uint64(0), bands.active[band]):
            scale, ex, ey, loss, wave = bands.weight[band, w], calm.ex[w], calm.ey[w], calm.loss[w], waves[w]
            if loss * radius < np.float32(1e-3) or scale == zero:
                continue
            # The wave's part of the mean height, choppiness k a^2/2: xx + yy is -choppiness k a.
            mean = np.float32(-0.5) * scale * scale * wave.z * (wave.xx + wave.yy)
            for i in range(bands.start[band], bands.start[band + np.uint64(1)]):
                u, v = bands.x[i] - calm.x, bands.y[i] - calm.y
                across = u * ey - v * ex
                square = radius * radius - across * across
                if square <= zero:
                    continue
                half = math.sqrt(square)
                path = min(max(u * ex + v * ey + half, zero), two * half)
                if path == zero:
                    continue
                transmission = math.exp(-loss * path)
                lost = scale * (one - transmission)
                cos, sin = single_cos_sin_turns(wave.kx * bands.x[i] + wave.ky * bands.y[i] + wave.phase)
                cos, sin = cos * lost, sin * lost
                sums.z[i] -= wave.z * cos + mean * (one - transmission * transmission)
                sums.X[i] -= wave.X * sin
                sums.Y[i] -= wave.Y * sin
                sums.hx[i] -= wave.hx * sin
                sums.hy[i] -= wave.hy * sin
                sums.xx[i] -= wave.xx * cos
                sums.yy[i] -= wave.yy * cos
                sums.xy[i] -= wave.xy * cos


@kernel(noalias=True, allocates=False)
def set_mesh(x, y, sums, vertices, slopes, jacobian):
    """vertices (flat n x 3) [m], slopes (flat n x 2) of the displaced surface, and the Jacobian J (n,).

    (dz/dx, dz/dy) (I + grad D) = (hx, hy), so dz/dx = (hx (1 + Dyy) - hy Dxy)/J.
    """
    one, least = np.float32(1.0), np.float32(0.1)
    for i in range(np.uint64(0), np.uint64(x.size)):
        a, b, c = one + sums.xx[i], one + sums.yy[i], sums.xy[i]
        J = a * b - c * c
        jacobian[i] = J
        inverse = one / max(J, least)
        slopes[np.uint64(2) * i] = (sums.hx[i] * b - sums.hy[i] * c) * inverse
        slopes[np.uint64(2) * i + np.uint64(1)] = (sums.hy[i] * a - sums.hx[i] * c) * inverse
        j = np.uint64(3) * i
        vertices[j] = x[i] + sums.X[i]
        vertices[j + np.uint64(1)] = y[i] + sums.Y[i]
        vertices[j + np.uint64(2)] = sums.z[i]
