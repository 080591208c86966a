"""Forces of lines on the holders of their ends, as MoorDyn's tensions at anchors and fairleads have them.

The first or last link, with the weight of half a segment and the forces of water, bed and bending on it; the inertia of
that half is left out. Where an end lies on the bed, the bed bears the weight of that half.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel
from sim.springs.forces.links import lengthening
from sim.springs.forces.under_water.bed import bed_force
from sim.springs.forces.under_water.bending import BEND_STIFFNESS, LINKS, WEIGHTS, bend_at
from sim.springs.forces.under_water.water import push_of
from sim.springs.laws import tension
from sim.springs.points.arrays import link_at
from sim.springs.points.each_link import stretch
from sim.springs.points.line_arrays import LineArrays

Array = NDArray[np.float64]

ON_THE_BED = 1e-3  # [m] over the bed, at which an end still lies on it


class LineEnds(NamedTuple):
    """Ends of lines, by their node, their part and their link."""

    nodes: NDArray[np.int64]  # (m,)
    parts: NDArray[np.int64]  # (m,)
    links: NDArray[np.int64]  # (m,)

    def of(self, nodes: NDArray[np.int64], links: NDArray[np.int64]) -> "LineEnds":
        """The ends at nodes (n,) of links (n,), in this order."""
        known = {key: i for i, key in enumerate(zip(self.nodes.tolist(), self.links.tolist(), strict=True))}
        index = [known[key] for key in zip(nodes.tolist(), links.tolist(), strict=True)]
        return LineEnds(*(values[index] for values in self))

    def forces(self, x: Array, v: Array, t: float, p: LineArrays) -> Array:
        """Forces (m, 3) [N] at positions x (3, n) and velocities v (3, n) at the time t [s]."""
        out = np.empty((len(self.nodes), 3))
        set_end_forces(np.ascontiguousarray(x).reshape(-1), np.ascontiguousarray(v).reshape(-1), t, p, *self, out)
        return out

    def tensions(self, x: Array, v: Array, t: float, p: LineArrays) -> Array:
        """Sizes (m,) [N] of `forces`."""
        return np.linalg.norm(self.forces(x, v, t, p), axis=1)


@kernel(allocates=False)
def set_end_forces(x, v, t, p, nodes, parts, links, out):
    """Set out (m, 3) of `LineEnds.forces`."""
    for i in range(nodes.shape[0]):
        j, k, q = nodes[i], parts[i], links[i]
        link = link_at(p, q)
        rx, ry, rz, length = stretch(x, p, link)
        _, rate, damping = lengthening(x, v, p, link)
        pull = (tension(link.law, link.stiffness, link.rest, length) + damping * rate) / length
        pull = pull if link.a == j else -pull
        wx, wy, wz, _ = push_of(x, v, t, p, k, j, True)
        bx, by, bz = bed_force(x, v, p, k, j, True)
        fx, fy, fz = pull * rx + wx + bx, pull * ry + wy + by, pull * rz + wz + bz + p.parts[k].mass * p.gz
        for b in range(p.bends.shape[0]):
            if int(p.bends[b, LINKS]) == q or int(p.bends[b, LINKS + 1]) == q:
                dx, dy, dz = bend_at(x, p, b)
                for e in range(3):
                    if int(p.bends[b, e]) == j:
                        s = p.bends[b, WEIGHTS + e] * p.bends[b, BEND_STIFFNESS]
                        fx, fy, fz = fx - s * dx, fy - s * dy, fz - s * dz
        if x[2 * p.cols + j] <= p.bed + ON_THE_BED and p.bed_stiffness > 0.0:
            fz = max(fz, 0.0)
        out[i, 0], out[i, 1], out[i, 2] = fx, fy, fz
