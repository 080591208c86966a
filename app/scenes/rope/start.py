"""Shapes in which a rope begins, and where its root is then."""

import numpy as np
from numpy.typing import NDArray

from app.messages import Vector
from app.scenes.rope.parameters import RopeParams
from app.scenes.springs.rope_parameters import ROOT, ROPE_RADIUS, SPHERE

BELOW = 0.4  # [m] of rope between the root and the height of the sphere's centre, where the rope lies over it
KNOT_PART = 0.55  # of the rope's length that a knot begins with, in its middle
KNOT_CUT = 0.3  # [rad] of the knot's curve to both sides of the place at which it is cut
WAVE = 0.2  # radii of the rope that a hanging one begins beside its line, so that it does not fall on itself exactly


def root_home(params: RopeParams) -> Vector:
    """Place [m] of the root of a new scene."""
    if params.start == "over":
        x, y, z = SPHERE
        return x + params.sphere_radius + ROPE_RADIUS, y, z - BELOW
    return ROOT


def start_points(params: RopeParams, root: Vector) -> NDArray[np.float64]:
    """(n, 3) points [m] at the start of a rope from `root` [m]."""
    curve = {"level": level_curve, "hanging": hanging_curve, "over": curve_over_sphere, "knot": knotted_curve}
    return np.array(root) + spaced(curve[params.start](params), params.points, params.length)


def spaced(polygon: NDArray[np.float64], points: int, length: float) -> NDArray[np.float64]:
    """(points, 3) at equal distances along a fine polygon (m, 3), from its first point over `length` [m]."""
    along = np.concatenate([[0.0], np.linalg.norm(np.diff(polygon, axis=0), axis=1).cumsum()])
    places = np.linspace(0.0, min(length, along[-1]), points)
    return np.column_stack([np.interp(places, along, axis) for axis in polygon.T])


def level_curve(params: RopeParams) -> NDArray[np.float64]:
    """Along -x, as `rope` makes it."""
    return np.array([(0.0, 0.0, 0.0), (-params.length, 0.0, 0.0)])


def hanging_curve(params: RopeParams) -> NDArray[np.float64]:
    """Straight down, in a slight helix."""
    down = np.linspace(0.0, params.length, 1000)
    side = WAVE * ROPE_RADIUS * np.minimum(1.0, down / params.length)
    return np.column_stack([side * np.cos(20.0 * down), side * np.sin(20.0 * down), -down])


def curve_over_sphere(params: RopeParams) -> NDArray[np.float64]:
    """Up beside the sphere, half a turn over its top, and down on its other side."""
    around = params.sphere_radius + ROPE_RADIUS
    angle = np.linspace(0.0, np.pi, 400)
    turn = np.column_stack([around * (np.cos(angle) - 1.0), 0.0 * angle, BELOW + around * np.sin(angle)])
    return np.vstack([(0.0, 0.0, 0.0), turn, turn[-1] - (0.0, 0.0, params.length)])


def knotted_curve(params: RopeParams) -> NDArray[np.float64]:
    """Along -x with a loose trefoil in the middle: a knot on a torus, cut where it is outermost, its ends straight."""
    t = np.linspace(KNOT_CUT, 2.0 * np.pi - KNOT_CUT, 4000)
    out = 2.0 + np.cos(3.0 * t)
    knot = np.column_stack([-out * np.sin(2.0 * t), np.sin(3.0 * t), out * np.cos(2.0 * t)])
    knot *= KNOT_PART * params.length / np.linalg.norm(np.diff(knot, axis=0), axis=1).sum()
    straight = 0.5 * (1.0 - KNOT_PART) * params.length
    first, last = knot[0] + (straight, 0.0, 0.0), knot[-1] - (straight, 0.0, 0.0)
    return np.vstack([first, knot, last]) - first
