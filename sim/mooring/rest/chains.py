"""Direct solution of a mooring's linear systems: the time grows linearly with the segments.

The inner nodes of a line are a chain of 3 x 3 blocks, or a band of them if it resists bending, which is eliminated.
What remains is a small dense system of the bodies and the points where lines end. Its matrix is positive definite where
that of the whole mooring is.
"""

import numpy as np
from numpy.typing import NDArray

from sim.mooring.bending import bending_entries
from sim.mooring.parts import MooringParts
from sim.mooring.tangent import carried_coordinates, free_coordinates
from sim.springs.integrators.implicit.block_tridiagonal import solve_block_tridiagonal
from sim.springs.points.line_arrays import STIFFNESS, LineArrays

Array = NDArray[np.float64]


Bending = tuple[Array, Array]  # of a line: (3, inner) bands from the diagonal on, and (inner, 2) beside its ends [N/m]


def bending_of(
    at: NDArray[np.int64], rows: NDArray[np.int64], columns: NDArray[np.int64], values: Array
) -> Bending | None:
    """The bending of the line with nodes `at`; None if it does not resist bending, or has no inner nodes."""
    count = len(at) - 2
    inner = (rows >= at[1]) & (rows <= at[-2]) if count > 0 else np.zeros(len(rows), dtype=bool)
    if not inner.any():
        return None
    rows, columns, values = rows[inner] - at[1], columns[inner], values[inner]
    band, beside = np.zeros((3, count)), np.zeros((count, 2))
    for i, end in enumerate((at[0], at[-1])):
        np.add.at(beside[:, i], rows[columns == end], values[columns == end])
    columns = columns - at[1]
    among = (columns >= 0) & (columns < count) & (columns <= rows)
    np.add.at(band, ((rows - columns)[among], columns[among]), values[among])
    return band, beside


class Chain:
    """The inner nodes of a line that does not resist bending."""

    def __init__(self, nodes: Array, links: Array) -> None:
        """nodes: (inner, 3, 3) block of each. links: (inner + 1, 3, 3) of each link, the first and last to the ends."""
        self.diagonal, self.beside = nodes.reshape(-1, 9), -np.ascontiguousarray(links[1:]).reshape(-1, 9)
        self.first, self.last = links[0], links[-1]
        moves = np.zeros((6, len(nodes), 3))
        for e in range(3):
            moves[e, 0], moves[3 + e, -1] = links[0, :, e], links[-1, :, e]
        # (inner, 3, 6) how the nodes follow unit moves of both ends
        self.moves = np.moveaxis(np.array([self.solve(move) for move in moves]), 0, -1)

    def solve(self, force: Array) -> Array:
        """Displacements (inner, 3) by forces on the nodes, with the ends held."""
        displacements = force.copy()
        solve_block_tridiagonal(self.diagonal, self.beside.copy(), displacements)
        return displacements

    def onto_ends(self, u: Array) -> Array:
        """Forces (2, 3, n) on the ends by displacements (inner, 3, n) of the nodes."""
        return np.stack((self.first @ u[0], self.last @ u[-1]))


class Band:
    """The inner nodes of a line that resists bending: each is coupled with two on either side.

    Two nodes make a block of 6, which is coupled with its neighbours only.
    """

    def __init__(self, nodes: Array, links: Array, band: Array, beside: Array) -> None:
        """nodes, links: as of `Chain`. band, beside: `bending_of` the line."""
        self.count, pairs = len(nodes), (len(nodes) + 1) // 2
        # Each node's block, those with the next and with the next but one, and a node without a coupling at the end.
        own, following, second = (np.zeros((2 * pairs + 2, 3, 3)) for _ in range(3))
        own[:] = np.eye(3)
        own[: self.count] = nodes + band[0][:, None, None] * np.eye(3)
        following[: self.count - 1] = -links[1:-1] + band[1, : self.count - 1, None, None] * np.eye(3)
        second[: self.count - 1] = band[2, : self.count - 1, None, None] * np.eye(3)
        first, other = slice(0, 2 * pairs, 2), slice(1, 2 * pairs, 2)
        diagonal = np.block([[own[first], following[first]], [following[first].swapaxes(1, 2), own[other]]])
        self.next = np.block([[second[first], np.zeros((pairs, 3, 3))], [following[other], second[other]]])
        self.inverse = np.empty_like(diagonal)
        self.inverse[0] = np.linalg.inv(diagonal[0])
        for k in range(1, pairs):
            before = self.next[k - 1]
            self.inverse[k] = np.linalg.inv(diagonal[k] - before.T @ self.inverse[k - 1] @ before)
        self.coupling = np.zeros((self.count, 3, 2, 3))
        self.coupling[0, :, 0], self.coupling[-1, :, 1] = -links[0], -links[-1]
        for e in range(3):
            self.coupling[:, e, :, e] += beside
        self.moves = self.solved(-self.coupling.reshape(self.count, 3, 6))  # as of `Chain`

    def solved(self, force: Array) -> Array:
        """Displacements (inner, 3, n) by forces on the nodes, with the ends held."""
        pairs, columns = len(self.inverse), force.shape[2]
        u = np.zeros((2 * pairs, 3, columns))
        u[: self.count] = force
        u = u.reshape(pairs, 6, columns)
        for k in range(1, pairs):
            u[k] -= self.next[k - 1].T @ (self.inverse[k - 1] @ u[k - 1])
        u[-1] = self.inverse[-1] @ u[-1]
        for k in range(pairs - 2, -1, -1):
            u[k] = self.inverse[k] @ (u[k] - self.next[k] @ u[k + 1])
        return u.reshape(2 * pairs, 3, columns)[: self.count]

    def solve(self, force: Array) -> Array:
        """Displacements (inner, 3) by forces on the nodes, with the ends held."""
        return self.solved(force[..., None])[..., 0]

    def onto_ends(self, u: Array) -> Array:
        """Forces (2, 3, n) on the ends by displacements (inner, 3, n) of the nodes."""
        return -np.einsum("iepd,ien->pdn", self.coupling, u)


class Chains:
    """The chains of a system, and how its points move by the coordinates that are left."""

    def __init__(self, system: MooringParts, p: LineArrays) -> None:
        self.p, self.points = p, len(system.points)
        self.lines = [(system.nodes_of[line.id], system.links_of[line.id]) for line in system.lines]
        rows, columns, values = bending_entries(p)
        of_points = (rows < self.points) & (columns < self.points)
        self.beside = np.zeros((self.points, self.points))  # bending stiffness between points
        np.add.at(self.beside, (rows[of_points], columns[of_points]), values[of_points])
        self.bends = [bending_of(at, rows, columns, values) for at, _ in self.lines]
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
        """links: (links, 3, 3) block H of each, which stands for [H -H; -H H]. nodes: (nodes, 3, 3) added to
        each node's block.
        """
        self.chains, p, m = chains, chains.p, chains.points
        blocks = nodes.copy()
        np.add.at(blocks, p.ends[:, 0], links)
        np.add.at(blocks, p.ends[:, 1], links)
        left = np.zeros((m, 3, m, 3))  # of the points
        left[np.arange(m), :, np.arange(m)] = blocks[:m]
        for e in range(3):
            left[:, e, :, e] += chains.beside
        self.parts: list[Chain | Band | None] = []
        for (at, of), bends in zip(chains.lines, chains.bends, strict=True):
            a, b, chain = int(at[0]), int(at[-1]), links[of]
            if len(at) == 2:
                left[a, :, b] -= chain[0]
                left[b, :, a] -= chain[0]
                self.parts.append(None)
                continue
            part = Chain(blocks[at[1:-1]], chain) if bends is None else Band(blocks[at[1:-1]], chain, *bends)
            self.parts.append(part)
            pulls = part.onto_ends(part.moves)
            for i, end in enumerate((a, b)):
                left[end, :, a] -= pulls[i, :, :3]
                left[end, :, b] -= pulls[i, :, 3:]
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
                middle = part.solve(inner[at[1:-1] - m])
                right[at[[0, -1]]] += part.onto_ends(middle[..., None])[..., 0]
                inner[at[1:-1] - m] = middle
        pull = self.motion.T @ right.reshape(-1) + np.concatenate((own, six))
        solution: Array = np.linalg.solve(self.matrix, pull).astype(np.float64, copy=False) if len(pull) else pull
        ends = (self.motion @ solution).reshape(m, 3)
        for (at, _), part in zip(chains.lines, self.parts, strict=True):
            if part is not None:
                inner[at[1:-1] - m] += part.moves @ np.concatenate((ends[at[0]], ends[at[-1]]))
        return np.concatenate(
            (np.concatenate((solution[: chains.count], inner.reshape(-1)))[chains.order], solution[chains.count :])
        )
