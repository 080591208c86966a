"""The reference solution and the check of a task."""

import numpy as np

from app.lab.checking import Curve, Mistake, Wrong, require
from app.lab.diagnosis import links
from app.lab.diagnosis.terms import Form, Term


def spring_force(x1, x2, v1, v2, stiffness, damping, rest_length):
    """The force [N], shape (3,), on the first of two points that a damped spring joins.

    F1 = k (|r| - d) r/|r| - b (v1 - v2), with r = x2 - x1, the vector from the first point to the second.

    x1, x2: positions [m], shape (3,). v1, v2: velocities [m/s], shape (3,). stiffness: k [N/m]. damping: b [N s/m].
    rest_length: d [m].
    """
    r = np.asarray(x2) - np.asarray(x1)
    length = np.linalg.norm(r)
    return stiffness * (length - rest_length) * r / length - damping * (np.asarray(v1) - np.asarray(v2))


def inputs(rng):
    """Two points 0.2 to 2 m apart, and a rest length that differs from that."""
    x1, v1, v2 = rng.normal(size=(3, 3))
    r = rng.normal(size=3)
    r *= rng.uniform(0.2, 2.0) / np.linalg.norm(r)
    return x1, x1 + r, 3.0 * v1, 3.0 * v2, rng.uniform(5.0, 20.0), rng.uniform(1.0, 5.0), rng.uniform(0.5, 1.5)


# The lab's rope: one spring under the whole weight, one that snaps back, one along x.
EXAMPLES = (
    (np.array([0.0, 0.0, 2.0]), np.array([0.0, 0.0, 1.65]), np.zeros(3), np.array([0.0, 0.0, -3.0]), 800.0, 7.0, 2 / 9),
    (np.array([1.0, 0.5, 2.0]), np.array([1.1, 0.5, 2.0]), np.zeros(3), np.array([8.0, 2.0, -6.0]), 800.0, 7.0, 2 / 9),
    (np.array([0.0, 0.0, 0.0]), np.array([3.0, 0.0, 0.0]), np.zeros(3), np.zeros(3), 1e4, 0.0, 0.2),
)


def only_pulls(x1, x2, v1, v2, k, b, d):
    return spring_force(x1, x2, v1, v2, k if np.linalg.norm(x2 - x1) > d else 0.0, b, d)


def not_normalised(x1, x2, v1, v2, k, b, d):
    r = x2 - x1
    return k * (np.linalg.norm(r) - d) * r - b * (v1 - v2)


def axial_damping(x1, x2, v1, v2, k, b, d):
    r = (x2 - x1) / np.linalg.norm(x2 - x1)
    return spring_force(x1, x2, v1, v2, k, 0.0, d) - b * ((v1 - v2) @ r) * r


MISTAKES = (
    Mistake(
        "sign reversed",
        "The force points the wrong way. A stretched spring pulls the first point towards the second: look at the "
        "direction of r, and at v1 - v2.",
        lambda *arguments: -spring_force(*arguments),
    ),
    Mistake(
        "sign of the spring reversed",
        "A stretched spring pushes its ends apart here. r must run from x1 to x2, so that it pulls x1 towards x2.",
        lambda x1, x2, v1, v2, k, b, d: spring_force(x1, x2, v1, v2, -k, b, d),
    ),
    Mistake(
        "sign of the damping reversed",
        "The damping drives the motion on. On the first point it is -b (v1 - v2).",
        lambda x1, x2, v1, v2, k, b, d: spring_force(x1, x2, v1, v2, k, -b, d),
    ),
    Mistake(
        "rest length forgotten",
        "The spring pulls as if its rest length were 0. The stretch is |r| - d, not |r|.",
        lambda x1, x2, v1, v2, k, b, d: k * (x2 - x1) - b * (v1 - v2),
    ),
    Mistake(
        "damping on absolute velocity",
        "The damping uses v1 only, so that it also brakes a spring that moves as a whole. A spring damps the relative "
        "velocity v1 - v2.",
        lambda x1, x2, v1, v2, k, b, d: spring_force(x1, x2, v1, 0.0 * v2, k, b, d),
    ),
    Mistake(
        "no force when compressed",
        "This spring only pulls, as a rope does. A spring also pushes its ends apart where it is shorter than d: leave "
        "out the condition on the sign of |r| - d.",
        only_pulls,
    ),
    Mistake(
        "direction not of unit length",
        "The stretch is multiplied by r instead of r/|r|: a long spring gets too large a force.",
        not_normalised,
    ),
    Mistake(
        "force not along the link",
        "The rest length is subtracted from every component of r. Subtract it from the length |r|; the force then "
        "points along r.",
        lambda x1, x2, v1, v2, k, b, d: k * (x2 - x1 - d) - b * (v1 - v2),
    ),
    Mistake(
        "damping along the link only",
        "The damping acts along the spring only. That is a good model, but this rope damps all of v1 - v2.",
        axial_damping,
    ),
)


def of_law(law):
    """A law of links as a function of the arguments."""

    def function(x1, x2, v1, v2, stiffness, damping, rest_length):
        r = x2 - x1
        return law(r, links.size(r), v1 - v2, stiffness, damping, rest_length)

    return function


TERMS = (
    Term(
        "the spring",
        links.SPRING,
        of_law(links.spring),
        tuple(Form(text, why, of_law(law)) for text, why, law in links.SPRING_FORMS),
    ),
    Term(
        "the damping",
        links.DAMPING,
        of_law(links.damping),
        tuple(Form(text, why, of_law(law)) for text, why, law in links.DAMPING_FORMS),
    ),
)

CURVE = Curve(
    "length [m]",
    "force along the spring [N]",
    np.linspace(0.2, 2.0, 19),
    lambda f, x: [f(np.zeros(3), np.array([r, 0.0, 0.0]), np.zeros(3), np.zeros(3), 10.0, 1.0, 1.0)[0] for r in x],
)


def behaviour(student):
    """No force at rest; Newton's third law; a pull when stretched, a push when compressed."""
    x, v = np.array([0.3, -0.2, 0.1]), np.array([1.0, 2.0, -1.0])
    along = np.array([0.6, 0.0, 0.8])
    rest = student(x, x + along, v, v, 100.0, 5.0, 1.0)
    require(np.abs(rest).max() < 1e-3, "a spring at its rest length that moves as a whole must give no force")
    pair = [student(a, b, p, q, 100.0, 5.0, 0.7) for a, b, p, q in ((x, x + along, v, 0 * v), (x + along, x, 0 * v, v))]
    if np.abs(pair[0] + pair[1]).max() > 1e-3 * np.abs(pair[0]).max():
        raise Wrong("the forces on the two ends do not add up to 0, as Newton's third law asks", "one end only")
    require(
        student(x, x + along, v, v, 100.0, 0.0, 0.5) @ along > 0.0, "a stretched spring must pull its ends together"
    )
    require(student(x, x + along, v, v, 100.0, 0.0, 2.0) @ along < 0.0, "a compressed spring must push its ends apart")
