"""Kernels of the half-plane spectrum: evolve it to a time, turn rings, derive fields.

Spectra (N, N/2 + 1) complex are passed as their real views (N, N + 2): real and imaginary parts side by side, so that
loops vectorise. Frequencies depend on |kx|, |ky| only: `rate` [turns/s], `fade` and `radial` are quarter planes
(N/2, N/2) and rows i and N - i share one sine and cosine. The Nyquist row and column are never written: they stay 0.
"""

from sim.jit import kernel
from sim.numerics.turns import cos_sin_turns, single_cos_sin_turns

SINGLE = 4  # [bytes] of a number of single precision


@kernel
def set_rotation(rate, fade, t, i, cosine, sine):
    """Row i of fade cos(omega t), fade sin(omega t), each value twice: for the real and for the imaginary part."""
    for j in range(rate.shape[1]):
        c, s = cos_sin_turns(rate[i, j] * t)
        cosine[2 * j] = cosine[2 * j + 1] = c * fade[i, j]
        sine[2 * j] = sine[2 * j + 1] = s * fade[i, j]


@kernel(noalias=True)
def set_single_rotation(rate, fade, t, i, cosine, sine):
    """The same within 2e-7, where nothing accumulates."""
    for j in range(rate.shape[1]):
        c, s = single_cos_sin_turns(rate[i, j] * t)
        cosine[2 * j] = cosine[2 * j + 1] = c * fade[i, j]
        sine[2 * j] = sine[2 * j + 1] = s * fade[i, j]


@kernel(noalias=True)
def set_heights(even, odd, rate, fade, t, cosine, sine, h, copy):
    """h(k, t) = fade (even cos(omega t) + odd sin(omega t)), and the same in copy; cosine, sine: scratch (N,)."""
    half, n = rate.shape[0], h.shape[0]
    for i in range(half):
        if cosine.itemsize == SINGLE:
            set_single_rotation(rate, fade, t, i, cosine, sine)
        else:
            set_rotation(rate, fade, t, i, cosine, sine)
        for row in range(2 if i > 0 else 1):
            m = n - i if row else i
            for j in range(2 * half):
                value = even[m, j] * cosine[j] + odd[m, j] * sine[j]
                h[m, j] = value
                copy[m, j] = value
        for j in range(2 * half, 2 * half + 2):
            copy[i, j] = copy[n - i if i > 0 else half, j] = 0.0
    for j in range(2 * half):
        copy[half, j] = 0.0


@kernel(noalias=True)
def add_heights(even, odd, rate, fade, t, cosine, sine, h):
    """The same, added to h."""
    half, n = rate.shape[0], h.shape[0]
    for i in range(half):
        set_rotation(rate, fade, t, i, cosine, sine)
        for j in range(2 * half):
            h[i, j] += even[i, j] * cosine[j] + odd[i, j] * sine[j]
        if i > 0:
            for j in range(2 * half):
                h[n - i, j] += even[n - i, j] * cosine[j] + odd[n - i, j] * sine[j]


@kernel(noalias=True)
def shift_time(even, odd, rate, fade, t, cosine, sine):
    """Move the origin of time by t: even' = fade (even cos + odd sin), odd' = fade (odd cos - even sin), in place."""
    half, n = rate.shape[0], even.shape[0]
    for i in range(half):
        set_rotation(rate, fade, t, i, cosine, sine)
        for row in range(2 if i > 0 else 1):
            m = n - i if row else i
            for j in range(2 * half):
                e, o = even[m, j], odd[m, j]
                even[m, j] = e * cosine[j] + o * sine[j]
                odd[m, j] = o * cosine[j] - e * sine[j]


@kernel
def weighted_energy(h, radial):
    """Sum of radial(|k|) |h(k)|^2 over the whole plane."""
    half, n = radial.shape[0], h.shape[0]
    total = 0.0
    for i in range(n):
        a = min(i, n - i)
        if a < half:
            once = radial[a, 0] * (h[i, 0] * h[i, 0] + h[i, 1] * h[i, 1])
            twice = once - once  # ky > 0 stands for ky < 0 too
            for j in range(1, half):
                twice += radial[a, j] * (h[i, 2 * j] * h[i, 2 * j] + h[i, 2 * j + 1] * h[i, 2 * j + 1])
            total += once + 2.0 * twice
    return total


@kernel(noalias=True)
def set_real_multiple(h, row, column, radial, out):
    """out(k) = row(kx) column(ky) radial(|k|) h(k): second derivatives."""
    half, n = radial.shape[0], h.shape[0]
    for i in range(n):
        a = min(i, n - i)
        if a < half:
            for j in range(half):
                f = row[i] * column[j] * radial[a, j]
                out[i, 2 * j] = f * h[i, 2 * j]
                out[i, 2 * j + 1] = f * h[i, 2 * j + 1]
        else:
            for j in range(2 * half):
                out[i, j] = 0.0
        out[i, 2 * half] = out[i, 2 * half + 1] = 0.0


@kernel(noalias=True)
def set_imaginary_multiple(h, row, column, radial, out):
    """out(k) = i row(kx) column(ky) radial(|k|) h(k): first derivatives, displacements."""
    half, n = radial.shape[0], h.shape[0]
    for i in range(n):
        a = min(i, n - i)
        if a < half:
            for j in range(half):
                f = row[i] * column[j] * radial[a, j]
                out[i, 2 * j] = -f * h[i, 2 * j + 1]
                out[i, 2 * j + 1] = f * h[i, 2 * j]
        else:
            for j in range(2 * half):
                out[i, j] = 0.0
        out[i, 2 * half] = out[i, 2 * half + 1] = 0.0
