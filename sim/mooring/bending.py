"""The bends of a mooring's lines: the kernels' rows, and their constant matrix."""

import numpy as np
from numpy.typing import NDArray

from sim.mooring.parts import MooringParts
from sim.springs.forces.under_water.bending import BEND_STIFFNESS, LINKS, NODES, OFFSET, WEIGHTS
from sim.springs.points.line_arrays import LineArrays

Array = NDArray[np.float64]


def bends_of(system: MooringParts) -> Array:
    """`bends` of the kernels' view: one of each inner node of a line that resists bending, and of each clamp."""
    rows: list[Array] = []
    for line in system.lines:
        nodes, count, first = system.nodes_of[line.id], line.segments, system.links_of[line.id].start
        length = line.length / count
        stiffness = line.type.bending / length**3
        if stiffness == 0.0:
            continue
        inner = np.zeros((count - 1, LINKS + 2))
        inner[:, NODES:WEIGHTS] = np.stack((nodes[:-2], nodes[1:-1], nodes[2:]), axis=1)
        inner[:, WEIGHTS:BEND_STIFFNESS] = 1.0, -2.0, 1.0
        inner[:, BEND_STIFFNESS] = stiffness
        inner[:, LINKS], inner[:, LINKS + 1] = first + np.arange(count - 1), first + np.arange(1, count)
        rows.append(inner)
        for direction, a, b in ((line.clamp_at_start, 0, 1), (line.clamp_at_end, count - 1, count)):
            if direction is not None:
                away = length * np.divide(direction, np.linalg.norm(direction))
                ends, link = (nodes[a], nodes[b], nodes[b]), first + a
                rows.append(np.array([[*ends, -1.0, 1.0, 0.0, 2.0 * stiffness, *-away, -1.0, link]]))
    return np.concatenate(rows) if rows else np.zeros((0, LINKS + 2))


def bending_entries(p: LineArrays) -> tuple[NDArray[np.int64], NDArray[np.int64], Array]:
    """Rows, columns and values [N/m] of the matrix between nodes that all three directions have."""
    nodes, weights = p.bends[:, NODES:WEIGHTS].astype(np.int64), p.bends[:, WEIGHTS:BEND_STIFFNESS]
    values = p.bends[:, BEND_STIFFNESS, None, None] * weights[:, :, None] * weights[:, None]
    rows = np.broadcast_to(nodes[:, :, None], values.shape)
    columns = np.broadcast_to(nodes[:, None], values.shape)
    return rows.reshape(-1), columns.reshape(-1), values.reshape(-1)


def bending_forces(x: Array, p: LineArrays) -> Array:
    """Forces (nodes, 3) [N] of all bends at positions x (3, n)."""
    forces = np.zeros((p.nodes, 3))
    nodes, weights = p.bends[:, NODES:WEIGHTS].astype(np.int64), p.bends[:, WEIGHTS:BEND_STIFFNESS]
    d = np.einsum("ie,die->id", weights, x[:, nodes]) + p.bends[:, OFFSET:LINKS]
    pull = -p.bends[:, BEND_STIFFNESS, None] * d
    for e in range(3):
        np.add.at(forces, nodes[:, e], weights[:, e, None] * pull)
    return forces
