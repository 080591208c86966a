"""The reference solution and the check of a task."""

import numpy as np

from app.lab.checking import Curve, Mistake, require


def pendulum_period(length, gravity):
    """The period [s] of a pendulum that swings by a small angle: T = 2 pi sqrt(L/g).

    length: L [m]. gravity: g [m/s2].
    """
    return 2 * np.pi * np.sqrt(length / gravity)


def inputs(rng):
    return rng.uniform(0.1, 3.0), rng.uniform(1.0, 20.0)


MISTAKES = (
    Mistake(
        "ratio upside down", "Long pendulums swing slowly: it is L/g, not g/L.", lambda L, g: 2 * np.pi * np.sqrt(g / L)
    ),
    Mistake("root forgotten", "The period grows with the root of L/g.", lambda L, g: 2 * np.pi * L / g),
)
CURVE = Curve("length [m]", "period [s]", np.linspace(0.1, 3.0, 30), lambda f, x: [f(L, 9.81) for L in x])


def behaviour(student):
    """The seconds pendulum."""
    require(abs(student(0.994, 9.81) - 2.0) < 1e-3, "a pendulum of 0.994 m must take 2 s on the Earth")
