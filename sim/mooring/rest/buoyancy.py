"""Buoyancy in the statics of a mooring: pieces of segments, and points that float, by the force `water`."""

import numpy as np
from numpy.typing import NDArray

from sim.springs.forces.under_water.water import PIECES
from sim.springs.points.line_arrays import LineArrays

Array = NDArray[np.float64]

MIDDLES = (np.arange(PIECES) + 0.5) / PIECES  # of the pieces, as a fraction of the way from end to end


class Volumes:
    """Volumes with their middles on the way from one node to another, or, of a point, at a node."""

    def __init__(self, p: LineArrays) -> None:
        lift, node, before, after = -p.gz * p.parts["displaced"], *p.places.T
        is_point = before == after  # both are the point itself
        points = np.flatnonzero(is_point & (lift > 0.0))
        # Half of a segment belongs to the part at either end. The part at its start has its other node after it.
        sides = np.where((before == node) | (after == node), 1, 2)
        starts = np.flatnonzero(~is_point & (after != node) & (lift > 0.0))
        link = {(int(a), int(b)): i for i, (a, b) in enumerate(p.ends)}
        pairs = zip(node[starts].tolist(), after[starts].tolist(), strict=True)
        links = np.array([link[pair] for pair in pairs], dtype=np.int64)
        each = 2.0 * lift[starts] / sides[starts] / PIECES
        self.near = np.concatenate((np.repeat(node[starts], PIECES), node[points]))
        self.far = np.concatenate((np.repeat(after[starts], PIECES), node[points]))
        self.way = np.concatenate((np.tile(MIDDLES, len(starts)), np.zeros(len(points))))
        self.whole = np.concatenate((np.repeat(each, PIECES), lift[points]))  # [N]
        self.height = np.concatenate((np.repeat(p.parts["height"][starts], PIECES), p.parts["height"][points]))  # [m]
        self.link = np.repeat(links, PIECES)  # of those of segments

    def middles(self, z: Array) -> Array:
        """Heights (k,) of the middles at heights z (n,) of the nodes."""
        return (1.0 - self.way) * z[self.near] + self.way * z[self.far]

    def add_forces(self, lift: Array, forces: Array) -> None:
        """Add forces (k,) [N] at the middles to the upward ones on the nodes, forces (nodes,)."""
        np.add.at(forces, self.near, (1.0 - self.way) * lift)
        np.add.at(forces, self.far, self.way * lift)

    def with_stiffness(self, stiffness: Array, blocks: Array, upright: Array) -> Array:
        """The blocks (links, 3, 3) of `Eliminated` with stiffness (k,) [N/m] at the middles.

        The rest of it, which is not of the form [H -H; -H H], is added to upright (nodes, 3, 3).
        """
        new_blocks, near, far = blocks.copy(), (1.0 - self.way) * stiffness, self.way * stiffness
        count = len(self.link)
        np.add.at(new_blocks[:, 2, 2], self.link, -(self.way * near)[:count])
        np.add.at(upright[:, 2, 2], self.near, near)
        np.add.at(upright[:, 2, 2], self.far, far)
        return new_blocks
