"""Linear hydrodynamics of a floating hull: added mass, radiation damping, wave excitation, memory of radiated waves.

The coefficients come from boundary elements (`boundary_elements.py`), as tables by draft in `tables`. A box, an upright
cylinder and a sphere are in the tables at every size: to the water a hull is its wet part. A hull from a file may have
a table of its own (`springtide hydrodynamics`). Other hulls use, as an approximation, the coefficients of a box of
equal volume and waterplane moments.

**Long waves.** The water about a hull that is short beside the wave moves as one, and its surface is a plane. The force
is that of the plane on the hull, plus the mass displaced and the added mass times the acceleration of the water (Taylor
1928, Proc. R. Soc. A 120:260). So a free hull moves with the water: 1 m/m, and the slope of the wave. The remainder of
X is O(k^2), and is extrapolated as k^2 or faster below the table. There the added mass is that of the first frequency,
and the damping is that of the waves that the hull makes, which follows from X (`haskind`).

Cummins (1962): (M + A_inf) a + int K(t - s) v(s) ds + C x = F. The transform of K is B + i w (A - A_inf); here it is a
sum over the same few poles for all entries, so that the memory is a small state: s' = p s + v, force -2 Re(R s). The
residues R are fitted, best where the hull's own frequencies lie, under the condition that a steady motion is free.
"""

import functools
import math
import warnings
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sim.dispersion import group_speed, omega, wavenumber
from sim.floating.hulls.closed_mesh import ClosedMesh, area_vectors
from sim.floating.hulls.hull import Hull
from sim.floating.linear.linear_table import LinearTable, table_of
from sim.floating.statics.equilibrium import SEA_WATER, Layers, equilibrium_draft, upright
from sim.floating.statics.hydrostatics import AT_SURFACE, Submerged, add_pressure, displaced
from sim.interruption import pieces, raise_if_stopped
from sim.validation import ApproximationWarning, ConvergenceError, argument_error
from sim.water import SAME_WATER

# Poles of the memory in units of sqrt(g/length); chosen once for the least error over all tables
POLES = np.array([-0.362 + 0.419j, -0.408 + 0.850j, -0.311 + 1.274j, -1.344 + 1.128j, -1.127 + 4.227j])
DIRECTIONS = np.radians(np.arange(0.0, 360.0, 10.0))  # in which waves run, of the excitation
FIT_WIDTH = 0.12  # fraction of a hull's own frequency about which the memory is fitted best
FIT_FLOOR = 0.06  # weight of the other frequencies
STEADY_WEIGHT = 30.0  # of the condition that a steady motion meets no force
DEEPEST = 0.98  # of the height of a hull: the draft at which one that is wholly under water has its coefficients
ONE_DRAFT = 0.01  # by how much a body's draft may differ from the only one of its table
MAX_TURNS = 60  # of the search for a natural frequency
PIECE = 64  # waves at a time: the solve yields in between
BEYOND = 1.0  # [lengths] of 1/k over which the force fades beyond the highest frequency of a table
LONG_NODES = 3  # frequencies of a table, up to which the force of long waves is taken off before interpolation
LONG_POWERS = np.array([1.0, 1.0, 1.0, 1.0, 1.0, 2.0])  # of k, by which what is left is divided there
# Of k, by which the rest at the first frequency fades below it: faster than by its law, since it is small, and wrong
# where a hull has the coefficients of a box
FADING_POWER = 3.0
YAW = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
LEVEL_MOTIONS = [0, 1, 5]  # surge, sway, yaw: water that is higher, and level, does not push along them
# Signs of the motions under a mirror that turns x, or y
MIRROR_X = np.array([-1.0, 1.0, 1.0, 1.0, -1.0, -1.0])
MIRROR_Y = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])


TABLED = ("box", "cylinder", "sphere")  # shapes that have tables
MAX_UNLIKE = 1.5  # factor between the sizes of such a hull and of its box
LEAST_PART = 1e-3  # of the area of a waterplane, below which a part of it does not count
ADVICE = "`with_dataset` takes a table by Capytaine, and `springtide hydrodynamics` makes one for a mesh file"


class PlaneForce(NamedTuple):
    """Force and moment (6,) on an upright hull under a plane, at unit density and gravity."""

    rise: np.ndarray  # for each metre that it rises
    slope: np.ndarray  # (2, 6) for each unit of slope along x, y


class LongWaveForce(NamedTuple):
    """Force and moment (6,) of a wave a cos(k.x - wt) that is long beside the hull.

    X = rise + w^2/g lift + i (kx run[0] + ky run[1]) to first order of k, at unit density and gravity; w^2/g is k in
    deep water. The yaw moment also has the term kx ky twist: the only one of a hull with two equal sides.
    """

    rise: np.ndarray
    lift: np.ndarray  # [for each rad/m]
    run: np.ndarray  # (2, 6) the same
    twist: float  # [m5]

    def at(self, kx: np.ndarray, ky: np.ndarray, depth: float) -> np.ndarray:
        """X (..., 6) of wavenumbers kx, ky (...) [rad/m] in water of a depth [m]."""
        kx, ky = kx[..., None], ky[..., None]
        upward = omega(np.hypot(kx, ky), 1.0, depth) ** 2
        return self.rise + upward * self.lift + 1j * (kx * self.run[0] + ky * self.run[1]) + kx * ky * self.twist * YAW


class LinearHull(NamedTuple):
    """Linear coefficients of one hull afloat, at unit density and gravity, about its centre of mass, in its own axes.

    A motion is (3) along and (3) about the axes; frequencies are omega/sqrt(g).
    """

    frequency: np.ndarray  # (n,) [1/sqrt(m)]
    added_mass: np.ndarray  # (n, 6, 6) [m3 to m5]
    damping: np.ndarray  # (n, 6, 6) over sqrt(g)
    infinite: np.ndarray  # (6, 6) added mass at infinite frequency
    # (n, 36, 6) over g: force X of a wave a cos(k.x - wt) that runs in one of DIRECTIONS: a Re(X exp(i (k.x - wt)))
    excitation: np.ndarray
    length: float  # [m] of the hull, by which poles are scaled
    draft: float  # [m]
    volume: float  # [m3] displaced
    is_round: bool  # seen from above: the excitation does not depend on the heading
    plane: PlaneForce  # of a plane on the hull at this draft
    long: LongWaveForce
    depth: float  # [m] of the water, inf for deep water
    heading: float  # [rad] the only heading with excitation data; nan: all headings

    @property
    def directions(self) -> np.ndarray:
        """The directions [rad] of the waves of the excitation (36,)."""
        return DIRECTIONS if math.isnan(self.heading) else np.full(len(DIRECTIONS), self.heading)

    def wavenumber(self, frequency: np.ndarray) -> np.ndarray:
        """Wavenumber [rad/m] of waves of frequencies [1/sqrt(m)] in the water that the coefficients are of."""
        return wavenumber(frequency, 1.0, self.depth)

    def at(self, frequency: float) -> tuple[np.ndarray, np.ndarray]:
        """Added mass and damping (6, 6) at a frequency [1/sqrt(m)].

        Beyond the table they are those of its end; below it the damping is that of the waves that the hull makes.
        """
        first, last = float(self.frequency[0]), float(self.frequency[-1])
        nodes, weights = lagrange(self.frequency, min(max(frequency, first), last))
        a = np.tensordot(weights, self.added_mass[nodes], 1)
        if frequency >= first:
            return a, np.tensordot(weights, self.damping[nodes], 1)
        k = self.wavenumber(np.array([frequency]))
        if math.isnan(self.heading):
            return a, haskind(self.around(k)[0], float(k[0]), self.depth)
        k_first = float(self.wavenumber(np.array([first]))[0])
        ratio = radiated_share(float(k[0]), self.depth) / radiated_share(k_first, self.depth)
        return a, ratio * self.damping[0]  # as if the forces were those of the first frequency

    def around(self, k: np.ndarray) -> np.ndarray:
        """X (waves, 36, 6) of waves in DIRECTIONS against the hull, for wavenumbers k (waves,) [rad/m], over g."""
        rest, is_long = self.beyond_long_waves(k)
        kx, ky = k[:, None] * np.cos(self.directions), k[:, None] * np.sin(self.directions)
        return rest + is_long[:, None, None] * self.long.at(kx, ky, self.depth)

    def beyond_long_waves(self, k: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """X (waves, 36, 6) as `around`, less that of long waves where is_long (waves,) is 1, and not 0.

        Above the table it fades with the shortness of the wave beside the hull.
        """
        nodes = self.wavenumber(self.frequency)
        is_long = (k < nodes[LONG_NODES - 1]).astype(float)
        cosine, sine = np.cos(self.directions), np.sin(self.directions)
        beyond = self.excitation - self.long.at(nodes[:, None] * cosine, nodes[:, None] * sine, self.depth)
        scaled = (beyond / nodes[:, None, None] ** LONG_POWERS).reshape(len(nodes), -1)
        powers = np.tile(LONG_POWERS, len(DIRECTIONS))
        index, weights = lagrange(self.frequency, np.minimum(omega(k, 1.0, self.depth), self.frequency[-1]))
        table, rest = self.excitation.reshape(len(nodes), -1), np.empty((len(k), scaled.shape[1]), complex)
        for piece in pieces(len(k), PIECE):
            for i, one in enumerate(k[piece].tolist(), start=piece.start):
                if one < nodes[0]:
                    rest[i] = (one / nodes[0]) ** FADING_POWER * beyond[0].ravel()
                elif is_long[i]:
                    rest[i] = one**powers * (weights[i] @ scaled[index[i]])
                else:
                    fade = math.exp(-max(one - nodes[-1], 0.0) * self.length * BEYOND)
                    rest[i] = fade * (weights[i] @ table[index[i]])
        return rest.reshape(len(k), len(DIRECTIONS), 6), is_long


def radiated_share(k: float, depth: float) -> float:
    """k/(4 v) [1/m^1.5], v over sqrt(g) the group velocity, of waves of wavenumber k [rad/m] at a depth [m]."""
    return k / (4.0 * float(group_speed(np.array(k), 1.0, depth)))


def haskind(X: np.ndarray, k: float, depth: float) -> np.ndarray:
    """Damping (6, 6) over sqrt(g) of the forces X (36, 6) over g in DIRECTIONS; wavenumber k [rad/m], depth [m].

    B = k/(8 pi rho g v) int X X* d beta, v the group velocity (Newman 1977, section 6.18, eq. 173).
    """
    return radiated_share(k, depth) * np.einsum("di,dj->ij", X, X.conj()).real / len(X)


class Memory(NamedTuple):
    """The memory of a hull's radiated waves, at unit density and gravity."""

    poles: np.ndarray  # (p,) complex
    residues: np.ndarray  # (p, 6, 6) complex

    def slow_added_mass(self) -> np.ndarray:
        """Addition (6, 6) to the added mass at infinite frequency in a motion far slower than its poles."""
        return -2.0 * np.einsum("pij,p->ij", self.residues, self.poles**-2.0).real


class TablePlace(NamedTuple):
    """The table of a hull at a draft, and the place in it."""

    table: LinearTable
    aspect: float  # length over width, at least 1
    depth: float  # draft over `length`
    length: float  # [m] that the table is in units of
    is_turned: bool  # the long side lies along y, in the tables along x
    is_round: bool


def place_in_table(hull: Hull, draft: float) -> TablePlace:
    """The table of a hull and its place in it, upright at a draft [m] below its height."""
    shape = hull.shape
    x, y = (float(value) for value in hull.size[:2])
    if shape.table is not None:
        length = table_length(hull)
        return TablePlace(shape.table, 1.0, draft / length, length, False, False)
    if shape.linear in ("cylinder", "sphere"):
        return TablePlace(table_of(shape.linear), 1.0, 2 * draft / x, x / 2, False, True)
    if shape.linear != "box":
        cut = upright(hull, draft)
        x, y = (math.sqrt(12 * max(second, 1e-9) / max(cut.area, 1e-9)) for second in cut.second[:2])
        draft = cut.volume / (x * y)
    length = math.sqrt(x * y) / 2
    return TablePlace(table_of("box"), max(x / y, y / x), draft / length, length, x < y, False)


def is_sunken(hull: ClosedMesh, draft: float) -> bool:
    """True for a hull that is wholly under water at a draft [m], deeper than with its deck in the surface."""
    return draft > (1.0 + AT_SURFACE) * float(hull.size[2])


def outside_table(hull: Hull, draft: float) -> str:
    """The words for a hull that floats upright at a draft [m] outside its table of coefficients; "" for one inside.

    A hull that is wholly under water makes no waves at the surface, and is never outside. Nor is one without a table of
    its own that nearly is.
    """
    if is_sunken(hull, draft) or (hull.shape.table is None and draft >= DEEPEST * float(hull.size[2])):
        return ""
    place, beyond = place_in_table(hull, draft), []
    for name, value, nodes in (
        ("length over width", place.aspect, place.table.aspect),
        ("draft over half the width", place.depth, place.table.draft),
    ):
        low, high = float(nodes[0]), float(nodes[-1])
        margin = 1e-9 if len(nodes) > 1 or name != "draft over half the width" else ONE_DRAFT
        if not low * (1 - margin) <= value <= high * (1 + margin):
            beyond.append(f"{name} {value:.3g} (table: {low:g} to {high:g})")
    return " and ".join(beyond)


def check_water_depth(name: str, hull: Hull, depth: float) -> None:
    """Raises ValueError for a hull with a dataset of water of a finite depth in water of another one [m].

    A dataset of deep water is right for waves that are short for the depth: in water of a finite depth an
    `ApproximationWarning` says so. Tables of deep water without a density are those of shapes, for any depth.
    """
    table = hull.shape.table
    if table is None:
        return
    own = table.depth * table_length(hull)
    if math.isinf(own):
        if math.isinf(depth) or math.isnan(table.density):
            return
        words = f"{name}: a hull with a dataset of water inf m deep, in water of {depth:.6g} m"
        right = f"its coefficients are right for waves up to {2.0 * depth:.3g} m long"
        warnings.warn(f"{words}; {right}", ApproximationWarning, stacklevel=3)
    elif not abs(depth - own) <= SAME_WATER * own:
        description = f"a hull with a dataset of water {own:.6g} m deep, in water of {depth:.6g} m"
        raise argument_error(name, description, "water of the dataset's depth, or a dataset of the water's")


def check_bed(name: str, hull: Hull, draft: float, depth: float) -> None:
    """Raises ValueError for a hull that is afloat at a draft [m] in water of a depth [m] that is less."""
    if min(draft, float(hull.size[2])) > depth:
        description = f"a hull of draft {draft:.6g} m, in water {depth:.6g} m deep"
        raise argument_error(name, description, "water that is deeper than its draft")


def is_boxed(hull: Hull, draft: float) -> bool:
    """True for a hull that has the coefficients of a box in place of its own."""
    return hull.shape.table is None and hull.shape.linear not in TABLED and not is_sunken(hull, draft)


def box_of(hull: Hull, draft: float) -> tuple[float, float, float]:
    """Length, width and draft [m] of the box whose coefficients a hull has at a draft [m]."""
    place = place_in_table(hull, draft)
    x = 2.0 * place.length * math.sqrt(place.aspect) ** (-1 if place.is_turned else 1)
    return x, 4.0 * place.length**2 / x, place.depth * place.length


def check_box(name: str, hull: Hull, draft: float) -> None:
    """Raises ValueError for a hull that no box stands for: in several parts at the waterline, or far from its box.

    Length, width and draft of the box may differ from those of the hull by a factor of 1.5.
    """
    if not is_boxed(hull, draft):
        return
    parts, size = waterplane_of(hull, draft)
    box, own = box_of(hull, draft), (*size, draft)
    differences = [f"{parts} parts at the waterline"] if parts > 1 else []
    for quantity, a, b in zip(("length", "width", "draft"), box, own, strict=True):
        if not MAX_UNLIKE**-1 * b <= a <= MAX_UNLIKE * b:
            differences.append(f"a {quantity} of {b:.3g} m, and the box with its volume and waterplane {a:.3g} m")
    if differences:
        allowed = "a hull with coefficients of its own: `springtide hydrodynamics FILE` computes them"
        raise argument_error(
            name, f"{hull.shape.name} with {'; '.join(differences)}", f"{allowed}, `with_dataset` reads them"
        )


def waterplane_of(hull: ClosedMesh, draft: float) -> tuple[int, tuple[float, float]]:
    """Number of parts of the waterplane of an upright hull at a draft [m], and its extents [m] along x and y.

    Faces that the surface cuts are the sides of loops; those around water inside the hull run the other way.
    """
    level = float(hull.extents[2, 0]) + draft
    height = hull.vertices[:, 2] - level
    wet = height < 0.0
    cut = hull.faces[wet[hull.faces].any(axis=1) & ~wet[hull.faces].all(axis=1)]
    if not len(cut):
        return 0, (0.0, 0.0)
    # The two edges of each face, from its wet end to its dry one, in the order in which the outside lies to the right.
    following = np.roll(cut, -1, axis=1)
    leaves, enters = wet[cut] & ~wet[following], ~wet[cut] & wet[following]
    ends = [np.stack((cut[leaves], following[leaves])), np.stack((following[enters], cut[enters]))]
    edges, number = np.unique(np.concatenate(ends, axis=1), axis=1, return_inverse=True)
    low, high = height[edges[0]], height[edges[1]]
    share = (low / (low - high))[:, None]
    places = (1.0 - share) * hull.vertices[edges[0], :2] + share * hull.vertices[edges[1], :2]
    first, second = number.reshape(2, -1)
    loop = np.arange(len(places))
    while True:
        least = np.minimum(loop[first], loop[second])
        after = loop.copy()
        np.minimum.at(after, first, least)
        np.minimum.at(after, second, least)
        after = after[after]
        if np.array_equal(after, loop):
            break
        loop = after
    (ax, ay), (bx, by) = places[first].T, places[second].T
    areas = np.bincount(loop[first], 0.5 * (ax * by - ay * bx), len(places))
    areas *= np.sign(areas.sum())
    x, y = np.ptp(places, axis=0).tolist()
    return int((areas > LEAST_PART * areas.sum()).sum()), (x, y)


def linear_hull(hull: Hull, draft: float) -> LinearHull:
    """The linear coefficients of a hull upright at a draft [m].

    Outside its table a hull has the coefficients at the border, and one without a table those of a box. An
    `ApproximationWarning` says so.
    """
    words = approximation_of(hull, draft)
    if words:
        warnings.warn(words, ApproximationWarning, stacklevel=2)
    return table_hull(hull, draft)


def approximation_of(hull: Hull, draft: float) -> str:
    """The words for coefficients that are not those of the hull at its draft [m]; "" for its own."""
    causes, beyond = [], outside_table(hull, draft)
    if is_boxed(hull, draft):
        x, y, depth = box_of(hull, draft)
        box = f"a box {x:.3g} m long, {y:.3g} m wide, of draft {depth:.3g} m"
        causes.append(f"added mass, damping and wave forces are those of {box}, of its volume and waterplane")
    if beyond:
        causes.append(f"{beyond} is outside; added mass, damping and wave forces are taken from the edge")
    return f"{hull.shape.name}: {'; '.join(causes)}; {ADVICE}" if causes else ""


def table_hull(hull: Hull, draft: float) -> LinearHull:
    """`linear_hull` without its warning."""
    raise_if_stopped()
    low = float(hull.extents[2, 0])
    if is_sunken(hull, draft):
        draft = DEEPEST * float(hull.size[2])
    table, aspect, depth, length, turned, is_round = place_in_table(hull, draft)
    coefficients = interpolated(table, aspect, depth)
    excitation = around(coefficients.excitation, table.direction)
    a, b, infinite = coefficients.added_mass, coefficients.damping, coefficients.infinite
    if turned:  # the tables have the long side along x: a quarter turn
        quarter = np.zeros((6, 6))
        quarter[0, 1], quarter[1, 0], quarter[2, 2] = -1.0, 1.0, 1.0
        quarter[3:, 3:] = quarter[:3, :3]
        a, b, infinite = quarter @ a @ quarter.T, quarter @ b @ quarter.T, quarter @ infinite @ quarter.T
        excitation = np.roll(excitation, len(DIRECTIONS) // 4, axis=1) @ quarter.T
    # into metres, and from the waterline to the centre of mass: v_waterline = S v, S = [[1, -[r]], [0, 1]]
    unit = length ** np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
    rise = low + draft  # [m] of the waterline over the centre of mass
    S = velocity_at(*hull.axis, rise)
    scale = np.outer(unit, unit) * length
    root = math.sqrt(length)
    frequency = table.frequency / root
    # the wave reaches the axis of the table and the centre of mass one after the other
    directions = DIRECTIONS if math.isnan(table.heading) else np.full(len(DIRECTIONS), table.heading)
    unit_vectors = np.column_stack([np.cos(directions), np.sin(directions)])
    path = unit_vectors @ np.array(hull.axis)
    water = table.depth * length
    excitation = excitation * np.exp(1j * wavenumber(frequency, 1.0, water)[:, None] * path)[:, :, None]
    excitation = (excitation * unit * length) @ S
    added, plane, cut = S.T @ (a * scale) @ S, plane_force(hull, draft), upright(hull, draft)
    twist = yaw_by_twist(excitation[0, :, 5], float(wavenumber(frequency[:1], 1.0, water)[0]) * unit_vectors)
    return LinearHull(
        frequency=frequency,
        added_mass=added,
        damping=S.T @ (b * scale / root) @ S,
        infinite=S.T @ (infinite * scale) @ S,
        excitation=excitation,
        length=length,
        draft=draft,
        volume=cut.volume,
        is_round=is_round,
        plane=plane,
        long=long_wave_force(plane, cut, added[0], twist),
        depth=water,
        heading=table.heading,
    )


def yaw_by_twist(moment: np.ndarray, k: np.ndarray) -> float:
    """The factor of kx ky in the yaw moment (n,) of waves of k (n, 2) [rad/m]; 0 where no wave turns the hull."""
    product = k[:, 0] * k[:, 1]
    square = float(product @ product)
    return float(product @ np.real(moment)) / square if square > 0.0 else 0.0


def long_wave_force(plane: PlaneForce, cut: Submerged, added: np.ndarray, twist: float) -> LongWaveForce:
    """The force of long waves on a hull of added mass (6, 6), and the part of it that is wet at rest.

    The mass displaced, times the acceleration of the water, is in the force of the plane except for its vertical part.
    """
    weight = cut.volume * np.array([0.0, 0.0, 1.0, cut.centre[1], -cut.centre[0], 0.0])
    return LongWaveForce(plane.rise, -added[:, 2] - weight, plane.slope - added[:, :2].T, twist)


def velocity_at(x: float, y: float, z: float) -> np.ndarray:
    """(6, 6): velocity and spin at a place x, y, z [m] from a point of a rigid body, of those at the point."""
    S = np.eye(6)
    S[:3, 3:] = [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]]
    return S


def table_length(hull: ClosedMesh) -> float:
    """Unit of length [m] of the table of a custom hull."""
    return math.sqrt(float(hull.size[0] * hull.size[1])) / 2


def interpolated(table: LinearTable, aspect: float, draft: float) -> LinearTable:
    """One hull of a table: the arrays without their first two axes, by cubic polynomials in the logarithms.

    Each coefficient is divided by the power of the draft by which it grows, and the ratio is interpolated: it varies
    little with the draft.
    """
    drafts, aspects = np.log(table.draft), np.log(table.aspect)
    draft = min(max(draft, float(table.draft[0])), float(table.draft[-1]))
    i, u = lagrange(drafts, math.log(draft))
    j, v = lagrange(aspects, min(max(math.log(aspect), 0.0), float(aspects[-1])))
    here, nodes = powers_of_draft(np.array([draft]))[0], powers_of_draft(table.draft[i])

    def value(array: np.ndarray, powers: int) -> np.ndarray:
        scale = nodes if powers == 1 else nodes[:, :, None] * nodes[:, None, :]
        back = here if powers == 1 else np.outer(here, here)
        at_aspect = np.tensordot(v, array[j], 1)[i]
        return (
            np.tensordot(
                u, at_aspect / scale.reshape(len(i), *[1] * (at_aspect.ndim - 1 - powers), *scale.shape[1:]), 1
            )
            * back
        )

    damping = value(table.damping, 2)
    return table._replace(
        added_mass=value(table.added_mass, 2), damping=not_negative(damping) if len(drafts) > 1 else damping,
        infinite=value(table.infinite, 2), excitation=value(table.excitation, 1),
    )  # fmt: skip


def powers_of_draft(draft: np.ndarray) -> np.ndarray:
    """Powers of the drafts (d,) by which the coefficients of each motion grow, (d, 6)."""
    one, turning = np.ones_like(draft), (0.5 + draft) ** 1.5
    return np.stack([draft, draft, one, turning, turning, draft], axis=1)


def not_negative(damping: np.ndarray) -> np.ndarray:
    """The nearest damping (n, 6, 6) that gives no energy to any motion; interpolation and datasets may miss that."""
    size = np.sqrt(np.abs(np.einsum("nii->ni", damping)).max(axis=0)) + 1e-12
    values, vectors = np.linalg.eigh(damping / np.outer(size, size))
    positive_part = np.einsum("nij,nj,nkj->nik", vectors, np.maximum(values, 0.0), vectors)
    return positive_part * np.outer(size, size)


def lagrange(nodes: np.ndarray, x: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """Indices and weights (..., 4) of the polynomials through the four nodes about each x (...), or through all nodes
    where they are fewer."""
    x, count = np.asarray(x, np.float64), min(4, len(nodes))
    first = np.clip(np.searchsorted(nodes, x) - 2, 0, len(nodes) - count)
    index = first[..., None] + np.arange(count)
    points = nodes[index]
    weights = np.ones(points.shape)
    for a in range(count):
        for b in range(count):
            if a != b:
                weights[..., a] *= (x - points[..., b]) / (points[..., a] - points[..., b])
    return index, weights


def around(excitation: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """The excitation (n, 36, 6) over the full circle from that of a quarter, or from one direction of a round hull."""
    if len(direction) == len(DIRECTIONS):
        return excitation
    if len(direction) == 1:
        ahead = excitation[:, 0]
        cosine, sine = np.cos(DIRECTIONS)[:, None], np.sin(DIRECTIONS)[:, None]
        parts = [
            ahead[:, None, 0:1] * cosine, ahead[:, None, 0:1] * sine, ahead[:, None, 2:3] + 0 * cosine,
            -ahead[:, None, 4:5] * sine, ahead[:, None, 4:5] * cosine, 0j * ahead[:, None, 5:6] * cosine,
        ]  # fmt: skip
        return np.concatenate(parts, axis=2)
    half = np.concatenate([excitation, (excitation * MIRROR_X)[:, -2::-1]], axis=1)  # 0 to 180 degrees
    return np.concatenate([half, (half * MIRROR_Y)[:, -2:0:-1]], axis=1)


def natural_frequency(linear: LinearHull, axis: int, mass: float, stiffness: float, added: float = 1.0) -> float:
    """omega/sqrt(g) [1/sqrt(m)] of a free oscillation along or about an axis (0 to 5).

    mass [m3 or m5]: of the solid over the fluid's density; stiffness [m2 or m4]: over the weight density. Roll and
    pitch carry the sway and surge that come with them. added scales the added mass. 0 where no force restores. Raises
    ConvergenceError if the search does not end.
    """
    if stiffness <= 0.0:
        return 0.0
    partner = {3: 1, 4: 0}.get(axis)
    raise_if_stopped()
    frequency = new = math.sqrt(stiffness / (mass + added * linear.infinite[axis, axis]))
    for _ in range(MAX_TURNS):
        a, _ = linear.at(frequency)
        inertia = mass + added * a[axis, axis]
        if partner is not None:
            inertia -= (added * a[axis, partner]) ** 2 / (linear.volume + added * a[partner, partner])
        new = math.sqrt(stiffness / inertia)
        if abs(new - frequency) < 1e-9 * new:
            return frequency
        frequency = 0.5 * (frequency + new)
    raise ConvergenceError("natural frequency", f"{abs(new / frequency - 1.0):.1g} of it", MAX_TURNS)


def memory_of(linear: LinearHull, own_frequencies: np.ndarray) -> Memory:
    """The memory of a hull. own_frequencies (6,) [1/sqrt(m)] of free oscillations; 0 for none."""
    raise_if_stopped()
    poles = POLES / math.sqrt(linear.length)
    s = 1j * linear.frequency[:, None]
    parts = np.concatenate([1 / (s - poles) + 1 / (s - poles.conj()), 1j / (s - poles) - 1j / (s - poles.conj())], 1)
    steady = np.concatenate([(-1 / poles - 1 / poles.conj()).real, (-1j / poles + 1j / poles.conj()).real])
    K = not_negative(linear.damping) + s[:, :, None] * (linear.added_mass - linear.infinite)
    residues = np.zeros((len(poles), 6, 6), complex)
    for i in range(6):
        for j in range(i, 6):
            size = math.sqrt(np.abs(K[:, i, i]).max() * np.abs(K[:, j, j]).max())
            if np.abs(K[:, i, j]).max() <= 1e-9 * size or size == 0.0:
                continue
            own = max(own_frequencies[i], own_frequencies[j])
            weight = np.ones(len(s))
            if own > 0.0:
                weight = FIT_FLOOR + np.exp(-0.5 * ((linear.frequency / own - 1) / FIT_WIDTH) ** 2)
            weight = weight[:, None]
            matrix = np.concatenate([(parts * weight).real, (parts * weight).imag, STEADY_WEIGHT * steady[None]])
            wanted = K[:, i, j, None] * weight
            x = np.linalg.lstsq(matrix, np.concatenate([wanted.real, wanted.imag, np.zeros((1, 1))])[:, 0])[0]
            residues[:, i, j] = residues[:, j, i] = x[: len(poles)] + 1j * x[len(poles) :]
    return Memory(poles, residues)


class Afloat(NamedTuple):
    """A hull of given density afloat in fluids, in linear theory."""

    linear: LinearHull
    memory: Memory
    wet_area: np.ndarray  # (3,) [m2] wet at rest across each axis, int |n_i| dA
    approximation: str  # of the coefficients, in words; "": none


def afloat(hull: Hull, density: float, layers: Layers = SEA_WATER) -> Afloat:
    """The linear coefficients of a hull of `density` [kg/m3] upright at its draft in these layers.

    One that sinks has those of the deepest draft. An `ApproximationWarning` as of `linear_hull`.
    """
    coefficients = coefficients_afloat(hull, density, layers)
    if coefficients.approximation:
        warnings.warn(coefficients.approximation, ApproximationWarning, stacklevel=2)
    return coefficients


@functools.lru_cache(maxsize=256)
def coefficients_afloat(hull: Hull, density: float, layers: Layers) -> Afloat:
    """`afloat` without its warning."""
    draft = equilibrium_draft(hull, density, layers)
    linear = table_hull(hull, draft)
    cut = upright(hull, draft)
    own = np.zeros(6)
    own[2] = natural_frequency(linear, 2, cut.volume, cut.area)
    for axis in (0, 1):
        stiffness = cut.second[1 - axis] + cut.volume * cut.centre[2]
        inertia = cut.volume / hull.volume * float(hull.inertia[axis, axis])
        own[3 + axis] = natural_frequency(linear, 3 + axis, inertia, stiffness)
    memory = memory_of(linear, own)
    # with the added mass that `step` has, or a long wave would not move the body as far as the water moves
    slow, solid = linear.infinite + memory.slow_added_mass(), cut.volume / hull.volume * float(hull.inertia[2, 2])
    twist = linear.long.twist * (solid + slow[5, 5]) / (solid + linear.added_mass[0, 5, 5])
    linear = linear._replace(long=long_wave_force(linear.plane, cut, slow, float(twist)))
    area = wet_area(hull, min(draft, float(hull.size[2])))
    return Afloat(linear, memory, area, approximation_of(hull, draft))


def plane_force(hull: Hull, draft: float) -> PlaneForce:
    """The force of a plane on a hull at a draft [m], by the integrals over its waterplane and its wet part.

    By Gauss's theorem on the wet surface and the waterplane, from -int d' n dA and -int d' x cross n dA of the change
    d' of the depth, which is 1, x or y (Newman 1977, section 6.16).
    """
    x, nz = np.ascontiguousarray(hull.vertices.T), np.ascontiguousarray(area_vectors(hull.vertices, hull.faces)[:, 2])
    integrals = displaced(x, np.ascontiguousarray(hull.faces.T), nz, hull.extents[2, 0] + draft - x[2])
    V, Vx, Vy, Vz, A, Ax, Ay, Axx, Ayy, Axy = integrals.tolist()
    along_x = [-V, 0.0, Ax, Axy, -Axx - Vz, Vy]
    along_y = [0.0, -V, Ay, Ayy + Vz, -Axy, -Vx]
    return PlaneForce(np.array([0.0, 0.0, A, Ay, -Ax, 0.0]), np.array([along_x, along_y]))


def wet_area(hull: Hull, draft: float) -> np.ndarray:
    """Area (3,) [m2] of an upright hull that is wet at a draft [m], across each axis: int |n_i| dA."""
    x, faces = np.ascontiguousarray(hull.vertices.T), np.ascontiguousarray(hull.faces.T)
    area, out = np.ascontiguousarray(area_vectors(hull.vertices, hull.faces).T), np.zeros(9)
    add_pressure(x, faces, area, 0, len(hull.faces), hull.extents[2, 0] + draft - x[2], 1.0, out)
    return out[6:9]
