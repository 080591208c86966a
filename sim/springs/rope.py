"""`rope`: a line of points joined by springs, in the lab's units; `lab_units` from a rope's material."""

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.springs.laws import check_law
from sim.springs.net import DAMPING_MODELS, FARTHEST, Contact, Family, Net, Vector, check_place, check_surroundings
from sim.validation import (
    argument_error,
    as_array,
    check_choice,
    check_kind,
    check_number,
    check_positive,
    is_whole_number,
)
from sim.water import EARTH_GRAVITY

MAX_POINTS = 1_000_000


def rope(
    points: int = 10,
    length: float = 2.0,
    mass: float | ArrayLike = 1.0,
    stiffness: float = 800.0,
    damping: float = 7.0,
    drag: float = 1.0,
    gravity: float = EARTH_GRAVITY,
    root: Vector = (0.0, 0.0, 0.0),
    floor: float | None = None,
    sphere: tuple[float, float, float, float] | None = None,
    damping_model: str = "isotropic",
    *,
    end: Vector | None = None,
    law: Any = "spring",
    contact: Contact | None = None,
    radius: float = 0.0,
    self_contact: bool = False,
) -> Net:
    """A rope in the lab's units, at rest from `root` along -x; point 0 is the fixed root.

    points: from 1. length: rest length of the whole [m]. mass: [kg] per point, one number or (points,). stiffness [N/m]
    and damping [N s/m] per link; drag [N s/m] per point; gravity [m/s^2] along -z. floor: height [m]; sphere: (x, y, z,
    radius) [m]. damping_model: "isotropic", the lab's eq. 4, b (v1 - v2); or "axial", its part along the link only.
    law: of the links, a name in `LAWS` or its numbers, as `sim.springs.laws.stiffening.Stiffening(30.0)`.
    end: where the last point is pinned too [m]; the points then start on the straight line from root to end.
    radius: of the points and links, for contact [m]. self_contact: True: links of this radius push each other with the
    contact's stiffness, damping and friction. Links with less than a half circle of rope between them, which the
    tightest bend needs, do not.

    Raises ValueError, naming the argument, its value and what is allowed.

    >>> from sim.springs import rope
    >>> net = rope(points=10, stiffness=800.0)
    >>> net.x0[:, 0, -1].tolist()  # the free end [m]
    [-2.0, 0.0, 0.0]
    """
    check_points(points)
    check_number("length", length, "m", 0, FARTHEST, above=True)
    each, ratios = masses_of(mass, points)
    check_number("stiffness", stiffness, "N/m", 0)
    check_number("damping", damping, "N s/m", 0)
    check_number("drag", drag, "N s/m", 0)
    check_number("gravity", gravity, "m/s^2")
    check_number("radius", radius, "m", 0)
    check_kind("self_contact", self_contact, bool, "True or False")
    if self_contact and radius == 0.0:
        raise argument_error("self_contact", self_contact, "False, as a rope of radius 0 has nothing that touches")
    check_place("root", root)
    if end is not None:
        check_place("end", end)
        if points == 1:
            raise argument_error("end", end, "None, as a rope of one point has no other end")
    check_choice("damping_model", damping_model, DAMPING_MODELS)
    contact = check_surroundings(contact, floor, sphere)

    n = int(points)
    rest = length / max(n - 1, 1)
    start = np.asarray(root, dtype=np.float64)
    stop = start - (length, 0.0, 0.0) if end is None else np.asarray(end, dtype=np.float64)
    along = np.linspace(0.0, 1.0, n)
    x0 = start[:, None] + (stop - start)[:, None] * along
    return Net(
        x0=np.ascontiguousarray(x0.reshape(3, 1, n)),
        families=(Family(0, 1, rest, float(stiffness), float(damping)),),
        mass=each,
        mass_ratios=ratios,
        drag=float(drag),
        gravity=(0.0, 0.0, -float(gravity)),
        pinned=frozenset({(0, 0)} if end is None else {(0, 0), (0, n - 1)}),
        damping_model=damping_model,
        law=check_law(law),
        floor=None if floor is None else float(floor),
        sphere=None if sphere is None else tuple(float(c) for c in sphere),  # type: ignore[arg-type]
        contact=contact,
        radius=float(radius),
        thickness=2.0 * float(radius) if self_contact else 0.0,
    )


def masses_of(mass: Any, points: int) -> tuple[float, NDArray[np.float64] | None]:
    """A net's mass [kg] and ratios of one number or (points,). Raises ValueError for others."""
    if not isinstance(mass, list | tuple | np.ndarray):
        return check_positive("mass", mass, "kg"), None
    allowed = f"a number above 0 kg, or {points} of them"
    array = as_array("mass", mass, allowed)
    if array.shape != (points,) or not ((array > 0.0) & (array < math.inf)).all():
        raise argument_error("mass", mass, allowed)
    return float(array[0]), (array / array[0]).reshape(1, -1).astype(np.float64)


def check_points(points: object) -> None:
    """Raises ValueError unless `points` is a number of points that a rope can have."""
    if not is_whole_number(points) or not 1 <= points <= MAX_POINTS:  # type: ignore[operator]
        raise argument_error("points", points, f"a whole number from 1 to {MAX_POINTS}")


def lab_units(
    points: int,
    length: float,
    axial_stiffness: float,
    mass_per_length: float,
    axial_viscosity: float,
    drag_per_length: float,
) -> dict[str, Any]:
    """`rope`'s per-link and per-point numbers of a rope given in material units, so that points only refine it.

    axial_stiffness EA [N], mass_per_length [kg/m], axial_viscosity [N s], drag_per_length [N s/m^2].
    With n links: k = EA n / L, m = mu L / n, b = eta n / L, c = drag L / n. Masses are (points,) [kg], that of the last
    point half a link's. So the error falls with 1/n^2; with drag with 1/n where that end is free, as each point has one
    drag.

    Raises ValueError, naming the argument, its value and what is allowed.

    >>> material = {"axial_stiffness": 500.0, "mass_per_length": 1.0, "axial_viscosity": 0.1, "drag_per_length": 0.0}
    >>> net = rope(11, 2.0, **lab_units(11, 2.0, **material))
    >>> net.families[0].stiffness  # [N/m] of each of ten links
    2500.0
    >>> net.masses[0, -2:].tolist()  # [kg]
    [0.2, 0.1]
    """
    check_points(points)
    check_number("length", length, "m", 0, FARTHEST, above=True)
    check_number("axial_stiffness", axial_stiffness, "N", 0)
    check_positive("mass_per_length", mass_per_length, "kg/m")
    check_number("axial_viscosity", axial_viscosity, "N s", 0)
    check_number("drag_per_length", drag_per_length, "N s/m^2", 0)
    spacing = length / max(points - 1, 1)
    mass = np.full(points, mass_per_length * spacing)
    if points > 1:
        mass[-1] /= 2.0
    return {
        "mass": mass,
        "stiffness": axial_stiffness / spacing,
        "damping": axial_viscosity / spacing,
        "drag": drag_per_length * spacing,
    }
