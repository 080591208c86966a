"""The reference solution and the check of a task."""

import numpy as np

from app.lab.checking import Curve, Mistake, require


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


def parts(x, v, centre, radius):
    r = x - centre
    distance = np.linalg.norm(r)
    return r / distance, radius - distance, r


def pulling(x, v, centre, radius, k, b):
    n, p, _ = parts(x, v, centre, radius)
    return (k * p - b * (v @ n)) * n if p > 0 else np.zeros(3)


def not_normalised(x, v, centre, radius, k, b):
    _, p, r = parts(x, v, centre, radius)
    return max(k * p - b * (v @ r), 0.0) * r if p > 0 else np.zeros(3)


def normal_only_scaled(x, v, centre, radius, k, b):
    n, p, r = parts(x, v, centre, radius)
    return max(k * p - b * (v @ n), 0.0) * r if p > 0 else np.zeros(3)


def inward(x, v, centre, radius, k, b):
    return -sphere_force(x, v, centre, radius, k, b)


def everywhere(x, v, centre, radius, k, b):
    n, p, _ = parts(x, v, centre, radius)
    return (k * p - b * (v @ n)) * n


def full_velocity(x, v, centre, radius, k, b):
    n, p, _ = parts(x, v, centre, radius)
    return k * p * n - b * v if p > 0 else np.zeros(3)


def no_damping(x, v, centre, radius, k, b):
    return sphere_force(x, v, centre, radius, k, 0.0)


def damping_reversed(x, v, centre, radius, k, b):
    return sphere_force(x, v, centre, radius, k, -b)


def distance_for_depth(x, v, centre, radius, k, b):
    n, p, _ = parts(x, v, centre, radius)
    return max(k * (radius - p) - b * (v @ n), 0.0) * n if p > 0 else np.zeros(3)


def unclipped_undamped(x, v, centre, radius, k, b):
    n, p, _ = parts(x, v, centre, radius)
    return k * p * n


MISTAKES = (
    Mistake(
        "damping that pulls",
        "A point that leaves fast is pulled back. A contact only pushes: take max(..., 0).",
        pulling,
    ),
    Mistake("normal not unit length", "n is x - c. Divide it by its length.", not_normalised),
    Mistake(
        "normal not unit length",
        "The force points along x - c, undivided. Divide it by its length.",
        normal_only_scaled,
    ),
    Mistake("sign reversed", "The force points into the sphere. The normal runs from the centre to the point.", inward),
    Mistake("force outside the sphere", "Points outside are pulled too. Outside the force is 0.", everywhere),
    Mistake("force outside the sphere", "Points outside are pulled too, and there is no damping.", unclipped_undamped),
    Mistake(
        "damping with the whole velocity",
        "The damping also brakes motion along the surface. Use its normal part v . n only, and never let it pull.",
        full_velocity,
    ),
    Mistake("damping forgotten", "There is no damping: subtract b (v . n).", no_damping),
    Mistake("sign of the damping reversed", "The damping drives the point on.", damping_reversed),
    Mistake(
        "distance instead of depth",
        "The force grows with the distance from the centre. It grows with the depth R - |x - c|.",
        distance_for_depth,
    ),
)

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
