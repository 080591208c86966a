"""Lines as rows of equally many pieces, whatever numbers of segments they have."""

from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sim.mooring import System
from sim.mooring.end_forces import LineEnds
from sim.springs.points.line_arrays import LineArrays

Ends: TypeAlias = tuple[NDArray[np.float64], NDArray[np.float64]]


class LineRows(NamedTuple):
    """The drawn points and pieces of all lines, each line from its anchor to its fairlead."""

    before: NDArray[np.int64]  # (lines, n + 1) node before each point, or at it
    after: NDArray[np.int64]  # (lines, n + 1) the next one
    fraction: NDArray[np.float64]  # (lines, n + 1, 1) of the way between them
    links: NDArray[np.int64]  # (lines, n) link of each piece
    lengths: NDArray[np.float64]  # (lines,) [m] unstretched
    held: tuple[tuple[int, int], ...]  # (line, 0 or -1) of each end at the body or vessel
    ends: LineEnds  # the anchors of all lines, then their fairleads

    def end_forces(self, x: NDArray[np.float64], v: NDArray[np.float64], t: float, p: LineArrays) -> Ends:
        """Forces (lines, 3) [N] on the holders of all anchors and of all fairleads, of nodes x, v (3, nodes)."""
        at_anchor, at_fairlead = self.ends.forces(x, v, t, p).reshape(2, -1, 3)
        return at_anchor, at_fairlead

    def points(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Points (lines, n + 1, 3) [m] of nodes x (3, nodes)."""
        nodes = x.T
        return nodes[self.before] + self.fraction * (nodes[self.after] - nodes[self.before])

    def stretch(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Stretch (lines,) of each line, over its length, with nodes x (3, nodes)."""
        spans = np.linalg.norm(np.diff(self.points(x), axis=1), axis=2).sum(axis=1)
        return spans / self.lengths - 1.0

    def largest_strain(self, x: NDArray[np.float64]) -> float:
        """Largest strain of a piece, with nodes x (3, nodes)."""
        pieces = np.linalg.norm(np.diff(self.points(x), axis=1), axis=2)
        return float((pieces / self.lengths[:, None]).max()) * self.links.shape[1] - 1.0

    def lying(self, points: NDArray[np.float64], bed: float) -> NDArray[np.float64]:
        """Unstretched length (lines,) [m] of the pieces with both ends at the height `bed` [m] or below it."""
        down = points[:, :, 2] <= bed
        return (down[:, :-1] & down[:, 1:]).sum(axis=1) * self.lengths / self.links.shape[1]

    def level_force(self, points: NDArray[np.float64], tension: NDArray[np.float64]) -> NDArray[np.float64]:
        """Level force (2,) [N] of all lines on the body or vessel. tension: (lines, n) [N]."""
        force = np.zeros(2)
        for line, end in self.held:
            way = points[line, 1 if end == 0 else -2] - points[line, end]
            force += tension[line, end] * way[:2] / max(float(np.linalg.norm(way)), 1e-12)
        return force


def ends_of(system: System, before: NDArray[np.int64], after: NDArray[np.int64], links: NDArray[np.int64]) -> LineEnds:
    """`LineRows.ends` of its fields."""
    nodes, at = np.concatenate((before[:, 0], after[:, -1])), np.concatenate((links[:, 0], links[:, -1]))
    return system.line_ends.of(nodes, at)
