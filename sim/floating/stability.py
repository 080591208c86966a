"""Rest and stability of a loaded hull at any heel, by the exact integrals over its mesh.

    >>> from sim.floating import Body, Hull
    >>> barge = Body(Hull.box(60.0, 16.0, 6.0), mass=2.952e6, center_of_gravity=(0.0, 0.0, 1.0))
    >>> round(metacentric_height(barge), 4)  # KB + BM - KG = 1.5 + 16^2/(12 x 3) - 4
    4.6111
    >>> righting_arm(barge, [0.0, 0.1]).round(4)
    array([0.    , 0.4639])

Heel is about x, and trim stays as it is at rest. Layers stay level.
"""

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from sim.floating.equilibrium import SEA_WATER, Layers, check_layers, density_steps
from sim.floating.hull import Hull
from sim.floating.hydrostatics import submerged
from sim.floating.rotation import rotation_matrix
from sim.validation import argument_error, as_array, is_whole_number

if TYPE_CHECKING:
    from sim.floating.body import Body

Quaternion = tuple[float, float, float, float]
MAX_TILT = math.radians(60.0)  # of a body at rest
TILT = 1e-6  # [rad] of the differences
LEVEL = 1e-9  # share of the size of a hull: an arm below it is none
MAX_TURNS = 60  # of the search for rest


def metacentric_height(body: "Body", layers: Layers = SEA_WATER, axis: int = 0) -> float:
    """GM [m] of the body at rest: transverse, for heel about x, or longitudinal with axis 1.

    The rise of the righting arm per radian. Of one fluid it is KB + I/V - KG (Newman 1977, section 6.16), negative
    where the body capsizes. Raises ValueError as `Body.afloat`, or for another axis.
    """
    if not is_whole_number(axis) or axis not in (0, 1):
        raise argument_error("axis", axis, "0 (heel) or 1 (trim)")
    arms = arms_of(body, np.array([-TILT, TILT]), layers, axis)
    return float(arms[1] - arms[0]) / (2.0 * TILT)


def righting_arm(body: "Body", heel: ArrayLike, layers: Layers = SEA_WATER) -> np.ndarray:
    """GZ [m] at angles of heel [rad] from rest, of the same shape: from the centre of gravity to the line of buoyancy.

    Positive where it rights the body. At each angle the weight of the displaced fluids is that of the body. Raises
    ValueError for an angle that is not within half a turn, and as `Body.afloat`.
    """
    allowed = "angles from -pi to pi rad"
    angles = as_array("heel", heel, allowed)
    bad = ~(np.abs(angles) <= math.pi)
    if bad.any():
        raise argument_error("heel", float(angles[bad].flat[0]), allowed)
    return arms_of(body, angles.ravel(), layers, 0).reshape(angles.shape)


def arms_of(body: "Body", angles: np.ndarray, layers: Layers, axis: int) -> np.ndarray:
    """Righting arms (n,) [m] at angles (n,) [rad] about the world's x, or y, from rest without its heading."""
    if not hasattr(body, "loaded"):  # sim/floating/body.py imports this module
        raise argument_error("body", body, "a Body")
    layers = check_layers(layers)
    hull, density = body.loaded()
    rest = body._replace(rotation=(1.0, 0.0, 0.0, 0.0)).afloat(layers).rotation
    found = []
    for angle in angles:
        x, y, _ = displaced_arm(hull, density, layers, product(tilted(angle * np.eye(2)[axis]), rest))
        found.append(0.0 - y if axis == 0 else x)
    return np.array(found)


def displaced_arm(hull: Hull, density: float, layers: Layers, rotation: Quaternion) -> tuple[float, float, float]:
    """x, y [m] of the centre of buoyancy from that of gravity in this pose, and its height over the surface [m].

    The height, by bisection, is the one at which the displaced fluids weigh as much as the body.
    """
    steps, weight = density_steps(layers), density * hull.volume
    heights = (hull.vertices @ rotation_matrix(np.array(rotation)).T)[:, 2]

    def parts(level: float) -> list[tuple[float, np.ndarray]]:
        """Density times volume, and the centre, of each step of the density, under a surface at this level."""
        cuts = [(change, submerged(hull, rotation=rotation, surface=level - top)) for change, top in steps]
        return [(change * cut.volume, cut.centre) for change, cut in cuts if cut.volume > 0.0]

    low, high = float(heights.min()), float(heights.max()) + steps[-1][1]
    while low < (middle := (low + high) / 2.0) < high:
        low, high = (middle, high) if sum(m for m, _ in parts(middle)) < weight else (low, middle)
    moment = sum((m * centre for m, centre in parts(high)), np.zeros(3)) / weight
    return float(moment[0]), float(moment[1]), -high


def rest_of(hull: Hull, density: float, layers: Layers, upright: float) -> tuple[float, Quaternion]:
    """Height [m] of the centre of gravity over the surface, and the rotation without heading, of a body at rest.

    upright [m]: that height where it floats upright, which is the answer if no arm turns it then. Else by Newton's
    method over the tilts about x and y. Raises ValueError where that finds no rest within MAX_TILT.
    """
    tilt, size = np.zeros(2), float(hull.size.max())
    still = (1.0, 0.0, 0.0, 0.0)
    x, y, height = displaced_arm(hull, density, layers, still)
    if max(abs(x), abs(y)) < LEVEL * size:
        return upright, still
    for _ in range(MAX_TURNS):
        change = np.empty((2, 2))
        for i in range(2):
            nudge = TILT * np.eye(2)[i]
            after, before = (displaced_arm(hull, density, layers, tilted(tilt + d))[:2] for d in (nudge, -nudge))
            change[:, i] = (np.array(after) - before) / (2.0 * TILT)
        arm = np.array([x, y])
        if np.abs(arm).max() < 0.01 * LEVEL * size:
            # a turn about x is righted by a buoyancy at lower y, one about y by one at higher x
            if np.linalg.eigvals(np.stack([-change[1], change[0]])).real.min() > 0.0:
                return height, tilted(tilt)
            break
        step = np.linalg.lstsq(change, -arm, rcond=None)[0]
        tilt = tilt + step * min(1.0, 0.2 / max(float(np.abs(step).max()), 1e-30))
        if np.abs(tilt).max() > MAX_TILT:
            break
        x, y, height = displaced_arm(hull, density, layers, tilted(tilt))
    allowed = "one with which the body finds a stable rest within 60 degrees"
    raise argument_error("center_of_gravity", hull.centre.tolist(), allowed)


def tilted(tilt: np.ndarray) -> Quaternion:
    """The quaternion of a rotation vector (tilt, 0) [rad] about x and y."""
    angle = float(np.hypot(*tilt))
    share = math.sin(angle / 2.0) / angle if angle > 0.0 else 0.5
    return math.cos(angle / 2.0), share * float(tilt[0]), share * float(tilt[1]), 0.0


def product(a: Quaternion, b: Quaternion) -> Quaternion:
    """The rotation b followed by a."""
    return (
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    )


def with_heading(turn: Quaternion, rotation: Quaternion) -> Quaternion:
    """`turn` after a turn about the vertical by the heading of another rotation."""
    size = math.hypot(rotation[0], rotation[3])
    if size == 0.0:
        return turn
    return product((rotation[0] / size, 0.0, 0.0, rotation[3] / size), turn)
