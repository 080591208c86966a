"""The static state of a mooring: Newton's method on the lines as they are discretised, bed and slack links included.

The forces are those of the kernels at zero speed, current's drag among them; the matrix is that of links, bed and
bodies. Without current they are the gradient of a convex energy, so that one state is found from any start.
"""

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.mooring.catenary import catenary
from sim.mooring.tangent import forces_on_free, links_at, links_matrix, moved, six_of, stiffness_matrix, with_bodies
from sim.springs.lines.arrays import STIFFNESS, LineArrays
from sim.springs.lines.forces import set_rest_forces
from sim.validation import argument_error

if TYPE_CHECKING:
    from sim.mooring.system import Line, System

MOST = 400  # corrections
SETTLED = 1e-9  # largest force left [N] over the largest on any node


class Rest(NamedTuple):
    """A static state."""

    x: dict[int, NDArray[np.float64]]  # by line: (segments + 1, 3) [m]
    tension: dict[int, NDArray[np.float64]]  # by line: (segments,) [N], from its start to its end
    bodies: dict[int, NDArray[np.float64]]  # by body: (6,) [m, rad] from its place
    nodes: NDArray[np.float64]  # (3, n) of all nodes and bodies, as kernels have them


def hanging_shape(
    line: "Line", low: NDArray[np.float64], high: NDArray[np.float64], bed: float, weight: float
) -> NDArray[np.float64]:
    """Nodes (segments + 1, 3) of the catenary from `low` to `high`; raises ValueError where there is none.

    weight: in water [N/m]. A line that floats is one that hangs from its lower end, upside down.
    """
    if weight < 0.0:
        mirror = np.array([1.0, 1.0, -1.0])
        return hanging_shape(line, high * mirror, low * mirror, -math.inf, -weight)[::-1] * mirror
    across = high - low
    span = math.hypot(across[0], across[1])
    on_bed = low[2] <= bed + 1e-6 * line.length
    found = catenary(line.length, line.type.stiffness, weight, span, float(across[2]), on_bed=on_bed)
    along, height = found.shape(np.linspace(0.0, line.length, line.segments + 1))
    away = np.array([across[0] / span, across[1] / span, 0.0])
    return low + along[:, None] * away + height[:, None] * (0.0, 0.0, 1.0)


def straight_shape(line: "Line", start: NDArray[np.float64], end: NDArray[np.float64]) -> NDArray[np.float64]:
    """Nodes (segments + 1, 3) on the straight line or, of a longer line, on two that meet below its middle."""
    chord = end - start
    distance = float(np.linalg.norm(chord))
    along = np.linspace(0.0, 1.0, line.segments + 1)[:, None]
    sag = 0.5 * math.sqrt(max(line.length**2 - distance**2, 0.0))
    return start + along * chord - np.minimum(along, 1.0 - along) * (0.0, 0.0, 2.0 * sag)


def first_shape(
    line: "Line", start: NDArray[np.float64], end: NDArray[np.float64], bed: float, weight: float
) -> NDArray[np.float64]:
    """Nodes (segments + 1, 3) to start from: of the catenary where there is one, else of straight lines."""
    is_up = end[2] >= start[2]
    low, high = (start, end) if is_up else (end, start)
    try:
        found = hanging_shape(line, low, high, bed, weight)
        return found if is_up else found[::-1]
    except ValueError:
        return straight_shape(line, start, end)


def first_guess(system: "System", placed: dict[int, NDArray[np.float64]]) -> NDArray[np.float64]:
    """Positions (3, n) to start from, with points at their own places or at those in `placed`, by id."""
    x = np.zeros((3, system.node_count + 2 * len(system.bodies)))
    for i, point in enumerate(system.points):
        x[:, i] = placed.get(point.id, np.asarray(point.position, dtype=np.float64))
    for line in system.lines:
        at = system.nodes_of[line.id]
        weight = (line.type.mass - system.density * line.type.volume) * system.gravity
        bed = -system.depth if system.bed_stiffness > 0.0 else -math.inf
        x[:, at[1:-1]] = first_shape(line, x[:, at[0]], x[:, at[-1]], bed, weight)[1:-1].T
        # What lies is as deep in the bed as it is heavy.
        depth = max(weight, 0.0) / max(system.bed_stiffness * line.type.diameter, 1e-300)
        x[2, at[1:-1]] = np.maximum(x[2, at[1:-1]], bed - depth)
        x[2, at[1:-1]] -= np.where(x[2, at[1:-1]] <= bed + 1e-9 * line.length, depth, 0.0)
    return x


def pull(x: NDArray[np.float64], p: LineArrays) -> tuple[NDArray[np.float64], float]:
    """Forces [N] on the free coordinates at rest, and the largest on any node."""
    f = np.zeros(9 * p.cols)
    set_rest_forces(np.ascontiguousarray(x).reshape(-1), p, f)
    forces = f[: 3 * p.cols].reshape(3, p.cols)[:, : p.nodes]
    return forces_on_free(forces, x, p), float(np.abs(forces).max())


def at_rest(system: "System", placed: dict[int, NDArray[np.float64]] | None = None) -> Rest:
    """The static state without waves, with points at their own places or at those in `placed`, by id.

    Raises ValueError where no state of rest is found.
    """
    p = system.kernel_view(1.0)._replace(waves=np.zeros((9, 0)))
    x = first_guess(system, placed or {})
    force, scale = pull(x, p)
    # What nothing is stiff against, such as slack links, is held by a share of taut links' stiffness, less and less.
    share_of_taut, tension = 1.0, np.full(len(p.links), scale)
    for _ in range(MOST):
        if np.abs(force).max(initial=0.0) <= SETTLED * max(scale, 1.0):
            return rest_of(system, x, p)
        taut = with_bodies(links_matrix(x, p, p.links[:, 1], tension / p.links[:, 0]), p, STIFFNESS)
        step = np.linalg.solve(stiffness_matrix(x, p) + share_of_taut * taut, force).astype(np.float64, copy=False)
        share, slope = 1.0, float(force @ step)
        while True:
            new = moved(x, share * step, p)
            new_force, scale = pull(new, p)
            # The forces do not pull back by more than half as much: the step was not much too long.
            if float(new_force @ step) >= -0.5 * slope or share < 1e-6:
                break
            share *= 0.5
        share_of_taut = max(share_of_taut * (4.0 if share < 0.5 else 0.25 if share == 1.0 else 1.0), 1e-12)
        x, force = new, new_force
    raise argument_error("system", f"{np.abs(force).max():.3g} N left", "one with a state of rest")


def rest_of(system: "System", x: NDArray[np.float64], p: LineArrays) -> Rest:
    """The named parts of positions (3, n)."""
    tension = links_at(x, p)[1]
    xs = {one: np.ascontiguousarray(x[:, nodes].T) for one, nodes in system.nodes_of.items()}
    tensions = {one: tension[links] for one, links in system.links_of.items()}
    return Rest(xs, tensions, {body.id: six_of(x, p, b) for b, body in enumerate(system.bodies)}, x)
