"""`write_moordyn`: a System as a file of MoorDyn's version 2."""

from pathlib import Path

from sim.files import replacing
from sim.mooring.parts import LineType
from sim.mooring.system import System
from sim.validation import argument_error

CURVE_FILE = "{stem}_{name}.dat"  # beside the file, of a line type with a table of strain and tension


def write_moordyn(system: System, path: str | Path) -> None:
    """Write a System as a MoorDyn file of version 2, and beside it a file of each table of strain and tension.

    Points and lines are numbered from 1 in their order, as MoorDyn wants them. Links are damped in MoorDyn where they
    are slack, too. Raises ValueError for a system with bodies, waves, current, clamps, or forces on points.
    """
    path = Path(path)
    check_writable(system)
    kinds = {line.type.name: line.type for line in system.lines}
    rows = [
        "--------------------- MoorDyn Input File ---------------------", "Written by Springtide",
        "---------------------- LINE TYPES ----------------------",
        "Name Diam MassDenInAir EA BA/-zeta EI Cd Ca CdAx CaAx",
        "(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)",
    ]  # fmt: skip
    for kind in kinds.values():
        rows.append(type_row(kind, path))
    rows += ["---------------------- POINTS ----------------------", "ID Attachment X Y Z M V CdA CA",
             "(#) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)"]  # fmt: skip
    number = {point.id: i for i, point in enumerate(system.points, 1)}
    for point in system.points:
        numbers = (*point.position, point.mass, point.volume, point.drag_area, point.added_mass)
        rows.append(" ".join([str(number[point.id]), point.kind.capitalize(), *map(shortest, numbers)]))
    rows += ["---------------------- LINES ----------------------",
             "ID LineType AttachA AttachB UnstrLen NumSegs Outputs", "(#) (name) (#) (#) (m) (-) (-)"]  # fmt: skip
    for i, line in enumerate(system.lines, 1):
        ends = f"{number[line.start]} {number[line.end]}"
        rows.append(f"{i} {line.type.name} {ends} {shortest(line.length)} {line.segments} -")
    rows += ["---------------------- OPTIONS ----------------------"]
    water = system.water
    options = {"g": water.gravity, "rho": water.density, "WtrDpth": water.depth, "kBot": system.bed_stiffness,
               "cBot": system.bed_damping, "FrictionCoefficient": system.friction}  # fmt: skip
    rows += [f"{shortest(value)} {name}" for name, value in options.items()]
    rows += ["---------------------- need this line ----------------------", ""]
    write_text(path, rows)


def check_writable(system: System) -> None:
    """Raises ValueError for a system that a file of lines and points cannot hold."""
    clamped = [line.id for line in system.lines if line.clamp_at_start or line.clamp_at_end]
    pushed = [point.id for point in system.points if any(point.force)]
    none = {"bodies": system.bodies, "waves": system.waves, "current": any(system.current)}
    for name, value in {**none, "clamps of lines": clamped, "forces on points": pushed}.items():
        if value:
            raise argument_error(f"system: {name}", value, "none: a MoorDyn file of lines and points cannot hold them")
    kinds = {line.type for line in system.lines}
    names = sorted(kind.name for kind in kinds)
    if len(set(names)) < len(names):
        raise argument_error("system: line types", names, "a different name for each type")
    for name in names:
        if not name or len(name.split()) != 1 or name.startswith(("#", "!", "---")):
            raise argument_error("system: line types", name, "names without spaces")


def type_row(kind: LineType, path: Path) -> str:
    """The row of a line type; its table of strain and tension is written beside the file."""
    stiffness = shortest(kind.stiffness)
    if kind.curve:
        stiffness = CURVE_FILE.format(stem=path.stem, name=kind.name)
        rows = [f"{shortest(strain)} {shortest(tension)}" for strain, tension in kind.curve]
        write_text(path.parent / stiffness, [kind.name, "Strain Tension", "(-) (N)", *rows])
    coefficients = kind.drag_across, kind.added_across, kind.drag_along, kind.added_along
    numbers = map(shortest, (kind.damping, kind.bending, *coefficients))
    return " ".join([kind.name, shortest(kind.diameter), shortest(kind.mass), stiffness, *numbers])


def shortest(value: float) -> str:
    """The shortest text that is read as the same number."""
    return repr(float(value)).removesuffix(".0")


def write_text(path: Path, rows: list[str]) -> None:
    """Write lines of text, all or none."""
    with replacing(path) as temporary:
        temporary.write_text("\n".join(rows), encoding="utf-8")
