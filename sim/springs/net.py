"""`Net`: particles on a structured grid, joined by springs. A rope is a net one particle wide.

Links are families of neighbour offsets, never index lists: every particle of the grid is linked to the one
(di, dj) further, if there is one. In this package k is a stiffness, h a time step.
"""

import dataclasses
import functools
import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.interruption import stop_request
from sim.jit import MAX_THREADS
from sim.springs.forces import OWN, check_forces, declared
from sim.springs.integrators import Integrator
from sim.springs.laws import LAWS, check_law
from sim.springs.points.arrays import (
    CellArrays,
    ClothArrays,
    GridArrays,
    RopeArrays,
    RubArrays,
    StrandArrays,
    TouchArrays,
    WideArrays,
)
from sim.springs.points.face_places import FACE_DEPTH
from sim.springs.points.line_arrays import record_of
from sim.springs.points.point_system import PointSystem
from sim.springs.run import Run
from sim.validation import (
    argument_error,
    as_array,
    check_choice,
    check_kind,
    check_number,
    check_positive,
    check_vector,
    is_whole_number,
    read_only,
)

Vector = tuple[float, float, float]

DAMPING_MODELS = ("isotropic", "axial")
CONTACT_LAWS = ("clipped", "lab")
CLOTH = [(0, 1), (1, 0), (1, 1), (1, -1), (0, 2), (2, 0)]  # structural, shear, bend: a kernel of their own
GRID_COST = 4.0  # of a point with links in several directions, over that of a rope's
CONTACT_COST = 2.0  # of a point of a net that touches itself, over another's; loops over many pairs check for a stop
LEAST_BAND = 8  # least rows for a thread
NEAR_CELLS = 32  # most pairs of edges, and of points and faces, of a cloth within reach for each particle, on average
PAIRS = 24  # most pairs within reach for each particle or, of a chain, thickness of it, on average; more do not push
FARTHEST = 1e9  # [m] from the origin, beyond which a net has diverged


class Family(NamedTuple):
    """All links from (i, j) to (i + di, j + dj). di >= 0; dj may be negative where di > 0."""

    di: int
    dj: int
    rest: float  # rest length [m]
    stiffness: float  # k [N/m] per link
    damping: float  # b [N s/m] per link


class Contact(NamedTuple):
    """Penalty contact with floor and sphere, of points, of a rope's links and of a cloth's faces.

    law "clipped": normal force max(0, k depth - b v_n), which never pulls (Schwager & Poeschel, cond-mat/0701278),
    and Coulomb friction. law "lab": the original's k depth n - b v, with the whole velocity and while separating,
    so that surfaces are sticky and viscous; its sphere scales b by the depth.
    """

    stiffness: float = 800.0  # [N/m] per point or link, half of it per face
    damping: float = 5.0  # [N s/m] likewise
    friction: float = 0.0  # Coulomb coefficient, law "clipped" only
    law: str = "clipped"
    # With "clipped", a rope's links touch the sphere as capsules of its radius, and a cloth's faces beside its points;
    # False: points alone.
    links: bool = True


PLAIN_CONTACT = Contact()


class Grab(NamedTuple):
    """A capped, damped pull of one particle towards a target."""

    row: int
    col: int
    target: Vector  # [m]
    stiffness: float  # [N/m]
    damping: float  # [N s/m]
    max_force: float  # [N], of the spring part


class Air(NamedTuple):
    """Moving air around a cloth: drag and lift on its cells, F = rho/2 A s [C_D u + C_L (|u| n - s u/|u|)], s = u . n.

    u is the air's velocity over the cell, A its area, n its normal on the side the air leaves.
    """

    wind: Vector = (0.0, 0.0, 0.0)  # [m/s]
    density: float = 1.2  # rho [kg/m^3]
    drag: float = 1.2  # C_D
    lift: float = 0.8  # C_L


class PinPath(NamedTuple):
    """Prescribed motion of a pin: x(s) = c0 + c1 s + c2 s^2 + c3 s^3 with s = t - start."""

    start: float  # [s]
    coefficients: tuple[Vector, Vector, Vector, Vector]


@dataclasses.dataclass(frozen=True, eq=False)
class Net(PointSystem[Run]):
    """The immutable description of a spring-mass system; its state is `State`. Its arrays are read-only copies."""

    x0: NDArray[np.float64]  # (3, rows, cols) [m], initial positions
    families: tuple[Family, ...]
    mass: float  # [kg] per point
    drag: float  # [N s/m] per point
    gravity: Vector  # [m/s^2]
    pinned: frozenset[tuple[int, int]]
    damping_model: str = "isotropic"
    law: Any = LAWS["spring"].numbers  # of the links: numbers of a law of sim/springs/laws, or its name
    floor: float | None = None  # height [m]
    sphere: tuple[float, float, float, float] | None = None  # x, y, z, radius [m]
    sphere_velocity: Vector = (0.0, 0.0, 0.0)  # [m/s]
    epoch: float = 0.0  # [s], when the sphere is at its centre
    contact: Contact = PLAIN_CONTACT
    radius: float = 0.0  # [m]: points and links touch at this distance
    pin_paths: tuple[tuple[tuple[int, int], PinPath], ...] = ()
    grab: Grab | None = None
    air: Air | None = None
    thickness: float = 0.0  # [m]: particles, or links of a chain, nearer to each other than this push; 0: they pass
    mass_ratios: NDArray[np.float64] | None = None  # (rows, cols), each point's mass over `mass`; None: 1
    side_ratio: float = 1.0  # stiffness and damping of links along a side of the net, over their family's
    forces: tuple[Any, ...] = ()  # numbers of forces of sim/springs/forces that have any, one of each
    threads: int = 1  # for the forces of a cloth

    def __reduce__(self) -> tuple[type["Net"], tuple[Any, ...]]:
        """Pickle the fields alone, so that their copies are read-only too."""
        return Net, tuple(getattr(self, field.name) for field in dataclasses.fields(self))

    def __deepcopy__(self, memo: object) -> "Net":
        """The net itself, as it is immutable."""
        return self

    def __post_init__(self) -> None:
        """Raises ValueError with the field's name for invalid values, as kernels check no index."""
        object.__setattr__(self, "x0", start_positions(self.x0))
        rows, cols = self.shape
        object.__setattr__(self, "law", check_law(self.law))
        object.__setattr__(self, "forces", check_forces(self.forces))
        for family in self.families:
            check_family(family)
            if self.law != LAWS["spring"].numbers:
                check_positive("families rest", family.rest, "m")
        check_positive("mass", self.mass, "kg")
        if self.mass_ratios is not None:
            object.__setattr__(self, "mass_ratios", check_mass_ratios(self.mass_ratios, (rows, cols)))
        check_positive("side_ratio", self.side_ratio, "")
        if self.side_ratio != 1.0 and min(rows, cols) < 2:
            raise argument_error("side_ratio", self.side_ratio, "1, as a net one particle wide has no sides")
        check_number("drag", self.drag, "N s/m", 0)
        check_vector("gravity", self.gravity, "m/s^2")
        check_choice("damping_model", self.damping_model, DAMPING_MODELS)
        check_surroundings(self.contact, self.floor, self.sphere)
        check_vector("sphere_velocity", self.sphere_velocity, "m/s")
        check_number("epoch", self.epoch, "s")
        check_number("radius", self.radius, "m", 0)
        check_number("thickness", self.thickness, "m", 0)
        if not is_whole_number(self.threads) or self.threads < 1:
            raise argument_error("threads", self.threads, "a whole number of at least 1")
        for pinned in self.pinned:
            check_particle("pinned", pinned, rows, cols)
        for pin, path in self.pin_paths:
            check_particle("pin_paths", pin, rows, cols)
            if pin not in self.pinned:
                raise argument_error("pin_paths", pin, "paths of pinned particles")
            check_number("pin_paths start", path.start, "s")
            if len(path.coefficients) != 4:
                raise argument_error("pin_paths coefficients", path.coefficients, "four vectors")
            for unit, coefficient in zip(("m", "m/s", "m/s^2", "m/s^3"), path.coefficients, strict=True):
                check_vector("pin_paths coefficients", coefficient, unit)
        if self.grab is not None:
            check_particle("grab", self.grab[:2], rows, cols)
            check_vector("grab.target", self.grab.target, "m")
            for name in ("stiffness", "damping", "max_force"):
                check_number(f"grab.{name}", getattr(self.grab, name), "", 0)
        if self.air is not None:
            check_air(self.air)
            if min(rows, cols) < 2:
                raise argument_error("air", self.air, "None, as a net one particle wide has no cells that catch air")

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, cols)."""
        return self.x0.shape[1], self.x0.shape[2]

    @property
    def state_shape(self) -> tuple[int, ...]:
        """(3, rows, cols)."""
        return self.x0.shape

    def start(self) -> NDArray[np.float64]:
        """Positions (3, rows, cols) [m], as the net was built."""
        return self.x0.copy()

    @property
    def is_rope(self) -> bool:
        """One row of points, each linked to the next only."""
        return self.is_chain and self.x0.shape[1] == 1

    @property
    def is_chain(self) -> bool:
        """One row or one column of points, each linked to the next only."""
        offsets = [f[:2] for f in self.families]
        return (offsets == [(0, 1)] and self.x0.shape[1] == 1) or (offsets == [(1, 0)] and self.x0.shape[2] == 1)

    @property
    def links_touch(self) -> bool:
        """True if the links touch the sphere, else the points do."""
        return self.is_chain and self.x0[0].size > 1 and touches_between_points(self)

    @property
    def faces_touch(self) -> bool:
        """True if the faces touch the sphere, beside the points."""
        return min(self.shape) > 1 and touches_between_points(self)

    @property
    def is_damped(self) -> bool:
        """True if anything but a grab takes energy out."""
        touched = self.floor is not None or self.sphere is not None or self.thickness > 0.0
        rough = self.contact.damping > 0.0 or (self.contact.friction > 0.0 and self.contact.law == "clipped")
        return (
            self.drag > 0.0
            or self.air is not None
            or any(f.damping > 0.0 for f in self.families)
            or any(OWN[type(one)].damp for one in self.forces)
            or (touched and rough)
        )

    @property
    def is_isolated(self) -> bool:
        """True if nothing but gravity acts on the net from outside."""
        touched = self.floor is not None or self.sphere is not None or self.grab is not None
        return not (self.pinned or touched or self.forces or self.drag > 0.0 or self.air is not None)

    @property
    def evaluation_cost(self) -> float:
        """Cost of one evaluation of the forces on all points, over that of one point of a rope."""
        touches = CONTACT_COST if self.thickness > 0.0 else 1.0
        return self.x0[0].size * touches * (1.0 if self.is_chain else GRID_COST)

    @property
    def is_strand(self) -> bool:
        """True if links touch each other."""
        return self.is_chain and self.thickness > 0.0

    def check_integrator(self, integrator: Integrator) -> None:
        """Raises ValueError for a damped net and a method that allows no damping."""
        if integrator.undamped_only and self.is_damped:
            allowed = "a method with damping: this net is damped by links, drag or contact"
            raise argument_error("integrator", integrator.name, allowed)

    @property
    def masses(self) -> NDArray[np.float64]:
        """(rows, cols) masses [kg], of pinned points too."""
        return np.full(self.shape, float(self.mass)) if self.mass_ratios is None else self.mass * self.mass_ratios

    def inverse_masses(self) -> NDArray[np.float64]:
        """(rows cols,) inverse masses [1/kg]; 0 where pinned."""
        w = 1.0 / self.masses
        for i, j in self.pinned:
            w[i, j] = 0.0
        return w.ravel()

    def link_ratios(self, di: int, dj: int) -> NDArray[np.float64]:
        """Stiffness and damping over the family's of the links to (di, dj) further, (rows - di, cols - |dj|)."""
        return link_ratios(self.shape, di, dj, self.side_ratio)

    def spacing(self, di: int, dj: int) -> float:
        """Rest length [m] of the links from (i, j) to (i + di, j + dj), FARTHEST without such links."""
        return next((float(f.rest) for f in self.families if f[:2] == (di, dj)), FARTHEST)

    def with_stiffness(self, stiffness: float) -> "Net":
        """The same net with all links scaled together, so that the stiffest have `stiffness` [N/m].

        If no link has any stiffness, all get this one.
        """
        stiffest = max((f.stiffness for f in self.families), default=0.0)
        ratios = (f.stiffness / stiffest if stiffest > 0.0 else 1.0 for f in self.families)
        families = (f._replace(stiffness=stiffness * r) for f, r in zip(self.families, ratios, strict=True))
        return dataclasses.replace(self, families=tuple(families))

    @property
    def most_pairs(self) -> int:
        """Largest number of pairs within reach of each other that self-contact can hold."""
        if self.thickness == 0.0:
            return 0
        # Along a thickness of another strand lie this many of its links, all within reach of one link.
        thicknesses = self.thickness / max(self.families[0].rest, 1e-3 * self.thickness) if self.is_chain else 1.0
        return math.ceil(PAIRS * self.x0[0].size * max(1.0, thicknesses))

    @property
    def bands(self) -> int:
        """Number of bands of rows; each thread computes the forces of one band."""
        return max(1, min(self.threads, MAX_THREADS, self.shape[0] // LEAST_BAND))

    def kernel_view(self, h: float) -> Any:
        """The kernels' view of this net for steps of h [s]. Its arrays are shared, except those that kernels fill."""
        view = self._unit_step_view._replace(stop_rate=1.0 / h, stop=stop_request())
        if view.held.size:
            view = cleared(view, "held", "load", "load_is", *(() if self.is_chain else ("pressed",)))
        if self.thickness == 0.0:
            return view
        pairs, seen, nearest = np.empty_like(view.pairs), np.zeros_like(view.seen), np.zeros_like(view.nearest)
        pairs[-1] = -1
        view = view._replace(pairs=pairs, seen=seen, nearest=nearest, looks=np.zeros_like(view.looks))
        if isinstance(view, GridArrays):
            return view
        view = view._replace(last=np.zeros_like(view.last), between=np.zeros_like(view.between))
        return view._replace(**(rub_arrays(self) if self.is_strand else cell_arrays(self)))

    @functools.cached_property
    def _unit_step_view(self) -> Any:
        """`kernel_view` for a step of 1 s, cached: a scene needs it every frame, and a net does not change."""
        rows, cols = self.shape
        paths = np.zeros((len(self.pin_paths), 5, 3))
        for p, (_, path) in enumerate(self.pin_paths):
            paths[p, :4] = path.coefficients
            paths[p, 4, 0] = path.start
        sphere = self.sphere or (0.0, 0.0, 0.0, 0.0)
        damped = any(f.damping > 0.0 for f in self.families)
        grab = self.grab or Grab(0, 0, (0.0, 0.0, 0.0), 0.0, 0.0, 0.0)
        view = record_of(
            RopeArrays,
            self,
            rows=1 if self.is_chain else rows,
            cols=rows * cols if self.is_chain else cols,
            inverse_masses=self.inverse_masses(),
            mass=self.masses.ravel(),
            offsets=[(0, 1)] if self.is_chain else np.reshape([f[:2] for f in self.families], (-1, 2)),
            families=np.reshape([f[2:] for f in self.families], (-1, 3)),
            forces=declared(self.forces),
            conserves_momentum=self.is_isolated,
            conserves_spin=self.is_isolated
            and not (damped and self.damping_model == "isotropic")
            and not (self.is_strand and self.contact.friction > 0.0),
            damped=damped,
            axial=self.damping_model == "axial",
            has_floor=self.floor is not None,
            floor=(self.floor or 0.0) + self.radius,
            has_sphere=self.sphere is not None,
            sr=sphere[3] + self.radius,
            contact_k=self.contact.stiffness,
            contact_b=self.contact.damping,
            friction=self.contact.friction,
            stop_rate=1.0,
            lab_contact=self.contact.law == "lab",
            held=np.zeros(6 * rows * cols if self.contact.friction > 0.0 else 0),
            load=np.zeros(6 * rows * cols if self.contact.friction > 0.0 else 0),
            load_is=np.zeros(1, np.int64),
            pins=[i * cols + j for (i, j), _ in self.pin_paths],
            paths=paths,
            grabbed=-1 if self.grab is None else grab.row * cols + grab.col,
            grab_k=grab.stiffness,
            grab_b=grab.damping,
            grab_max=grab.max_force,
            stop=stop_request(),
            **components("g", self.gravity),
            **components("s", sphere),
            **components("sv", self.sphere_velocity),
            **components("grab_", grab.target),
        )
        if self.is_chain and self.thickness == 0.0:
            return view
        touch = record_of(
            TouchArrays,
            self,
            row_spacing=self.spacing(1, 0),
            col_spacing=self.families[0].rest if self.is_chain else self.spacing(0, 1),
            pairs=np.full((self.most_pairs + 1, 2), -1),
            seen=np.zeros(3 * rows * cols if self.thickness > 0 else 3),
            nearest=np.zeros(1),
            looks=np.zeros(1, np.int64),
        )
        if self.is_chain:
            return StrandArrays(*view, *touch, np.zeros(self.x0.size), np.zeros(12), **rub_arrays(self))
        air, (ends, links) = self.air or Air(), link_table(self.shape, self.families, float(self.side_ratio))
        wide = record_of(
            WideArrays,
            self,
            has_air=self.air is not None,
            air_drag=0.5 * air.density * air.drag,
            air_lift=0.5 * air.density * air.lift,
            side=self.side_ratio,
            ends=ends,
            links=links,
            **components("wind_", air.wind) | face_arrays(self),
        )
        grid = GridArrays(*view, *touch, *wide)
        if [f[:2] for f in self.families] != CLOTH:
            return grid
        return ClothArrays(*grid, np.zeros_like(touch.seen), np.zeros(12), **cell_arrays(self))


def touches_between_points(net: Net) -> bool:
    """True if the contact is one by which places between the points touch the sphere, too."""
    return net.sphere is not None and net.contact.links and net.contact.law == "clipped"


def cleared(view: Any, *names: str) -> Any:
    """A copy of the kernels' record with new arrays of zeros under these names."""
    return view._replace(**{name: np.zeros_like(getattr(view, name)) for name in names})


def face_arrays(net: Net) -> dict[str, Any]:
    """Fields of `WideArrays` for the contact of faces."""
    radius = net.radius + (net.sphere[3] if net.sphere is not None else 0.0)
    size = 4 * net.x0[0].size if net.faces_touch and net.contact.friction > 0.0 else 0
    return {"face_depth": FACE_DEPTH * radius, "pressed": np.zeros(size)}


def rub_arrays(net: Net) -> dict[str, Any]:
    """`RubArrays` of a list that is not yet made."""
    touching = np.empty((net.most_pairs + 1, 2), np.int64)
    touching[-1] = -1
    return RubArrays(touching, np.empty((net.most_pairs, 14)), np.empty((net.most_pairs, 5)))._asdict()


def cell_arrays(net: Net) -> dict[str, Any]:
    """`CellArrays` of a list that is not yet made."""
    most = NEAR_CELLS * net.x0[0].size if net.thickness > 0.0 else 0
    near = np.empty((most + 1, 3), np.int64)
    near[-1] = -1, 0, 0
    listed, joined = np.zeros((2, net.x0.size if most else 3))
    return CellArrays(near, np.empty(most), listed, joined, np.zeros(4), *np.zeros((3, 3)))._asdict()


def components(prefix: str, vector: Sequence[float]) -> dict[str, float]:
    """Fields of a kernels' record that hold a vector: `prefix` with x, y and z."""
    return {prefix + axis: component for axis, component in zip("xyz", vector, strict=False)}


def link_ratios(shape: tuple[int, int], di: int, dj: int, side: float) -> NDArray[np.float64]:
    """`Net.link_ratios` of a net of this shape and `side_ratio`."""
    rows, cols = shape
    ratios = np.ones((max(0, rows - di), max(0, cols - abs(dj))))
    if di == 0:
        ratios[[0, -1]] = side
    if dj == 0 and ratios.size:
        ratios[:, [0, -1]] = side
    return ratios


@functools.lru_cache(maxsize=4)
def link_table(
    shape: tuple[int, int], families: tuple[Family, ...], side: float
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """`ends` and `links` of the kernels' record. Kept, as a net that is dragged is another in every frame."""
    points = np.arange(shape[0] * shape[1]).reshape(shape)
    ends, links = [np.zeros((0, 3), np.int64)], [np.zeros((0, 3))]
    for family, (di, dj, rest, stiffness, damping) in enumerate(families):
        ratios = link_ratios(shape, di, dj, side).ravel()
        near = points[: max(0, shape[0] - di), max(0, -dj) : max(0, shape[1] - max(0, dj))].ravel()
        ends.append(np.column_stack([near, near + di * shape[1] + dj, np.full_like(near, family)]))
        links.append(np.column_stack([np.full_like(ratios, rest), ratios * stiffness, ratios * damping]))
    return np.concatenate(ends), np.concatenate(links)


def start_positions(x0: Any) -> NDArray[np.float64]:
    """`x0` as a contiguous float64 array (3, rows, cols); raises ValueError for another shape or a point too far away.

    A NaN passes: its run diverges at the first step.
    """
    allowed = f"real numbers of shape (3, rows, cols), nearer to the origin than {FARTHEST:g} m"
    if not isinstance(x0, np.ndarray) or x0.dtype.kind not in "iuf":
        raise argument_error("x0", getattr(x0, "dtype", type(x0)), allowed)
    if x0.ndim != 3 or x0.shape[0] != 3 or x0.size == 0:
        raise argument_error("x0", x0.shape, allowed)
    x0 = read_only(x0.astype(np.float64))
    largest = float(np.abs(x0).max())
    if largest >= FARTHEST:
        raise argument_error("x0", largest, allowed)
    return x0


def check_mass_ratios(ratios: Any, shape: tuple[int, int]) -> NDArray[np.float64]:
    """`ratios` as a read-only array. Raises ValueError unless they are numbers above 0, one for each point."""
    array = as_array("mass_ratios", ratios, f"numbers of shape {shape}")
    if array.shape != shape:
        raise argument_error("mass_ratios", array.shape, f"numbers of shape {shape}")
    bad = ~((array > 0.0) & (array < math.inf))
    if bad.any():
        raise argument_error("mass_ratios", float(array[bad][0]), "finite numbers above 0")
    return read_only(array)


def check_place(name: str, value: object) -> Vector:
    """`value` as three numbers nearer to the origin than FARTHEST. Raises ValueError otherwise."""
    x, y, z = check_vector(name, value, "m")
    if not max(abs(x), abs(y), abs(z)) < FARTHEST:
        raise argument_error(name, value, f"3 numbers [m], nearer to the origin than {FARTHEST:g} m")
    return x, y, z


def check_family(family: Family) -> None:
    """Raises ValueError for links that are not from a particle to one after it, or numbers that no spring has."""
    di, dj = family[:2]
    if not (is_whole_number(di) and is_whole_number(dj) and (di > 0 or (di == 0 and dj > 0))):
        raise argument_error("families", (di, dj), "links to a later row, or to a later particle of the same row")
    check_number("families rest", family.rest, "m", 0)
    check_number("families stiffness", family.stiffness, "N/m", 0)
    check_number("families damping", family.damping, "N s/m", 0)


def check_particle(name: str, value: Any, rows: int, cols: int) -> tuple[int, int]:
    """`value` as the (row, column) of a particle. Raises ValueError outside the net."""
    pair = tuple(value) if isinstance(value, tuple | list | np.ndarray) else ()
    if len(pair) == 2 and all(map(is_whole_number, pair)) and 0 <= pair[0] < rows and 0 <= pair[1] < cols:
        return int(pair[0]), int(pair[1])
    raise argument_error(name, value, f"a row from 0 to {rows - 1} and a column from 0 to {cols - 1}")


def check_air(air: Air) -> None:
    """Raises ValueError with the name of the invalid property of the air."""
    if not isinstance(air, Air):
        raise argument_error("air", air, "an Air, or None")
    check_vector("air.wind", air.wind, "m/s")
    for name in ("density", "drag", "lift"):
        check_number(f"air.{name}", getattr(air, name), "", 0)


def check_surroundings(
    contact: Contact | None, floor: float | None, sphere: tuple[float, float, float, float] | None
) -> Contact:
    """The contact, or the plain one for None; raises ValueError with the name of the invalid one and the reason."""
    contact = PLAIN_CONTACT if contact is None else contact
    if not isinstance(contact, Contact):
        raise argument_error("contact", contact, "a Contact, or None")
    check_number("contact.stiffness", contact.stiffness, "N/m", 0)
    check_number("contact.damping", contact.damping, "N s/m", 0)
    check_number("contact.friction", contact.friction, "", 0)
    check_choice("contact.law", contact.law, CONTACT_LAWS)
    check_kind("contact.links", contact.links, bool, "True or False")
    if floor is not None:
        check_number("floor", floor, "m")
    if sphere is not None:
        check_number("sphere radius", check_vector("sphere", sphere, "m", 4)[3], "m", 0)
    return contact
