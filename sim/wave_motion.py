"""The motion of water under linear waves at one place, for kernels: velocity, acceleration and pressure.

A wave a cos(theta), theta = k.x - omega t + phase, in water of depth h moves the water at height z (Lamb, Art. 229)

  along k by u = a omega C cos(theta), upwards by w = a omega S sin(theta), under the pressure
  p = rho a omega^2/k C cos(theta), C = cosh k(z + h)/sinh kh, S = sinh k(z + h)/sinh kh; both are e^(kz) in deep water.
"""

import math

from sim.jit import kernel
from sim.turns import cos_sin_turns

DEEPEST = 40.0  # kz beyond which the motion is under 1e-17 of that at the surface


@kernel(inline=True)
def exponential(x):
    """e^x for -DEEPEST <= x <= 0 within 1e-13: Taylor's series of x/1024, squared ten times."""
    y = x / 1024.0
    e = 1.0 + y * (1.0 + y / 2.0 * (1.0 + y / 3.0 * (1.0 + y / 4.0 * (1.0 + y / 5.0 * (1.0 + y / 6.0)))))
    e *= e
    e *= e
    e *= e
    e *= e
    e *= e
    e *= e
    e *= e
    e *= e
    e *= e
    return e * e


@kernel(inline=True)
def flow_at(x, y, z, t, waves, depth):
    """(u, v, w) [m/s], (du, dv, dw)/dt [m/s2], pressure over density [m2/s2], and elevation [m] at a place.

    Above z = 0 and below the bottom are the values there.
    waves (9, n): kx, ky [turns/m], phase [turns], omega [turns/s], cos and sin of the bearing, a omega/(1 - q) [m/s],
    q = e^(-2kh), a [m].
    """
    turn = 2.0 * math.pi
    z = min(max(z, -depth), 0.0)
    u = v = w = du = dv = dw = pushed = elevation = 0.0
    for i in range(waves.shape[1]):
        kx, ky, nx, ny, speed = waves[0, i], waves[1, i], waves[4, i], waves[5, i], waves[6, i]
        c, s = cos_sin_turns(kx * x + ky * y + waves[2, i] - waves[3, i] * t)
        k, omega = turn * (kx * nx + ky * ny), turn * waves[3, i]
        e = exponential(max(k * z, -DEEPEST))
        back = waves[7, i] / e
        level, upward = speed * (e + back), speed * (e - back)
        u += nx * level * c
        v += ny * level * c
        w += upward * s
        du += nx * omega * level * s
        dv += ny * omega * level * s
        dw -= omega * upward * c
        pushed += omega / k * level * c
        elevation += waves[8, i] * c
    return u, v, w, du, dv, dw, pushed, elevation
