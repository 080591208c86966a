"""The reference solution and the check of a task."""

import functools
import itertools

import numpy as np

from app.lab.checking import Curve, Mistake, require
from app.lab.diagnosis.differences import Case
from app.lab.diagnosis.terms import Form, Term


def sphere_force(x, v, centre, radius, stiffness, damping):
    """The force [N], shape (3,), of a sphere on a point that has entered it; 0 outside.

    F = max(k p - b (v . n), 0) n, with the depth p = R - |x - c| and the unit normal n = (x - c)/|x - c|.
    The force never pulls: where k p - b (v . n) is negative, it is 0.

    x, v: position [m] and velocity [m/s] of the point, shape (3,). centre: c [m], shape (3,). radius: R [m].
    stiffness: k [N/m]. damping: b [N s/m].
    """
    r = np.asarray(x) - np.asarray(centre)
    distance = np.linalg.norm(r)
    if distance >= radius:
        return np.zeros(3)
    n = r / distance
    return max(stiffness * (radius - distance) - damping * np.dot(v, n), 0.0) * n


def inputs(rng):
    """Points inside and outside; some leave the sphere so fast that damping alone would pull them back."""
    centre, direction, v = rng.normal(size=(3, 3))
    radius = rng.uniform(0.5, 1.5)
    x = centre + direction / np.linalg.norm(direction) * radius * rng.choice([0.3, 0.6, 0.9, 1.3])
    return x, 3.0 * v, centre, radius, rng.uniform(10.0, 30.0), rng.uniform(2.0, 6.0)


# The sphere of the lab's cloth, and a hard one; then points outside, above and below, that come in fast.
EXAMPLES = (
    (np.array([0.1, 0.2, 0.9]), np.array([0.0, 0.5, -2.0]), np.zeros(3), 1.0, 3000.0, 5.0),
    (np.array([0.0, 0.5, 0.0]), np.array([0.0, -3.0, 0.0]), np.zeros(3), 1.0, 1e5, 10.0),
    (np.array([0.0, 0.1, 1.2]), np.array([0.0, 0.0, -20.0]), np.zeros(3), 1.0, 100.0, 10.0),
    (np.array([0.1, 0.0, -1.2]), np.array([0.0, 0.0, 20.0]), np.zeros(3), 1.0, 100.0, 10.0),
)


def only_above_counts_as_outside(x, v, centre, radius, stiffness, damping):
    normal = (x - centre) / np.linalg.norm(x - centre)
    push = stiffness * (radius - np.linalg.norm(x - centre)) - damping * (v @ normal)
    return np.zeros(3) if x[2] > centre[2] + radius else max(push, 0.0) * normal


def variant(push, everywhere=False):
    """A mistake: another push, a function of n, p, r = x - c, v, k and b; inside the sphere only, or everywhere."""

    def function(x, v, centre, radius, stiffness, damping):
        r = x - centre
        distance = np.linalg.norm(r)
        force = push(r / distance, radius - distance, r, v, stiffness, damping)
        return force if everywhere or distance < radius else np.zeros(3)

    return function


MISTAKES = (
    Mistake(
        "only above counts as outside",
        "A point beside the sphere or below it is outside, too: compare the distance from the centre with the radius.",
        only_above_counts_as_outside,
    ),
    Mistake(
        "damping that pulls",
        "A point that leaves fast is pulled back. A contact only pushes: take max(..., 0).",
        variant(lambda n, p, r, v, k, b: (k * p - b * (v @ n)) * n),
    ),
    Mistake(
        "normal not unit length",
        "n is x - c. Divide it by its length.",
        variant(lambda n, p, r, v, k, b: max(k * p - b * (v @ r), 0.0) * r),
    ),
    Mistake(
        "normal not unit length",
        "The force points along x - c, undivided. Divide it by its length.",
        variant(lambda n, p, r, v, k, b: max(k * p - b * (v @ n), 0.0) * r),
    ),
    Mistake(
        "sign reversed",
        "The force points into the sphere. The normal runs from the centre to the point.",
        lambda *arguments: -sphere_force(*arguments),
    ),
    Mistake(
        "force outside the sphere",
        "Points outside are pulled too. Outside the force is 0.",
        variant(lambda n, p, r, v, k, b: (k * p - b * (v @ n)) * n, everywhere=True),
    ),
    Mistake(
        "force outside the sphere",
        "Points outside are pulled too, and there is no damping.",
        variant(lambda n, p, r, v, k, b: k * p * n, everywhere=True),
    ),
    Mistake(
        "damping with the whole velocity",
        "The damping also brakes motion along the surface. Use its normal part v . n only, and never let it pull.",
        variant(lambda n, p, r, v, k, b: k * p * n - b * v),
    ),
    Mistake(
        "distance instead of depth",
        "The force grows with the distance from the centre. It grows with the depth R - |x - c|.",
        variant(lambda n, p, r, v, k, b: max(k * np.linalg.norm(r) - b * (v @ n), 0.0) * n),
    ),
)


def of_part(part):
    """A function of n, p, r = x - c, v, k and b as one of the arguments."""
    return variant(part, everywhere=True)


TERMS = (
    Term(
        "the push", "k (R - |x - c|) n", of_part(lambda n, p, r, v, k, b: k * p * n),
        (
            Form("k |x - c| n", "The depth is R - |x - c|.",
                 of_part(lambda n, p, r, v, k, b: k * np.linalg.norm(r) * n)),
            Form("k p (x - c)", "The normal must have unit length.", of_part(lambda n, p, r, v, k, b: k * p * r)),
            Form("k p² n", "The depth is squared.", of_part(lambda n, p, r, v, k, b: k * p * p * n)),
            Form("k n", "The depth is missing.", of_part(lambda n, p, r, v, k, b: k * n)),
        ),
    ),
    Term(
        "the damping", "-b (v . n) n", of_part(lambda n, p, r, v, k, b: -b * (v @ n) * n),
        (
            Form("-b v", "Only the normal part v . n counts.", of_part(lambda n, p, r, v, k, b: -b * v)),
            Form("-b p v", "Only the normal part v . n counts, not the depth.",
                 of_part(lambda n, p, r, v, k, b: -b * p * v)),
            Form("-b p (v . n) n", "It is multiplied by the depth.",
                 of_part(lambda n, p, r, v, k, b: -b * p * (v @ n) * n)),
            Form("-b |v| n", "Only the normal part v . n counts.",
                 of_part(lambda n, p, r, v, k, b: -b * np.linalg.norm(v) * n)),
            Form("-b |v . n| n", "It never changes its sign.", of_part(lambda n, p, r, v, k, b: -b * abs(v @ n) * n)),
            Form("-b (v . (x - c)) (x - c)", "The normal must have unit length.",
                 of_part(lambda n, p, r, v, k, b: -b * (v @ r) * r)),
        ),
    ),
)  # fmt: skip


def within(form):
    """The whole force from a form of its terms: with and without the two cases in which it must be 0."""

    def function(is_clipped, is_inside, x, v, centre, radius, stiffness, damping):
        r = x - centre
        force = form(x, v, centre, radius, stiffness, damping)
        is_zero = (is_clipped and force @ r <= 0.0) or (is_inside and np.linalg.norm(r) >= radius)
        return np.zeros(3) if is_zero else force

    return tuple(functools.partial(function, *cases) for cases in itertools.product((True, False), repeat=2))


def adds_up(student, *arguments):
    """True where the force is the sum of its terms: the sphere pushes."""
    return np.any(sphere_force(*arguments)) and np.any(student(*arguments))


CASES = (
    Case("outside the sphere", lambda x, v, centre, radius, k, b: np.linalg.norm(x - centre) >= radius),
    Case(
        "where the damping would pull", lambda x, v, centre, radius, k, b: (
            np.linalg.norm(x - centre) < radius and not sphere_force(x, v, centre, radius, k, b).any()
        ),
    ),
)  # fmt: skip
CURVE = Curve(
    "distance from the centre [m]",
    "force outwards [N]",
    np.linspace(0.1, 1.5, 29),
    lambda f, x: [f(np.array([r, 0.0, 0.0]), np.zeros(3), np.zeros(3), 1.0, 10.0, 1.0)[0] for r in x],
)


def behaviour(student):
    """Pushes outwards, and never pulls."""
    centre, out = np.array([1.0, 2.0, 3.0]), np.array([0.0, 0.6, 0.8])
    push = student(centre + 0.5 * out, np.zeros(3), centre, 1.0, 100.0, 5.0)
    require(np.allclose(push, 50.0 * out, rtol=1e-3), "a point at rest half a radius deep must be pushed out by k R/2")
    leaving = student(centre + 0.99 * out, 10.0 * out, centre, 1.0, 100.0, 5.0)
    require(np.abs(leaving).max() < 1e-6, "a point that leaves fast must feel no force")
