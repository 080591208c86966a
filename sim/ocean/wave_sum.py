"""The sum of Gerstner waves for drawing: over blocks of vertices, in single precision.

A wave of phase p [turns] at label X lifts z by a cos 2 pi p and moves the label by -chop (k/|k|) a sin 2 pi p
(Gerstner; Lamb, Hydrodynamics, Art. 251). Accumulated at each vertex are z, the displacement (X, Y), the slope of z
along labels, and the three strains, from which normals follow.

**Precision.** The phase of a wave at the grid's centre is reduced to a turn in double once a frame; what is added per
vertex is a few turns in single precision, since waves short against the distance are not drawn there. So the error
does not grow with time.
"""

import math

import numpy as np

from sim.jit import kernel
from sim.turns import single_cos_sin_turns


@kernel(noalias=True, allocates=False)
def add_pair(x, y, first, last, w, wave, scale0, scale1, z, X, Y, hx, hy, xx, yy, xy):
    """Add waves w and w + 1 to vertices first to last; two at a time halve the traffic of the eight sums.

    wave (flat): kx, ky [turns/m], phase [turns], a, bx, by, sx, sy, xx, yy, xy a wave: what each sum is multiplied by.
    """
    q = np.uint64(11) * w
    k0, l0, p0 = wave[q], wave[q + 1], wave[q + 2]
    a0, b0, c0, d0 = wave[q + 3] * scale0, wave[q + 4] * scale0, wave[q + 5] * scale0, wave[q + 6] * scale0
    e0, f0, g0, h0 = wave[q + 7] * scale0, wave[q + 8] * scale0, wave[q + 9] * scale0, wave[q + 10] * scale0
    q += np.uint64(11)
    k1, l1, p1 = wave[q], wave[q + 1], wave[q + 2]
    a1, b1, c1, d1 = wave[q + 3] * scale1, wave[q + 4] * scale1, wave[q + 5] * scale1, wave[q + 6] * scale1
    e1, f1, g1, h1 = wave[q + 7] * scale1, wave[q + 8] * scale1, wave[q + 9] * scale1, wave[q + 10] * scale1
    for i in range(first, last):
        cos0, sin0 = single_cos_sin_turns(k0 * x[i] + l0 * y[i] + p0)
        cos1, sin1 = single_cos_sin_turns(k1 * x[i] + l1 * y[i] + p1)
        z[i] += a0 * cos0 + a1 * cos1
        X[i] += b0 * sin0 + b1 * sin1
        Y[i] += c0 * sin0 + c1 * sin1
        hx[i] += d0 * sin0 + d1 * sin1
        hy[i] += e0 * sin0 + e1 * sin1
        xx[i] += f0 * cos0 + f1 * cos1
        yy[i] += g0 * cos0 + g1 * cos1
        xy[i] += h0 * cos0 + h1 * cos1


@kernel(noalias=True, allocates=False)
def add_waves(x, y, start, active, weight, waves, wave, z, X, Y, hx, hy, xx, yy, xy):
    """Add to each band the waves it shows: the first active[band] of them, an even number, each times its weight.

    weight: flat (bands, waves); sums as in `add_pair`, one array each, that the caller has set to 0.
    """
    one, two = np.uint64(1), np.uint64(2)
    for band in range(np.uint64(0), np.uint64(active.size)):
        row = band * waves
        for w in range(np.uint64(0), active[band], two):
            add_pair(x, y, start[band], start[band + one], w, wave, weight[row + w], weight[row + w + one],
                     z, X, Y, hx, hy, xx, yy, xy)  # fmt: skip


@kernel(noalias=True, allocates=False)
def calm_waves(x, y, start, active, weight, waves, wave, ex, ey, loss, cx, cy, radius, z, X, Y, hx, hy, xx, yy, xy):
    """Subtract from the sums of `add_waves` the losses of the waves under a round slick before they reach a vertex.

    ex, ey (waves,): direction of each wave; loss (waves,) [1/m]; cx, cy, radius [m] of the slick, single precision.
    """
    zero, one, two = np.float32(0.0), np.float32(1.0), np.float32(2.0)
    for band in range(np.uint64(0), np.uint64(active.size)):
        row = band * waves
        for w in range(np.uint64(0), active[band]):
            scale = weight[row + w]
            if loss[w] * radius < np.float32(1e-3) or scale == zero:
                continue
            q = np.uint64(11) * w
            # The wave's part of the mean height, choppiness k a^2/2: xx + yy is -choppiness k a.
            mean = np.float32(-0.5) * scale * scale * wave[q + np.uint64(3)]
            mean *= wave[q + np.uint64(8)] + wave[q + np.uint64(9)]
            for i in range(start[band], start[band + np.uint64(1)]):
                u, v = x[i] - cx, y[i] - cy
                across = u * ey[w] - v * ex[w]
                square = radius * radius - across * across
                if square <= zero:
                    continue
                half = math.sqrt(square)
                path = min(max(u * ex[w] + v * ey[w] + half, zero), two * half)
                if path == zero:
                    continue
                kept = math.exp(-loss[w] * path)
                lost = scale * (one - kept)
                cos, sin = single_cos_sin_turns(wave[q] * x[i] + wave[q + np.uint64(1)] * y[i] + wave[q + np.uint64(2)])
                cos, sin = cos * lost, sin * lost
                z[i] -= wave[q + np.uint64(3)] * cos + mean * (one - kept * kept)
                X[i] -= wave[q + np.uint64(4)] * sin
                Y[i] -= wave[q + np.uint64(5)] * sin
                hx[i] -= wave[q + np.uint64(6)] * sin
                hy[i] -= wave[q + np.uint64(7)] * sin
                xx[i] -= wave[q + np.uint64(8)] * cos
                yy[i] -= wave[q + np.uint64(9)] * cos
                xy[i] -= wave[q + np.uint64(10)] * cos


@kernel(noalias=True, allocates=False)
def set_mesh(x, y, z, X, Y, hx, hy, xx, yy, xy, vertices, slopes, jacobian):
    """vertices (flat n x 3) [m], slopes (flat n x 2) of the displaced surface, and the Jacobian J (n,).

    (dz/dx, dz/dy) (I + grad D) = (hx, hy), so dz/dx = (hx (1 + Dyy) - hy Dxy)/J.
    """
    one, least = np.float32(1.0), np.float32(0.1)
    for i in range(np.uint64(0), np.uint64(x.size)):
        a, b, c = one + xx[i], one + yy[i], xy[i]
        J = a * b - c * c
        jacobian[i] = J
        inverse = one / max(J, least)
        slopes[np.uint64(2) * i] = (hx[i] * b - hy[i] * c) * inverse
        slopes[np.uint64(2) * i + np.uint64(1)] = (hy[i] * a - hx[i] * c) * inverse
        j = np.uint64(3) * i
        vertices[j] = x[i] + X[i]
        vertices[j + np.uint64(1)] = y[i] + Y[i]
        vertices[j + np.uint64(2)] = z[i]
