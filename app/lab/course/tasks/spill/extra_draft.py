"""The reference solution and the check of a task."""

import numpy as np

from app.lab.checking import Curve, Mistake, require


def extra_draft(oil_thickness, oil_density, water_density):
    """Extra draft [m] of a box when a layer of oil comes onto the water: depth of its bottom below the surface.

    Before and after, the box displaces its own weight: of water alone, then of a layer of oil of thickness d and of
    the water below it.

    oil_thickness: d [m]. oil_density, water_density: rho [kg/m3].
    """
    return oil_thickness * (1 - oil_density / water_density)


def inputs(rng):
    return rng.uniform(0.05, 0.6), rng.uniform(700.0, 990.0), rng.uniform(995.0, 1200.0)


EXAMPLES = ((0.2, 850.0, 1025.0), (0.0, 866.0, 1025.0), (3.0, 700.0, 1000.0))


MISTAKES = (
    Mistake(
        "the whole thickness",
        "This is d. The oil carries too: only the part 1 - rho_oil/rho_water of d is lost.",
        lambda d, o, w: d,
    ),
    Mistake(
        "the part that the oil carries",
        "This is what the oil carries. The extra draft is the rest, d minus that.",
        lambda d, o, w: d * o / w,
    ),
    Mistake(
        "densities swapped",
        "The ratio is upside down: it is rho_oil/rho_water, below 1.",
        lambda d, o, w: d * (1 - w / o),
    ),
    Mistake(
        "relative to the oil",
        "The difference of the densities is divided by that of the oil. The box ends in water: "
        "divide by that of the water.",
        lambda d, o, w: d * (w / o - 1),
    ),
    Mistake(
        "sign reversed",
        "The box comes up here. Oil carries less than water, so that it sinks.",
        lambda d, o, w: d * (o / w - 1),
    ),
    Mistake(
        "density of air",
        "A layer of air would do that. Oil carries 700 times more than air.",
        lambda d, o, w: d * (1 - 1.2 / w),
    ),
    Mistake(
        "difference not divided",
        "Divide the difference of the densities by that of the water.",
        lambda d, o, w: d * (w - o),
    ),
)

CURVE = Curve(
    "thickness of the oil [m]",
    "extra draft [m]",
    np.linspace(0.0, 0.6, 30),
    lambda f, x: [f(d, 866.0, 1025.0) for d in x],
)


def behaviour(student):
    """Oil as dense as water changes nothing; the reference drafts of two fluids."""
    require(abs(student(0.5, 1000.0, 1000.0)) < 1e-6, "a layer as dense as water must change nothing")
    require(abs(student(0.2, 850.0, 1025.0) - 0.034146) < 1e-4, "0.2 m of oil of 850 kg/m3 on sea water make 0.0341 m")
