"""The reference solution and the check of a task."""

import numpy as np

from app.lab.checking import Curve, Mistake, require


def line_tension(weight, hanging, height):
    """The tension [N] at the upper end of a line that hangs down to a level bed and lies on.

    Where it touches down it is level: the forces on the hanging part give H = w (s^2 - z^2)/(2 z) and V = w s, so that
    T = w (s^2 + z^2)/(2 z).

    weight: w [N/m], in water. hanging: length s [m] that hangs. height: z [m] of the upper end over the bed.
    """
    return weight * (hanging**2 + height**2) / (2 * height)


def inputs(rng):
    height = rng.uniform(10.0, 100.0)
    return rng.uniform(10.0, 2000.0), height * rng.uniform(1.1, 4.0), height


# The lab's line: straight down, hanging, and nearly level.
EXAMPLES = ((750.0, 40.0, 40.0), (750.0, 80.0, 40.0), (0.5, 300.0, 10.0))


MISTAKES = (
    Mistake(
        "horizontal part only",
        "This is the horizontal part, H. The line also carries the weight of its hanging part, V = w s.",
        lambda w, s, z: w * (s**2 - z**2) / (2 * z),
    ),
    Mistake("weight only", "This is the hanging weight. The line also pulls sideways.", lambda w, s, z: w * s),
    Mistake(
        "parts added",
        "The level and the upward part are at right angles: the tension is the root of the sum of their squares.",
        lambda w, s, z: w * (s**2 - z**2) / (2 * z) + w * s,
    ),
    Mistake("factor 2 forgotten", "Divide by twice the height.", lambda w, s, z: w * (s**2 + z**2) / z),
)
CURVE = Curve(
    "hanging length [m]", "tension [N]", np.linspace(40.0, 120.0, 30), lambda f, x: [f(750.0, s, 40.0) for s in x]
)


def behaviour(student):
    """Straight down it carries its own weight; the tension is H + w z."""
    require(abs(student(100.0, 30.0, 30.0) - 3000.0) < 0.01, "a line that hangs straight down has another tension")
    level = 100.0 * (50.0**2 - 30.0**2) / 60.0
    require(abs(student(100.0, 50.0, 30.0) - level - 3000.0) < 0.01, "the tension must be its horizontal part and w z")
