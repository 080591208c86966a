"""The reference solution and the check of a task."""

import numpy as np

from app.lab.checking import Curve, Mistake, require


def net_buoyancy(volume, body_density, fluid_density, gravity):
    """The net force [N], positive upwards, on a body that is wholly inside a fluid: buoyancy less weight.

    volume: V [m3]. body_density, fluid_density: rho [kg/m3]. gravity: g [m/s2].
    """
    return (fluid_density - body_density) * gravity * volume


def inputs(rng):
    return rng.uniform(0.2, 3.0), rng.uniform(700.0, 1300.0), rng.uniform(800.0, 1100.0), rng.uniform(2.0, 20.0)


EXAMPLES = ((1.0, 500.0, 1025.0, 9.81), (1e-3, 7850.0, 1025.0, 9.81), (1000.0, 866.0, 866.0, 45.53))


MISTAKES = (
    Mistake(
        "sign reversed",
        "The force points down where it must point up: buoyancy counts upwards, weight downwards.",
        lambda V, b, f, g: (b - f) * g * V,
    ),
    Mistake(
        "weight forgotten", "This is the buoyancy alone. Subtract the weight of the body.", lambda V, b, f, g: f * g * V
    ),
    Mistake("buoyancy forgotten", "This is the weight alone.", lambda V, b, f, g: -b * g * V),
    Mistake(
        "weight and buoyancy added", "Weight and buoyancy point opposite ways.", lambda V, b, f, g: (f + b) * g * V
    ),
    Mistake("gravity forgotten", "This is a mass: multiply by g.", lambda V, b, f, g: (f - b) * V),
    Mistake("volume forgotten", "This is the force on 1 m3: multiply by V.", lambda V, b, f, g: (f - b) * g),
    Mistake(
        "density of air",
        "The buoyancy is that of air. The body is inside the fluid, whatever is above.",
        lambda V, b, f, g: (1.2 - b) * g * V,
    ),
)

CURVE = Curve(
    "density of the body [kg/m3]",
    "net force on 1 m3 in sea water [N]",
    np.linspace(700.0, 1300.0, 30),
    lambda f, x: [f(1.0, density, 1025.0, 9.81) for density in x],
)


def behaviour(student):
    """A body as dense as the fluid floats in it anywhere; a lighter one rises."""
    require(abs(student(2.0, 1000.0, 1000.0, 9.81)) < 1.0, "a body as dense as the fluid must feel no net force")
    require(student(1.0, 850.0, 1025.0, 9.81) > 0.0, "oil in water must be pushed up")
