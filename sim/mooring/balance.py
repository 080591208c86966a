"""Newton's method for the balance of a mooring, with the tensions as unknowns of their own.

A stiff line that turns by a step of the size of a link is stretched by the second order of it, and with the tension of
that stretch the next step would be tiny. So the matrix has the tensions that the last correction solved for, as if both
positions and tensions were unknown. Links that pull or not, nodes on the bed or not and nodes in, on or above the water
follow piecewise linear laws: where a correction ends on another piece than it assumed, it is solved again with that.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.mooring.chains import Chains
from sim.mooring.tangent import forces_on_free, links_at, moved, moves_on_free
from sim.springs.lines.arrays import BED_AREA, DISPLACED, HEIGHT, MASS, STIFFNESS, LineArrays
from sim.springs.lines.forces import set_rest_forces

if TYPE_CHECKING:
    from sim.mooring.system import System

Array = NDArray[np.float64]

MAX_CORRECTIONS = 40  # of a search
MAX_REPEATS = 6  # of a correction with other pieces, before it is cut short
SETTLED = 1e-9  # largest force left [N] over the largest on any node
ROUND_OFF = 8.0 * np.finfo(float).eps  # the same over the stiffest link times the farthest position
MAX_TURN = 0.6  # [rad] of a link in one correction
TURNED_FAR = 4.0  # MAX_TURNs of a correction that is solved again with more hold
HOLD, REFINED_HOLD = 1e-2, 1e-4  # of slack links to begin with, over what taut ones would have: of a shape, of a state
MIN_HOLD, MAX_HOLD = 1e-12, 10.0
SOFTER = 0.1  # factor on the softness after a whole correction
MIN_SOFTNESS = 1e-6


class Balance(NamedTuple):
    """A state as a search left it."""

    x: Array  # (3, n) [m]
    tension: Array  # (links,) [N] as the last correction found it
    left: float  # [N] largest force on a free coordinate
    is_settled: bool


class Pieces(NamedTuple):
    """The assumed pieces of the laws."""

    taut: NDArray[np.bool_]  # (links,)
    lies: NDArray[np.bool_]  # (parts,) on the bed
    wet: NDArray[np.int64]  # (parts,) 0: below the surface, 1: in it, 2: above


class Softened:
    """The laws of a mooring, softened so that every line stretches and every bed and surface yields by a share.

    softness: of a line's length under the largest load, and of the depth under a part's own weight.
    """

    def __init__(self, system: "System", p: LineArrays, softness: float) -> None:
        weights = p.gravity * np.abs(p.parts[:, DISPLACED] - p.parts[:, MASS])
        load = max(
            *(weights[np.isin(p.places[:, 0], nodes[1:-1])].sum() for nodes in system.nodes_of.values()),
            np.abs(p.steady[:, :3]).max(initial=0.0),
            1e-9,
        )
        deep = min(system.depth, max(line.length for line in system.lines))
        links, parts = p.links.copy(), p.parts.copy()
        if softness > 0.0:
            links[:, 1] = 1.0 / (1.0 / links[:, 1] + softness * links[:, 0] / load)
            parts[:, HEIGHT] += softness * deep
            yields = softness * deep * p.bed_stiffness / np.maximum(weights, 1e-9 * load)
            parts[:, BED_AREA] /= 1.0 + yields * parts[:, BED_AREA]
        self.p = p._replace(links=links, parts=parts)
        self.rest, self.stiffness = links[:, 0], links[:, 1]
        self.node, self.height = p.places[:, 0], parts[:, HEIGHT]
        self.bed, self.lift = parts[:, BED_AREA] * p.bed_stiffness, parts[:, DISPLACED] * p.gravity

    def side(self, z: Array) -> NDArray[np.int64]:
        """Piece of the law of buoyancy at heights z (parts,)."""
        return np.where(z <= -0.5 * self.height, 0, np.where(z < 0.5 * self.height, 1, 2))

    def upward(self, z: Array) -> Array:
        """Bed's force and buoyancy (parts,) [N] at heights z."""
        bed = self.bed * np.maximum(self.p.bed - z, 0.0)
        return bed + self.lift * np.clip(0.5 - z / self.height, 0.0, 1.0)

    def assumed(self, z: Array, pieces: Pieces) -> Array:
        """The same on the assumed pieces, wherever they end."""
        bed = np.where(pieces.lies, self.bed * (self.p.bed - z), 0.0)
        return bed + self.lift * np.select(
            [pieces.wet == 0, pieces.wet == 1], [np.ones_like(z), 0.5 - z / self.height], 0.0
        )

    def pieces_at(self, stretch: Array, z: Array, tension: Array) -> Pieces:
        """The pieces of a state."""
        return Pieces((tension > 0.0) | (stretch > 0.0), z <= self.p.bed, self.side(z))

    def pieces_after(self, stretch: Array, z: Array, before: Pieces) -> Pieces:
        """The pieces where a correction ends; what crosses the surface stops in it first."""
        side = self.side(z)
        crosses = (before.wet != 1) & (side != before.wet)
        return Pieces(stretch > 0.0, z <= self.p.bed, np.where(crosses, 1, side))


class Correction:
    """One linear solution, and how the energy falls along it."""

    def __init__(self, laws: Softened, chains: Chains, x: Array, tension: Array, hold: Array, pieces: Pieces) -> None:
        p = laws.p
        a, b = p.ends.T
        length = links_at(x, p)[0]
        self.laws, self.stretch, self.z = laws, length - laws.rest, x[2, laws.node]
        unit = ((x[:, b] - x[:, a]) / np.maximum(length, 1e-12)).T
        force, self.largest = pull(x, p)
        along = np.where(pieces.taut, laws.stiffness, hold)
        across = np.where(pieces.taut, tension / np.maximum(length, 1e-12), 0.0) + hold
        more = np.zeros((p.nodes, 3))  # force of the assumed pieces over that of the laws
        link = (np.where(pieces.taut, laws.stiffness * self.stretch, 0.0) - self.pulls(self.stretch))[:, None] * unit
        np.add.at(more, a, link)
        np.add.at(more, b, -link)
        np.add.at(more[:, 2], laws.node, laws.assumed(self.z, pieces) - laws.upward(self.z))
        blocks = across[:, None, None] * np.eye(3) + (along - across)[:, None, None] * (
            unit[:, :, None] * unit[:, None]
        )
        upright = np.zeros((p.nodes, 3, 3))
        slope = np.where(pieces.lies, laws.bed, 0.0) + np.where(pieces.wet == 1, laws.lift / laws.height, 0.0)
        np.add.at(upright[:, 2, 2], laws.node, slope)
        self.step = chains.solve(blocks, upright, force + moves_on_free(more.T, p))
        d = moved(x, self.step, p) - x
        turn = (d[:, b] - d[:, a]).T
        self.growth = np.einsum("ij,ij->i", turn, unit)
        square = np.maximum(np.square(turn).sum(axis=1) - self.growth**2, 0.0)
        self.turn = float((np.sqrt(square) / np.maximum(length, 1e-12)).max())
        self.rise = d[2, laws.node]
        self.slope = -float(force @ self.step)
        self.bend = float((across * square).sum() + (np.where(pieces.taut, 0.0, hold) * self.growth**2).sum())
        for i, row in enumerate(p.bodies):
            six = self.step[len(self.step) - 6 * (len(p.bodies) - i) :][:6]
            self.bend += float(six @ row[STIFFNESS : STIFFNESS + 36].reshape(6, 6) @ six)
        self.tension = np.where(pieces.taut, self.pulls(self.stretch + self.growth), 0.0)

    def pulls(self, stretch: Array) -> Array:
        """Tensions (links,) [N] of the law."""
        return np.maximum(self.laws.stiffness * stretch, 0.0)

    def slope_at(self, share: float) -> float:
        """Derivative [J] of the energy at a share of the step, with the links turned no farther."""
        links = (self.pulls(self.stretch + share * self.growth) - self.pulls(self.stretch)) @ self.growth
        upward = (self.laws.upward(self.z + share * self.rise) - self.laws.upward(self.z)) @ self.rise
        return self.slope + share * self.bend + float(links) - float(upward)

    def goes_too_far(self, share: float) -> bool:
        """True if the forces there pull back by more than half as much."""
        return self.slope_at(share) > 0.5 * abs(self.slope)

    def share(self) -> float:
        """The share of the step to take: no link turns too far, and the energy does not rise at its end."""
        share = min(1.0, MAX_TURN / max(self.turn, 1e-300))
        if not self.goes_too_far(share):
            return share
        low, high = 0.0, share
        for _ in range(30):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if self.slope_at(middle) > 0.0 else (middle, high)
        return high


def pull(x: Array, p: LineArrays) -> tuple[Array, float]:
    """Forces [N] on the free coordinates at rest, and the largest on any node."""
    f = np.zeros(9 * p.cols)
    set_rest_forces(np.ascontiguousarray(x).reshape(-1), p, f)
    forces = f[: 3 * p.cols].reshape(3, p.cols)[:, : p.nodes]
    return forces_on_free(forces, x, p), float(np.abs(forces).max())


def balanced(system: "System", x: Array, tension: Array, hold: float, softness: float = 0.0) -> Balance:
    """The state that a search from positions x (3, n) and tensions (links,) comes to.

    hold: HOLD or REFINED_HOLD. softness: see `Softened`; where it is above 0 it falls to 0 on the way.
    """
    p = system.kernel_view(1.0)._replace(waves=np.zeros((9, 0)))
    chains, laws = Chains(system, p), Softened(system, p, softness)
    tension = np.maximum(tension, links_at(x, p)[1])
    scale = max(pull(x, p)[1], float(np.abs(p.steady[:, :3]).max(initial=0.0)), 1e-300)
    pieces, repeats = None, 0
    for _ in range(MAX_CORRECTIONS):
        left, is_settled = what_is_left(x, laws.p)
        if is_settled and softness == 0.0:
            return Balance(x, tension, left, True)
        if pieces is None:
            z = x[2, laws.node]
            pieces, repeats = laws.pieces_at(links_at(x, p)[0] - laws.rest, z, tension), 0
        found = Correction(laws, chains, x, tension, hold * scale / laws.rest, pieces)
        if repeats < MAX_REPEATS and found.goes_too_far(1.0):
            after = laws.pieces_after(found.stretch + found.growth, found.z + found.rise, pieces)
            if any((new != old).any() for new, old in zip(after, pieces, strict=True)):
                pieces, repeats = after, repeats + 1
                continue
        if found.turn > TURNED_FAR * MAX_TURN and hold < MAX_HOLD:
            hold = min(hold * min(max(found.turn / MAX_TURN, 4.0), 1e4), MAX_HOLD)
            continue
        share = found.share()
        x = moved(x, share * found.step, p)
        tension = tension + share * (found.tension - tension)
        hold = max(0.25 * hold, MIN_HOLD) if share == 1.0 else min(2.0 * hold, MAX_HOLD) if share < 0.5 else hold
        if share == 1.0 and softness > 0.0:
            softness = SOFTER * softness if SOFTER * softness > MIN_SOFTNESS else 0.0
            laws = Softened(system, p, softness)
        pieces = None
    left, is_settled = what_is_left(x, laws.p)
    return Balance(x, tension, left, is_settled and softness == 0.0)


def what_is_left(x: Array, p: LineArrays) -> tuple[float, bool]:
    """The largest force [N] on a free coordinate, and whether it is next to nothing."""
    force, largest = pull(x, p)
    left = float(np.abs(force).max(initial=0.0))
    return left, left <= max(SETTLED * largest, ROUND_OFF * float(p.links[:, 1].max() * np.abs(x).max()))
