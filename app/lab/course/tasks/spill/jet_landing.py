"""The reference solution and the check of a task."""

import numpy as np

from app.lab.checking import Curve, Mistake, require


def jet_landing(x, v, level, gravity):
    """Position [m] where a drop of an oil jet falls back onto the sea, shape (3,), on the surface z = level.

    The drop flies freely: x(t) = x + v t + g t^2/2, with g = (0, 0, -gravity). It lands at the later of the two times
    at which its height is that of the surface.

    x, v: position [m] and velocity [m/s] at the start, shape (3,), above the surface. level: [m]. gravity: [m/s2].
    """
    x, v = np.asarray(x, dtype=float), np.asarray(v, dtype=float)
    t = (v[2] + np.sqrt(v[2] ** 2 + 2 * gravity * (x[2] - level))) / gravity
    landing = x + v * t
    landing[2] = level
    return landing


def inputs(rng):
    x, v = rng.normal(size=(2, 3))
    level = rng.uniform(0.5, 2.0)
    x[2] = level + rng.uniform(0.5, 3.0)
    return x, 4.0 * v, level, rng.uniform(2.0, 20.0)


# A jet at 45 degrees, one straight down, one from the surface.
EXAMPLES = (
    (np.array([0.0, 0.0, 3.0]), np.array([8.0, 0.0, 8.0]), 0.0, 9.81),
    (np.array([1.0, 2.0, 4.0]), np.array([0.0, 0.0, -2.0]), -1.0, 9.81),
    (np.array([0.0, 1.0, 0.5]), np.array([3.0, -40.0, 60.0]), 0.5, 2.1135),
)


def at(time, height=None):
    """A function that makes a mistake: the position at another time, or at another height."""

    def function(x, v, level, gravity):
        landing = x + v * time(x, v, level, gravity)
        landing[2] = level if height is None else height(x, v, level, gravity)
        return landing

    return function


def root(sign=1.0, half=2.0, base=1.0):
    def time(x, v, level, gravity):
        return (v[2] + sign * np.sqrt(v[2] ** 2 + half * gravity * (x[2] - base * level))) / gravity

    return time


MISTAKES = (
    Mistake(
        "the earlier time",
        "This is the earlier of the two times, before the start. Take the plus sign.",
        at(root(sign=-1.0)),
    ),
    Mistake(
        "half forgotten",
        "The drop falls with g t^2 instead of g t^2/2.",
        at(lambda x, v, level, g: (v[2] + np.sqrt(v[2] ** 2 + 4 * g * (x[2] - level))) / (2 * g)),
    ),
    Mistake(
        "brackets of the divisor",
        "The divisor is g, as 2 cancels: t = (v_z + sqrt(v_z^2 + 2 g h))/g. This divides by 2 and multiplies by g.",
        at(lambda x, v, level, g: root()(x, v, level, g) * g * g / 2),
    ),
    Mistake(
        "start velocity forgotten",
        "The drop falls as if it had no velocity upwards.",
        at(lambda x, v, level, g: np.sqrt(2 * (x[2] - level) / g)),
    ),
    Mistake(
        "level forgotten",
        "The drop falls to z = 0. The surface is at z = level.",
        at(root(base=0.0), lambda x, v, level, g: 0.0),
    ),
    Mistake("level forgotten", "This is the time of a fall to z = 0. The surface is at z = level.", at(root(base=0.0))),
    Mistake("height set to 0", "The drop lands at z = level, not at z = 0.", at(root(), lambda x, v, level, g: 0.0)),
    Mistake(
        "gravity forgotten in the height",
        "x and y are right. z must be that of the surface: v t alone leaves out gravity.",
        at(root(), lambda x, v, level, g: x[2] + v[2] * root()(x, v, level, g)),
    ),
    Mistake(
        "straight down", "The drop also moves along x and y.", lambda x, v, level, g: np.array([x[0], x[1], level])
    ),
)

CURVE = Curve(
    "speed at 45 degrees [m/s]",
    "distance [m]",
    np.linspace(0.0, 12.0, 40),
    lambda f, x: [f(np.array([0.0, 0.0, 3.0]), np.array([s, 0.0, s]) / np.sqrt(2.0), 0.0, 9.81)[0] for s in x],
)


def behaviour(student):
    """A drop that is thrown up at 45 degrees from the surface lands at v^2/g."""
    landing = student(np.array([0.0, 0.0, 1e-9]), np.array([5.0, 0.0, 5.0]), 0.0, 10.0)
    require(
        np.allclose(landing, (5.0, 0.0, 0.0), atol=1e-2),
        "a drop that leaves at 45 degrees with 7.07 m/s must land after 5 m",
    )
