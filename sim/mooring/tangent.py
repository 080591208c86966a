"""The free coordinates of a mooring, and the forces on them."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel
from sim.springs.forces import Absent
from sim.springs.forces.links import set_tensions
from sim.springs.forces.matrices import STIFFNESS
from sim.springs.integrators.implicit.tangent import add_tangents
from sim.springs.laws import TAUT
from sim.springs.points.line_arrays import STIFFNESS as OF_BODY
from sim.springs.points.line_arrays import LineArrays

Array = NDArray[np.float64]


def motion_of(arm: Sequence[float]) -> NDArray[np.float64]:
    """The motion (3, 6) of a place at `arm` [m] by its body's: r + theta x arm."""
    x, y, z = arm
    return np.array(((1, 0, 0, 0, z, -y), (0, 1, 0, -z, 0, x), (0, 0, 1, y, -x, 0)), dtype=np.float64)


def free_coordinates(p: LineArrays) -> NDArray[np.int64]:
    """Coordinates of the free nodes among (3 nodes,)."""
    free = np.flatnonzero(p.inverse_masses[: p.nodes] > 0.0)
    return np.concatenate([e * p.nodes + free for e in range(3)])


def carried_coordinates(p: LineArrays) -> tuple[NDArray[np.int64], Array]:
    """Coordinates (m,) of the nodes that bodies carry among (3 nodes,), and how they move (m, 6 bodies) by them."""
    at = np.concatenate([e * p.nodes + p.carried[:, 0] for e in range(3)])
    moves = np.zeros((3, len(p.carried), 6 * len(p.bodies)))
    for i, (arm, body) in enumerate(zip(p.arms, p.carried[:, 1], strict=True)):
        moves[:, i, 6 * int(body) : 6 * int(body) + 6] = motion_of(arm)
    return at, moves.reshape(3 * len(p.carried), 6 * len(p.bodies))


def links_at(x: Array, p: LineArrays) -> tuple[Array, Array]:
    """Length [m] and tension [N] of every link at x (3, n)."""
    flat, tension = np.ascontiguousarray(x).reshape(-1), np.empty(len(p.ends))
    set_tensions(flat, np.zeros_like(flat), p, tension)
    return np.linalg.norm(x[:, p.ends[:, 1]] - x[:, p.ends[:, 0]], axis=0), tension


@kernel
def set_tangents(x, units, p, part, out):
    """Set `part` of the tangent of all forces about x (3 n,) times each row of `units` (m, 3 n), as kernels have it."""
    for i in range(units.shape[0]):
        for j in range(x.shape[0]):
            out[i, j] = 0.0
        add_tangents(x, units[i], 0.0, p, part, TAUT, out[i])


def others(p: LineArrays) -> LineArrays:
    """The mooring with the drag of a current and declared forces only; the statics adds the others itself."""
    none, no_bends = p.links * [1.0, 0.0, 0.0, 0.0, 0.0], p.bends[:0]
    return p._replace(
        links=none, bends=no_bends, loads=0.0 * p.loads, bed_stiffness=0.0, bed_damping=0.0, friction=0.0, gz=0.0
    )


def is_declared(p: LineArrays) -> bool:
    """True if a force of `System.forces` acts."""
    return not all(isinstance(one, Absent) for one in p.forces)


def declared_stiffness(x: Array, p: LineArrays) -> Array:
    """Stiffness (nodes, 3, 3) [N/m] of the declared forces at each node about x (3, n)."""
    if not is_declared(p):
        return np.zeros((p.nodes, 3, 3))
    units = np.zeros((3, 3, p.cols))
    units[np.arange(3), np.arange(3), : p.nodes] = 1.0
    tangents = np.empty_like(units)
    set_tangents(
        np.ascontiguousarray(x).reshape(-1), units.reshape(3, -1), others(p), STIFFNESS, tangents.reshape(3, -1)
    )
    return np.ascontiguousarray(tangents[:, :, : p.nodes].T)


def moves_on_free(forces: Array, p: LineArrays) -> Array:
    """Forces (3, nodes) on all nodes in free coordinates."""
    flat = forces.reshape(-1)
    carried, moves = carried_coordinates(p)
    return np.concatenate((flat[free_coordinates(p)], moves.T @ flat[carried]))


def forces_on_free(forces: Array, x: Array, p: LineArrays) -> Array:
    """Forces (3, nodes) on all nodes in free coordinates, with the bodies' own stiffness and steady forces."""
    free_forces = moves_on_free(forces, p)
    six = free_forces[len(free_forces) - 6 * len(p.bodies) :]
    for b, row in enumerate(p.bodies):
        six[6 * b : 6 * b + 6] += p.steady[b] - row[OF_BODY : OF_BODY + 36].reshape(6, 6) @ six_of(x, p, b)
    return free_forces


def moved(x: Array, step: Array, p: LineArrays) -> Array:
    """Positions x (3, n) after a step of the free coordinates."""
    free = free_coordinates(p)
    carried, moves = carried_coordinates(p)
    nodes, six = x[:, : p.nodes].reshape(-1).copy(), step[len(free) :]
    nodes[free] += step[: len(free)]
    nodes[carried] += moves @ six
    bodies = x[:, p.nodes :] + six.reshape(-1, 3).T
    return np.concatenate((nodes.reshape(3, -1), bodies), axis=1)


def six_of(x: Array, p: LineArrays, body: int) -> Array:
    """Displacement and rotation (6,) of a body, by its place in the row of bodies."""
    return np.concatenate((x[:, p.nodes + 2 * body], x[:, p.nodes + 2 * body + 1]))
