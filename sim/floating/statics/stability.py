"""Rest and stability of a loaded hull at any heel, by the exact integrals over its mesh.

A body is stable in a pose of rest if each tilt is righted: both eigenvalues of its restoring matrix, its metacentric
heights about two level axes, are above 0 (Newman 1977, section 6.16). A ball has heights of 0 and rests in any pose; a
body counts as a ball within `NEUTRAL`.
"""

import functools
import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from sim.floating.hulls.closed_mesh import area_vectors
from sim.floating.hulls.hull import Hull
from sim.floating.motion.rotation import heading_angle, product, quaternion_by_vector, rotation_matrix
from sim.floating.statics.equilibrium import Layers, density_steps
from sim.floating.statics.hydrostatics import displaced
from sim.numerics.root import narrowed
from sim.validation import ConvergenceError, argument_error

Quaternion = tuple[float, float, float, float]
UPRIGHT: Quaternion = (1.0, 0.0, 0.0, 0.0)
MAX_TILT = math.radians(60.0)  # of a body at rest
LEVEL = 1e-9  # fraction of the size of a hull: an arm below it counts as 0
NEUTRAL = 1e-3  # fraction of the size of a hull: a GM nearer to 0 counts as 0, as that of a ball of 500 triangles
FIRST_LEAN = 0.05  # [rad] from an unstable rest, where the search for a stable one begins
MAX_TURN = 0.2  # [rad] of one turn of the search for rest
MAX_TURNS = 60  # of that search
ROUND_OFF = 1e-15  # fraction of the height of a hull that counts as 0


class Balance(NamedTuple):
    """A body in a pose in which it weighs as much as the displaced fluids."""

    rotation: Quaternion
    height: float  # [m] of the centre of gravity over the surface
    arm: np.ndarray  # (2,) [m] by which the buoyancy turns the body back about x and about y, less than 0: over
    restoring: np.ndarray  # (2, 2) [m] rise of the arms with each tilt about x, y [rad]; symmetric

    @property
    def least_height(self) -> float:
        """The least metacentric height [m] over all level axes."""
        return float(np.linalg.eigvalsh(self.restoring)[0])

    @property
    def tilt(self) -> float:
        """Angle [rad] of the body's z axis from upright."""
        _, x, y, _ = self.rotation
        return 2.0 * math.asin(min(math.hypot(x, y), 1.0))


class Loaded(NamedTuple):
    """A hull about its centre of gravity, of a mean density [kg/m3], in fluids."""

    hull: Hull
    density: float
    layers: Layers


def arms_of(loaded: Loaded, rest: Balance, angles: np.ndarray, axis: int) -> np.ndarray:
    """Righting arms (n,) [m] at angles (n,) [rad] about the world's x, or y, from rest without its heading."""
    return np.array(
        [balance_at(loaded, product(tilted(angle * np.eye(2)[axis]), rest.rotation)).arm[axis] for angle in angles]
    )


def balance_at(loaded: Loaded, rotation: Quaternion) -> Balance:
    """The balance of a body in a pose.

    The level is the one at which the displaced fluids weigh as much as the body.
    A tilt moves the centre of buoyancy with the body, and by the wedges at the waterplanes, which it turns about their
    common centre of flotation (Newman 1977, section 6.16).
    """
    hull, density, layers = loaded
    steps, weight = density_steps(layers), density * hull.volume
    x = np.ascontiguousarray(rotation_matrix(np.array(rotation)) @ hull.vertices.T)
    faces, vertical = np.ascontiguousarray(hull.faces.T), np.ascontiguousarray(area_vectors(x.T, hull.faces)[:, 2])

    @functools.lru_cache(maxsize=2)  # of the bracket's ends; the search has been at the last one already
    def under(level: float) -> np.ndarray:
        """The integrals (10,) of `add_displaced`, times density, under a surface at this level."""
        return sum((change * displaced(x, faces, vertical, level - top - x[2]) for change, top in steps), np.zeros(10))

    def excess(level: float) -> tuple[float, float]:
        """Mass [kg] of the displaced fluids over the body's, and its derivative [kg/m]."""
        integrals = under(level)
        return float(integrals[0]) - weight, float(integrals[4])

    low, high = float(x[2].min()), float(x[2].max()) + steps[-1][1]
    level = float(narrowed(excess, low, high, ROUND_OFF * (high - low), has_slope=True)[1])
    _, Mx, My, Mz, A, Ax, Ay, Axx, Ayy, Axy = under(level).tolist()
    if A > 0.0:
        Axx, Ayy, Axy = Axx - Ax * Ax / A, Ayy - Ay * Ay / A, Axy - Ax * Ay / A
    restoring = np.array([[Mz + Ayy, -Axy], [-Axy, Mz + Axx]]) / weight
    return Balance(rotation, -level, np.array([0.0 - My, Mx]) / weight, restoring)


def is_stable(hull: Hull, rest: Balance) -> bool:
    """True unless a tilt from rest grows by itself; the one test of stability."""
    return hull.shape.is_round or rest.least_height > -NEUTRAL * float(hull.size.max())


def near_upright(loaded: Loaded) -> Balance | None:
    """The balance next to upright in which no arm turns the body, stable or not; None without one within MAX_TILT."""
    try:
        return settled(loaded, balance_at(loaded, UPRIGHT), lambda heights: heights)
    except ConvergenceError:  # it may not exist
        return None


def rest_of(loaded: Loaded) -> Balance:
    """The body at stable rest: near upright, or after turning over from there.

    Raises ValueError if no such angle is within MAX_TILT, ConvergenceError if the search does not converge.
    """
    start = balance_at(loaded, UPRIGHT)
    balance = near_upright(loaded)
    if balance is not None and is_stable(loaded.hull, balance):
        return balance
    for _ in range(2):  # over an edge, and again over a corner
        rest = settled(loaded, balance_at(loaded, leaning(balance)) if balance else start, np.abs)
        if rest is None:
            break
        if is_stable(loaded.hull, rest):
            return rest
        balance = rest
    allowed = "a body that is stable within 60 degrees of upright: one with a lower center_of_gravity, or a wider one"
    raise argument_error("body", f"GM = {start.least_height:.3g} m", allowed)


def leaning(balance: Balance) -> Quaternion:
    """The pose a little off an unstable balance, in the direction in which it turns over.

    Where it turns over both ways, that is with a positive turn about x, or about y.
    """
    heights, axes = np.linalg.eigh(balance.restoring)
    over = axes[:, heights < heights[0] + 0.01 * abs(heights[0])]
    turns = over @ over.T  # towards the axes over which it turns: of a square body, over any
    turn = turns[:, 0] if turns[0, 0] > 0.01 else turns[:, 1]
    return product(tilted(FIRST_LEAN * turn / np.linalg.norm(turn)), balance.rotation)


def settled(loaded: Loaded, start: Balance, over: Callable[[np.ndarray], np.ndarray]) -> Balance | None:
    """The balance in which no arm turns the body, by Newton's method over the tilts about x and y.

    None without one within MAX_TILT. Raises ConvergenceError if the arms do not vanish.

    over: of the metacentric heights (2,), those that a step divides by. As they are, it leads to the next balance;
    their sizes lead downhill, to a stable one.
    """
    size, balance = float(loaded.hull.size.max()), start
    for turn in range(MAX_TURNS):
        if np.abs(balance.arm).max() < (LEVEL if turn == 0 else 0.01 * LEVEL) * size:
            return balance
        heights, axes = np.linalg.eigh(balance.restoring)
        divided = over(heights)
        divided = np.copysign(np.maximum(np.abs(divided), LEVEL * size), divided)
        step = -axes @ (axes.T @ balance.arm / divided)
        step *= min(1.0, MAX_TURN / float(np.linalg.norm(step)))
        balance = balance_at(loaded, without_heading(product(tilted(step), balance.rotation)))
        if balance.tilt > MAX_TILT:
            return None
    raise ConvergenceError("rest of a floating body", f"arms of {np.abs(balance.arm).max():.3g} m", MAX_TURNS)


def tilted(tilt: np.ndarray) -> Quaternion:
    """The quaternion of a rotation vector (tilt, 0) [rad] about x and y."""
    return quaternion_by_vector((float(tilt[0]), float(tilt[1]), 0.0))


def without_heading(rotation: Quaternion) -> Quaternion:
    """The rotation before a turn about the vertical: one about a level axis alone."""
    w, x, y, z = rotation
    size = math.hypot(w, z)
    return size, (w * x + z * y) / size, (w * y - z * x) / size, 0.0


def with_heading(turn: Quaternion, rotation: Quaternion) -> Quaternion:
    """`turn` after a turn about the vertical by the heading of another rotation."""
    return product(quaternion_by_vector((0.0, 0.0, heading_angle(np.array(rotation)))), turn)
