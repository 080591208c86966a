"""Cosine and sine of an angle in turns, in double and in single precision, for kernels."""

import math

import numpy as np

from sim.jit import kernel

# sin(2 pi q) on |q| <= 1/4, odd, minimax (3.3e-9; 5e-8 with single coefficients), by Lawson's iteration
S1, S3, S5, S7, S9 = (
    np.float32(c)
    for c in (6.283185160088972, -41.34165503128634, 81.60100406453265, -76.5497820808528, 39.53670436428712)
)
QUARTER = np.float32(0.25)


@kernel
def cos_sin_turns(turns):
    """(cos, sin) of 2 pi turns within 2e-15. turns is brought to [-1/2, 1/2], so that it is exact after days."""
    x = np.pi * (turns - np.rint(turns))
    y = x * x
    # sin x/x and cos x on |x| <= pi/2 by Chebyshev polynomials of y, errors 4e-16 and 1e-17; then the double angle.
    s = 1.6048170684608897e-10 - 7.374413956605131e-13 * y
    s = 2.755731661053336e-06 + y * (-2.505188203006007e-08 + y * s)
    s = 0.008333333333282813 + y * (-0.00019841269824875094 + y * s)
    s = x * (0.9999999999999999 + y * (-0.16666666666666075 + y * s))
    c = 2.087656242747118e-09 + y * (-1.1462916824488413e-11 + y * 4.6091323119689123e-14)
    c = 2.4801587277557563e-05 + y * (-2.755731640322175e-07 + y * c)
    c = 0.04166666666666392 + y * (-0.0013888888888773918 + y * c)
    c = 1.0 + y * (-0.4999999999999997 + y * c)
    return 1.0 - 2.0 * s * s, 2.0 * s * c


@kernel(inline=True)
def single_sine(q):
    """sin(2 pi q), |q| <= 1/4."""
    s = q * q
    return q * (S1 + s * (S3 + s * (S5 + s * (S7 + s * S9))))


@kernel(inline=True)
def single_cos_sin_turns(turns):
    """(cos, sin) of 2 pi turns in single precision, within 2e-7. turns are folded in their own precision.

    Folded to a quarter turn, u = |t| - 1/4: cos 2 pi t = -sin 2 pi u, sin 2 pi t = sign(t) sin 2 pi (1/4 - |u|).
    """
    t = turns - np.rint(turns)
    u = np.float32(abs(t) - QUARTER)
    return -single_sine(u), math.copysign(single_sine(QUARTER - abs(u)), np.float32(t))
