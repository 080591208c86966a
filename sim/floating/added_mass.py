"""Added mass: how much fluid the accelerations of a hull carry along, in units of the fluid's density.

The values are those of a whole hull in unbounded fluid; each shape (shapes/) says which formula it uses. A body at
the surface gets each of them in the proportion that its own surface is wet, seen along that axis (`motion.py`): half
of it for a sphere afloat at its equator, for a disc or a plate wet from below, the fraction submerged for the sides of
an upright cylinder. That is the limit of high frequency of the linear theory, where the water surface is a mirror of
opposite sign.

| hull | along an axis | about an axis |
|---|---|---|
| sphere | V/2 (Lamb, Hydrodynamics, 1932, Art. 92) | 0 |
| cylinder | side: pi R^2 H, as in two dimensions (Art. 68); end: 8/3 R^3, the disc (Art. 102) | ellipsoid R, R, H/2 |
| box | each face as a rectangular plate (DNV-RP-C205, 2010, table D-2) | ellipsoid of its half edges |
| mesh | ellipsoid of the same volume and proportions of inertia (Lamb Art. 114) | the same (Art. 115) |

Limits: the axes are not coupled; the waves that a body made do not act back on it (only a constant linear damping
does); and a floating hemisphere of long period truly carries 0.831 of the displaced mass instead of 0.5 (Hulme 1982,
JFM 121:443). `MotionCoefficients.added_mass` scales all of them.
"""

import math

import numpy as np

# A plate of edges b >= a that moves along its normal carries C pi/4 a^2 b; C by b/a (DNV-RP-C205, table D-2).
PLATE_ASPECT = (1.0, 1.25, 1.5, 1.59, 2.0, 2.5, 3.0, 3.17, 4.0, 5.0, 6.25, 8.0, 10.0)
PLATE_COEFFICIENT = (0.579, 0.642, 0.690, 0.704, 0.757, 0.801, 0.830, 0.840, 0.872, 0.897, 0.917, 0.934, 0.947)


def of_equal_ellipsoid(volume: float, inertia: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Added mass (3,) [m3] along and (3,) [m5] about the axes of an ellipsoid.

    It has the volume [m3] of a body, and the proportions of the body's inertia (3, 3) [m5] at unit density.
    """
    # An ellipsoid has int x_i^2 = V a_i^2 / 5; only the proportions of the axes are taken from that, the size from V.
    second = np.trace(inertia) / 2 - np.diag(inertia)
    axes = np.sqrt(np.maximum(second, 1e-6 * second.max()))
    return ellipsoid(axes * (volume / (4 / 3 * math.pi * axes.prod())) ** (1 / 3))


def plate(a: float, b: float) -> float:
    """Added mass [m3] of a rectangular plate of edges a, b [m] along its normal; C tends to 1 as 1 - 0.53 a/b."""
    a, b = min(a, b), max(a, b)
    last = PLATE_ASPECT[-1]
    c = np.interp(b / a, PLATE_ASPECT, PLATE_COEFFICIENT) if b / a <= last else 1 - (1 - 0.947) * last * a / b
    return float(c) * math.pi / 4 * a * a * b


def ellipsoid(axes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Added mass (3,) [m3] along and (3,) [m5] about the axes of an ellipsoid of semi-axes (3,) [m].

    Lamb Art. 114 eq. 5 and Art. 115: with alpha_i = abc int_0^inf dl / ((a_i^2 + l) Delta),
      along i: V alpha_i/(2 - alpha_i)
      about i: V/5 (b^2 - c^2)^2 (gamma - beta) / (2 (b^2 - c^2) + (b^2 + c^2)(beta - gamma))
    """
    volume = 4 / 3 * math.pi * float(axes.prod())
    squares = axes**2
    # the integral is 2/3 R_D(b^2, c^2, a^2) of Carlson
    alpha = np.array([
        2 / 3 * float(axes.prod()) * carlson_rd(squares[(i + 1) % 3], squares[(i + 2) % 3], squares[i])
        for i in range(3)
    ])  # fmt: skip
    along = volume * alpha / (2 - alpha)
    about = np.zeros(3)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        b, c = squares[j], squares[k]
        if abs(b - c) > 1e-6 * (b + c):  # else the ellipsoid is round about axis i, and moves no fluid
            change = alpha[k] - alpha[j]
            about[i] = volume / 5 * (b - c) ** 2 * change / (2 * (b - c) - (b + c) * change)
    return along, about


def carlson_rd(x: float, y: float, z: float) -> float:
    """R_D = 3/2 int_0^inf dt / (sqrt((t+x)(t+y)) (t+z)^(3/2)) by duplication (Carlson 1979, Numer. Math. 33:1)."""
    total, power = 0.0, 1.0
    for _ in range(40):
        mean = (x + y + 3 * z) / 5
        if max(abs(x - mean), abs(y - mean), abs(z - mean)) < 1e-3 * mean:
            break
        root = math.sqrt(x * y) + math.sqrt(y * z) + math.sqrt(z * x)
        total += 3 * power / (math.sqrt(z) * (z + root))
        power /= 4
        x, y, z = (x + root) / 4, (y + root) / 4, (z + root) / 4
    mean = (x + y + 3 * z) / 5
    dx, dy = 1 - x / mean, 1 - y / mean
    dz = -(dx + dy) / 3
    e2, e3 = dx * dy - 6 * dz * dz, (3 * dx * dy - 8 * dz * dz) * dz
    # the series is cut at third order: relative error below 1e-11 once the arguments agree to 1e-3
    return total + power * (1 - 3 / 14 * e2 + e3 / 6) / (mean * math.sqrt(mean))
