"""The linearised forces of a mooring: free coordinates, and the stiffness and damping about a state."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sim.springs.lines.arrays import BED_AREA, DAMPING, STIFFNESS, LineArrays
from sim.springs.lines.forces import link_state

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


def links_at(x: Array, p: LineArrays) -> Array:
    """Length [m], tension [N], its derivative [N/m] and the damping [N s/m] of every link (4, links) at x (3, n)."""
    return link_state(np.ascontiguousarray(x).reshape(-1), p).T


def links_matrix(x: Array, p: LineArrays, along: Array, across: Array) -> Array:
    """The matrix (3 nodes, 3 nodes) of links that resist by `along` and `across` (links,) about x (3, n)."""
    m = p.nodes
    found = np.zeros(9 * m * m)
    a, b = p.ends.T
    r = x[:, b] - x[:, a]
    unit = r / np.maximum(np.linalg.norm(r, axis=0), 1e-12)
    for d in range(3):
        for e in range(3):
            block = (along - across) * unit[d] * unit[e] + (across if d == e else 0.0)
            for i, j, sign in ((a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)):
                np.add.at(found, (d * m + i) * 3 * m + e * m + j, sign * block)
    return found.reshape(3 * m, 3 * m)


def add_bed(matrix: Array, x: Array, p: LineArrays, by_area: float) -> None:
    """Add the bed's vertical resistance by the plan area of the nodes on it."""
    node = p.places[:, 0]
    upwards = 2 * p.nodes + node
    np.add.at(matrix, (upwards, upwards), np.where(x[2, node] <= p.bed, p.parts[:, BED_AREA] * by_area, 0.0))


def with_bodies(matrix: Array, p: LineArrays, start: int) -> Array:
    """`matrix` (3 nodes, 3 nodes) in free coordinates, plus the bodies' own from column `start` of their rows."""
    free = free_coordinates(p)
    if not len(p.bodies):
        return matrix[np.ix_(free, free)]
    carried, moves = carried_coordinates(p)
    beside = matrix[np.ix_(free, carried)] @ moves
    own = moves.T @ matrix[np.ix_(carried, carried)] @ moves
    for b, row in enumerate(p.bodies):
        own[6 * b : 6 * b + 6, 6 * b : 6 * b + 6] += row[start : start + 36].reshape(6, 6)
    return np.block([[matrix[np.ix_(free, free)], beside], [beside.T, own]])


def stiffness_matrix(x: Array, p: LineArrays) -> Array:
    """The matrix K [N/m] of links, bed and bodies about x (3, n), in free coordinates; slack links have none."""
    length, tension, slope, _ = links_at(x, p)
    found = links_matrix(x, p, slope, tension / length)
    add_bed(found, x, p, p.bed_stiffness)
    return with_bodies(found, p, STIFFNESS)


def damping_matrix(x: Array, p: LineArrays) -> Array:
    """The matrix D [N s/m] of links, bed and bodies about x (3, n), in free coordinates; drag is none at rest."""
    found = links_matrix(x, p, links_at(x, p)[3], np.zeros(len(p.links)))
    add_bed(found, x, p, p.bed_damping)
    return with_bodies(found, p, DAMPING)


def forces_on_free(forces: Array, x: Array, p: LineArrays) -> Array:
    """Forces (3, nodes) on all nodes in free coordinates, with the bodies' own stiffness and steady forces."""
    flat = forces.reshape(-1)
    carried, moves = carried_coordinates(p)
    six = moves.T @ flat[carried]
    for b, row in enumerate(p.bodies):
        six[6 * b : 6 * b + 6] += p.steady[b] - row[STIFFNESS : STIFFNESS + 36].reshape(6, 6) @ six_of(x, p, b)
    return np.concatenate((flat[free_coordinates(p)], six))


def moved(x: Array, step: Array, p: LineArrays) -> Array:
    """Positions x (3, n) after a step of the free coordinates."""
    free = free_coordinates(p)
    carried, moves = carried_coordinates(p)
    nodes, six = x[:, : p.nodes].reshape(-1).copy(), step[len(free) :]
    nodes[free] += step[: len(free)]
    nodes[carried] += moves @ six
    # Of a body's two points the first is its displacement, the second its rotation.
    bodies = x[:, p.nodes :] + six.reshape(-1, 3).T
    return np.concatenate((nodes.reshape(3, -1), bodies), axis=1)


def six_of(x: Array, p: LineArrays, body: int) -> Array:
    """Displacement and rotation (6,) of a body, by its place in the row of bodies."""
    return np.concatenate((x[:, p.nodes + 2 * body], x[:, p.nodes + 2 * body + 1]))
