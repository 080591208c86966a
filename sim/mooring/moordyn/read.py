"""`read_moordyn`: the System of a MoorDyn file."""

import warnings
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from sim.inputs.bounds import WARNING
from sim.mooring.moordyn.bodies import drag_of, free_body, is_point, least_inertia, merge
from sim.mooring.moordyn.meant import doubts
from sim.mooring.moordyn.options import read_options
from sim.mooring.moordyn.rods import Rod, add_ends, add_lines, read_rod, read_rod_type
from sim.mooring.moordyn.rows import ends_first, read_body, read_line, read_point, read_type
from sim.mooring.moordyn.sections import (
    BODIES,
    LINES,
    OPTIONS,
    POINTS,
    ROD_TYPES,
    RODS,
    TYPES,
    Section,
    decoded,
    read_text,
    split_sections,
)
from sim.mooring.parts import Point
from sim.mooring.system import System
from sim.mooring.turning import with_turning
from sim.tables import Row
from sim.validation import ConvergenceError, Refusals, argument_error
from sim.water import Water

LARGE_TURN, MOST_TURN = 0.2, 0.6  # [rad] of a free body from its place in the file: beyond, it is said, and refused

T = TypeVar("T")


def read_moordyn(path: str | Path, say: Callable[[str], None] | None = None, content: bytes | None = None) -> System:
    """The System of a MoorDyn file of version 1 or 2.

    Coupled bodies become coupled points at their places. A free one becomes a Body, which turns by small angles with
    the stiffness that its lines at rest give it. Rods become points or stiff lines: see `rods`. Internal
    damping acts in slack links, too, as in MoorDyn: `System.slack_damping` is True. Steady forces on points are in N.

    say: takes a line on each omitted part of the file. None: a UserWarning on those that may change forces.
    content: text to use instead of the file's, as of `changed_moordyn`.
    Raises ValueError with all unreadable parts, by section and line.
    """
    path, wrong = Path(path), Refusals()
    if content is None:
        from sim.inputs.kinds import check_file  # a start without a file does without it

        check_file("file", path, ("deck",), "a deck of MoorDyn")
    sections = split_sections(read_text(path) if content is None else decoded(content), wrong)
    needed = (TYPES, LINES) if RODS in sections and sections[RODS].rows else (TYPES, POINTS, LINES)
    for name in needed:
        if name not in sections or not sections[name].rows:
            with wrong:
                raise argument_error("file", str(path.name), f"a MoorDyn file with a section {name}")
    kinds = read_rows(
        sections.get(TYPES), TYPES, "name", lambda row: read_type(row, path.parent), lambda t: t.name, wrong
    )
    bodies = read_rows(sections.get(BODIES), BODIES, "ID", read_body, lambda body: body.id, wrong)
    points: dict[int, Point] = {}
    if len(bodies) == count_of(sections.get(BODIES)):  # else their points would be refused, too
        points = read_rows(
            sections.get(POINTS), POINTS, "ID", lambda row: read_point(row, bodies), lambda p: p.id, wrong
        )
    rods: dict[int, Rod] = {}
    if len(bodies) == count_of(sections.get(BODIES)):
        steel = read_rows(sections.get(ROD_TYPES), ROD_TYPES, "name", read_rod_type, lambda t: t.name, wrong)
        rods = read_rows(
            sections.get(RODS), RODS, "ID", lambda row: read_rod(row, steel, bodies), lambda r: r.id, wrong
        )
    whole = len(points) == count_of(sections.get(POINTS)) and len(rods) == count_of(sections.get(RODS))
    ends = add_ends(rods.values(), points)
    lines: dict[int, Any] = {}
    if len(kinds) == count_of(sections.get(TYPES)) and whole and LINES in sections:
        order = ends_first(sections[LINES], points)
        read = lambda row: read_line(row, order, kinds, points, ends)  # noqa: E731
        lines = read_rows(sections[LINES], LINES, "ID", read, lambda line: line.id, wrong)
    left = [column_left_out(sections[POINTS])] if POINTS in sections else []
    options = read_options(sections[OPTIONS].rows if OPTIONS in sections else [], wrong)
    wrong.check()
    depth = depth_of(options.fields, points.values(), options.warnings)
    fields = {name: value for name, value in options.fields.items() if name != "depth"}
    water = Water(depth, **{name: fields.pop(name) for name in ("gravity", "density") if name in fields})
    left.extend(add_lines(rods.values(), ends, lines))
    options.warnings.extend(doubts(kinds.values(), points, lines, water))
    used = {end for line in lines.values() for end in (line.start, line.end)}
    for one in {end.point for end in ends.values() if points[end.point].kind in ("fixed", "coupled")} - used:
        del points[one]
    free = [body for body in bodies.values() if body.kind == "free"]
    for body in [body for body in free if is_point(body, points.values())]:
        free.remove(body)
        left.append(merge(body, points, lines))
    dragged = [drag_of(body) for body in free if body.drag_area > 0.0]
    least = {body.id: least_inertia(body, points, lines.values()) for body in free}
    left.extend(f"body {one} has less mass or inertia than a thousandth of its lines' ends: it has that"
                for one, (mass, _) in least.items() if mass > 0.0)  # fmt: skip
    moved = tuple(free_body(body, *least[body.id], water) for body in free)
    system = System(tuple(lines.values()), (*points.values(), *dragged), water, moved, slack_damping=True, **fields)
    if free:
        system = turned(system, options.warnings)
    if options.steering:
        left.append(f"left out, as they control MoorDyn only: {', '.join(options.steering)}")
    if say is not None:
        for text in filter(None, left):
            say(text)
    for text in options.warnings:
        say(text) if say is not None else warnings.warn(f"{path.name}: {text.removeprefix(WARNING)}", stacklevel=2)
    return system


def turned(system: System, said: list[str]) -> System:
    """The system with the stiffness of its bodies by their lines at rest."""
    try:
        rest = system.at_rest()
        for b, body in enumerate(system.bodies):
            turn = rest.nodes[:, system.node_count + 2 * b + 1]
            arms = [np.subtract(point.position, body.place) for point in system.points if point.body == body.id]
            # a turn about its own arm has no effect
            angle = max((float(np.linalg.norm(np.cross(turn, arm)) / np.linalg.norm(arm)) for arm in arms if arm.any()),
                        default=0.0)  # fmt: skip
            if angle > MOST_TURN:
                raise argument_error(
                    f"body {body.id}", f"{angle:.3g} rad from its place in the file to its rest",
                    f"a turn of at most {MOST_TURN:g} rad: bodies turn by small angles",
                )  # fmt: skip
            if angle > LARGE_TURN:
                said.append(f"body {body.id} turns by {angle:.2g} rad to its rest: it is computed for small turns")
        return with_turning(system, rest)
    except ConvergenceError as error:
        said.append(f"free bodies turn without the stiffness that their lines give ({error})")
        return system


def count_of(section: Section | None) -> int:
    """Number of rows of a section, 0 if it is missing."""
    return 0 if section is None else len(section.rows)


def read_rows(
    section: Section | None, name: str, key: str, read: Callable[[Row], T], key_of: Callable[[T], Any], wrong: Refusals
) -> dict[Any, T]:
    """The rows of a section by their keys; refusals go to `wrong`."""
    entries: dict[Any, T] = {}
    for row in section.rows if section is not None else ():
        with wrong:
            one = read(row)
            if key_of(one) in entries:
                raise argument_error(f"{name}, line {row.number}: {key}", key_of(one), "one that no other row has")
            entries[key_of(one)] = one
    return entries


def depth_of(fields: Mapping[str, float], points: Iterable[Point], said: list[str]) -> float:
    """The depth of the water [m]: that of the lowest fixed point if none or less is given, as in MoorDyn."""
    lowest = -min((point.position[2] for point in points if point.kind == "fixed"), default=0.0)
    depth = fields.get("depth", 0.0)
    if not max(lowest, depth) > 0.0:
        raise argument_error(f"{OPTIONS}: WtrDpth", fields.get("depth"), "the depth of the water [m]")
    if "depth" in fields and lowest > depth * (1.0 + 1e-6):
        said.append(f"WtrDpth {depth:g}: the water is {lowest:g} m deep, as a fixed point is below the bed")
        return lowest
    return fields.get("depth", lowest)


def column_left_out(section: Section) -> str:
    """A line on the tenth column of points, which MoorDyn does not read, or ""."""
    if all(len(row.words) != 10 for row in section.rows):
        return ""
    name = section.columns[9] if len(section.columns) == 10 else "without a name"
    return f"left out, as MoorDyn does not read it: the tenth column of points, {name}"
