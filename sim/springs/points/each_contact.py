"""`each_contact` and `each_load`: the loops over points of ropes, cloths and other nets that floor and sphere press.

Their source is written when the program starts, like that of `each_link`. It stands there once for each surface, which
is thus a constant that LLVM makes use of.
"""

import inspect
import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from sim.jit import generated, kernel
from sim.springs.points.arrays import by_net
from sim.springs.points.each_link import LOOPS
from sim.springs.points.face_places import each_face, face_reach, push_on_face
from sim.springs.points.link_places import links_near, place_on_link, push_on_link, sphere_gap, touching


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


class Load(NamedTuple):
    """A point that a surface presses, by itself or through its share of the forces on its links or faces."""

    j: int
    on_sphere: bool  # else by the floor
    push: float  # normal force [N], 0 or above
    nx: float  # its direction
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


# False if there is no sphere, or a rope's links meet it instead.
points_meet_sphere = kernel(lambda p: p.has_sphere and not p.links_touch, inline=True)


@kernel(noalias=True, allocates=False)
def touches(x, t, p, on_sphere):
    """True if any point is in contact by itself."""
    n = np.uint64(p.rows * p.cols)
    if on_sphere:
        return points_meet_sphere(p) and sphere_gap(x, n, t, p) < 0.0
    return p.has_floor and lowest(x, n) < p.floor


@kernel(inline=True)
def slip(v, n, touch):
    """Velocity [m/s] of a touching or loaded point relative to the surface."""
    return v[touch.j] - touch.su, v[n + touch.j] - touch.sv, v[2 * n + touch.j] - touch.sw


@kernel(inline=True)
def load_of(touch, v, n, p, with_damping):
    """The `Load` of a point that touches a surface by itself."""
    u, q, r = slip(v, n, touch)
    rate = p.contact_b * (u * touch.nx + q * touch.ny + r * touch.nz) if with_damping else 0.0
    push = max(0.0, p.contact_k * touch.depth - rate)
    return Load(touch.j, touch.on_sphere, push, touch.nx, touch.ny, touch.nz, touch.su, touch.sv, touch.sw)


@kernel(inline=True)
def sphere_load(j, gx, gy, gz, p):
    """The `Load` of a point on which the sphere acts by the force (gx, gy, gz) [N], of links and faces too."""
    push = math.sqrt(gx * gx + gy * gy + gz * gz)
    scale = 1.0 / push if push > 0.0 else 0.0
    return Load(j, True, push, scale * gx, scale * gy, scale * gz, p.svx, p.svy, p.svz)


@kernel(inline=True)
def add_pressed(p, j, part, fx, fy, fz):
    """Add a part of a force [N] of the sphere to that on point j."""
    if part > 0.0:
        n = p.rows * p.cols
        p.pressed[j] += part * fx
        p.pressed[n + j] += part * fy
        p.pressed[2 * n + j] += part * fz
        p.pressed[3 * n + j] = 1.0


@each_face()
def press_faces(place, x, v, t, p, with_damping):
    fx, fy, fz = push_on_face(v, p, place, with_damping)
    add_pressed(p, place.a, place.wa, fx, fy, fz)
    add_pressed(p, place.b, place.wb, fx, fy, fz)
    add_pressed(p, place.c, place.wc, fx, fy, fz)


@kernel(allocates=False)
def press(x, v, t, p, with_damping):
    """Set p.pressed to the forces of the sphere on the points, by themselves and through their faces."""
    n = p.rows * p.cols
    for i in range(4 * n):
        p.pressed[i] = 0.0
    for j in range(n):
        depth, nx, ny, nz = touching(x[j], x[n + j], x[2 * n + j], t, p, True)
        if depth > 0.0:
            load = load_of(Touch(j, True, depth, nx, ny, nz, p.svx, p.svy, p.svz), v, n, p, with_damping)
            add_pressed(p, j, load.push, nx, ny, nz)
            p.pressed[3 * n + j] = 1.0
    press_faces(x, v, t, p, with_damping)


SURFACE = """
    if {only}touches(x, t, p, {surface}):
        su, sv, sw = surface_velocity(p, {surface})
        for j in range(n):
            depth, nx, ny, nz = touching(x[j], x[n + j], x[2 * n + j], t, p, {surface})
            if depth > 0.0:
                {within}"""
# The force on each link is shared by the place of contact: (1 - s) to its first point and s to its second.
LINKS = """
    if links_near(x, t, p):
        bx = by = bz = 0.0
        is_touched = False
        for j in range(n):
            gx, gy, gz, is_loaded = bx, by, bz, is_touched
            bx = by = bz = 0.0
            is_touched = False
            if j + 1 < n:
                place = place_on_link(x, t, p, j)
                if place.depth > 0.0:
                    fx, fy, fz = push_on_link({velocities}, p, place, {with_damping})
                    bx, by, bz = place.s * fx, place.s * fy, place.s * fz
                    gx, gy, gz = gx + fx - bx, gy + fy - by, gz + fz - bz
                    is_loaded = is_touched = True
            if is_loaded:
                {within}"""
# Each force on a face is shared by the place of contact, too, so that it is summed over the faces of a point first.
FACES = """
    by_faces = face_reach(x, t, p) > 0.0
    if by_faces:
        press(x, {velocities}, t, p, {with_damping})
        for j in range(n):
            if p.pressed[3 * n + j] > 0.0:
                gx, gy, gz = p.pressed[j], p.pressed[n + j], p.pressed[2 * n + j]
                {within}"""
TOUCH = "Touch(j, {surface}, depth, nx, ny, nz, su, sv, sw)"
LOAD_OF_POINT = f"load_of({TOUCH}, {{velocities}}, n, p, {{with_damping}})"
LOAD_OF_SPHERE = "sphere_load(j, gx, gy, gz, p)"
ALONE = "not by_faces and "
NAMES = {
    "Touch": Touch, "touches": touches, "touching": touching, "surface_velocity": surface_velocity, "load_of": load_of,
    "links_near": links_near, "place_on_link": place_on_link, "push_on_link": push_on_link, "sphere_load": sphere_load,
    "face_reach": face_reach, "press": press,
}  # fmt: skip


def loop(
    function: Callable[..., Any], name: str, pieces: Sequence[tuple[str, dict[str, str]]], result: str, *, noalias: bool
) -> Any:
    """A kernel of the arguments of `function` after the first, which is `item` of each piece of source."""
    before, within, after = LOOPS[result]
    arguments = ", ".join(list(inspect.signature(function).parameters)[1:])
    source = [f"def {function.__name__}_{name}({arguments}):\n    {before}\n    n = p.rows * p.cols"]
    for piece, values in pieces:
        item = values["item"].format(**values)
        source.append(piece.format(within=within.format(call=f"visit({item}, {arguments})"), **values))
    visit = kernel(function, noalias=noalias, inline=True)
    names = {"visit": visit, **NAMES}
    return generated("".join([*source, f"\n    {after}"]), names, function.__module__, noalias=noalias, allocates=False)


def each_contact(result: str = "nothing", *, noalias: bool = False) -> Callable[[Callable[..., Any]], Any]:
    """Make a function of a touching point and other arguments, x, t and p among them, a kernel of these that calls it
    for every point that touches the floor by itself, then for every point that touches the sphere.

    The point is a `Touch`. result: a key of LOOPS. noalias: as of `kernel`.
    """

    def made(function: Callable[..., Any]) -> Any:
        pieces = [(SURFACE, {"surface": surface, "item": TOUCH, "only": ""}) for surface in ("False", "True")]
        return loop(function, "of_contacts", pieces, result, noalias=noalias)

    return made


def each_load(result: str = "nothing", *, noalias: bool = False) -> Callable[[Callable[..., Any]], Any]:
    """As `each_contact`, for every point that a surface presses, by its links or faces too. The point is a `Load`.

    The force has its damping if the velocities v are among the arguments; without them u stands in their place.
    """

    def made(function: Callable[..., Any]) -> Any:
        damped = "v" in inspect.signature(function).parameters
        values = {"velocities": "v" if damped else "u", "with_damping": str(damped)}
        of_point = {"item": LOAD_OF_POINT, "only": "", **values}
        on_floor, on_sphere = (SURFACE, {"surface": "False", **of_point}), (SURFACE, {"surface": "True", **of_point})
        by_links = LINKS, {"item": LOAD_OF_SPHERE, **values}
        of_chain = loop(function, "of_loads_and_links", [on_floor, on_sphere, by_links], result, noalias=noalias)
        by_faces, alone = (FACES, {"item": LOAD_OF_SPHERE, **values}), (SURFACE, {**on_sphere[1], "only": ALONE})
        of_wide = loop(function, "of_loads_and_faces", [on_floor, by_faces, alone], result, noalias=noalias)
        return by_net(rope=of_chain, grid=of_wide, strand=of_chain)

    return made
