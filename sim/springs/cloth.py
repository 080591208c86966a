"""`cloth`: a rectangle of particles with structural, shear and bend springs."""

import dataclasses
import math
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.numerics.root import narrowed
from sim.springs.laws import check_law
from sim.springs.net import (
    CLOTH,
    DAMPING_MODELS,
    FARTHEST,
    Air,
    Contact,
    Family,
    Net,
    Vector,
    check_particle,
    check_place,
    check_surroundings,
)
from sim.validation import argument_error, check_choice, check_number, check_positive, is_whole_number
from sim.water import EARTH_GRAVITY

PIN_CHOICES = ("corners", "edge", "all corners", "rim", "free")
MAX_ROWS = 1024  # and columns
PLEATS = 4


def held(hold: str, rows: int, cols: int) -> frozenset[tuple[int, int]]:
    """The pinned particles: corners (0, 0) and (0, cols - 1), the edge between them, four corners, the rim, or none."""
    check_choice("pinned", hold, PIN_CHOICES)
    corners = {(0, 0), (0, cols - 1)}
    far = {(rows - 1, 0), (rows - 1, cols - 1)}
    edge = {(0, j) for j in range(cols)}
    rim = {(i, j) for i in range(rows) for j in range(cols) if i in (0, rows - 1) or j in (0, cols - 1)}
    return frozenset({"corners": corners, "edge": edge, "all corners": corners | far, "rim": rim, "free": set()}[hold])


def cloth(
    rows: int = 32,
    cols: int = 32,
    width: float = 1.0,
    length: float = 1.0,
    density: float = 1.0,
    stiffness: float = 981.0,
    shear: float = 490.0,
    bend: float = 98.0,
    damping: float = 0.002,
    drag: float = 0.0,
    gravity: float = EARTH_GRAVITY,
    origin: Vector = (0.0, 0.0, 0.0),
    pinned: str | Iterable[tuple[int, int]] = "corners",
    floor: float | None = None,
    sphere: tuple[float, float, float, float] | None = None,
    damping_model: str = "isotropic",
    *,
    law: Any = "spring",
    contact: Contact | None = None,
    radius: float = 0.0,
    air: Air | None = None,
    thickness: float = 0.0,
) -> Net:
    """A cloth at rest in a level plane: particle (i, j) is at origin + (j width/(cols-1), i length/(rows-1), 0).

    width, length: [m]. density: [kg/m^2]; a particle has the mass of the cloth nearest to it. stiffness, shear, bend:
    [N/m] of a link to the next particle, across a cell, and to the next but one; damping [N s/m] of a link. A link
    along an edge, beside half a strip of cloth, has half of both. drag [N s/m] of a particle.
    pinned: "corners" (0, 0) and (0, cols - 1), "edge" between them, "all corners", "rim", "free", or the particles.
    thickness [m]: nearer particles push with the contact's stiffness, and with explicit methods no part of the cloth
    passes another, at any thickness above 0; 0: they pass. air: wind. The rest: as of `rope`.

    Raises ValueError, naming the argument, its value and what is allowed.

    >>> cloth(24, 36, width=1.5, length=1.0).x0[:, -1, -1].tolist()  # [m]
    [1.5, 1.0, 0.0]
    """
    for name, count in (("rows", rows), ("cols", cols)):
        if not is_whole_number(count) or not 2 <= count <= MAX_ROWS:
            raise argument_error(name, count, f"a whole number from 2 to {MAX_ROWS}")
    check_number("width", width, "m", 0, FARTHEST, above=True)
    check_number("length", length, "m", 0, FARTHEST, above=True)
    check_positive("density", density, "kg/m^2")
    for name, value in (("stiffness", stiffness), ("shear", shear), ("bend", bend)):
        check_number(name, value, "N/m", 0)
    check_number("damping", damping, "N s/m", 0)
    check_number("drag", drag, "N s/m", 0)
    check_number("gravity", gravity, "m/s^2")
    check_number("radius", radius, "m", 0)
    check_number("thickness", thickness, "m", 0)
    check_place("origin", origin)
    check_choice("damping_model", damping_model, DAMPING_MODELS)
    contact = check_surroundings(contact, floor, sphere)

    dx, dy = width / (cols - 1), length / (rows - 1)
    rests = (dx, dy, math.hypot(dx, dy), math.hypot(dx, dy), 2.0 * dx, 2.0 * dy)
    springs = (stiffness, stiffness, shear, shear, bend, bend)
    links = zip(CLOTH, rests, springs, strict=True)
    families = tuple(Family(di, dj, rest, float(k), float(damping)) for (di, dj), rest, k in links)
    j, i = np.meshgrid(dx * np.arange(cols), dy * np.arange(rows))
    x0 = np.stack([j, i, np.zeros_like(i)]) + np.asarray(origin, dtype=np.float64)[:, None, None]
    return Net(
        x0=np.ascontiguousarray(x0),
        families=families,
        mass=density * dx * dy,
        mass_ratios=cells_around(rows, cols),
        side_ratio=0.5,
        drag=float(drag),
        gravity=(0.0, 0.0, -float(gravity)),
        pinned=pinned_particles(pinned, int(rows), int(cols)),
        damping_model=damping_model,
        law=check_law(law),
        floor=None if floor is None else float(floor),
        sphere=None if sphere is None else tuple(float(c) for c in sphere),  # type: ignore[arg-type]
        contact=contact,
        radius=float(radius),
        air=air,
        thickness=float(thickness),
    )


def cells_around(rows: int, cols: int) -> NDArray[np.float64]:
    """(rows, cols) cells of cloth that belong to each particle: 1, on an edge 1/2, at a corner 1/4."""
    across, down = np.ones(cols), np.ones(rows)
    across[[0, -1]] = down[[0, -1]] = 0.5
    return np.outer(down, across)


def pinned_particles(pinned: object, rows: int, cols: int) -> frozenset[tuple[int, int]]:
    """`cloth`'s pinned as (row, column) pairs; raises ValueError for one that is not a particle."""
    if isinstance(pinned, str):
        return held(pinned, rows, cols)
    if not isinstance(pinned, Iterable):
        raise argument_error("pinned", pinned, "one of " + ", ".join(PIN_CHOICES) + ", or (row, column) pairs")
    return frozenset(check_particle("pinned", pair, rows, cols) for pair in pinned)


def vertical_cloth(net: Net) -> Net:
    """The same cloth hanging in the vertical plane below its first row instead of lying level."""
    x, y, z = net.x0
    return dataclasses.replace(net, x0=np.ascontiguousarray(np.stack([x, np.full_like(y, y[0, 0]), z - (y - y[0, 0])])))


def pleated_cloth(net: Net, gather: float) -> Net:
    """A vertical cloth on `gather` (0 to 1) of its width, in PLEATS sine waves that keep its width as arc length."""
    x, y, z = net.x0
    width = float(x[0, -1] - x[0, 0])
    s = np.linspace(0.0, gather * width, 2001)
    phase = 2.0 * math.pi * PLEATS * s / s[-1]

    def arc_length_at(amplitude: float) -> NDArray[np.float64]:
        return np.concatenate([[0.0], np.hypot(np.diff(s), np.diff(amplitude * np.sin(phase))).cumsum()])

    # The wave is as long as the cloth is wide.
    ends = narrowed(lambda amplitude: arc_length_at(amplitude)[-1] - width, 0.0, width, 1e-15 * width)
    amplitude = float(ends[1])
    arc_length = arc_length_at(amplitude)
    # Particles lie at equal arc lengths along the wave.
    along = np.interp(np.linspace(0.0, arc_length[-1], x.shape[1]), arc_length, s)
    out = amplitude * np.sin(2.0 * math.pi * PLEATS * along / s[-1])
    return dataclasses.replace(net, x0=np.ascontiguousarray(np.stack([x[0, 0] + along + 0.0 * y, y + out, z])))
