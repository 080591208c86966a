"""`each_contact`: the one loop over the points of ropes, cloths and other nets that touch the floor or the sphere.

Its source is written when the program starts, like that of `each_link`. It stands there once for each surface, which is
thus a constant that LLVM makes use of.
"""

import inspect
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from sim import point_laws
from sim.jit import generated, kernel
from sim.springs.points.each_link import LOOPS

touching = kernel(inline=True)(point_laws.touching)


class Touch(NamedTuple):
    """A point in contact."""

    j: int
    on_sphere: bool  # else on the floor
    depth: float  # [m], above 0
    nx: float  # normal of the surface
    ny: float
    nz: float
    su: float  # velocity of the surface [m/s]
    sv: float
    sw: float


@kernel(inline=True)
def surface_velocity(p, on_sphere):
    if on_sphere:
        return p.svx, p.svy, p.svz
    return 0.0, 0.0, 0.0


@kernel(noalias=True, inline=True)
def lowest(x, n):
    """Least z, so that a net above the floor costs one comparison a point."""
    least = math.inf
    for j in range(n):
        least = min(least, x[n + n + j])
    return least


@kernel(noalias=True, inline=True)
def nearest(x, n, cx, cy, cz):
    """Least squared distance of any point from (cx, cy, cz)."""
    least = math.inf
    for j in range(n):
        dx, dy, dz = x[j] - cx, x[n + j] - cy, x[n + n + j] - cz
        least = min(least, dx * dx + dy * dy + dz * dz)
    return least


@kernel(noalias=True, allocates=False)
def touches(x, t, p, on_sphere):
    """True if any point is in contact."""
    n = np.uint64(p.rows * p.cols)
    if on_sphere:
        s = t - p.epoch
        return p.has_sphere and nearest(x, n, p.sx + s * p.svx, p.sy + s * p.svy, p.sz + s * p.svz) < p.sr * p.sr
    return p.has_floor and lowest(x, n) < p.floor


@kernel(inline=True)
def slip(v, n, touch):
    """Velocity [m/s] of a touching point relative to the surface."""
    return v[touch.j] - touch.su, v[n + touch.j] - touch.sv, v[2 * n + touch.j] - touch.sw


SURFACE = """
    if touches(x, t, p, {surface}):
        su, sv, sw = surface_velocity(p, {surface})
        for j in range(n):
            depth, nx, ny, nz = touching(x[j], x[n + j], x[2 * n + j], t, p, {surface})
            if depth > 0.0:
                {within}"""


def each_contact(result: str = "nothing", *, noalias: bool = False) -> Callable[[Callable[..., Any]], Any]:
    """Make a function of a touching point and other arguments, x, t and p among them, a kernel of these that calls it
    for every point that touches the floor, then for every point that touches the sphere.

    The point is a `Touch`. result: a key of LOOPS. noalias: as of `kernel`.
    """
    before, within, after = LOOPS[result]

    def made(function: Callable[..., Any]) -> Any:
        arguments = ", ".join(list(inspect.signature(function).parameters)[1:])
        visit = f"visit(Touch(j, {{surface}}, depth, nx, ny, nz, su, sv, sw), {arguments})"
        surface = SURFACE.replace("{within}", within.format(call=visit))
        head = f"def {function.__name__}_of_contacts({arguments}):\n    {before}\n    n = p.rows * p.cols"
        source = "".join([head, surface.format(surface=False), surface.format(surface=True), f"\n    {after}"])
        names = {"visit": kernel(function, noalias=noalias, inline=True), "Touch": Touch, "touches": touches}
        names |= {"touching": touching, "surface_velocity": surface_velocity}
        return generated(source, names, function.__module__, noalias=noalias, allocates=False)

    return made
