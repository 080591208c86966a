"""Rest and stability of a loaded hull at any heel, by the exact integrals over its mesh.

    >>> from sim.floating import Body, Hull
    >>> barge = Body(Hull.box(60.0, 16.0, 6.0), mass=2.952e6, center_of_gravity=(0.0, 0.0, 1.0))
    >>> round(metacentric_height(barge), 4)  # KB + BM - KG = 1.5 + 16^2/(12 x 3) - 4
    4.6111
    >>> righting_arm(barge, [0.0, 0.1]).round(4)
    array([0.    , 0.4639])

Heel is about x, and trim stays as it is at rest. Layers stay level.

A body is stable in a pose of rest where each tilt is righted: where both eigenvalues of its restoring matrix, which are
its metacentric heights about two level axes, are above 0 (Newman 1977, section 6.16). A ball has none, and rests in any
pose: within `NEUTRAL` a body counts as one.
"""

import functools
import math
import warnings
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sim.floating.hulls.closed_mesh import area_vectors
from sim.floating.hulls.hull import Hull
from sim.floating.motion.rotation import heading_angle, product, quaternion_by_vector, rotation_matrix
from sim.floating.statics.equilibrium import SEA_WATER, Layers, check_layers, density_steps
from sim.floating.statics.hydrostatics import displaced
from sim.numerics.root import narrowed
from sim.validation import ConvergenceError, argument_error, as_array, is_whole_number

if TYPE_CHECKING:
    from sim.floating.motion.body import Body

Quaternion = tuple[float, float, float, float]
UPRIGHT: Quaternion = (1.0, 0.0, 0.0, 0.0)
MAX_TILT = math.radians(60.0)  # of a body at rest
LEVEL = 1e-9  # share of the size of a hull: an arm below it is none
NEUTRAL = 1e-3  # share of the size of a hull: a GM is none if it is nearer to 0, as that of a ball of 500 triangles
FIRST_LEAN = 0.05  # [rad] from an unstable rest, where the search for a stable one begins
MAX_TURN = 0.2  # [rad] of one turn of the search for rest
MAX_TURNS = 60  # of that search
ROUND_OFF = 1e-15  # share of the height of a hull that is none


class Balance(NamedTuple):
    """A body in a pose in which the displaced fluids weigh as much as it does."""

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


def metacentric_height(body: "Body", layers: Layers = SEA_WATER, axis: int = 0) -> float:
    """GM [m] of the body at rest: transverse, for heel about x, or longitudinal with axis 1.

    The rise of the righting arm per radian. Of one fluid it is KB + I/V - KG (Newman 1977, section 6.16). A body that
    is not stable upright has its GM there, which is negative about one axis at least. Raises ValueError as
    `Body.afloat`, or for another axis.
    """
    if not is_whole_number(axis) or axis not in (0, 1):
        raise argument_error("axis", axis, "0 (heel) or 1 (trim)")
    _, rest = about_rest(body, layers)
    return float(rest.restoring[axis, axis])


def righting_arm(body: "Body", heel: ArrayLike, layers: Layers = SEA_WATER) -> np.ndarray:
    """GZ [m] at angles of heel [rad] from rest, of the same shape: from the centre of gravity to the line of buoyancy.

    Positive where it rights the body. At each angle the weight of the displaced fluids is that of the body. The heel of
    a body that is not stable upright is from there, and a UserWarning gives its GM. Raises ValueError for an angle that
    is not within half a turn, and as `Body.afloat`.
    """
    allowed = "angles from -pi to pi rad"
    angles = as_array("heel", heel, allowed)
    bad = ~(np.abs(angles) <= math.pi)
    if bad.any():
        raise argument_error("heel", float(angles[bad].flat[0]), allowed)
    afloat, rest = about_rest(body, layers)
    if not is_stable(afloat.hull, rest):
        words = f"GM = {rest.least_height:.3g} m: the body is not stable upright, and the heel is from there"
        warnings.warn(words, UserWarning, stacklevel=2)
    return arms_of(afloat, rest, angles.ravel(), 0).reshape(angles.shape)


class Loaded(NamedTuple):
    """A hull about its centre of gravity, of a mean density [kg/m3], in fluids."""

    hull: Hull
    density: float
    layers: Layers


def about_rest(body: "Body", layers: Layers) -> tuple[Loaded, Balance]:
    """The body, and the balance about which it heels: near upright where there is one, else where it is at rest."""
    if not hasattr(body, "loaded"):  # sim/floating/motion/body.py imports this module
        raise argument_error("body", body, "a Body")
    body.draft(layers)
    loaded = Loaded(*body.loaded(), check_layers(layers))
    return loaded, near_upright(loaded) or rest_of(loaded)


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

    @functools.lru_cache(maxsize=2)  # of the bracket's ends, at the last one of which the search has been already
    def under(level: float) -> np.ndarray:
        """The integrals (10,) of `add_displaced`, times density, under a surface at this level."""
        return sum((change * displaced(x, faces, vertical, level - top - x[2]) for change, top in steps), np.zeros(10))

    def excess(level: float) -> tuple[float, float]:
        """Mass [kg] of the displaced fluids over the body's, and its derivative [kg/m]."""
        found = under(level)
        return float(found[0]) - weight, float(found[4])

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
    except ConvergenceError:  # there need not be one
        return None


def rest_of(loaded: Loaded) -> Balance:
    """The body at stable rest: next to upright, or where it comes to rest when it turns over from there.

    Raises ValueError where that is none within MAX_TILT, ConvergenceError where the search does not end.
    """
    start = balance_at(loaded, UPRIGHT)
    found = near_upright(loaded)
    if found is not None and is_stable(loaded.hull, found):
        return found
    for _ in range(2):  # over an edge, and again over a corner
        rest = settled(loaded, balance_at(loaded, leaning(found)) if found else start, np.abs)
        if rest is None:
            break
        if is_stable(loaded.hull, rest):
            return rest
        found = rest
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

    None without one within MAX_TILT. Raises ConvergenceError where the arms do not vanish.

    over: of the metacentric heights (2,), those that a step divides by. As they are, it leads to the next balance;
    their sizes lead downhill, to a stable one.
    """
    size, found = float(loaded.hull.size.max()), start
    for turn in range(MAX_TURNS):
        if np.abs(found.arm).max() < (LEVEL if turn == 0 else 0.01 * LEVEL) * size:
            return found
        heights, axes = np.linalg.eigh(found.restoring)
        divided = over(heights)
        divided = np.copysign(np.maximum(np.abs(divided), LEVEL * size), divided)
        step = -axes @ (axes.T @ found.arm / divided)
        step *= min(1.0, MAX_TURN / float(np.linalg.norm(step)))
        found = balance_at(loaded, without_heading(product(tilted(step), found.rotation)))
        if found.tilt > MAX_TILT:
            return None
    raise ConvergenceError("rest of a floating body", f"arms of {np.abs(found.arm).max():.3g} m", MAX_TURNS)


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
