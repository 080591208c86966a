"""The reference solution and the check of a task."""

import numpy as np

from app.lab.checking import Mistake, require
from app.lab.diagnosis import links as laws


def cloth_forces(x, v, links, rest_lengths, stiffness, damping):
    """The forces [N], shape (n, 3), of all links on the n points of a cloth.

    On the first point of a link: F = k (|r| - d) r/|r| - b (v1 - v2), r = x2 - x1; on the second point: -F.
    A point gets the sum over all its links.

    x, v: positions [m] and velocities [m/s], shape (n, 3). links: numbers of the two points of each, shape (links, 2).
    rest_lengths: d [m], shape (links,). stiffness: k [N/m]. damping: b [N s/m].
    """
    x, v = np.asarray(x), np.asarray(v)
    force = np.zeros(x.shape)
    for (i, j), d in zip(links, rest_lengths, strict=True):
        r = x[j] - x[i]
        length = np.linalg.norm(r)
        pull = stiffness * (length - d) * r / length - damping * (v[i] - v[j])
        force[i] += pull
        force[j] -= pull
    return force


def inputs(rng):
    """A cloth of 2 to 4 rows and columns in a random shape, with some of its links in random order."""
    rows, cols = (int(number) for number in rng.integers(2, 5, 2))
    number = np.arange(rows * cols).reshape(rows, cols)
    steps = ((0, 1), (1, 0), (1, 1), (0, 2), (2, 0))
    pairs = [(number[: rows - i, : cols - j].ravel(), number[i:, j:].ravel()) for i, j in steps]
    links = rng.permutation(np.concatenate([np.stack(pair, axis=1) for pair in pairs]))
    links = links[: rng.integers(max(3, len(links) // 2), len(links) + 1)]
    x, v = rng.normal(size=(2, rows * cols, 3))
    return x, 2.0 * v, links, rng.uniform(0.3, 1.5, len(links)), rng.uniform(5.0, 20.0), rng.uniform(1.0, 4.0)


# Three points of the lab's cloth, one of them far away.
EXAMPLES = (
    (
        np.array([[0.0, 0, 0], [0.3, 0, 0], [0.3, 2.0, 0]]), np.array([[0.0, 0, 0], [1, 0, -5], [0, 3, 0]]),
        np.array([(0, 1), (2, 1)]), np.array([0.25, 0.25]), 2000.0, 2.0,
    ),
)  # fmt: skip


def pulls(x, v, links, d, k, b, rest=1.0, other_end=1.0):
    i, j = links.T
    r = x[j] - x[i]
    length = np.linalg.norm(r, axis=1)
    return (k * (length - rest * d) / length)[:, None] * r - b * (v[i] - other_end * v[j])


def summed(first, second, **changes):
    """A function that makes a mistake: other signs at the ends, or a part of the force left out."""

    def function(x, v, links, d, k, b):
        force, pull = np.zeros(x.shape), pulls(x, v, links, d, k, b, **changes)
        np.add.at(force, links[:, 0], first * pull)
        np.add.at(force, links[:, 1], second * pull)
        return force

    return function


def lost(x, v, links, d, k, b):
    force, pull = np.zeros(x.shape), pulls(x, v, links, d, k, b)
    force[links[:, 0]] += pull
    force[links[:, 1]] -= pull
    return force


def overwritten(x, v, links, d, k, b):
    force = np.zeros(x.shape)
    for (i, j), pull in zip(links, pulls(x, v, links, d, k, b), strict=True):
        force[i] = pull
        force[j] = -pull
    return force


def damped_at_each_end(x, v, links, d, k, b):
    force, pull = np.zeros(x.shape), pulls(x, v, links, d, k, 0.0)
    np.add.at(force, links[:, 0], pull - b * v[links[:, 0]])
    np.add.at(force, links[:, 1], -pull - b * v[links[:, 1]])
    return force


MISTAKES = (
    Mistake("force on one end only", "Only the first point of each link gets a force.", summed(1.0, 0.0)),
    Mistake("force on one end only", "Only the second point of each link gets a force.", summed(0.0, -1.0)),
    Mistake("same force on both ends", "Both ends get a force of the same sign.", summed(1.0, 1.0)),
    Mistake("rest length forgotten", "The links pull as if their rest lengths were 0.", summed(1.0, -1.0, rest=0.0)),
    Mistake(
        "repeated indices",
        "A point with several links gets the force of one only: force[i] += f with an array i "
        "that holds a number twice adds once. Use np.add.at, or a loop.",
        lost,
    ),
    Mistake("forces overwritten", "Each link overwrites the force of the link before. Add with +=.", overwritten),
    Mistake(
        "damping on absolute velocity",
        "The damping uses the velocity of one end. It damps v1 - v2.",
        summed(1.0, -1.0, other_end=0.0),
    ),
    Mistake(
        "damping on absolute velocity",
        "Each end is damped by its own velocity, as by air. A link damps v1 - v2.",
        damped_at_each_end,
    ),
    Mistake(
        "air drag for the damping of the links",
        "Each point is damped once by its own velocity, as by air. Each link damps v1 - v2.",
        lambda x, v, links, d, k, b: summed(1.0, -1.0)(x, v, links, d, k, 0.0) - b * v,
    ),
)


def of_law(law, first=1.0, second=-1.0, chosen=slice(None)):
    """The forces of the links by a law, as a function of the arguments. chosen: links."""

    def function(x, v, links, rest_lengths, stiffness, damping):
        i, j = links[chosen].T
        r = x[j] - x[i]
        pull = law(r, laws.size(r), v[i] - v[j], stiffness, damping, rest_lengths[chosen, None])
        force = np.zeros(x.shape)
        np.add.at(force, i, first * pull)
        np.add.at(force, j, second * pull)
        return force

    return function


TERMS = laws.terms_of_net(of_law)
GROUPS = laws.groups_of_net(of_law)


def behaviour(student):
    """No force on a cloth at its rest lengths, and no net force on a cloth."""
    x = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    links, d = np.array([(0, 1), (2, 3), (0, 2), (1, 3)]), np.ones(4)
    still = np.tile([1.0, 2.0, 3.0], (4, 1))
    require(
        np.abs(student(x, still, links, d, 100.0, 5.0)).max() < 1e-3, "a cloth at its rest lengths must have no force"
    )
    force = student(1.5 * x, np.arange(12.0).reshape(4, 3), links, d, 100.0, 5.0)
    require(np.abs(force.sum(axis=0)).max() < 1e-2, "the forces of the links must add up to 0 over the cloth")
