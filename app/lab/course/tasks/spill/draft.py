"""The reference solution and the check of a task."""

import numpy as np

from app.lab.checking import Curve, Mistake, require
from app.lab.diagnosis.differences import Case


def draft(body_density, height, oil_density, oil_thickness, water_density):
    """The draft [m] of a box that floats upright: the depth of its bottom below the surface of the oil.

    The box displaces its own weight. Where the oil alone carries it, rho_body H = rho_oil D. Otherwise it reaches
    into the water: rho_body H = rho_oil d + rho_water (D - d).

    body_density: rho_body [kg/m3], less than oil and water. height: H [m]. oil_density: rho_oil [kg/m3].
    oil_thickness: d [m]. water_density: rho_water [kg/m3].
    """
    load = body_density * height
    if load <= oil_density * oil_thickness:
        return load / oil_density
    return oil_thickness + (load - oil_density * oil_thickness) / water_density


def inputs(rng):
    """Boxes that float in the oil alone, and boxes that reach into the water."""
    d = rng.choice([rng.uniform(0.05, 0.2), rng.uniform(1.0, 2.0)])
    return rng.uniform(300.0, 700.0), rng.uniform(0.5, 1.0), rng.uniform(750.0, 950.0), d, rng.uniform(1000.0, 1100.0)


# The lab's box of 1 m and 500 kg/m3, in layers around the one that just carries it.
EXAMPLES = tuple((500.0, 1.0, 850.0, d, 1025.0) for d in (0.0, 0.2, 0.55, 0.6, 0.7, 0.95, 5.0))


MISTAKES = (
    Mistake("oil forgotten", "This is the draft in water alone.", lambda b, H, o, d, w: b * H / w),
    Mistake(
        "water forgotten",
        "This is the draft in oil alone: a thin layer does not carry the box.",
        lambda b, H, o, d, w: b * H / o,
    ),
    Mistake(
        "thick oil forgotten",
        "Where the oil is so thick that it carries the box alone, the box does not reach the water. "
        "Tell the two cases apart.",
        lambda b, H, o, d, w: d + (b * H - o * d) / w,
    ),
    Mistake(
        "depth in the water only",
        "This is the depth below the interface. Add the thickness of the oil.",
        lambda b, H, o, d, w: b * H / o if b * H <= o * d else (b * H - o * d) / w,
    ),
    Mistake(
        "lift of the oil forgotten",
        "The oil carries nothing here: subtract rho_oil d from the load of the water.",
        lambda b, H, o, d, w: b * H / o if b * H <= o * d else d + b * H / w,
    ),
    Mistake(
        "mean density",
        "This takes the mean density of a box that is wholly under the surface. Count the oil, then the water.",
        lambda b, H, o, d, w: b * H / ((o * d + w * (H - d)) / H),
    ),
    Mistake(
        "densities swapped", "The densities of oil and water are swapped.", lambda b, H, o, d, w: draft(b, H, w, d, o)
    ),
    Mistake(
        "density of air",
        "This uses the density of air. Above the oil the box displaces nothing that counts.",
        lambda b, H, o, d, w: draft(b, H, 1.2, d, w),
    ),
    Mistake(
        "cases swapped",
        "The two cases are swapped: the oil alone carries the box where rho_body H <= rho_oil d.",
        lambda b, H, o, d, w: d + (b * H - o * d) / w if b * H <= o * d else b * H / o,
    ),
)

CASES = (
    Case("where the oil alone carries the box", lambda b, H, o, d, w: b * H <= o * d),
    Case("where the box reaches into the water", lambda b, H, o, d, w: b * H > o * d),
)
CURVE = Curve(
    "thickness of the oil [m]",
    "draft [m]",
    np.linspace(0.0, 1.0, 21),
    lambda f, x: [f(500.0, 1.0, 850.0, d, 1025.0) for d in x],
)


def behaviour(student):
    """Reference drafts."""
    require(
        abs(student(500.0, 1.0, 850.0, 0.2, 1025.0) - 0.521951) < 1e-4,
        "a box that reaches through the oil into the water has another draft",
    )
    require(
        abs(student(500.0, 1.0, 850.0, 5.0, 1025.0) - 0.588235) < 1e-4,
        "a box that the oil alone carries has another draft",
    )
