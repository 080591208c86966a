"""Newton's method for the balance of a mooring from a state near rest, with the tensions as unknowns of their own.

A stiff line that turns by a step of the size of a link is stretched by the second order of it, and with the tension of
that stretch the next step would be tiny. The matrix therefore uses the tensions of the last correction, as if positions
and tensions were both unknowns. Links that pull or not, nodes on the bed or not and volumes in, at or above the surface
follow piecewise linear laws, and the start is near enough to show on which piece each of them is.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.mooring.elastic import Elastic
from sim.mooring.rest.buoyancy import Volumes
from sim.mooring.rest.chains import Chains
from sim.mooring.tangent import declared_stiffness, forces_on_free, links_at, moved, moves_on_free, six_of
from sim.springs.forces.under_water.bending import BEND_STIFFNESS
from sim.springs.points.acceleration import set_rest_forces
from sim.springs.points.line_arrays import STIFFNESS, LineArrays

Array = NDArray[np.float64]

SETTLED = 1e-9  # largest force left [N] over the largest on any node
ROUND_OFF = 8.0 * np.finfo(float).eps  # the same over the largest term of a sum of forces
LARGEST_BEND = 16.0  # eigenvalue of the bends of a line, over the stiffness of one
RISE = 1e6  # of the largest force left by the first correction, above which the start was not near
HOLD = 1e-8  # of slack links, over tensions and weights: the position of a slack part is arbitrary


class BalanceResult(NamedTuple):
    """A state as the corrections left it."""

    x: Array  # (3, n) [m]
    left: float  # [N] largest force on a free coordinate
    is_settled: bool
    corrections: int


class Pieces(NamedTuple):
    """The pieces of the laws on which parts and volumes are."""

    lies: NDArray[np.bool_]  # (parts,) on the bed
    wet: NDArray[np.bool_]  # (volumes,) with some buoyancy
    in_surface: NDArray[np.bool_]  # (volumes,) cut by the surface


class Laws:
    """The piecewise linear laws of links, bed and buoyancy."""

    def __init__(self, p: LineArrays) -> None:
        self.p, self.elastic, self.volumes = p, Elastic(p), Volumes(p)
        self.node, self.bed = p.places[:, 0], p.parts["bed_area"] * p.bed_stiffness
        self.weight = float((p.parts["mass"] * -p.gz).max())  # [N] of the heaviest part

    def pieces_at(self, x: Array) -> Pieces:
        """The pieces at positions x (3, n)."""
        z, top = self.volumes.middles(x[2]), 0.5 * self.volumes.height
        return Pieces(x[2, self.node] <= self.p.bed, z < top, np.abs(z) < top)

    def upward(self, x: Array, on: Pieces) -> Array:
        """Forces (nodes,) [N] of bed and buoyancy at positions x (3, n), each on its piece wherever that ends."""
        forces, volumes = np.zeros(self.p.nodes), self.volumes
        np.add.at(forces, self.node, np.where(on.lies, self.bed * (self.p.bed - x[2, self.node]), 0.0))
        share = np.where(on.in_surface, 0.5 - volumes.middles(x[2]) / volumes.height, 1.0)
        volumes.add_forces(np.where(on.wet, volumes.whole * share, 0.0), forces)
        return forces

    def with_stiffness(self, on: Pieces, blocks: Array, upright: Array) -> Array:
        """As `Volumes.with_stiffness`, of bed and buoyancy."""
        np.add.at(upright[:, 2, 2], self.node, np.where(on.lies, self.bed, 0.0))
        stiffness = np.where(on.in_surface, self.volumes.whole / self.volumes.height, 0.0)
        return self.volumes.with_stiffness(stiffness, blocks, upright)


def corrected(laws: Laws, chains: Chains, x: Array, tension: Array, on: Pieces) -> tuple[Array, Array]:
    """Positions (3, n) and tensions (links,) [N] after one correction, with parts on the pieces `on`."""
    p = laws.p
    a, b = p.ends.T
    length, pulls = links_at(x, p)
    rest, (chord, stiffness) = p.links[:, 0], laws.elastic.tension(length)
    unit = ((x[:, b] - x[:, a]) / np.maximum(length, 1e-12)).T
    taut = (tension > 0.0) | (length > rest)
    hold = HOLD * max(float(tension.max()), laws.weight, 1e-12 * float((stiffness * rest).max())) / rest
    along = np.where(taut, stiffness, hold)
    across = np.where(taut, tension / np.maximum(length, 1e-12), 0.0) + hold
    # A taut link that is shorter by round-off pushes, for this correction.
    pushes = (np.where(taut, chord, 0.0) - pulls)[:, None] * unit
    more, upright = np.zeros((p.nodes, 3)), declared_stiffness(x, p)
    np.add.at(more, a, pushes)
    np.add.at(more, b, -pushes)
    outer = unit[:, :, None] * unit[:, None]
    blocks = across[:, None, None] * np.eye(3) + (along - across)[:, None, None] * outer
    blocks = laws.with_stiffness(on, blocks, upright)
    more[:, 2] += laws.upward(x, on) - laws.upward(x, laws.pieces_at(x))
    force = pull(x, p)[0] + moves_on_free(np.ascontiguousarray(more.T), p)
    step = chains.solve(blocks, upright, force)
    d = moved(np.zeros_like(x), step, p)  # with no round-off of the places
    growth = np.einsum("ij,ij->i", (d[:, b] - d[:, a]).T, unit)
    return moved(x, step, p), np.where(taut, np.maximum(chord + stiffness * growth, 0.0), 0.0)


def pull(x: Array, p: LineArrays) -> tuple[Array, float]:
    """Forces [N] on the free coordinates at rest, and the largest on any node."""
    f = np.zeros(3 * p.cols)
    set_rest_forces(np.ascontiguousarray(x).reshape(-1), p, f)
    forces = f.reshape(3, p.cols)[:, : p.nodes]
    return forces_on_free(forces, x, p), float(np.abs(forces).max())


def balanced(laws: Laws, chains: Chains, x: Array, tension: Array, on: Pieces, corrections: int) -> BalanceResult:
    """The state of rest near positions x (3, n) and tensions (links,) [N], after `corrections` at most.

    on: pieces of the laws there, for the first correction.
    """
    p = laws.p
    left, is_settled = what_is_left(x, p)
    most = RISE * left  # a stiff line may be stretched by the first correction, which the second takes back
    for done in range(corrections):
        if is_settled or not left <= most:
            return BalanceResult(x, left, is_settled, done)
        most = left if done else most
        x, tension = corrected(laws, chains, x, tension, on)
        on = laws.pieces_at(x)
        left, is_settled = what_is_left(x, p)
    return BalanceResult(x, left, is_settled, corrections)


def what_is_left(x: Array, p: LineArrays) -> tuple[float, bool]:
    """The largest force [N] on a free coordinate, and whether it is next to nothing."""
    force, largest = pull(x, p)
    left = float(np.abs(force).max(initial=0.0))
    # Round-off of the force of a link, of a bend or of the bed, and of all that a body sums, with its arms.
    stiffest = max(
        float(p.links[:, 1].max()),
        p.bed_stiffness * float(p.parts["bed_area"].max(initial=0.0)),
        LARGEST_BEND * float(p.bends[:, BEND_STIFFNESS].max(initial=0.0)),
    )
    summed = max(1.0, float(np.maximum(np.abs(p.arms).max(axis=1, initial=0.0), 1.0).sum()))
    terms = stiffest * float(np.abs(x).max()) * summed
    for b, row in enumerate(p.bodies):
        stiffness = np.abs(row[STIFFNESS : STIFFNESS + 36].reshape(6, 6))
        terms = max(terms, float((stiffness @ np.abs(six_of(x, p, b))).max()), float(np.abs(p.steady[b]).max()))
    return left, left <= max(SETTLED * largest, ROUND_OFF * terms)
