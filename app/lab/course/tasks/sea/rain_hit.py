"""The reference solution and the check of a task."""

import numpy as np

from app.lab.checking import Mistake, require


def rain_hit(z0, z1, level0, level1):
    """Time at which rain drops meet the surface: the fraction of the time step, shape (n,), infinite for no meeting.

    In a step a drop falls from z0 to z1, and the surface below it moves from level0 to level1, both at constant speed.
    They meet at the fraction s = (z0 - level0)/((z0 - level0) - (z1 - level1)). There is a meeting if the drop
    starts above the surface (z0 > level0) and ends on it or below (z1 <= level1).

    z0, z1: heights of the drops [m], shape (n,). level0, level1: heights of the surface at the drops [m], shape (n,).
    """
    start, end = np.asarray(z0) - np.asarray(level0), np.asarray(z1) - np.asarray(level1)
    hit = (start > 0) & (end <= 0)
    return np.where(hit, start / np.where(hit, start - end, 1), np.inf)


def inputs(rng):
    """Drops above, through and below a surface that rises or falls."""
    n = int(rng.integers(5, 16))
    z0 = rng.uniform(-0.3, 2.0, n)
    level0 = rng.uniform(-0.3, 0.3, n)
    return z0, z0 - rng.uniform(0.2, 2.0, n), level0, level0 + rng.uniform(-0.6, 0.6, n)


# A drop that starts on the surface has met it before; one that ends on it meets it now.
EXAMPLES = (
    (np.array([0.5, 1.0, 2.0]), np.array([-1.0, 0.25, 3.0]), np.array([0.5, 0.0, 0.0]), np.array([0.0, 0.25, 0.5])),
    (np.array([0.0]), np.array([-1.0]), np.array([0.0]), np.array([0.0])),
    (np.array([8.0, 1.0]), np.array([0.0, 1.0]), np.array([0.0, 0.0]), np.array([0.0, 1.0])),
)


def share(start, end, hit):
    with np.errstate(all="ignore"):
        return np.where(hit, start / (start - end), np.inf)


def levels(first, last):
    """A function that makes a mistake: the surface is taken as still."""

    def function(z0, z1, level0, level1):
        a, b = z0 - (level0, level1)[first], z1 - (level0, level1)[last]
        return share(a, b, (a > 0) & (b <= 0))

    return function


def still_way(z0, z1, level0, level1):
    start, end = z0 - level0, z1 - level1
    return np.where((start > 0) & (end <= 0), start / (z0 - z1), np.inf)


def with_start_and_end(function):
    """A function of the heights above the surface at start and end."""
    return lambda z0, z1, level0, level1: function(z0 - level0, z1 - level1)


MISTAKES = (
    Mistake(
        "surface taken as still", "The surface is taken where it was at the start. It moves to level1.", levels(0, 0)
    ),
    Mistake(
        "surface taken as still", "The surface is taken where it is at the end. It comes from level0.", levels(1, 1)
    ),
    Mistake(
        "motion of the surface forgotten",
        "This is a fraction of the drop's path, z0 - z1. The surface moves too: divide by the fall relative "
        "to it, (z0 - level0) - (z1 - level1).",
        still_way,
    ),
    Mistake(
        "only the end is tested",
        "Drops that start below the surface count as well: they have met it before. Test z0 > level0 too.",
        with_start_and_end(lambda a, b: share(a, b, b <= 0)),
    ),
    Mistake(
        "misses not infinite",
        "Drops that do not meet the surface must get infinity.",
        with_start_and_end(lambda a, b: share(a, b, True)),
    ),
    Mistake(
        "fraction from the end",
        "This is the fraction that is left after the meeting.",
        with_start_and_end(lambda a, b: np.where((a > 0) & (b <= 0), -b / (a - b), np.inf)),
    ),
    Mistake(
        "true or false",
        "This is only true or false. Return the time of the meeting.",
        with_start_and_end(lambda a, b: (a > 0) & (b <= 0)),
    ),
    Mistake(
        "end of the step",
        "Every meeting is put at the end of the step. The drop meets the surface before.",
        with_start_and_end(lambda a, b: np.where((a > 0) & (b <= 0), 1.0, np.inf)),
    ),
    Mistake(
        "0 for no meeting",
        "Drops that do not meet the surface get 0, which is the start of the step. Give them infinity.",
        with_start_and_end(lambda a, b: np.where((a > 0) & (b <= 0), a / (a - b), 0.0)),
    ),
    Mistake(
        "distance instead of fraction",
        "This is the height above the surface. Divide it by its decrease within the step.",
        with_start_and_end(lambda a, b: np.where((a > 0) & (b <= 0), a, np.inf)),
    ),
)


def behaviour(student):
    """A drop half way, one that is too high, one below."""
    one = np.ones(3)
    fractions = student(np.array([1.0, 5.0, -1.0]), np.array([-1.0, 3.0, -3.0]), 0 * one, 0 * one)
    require(
        abs(fractions[0] - 0.5) < 1e-4,
        "a drop that falls from 1 m above to 1 m below a still surface meets it half way",
    )
    require(np.isinf(fractions[1]), "a drop that stays above does not meet the surface")
    require(np.isinf(fractions[2]), "a drop that is below already does not meet the surface")
