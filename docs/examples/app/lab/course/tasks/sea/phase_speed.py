"""The reference solution and the check of a task."""

import numpy as np

from app.lab.checking import Curve, Mistake, require


def phase_speed(k, gravity):
    """The phase speed [m/s] of a wave on deep water: c = sqrt(g/k).

    k: wavenumber [rad/m]. gravity: g [m/s2].
    """
    return np.sqrt(gravity / k)


def inputs(rng):
    return rng.uniform(0.1, 5.0), rng.uniform(1.0, 20.0)


MISTAKES = (
    Mistake("ratio upside down", "Long waves run fast: it is g/k, not k/g.", lambda k, g: np.sqrt(k / g)),
    Mistake("angular frequency", "This is omega: divide it by k.", lambda k, g: np.sqrt(g * k)),
)
CURVE = Curve("wavenumber [rad/m]", "speed [m/s]", np.linspace(0.1, 5.0, 30), lambda f, x: [f(k, 9.81) for k in x])


def behaviour(student):
    require(abs(student(1.0, 9.81) - 3.132) < 1e-3, "a wave of 1 rad/m must run at 3.13 m/s on the Earth")
