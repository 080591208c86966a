"""The static state of a mooring: Newton's method on the lines as they are discretised, bed and slack links included.

The forces are those of the kernels at zero speed, current's drag among them. Without current they are the gradient of
a convex energy, so that one state is found from any start. `sim.mooring.balance` holds the corrections; the search
begins with few segments and a shape that a line can have; where that fails, with softer lines.
"""

import dataclasses
import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.mooring.balance import HOLD, MAX_CORRECTIONS, REFINED_HOLD, Balance, balanced
from sim.mooring.catenary import catenary
from sim.mooring.tangent import links_at, six_of
from sim.springs.lines.arrays import LineArrays
from sim.validation import ConvergenceError

if TYPE_CHECKING:
    from sim.mooring.system import Line, System

Shape = tuple[NDArray[np.float64], NDArray[np.float64]]  # nodes (segments + 1, 3) [m], tensions (segments,) [N]
FEWEST = 6  # segments of a line, from which a state with a quarter of them is sought first
SOFTNESS = (
    0.0,
    0.1,
    0.3,
    1.0,
)  # of the lines, the bed and the surface to begin with, one after the other, see `Balance`


class Rest(NamedTuple):
    """A static state."""

    x: dict[int, NDArray[np.float64]]  # by line: (segments + 1, 3) [m]
    tension: dict[int, NDArray[np.float64]]  # by line: (segments,) [N], from its start to its end
    bodies: dict[int, NDArray[np.float64]]  # by body: (6,) [m, rad] from its place
    nodes: NDArray[np.float64]  # (3, n) of all nodes and bodies, as kernels have them


def hanging_shape(
    line: "Line", low: NDArray[np.float64], high: NDArray[np.float64], bed: float, weight: float
) -> Shape:
    """The catenary from `low` to `high`; raises ValueError where there is none. weight: in water [N/m], above 0."""
    across = high - low
    span = math.hypot(across[0], across[1])
    on_bed = low[2] <= bed + 1e-6 * line.length
    found = catenary(line.length, line.type.stiffness, weight, span, float(across[2]), on_bed=on_bed)
    s = np.linspace(0.0, line.length, line.segments + 1)
    along, height = found.shape(s)
    away = np.array([across[0] / span, across[1] / span, 0.0])
    x = low + along[:, None] * away + height[:, None] * (0.0, 0.0, 1.0)
    return x, found.tension(0.5 * (s[1:] + s[:-1]))


def slack_shape(line: "Line", low: NDArray[np.float64], high: NDArray[np.float64], bed: float, weight: float) -> Shape:
    """A line that reaches the bed below both of its ends: it hangs straight, and what is left lies on the bed.

    A line that cannot is straight or, longer than its chord, goes straight to a point below its middle and up again.
    """
    s = np.linspace(0.0, line.length, line.segments + 1)
    fall, rise = max(float(low[2]) - bed, 0.0), max(float(high[2]) - bed, 0.0)
    if fall + rise < line.length:
        level = np.clip((s - fall) / (line.length - fall - rise), 0.0, 1.0)
        x = low + level[:, None] * (high - low)
        hung = np.maximum(fall - s, 0.0) + np.maximum(s - (line.length - rise), 0.0)
        x[:, 2] = min(float(low[2]), bed) + hung
    else:
        chord = high - low
        sag = 0.5 * math.sqrt(max(line.length**2 - float(chord @ chord), 0.0))
        share = s[:, None] / line.length
        x = low + share * chord - np.minimum(share, 1.0 - share) * (0.0, 0.0, 2.0 * sag)
    # What is stretched carries the weight below it.
    lengths = np.linalg.norm(np.diff(x, axis=0), axis=1)
    below = 0.5 * (x[1:, 2] + x[:-1, 2]) - x[:, 2].min()
    return x, np.where(lengths >= (1.0 - 1e-6) * line.length / line.segments, weight * below, 0.0)


def first_shape(line: "Line", start: NDArray[np.float64], end: NDArray[np.float64], system: "System") -> Shape:
    """Nodes and tensions to start from. A line that floats hangs upside down, and the surface is its bed."""
    weight = (line.type.mass - system.density * line.type.volume) * system.gravity
    bed = -system.depth if system.bed_stiffness > 0.0 else -math.inf
    mirror = np.array([1.0, 1.0, -1.0 if weight < 0.0 else 1.0])
    if weight < 0.0:
        bed = 0.0
    ends = start * mirror, end * mirror
    is_up = ends[1][2] >= ends[0][2]
    low, high = ends if is_up else ends[::-1]
    try:
        x, tension = hanging_shape(line, low, high, bed if weight > 0.0 else -math.inf, abs(weight))
    except ValueError:
        x, tension = slack_shape(line, low, high, bed, abs(weight))
    x = x * mirror
    return (x, tension) if is_up else (x[::-1], tension[::-1])


def first_guess(
    system: "System", placed: dict[int, NDArray[np.float64]]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Positions (3, n) [m] and tensions (links,) [N] to start from, with the points in `placed`, by id, there."""
    x = np.zeros((3, system.node_count + 2 * len(system.bodies)))
    tension = np.zeros(sum(line.segments for line in system.lines))
    for i, point in enumerate(system.points):
        x[:, i] = placed.get(point.id, np.asarray(point.position, dtype=np.float64))
    for line in system.lines:
        at = system.nodes_of[line.id]
        shape, tension[system.links_of[line.id]] = first_shape(line, x[:, at[0]], x[:, at[-1]], system)
        x[:, at[1:-1]] = shape[1:-1].T
        x[2, at[1:-1]] = np.clip(x[2, at[1:-1]], -system.depth if system.bed_stiffness > 0.0 else -math.inf, None)
        # What lies is as deep in the bed as it is heavy, and what floats is as deep in the water as it is light.
        weight = (line.type.mass - system.density * line.type.volume) * system.gravity
        if weight > 0.0 < system.bed_stiffness:
            lies = x[2, at[1:-1]] <= -system.depth + 1e-9 * line.length
            x[2, at[1:-1]] -= np.where(lies, weight / (system.bed_stiffness * line.type.diameter), 0.0)
        elif weight < 0.0:
            wet = line.type.mass / (system.density * line.type.volume)
            x[2, at[1:-1]] = np.minimum(x[2, at[1:-1]], (0.5 - wet) * math.pi / 4.0 * line.type.diameter)
    return x, tension


def coarser(system: "System") -> "System | None":
    """The system with a quarter of the segments; None where its lines have few."""
    lines = tuple(
        line._replace(segments=max(4, -(-line.segments // 4)) if line.segments > FEWEST else line.segments)
        for line in system.lines
    )
    return None if lines == system.lines else dataclasses.replace(system, lines=lines)


def refined(system: "System", coarse: "System", found: Balance) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Positions and tensions of the state of a coarser system, between its nodes as they are on its links."""
    x = np.zeros((3, system.node_count + 2 * len(system.bodies)))
    tension = np.zeros(sum(line.segments for line in system.lines))
    points = len(system.points)
    x[:, :points], x[:, system.node_count :] = found.x[:, :points], found.x[:, coarse.node_count :]
    for fine, rough in zip(system.lines, coarse.lines, strict=True):
        new, old = (np.linspace(0.0, 1.0, line.segments + 1) for line in (fine, rough))
        for e in range(3):
            x[e, system.nodes_of[fine.id]] = np.interp(new, old, found.x[e, coarse.nodes_of[rough.id]])
        fresh, known = (0.5 * (at[1:] + at[:-1]) for at in (new, old))
        tension[system.links_of[fine.id]] = np.interp(fresh, known, found.tension[coarse.links_of[rough.id]])
    return x, tension


def sought(system: "System", placed: dict[int, NDArray[np.float64]], softness: float) -> Balance:
    """The state as it is found, or not, by way of coarser lines."""
    coarse = coarser(system)
    if coarse is not None:
        found = sought(coarse, placed, softness)
        if found.is_settled:
            return balanced(system, *refined(system, coarse, found), REFINED_HOLD)
    return balanced(system, *first_guess(system, placed), HOLD, softness)


def at_rest(system: "System", placed: dict[int, NDArray[np.float64]] | None = None) -> Rest:
    """The static state without waves, with points at their own places or at those in `placed`, by id.

    Raises ConvergenceError where no state of rest is found.
    """
    placed = placed or {}
    found = balanced(system, *first_guess(system, placed), HOLD)
    left = found.left
    for softness in SOFTNESS:
        if found.is_settled:
            break
        found = sought(system, placed, softness)
        left = min(left, found.left)
    if not found.is_settled:
        raise ConvergenceError("static state of the mooring", f"{left:.3g} N", MAX_CORRECTIONS)
    return rest_of(system, found.x, system.kernel_view(1.0))


def rest_of(system: "System", x: NDArray[np.float64], p: LineArrays) -> Rest:
    """The named parts of positions (3, n)."""
    tension = links_at(x, p)[1]
    xs = {one: np.ascontiguousarray(x[:, nodes].T) for one, nodes in system.nodes_of.items()}
    tensions = {one: tension[links] for one, links in system.links_of.items()}
    return Rest(xs, tensions, {body.id: six_of(x, p, b) for b, body in enumerate(system.bodies)}, x)
