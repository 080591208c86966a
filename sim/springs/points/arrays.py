"""The kernels' records of a net, and kernels that depend on its class."""

from collections import namedtuple
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import chosen, kernel
from sim.springs.laws.curve import TensionCurve
from sim.springs.points.line_arrays import LineArrays


class RopeArrays(NamedTuple):
    """Kernel data of a chain: points in one row or one column, each linked to the next alone, that never touch."""

    rows: int  # 1, of a column too
    cols: int
    inverse_masses: NDArray[np.float64]  # (rows cols,) inverse masses [1/kg], 0 where pinned
    mass: NDArray[np.float64]  # (rows cols,) [kg], of pinned points too
    drag: float  # [N s/m] per point
    gx: float  # gravity [m/s^2]
    gy: float
    gz: float
    offsets: NDArray[np.int64]  # (families, 2)
    families: NDArray[np.float64]  # (families, 3): rest, stiffness, damping
    law: Any  # numbers of the links' law, see sim/springs/laws
    conserves_momentum: bool  # nothing acts from outside but gravity
    conserves_spin: bool  # and all forces point along links: the angular momentum stays as well
    forces: Any  # `Declared`: numbers of the forces that have any, see sim/springs/forces
    damped: bool  # any link damping
    axial: bool
    has_floor: bool
    floor: float  # [m] where points meet it
    has_sphere: bool
    links_touch: bool  # the links meet it, not the points
    sx: float  # sphere centre at time `epoch` [m]
    sy: float
    sz: float
    sr: float  # radius at which points and links meet it [m]
    svx: float  # sphere velocity [m/s]
    svy: float
    svz: float
    epoch: float  # [s]
    contact_k: float
    contact_b: float
    friction: float
    stop_rate: float  # 1/h [1/s]: friction stops a point within the step, if it can
    lab_contact: bool
    held: NDArray[np.float64]  # (2, 3, rows cols) accelerations by friction of floor and sphere, flat; (0,) without it
    load: NDArray[np.float64]  # (2, 3, rows cols) accelerations by all other forces, which friction holds against
    load_is: NDArray[np.int64]  # (1,) CURRENT, NOTED or FIXED, see sim/springs/forces/friction.py
    pins: NDArray[np.int64]  # (pins,) flat indices of the moving ones
    paths: NDArray[np.float64]  # (pins, 5, 3): four coefficients, and the start time in [4, 0]
    grabbed: int  # flat index, -1: none
    grab_x: float
    grab_y: float
    grab_z: float
    grab_k: float
    grab_b: float
    grab_max: float
    stop: NDArray[np.int64]  # (2,) that ends a long solve, see sim.interruption


class TouchArrays(NamedTuple):
    """Extra kernel data of nets that may touch themselves, see `sim.springs.near.near_pairs`."""

    thickness: float  # [m] at which particles, or links of a chain, push each other, 0: never
    row_spacing: float  # [m] at rest from row to row, FARTHEST where no link says it
    col_spacing: float
    # (most + 1, 2): those within reach, their number in [-1, 0], -1: not yet looked for; in [-1, 1] the most particles
    # or links, or cells of a cloth, that were left out as a list was full
    pairs: NDArray[np.int64]
    seen: NDArray[np.float64]  # (3 rows cols,) positions when the pairs were found
    nearest: NDArray[np.float64]  # (1,) the least distance [m] of any pair then, 0 if it is not known
    looks: NDArray[np.int64]  # (1,) number of pairs that loops came to since the last check of p.stop


class StepArrays(NamedTuple):
    """Extra kernel data of chains and cloths that touch themselves, see `sim.springs.kicks.apart`."""

    last: NDArray[np.float64]  # (3 rows cols,) positions at the start of a step
    between: NDArray[np.float64]  # (12,) those of a pair within a step: x, y, z of its four points


class RubArrays(NamedTuple):
    """Extra kernel data of chains that touch themselves, see `sim.springs.forces.strand_friction`."""

    # (most + 1, 2): pairs of links that touch; in [-1] their number and that of the last kick, -1: no list yet
    touching: NDArray[np.int64]
    rubs: NDArray[np.float64]  # (most, 14): their places, distance and normals, mobility, and friction
    last_rubs: NDArray[np.float64]  # (most, 5): those of the last kick: first points, and friction on the second [N]


class CellArrays(NamedTuple):
    """Extra kernel data of cloths that touch themselves, see `sim.springs.near.near_cells`."""

    # (most + 1, 3): pairs that may meet, and the kind of each; their number in [-1, 0], -1: there is no list yet, and
    # that of FAR ones, which come first, in [-1, 1]
    near: NDArray[np.int64]
    near_gaps: NDArray[np.float64]  # (most,) lower bound of the distance [m] of each when the list was made
    listed: NDArray[np.float64]  # (3 rows cols,) positions at the end of the step in which the list was made
    joined: NDArray[np.float64]  # the same for the list of neighbours, which is made more often
    moved: NDArray[np.float64]  # (4,) `motion_since` at the start of the step and at its end, inf: not known
    reach: NDArray[np.float64]  # (3,) distance [m] within which pairs of each kind are listed
    clear: NDArray[np.float64]  # (3,) lower bound of the distance [m] of all then
    closing: NDArray[np.float64]  # (3,) [m], see `set_closing`


LISTS = ("pairs", "seen", "nearest", "looks", *CellArrays._fields)  # lists of what is near, with the data for renewing


class WideArrays(NamedTuple):
    """Further kernel data of nets that are no chains."""

    has_air: bool
    faces_touch: bool  # the faces touch the sphere, beside the points
    face_depth: float  # [m] below the sphere's surface, where faces meet it
    # (4, rows cols): force of the sphere on each point [N], and 1 where it is touched, flat; (0,) without friction
    pressed: NDArray[np.float64]
    wind_x: float  # [m/s]
    wind_y: float
    wind_z: float
    air_drag: float  # rho C_D / 2 [kg/m^3]
    air_lift: float
    bands: int  # number of bands of rows; each thread computes the forces of one band
    side: float  # stiffness and damping of links along a side, over their family's
    ends: NDArray[np.int64]  # (links, 3): both points of each, and its family
    links: NDArray[np.float64]  # (links, 3): rest length [m], stiffness [N/m], damping [N s/m] of each


# A chain that touches itself, a net of any families of links, and one of those of CLOTH. A kernel is compiled for each
# of the four classes of arrays, with no more than nets of that class can need: numba tells them apart by their types.
StrandArrays = namedtuple(
    "StrandArrays", RopeArrays._fields + TouchArrays._fields + StepArrays._fields + RubArrays._fields
)
GridArrays = namedtuple("GridArrays", RopeArrays._fields + TouchArrays._fields + WideArrays._fields)
ClothArrays = namedtuple("ClothArrays", GridArrays._fields + StepArrays._fields + CellArrays._fields)


def by_net(rope: Any, grid: Any, cloth: Any = None, lines: Any = None, strand: Any = None) -> Any:
    """A kernel that stands for one of these, by the class of its argument p.

    cloth, strand: None for that of any other net. lines: those under water; None if they have no such kernel.
    """
    variants = {RopeArrays: rope, GridArrays: grid, ClothArrays: cloth or grid, StrandArrays: strand or grid}
    return chosen(variants if lines is None else {**variants, LineArrays: lines})


# Mass of point j [kg].
mass_at = kernel(lambda p, j: p.mass[j], inline=True)

every_point = kernel(lambda p: p.rows * p.cols, inline=True)
# Number of points that forces act on. Of lines two more a body follow, for its displacement and its rotation.
point_count = by_net(rope=every_point, grid=every_point, lines=kernel(lambda p: p.nodes, inline=True))

is_free = kernel(lambda p, j: p.inverse_masses[j] > 0.0, inline=True)
# True unless the motion of point j is prescribed.
is_moving = by_net(rope=is_free, grid=is_free, lines=kernel(lambda p, j: p.moving[j], inline=True))


@kernel(inline=True)
def push_mass(p, a, j, fx, fy, fz):
    n, j = np.uint64(p.rows * p.cols), np.uint64(j)
    w = p.inverse_masses[j]
    a[j] += w * fx
    a[n + j] += w * fy
    a[n + n + j] += w * fz


@kernel(inline=True)
def push_node(p, a, j, fx, fy, fz):
    n, j = np.uint64(p.cols), np.uint64(j)
    a[j] += fx
    a[n + j] += fy
    a[n + n + j] += fz


# Add a force [N] on point j to what `accelerate` sums in a: accelerations, but of lines, whose masses in water are
# matrices, forces.
push = by_net(rope=push_mass, grid=push_mass, lines=push_node)


class Link(NamedTuple):
    """A row of the table of links."""

    number: int
    a: int  # its points
    b: int
    family: int  # 0 of lines
    rest: float  # [m]
    stiffness: float  # [N/m]
    damping: float  # [N s/m]
    law: Any  # numbers of its law


@kernel(inline=True)
def next_link(p, q):
    return Link(q, q, q + 1, 0, p.families[0, 0], p.families[0, 1], p.families[0, 2], p.law)


@kernel(inline=True)
def listed_link(p, q):
    return Link(q, p.ends[q, 0], p.ends[q, 1], p.ends[q, 2], p.links[q, 0], p.links[q, 1], p.links[q, 2], p.law)


@kernel(inline=True)
def link_of_line(p, q):
    law = TensionCurve(p.curves, p.links[q, 3], p.links[q, 4], p.slack_damping)
    return Link(q, p.ends[q, 0], p.ends[q, 1], 0, p.links[q, 0], p.links[q, 1], p.links[q, 2], law)


listed = kernel(lambda p: p.ends.shape[0], inline=True)
# Number of links, and link q.
beside = kernel(lambda p: p.cols - 1, inline=True)
link_count = by_net(rope=beside, grid=listed, lines=listed, strand=beside)
link_at = by_net(rope=next_link, grid=listed_link, lines=link_of_line, strand=next_link)


@kernel(inline=True)
def span(x, n, a, b):
    """(x, y, z) from point a to point b, of positions or velocities x (3 n,)."""
    n, a, b = np.uint64(n), np.uint64(a), np.uint64(b)  # unsigned, as in `sim.springs.points.acceleration`
    return x[b] - x[a], x[n + b] - x[n + a], x[n + n + b] - x[n + n + a]


@kernel(inline=True)
def add_pair(out, n, a, b, fx, fy, fz):
    """Add (fx, fy, fz) at point a and take it at point b."""
    n, a, b = np.uint64(n), np.uint64(a), np.uint64(b)
    out[a] += fx
    out[n + a] += fy
    out[n + n + a] += fz
    out[b] -= fx
    out[n + b] -= fy
    out[n + n + b] -= fz
