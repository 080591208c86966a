"""`each_link`: the one loop over the table of links of ropes, other nets and lines.

Its source is written when the program starts, as `sim.springs.forces.each` does for forces, and the compiler expands
into it what is done to a link. Loops that follow the rows of a grid, so that they vectorise, stand where they are used.
"""

import inspect
import math
from collections.abc import Callable
from typing import Any

from sim.jit import generated, kernel
from sim.springs.laws import damping
from sim.springs.points.arrays import link_at, link_count, span
from sim.springs.points.order import in_turn

TINY = 1e-300  # [m^2] under the root: coincident points get no spring force instead of 0/0

# Of a loop over links or contacts: its lines before, within and after, by what becomes of the values of `visit`.
LOOPS = {
    "nothing": ("pass", "{call}", "return None"),
    "sum": ("total = 0.0", "total += {call}", "return total"),
    "two sums": ("first = second = 0.0", "one, other = {call}; first += one; second += other", "return first, second"),
    "largest": ("largest = 0.0", "largest = max(largest, {call})", "return largest"),
}


def each_link(result: str = "nothing", *, noalias: bool = False) -> Callable[[Callable[..., Any]], Any]:
    """Make a function of a link and other arguments, p among them, a kernel of these that calls it for every link.

    The link is a `Link`. If `reverse` is among the arguments, True is the order from the last link to the first.
    result: a key of LOOPS. noalias: as of `kernel`.
    """
    before, within, after = LOOPS[result]

    def made(function: Callable[..., Any]) -> Any:
        names = list(inspect.signature(function).parameters)[1:]
        number, arguments = "in_turn(q, count, reverse)" if "reverse" in names else "q", ", ".join(names)
        lines = [
            f"def {function.__name__}_of_links({arguments}):",
            f"    {before}",
            "    count = link_count(p)",
            "    for q in range(count):",
            f"        {within.format(call=f'visit(link_at(p, {number}), {arguments})')}",
            f"    {after}",
        ]
        visit = kernel(function, noalias=noalias, inline=True)
        used = {"visit": visit, "in_turn": in_turn, "link_count": link_count, "link_at": link_at}
        return generated("\n".join(lines), used, function.__module__, noalias=noalias, allocates=False)

    return made


@kernel(inline=True)
def stretch(x, p, link):
    """(x, y, z) [m] from a link's first point to its second, and its length [m]."""
    rx, ry, rz = span(x, p.rows * p.cols, link.a, link.b)
    return rx, ry, rz, math.sqrt(rx * rx + ry * ry + rz * rz + TINY)


@kernel(inline=True)
def acting_damping(link, length, rate):
    """The part of a link's damping [N s/m] that acts at this length [m] where it grows by `rate` [m/s]."""
    return damping(link.law, link.stiffness, link.damping, link.rest, length, rate)
