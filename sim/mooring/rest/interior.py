"""An interior-point method for the state of rest of a mooring, which needs no good start.

A state of rest has the least energy, and the energy is convex: a link only pulls, the bed only presses, and buoyancy
ends at the surface. Each of these laws is a complementarity: of a link's slack and tension in dual second-order
cones, of the bed's force and the gap to it, of the buoyancy that is missing or left and the depth or height beyond
the surface. The method follows the central path, on which the products of all such pairs are equal, by Mehrotra's
predictor and corrector. Forces need not balance on the way. Near the end the active laws are known, and
`sim.mooring.rest.balance` solves them.

Source: L. Vandenberghe, "The CVXOPT linear and quadratic cone program solvers" (2010).
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.mooring.bending import bending_forces
from sim.mooring.elastic import Elastic
from sim.mooring.rest.balance import Pieces
from sim.mooring.rest.buoyancy import Volumes
from sim.mooring.rest.chains import Chains, Eliminated
from sim.mooring.rest.cones import (
    MIRROR,
    UNIT,
    Scaling,
    determinant,
    dot,
    longest_above_zero,
    longest_in_cones,
    product,
    quotient,
)
from sim.mooring.tangent import forces_on_free, is_declared, moved, moves_on_free, others
from sim.springs.points.acceleration import set_rest_forces
from sim.springs.points.line_arrays import STIFFNESS, LineArrays

Array = NDArray[np.float64]

INSIDE = 0.99  # fraction of the step to the nearest bound
SHORTER, LEAST_FRACTION = 0.7, 1e-6  # of a step that ends on a bound by round-off
TAUT = 1e-3  # slack of a link that seems taut, over its length
WIDE = 1.5  # slack at the start, over the longer of a link's rest length and its span


class InteriorState(NamedTuple):
    """Numbers that the laws keep positive or inside cones, or a step of them."""

    slack: Array  # (links, 4) [m]: stretched length, span
    pull: Array  # (links, 4) [N]: tension, and force on the link's end
    press: Array  # (m,) [N] of the bed on each part with a bed area
    gap: Array  # (m,) [m] to the bed, as far as it yields
    lift: Array  # (k,) [N] buoyancy of each of `Volumes`
    spare: Array  # (k,) [N] missing from the buoyancy of the whole volume
    above: Array  # (k,) [m] beyond the height at which buoyancy ends
    below: Array  # (k,) [m] beyond the depth at which it is whole

    def plus(self, step: "InteriorState", fraction: float) -> "InteriorState":
        """The state after a fraction of a step."""
        return InteriorState(*(value + fraction * change for value, change in zip(self, step, strict=True)))

    def longest(self, step: "InteriorState") -> float:
        """Largest multiple of a step, 1 at most, that leaves no bound."""
        cones = (longest_in_cones(u, d) for u, d in zip(self[:2], step[:2], strict=True))
        rays = (longest_above_zero(u, d) for u, d in zip(self[2:], step[2:], strict=True))
        return min(1.0, *cones, *rays)

    def is_inside(self) -> bool:
        """True if no number is on its bound, which a step may reach by round-off."""
        cones = all(bool((determinant(u) > 0.0).all() and (u[:, 0] > 0.0).all()) for u in self[:2])
        return cones and all(bool((u > 0.0).all()) for u in self[2:])


class Products(NamedTuple):
    """Products of the pairs, or the change of them that a step is to make, to first order."""

    links: Array  # (links, 4) in the cones' scaled algebra
    bed: Array  # (m,) [J]
    dry: Array  # (k,) [J] of lift and above
    wet: Array  # (k,) [J] of spare and below


class Pairs:
    """The constants of a mooring's pairs."""

    def __init__(self, p: LineArrays) -> None:
        self.p = p
        self.start, self.end = p.ends.T
        self.rest, self.stiffness = p.links[:, 0], p.links[:, 1]
        node, self.weight = p.places[:, 0], p.parts["mass"] * -p.gz
        bed, self.volumes = p.parts["bed_area"] * p.bed_stiffness, Volumes(p)
        self.has_bed = bed > 0.0
        self.node, self.on_bed, self.bed = node, node[self.has_bed], bed[self.has_bed]
        self.whole, self.height = self.volumes.whole, self.volumes.height
        self.count = len(self.rest) + len(self.bed) + 2 * len(self.whole)
        # Not the difference of weight and lift: a part at the surface loses its lift.
        self.load = float(np.maximum(self.weight, p.parts["displaced"] * -p.gz).sum() + np.abs(p.loads).sum())  # [N]
        self.elastic, self.others = Elastic(p), others(p)

    def span(self, x: Array) -> Array:
        """Vectors (links, 3) from start to end of every link."""
        return (x[:, self.end] - x[:, self.start]).T

    def first(self, x: Array) -> InteriorState:
        """A state inside all bounds with equal products, by the forces to be expected."""
        p, span = self.p, self.span(x)
        length = np.sqrt(dot(span, span))
        # A line that is too short is stretched, or draws bodies down.
        short = np.maximum(length - self.rest, 0.0)
        held = float((self.stiffness * short).max())
        if len(p.bodies):
            held = min(held, float(p.bodies[:, [STIFFNESS, STIFFNESS + 7, STIFFNESS + 14]].max() * short.sum()))
        least = 1e-12 * float((self.stiffness * self.rest).max())
        load = max(self.load, float(np.abs(p.steady[:, :3]).max(initial=0.0)), held, least)
        each = load * float(np.maximum(self.rest, length).mean())  # [J] of every pair
        slack = np.concatenate((WIDE * np.maximum(self.rest, length)[:, None], span), axis=1)
        pull = each * MIRROR * slack / determinant(slack)[:, None]
        press = np.full(len(self.bed), load / max(len(self.bed), 1))
        lift = 0.5 * self.whole
        return InteriorState(slack, pull, press, each / press, lift, lift.copy(), each / lift, each / lift)

    def forces(self, x: Array, state: InteriorState) -> Array:
        """Forces (nodes, 3) [N] of a state on every node."""
        p, forces = self.p, np.zeros((self.p.nodes, 3))
        if p.current.any() or is_declared(p):
            more = np.zeros(3 * p.cols)
            set_rest_forces(np.ascontiguousarray(x).reshape(-1), self.others, more)
            forces += more.reshape(3, p.cols)[:, : p.nodes].T
        np.add.at(forces[:, 2], self.node, -self.weight)
        forces += bending_forces(x, p)
        if len(p.loads):
            forces += p.loads[: p.nodes]
        return forces + self.forces_of(state.pull[:, 1:], state.press, state.lift)

    def forces_of(self, pull: Array, press: Array, lift: Array) -> Array:
        """Forces (nodes, 3) [N] of links, bed and buoyancy."""
        forces = np.zeros((self.p.nodes, 3))
        np.add.at(forces, self.end, pull)
        np.add.at(forces, self.start, -pull)
        np.add.at(forces[:, 2], self.on_bed, press)
        self.volumes.add_forces(lift, forces[:, 2])
        return forces

    def pieces(self, state: InteriorState) -> Pieces:
        """The pieces on which all seem to be: forces against lengths, over the stiffness of the lines there."""
        stiffness = np.full(self.p.nodes, self.load / self.count / float(self.rest.mean()))
        for ends in (self.start, self.end):
            np.maximum.at(stiffness, ends, state.pull[:, 0] / state.slack[:, 0])
        lies, firmness = np.zeros(len(self.node), dtype=bool), self.volumes.middles(stiffness)
        lies[self.has_bed] = state.press > stiffness[self.on_bed] * state.gap
        wet = state.lift > firmness * state.above
        return Pieces(lies, wet, wet & (state.spare > firmness * state.below))

    def mean(self, state: InteriorState) -> float:
        """Mean product [J] of the pairs of a state."""
        links, bed = dot(state.slack, state.pull).sum(), state.press @ state.gap
        return float(links + bed + state.lift @ state.above + state.spare @ state.below) / self.count

    def gap(self, state: InteriorState) -> float:
        """The same over the largest energy of a link, which has `load` at least."""
        energy = max(self.load * float(self.rest.mean()), float((state.slack[:, 0] * state.pull[:, 0]).max()))
        return self.mean(state) / max(energy, 1e-300)

    def errors(self, x: Array, state: InteriorState) -> tuple[Array, Array, Array]:
        """Lengths [m] by which slack (links, 4), gaps (m,) and heights (k,) of a state differ from those at x."""
        length, _ = self.elastic.length(state.pull[:, 0])
        slack = np.concatenate((length[:, None], self.span(x)), axis=1) - state.slack
        gap = x[2, self.on_bed] - self.p.bed + state.press / self.bed - state.gap
        height = (
            self.volumes.middles(x[2]) + self.height * (state.lift / self.whole - 0.5) - (state.above - state.below)
        )
        return slack, gap, height


class Tangent:
    """The laws linearised about a state, to which the steps of one correction are solved."""

    def __init__(self, pairs: Pairs, chains: Chains, x: Array, state: InteriorState) -> None:
        self.pairs, self.x, self.state = pairs, x, state
        p = pairs.p
        self.force = forces_on_free(np.ascontiguousarray(pairs.forces(x, state).T), x, p)
        self.errors = pairs.errors(x, state)
        self.mean = pairs.mean(state)
        self.scaling = Scaling(state.slack, state.pull)
        # With G = W^2 + diag(1/k, 0, 0, 0) a step of the pull is G^-1 (target - errors - (0, step of the span)).
        w, self.square = self.scaling.w, self.scaling.beta**2
        self.first, self.rest = w[:, 0], -w[:, 1:]
        _, self.stiffness = pairs.elastic.length(state.pull[:, 0])
        self.ratio = self.stiffness * self.square
        self.divisor = self.ratio + 2.0 * self.first**2 - 1.0
        along = 2.0 * (self.ratio - 1.0) / self.divisor
        outer = self.rest[:, :, None] * self.rest[:, None]
        self.blocks = (np.eye(3) + along[:, None, None] * outer) / self.square[:, None, None]
        self.yields = state.gap + state.press / pairs.bed
        self.rises = pairs.height / pairs.whole + state.above / state.lift + state.below / state.spare
        upright = np.zeros((p.nodes, 3, 3))
        np.add.at(upright[:, 2, 2], pairs.on_bed, state.press / self.yields)
        blocks = pairs.volumes.with_stiffness(1.0 / self.rises, self.blocks, upright)
        self.matrix = Eliminated(chains, blocks, upright)

    def solve(self, change: Products) -> tuple[Array, InteriorState]:
        """The step of the free coordinates, and of the state, that balances forces and changes the products."""
        pairs, state, (slack, gap, height) = self.pairs, self.state, self.errors
        p, first, rest, ratio = pairs.p, self.first, self.rest, self.ratio
        target = self.scaling.times(change.links) - slack
        one, three = target[:, 0], target[:, 1:]
        along = 2.0 * (first * ratio * one + (ratio - 1.0) * dot(rest, three)) / self.divisor
        pull = (three + along[:, None] * rest) / self.square[:, None]
        press = (change.bed - state.press * gap) / self.yields
        lift = (change.dry / state.lift - change.wet / state.spare - height) / self.rises
        more = np.ascontiguousarray(pairs.forces_of(pull, press, lift).T)
        step = self.matrix.solve(self.force + moves_on_free(more, p))
        dx = moved(np.zeros_like(self.x), step, p)  # with no round-off of the places
        span, down, up = pairs.span(dx), dx[2, pairs.on_bed], pairs.volumes.middles(dx[2])
        pull = pull - np.einsum("ijk,ik->ij", self.blocks, span)
        stretch = ((2.0 * first**2 - 1.0) * one + 2.0 * first * dot(rest, three - span)) / self.divisor
        press = press - state.press / self.yields * down
        lift = lift - up / self.rises
        return step, InteriorState(
            np.concatenate((stretch[:, None], span), axis=1) + slack,
            np.concatenate(((self.stiffness * stretch)[:, None], pull), axis=1),
            press,
            down + press / pairs.bed + gap,
            lift,
            -lift,
            (change.dry - state.above * lift) / state.lift,
            (change.wet + state.below * lift) / state.spare,
        )

    def step(self) -> tuple[Array, InteriorState]:
        """Predictor and corrector step (Mehrotra)."""
        state, scaled = self.state, self.scaling.times(self.state.pull)
        bed, dry, wet = -state.press * state.gap, -state.lift * state.above, -state.spare * state.below
        _, ahead = self.solve(Products(-scaled, bed, dry, wet))
        aim = (1.0 - state.longest(ahead)) ** 3 * self.mean
        second = product(self.scaling.over(ahead.slack), self.scaling.times(ahead.pull))
        return self.solve(
            Products(
                quotient(aim * UNIT - product(scaled, scaled) - second, scaled),
                aim + bed - ahead.press * ahead.gap,
                aim + dry - ahead.lift * ahead.above,
                aim + wet - ahead.spare * ahead.below,
            )
        )


class Near(NamedTuple):
    """A state on the way to rest."""

    x: Array  # (3, n) [m]
    tension: Array  # (links,) [N]
    slack: Array  # (links,) over their lengths
    on: Pieces
    gap: float  # mean product of the pairs over the largest energy of a link
    is_last: bool  # round-off prevents a closer state

    def guesses(self, by_place: Pieces) -> list[tuple[Array, Pieces]]:
        """Tensions (links,), 0 of links that seem slack, and pieces: one guess, or two if they differ.

        Links by their lengths and parts by both numbers of their pairs; or links by their pairs and parts by place.
        """
        by_length = self.slack < TAUT
        by_pair = self.tension > self.slack * float(self.tension.max())
        one, other = (np.where(by_length, self.tension, 0.0), self.on), (np.where(by_pair, self.tension, 0.0), by_place)
        is_same = all((a == b).all() for a, b in zip((one[0], *one[1]), (other[0], *other[1]), strict=True))
        return [one] if is_same else [one, other]


def corrected(pairs: Pairs, chains: Chains, x: Array, state: InteriorState) -> tuple[Array, InteriorState] | None:
    """Positions and state after one correction; None if round-off leaves no step inside the bounds."""
    try:
        step, change = Tangent(pairs, chains, x, state).step()
    except np.linalg.LinAlgError:
        return None
    fraction = INSIDE * state.longest(change)
    while not (after := state.plus(change, fraction)).is_inside():
        fraction *= SHORTER
        if not fraction > LEAST_FRACTION:  # true of a NaN as well
            return None
    return moved(x, fraction * step, pairs.p), after


def along_central_path(p: LineArrays, chains: Chains, x: Array) -> Iterator[Near]:
    """States nearer and nearer to rest, one a correction, from positions x (3, n), which may be anywhere."""
    pairs = Pairs(p)
    state, is_last = pairs.first(x), False
    while not is_last:
        after = corrected(pairs, chains, x, state)
        is_last = after is None
        x, state = after or (x, state)
        slack = state.slack[:, 0] - np.sqrt(dot(state.slack[:, 1:], state.slack[:, 1:]))
        yield Near(x, state.pull[:, 0], slack / pairs.rest, pairs.pieces(state), pairs.gap(state), is_last)
