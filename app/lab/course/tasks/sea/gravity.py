"""The reference solution and the check of a task."""

import numpy as np

from app.lab.checking import Curve, Mistake, require


def gravity(mass_ratio):
    """The gravity [m/s2] at the surface of a planet that is as dense as the Earth.

    g = G M/R^2, and at the same density R grows with M^(1/3). On the Earth g = 9.81 m/s2.

    mass_ratio: the planet's mass in masses of the Earth.
    """
    return 9.81 * mass_ratio / (mass_ratio ** (1 / 3)) ** 2


def inputs(rng):
    return (10.0 ** rng.uniform(-2.0, 2.0),)


# The Earth and the lab's two planets.
EXAMPLES = ((1.0,), (100.0,), (0.01,))


MISTAKES = (
    Mistake(
        "radius unchanged",
        "A planet of 100 times the mass and the Earth's density is also larger: R grows with M^(1/3).",
        lambda m: 9.81 * m,
    ),
    Mistake(
        "mass squared", "The mass is squared. In g = G M/R^2 it is the radius that is squared.", lambda m: 9.81 * m**2
    ),
    Mistake("radius not squared", "The radius is not squared: g = G M/R^2.", lambda m: 9.81 * m ** (2 / 3)),
    Mistake(
        "radius grows with the mass",
        "The volume grows with the mass, the radius with its cube root.",
        lambda m: 9.81 / m,
    ),
    Mistake(
        "gravity unchanged",
        "g is the Earth's for every mass. R grows with M^(1/3), not with the root of M.",
        lambda m: 9.81 + 0 * m,
    ),
    Mistake("mass forgotten", "This is g for a planet of one mass but another radius.", lambda m: 9.81 * m ** (-2 / 3)),
    Mistake("upside down", "The heavier planet has the lower gravity here.", lambda m: 9.81 * m ** (-1 / 3)),
)

CONSTANT = "The lab sets g = 9.81 m/s2 on the Earth: G, M and R of tables give a little more or less."

CURVE = Curve("mass [Earth masses]", "gravity [m/s2]", np.linspace(0.1, 10.0, 25), lambda f, x: [f(m) for m in x])


def behaviour(student):
    """The Earth, and the two planets of the lab."""
    require(abs(student(1.0) - 9.81) < 0.01, "for the Earth itself it must be 9.81 m/s2")
    require(abs(student(100.0) - 45.53) < 0.1, "for 100 Earth masses it must be 45.5 m/s2")
    require(abs(student(0.01) - 2.1135) < 0.01, "for 1/100 of the Earth's mass it must be 2.11 m/s2")
