"""MoorDyn's input files, version 2: LINE TYPES, POINTS, LINES and OPTIONS are read and written.

A section begins with a line of dashes and its name, then two lines of column names and units; OPTIONS has none. What is
not understood is refused in one line that names the section: nothing of a mooring is left out in silence.
"""

import math
import re
from pathlib import Path
from typing import Any

from sim.files import replacing
from sim.mooring.system import Line, LineType, Point, System
from sim.validation import argument_error

NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eEdD][-+]?\d+)?", re.ASCII)
HEADER = re.compile(r"-{3,}\s*(.*?)\s*-*$")
TYPES, POINTS, LINES, OPTIONS = "LINE TYPES", "POINTS", "LINES", "OPTIONS"
ALIASES = {
    "LINE TYPES": TYPES, "LINE DICTIONARY": TYPES, "POINTS": POINTS, "POINT LIST": POINTS, "POINT PROPERTIES": POINTS,
    "CONNECTION PROPERTIES": POINTS, "LINES": LINES, "LINE LIST": LINES, "LINE PROPERTIES": LINES,
    "OPTIONS": OPTIONS, "SOLVER OPTIONS": OPTIONS,
}  # fmt: skip
UNREAD = ("", "NEED THIS LINE", "END", "END OF INPUT FILE", "OUTPUT", "OUTPUTS")  # what MoorDyn would write
KINDS = {"fixed": "fixed", "fix": "fixed", "anchor": "fixed", "coupled": "coupled", "vessel": "coupled",
         "ves": "coupled", "free": "free", "point": "free", "connect": "free", "con": "free"}  # fmt: skip
# Options of a System, by MoorDyn's names in small letters, and its defaults.
FIELDS = {"g": "gravity", "gravity": "gravity", "rhow": "density", "wtrdnsty": "density", "wtrdpth": "depth",
          "depth": "depth", "kbot": "bed_stiffness", "kb": "bed_stiffness", "cbot": "bed_damping", "cb": "bed_damping",
          "frictioncoefficient": "friction", "mu_kt": "friction"}  # fmt: skip
# How MoorDyn steps, starts and writes: of no meaning here.
IGNORED = {"dtm", "dtic", "tmaxic", "cdscaleic", "cddampscaleic", "threshic", "writelog", "tscheme", "writeunits",
           "dtout", "disableoutput", "disableouttime", "fricdamp", "staticdynamicfrictionscale", "mu_ka", "mc",
           "icdfac", "icdt", "ictmax", "icthresh", "inertialf", "inertialf_rampt", "outswitch", "ic_gen",
           "startic", "cv"}  # fmt: skip
ZERO = {"wavekin", "waves", "currentmod", "currents", "unifycurrentgrid", "dtwave", "wavegrid", "waterkin"}


def sections(path: Path) -> dict[str, list[tuple[int, list[str]]]]:
    """The rows of each section, with the numbers of their lines."""
    found: dict[str, list[tuple[int, list[str]]]] = {}
    current, skip = None, 0
    try:
        text = path.read_text(encoding="utf-8-sig", errors="replace")
    except OSError as error:
        raise argument_error("file", str(path), f"a file that can be read ({error.strerror})") from None
    for number, line in enumerate(text.splitlines(), 1):
        header = HEADER.match(line.strip())
        if header:
            name = re.sub(r"\s+", " ", header.group(1)).upper()
            current = ALIASES.get(name)
            if current is not None:
                skip = 0 if current == OPTIONS else 2
                if current in found:
                    raise argument_error(f"line {number}: section", header.group(1), f"one section {current}")
                found[current] = []
            elif number > 2 and name not in UNREAD and "MOORDYN" not in name:
                raise argument_error(f"line {number}: section", header.group(1), f"one of {sorted(set(ALIASES))}")
            continue
        if current is None:
            continue
        row = re.split(r"(?:^|\s)[#!]", line, maxsplit=1)[0].split()  # without a comment
        if skip:
            skip -= 1
            if any(map(NUMBER.fullmatch, row)):
                raise argument_error(
                    f"{current}, line {number}", line.strip(), "a line of column names, then one of units"
                )
        elif row:
            found[current].append((number, row))
    for name in (TYPES, POINTS, LINES):
        if not found.get(name):
            raise argument_error("file", str(path.name), f"a MoorDyn file with a section {name}")
    return found


def number_in(where: str, text: str) -> float:
    """The finite number that `text` is; raises ValueError otherwise."""
    value = float(re.sub("[dD]", "e", text)) if NUMBER.fullmatch(text) else math.nan
    if not math.isfinite(value):
        raise argument_error(where, text, "a finite number")
    return value


def whole_in(where: str, text: str) -> int:
    """The whole number that `text` is; raises ValueError otherwise."""
    value = number_in(where, text)
    if value != int(value):
        raise argument_error(where, text, "a whole number")
    return int(value)


def columns(section: str, number: int, row: list[str], count: int, most: int) -> list[str]:
    """The row; raises ValueError where it has fewer columns, or more than `most`."""
    if not count <= len(row) <= most:
        raise argument_error(f"{section}, line {number}", " ".join(row), f"{count} columns")
    return row


def read_type(number: int, row: list[str]) -> LineType:
    """Name Diam MassDenInAir EA BA/-zeta EI Cd Ca CdAx CaAx."""
    name, *rest = columns(TYPES, number, row, 10, 10)
    where = f"{TYPES}, line {number}"
    if any("|" in text for text in rest):
        raise argument_error(where, " ".join(rest), "constant stiffness and damping")
    if any(re.search(r"[A-Za-z_]\w*\.\w+$", text) for text in rest[:4]):
        raise argument_error(where, " ".join(rest), "numbers, no file of a stress curve")
    diameter, mass, stiffness, damping, bending, drag, added, drag_along, added_along = (
        number_in(where, text) for text in rest[:9]
    )
    if bending != 0.0:
        raise argument_error(f"{where}: EI", bending, "0: lines here do not resist bending")
    return LineType(name, diameter, mass, stiffness, damping, added, drag, added_along, drag_along)


def read_point(number: int, row: list[str]) -> Point:
    """ID Attachment X Y Z M V CdA CA."""
    where = f"{POINTS}, line {number}"
    row = columns(POINTS, number, row, 9, 9)
    kind = KINDS.get(row[1].lower())
    if kind is None:
        raise argument_error(f"{where}: attachment", row[1], "Fixed, Coupled or Free")
    x, y, z, mass, volume, drag_area, added = (number_in(where, text) for text in row[2:9])
    return Point(whole_in(where, row[0]), kind, (x, y, z), mass, volume, drag_area, added)


def read_line(number: int, row: list[str], types: dict[str, LineType], points: dict[int, Point]) -> Line:
    """ID LineType AttachA AttachB UnstrLen NumSegs [Outputs]."""
    where = f"{LINES}, line {number}"
    row = columns(LINES, number, row, 6, 7)
    if row[1] not in types:
        raise argument_error(f"{where}: type", row[1], f"one of {sorted(types)}")
    ends = []
    for text in row[2:4]:
        if not re.fullmatch(r"(?i)(point|p|con)?\d+", text):
            raise argument_error(f"{where}: attachment", text, "the ID of a point; BODIES and RODS are not read")
        ends.append(int(re.sub(r"\D", "", text)))
        if ends[-1] not in points:
            raise argument_error(f"{where}: attachment", text, f"one of the points {sorted(points)}")
    start, end = ends
    return Line(whole_in(where, row[0]), types[row[1]], start, end, number_in(where, row[4]), whole_in(where, row[5]))


def read_options(rows: list[tuple[int, list[str]]]) -> dict[str, float]:
    """Fields of a System."""
    found: dict[str, float] = {}
    for number, row in rows:
        where = f"{OPTIONS}, line {number}"
        value, name = columns(OPTIONS, number, row, 2, len(row))[:2]
        key = name.lower()
        if key in IGNORED:
            continue
        if key in ZERO:
            if number_in(f"{where}: {name}", value) != 0.0:
                raise argument_error(f"{where}: {name}", value, "0: water is still, or set by `waves` and `current`")
        elif key in FIELDS:
            add_new(found, FIELDS[key], number_in(f"{where}: {name}", value), f"{where}: {name}")
        else:
            raise argument_error(f"{where}: option", name, f"one of {sorted({*FIELDS, *IGNORED, *ZERO})}")
    return found


def add_new(found: dict[Any, Any], key: object, value: object, where: str) -> None:
    """Add an entry. Raises ValueError where there is one of that key."""
    if key in found:
        raise argument_error(where, key, "one that no other has")
    found[key] = value


def read_moordyn(path: str | Path) -> System:
    """The System of a MoorDyn v2 file. Raises ValueError with the section and the line that it cannot read."""
    path = Path(path)
    found = sections(path)
    kinds: dict[str, LineType] = {}
    for number, row in found[TYPES]:
        kind = read_type(number, row)
        add_new(kinds, kind.name, kind, f"{TYPES}, line {number}: name")
    points: dict[int, Point] = {}
    for number, row in found[POINTS]:
        point = read_point(number, row)
        add_new(points, point.id, point, f"{POINTS}, line {number}: ID")
    lines: dict[int, Line] = {}
    for number, row in found[LINES]:
        line = read_line(number, row, kinds, points)
        add_new(lines, line.id, line, f"{LINES}, line {number}: ID")
    options = read_options(found.get(OPTIONS, []))
    if "depth" not in options:
        anchors = [point.position[2] for point in points.values() if point.kind == "fixed"]
        if not anchors or min(anchors) >= 0.0:
            raise argument_error(f"{OPTIONS}: WtrDpth", None, "the depth of the water [m]")
        options["depth"] = -min(anchors)
    depth = options.pop("depth")
    return System(tuple(lines.values()), tuple(points.values()), depth, **options)  # type: ignore[arg-type]


def write_moordyn(path: str | Path, system: System) -> None:
    """Write a System as a MoorDyn v2 file. Raises ValueError for one with bodies, waves or current."""
    for name, value in (("bodies", system.bodies), ("waves", system.waves), ("current", any(system.current))):
        if value:
            raise argument_error(f"system: {name}", value, "none: a MoorDyn file of lines and points holds none")
    kinds = {line.type.name: line.type for line in system.lines}
    if len(kinds) < len({line.type for line in system.lines}):
        raise argument_error("system: line types", sorted(kinds), "a name of its own for each type")
    rows = [
        "--------------------- MoorDyn Input File ---------------------", "Written by Springtide",
        "---------------------- LINE TYPES ----------------------",
        "Name Diam MassDenInAir EA BA/-zeta EI Cd Ca CdAx CaAx",
        "(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)",
    ]  # fmt: skip
    for kind in kinds.values():
        numbers = (
            kind.diameter, kind.mass, kind.stiffness, kind.damping, 0.0, kind.drag_across, kind.added_across,
            kind.drag_along, kind.added_along,
        )  # fmt: skip
        rows.append(" ".join([kind.name, *(f"{number:.17g}" for number in numbers)]))
    rows += ["---------------------- POINTS ----------------------", "ID Attachment X Y Z M V CdA CA",
             "(#) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)"]  # fmt: skip
    for point in system.points:
        numbers = (*point.position, point.mass, point.volume, point.drag_area, point.added_mass)
        rows.append(" ".join([str(point.id), point.kind.capitalize(), *(f"{number:.17g}" for number in numbers)]))
    rows += ["---------------------- LINES ----------------------",
             "ID LineType AttachA AttachB UnstrLen NumSegs Outputs", "(#) (name) (#) (#) (m) (-) (-)"]  # fmt: skip
    for line in system.lines:
        rows.append(f"{line.id} {line.type.name} {line.start} {line.end} {line.length:.17g} {line.segments} -")
    rows += ["---------------------- OPTIONS ----------------------"]
    options = {"g": system.gravity, "rhoW": system.density, "WtrDpth": system.depth, "kBot": system.bed_stiffness,
               "cBot": system.bed_damping, "FrictionCoefficient": system.friction}  # fmt: skip
    rows += [f"{value:.17g} {name}" for name, value in options.items()]
    rows += ["---------------------- need this line ----------------------", ""]
    with replacing(Path(path)) as temporary:
        temporary.write_text("\n".join(rows), encoding="utf-8")
