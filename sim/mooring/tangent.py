"""The linearised forces of a mooring: free coordinates, and the stiffness and damping about a state."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sim.mooring.bending import bending_entries
from sim.springs.lines.arrays import BED_AREA, DAMPING, DISPLACED, HEIGHT, STIFFNESS, LineArrays
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


def on_bed(x: Array, p: LineArrays) -> Array:
    """Plan area (nodes,) [m^2] of each node that lies on the bed, else 0."""
    node, found = p.places[:, 0], np.zeros(p.nodes)
    np.add.at(found, node, np.where(x[2, node] <= p.bed, p.parts[:, BED_AREA], 0.0))
    return found


def upright_stiffness(x: Array, p: LineArrays) -> Array:
    """Vertical stiffness (nodes,) [N/m] of each node: the bed's, and that of buoyancy at the surface of still water."""
    node, height = p.places[:, 0], p.parts[:, HEIGHT]
    found = p.bed_stiffness * on_bed(x, p)
    lift = p.gravity * p.parts[:, DISPLACED] / height
    np.add.at(found, node, np.where(np.abs(x[2, node]) < 0.5 * height, lift, 0.0))
    return found


def add_upright(matrix: Array, p: LineArrays, resistance: Array) -> None:
    """Add a vertical resistance (nodes,) to `matrix` (3 nodes, 3 nodes)."""
    upwards = np.arange(2 * p.nodes, 3 * p.nodes)
    matrix[upwards, upwards] += resistance


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
    """The matrix K [N/m] of links, bends, bed, surface and bodies about x (3, n), in free coordinates."""
    length, tension, slope, _ = links_at(x, p)
    found = links_matrix(x, p, slope, tension / length)
    rows, columns, values = bending_entries(p)
    for e in range(3):
        np.add.at(found, (e * p.nodes + rows, e * p.nodes + columns), values)
    add_upright(found, p, upright_stiffness(x, p))
    return with_bodies(found, p, STIFFNESS)


def damping_matrix(x: Array, p: LineArrays) -> Array:
    """The matrix D [N s/m] of links, bed and bodies about x (3, n), in free coordinates; drag is none at rest."""
    found = links_matrix(x, p, links_at(x, p)[3], np.zeros(len(p.links)))
    add_upright(found, p, p.bed_damping * on_bed(x, p))
    return with_bodies(found, p, DAMPING)


def moves_on_free(forces: Array, p: LineArrays) -> Array:
    """Forces (3, nodes) on all nodes in free coordinates."""
    flat = forces.reshape(-1)
    carried, moves = carried_coordinates(p)
    return np.concatenate((flat[free_coordinates(p)], moves.T @ flat[carried]))


def forces_on_free(forces: Array, x: Array, p: LineArrays) -> Array:
    """Forces (3, nodes) on all nodes in free coordinates, with the bodies' own stiffness and steady forces."""
    found = moves_on_free(forces, p)
    six = found[len(found) - 6 * len(p.bodies) :]
    for b, row in enumerate(p.bodies):
        six[6 * b : 6 * b + 6] += p.steady[b] - row[STIFFNESS : STIFFNESS + 36].reshape(6, 6) @ six_of(x, p, b)
    return found


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
