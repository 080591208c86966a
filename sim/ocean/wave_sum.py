"""The sum of Gerstner waves: over blocks of vertices in single precision, and at points in double.

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

# sin(2 pi q) on |q| <= 1/4, odd, of least greatest error (3.3e-9; 5e-8 with single coefficients), by Lawson's iteration
SINE = (6.283185160088972, -41.34165503128634, 81.60100406453265, -76.5497820808528, 39.53670436428712)
D1, D3, D5, D7, D9 = SINE
TOLERANCE = 1e-7  # [m] at which a label counts as found
MOST_STEPS = 12


@kernel(inline=True)
def fine_sine(q):
    """sin(2 pi q), |q| <= 1/4, in double."""
    s = q * q
    return q * (D1 + s * (D3 + s * (D5 + s * (D7 + s * D9))))


@kernel(inline=True)
def fine_wave(t, a):
    """a cos(2 pi t) and a sin(2 pi t) in double: t [turns] folded to a quarter turn, see sim/turns.py."""
    t -= np.rint(t)
    u = abs(t) - 0.25
    return -fine_sine(u) * a, math.copysign(fine_sine(0.25 - abs(u)), t) * a


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


@kernel
def sum_at(x, y, p, kx, ky, phase, amplitude, chop, weight, out):
    """out (8,): z, X, Y, hx, hy, xx, yy, xy of the sum at label x, y; weight[p] (waves,) scales each wave."""
    z = X = Y = hx = hy = xx = yy = xy = 0.0
    for w in range(kx.size):
        c, s = fine_wave((kx[w] * x + ky[w] * y) / (2.0 * math.pi) + phase[w], amplitude[w] * weight[p, w])
        k = np.sqrt(kx[w] * kx[w] + ky[w] * ky[w])
        ex, ey = chop * kx[w] / k, chop * ky[w] / k
        z += c
        X -= ex * s
        Y -= ey * s
        hx -= kx[w] * s
        hy -= ky[w] * s
        xx -= ex * kx[w] * c
        yy -= ey * ky[w] * c
        xy -= ex * ky[w] * c
    out[0], out[1], out[2], out[3], out[4], out[5], out[6], out[7] = z, X, Y, hx, hy, xx, yy, xy


@kernel
def find_labels(points, kx, ky, phase, amplitude, chop, weight, labels, found, residual):
    """Set labels (n, 2) of the resting surface that are displaced to points (n, 2); found (n, 8): the sums there.

    x + D(x) = X by Newton's method from x = X - D(X); residual (n,) [m] is the remaining miss, at rounding unless the
    surface folds there.
    """
    for p in range(points.shape[0]):
        px, py = points[p, 0], points[p, 1]
        out = found[p]
        sum_at(px, py, p, kx, ky, phase, amplitude, chop, weight, out)
        x, y = px - out[1], py - out[2]
        miss = 0.0
        for _ in range(MOST_STEPS):
            sum_at(x, y, p, kx, ky, phase, amplitude, chop, weight, out)
            fx, fy = x + out[1] - px, y + out[2] - py
            miss = np.sqrt(fx * fx + fy * fy)
            if miss < TOLERANCE:
                break
            a, b, c = 1.0 + out[5], 1.0 + out[6], out[7]
            J = a * b - c * c
            if J < 0.05:  # folded: a plain step instead of a wild one
                x, y = x - 0.5 * fx, y - 0.5 * fy
            else:
                x, y = x - (b * fx - c * fy) / J, y - (a * fy - c * fx) / J
        labels[p, 0], labels[p, 1], residual[p] = x, y, miss


@kernel
def set_motion(labels, kx, ky, rate, phase, amplitude, chop, weight, ratio, velocity, acceleration, interface):
    """Set the motion of the surface at labels (n, 2): velocity (n, 3), upward acceleration (n,), and of the interface.

    interface (n, 4): height, slope along x, y, rise. rate [rad/s]; ratio: interface over surface.
    """
    for p in range(labels.shape[0]):
        u = v = w = g = h = hx = hy = rise = 0.0
        for i in range(kx.size):
            t = (kx[i] * labels[p, 0] + ky[i] * labels[p, 1]) / (2.0 * math.pi) + phase[i]
            c, s = fine_wave(t, amplitude[i] * weight[p, i])
            k = np.sqrt(kx[i] * kx[i] + ky[i] * ky[i])
            # d/dt of -e sin and of cos at phase k.X - omega t
            u += chop * kx[i] / k * rate[i] * c
            v += chop * ky[i] / k * rate[i] * c
            w += rate[i] * s
            g -= rate[i] * rate[i] * c
            h += ratio[i] * c
            hx -= ratio[i] * kx[i] * s
            hy -= ratio[i] * ky[i] * s
            rise += ratio[i] * rate[i] * s
        velocity[p, 0], velocity[p, 1], velocity[p, 2], acceleration[p] = u, v, w, g
        interface[p, 0], interface[p, 1], interface[p, 2], interface[p, 3] = h, hx, hy, rise
