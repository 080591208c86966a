"""Places of a cloth's faces that are nearest to the sphere, and `each_face`: the loop over the faces that touch it."""

import inspect
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from sim.jit import generated, kernel
from sim.springs.points.arrays import span
from sim.springs.points.cells import FACES, cell_at, face_corners
from sim.springs.points.each_link import LOOPS
from sim.springs.points.link_places import contact_force, sphere_gap, touching
from sim.springs.points.order import in_turn
from sim.springs.points.places import dot, face_parts

# Stiffness and damping of a face over those of a point: two faces that share the edge under the sphere push as a point.
FACE_PART = 0.5
# Depth of the surface that faces touch, over the sphere's radius. A cell whose corners are on the sphere does not
# reach it if its diagonal is shorter than 0.62 radii.
FACE_DEPTH = 0.05
USUAL_STRETCH = 1.5  # length over that at rest of a cell's side, above which the exact bound is looked for
ROUND_OFF = 1e-15  # part of a corner in a place on the opposite side


class FacePlace(NamedTuple):
    """The place of a face that is nearest to the sphere's centre."""

    a: int  # corners
    b: int
    c: int
    wa: float  # their parts of the place, which sum to 1
    wb: float
    wc: float
    depth: float  # [m] below the surface that faces touch, above 0 in contact
    nx: float  # normal of the sphere
    ny: float
    nz: float


@kernel(noalias=True, inline=True)
def longest_side(x, n, stride, start, stop):
    """Largest squared length of sides from the points `start` up to `stop` to those `stride` further."""
    most = 0.0
    for j in range(start, stop):
        i = j + stride
        dx, dy, dz = x[i] - x[j], x[n + i] - x[n + j], x[n + n + i] - x[n + n + j]
        most = max(most, dx * dx + dy * dy + dz * dz)
    return most


@kernel(noalias=True, inline=True)
def count_longer(x, n, stride, start, stop, square):
    """Number of these sides that are longer than the root of a square [m2].

    A count vectorises. A maximum does not, as NaN must stay visible.
    """
    count = 0
    for j in range(start, stop):
        i = j + stride
        dx, dy, dz = x[i] - x[j], x[n + i] - x[n + j], x[n + n + i] - x[n + n + j]
        count += dx * dx + dy * dy + dz * dz > square
    return count


@kernel(noalias=True, inline=True)
def count_nearer(x, n, t, p, square):
    """Number of points nearer to the sphere's centre than the root of a square [m2]."""
    count, s = 0, t - p.epoch
    cx, cy, cz = p.sx + s * p.svx, p.sy + s * p.svy, p.sz + s * p.svz
    for j in range(n):
        dx, dy, dz = x[j] - cx, x[n + j] - cy, x[n + n + j] - cz
        count += dx * dx + dy * dy + dz * dz < square
    return count


@kernel(inline=True)
def reach_of_sides(p, down, right):
    """Square [m2] of the distance from the centre within which touching faces with sides of these squares have corners.

    With corners at D or more and sides of L or less a face is no nearer than (D^2 - L^2/3)^(1/2). No diagonal is
    longer than two sides together.
    """
    radius = p.sr - p.face_depth
    return radius * radius + (down + right + 2.0 * math.sqrt(down * right)) / 3.0


@kernel(noalias=True, allocates=False)
def face_reach(x, t, p):
    """Square [m2] of a distance from the sphere's centre within which each touching face has a corner; 0: none does."""
    if not p.faces_touch:
        return 0.0
    n, cols, one = np.uint64(p.rows * p.cols), np.uint64(p.cols), np.uint64(1)
    # First a quick look, as most cloths are far from the sphere or have cells that are small beside it.
    usual = (USUAL_STRETCH * max(p.row_spacing, p.col_spacing)) ** 2
    count = count_nearer(x, n, t, p, reach_of_sides(p, usual, usual))
    count += count_longer(x, n, cols, np.uint64(0), n - cols, usual)
    for row in range(np.uint64(p.rows)):
        count += count_longer(x, n, one, row * cols, row * cols + cols - one, usual)
    if count == 0:
        return 0.0
    down, right = longest_side(x, n, cols, np.uint64(0), n - cols), 0.0
    for row in range(np.uint64(p.rows)):
        right = max(right, longest_side(x, n, one, row * cols, row * cols + cols - one))
    reach = reach_of_sides(p, down, right)
    return reach if sphere_gap(x, n, t, p) + p.sr * p.sr < reach else 0.0


@kernel(noalias=True, inline=True)
def nearest_square(x, t, p, start, stop):
    """Least squared distance [m2] of the points from `start` up to `stop` from the sphere's centre."""
    n, least, s = np.uint64(p.rows * p.cols), math.inf, t - p.epoch
    cx, cy, cz = p.sx + s * p.svx, p.sy + s * p.svy, p.sz + s * p.svz
    for j in range(np.uint64(start), np.uint64(stop)):
        dx, dy, dz = x[j] - cx, x[n + j] - cy, x[n + n + j] - cz
        least = min(least, dx * dx + dy * dy + dz * dz)
    return least


@kernel(inline=True)
def row_distance(x, t, p, row):
    """Least squared distance [m2] of the corners of a row of cells from the sphere's centre."""
    return nearest_square(x, t, p, row * p.cols, (row + 2) * p.cols)


@kernel(inline=True)
def cell_distance(x, t, p, row, col):
    """The same of one cell."""
    start, cols = row * p.cols + col, p.cols
    return min(nearest_square(x, t, p, start, start + 2), nearest_square(x, t, p, start + cols, start + cols + 2))


@kernel(inline=True)
def place_on_face(x, t, p, cell, face):
    """The `FacePlace` of a face of a cell."""
    n, s = p.rows * p.cols, t - p.epoch
    a, b, c = face_corners(cell, face)
    ax, ay, az = x[a], x[n + a], x[2 * n + a]
    px, py, pz = p.sx + s * p.svx - ax, p.sy + s * p.svy - ay, p.sz + s * p.svz - az
    bx, by, bz = span(x, n, a, b)
    cx, cy, cz = span(x, n, a, c)
    wb, wc = face_parts(
        dot(px, py, pz, bx, by, bz), dot(px, py, pz, cx, cy, cz), dot(bx, by, bz, bx, by, bz),
        dot(bx, by, bz, cx, cy, cz), dot(cx, cy, cz, cx, cy, cz),
    )  # fmt: skip
    wa = 1.0 - wb - wc
    if wa < ROUND_OFF:
        wa = 0.0
    depth, nx, ny, nz = touching(
        ax + wb * bx + wc * cx, ay + wb * by + wc * cy, az + wb * bz + wc * cz, t, p, True
    )  # fmt: skip
    return FacePlace(a, b, c, wa, wb, wc, depth - p.face_depth, nx, ny, nz)


@kernel(inline=True)
def face_motion(v, p, place):
    """Velocity or acceleration of a place of a face."""
    n, a, b, c = p.rows * p.cols, place.a, place.b, place.c
    wa, wb, wc = place.wa, place.wb, place.wc
    return (
        wa * v[a] + wb * v[b] + wc * v[c],
        wa * v[n + a] + wb * v[n + b] + wc * v[n + c],
        wa * v[2 * n + a] + wb * v[2 * n + b] + wc * v[2 * n + c],
    )


@kernel(inline=True)
def face_slip(v, p, place):
    """Velocity [m/s] of a place of a face relative to the sphere."""
    u, q, r = face_motion(v, p, place)
    return u - p.svx, q - p.svy, r - p.svz


@kernel(inline=True)
def push_on_face(v, p, place, with_damping):
    """Normal force (3,) [N] of the sphere on a touching face."""
    u, q, r = face_slip(v, p, place)
    fx, fy, fz = contact_force(place.depth, place.nx, place.ny, place.nz, u, q, r, p, True, with_damping)
    return FACE_PART * fx, FACE_PART * fy, FACE_PART * fz


@kernel(allocates=False)
def next_face(x, t, p, reach, turn, reverse):
    """The next turn after the face that touches the sphere in this turn or the first one later, and its `FacePlace`.

    The turn is -1 if no more faces touch. Each face of each cell has its turn, row by row. reach: of `face_reach`.
    """
    of_row = FACES * (p.cols - 1)
    count = of_row * (p.rows - 1)
    while turn < count:
        number = in_turn(turn, count, reverse)
        row, col, face = number // of_row, number % of_row // FACES, number % FACES
        if turn % of_row == 0 and row_distance(x, t, p, row) >= reach:
            turn += of_row
        elif turn % FACES == 0 and cell_distance(x, t, p, row, col) >= reach:
            turn += FACES
        else:
            turn += 1
            place = place_on_face(x, t, p, cell_at(p, row, col), face)
            if place.depth > 0.0:
                return turn, place
    return -1, FacePlace(0, 0, 0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def each_face(result: str = "nothing", *, noalias: bool = False) -> Callable[[Callable[..., Any]], Any]:
    """Make a function of a `FacePlace` and other arguments, x, t and p among them, a kernel of these that calls it for
    every face that touches the sphere.

    If `reverse` is among the arguments, True is the order from the last face to the first. result: a key of LOOPS.
    noalias: as of `kernel`.
    """
    before, within, after = LOOPS[result]

    def made(function: Callable[..., Any]) -> Any:
        names = list(inspect.signature(function).parameters)[1:]
        arguments, order = ", ".join(names), "reverse" if "reverse" in names else "False"
        lines = [
            f"def {function.__name__}_of_faces({arguments}):",
            f"    {before}",
            "    reach, face_turn = face_reach(x, t, p), 0",
            "    while reach > 0.0:",
            f"        face_turn, place = next_face(x, t, p, reach, face_turn, {order})",
            "        if face_turn < 0:",
            "            break",
            f"        {within.format(call=f'visit(place, {arguments})')}",
            f"    {after}",
        ]
        visit = kernel(function, noalias=noalias, inline=True)
        used = {"visit": visit, "face_reach": face_reach, "next_face": next_face}
        return generated("\n".join(lines), used, function.__module__, noalias=noalias, allocates=False)

    return made
