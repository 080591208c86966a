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
        """Place of each free coordinate of `sim.mooring.tangent` among points' (3 each), inner nodes' and bodies'."""
        inner = np.arange(self.points, self.p.nodes)
        nodes = np.concatenate((free, inner))
        place = {int(3 * node + e): 3 * i + e for i, node in enumerate(nodes) for e in range(3)}
        at = free_coordinates(self.p)
        return np.array([place[3 * int(c % self.p.nodes) + int(c // self.p.nodes)] for c in at], dtype=np.int64)

    def solve(self, links: Array, nodes: Array, force: Array) -> Array:
        """The solution of K u = force in the free coordinates of `sim.mooring.tangent`; see `Eliminated`."""
        return Eliminated(self, links, nodes).solve(force)


class Eliminated:
    """The matrix K of a system with its chains eliminated, to be solved for several forces."""

    def __init__(self, chains: Chains, links: Array, nodes: Array) -> None:
        """links: (links, 3, 3) block H of each, which stands for [H -H; -H H]. nodes: (nodes, 3, 3) what is added to
        each node's block.
        """
        self.chains, p, m = chains, chains.p, chains.points
        blocks = nodes.copy()
        np.add.at(blocks, p.ends[:, 0], links)
        np.add.at(blocks, p.ends[:, 1], links)
        left = np.zeros((m, 3, m, 3))  # of the points
        left[np.arange(m), :, np.arange(m)] = blocks[:m]
        # Of each line: its blocks, and how its inner nodes follow unit moves of both ends.
        self.parts: list[tuple[Array, Array, Array, Array, Array] | None] = []
        for at, of in chains.lines:
            a, b, chain = int(at[0]), int(at[-1]), links[of]
            if len(at) == 2:
                left[a, :, b] -= chain[0]
                left[b, :, a] -= chain[0]
                self.parts.append(None)
                continue
            moves = np.zeros((6, len(at) - 2, 3))
            for e in range(3):
                moves[e, 0], moves[3 + e, -1] = chain[0, :, e], chain[-1, :, e]
            diagonal = np.ascontiguousarray(blocks[at[1:-1]]).reshape(-1, 9)
            beside = -np.ascontiguousarray(chain[1:]).reshape(-1, 9)
            for move in moves:
                solve_block_tridiagonal(diagonal, beside.copy(), move)
            self.parts.append((diagonal, beside, moves, chain[0], chain[-1]))
            # What the ends feel of the chain: H u of its first and its last node.
            for end, H, u in ((a, chain[0], moves[:, 0]), (b, chain[-1], moves[:, -1])):
                left[end, :, a] -= H @ u[:3].T
                left[end, :, b] -= H @ u[3:].T
        self.motion = chains.motion.reshape(3 * m, -1)
        self.matrix = self.motion.T @ left.reshape(3 * m, 3 * m) @ self.motion
        for b, row in enumerate(p.bodies):
            at6 = slice(chains.count + 6 * b, chains.count + 6 * b + 6)
            self.matrix[at6, at6] += row[STIFFNESS : STIFFNESS + 36].reshape(6, 6)

    def solve(self, force: Array) -> Array:
        """The solution of K u = force in the free coordinates of `sim.mooring.tangent`."""
        chains, m = self.chains, self.chains.points
        inner, six = np.zeros(3 * (chains.p.nodes - m) + chains.count), force[len(chains.order) :]
        inner[chains.order] = force[: len(chains.order)]
        own, inner = inner[: chains.count], inner[chains.count :].reshape(-1, 3)
        right = np.zeros((m, 3))  # of the points
        for (at, _), part in zip(chains.lines, self.parts, strict=True):
            if part is not None:
                diagonal, beside, _, first, last = part
                middle = inner[at[1:-1] - m]
                solve_block_tridiagonal(diagonal, beside.copy(), middle)
                right[at[0]] += first @ middle[0]
                right[at[-1]] += last @ middle[-1]
                inner[at[1:-1] - m] = middle
        pull = self.motion.T @ right.reshape(-1) + np.concatenate((own, six))
        found: Array = np.linalg.solve(self.matrix, pull).astype(np.float64, copy=False) if len(pull) else pull
        ends = (self.motion @ found).reshape(m, 3)
        for (at, _), part in zip(chains.lines, self.parts, strict=True):
            if part is not None:
                inner[at[1:-1] - m] += np.tensordot(np.concatenate((ends[at[0]], ends[at[-1]])), part[2], 1)
        return np.concatenate(
            (np.concatenate((found[: chains.count], inner.reshape(-1)))[chains.order], found[chains.count :])
        )
