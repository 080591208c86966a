"""`LineArrays`: the kernels' record of lines under water, and the columns of its tables.

Nodes of all lines stand in one row of points; the last two points of a body are its displacement and its small
rotation. A link joins any two nodes. What water does is summed over parts: an inner node of a line is one part, a free
point where several lines end has one for each of them, half a segment long. A mass or a float at a point is a part too:
its neighbours are the point itself, so that it has no direction, and water acts on it alike in all.
"""

import functools
from collections.abc import Callable
from typing import Any, NamedTuple, TypeVar, get_type_hints

import numpy as np
from numpy.typing import NDArray

PART = np.dtype([
    ("mass", "f8"),  # [kg]
    ("displaced", "f8"),  # [kg] of water
    ("added_across", "f8"),  # added masses over the displaced one
    ("added_along", "f8"),
    ("drag_across", "f8"),  # [kg/m] drag over the square of the speed
    ("drag_along", "f8"),
    ("bed_area", "f8"),  # [m^2]
    ("height", "f8"),  # [m] of its volume
])  # fmt: skip
# Where a row of `bodies` holds its (6, 6) matrices, flat, and its place. MASS_ROOT is the root of the inverse mass, and
# INVERSE_ROOT the inverse of that.
INVERSE_MASS, BODY_MASS, STIFFNESS, DAMPING, PLACE = 0, 36, 72, 108, 144
MASS_ROOT, INVERSE_ROOT, BODY_ROW = 147, 183, 219

Record = TypeVar("Record")
# A kernel is compiled for the types of its record's fields: each field always gets the type that it declares.
CONVERTERS: dict[Any, Callable[[Any], Any]] = {
    int: int,
    float: float,
    bool: bool,
    NDArray[np.float64]: lambda value: np.ascontiguousarray(value, dtype=np.float64),
    NDArray[np.int64]: lambda value: np.ascontiguousarray(value, dtype=np.int64),
}


def record_of(kind: type[Record], owner: object, **fields: Any) -> Record:
    """A record of the NamedTuple `kind`: `fields`, and attributes of `owner` for its other fields.

    Values of the types in CONVERTERS are converted. Arrays that have the declared type already are shared.
    """
    return kind(**{
        name: convert(fields[name] if name in fields else getattr(owner, name))
        for name, convert in converters_of(kind).items()
    })  # fmt: skip


@functools.cache
def converters_of(kind: type) -> dict[str, Callable[[Any], Any]]:
    """The converter of each field of a NamedTuple."""
    return {name: CONVERTERS.get(declared, lambda value: value) for name, declared in get_type_hints(kind).items()}


class LineArrays(NamedTuple):
    """Kernel data of lines under water. n points: nodes, then two a body."""

    rows: int  # 1
    cols: int  # n
    nodes: int  # points that are nodes
    inverse_masses: NDArray[np.float64]  # (n,) [1/kg] without the water's; 0 where prescribed or carried by a body
    mass: NDArray[np.float64]  # (n,) [kg] without the water's
    moving: NDArray[np.bool_]  # (n,) nodes that are free or carried by a body
    inertia: NDArray[np.float64]  # (6 n,) of `set_inverse_masses`: xx, xy, xz, yy, yz, zz of each node's matrix [1/kg]
    gx: float  # gravity [m/s^2]
    gy: float
    gz: float
    forces: Any  # `Declared`: numbers of the forces that have any, see sim/springs/forces
    damped: bool  # any damping of links
    axial: bool  # True: it acts along them
    slack_damping: bool  # it acts whole in slack links, too, as in MoorDyn
    ends: NDArray[np.int64]  # (links, 2) nodes
    # (links, 5): rest length [m], stiffness [N/m], damping [N s/m], first row and number of rows in `curves`, or 0
    links: NDArray[np.float64]
    link_order: NDArray[np.int64]  # this one and the next four: `Coupling` of `sim.springs.kicks.line_solver`
    columns_below: NDArray[np.int64]
    rows_below: NDArray[np.int64]
    link_targets: NDArray[np.int64]
    products: NDArray[np.int64]
    curves: NDArray[np.float64]  # (rows, 3): strain, tension [N], energy per length [N], see `sim.springs.laws.curve`
    bends: NDArray[np.float64]  # (bends, 12): see `sim.springs.forces.under_water.bending`
    loads: NDArray[np.float64]  # (n, 3) [N] steady forces on nodes, or (0, 3) without any
    places: NDArray[np.int64]  # (parts, 3): node, and the nodes before and after it along the line
    parts: NDArray[np.void]  # (parts,) of PART
    bed: float  # height [m]
    bed_stiffness: float  # [Pa/m]
    bed_damping: float  # [Pa s/m]
    friction: float  # Coulomb coefficient of the bed
    stop_rate: float  # 1/h [1/s]: friction takes at most the force that stops a node within the step
    current: NDArray[np.float64]  # (3,) [m/s]
    depth: float  # [m]
    waves: NDArray[np.float64]  # (9, waves): `Waves.table`
    pins: NDArray[np.int64]  # (pins,) nodes that are moved
    paths: NDArray[np.float64]  # (pins, 5, 3): four coefficients, and the start time in [4, 0]
    carried: NDArray[np.int64]  # (fairleads, 2): node, body
    arms: NDArray[np.float64]  # (fairleads, 3) [m] from the body's reference point
    # (bodies, 219): inverse mass, mass, stiffness and damping matrix; place at rest [m]; roots of the inverse mass
    bodies: NDArray[np.float64]
    steady: NDArray[np.float64]  # (bodies, 6) [N, N m] steady forces on bodies
    # (bodies, 12, waves) [N/m, N]: real, then imaginary part of X, see `sim.springs.forces.under_water.bodies`
    excitation: NDArray[np.float64]
    stop: NDArray[np.int64]  # (2,) that ends a long solve, see sim.interruption
