"""Cosine and sine of an angle in turns, in double and in single precision, for kernels that sum waves."""

import math

import numpy as np

from sim.jit import kernel

# sin(2 pi q) on |q| <= 1/4, odd, of least greatest error (3.3e-9; 5e-8 with single coefficients), by Lawson's iteration
S1, S3, S5, S7, S9 = (
    np.float32(c)
    for c in (6.283185160088972, -41.34165503128634, 81.60100406453265, -76.5497820808528, 39.53670436428712)
)
QUARTER = np.float32(0.25)


@kernel
def cos_sin_turns(turns):
    """(cos, sin) of 2 pi turns. turns is brought to [-1/2, 1/2] in double, so that it is exact after days."""
    x = np.pi * (turns - np.rint(turns))
    y = x * x
    # Taylor series of sin x, cos x on |x| <= pi/2, remainders x^21/21! and x^22/22! under 3e-16 and 2e-17; then 2x.
    s = 1 / 355687428096000 - y / 121645100408832000
    s = -1 / 39916800 + y * (1 / 6227020800 + y * (-1 / 1307674368000 + y * s))
    s = x * (1.0 + y * (-1 / 6 + y * (1 / 120 + y * (-1 / 5040 + y * (1 / 362880 + y * s)))))
    c = -1 / 6402373705728000 + y / 2432902008176640000
    c = 1 / 479001600 + y * (-1 / 87178291200 + y * (1 / 20922789888000 + y * c))
    c = 1.0 + y * (-1 / 2 + y * (1 / 24 + y * (-1 / 720 + y * (1 / 40320 + y * (-1 / 3628800 + y * c)))))
    return 1.0 - 2.0 * s * s, 2.0 * s * c


@kernel(inline=True)
def single_sine(q):
    """sin(2 pi q), |q| <= 1/4."""
    s = q * q
    return q * (S1 + s * (S3 + s * (S5 + s * (S7 + s * S9))))


@kernel(inline=True)
def single_cos_sin_turns(turns):
    """(cos, sin) of 2 pi turns in single precision, within 1e-7. turns are folded in their own precision.

    Folded to a quarter turn, u = |t| - 1/4: cos 2 pi t = -sin 2 pi u, sin 2 pi t = sign(t) sin 2 pi (1/4 - |u|).
    """
    t = turns - np.rint(turns)
    u = np.float32(abs(t) - QUARTER)
    return -single_sine(u), math.copysign(single_sine(QUARTER - abs(u)), np.float32(t))
