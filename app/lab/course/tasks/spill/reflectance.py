"""The reference solution and the check of a task."""

import numpy as np

from app.lab.checking import Curve, Mistake, require


def reflectance(angle, index):
    """Fraction of unpolarised light that a surface reflects, by Fresnel's equations.

    With c = cos(angle) and t = sqrt(1 - (sin(angle)/n)^2), the cosine below the surface:
    R_s = ((c - n t)/(c + n t))^2, R_p = ((n c - t)/(n c + t))^2, R = (R_s + R_p)/2.

    angle: between the light and the surface's normal [rad], 0 to pi/2. index: refractive index n of the fluid.
    """
    c = np.cos(angle)
    t = np.sqrt(1 - (np.sin(angle) / index) ** 2)
    return (((c - index * t) / (c + index * t)) ** 2 + ((index * c - t) / (index * c + t)) ** 2) / 2


def inputs(rng):
    return rng.uniform(0.1, 1.4), rng.uniform(1.3, 1.6)


# From straight down to along the surface, for oil and water.
EXAMPLES = ((0.0, 1.333), (1e-3, 1.47), (1.55, 1.47), (np.pi / 2, 1.333))


def polarised(angle, n):
    c, t = np.cos(angle), np.sqrt(1 - (np.sin(angle) / n) ** 2)
    return (c - n * t) / (c + n * t), (n * c - t) / (n * c + t)


def bent_the_wrong_way(angle, n):
    c, t = np.cos(angle), np.sqrt(np.maximum(1 - np.sin(angle) ** 2 * n**2, 0.0))
    return (((c - n * t) / (c + n * t)) ** 2 + ((n * c - t) / (n * c + t)) ** 2) / 2


MISTAKES = (
    Mistake(
        "one polarisation only",
        "This is R_s. Unpolarised light has half of each.",
        lambda a, n: polarised(a, n)[0] ** 2,
    ),
    Mistake(
        "one polarisation only",
        "This is R_p. Unpolarised light has half of each.",
        lambda a, n: polarised(a, n)[1] ** 2,
    ),
    Mistake(
        "sum instead of mean",
        "The two reflectances are added: take their mean.",
        lambda a, n: sum(r**2 for r in polarised(a, n)),
    ),
    Mistake(
        "not squared",
        "These are ratios of amplitudes. Reflectance is their square.",
        lambda a, n: sum(polarised(a, n)) / 2,
    ),
    Mistake(
        "not squared",
        "These are ratios of amplitudes. Reflectance is their square.",
        lambda a, n: sum(abs(r) for r in polarised(a, n)) / 2,
    ),
    Mistake(
        "angle not used",
        "This is the reflectance straight down, ((n - 1)/(n + 1))^2. An angle that is taken as degrees gives that too.",
        lambda a, n: ((n - 1) / (n + 1)) ** 2,
    ),
    Mistake(
        "light bent the wrong way", "Below the surface the sine is divided by n, not multiplied.", bent_the_wrong_way
    ),
    Mistake(
        "mean before the square",
        "This squares the mean. Take the mean of the squares.",
        lambda a, n: (sum(polarised(a, n)) / 2) ** 2,
    ),
    Mistake(
        "angle from the surface",
        "The angle is taken from the surface. It is the angle from the normal: sine and cosine change places.",
        lambda a, n: reflectance(np.pi / 2 - a, n),
    ),
    Mistake("light that passes", "This is the part that passes into the fluid.", lambda a, n: 1 - reflectance(a, n)),
)

CURVE = Curve("angle [rad]", "reflectance of oil", np.linspace(0.02, 1.55, 30), lambda f, x: [f(a, 1.47) for a in x])


def behaviour(student):
    """Straight down ((n - 1)/(n + 1))^2; along the surface everything."""
    require(abs(student(0.0, 1.333) - 0.02037) < 1e-4, "water reflects another fraction straight down")
    require(student(1.5707, 1.333) > 0.99, "along the surface everything must be reflected")
