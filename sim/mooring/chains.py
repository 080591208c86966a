"""Direct solution of a mooring's linear systems: the time grows linearly with the segments.

The inner nodes of a line are a chain of 3 x 3 blocks, which is eliminated; a small dense system is left of the points
where lines end and of the bodies. Its matrix is positive definite where that of the whole mooring is.
"""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sim.mooring.tangent import carried_coordinates, free_coordinates
from sim.springs.integrators.implicit.block_tridiagonal import solve_block_tridiagonal
from sim.springs.lines.arrays import STIFFNESS, LineArrays

if TYPE_CHECKING:
    from sim.mooring.system import System

Array = NDArray[np.float64]


class Chains:
    """The chains of a system, and how its points move by the coordinates that are left."""

    def __init__(self, system: "System", p: LineArrays) -> None:
        self.p, self.points = p, len(system.points)
        self.lines = [(system.nodes_of[line.id], system.links_of[line.id]) for line in system.lines]
        free = np.flatnonzero(p.inverse_masses[: self.points] > 0.0)
        self.count = 3 * len(free)
        self.motion = np.zeros((self.points, 3, self.count + 6 * len(p.bodies)))  # of the points by the coordinates
        for i, node in enumerate(free):
            self.motion[node, :, 3 * i : 3 * i + 3] = np.eye(3)
        nodes, moves = carried_coordinates(p)
        self.motion.reshape(3 * self.points, -1)[3 * (nodes % p.nodes) + nodes // p.nodes, self.count :] = moves
        self.order = self.free_order(free)

    def free_order(self, free: NDArray[np.int64]) -> NDArray[np.int64]:
        """Where each free coordinate of `sim.mooring.tangent` is among points' (3 each), inner nodes' and bodies'."""
        inner = np.arange(self.points, self.p.nodes)
        nodes = np.concatenate((free, inner))
        place = {int(3 * node + e): 3 * i + e for i, node in enumerate(nodes) for e in range(3)}
        at = free_coordinates(self.p)
        return np.array([place[3 * int(c % self.p.nodes) + int(c // self.p.nodes)] for c in at], dtype=np.int64)

    def solve(self, links: Array, nodes: Array, force: Array) -> Array:
        """The solution of K u = force in the free coordinates of `sim.mooring.tangent`.

        links: (links, 3, 3) block H of each, which stands for [H -H; -H H]. nodes: (nodes, 3, 3) what is added to each
        node's block. force: in free coordinates.
        """
        p, m = self.p, self.points
        blocks = nodes.copy()
        np.add.at(blocks, p.ends[:, 0], links)
        np.add.at(blocks, p.ends[:, 1], links)
        inner, six = np.zeros(3 * (p.nodes - m) + self.count), force[len(self.order) :]
        inner[self.order] = force[: len(self.order)]
        own, inner = inner[: self.count], inner[self.count :].reshape(-1, 3)
        left, right = np.zeros((m, 3, m, 3)), np.zeros((m, 3))  # of the points
        left[np.arange(m), :, np.arange(m)] = blocks[:m]
        solved = []
        for at, of in self.lines:
            a, b, chain = int(at[0]), int(at[-1]), links[of]
            if len(at) == 2:
                left[a, :, b] -= chain[0]
                left[b, :, a] -= chain[0]
                solved.append(None)
                continue
            middle = at[1:-1]
            sides = np.zeros((7, len(middle), 3))  # the forces, then the pull of unit moves of both ends
            sides[0] = inner[middle - m]
            for e in range(3):
                sides[1 + e, 0], sides[4 + e, -1] = chain[0, :, e], chain[-1, :, e]
            diagonal = np.ascontiguousarray(blocks[middle]).reshape(-1, 9)
            beside = -np.ascontiguousarray(chain[1:]).reshape(-1, 9)
            for side in sides:
                solve_block_tridiagonal(diagonal, beside.copy(), side)
            solved.append(sides)
            # What the ends feel of the chain: H u of its first and its last node.
            for end, H, u in ((a, chain[0], sides[:, 0]), (b, chain[-1], sides[:, -1])):
                right[end] += H @ u[0]
                left[end, :, a] -= H @ u[1:4].T
                left[end, :, b] -= H @ u[4:].T
        motion = self.motion.reshape(3 * m, -1)
        matrix = motion.T @ left.reshape(3 * m, 3 * m) @ motion
        for b, row in enumerate(p.bodies):
            at6 = slice(self.count + 6 * b, self.count + 6 * b + 6)
            matrix[at6, at6] += row[STIFFNESS : STIFFNESS + 36].reshape(6, 6)
        pull = motion.T @ right.reshape(-1) + np.concatenate((own, six))
        found: Array = np.linalg.solve(matrix, pull).astype(np.float64, copy=False) if len(pull) else pull
        moves = (motion @ found).reshape(m, 3)
        for (at, _), sides in zip(self.lines, solved, strict=True):
            if sides is not None:
                ends = np.concatenate((moves[at[0]], moves[at[-1]]))
                inner[at[1:-1] - m] = sides[0] + np.tensordot(ends, sides[1:], 1)
        return np.concatenate(
            (np.concatenate((found[: self.count], inner.reshape(-1)))[self.order], found[self.count :])
        )
