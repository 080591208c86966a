"""The damped kick in time: one complex step, of second order and L-stable.

At fixed positions v' = a - A v, with a = M^-1 F of the forces of position and A = M^-1 B of the damping. For a time s

    V = v + alpha s (a - A V),  alpha = (1 + i)/2,
    mean velocity = Re V,  new velocity = v + s (a - A Re V).

With v* such that A v* = a that is v* + R(s A) (v - v*), R(y) = 1 / (1 + y + y^2/2), the Pade approximant (0, 2) of
exp(-y) (Hairer & Wanner, Solving Ordinary Differential Equations II, table IV.3.1) by its partial fractions. So the
terminal velocity v* stays exactly, whatever s; R falls from 1 to 0 without a change of sign; and without damping it is
the plain kick v + s a. The mean velocity is that of the path: damping forces times it are the impulse of damping.

Stability. Let E = R(h A/2)^2 be two such kicks of half a step. Kick, drift, kick is then the central difference
    N (x_+ - 2 x + x_-)/h^2 + B (x_+ - x_-)/(2 h) + K x = 0,  N = (h B/2) (1 + E)/(1 - E),
with E a function of A. From E >= (2 - y)/(2 + y), y of h A, follows N >= M. The quadratic form
d^T (N - h^2 K/4) d + h^2 m^T K m of the difference d and the mean m of two positions only falls, and it is positive for
h omega < 2 of the undamped net: that is enough at any damping.
"""

import math

from sim.jit import kernel

ALPHA = 0.5 + 0.5j


@kernel(inline=True)
def shares(rate, s):
    """Times [s] for which w = a - rate v at the start of a time s [s] changes v, and the mean of v: exact for one rate.

    s phi1(-y) and s phi2(-y), y = rate s, of exponential integrators (Hochbruck & Ostermann 2010, eq. 2.10).
    """
    y = rate * s
    if y < 1e-3:
        return s * (1.0 - y / 2.0 + y * y / 6.0 - y**3 / 24.0), s * (0.5 - y / 6.0 + y * y / 24.0 - y**3 / 120.0)
    first = -math.expm1(-y) / y
    return s * first, s * (1.0 - first) / y


@kernel(inline=True)
def relaxed(v, pull, rate, s):
    """Velocity after a time s [s] of v' = pull - rate v, and its mean."""
    first, second = shares(rate, s)
    w = pull - rate * v
    return v + first * w, v + second * w
