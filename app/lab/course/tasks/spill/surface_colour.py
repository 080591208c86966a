"""The reference solution and the check of a task."""

import numpy as np

from app.lab.checking import Curve, Mistake, require


def surface_colour(oil_colour, water_colour, thickness, absorption):
    """The colour of water below a layer of oil: red, green, blue, shape (3,), each from 0 to 1.

    Light passes the oil down and up again, so that the fraction T = exp(-2 a d) of the water's colour is seen:
    colour = T water + (1 - T) oil.

    oil_colour, water_colour: red, green, blue, shape (3,). thickness: d [m]. absorption: a [1/m].
    """
    seen = np.exp(-2 * absorption * thickness)
    return seen * np.asarray(water_colour) + (1 - seen) * np.asarray(oil_colour)


def inputs(rng):
    oil, water = rng.uniform(0.05, 0.95, size=(2, 3))
    return oil, water, rng.uniform(0.01, 0.1), rng.uniform(2.0, 20.0)


# The lab's oil, from none to thick.
EXAMPLES = tuple((np.array([0.1, 0.07, 0.04]), np.array([0.0, 0.3, 0.4]), d, 15.0) for d in (0.0, 1e-3, 0.2, 3.0))


MISTAKES = (
    Mistake(
        "light passes once",
        "The light passes the oil twice, down and up: exp(-2 a d).",
        lambda o, w, d, a: np.exp(-a * d) * w + (1 - np.exp(-a * d)) * o,
    ),
    Mistake(
        "colours swapped",
        "Thin oil looks like oil here. T is the fraction of the water.",
        lambda o, w, d, a: surface_colour(w, o, d, a),
    ),
    Mistake(
        "sign reversed in the exponent",
        "Thick oil lets more light through here: the exponent is -2 a d.",
        lambda o, w, d, a: np.exp(2 * a * d) * w + (1 - np.exp(2 * a * d)) * o,
    ),
    Mistake(
        "fractions do not sum to one",
        "The oil's colour is added in full. Its fraction is 1 - T.",
        lambda o, w, d, a: np.exp(-2 * a * d) * w + o,
    ),
    Mistake(
        "exponential forgotten",
        "The fraction falls as 1 - 2 a d. Each layer absorbs a fraction of what is left: exp(-2 a d).",
        lambda o, w, d, a: (1 - 2 * a * d) * w + 2 * a * d * o,
    ),
    Mistake(
        "mean of the colours",
        "This is the mean of the two colours, whatever the thickness.",
        lambda o, w, d, a: (o + w) / 2,
    ),
    Mistake("colour of the oil alone", "A thin layer lets the water shine through.", lambda o, w, d, a: o),
)

CURVE = Curve(
    "thickness of the oil [m]",
    "fraction of red",
    np.linspace(0.0, 0.2, 40),
    lambda f, x: [f(np.array([0.1, 0.07, 0.04]), np.array([0.0, 0.3, 0.4]), d, 15.0)[0] for d in x],
)


def behaviour(student):
    """Without oil the water's colour, under thick oil the oil's."""
    oil, water = np.array([0.2, 0.1, 0.05]), np.array([0.0, 0.3, 0.5])
    require(
        np.allclose(student(oil, water, 0.0, 10.0), water, atol=1e-3),
        "without oil the colour must be that of the water",
    )
    require(np.allclose(student(oil, water, 5.0, 10.0), oil, atol=1e-3), "thick oil must have the colour of the oil")
