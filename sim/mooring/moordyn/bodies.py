"""Bodies of a MoorDyn file that are free: as Bodies, or as points where nothing can turn them."""

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from sim.mooring.moordyn.rows import FileBody
from sim.mooring.parts import Line, MooredBody, Point
from sim.water import Water

# Of a free body's weight on an arm of 1 m, as stiffness of rotation: statics need one where no line turns it.
HELD = 1e-6
LIGHT = 1e-3  # of the mass of the ends of its lines: that of a free body without its own
SAME_PLACE = 1e-6  # [m]


def arms_of(body: FileBody, points: Iterable[Point]) -> NDArray[np.float64]:
    """Arms (n, 3) [m] of the points that a body carries."""
    return np.array([point.position for point in points if point.body == body.id]).reshape(-1, 3) - body.place


def is_point(body: FileBody, points: Iterable[Point]) -> bool:
    """True for a free body without inertia with all its points in the middle: no force can turn it."""
    arms = arms_of(body, points)
    return body.inertia.max() == 0.0 and not body.centre.any() and bool(len(arms)) and np.abs(arms).max() < SAME_PLACE


def merge(body: FileBody, points: dict[int, Point], lines: dict[int, Line]) -> str:
    """Make a body one free point, to which the lines of its points lead. Returns a line that says so."""
    first, *others = [point for point in points.values() if point.body == body.id]
    mass, volume, drag = (
        sum(getattr(point, name) for point in (first, *others)) for name in ("mass", "volume", "drag_area")
    )
    x, y, z = np.sum([point.force for point in (first, *others)], axis=0).tolist()
    added = float(body.added.mean()) * body.volume + sum(p.added_mass * p.volume for p in (first, *others))
    volume += body.volume
    points[first.id] = first._replace(
        kind="free", body=None, mass=mass + body.mass, volume=volume, drag_area=drag + body.drag_area,
        added_mass=added / volume if volume > 0.0 else 0.0, force=(x, y, z),
    )  # fmt: skip
    for other in others:
        del points[other.id]
    gone = {other.id for other in others}
    for line in list(lines.values()):
        start, end = (first.id if one in gone else one for one in (line.start, line.end))
        lines[line.id] = line._replace(start=start, end=end)
    return f"body {body.id} has no inertia: it is the free point {first.id}"


def least_inertia(body: FileBody, points: Mapping[int, Point], lines: Iterable[Line]) -> tuple[float, float]:
    """The mass [kg] and the inertia [kg m^2] that a free body lacks, (0, 0) if it lacks none.

    A body without its own moves with the masses of the ends of its lines, as in MoorDyn. LIGHT of them is added, so
    that it has an inertia about each axis.
    """
    if body.mass > 0.0 and body.inertia.min() > 0.0:
        return 0.0, 0.0
    own = {one.id for one in points.values() if one.body == body.id}
    ends = [
        line.type.mass * line.length / line.segments for line in lines for one in (line.start, line.end) if one in own
    ]
    mass = LIGHT * max(0.5 * sum(ends) + body.mass + sum(points[one].mass for one in own), 1.0)
    arm = max(float(np.abs(arms_of(body, points.values())).max(initial=0.0)), 1.0)
    return mass, mass * arm**2


def drag_of(body: FileBody) -> Point:
    """The point in the middle of a body on which its drag acts; its ID is below 0."""
    x, y, z = body.place.tolist()
    return Point(-body.id, "body", (x, y, z), drag_area=body.drag_area, body=body.id)


def free_body(body: FileBody, least_mass: float, least_inertia: float, water: Water) -> MooredBody:
    """The Body of a row: weight and the buoyancy of all its volume act at its centre of gravity, as in MoorDyn."""
    arm, turn = body.turn @ body.centre, body.turn
    cross = np.cross(np.eye(3), arm)  # cross @ v = arm x v
    mass = np.zeros((6, 6))
    mass[:3, :3] = body.mass * np.eye(3) + water.density * body.volume * (turn * body.added) @ turn.T
    mass[3:, 3:] = (turn * body.inertia) @ turn.T - body.mass * cross @ cross
    mass += np.diag([least_mass] * 3 + [least_inertia] * 3)
    mass[3:, :3] = body.mass * cross
    mass[:3, 3:] = mass[3:, :3].T
    lift = (water.density * body.volume - body.mass) * water.gravity
    # A sinking body hangs below the middle, a floating one is above it; the other way round only lines turn it.
    upright = max(lift * float(arm[2]), 0.0)
    held = HELD * max(abs(lift), body.mass * water.gravity, 1.0)
    stiffness = np.diag([0.0, 0.0, 0.0, upright + held, upright + held, held])
    moment = np.cross(arm, (0.0, 0.0, lift))
    x, y, z = body.place.tolist()
    return MooredBody(body.id, (x, y, z), mass, stiffness, steady=(0.0, 0.0, lift, *moment.tolist()))
