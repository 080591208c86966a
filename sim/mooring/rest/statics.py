"""The static state of a mooring without waves.

`sim.mooring.rest.interior` approaches it from straight lines, so that any start leads to the same state.
`sim.mooring.rest.balance` solves it to round-off.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.mooring.parts import MooringParts
from sim.mooring.rest.balance import Laws, balanced
from sim.mooring.rest.chains import Chains
from sim.mooring.rest.interior import along_central_path
from sim.mooring.tangent import six_of
from sim.records import equal_to_itself
from sim.springs.forces.under_water.bending import set_line_tensions
from sim.springs.points.line_arrays import LineArrays
from sim.validation import ConvergenceError

MAX_CORRECTIONS = 60  # of both methods together
FINISHING, LEAST_FINISHING = 12, 2  # of them at the end, at most, and before they run out
NEAR, NEARER = 1e-9, 1e-4  # gap at which the end is tried first, and over the last one again
STALLED, SMALL = 0.9, 1e-6  # gap over the least before it, and gap: round-off ends the path there


@equal_to_itself
class Rest(NamedTuple):
    """A static state."""

    x: dict[int, NDArray[np.float64]]  # by line: (segments + 1, 3) [m]
    tension: dict[int, NDArray[np.float64]]  # by line: (segments,) [N], from its start to its end
    end_tension: dict[int, NDArray[np.float64]]  # by line: (2,) [N] at its start and end, see `sim.mooring.end_forces`
    bodies: dict[int, NDArray[np.float64]]  # by body: (6,) [m, rad] from its place
    nodes: NDArray[np.float64]  # (3, n) of all nodes and bodies, as kernels have them


def straight(system: MooringParts, placed: dict[int, NDArray[np.float64]] | None = None) -> NDArray[np.float64]:
    """Positions (3, n) [m] on straight lines, with the points in `placed`, by id, there."""
    placed = placed or {}
    x = np.zeros((3, system.node_count + 2 * len(system.bodies)))
    for i, point in enumerate(system.points):
        x[:, i] = placed.get(point.id, np.asarray(point.position, dtype=np.float64))
    for line in system.lines:
        at = system.nodes_of[line.id]
        x[:, at] = np.linspace(x[:, at[0]], x[:, at[-1]], len(at)).T
    return x


def at_rest(system: MooringParts, placed: dict[int, NDArray[np.float64]] | None = None) -> Rest:
    """The static state without waves, with points at their own places or at those in `placed`, by id.

    Raises ConvergenceError if no state of rest is found.
    """
    p = system.kernel_view(1.0)._replace(waves=np.zeros((9, 0)))
    laws, chains, x = Laws(p), Chains(system, p), straight(system, placed)
    done, left, aim, least = 0, math.inf, NEAR, math.inf
    for near in along_central_path(p, chains, x):
        done, stalls = done + 1, STALLED * least < near.gap < SMALL
        least = min(least, near.gap)
        if not (near.gap <= aim or stalls or near.is_last or done >= MAX_CORRECTIONS - LEAST_FINISHING):
            continue
        aim = min(aim, NEARER * near.gap)
        for tension, on in near.guesses(laws.pieces_at(near.x)):
            balance = balanced(laws, chains, near.x, tension, on, min(FINISHING, MAX_CORRECTIONS - done))
            if balance.is_settled:
                return rest_of(system, balance.x, p)
            done, left = done + balance.corrections, min(left, balance.left)
        if done >= MAX_CORRECTIONS:
            break
    raise ConvergenceError("static state of the mooring", f"{left:.3g} N", done)


def rest_of(system: MooringParts, x: NDArray[np.float64], p: LineArrays) -> Rest:
    """The named parts of positions (3, n)."""
    tension, flat = np.empty(len(p.ends)), np.ascontiguousarray(x).reshape(-1)
    set_line_tensions(flat, np.zeros_like(flat), p, tension)
    xs = {one: np.ascontiguousarray(x[:, nodes].T) for one, nodes in system.nodes_of.items()}
    tensions = {one: tension[links] for one, links in system.links_of.items()}
    at_ends = system.line_ends.tensions(x, np.zeros_like(x), 0.0, p).reshape(-1, 2)
    ends = {line.id: one for line, one in zip(system.lines, at_ends, strict=True)}
    return Rest(xs, tensions, ends, {body.id: six_of(x, p, b) for b, body in enumerate(system.bodies)}, x)
