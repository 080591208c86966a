"""The reference solution and the check of a task."""

import numpy as np

from app.lab.checking import Curve, Mistake, require
from app.lab.diagnosis import links
from app.lab.diagnosis.terms import Form, Term


def rope_acceleration(x, v, mass, stiffness, damping, drag, rest_length, gravity):
    """The accelerations [m/s2], shape (n, 3), of the n points of a rope. z points up.

    a = g + (F_springs - c v) / m. Every two neighbours are joined by a spring (`spring_force` gives its force on the
    first point). Point 0 is held: its acceleration is 0.

    x, v: positions [m] and velocities [m/s], shape (n, 3). mass: m [kg] of each point. stiffness: k [N/m].
    damping: b [N s/m]. drag: c [N s/m] of the air on each point. rest_length: d [m]. gravity: g [m/s2], downwards.
    """
    x, v = np.asarray(x, dtype=float), np.asarray(v, dtype=float)
    r = x[1:] - x[:-1]
    length = np.linalg.norm(r, axis=1)[:, None]
    pull = stiffness * (length - rest_length) * r / length - damping * (v[:-1] - v[1:])
    force = -drag * v
    force[:-1] += pull
    force[1:] -= pull
    a = force / mass
    a[:, 2] -= gravity
    a[0] = 0.0
    return a


def inputs(rng):
    """A rope of three to six points in a random shape."""
    n = int(rng.integers(3, 7))
    x = np.cumsum(rng.normal(size=(n, 3)), axis=0)
    numbers = rng.uniform((0.3, 20.0, 1.0, 0.5, 0.5, 5.0), (3.0, 60.0, 8.0, 4.0, 1.5, 15.0))
    return (x, 3.0 * rng.normal(size=(n, 3)), *(float(number) for number in numbers))


def lab_rope(n, sag):
    """The lab's rope of n points, 2 m long, which swings. sag: how far its links are stretched [m]."""
    i = np.arange(n)[:, None]
    x = i * (2.0 / (n - 1) + sag) * np.array([0.6, 0.0, -0.8])
    v = i * np.array([0.5, 0.2, -0.1])
    return x, v, 1.0, 800.0, 7.0, 1.0, 2.0 / (n - 1), 10.0


EXAMPLES = (lab_rope(10, 0.05), lab_rope(2, 0.1), lab_rope(30, -0.01))


def variant(first=1.0, second=-1.0, spring_mass=None, weight=1.0, weight_axis=2, held=True, rest=1.0):
    """A function that makes a mistake: a part of the reference with another factor."""

    def function(x, v, mass, stiffness, damping, drag, rest_length, gravity):
        r = x[1:] - x[:-1]
        length = np.linalg.norm(r, axis=1)[:, None]
        pull = stiffness * (length - rest * rest_length) * r / length - damping * (v[:-1] - v[1:])
        force = -drag * v
        force[:-1] += first * pull
        force[1:] += second * pull
        a = force / mass if spring_mass is None else force * mass**spring_mass
        a[:, weight_axis] -= weight * gravity
        if held:
            a[0] = 0.0
        return a

    return function


MISTAKES = (
    Mistake("mass forgotten", "The forces are not divided by the mass: a = F/m.", variant(spring_mass=0)),
    Mistake(
        "multiplied by the mass", "The forces are multiplied by the mass. Newton: a = F/m.", variant(spring_mass=1)
    ),
    Mistake(
        "force on one end only",
        "A spring pulls its first point, but not its second. Both ends get a force, of opposite sign.",
        variant(second=0.0),
    ),
    Mistake(
        "force on one end only",
        "A spring pulls its second point, but not its first. Both ends get a force, of opposite sign.",
        variant(first=0.0),
    ),
    Mistake(
        "same force on both ends",
        "Both ends of a spring get a force of the same sign. Newton's third law: the second gets the opposite one.",
        variant(second=1.0),
    ),
    Mistake(
        "sign of the springs reversed", "Stretched springs push their ends apart.", variant(first=-1.0, second=1.0)
    ),
    Mistake("root not held", "Point 0 moves. It is held, so that its acceleration is 0.", variant(held=False)),
    Mistake(
        "gravity upwards",
        "Gravity points upwards. z points up, so that its acceleration is -g in z.",
        variant(weight=-1.0),
    ),
    Mistake(
        "gravity along the wrong axis", "Gravity acts along y here. In this lab z points up.", variant(weight_axis=1)
    ),
    Mistake(
        "gravity divided by the mass",
        "Gravity is divided by the mass. The weight is m g, so that m cancels: every point falls with g.",
        lambda x, v, mass, stiffness, damping, drag, rest_length, gravity: rope_acceleration(
            x, v, mass, stiffness, damping, drag, rest_length, gravity / mass
        ),
    ),
    Mistake(
        "gravity multiplied by the mass",
        "Gravity is multiplied by the mass. The weight is m g, and its acceleration g.",
        lambda x, v, mass, stiffness, damping, drag, rest_length, gravity: rope_acceleration(
            x, v, mass, stiffness, damping, drag, rest_length, gravity * mass
        ),
    ),
    Mistake("rest length forgotten", "The springs pull as if their rest length were 0.", variant(rest=0.0)),
)


def of_law(law, first=1.0, second=-1.0, chosen=slice(None)):
    """The accelerations of the links by a law, as a function of the arguments. chosen: links."""

    def function(x, v, mass, stiffness, damping, drag, rest_length, gravity):
        r = x[1:] - x[:-1]
        force = law(r, links.size(r), v[:-1] - v[1:], stiffness, damping, rest_length)
        a = np.zeros(x.shape)
        a[:-1][chosen] += first * force[chosen] / mass
        a[1:][chosen] += second * force[chosen] / mass
        a[0] = 0.0
        return a

    return function


def overwritten(x, v, mass, stiffness, damping, drag, rest_length, gravity):
    r = x[1:] - x[:-1]
    force = links.both(r, links.size(r), v[:-1] - v[1:], stiffness, damping, rest_length) / mass
    a = np.vstack([force, -force[-1:]])
    a[0] = 0.0
    return a


def ring(x, v, mass, stiffness, damping, drag, rest_length, gravity):
    closed = of_law(links.both)(x, v, mass, stiffness, damping, drag, rest_length, gravity)
    r = x[0] - x[-1]
    pull = links.both(r, links.size(r), v[-1] - v[0], stiffness, damping, rest_length) / mass
    closed[-1] += pull
    return closed


def all_pairs(x, v, mass, stiffness, damping, drag, rest_length, gravity):
    r, dv = x[None] - x[:, None], v[:, None] - v[None]
    length = links.size(r) + np.eye(len(x))[:, :, None]
    a = links.both(r, length, dv, stiffness, damping, rest_length).sum(axis=1) / mass
    a[0] = 0.0
    return a


def air_drag(x, v, mass, stiffness, damping, drag, rest_length, gravity):
    a = -drag * v / mass
    a[0] = 0.0
    return a


def squared_drag(x, v, mass, stiffness, damping, drag, rest_length, gravity):
    a = -drag * links.size(v) * v / mass
    a[0] = 0.0
    return a


def weight(x, v, mass, stiffness, damping, drag, rest_length, gravity):
    a = np.zeros(x.shape)
    a[1:, 2] = -gravity
    return a


def weight_on_all_axes(x, v, mass, stiffness, damping, drag, rest_length, gravity):
    a = np.full(x.shape, -gravity)
    a[0] = 0.0
    return a


def drag_of_next(x, v, mass, stiffness, damping, drag, rest_length, gravity):
    a = np.zeros(x.shape)
    a[1:-1] = -drag * v[2:] / mass
    return a


TERMS = (
    *links.terms_of_net(of_law, " / m"),
    Term(
        "the air drag",
        "-c v / m",
        air_drag,
        (
            Form("-c |v| v / m", "The speed is squared.", squared_drag),
            Form("-c v / m with the velocity of the next point", "Each point has its own velocity.", drag_of_next),
        ),
    ),
    Term(
        "gravity",
        "-g in z",
        weight,
        (Form("-g in x, y and z", "It acts in z only: subtract it from a[:, 2].", weight_on_all_axes),),
    ),
)
GROUPS = links.groups_of_net(
    of_law, " / m",
    (
        Form("that of one link at each point", "Add with +=.", overwritten),
        Form(
            "that of all pairs of points", "Only neighbours are joined.", all_pairs,
        ),
        Form(
            "that of a ring", "A force acts between the first point and the last, which are no neighbours: x[i - 1] is "
            "the last point for i = 0.", ring,
        ),
    ),
)  # fmt: skip

CURVE = Curve(
    "length of the last link, 0.2 m at rest [m]",
    "acceleration of the last point [m/s2]",
    np.linspace(0.15, 0.25, 41),
    lambda f, x: [
        f(np.array([[0, 0, 0], [0, 0, -0.2], [0, 0, -0.2 - d]]), np.zeros((3, 3)), 1.0, 800.0, 7.0, 1.0, 0.2, 10.0)[
            2, 2
        ]
        for d in x
    ],
)


def behaviour(student):
    """The hanging chain at rest in closed form, and momentum."""
    n, m, k, d, g = 10, 1.0, 800.0, 2.0 / 9.0, 10.0
    loads = m * g * np.arange(n - 1, 0, -1)
    x = np.zeros((n, 3))
    x[1:, 2] = -np.cumsum(d + loads / k)
    a = student(x, np.zeros((n, 3)), m, k, 7.0, 1.0, d, g)
    require(
        np.abs(a).max() < 1e-2 * g,
        "a rope that hangs at rest must have no acceleration",
    )
    a = student(x, np.zeros((n, 3)), m, k, 7.0, 1.0, 0.3 * d, 0.0)
    middle = a[1:].sum(axis=0) * m
    pull = np.array([0.0, 0.0, k * (-x[1, 2] - 0.3 * d)])
    require(
        np.abs(middle - pull).max() < 1e-2 * np.abs(pull).max(),
        "all forces between the points must cancel: only the spring at the root pulls the rope as a whole",
    )
