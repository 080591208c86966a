"""`System`: lines between fixed, moved, free and floating points, in water above a bed.

z is up from still water [m]; node 0 of a line is at its start. A System is immutable; kernels see it as `LineArrays`,
with one link a segment and half a segment's mass at each end.
"""

import dataclasses
import functools
import itertools
import math
from collections.abc import Collection, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.interruption import stop_request
from sim.mooring.bending import bends_of
from sim.mooring.elastic import Curves
from sim.mooring.parts import Line, LineType, MooredBody, MooringParts, Point, Vector
from sim.mooring.rest.statics import Rest, at_rest
from sim.mooring.tangent import motion_of
from sim.springs.forces import check_forces, declared
from sim.springs.integrators import Integrator, discover
from sim.springs.kicks.line_solver import coupling_of
from sim.springs.points.line_arrays import (
    BODY_MASS,
    BODY_ROW,
    DAMPING,
    INVERSE_MASS,
    INVERSE_ROOT,
    MASS_ROOT,
    PART,
    PLACE,
    STIFFNESS,
    LineArrays,
    record_of,
)
from sim.validation import (
    argument_error,
    check_choice,
    check_kind,
    check_number,
    check_positive,
    check_vector,
    is_whole_number,
    read_only,
)
from sim.water import Water
from sim.waves import Waves

KINDS = ("fixed", "coupled", "free", "body")
FARTHEST = 1e5  # [m] from the origin
LINE_COST = 50.0  # of a node, over that of a point of a rope
MOST_SEGMENTS = 2000  # of a line
MOST_PARTS = 10_000  # lines or points of a system
MOST_DAMPING = 100.0  # ratio, of a segment
MAX_DISPERSION_ERROR = 0.02  # of omega: what surface tension and rounded numbers may make


@dataclasses.dataclass(frozen=True)
class System(MooringParts):
    """Lines, points and bodies in water of one depth."""

    lines: tuple[Line, ...]
    points: tuple[Point, ...]
    water: Water  # around the lines, above the bed; of density 0: none
    bodies: tuple[MooredBody, ...] = ()
    bed_stiffness: float = 3e6  # [Pa/m]; 0: no bed
    bed_damping: float = 3e5  # [Pa s/m]
    friction: float = 0.0  # Coulomb coefficient
    # False: a slack segment has no tension, and a taut one never pushes. True: internal damping acts at any length, as
    # in MoorDyn, so that a slack segment pulls where it lengthens and pushes where it shortens.
    slack_damping: bool = False
    current: Vector = (0.0, 0.0, 0.0)  # [m/s]; it pushes lines and points, but no body
    waves: Waves | None = None  # on the same water; None: still water
    forces: tuple[Any, ...] = ()  # numbers of forces of sim/springs/forces, at most one of each

    def __post_init__(self) -> None:
        """Raises ValueError with the name of an invalid value, as kernels check no index."""
        for name in ("lines", "points", "bodies"):
            object.__setattr__(self, name, tuple(getattr(self, name)))
        for name in ("lines", "points", "bodies"):
            if len(getattr(self, name)) > MOST_PARTS:
                raise argument_error(name, len(getattr(self, name)), f"at most {MOST_PARTS}")
        check_kind("water", self.water, Water, "a Water")
        check_number("water: depth", self.water.depth, "m", 0, FARTHEST, above=True)
        check_number("water: gravity", self.water.gravity, "m/s2", 0, 1e4)
        for name, unit in (("bed_stiffness", "Pa/m"), ("bed_damping", "Pa s/m"), ("friction", "")):
            check_number(name, getattr(self, name), unit, 0)
        check_kind("slack_damping", self.slack_damping, bool, "True or False")
        check_vector("current", self.current, "m/s")
        check_forces(self.forces)
        self.check_waves()
        check_ids("bodies", self.bodies)
        for body in self.bodies:
            check_body(body, 0 if self.waves is None else len(self.waves.kx))
        object.__setattr__(self, "bodies", tuple(map(with_read_only_arrays, self.bodies)))
        check_ids("points", self.points)
        bodies = dict.fromkeys(body.id for body in self.bodies).keys()
        for point in self.points:
            self.check_point(point, bodies)
        check_ids("lines", self.lines)
        if not self.lines:
            raise argument_error("lines", (), "at least one line")
        for kind in {id(line.type): line.type for line in self.lines}.values():  # lines share their types
            check_type(kind)
        for line in self.lines:
            self.check_line(line)
        ended = {end for line in self.lines for end in (line.start, line.end)}
        for point in self.points:
            if point.kind == "free" and point.id not in ended and point.mass == 0.0:
                raise argument_error(f"point {point.id}", "free, without a line", "a mass, or a line that ends there")

    def check_waves(self) -> None:
        """Raises ValueError for waves on another water, or with other frequencies than gravity waves have on it."""
        waves = self.waves
        if waves is None:
            return
        check_kind("waves", waves, Waves, "Waves, as `draw_waves` or `waves_at` of a sea, or None")
        if not waves.water.is_same(self.water):
            raise argument_error("waves", f"waves on {waves.water}", f"those on the system's {self.water}")
        expected = self.water.omega(waves.k)
        wrong = np.abs(waves.omega - expected) > MAX_DISPERSION_ERROR * expected
        if wrong.any():
            gravity = self.water.gravity
            allowed = f"{float(expected[wrong][0]):g} rad/s, as waves of that length have in gravity {gravity:g} m/s2"
            raise argument_error("waves: omega", float(waves.omega[wrong][0]), allowed)

    def check_point(self, point: Point, bodies: Collection[int]) -> None:
        """Raises ValueError for a point that is not allowed. bodies: their ids."""
        name = f"point {point.id}"
        check_choice(f"{name}: kind", point.kind, KINDS)
        x, y, z = check_vector(f"{name}: position", point.position, "m")
        if not max(abs(x), abs(y), abs(z)) < FARTHEST:
            raise argument_error(f"{name}: position", point.position, f"nearer to the origin than {FARTHEST:g} m")
        depth = self.water.depth
        if point.kind == "fixed" and self.bed_stiffness > 0.0 and z < -depth - 1e-6 * depth:
            raise argument_error(f"{name}: position", point.position, f"on or above the bed at z = {-depth:g} m")
        for field, unit in (("mass", "kg"), ("volume", "m^3"), ("drag_area", "m^2"), ("added_mass", "")):
            check_number(f"{name}: {field}", getattr(point, field), unit, 0)
        check_vector(f"{name}: force", point.force, "N")
        if (point.kind == "body") != (point.body is not None):
            raise argument_error(f"{name}: body", point.body, "the id of a body, for points of kind 'body' only")
        if point.body is not None and point.body not in bodies:
            raise argument_error(f"{name}: body", point.body, f"one of {list(bodies)}")

    def check_line(self, line: Line) -> None:
        name = f"line {line.id}"
        for field in ("start", "end"):
            if getattr(line, field) not in self.node_of_point:
                allowed = f"the id of a point: {list(self.node_of_point)}"
                raise argument_error(f"{name}: {field}", getattr(line, field), allowed)
        if line.start == line.end:
            raise argument_error(f"{name}: end", line.end, "another point than its start")
        check_number(f"{name}: length", line.length, "m", 0, FARTHEST, above=True)
        if not is_whole_number(line.segments) or not 1 <= line.segments <= MOST_SEGMENTS:
            raise argument_error(f"{name}: segments", line.segments, f"a whole number from 1 to {MOST_SEGMENTS}")
        for field, end in (("clamp_at_start", line.start), ("clamp_at_end", line.end)):
            self.check_clamp(f"{name}: {field}", getattr(line, field), line.type, end)

    def check_clamp(self, name: str, direction: Vector | None, kind: LineType, end: int) -> None:
        """Raises ValueError for a clamp of a line without EI, or at an end that is free."""
        if direction is None:
            return
        if not math.sqrt(sum(c * c for c in check_vector(name, direction, ""))) > 0.0:
            raise argument_error(name, direction, "a direction")
        if kind.bending == 0.0 or self.points[self.node_of_point[end]].kind not in ("fixed", "coupled"):
            raise argument_error(name, direction, "None, except for a line with EI at a fixed or coupled point")

    def at_rest(self) -> Rest:
        """The static state: see `sim.mooring.rest.statics.at_rest`."""
        return at_rest(self)

    @property
    def state_shape(self) -> tuple[int, ...]:
        """(3, n) of all nodes, then two points a body: its displacement and its rotation."""
        return 3, self.node_count + 2 * len(self.bodies)

    def start(self) -> NDArray[np.float64]:
        """Positions (3, n) [m] of the state of rest. Raises ConvergenceError without one."""
        return self.at_rest().nodes

    @property
    def evaluation_cost(self) -> float:
        """Cost of one evaluation of the forces on all points, over that of one point of a rope."""
        return LINE_COST * self.node_count

    def check_integrator(self, integrator: Integrator) -> None:
        """Raises ValueError for a method without water, bed or bodies, or without damping."""
        if integrator.implicit or integrator.undamped_only:
            usable = [one.name for one in discover().values() if not (one.implicit or one.undamped_only)]
            allowed = f"one of {', '.join(usable)}: implicit methods know no water, bed or bodies, and pefrl no damping"
            raise argument_error("integrator", integrator.name, allowed)

    def kernel_view(self, h: float) -> LineArrays:
        """The kernels' view for steps of h [s]. Its arrays are shared, except the one that kernels fill."""
        view = self._unit_step_view
        return view._replace(stop_rate=1.0 / h, stop=stop_request(), inertia=np.zeros_like(view.inertia))

    @functools.cached_property
    def _unit_step_view(self) -> LineArrays:
        """`kernel_view` for a step of 1 s: a system does not change."""
        nodes, bodies = self.node_count, len(self.bodies)
        n = nodes + 2 * bodies
        curves = Curves(line.type for line in self.lines)
        ends, links = link_tables(self, curves)
        places, parts = part_tables(self)
        mass = np.zeros(n)
        np.add.at(mass, places[:, 0], parts["mass"])
        inverse = self.inverse_masses(mass)
        moved = list(self.coupled_nodes.values())
        paths = np.zeros((len(moved), 5, 3))
        for q, i in enumerate(moved):
            paths[q, 0] = self.points[i].position
        carried, arms, rows = self.body_rows(mass)
        waves = np.zeros((9, 0)) if self.waves is None else self.waves.table
        return record_of(
            LineArrays,
            self,
            rows=1,
            cols=n,
            nodes=nodes,
            inverse_masses=inverse,
            mass=mass,
            moving=(inverse > 0.0) | np.isin(np.arange(n), carried[:, 0]),
            inertia=np.zeros(6 * n),
            gx=0.0,
            gy=0.0,
            gz=-self.water.gravity,
            forces=declared(self.forces),
            damped=True,
            axial=True,
            loads=loads_on(self.points, n),
            bends=bends_of(self),
            curves=curves.table,
            ends=ends,
            links=links,
            **coupling_of(ends, inverse > 0.0, carried)._asdict(),
            places=places,
            parts=parts,
            bed=-self.water.depth,
            depth=self.water.depth,
            stop_rate=1.0,
            waves=waves,
            pins=moved,
            paths=paths,
            carried=carried,
            arms=arms,
            bodies=rows,
            steady=np.reshape([body.steady for body in self.bodies], (-1, 6)),
            excitation=excitations(self.bodies, waves.shape[1]),
            stop=stop_request(),
        )

    def inverse_masses(self, mass: NDArray[np.float64]) -> NDArray[np.float64]:
        """(n,) [1/kg] of the kernels' points of these masses (n,); 0 where prescribed or carried by a body."""
        free = np.zeros(len(mass), dtype=bool)
        free[: self.node_count] = True
        free[: len(self.points)] = [point.kind == "free" for point in self.points]
        inverse = np.zeros(len(mass))
        inverse[free] = 1.0 / np.maximum(mass[free], 1e-12)
        return inverse

    def body_rows(self, mass: NDArray[np.float64]) -> tuple[Any, Any, Any]:
        """`carried`, `arms` and `bodies` of the kernels' view; a body's mass includes its fairleads' nodes."""
        index = {body.id: i for i, body in enumerate(self.bodies)}
        carried, arms = [], []
        for i, point in enumerate(self.points):
            if point.body is not None:
                body = self.bodies[index[point.body]]
                carried.append((i, index[point.body]))
                arms.append(np.subtract(point.position, body.place))
        rows = np.zeros((len(self.bodies), BODY_ROW))
        for b, body in enumerate(self.bodies):
            full = np.array(body.mass, dtype=np.float64)
            for (node, owner), arm in zip(carried, arms, strict=True):
                if owner == b:
                    motion = motion_of(arm)
                    full += mass[node] * motion.T @ motion
            rows[b, INVERSE_MASS:BODY_MASS] = np.linalg.inv(full).ravel()
            rows[b, BODY_MASS:STIFFNESS] = full.ravel()
            rows[b, STIFFNESS:DAMPING] = np.ravel(body.stiffness)
            damping = np.zeros((6, 6)) if body.damping is None else np.array(body.damping, dtype=np.float64)
            rows[b, DAMPING:PLACE] = damping.ravel()
            rows[b, PLACE:MASS_ROOT] = body.place
            squares, axes = np.linalg.eigh(full)
            root, inverse_root = (axes * squares**power @ axes.T for power in (-0.5, 0.5))
            rows[b, MASS_ROOT:INVERSE_ROOT] = root.ravel()
            rows[b, INVERSE_ROOT:] = inverse_root.ravel()
        return (
            np.array(carried, dtype=np.int64).reshape(-1, 2),
            np.array(arms, dtype=np.float64).reshape(-1, 3),
            rows,
        )


def loads_on(points: Sequence[Point], n: int) -> NDArray[np.float64]:
    """Steady force (n, 3) [N] on each of the kernels' points, `points` first; (0, 3) without any."""
    loads = np.zeros((n if any(any(point.force) for point in points) else 0, 3))
    if len(loads):
        for i, point in enumerate(points):
            loads[i] = point.force
    return loads


def excitations(bodies: Sequence[MooredBody], waves: int) -> NDArray[np.float64]:
    """`excitation` of the kernels' view, for a number of waves; empty if no wave pushes a body."""
    if all(body.excitation is None for body in bodies):
        return np.zeros((len(bodies), 12, 0))
    forces = np.zeros((len(bodies), 12, waves))
    for b, body in enumerate(bodies):
        if body.excitation is not None:
            X = np.asarray(body.excitation).T
            forces[b] = np.concatenate((X.real, X.imag))
    return forces


def link_tables(system: System, curves: Curves) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """`ends` and `links` of the kernels' view."""
    ends, links = [], []
    for line in system.lines:
        kind, at, length = line.type, system.nodes_of[line.id], line.length / line.segments
        damping = kind.damping
        if damping < 0.0:
            damping = -damping * length * math.sqrt(kind.stiffness * kind.mass)
        ends.append(np.column_stack((at[:-1], at[1:])))
        row = (length, kind.stiffness / length, damping / length, *curves.rows_of(kind))
        links.append(np.tile(np.array(row, dtype=np.float64), (line.segments, 1)))
    return np.concatenate(ends), np.concatenate(links)


def part_tables(system: System) -> tuple[NDArray[np.int64], NDArray[np.void]]:
    """`places` and `parts` of the kernels' view: those of the lines, then the masses and floats at points."""
    density, places, parts = system.water.density, [], []
    for line in system.lines:
        kind, at, last = line.type, system.nodes_of[line.id], line.segments
        drag, height = 0.5 * density * kind.diameter, volume_height(kind.volume, kind.diameter)
        for i in range(last + 1):
            length = (0.5 if i in (0, last) else 1.0) * line.length / last
            places.append((at[i], at[max(i - 1, 0)], at[min(i + 1, last)]))
            parts.append((
                length * kind.mass, length * density * kind.volume, kind.added_across, kind.added_along,
                length * drag * kind.drag_across, length * drag * math.pi * kind.drag_along, length * kind.diameter,
                height,
            ))  # fmt: skip
    for i, point in enumerate(system.points):
        if point.mass > 0.0 or point.volume > 0.0 or point.drag_area > 0.0:
            places.append((i, i, i))
            added, drag = point.added_mass, 0.5 * density * point.drag_area
            height = volume_height(point.volume, math.pi / 4.0 * (6.0 * point.volume / math.pi) ** (2 / 3))
            parts.append((point.mass, density * point.volume, added, added, drag, 0.0, 0.0, height))
    return np.array(places, dtype=np.int64), np.array(parts, dtype=PART)


def volume_height(volume: float, area: float) -> float:
    """Height [m] of a volume over its area in the plane of water that cuts it in the middle; a point's is next to 0."""
    return max(volume / max(area, 1e-300), 1e-9)


def with_read_only_arrays(body: MooredBody) -> MooredBody:
    """The body with copies of its arrays that nobody can change."""
    arrays = {name: getattr(body, name) for name in ("mass", "stiffness", "damping", "excitation")}
    return body._replace(**{name: read_only(array) for name, array in arrays.items() if array is not None})


def check_ids(name: str, items: Sequence[Any]) -> None:
    """Raises ValueError unless each has a whole number of its own."""
    ids = [item.id for item in items]
    for one in ids:
        if not is_whole_number(one):
            raise argument_error(f"{name}: id", one, "a whole number")
    if len(set(ids)) < len(ids):
        raise argument_error(f"{name}: id", ids, "a different number for each")


def check_type(kind: LineType) -> None:
    """Raises ValueError with the name of the coefficient that no line has."""
    name = f"line type {kind.name}"
    for field, unit in (("diameter", "m"), ("mass", "kg/m"), ("stiffness", "N")):
        check_positive(f"{name}: {field}", getattr(kind, field), unit)
    check_number(f"{name}: bending", kind.bending, "N m^2", 0)
    check_curve(f"{name}: curve", kind.curve)
    check_number(f"{name}: damping", kind.damping, "N s, or a ratio where negative", -MOST_DAMPING)
    for field in ("added_across", "drag_across", "added_along", "drag_along"):
        check_number(f"{name}: {field}", getattr(kind, field), "", 0)


def check_curve(name: str, curve: Sequence[tuple[float, float]]) -> None:
    """Raises ValueError unless strain and tension grow from (0, 0) on, so that the energy is convex."""
    allowed = "rows (strain, tension [N]) from (0, 0) on, both growing from row to row"
    rows = [check_vector(name, row, "1, N", 2) for row in curve]
    if rows and not (len(rows) > 1 and rows[0] == (0.0, 0.0)):
        raise argument_error(name, curve, allowed)
    for before, after in itertools.pairwise(rows):
        if not (after[0] > before[0] and after[1] > before[1]):
            raise argument_error(name, (before, after), allowed)


def check_body(body: MooredBody, waves: int) -> None:
    """Raises ValueError for matrices that no body has, and forces for another number of waves."""
    check_vector(f"body {body.id}: place", body.place, "m")
    for field in ("mass", "stiffness", "damping"):
        matrix = getattr(body, field)
        if matrix is None and field == "damping":
            continue
        matrix = np.asarray(matrix, dtype=np.float64)
        if matrix.shape != (6, 6) or not np.isfinite(matrix).all():
            raise argument_error(f"body {body.id}: {field}", matrix.shape, "finite numbers of shape (6, 6)")
        if not np.allclose(matrix, matrix.T, rtol=1e-9, atol=1e-9 * np.abs(matrix).max(initial=0.0)):
            raise argument_error(f"body {body.id}: {field}", "not symmetric", "a symmetric matrix")
        least = np.linalg.eigvalsh(matrix)[0]
        if least < -1e-9 * np.abs(matrix).max(initial=0.0) or (field == "mass" and least <= 0.0):
            raise argument_error(f"body {body.id}: {field}", least, "a matrix without negative eigenvalues")
    check_vector(f"body {body.id}: steady", body.steady, "N, N m", 6)
    if body.excitation is not None:
        X = np.asarray(body.excitation)
        if X.shape != (waves, 6) or not np.isfinite(X).all():
            raise argument_error(f"body {body.id}: excitation", X.shape, f"finite numbers of shape ({waves}, 6)")
