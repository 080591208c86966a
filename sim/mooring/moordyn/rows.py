"""The rows of a MoorDyn file: line types, bodies, points and lines."""

import math
import re
from collections.abc import Collection, Container, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.mooring.moordyn.sections import (
    BODIES,
    LINES,
    POINTS,
    TYPES,
    Section,
    check_columns,
    number_in,
    numbers_in,
    read_text,
    whole_in,
)
from sim.mooring.parts import Line, LineType, Point, Vector
from sim.tables import Row, factor_of, measure_of, number_of
from sim.tables.columns import FORCE, STRAIN
from sim.validation import argument_error

ATTACHMENT = re.compile(r"([A-Za-z]+)(\d*)", re.ASCII)
FIXED, COUPLED = ("anchor", "fixed", "fix"), ("fairlead", "vessel", "ves", "coupled", "cpld")
FREE = ("free", "point", "connect", "con")
PINNED = ("vesselpinned", "vespin", "cpldpin", "coupledpinned")
ROD_END = re.compile(r"r(?:od)?(\d+[ab])", re.IGNORECASE | re.ASCII)  # R1A
CURVE_HEADER = 3  # lines of a file of strain and tension before its rows
MAX_CURVE_ROWS = 1000
MAX_LISTED = 30  # names in an error


class FileBody(NamedTuple):
    """A row of BODIES."""

    id: int
    kind: str  # fixed, coupled or free
    place: NDArray[np.float64]  # (3,) [m]
    turn: NDArray[np.float64]  # (3, 3) from the body's axes to those of space
    mass: float  # [kg]
    centre: NDArray[np.float64]  # (3,) [m] of gravity, in the body's axes
    inertia: NDArray[np.float64]  # (3,) [kg m^2] about it
    volume: float  # [m^3]
    drag_area: float  # [m^2] mean of the three directions
    added: NDArray[np.float64]  # (3,) coefficients along the body's axes


class RodEnd(NamedTuple):
    """An end of a rod, as lines see it."""

    point: int  # its ID
    outward: Vector | None  # direction in which a line with EI leaves it; None for one that is hinged


def read_type(row: Row, folder: Path) -> LineType:
    """Name Diam Mass EA BA/-zeta EI Cd Ca CdAx CaAx [Cl dF cF], or as of version 1: EI Can Cat Cdn Cdt without EI."""
    where = f"{TYPES}, line {row.number}"
    name, *rest = check_columns(where, row.words, 9, 13, 9)
    is_first_version = len(rest) == 8
    diameter, mass = number_in(where, rest[0]), number_in(where, rest[1])
    stiffness, curve = read_stiffness(where, rest[2], folder)
    damping = only_number(f"{where}: BA", rest[3], "damping that changes is not modelled")
    if is_first_version:
        added, added_along, drag, drag_along = (number_in(where, text) for text in rest[4:])
        bending = 0.0
    else:
        bending = only_number(f"{where}: EI", rest[4], "an EI that changes is not modelled")
        drag, added, drag_along, added_along = (number_in(where, text) for text in rest[5:9])
    if len(rest) > 9 and number_in(f"{where}: Cl", rest[9]) != 0.0:
        raise argument_error(f"{where}: Cl", rest[9], "0: vortex-induced vibrations are not modelled")
    return LineType(name, diameter, mass, stiffness, damping, added, drag, added_along, drag_along, bending, curve)


def only_number(where: str, text: str, reason: str) -> float:
    """`text` as a number. Raises ValueError, for a list or the name of a file with the reason."""
    if "|" in text or ":" in text or re.search(r"[A-Za-z_]\w*\.\w+$", text):
        raise argument_error(where, text, f"one number: {reason}")
    return number_in(where, text)


def read_stiffness(where: str, text: str, folder: Path) -> tuple[float, tuple[tuple[float, float], ...]]:
    """EA [N], and the rows of a file of strain and tension; empty for a number."""
    where = f"{where}: EA"
    if number_of(text) is not None:
        return number_in(where, text), ()
    if "|" in text or text.upper().startswith("SYROPE"):
        raise argument_error(
            where, text, "a number, or a file of strain and tension: viscoelastic and Syrope lines are not modelled"
        )
    if not re.search(r"\.\w+$", text):
        return number_in(where, text), ()
    rows = [(0.0, 0.0)]
    lines = read_text(folder / text).splitlines()
    check_curve_units(f"{where}: {text}, line {CURVE_HEADER}", lines[CURVE_HEADER - 1 : CURVE_HEADER])
    for number, line in enumerate(lines[CURVE_HEADER:], CURVE_HEADER + 1):
        words = line.split()
        if not words or line.lstrip().startswith(("#", "!")):
            continue
        of_row = f"{where}: {text}, line {number}"
        strain, tension = (number_in(of_row, word) for word in check_columns(of_row, words, 2, 2))
        if strain > 0.0:  # MoorDyn's lines do not push
            rows.append((strain, tension))
    if not 2 <= len(rows) <= MAX_CURVE_ROWS:
        raise argument_error(
            f"{where}: {text}", f"{len(rows) - 1} rows", f"1 to {MAX_CURVE_ROWS - 1} rows of strain and tension"
        )
    return rows[-1][1] / rows[-1][0], tuple(rows)


def check_curve_units(where: str, lines: list[str]) -> None:
    """Raises ValueError for a line of units other than those that MoorDyn reads, as it ignores the header."""
    for word in " ".join(lines).split():
        measure = measure_of(word.strip("[]()"))
        if measure is not None and any(factor_of(kind, measure)[0] not in (None, 1.0) for kind in (STRAIN, FORCE)):
            raise argument_error(where, word, "strain without a unit, and tension in N, as MoorDyn reads them")


def listed(names: Collection[object]) -> str:
    """The names, or their number if they are many."""
    return str(list(names)) if len(names) <= MAX_LISTED else f"{len(names)} of the file"


def read_kind(where: str, text: str) -> tuple[str, int | None]:
    """Kind of an attachment, and the number behind it, as in Body2. Raises ValueError for one that is not modelled."""
    match = ATTACHMENT.fullmatch(text)
    word = match.group(1).lower() if match else ""
    number = int(match.group(2)) if match and match.group(2) else None
    for kind, words in (("fixed", FIXED), ("coupled", COUPLED), ("free", FREE), ("body", ("body",))):
        if word in words:
            return kind, number
    allowed = "Fixed, Coupled or Free"
    if word in PINNED or word == "turbine":
        what = "pinned bodies" if word in PINNED else "several turbines of a farm"
        raise argument_error(where, text, f"{allowed}: {what} are not modelled")
    raise argument_error(where, text, f"{allowed}, or for points BodyN")


def read_body(row: Row) -> FileBody:
    """ID Attachment X0 Y0 Z0 r0 p0 y0 Mass CG I Volume CdA Ca; angles in degrees."""
    where = f"{BODIES}, line {row.number}"
    words = check_columns(where, row.words, 14, 14, 14)
    kind, _ = read_kind(f"{where}: attachment", words[1])
    if kind == "body":
        raise argument_error(f"{where}: attachment", words[1], "Fixed, Coupled or Free")
    place = np.array([number_in(where, text) for text in words[2:5]])
    turn = rotation(*(math.radians(number_in(where, text)) for text in words[5:8]))
    mass, volume = number_in(f"{where}: mass", words[8]), number_in(f"{where}: volume", words[11])
    centre, inertia = numbers_in(f"{where}: CG", words[9], (1, 3)), numbers_in(f"{where}: I", words[10], (1, 3))
    drag, added = numbers_in(f"{where}: CdA", words[12], (1, 2, 3, 6)), numbers_in(f"{where}: Ca", words[13], (1, 3))
    for name, numbers in (("mass", [mass]), ("volume", [volume]), ("I", inertia), ("CdA", drag), ("Ca", added)):
        if min(numbers) < 0.0:
            raise argument_error(f"{where}: {name}", min(numbers), "0 or above")
    return FileBody(
        whole_in(where, words[0]), kind, place, turn, mass,
        np.array([0.0, 0.0, centre[0]] if len(centre) == 1 else centre), np.resize(inertia, 3), volume,
        float(np.mean(drag[:1] if len(drag) < 3 else drag[:3])), np.resize(added, 3),
    )  # fmt: skip


def rotation(roll: float, pitch: float, yaw: float) -> NDArray[np.float64]:
    """Matrix (3, 3) of MoorDyn's angles [rad]: about x, then the new y, then the new z."""
    (a, b, c), (d, e, f) = (np.cos((roll, pitch, yaw)), np.sin((roll, pitch, yaw)))
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, a, -d], [0.0, d, a]])
    about_y = np.array([[b, 0.0, e], [0.0, 1.0, 0.0], [-e, 0.0, b]])
    about_z = np.array([[c, -f, 0.0], [f, c, 0.0], [0.0, 0.0, 1.0]])
    return about_x @ about_y @ about_z


def read_point(row: Row, bodies: Mapping[int, FileBody]) -> Point:
    """ID Attachment X Y Z M V CdA [CA], or with FX FY FZ before CdA; a point of a body is at a place in its axes.

    A tenth column is an index of MoorDyn-F for points of other programs. MoorDyn does not read it.
    """
    where = f"{POINTS}, line {row.number}"
    words = check_columns(where, row.words, 8, 12, 8)
    if len(words) == 11:
        raise argument_error(where, " ".join(words), "8 to 10 columns, or 12 with a force")
    words = words[:9] if len(words) == 10 else words
    kind, number = read_kind(f"{where}: attachment", words[1])
    numbers = [number_in(where, text) for text in words[2:]]
    place, (mass, volume) = np.array(numbers[:3]), numbers[3:5]
    force = numbers[5:8] if len(words) == 12 else [0.0, 0.0, 0.0]
    drag_area, added = (*numbers[8 if len(words) == 12 else 5 :], 0.0)[:2]
    body = None
    if kind == "body":
        if number is None or number not in bodies:
            raise argument_error(f"{where}: attachment", words[1], f"a body of the file: {listed(bodies)}")
        owner = bodies[number]
        place = owner.place + owner.turn @ place
        kind, body = ("body", number) if owner.kind == "free" else (owner.kind, None)
    x, y, z = place.tolist()
    loads: Vector = (force[0], force[1], force[2]) if kind in ("free", "body") else (0.0, 0.0, 0.0)
    return Point(whole_in(where, words[0]), kind, (x, y, z), mass, volume, drag_area, added, body, loads)


def read_end(where: str, text: str, points: Mapping[int, Point], rod_ends: Mapping[str, RodEnd]) -> RodEnd:
    """The point that an end of a line is attached to; rod_ends: those of "1a", "1b"."""
    of_rod = ROD_END.fullmatch(text)
    if of_rod is not None:
        if of_rod[1].lower() not in rod_ends:
            raise argument_error(f"{where}: attachment", text, f"an end of a rod, as R1A: {listed(rod_ends)}")
        return rod_ends[of_rod[1].lower()]
    if not re.fullmatch(r"(?i)(point|p|con|c)?\d{1,9}", text):
        raise argument_error(f"{where}: attachment", text, "the ID of a point")
    number = int(re.sub(r"\D", "", text))
    if number not in points:
        raise argument_error(f"{where}: attachment", text, f"one of the points {listed(points)}")
    return RodEnd(number, None)


def ends_first(section: Section, points: Container[int]) -> bool:
    """True if the ends of a line stand before its length and segments, as in version 2, and not behind them.

    The values decide. If both orders fit, the column names do: some files have those of the other version.
    """
    names = section.columns
    by_name = not any(name.startswith("unstr") for name in names[2:3])

    def fit(first: int) -> bool:
        return all(
            len(row.words) >= first + 2
            and all(
                ROD_END.fullmatch(word) or (re.fullmatch(r"\d{1,9}", word) and int(word) in points)
                for word in row.words[first : first + 2]
            )
            for row in section.rows
        )

    fits = fit(2), fit(4)
    return by_name if fits[0] == fits[1] else fits[0]


def read_line(
    row: Row,
    ends_first: bool,
    types: Mapping[str, LineType],
    points: Mapping[int, Point],
    rod_ends: Mapping[str, RodEnd],
) -> Line:
    """ID LineType AttachA AttachB UnstrLen NumSegs [Outputs]; in version 1 the ends stand behind the length and number.

    A negative length is in distances of the ends. rod_ends: those of "1a", "1b".
    """
    where = f"{LINES}, line {row.number}"
    words = check_columns(where, row.words, 6, 7, 7)
    if words[1] not in types:
        raise argument_error(f"{where}: type", words[1], f"one of {listed(types)}")
    first, numbers = (words[2:4], words[4:6]) if ends_first else (words[4:6], words[2:4])
    start, end = (read_end(where, text, points, rod_ends) for text in first)
    length = number_in(where, numbers[0])
    if length < 0.0:
        length *= -math.dist(points[start.point].position, points[end.point].position)
    kind = types[words[1]]
    out, into = (one.outward if kind.bending > 0.0 else None for one in (start, end))
    into = None if into is None else (-into[0], -into[1], -into[2])
    return Line(
        whole_in(where, words[0]), kind, start.point, end.point, length, whole_in(where, numbers[1]), out, into
    )  # fmt: skip
