"""A mooring from a MoorDyn file: its lines as the scene shows them, and the vessel that its coupled points make."""

import functools
import math
from pathlib import Path
from typing import NamedTuple, TypeAlias

import numpy as np

from app.messages import Vector, vector_of
from app.scenes.mooring.parameters import MooringParams
from app.scenes.mooring.rows import LineRows, ends_of
from sim.mooring import System, changed_moordyn, read_moordyn
from sim.validation import unreadable

LEAST_EXTENT = 1e-3  # [m]
STRETCH = 0.01  # of the shortest line at the vessel, to which the vessel may be dragged beyond where it is straight
ELSEWHERE = 0.1  # of the extent, to which a vessel may be dragged if no line leads from it to a fixed point


class FileMooring(NamedTuple):
    """A file that was read."""

    system: System
    notes: tuple[str, ...]  # on what was left out
    rows: LineRows
    vessel: tuple[int, ...]  # nodes of the coupled points
    anchors: tuple[int, ...]  # nodes of the fixed points
    others: tuple[int, ...]  # nodes of free points and of those that free bodies carry
    middle: Vector  # [m] of the vessel, at the surface
    radius: float  # [m] from there to its farthest point
    extent: float  # [m] that the picture is made for
    farthest: float  # [m] to which the vessel may be dragged


Changes: TypeAlias = tuple[tuple[str, str, float], ...]  # as in `MooringParams`


def opened(params: MooringParams) -> FileMooring:
    """The mooring of the file of these parameters, with its changes."""
    return mooring_of(params.moordyn_file, params.file_changes)


def content_of(path: str, changes: Changes) -> bytes:
    """The content of a file with changes. Raises ValueError as `changed_moordyn` does, or where the file is gone."""
    lengths = {int(of): value for what, of, value in changes if what == "length"}
    diameters = {of: value for what, of, value in changes if what == "diameter"}
    try:
        content = Path(path).read_bytes()
    except OSError as error:
        raise unreadable("file", Path(path).name, error) from None
    return changed_moordyn(content, lengths, diameters)


@functools.lru_cache(maxsize=4)
def mooring_of(path: str, changes: Changes = ()) -> FileMooring:
    """The mooring of a file, which is read once. Raises ValueError as `read_moordyn` does."""
    notes = [f"changed here: {what} of {of} is {value:g} m" for what, of, value in changes]
    system = read_moordyn(path, notes.append, content_of(path, changes) if changes else None)
    kinds = {point.id: point.kind for point in system.points}
    nodes = {kind: tuple(i for i, p in enumerate(system.points) if p.kind == kind) for kind in (*kinds.values(), "")}
    vessel = nodes.get("coupled", ())
    places = np.array([point.position for point in system.points])
    middle = np.mean(places[list(vessel)] if vessel else places, axis=0)[:2]
    reach = float(np.hypot(*places[:, :2].T).max())
    extent = max(reach, 1.2 * system.water.depth, LEAST_EXTENT)
    arms = np.linalg.norm(places[list(vessel), :2] - middle, axis=1)
    reverse = [is_reversed(system, line.start, line.end) for line in system.lines]
    held = tuple(
        (i, end)
        for i, (line, turned) in enumerate(zip(system.lines, reverse, strict=True))
        for end, point in ((0, line.end if turned else line.start), (-1, line.start if turned else line.end))
        if kinds[point] == "coupled"
    )
    return FileMooring(
        system, tuple(notes), rows_of_lines(system, reverse, held), vessel, nodes.get("fixed", ()),
        (*nodes.get("free", ()), *nodes.get("body", ())), vector_of(np.append(middle, 0.0)),
        float(arms.max(initial=0.0)), extent, farthest_offset(system, extent),
    )  # fmt: skip


def is_reversed(system: System, start: int, end: int) -> bool:
    """True if a line begins at its fairlead: its anchor is the fixed point, or else the lower end."""
    first, last = (next(point for point in system.points if point.id == one) for one in (start, end))
    if (first.kind == "fixed") != (last.kind == "fixed"):
        return last.kind == "fixed"
    if (first.kind == "coupled") != (last.kind == "coupled"):
        return first.kind == "coupled"
    return last.position[2] < first.position[2]


def rows_of_lines(system: System, reverse: list[bool], held: tuple[tuple[int, int], ...]) -> LineRows:
    """The rows of all lines, with as many pieces as the line of most segments has."""
    pieces = max(line.segments for line in system.lines)
    before, after, fraction, links = [], [], [], []
    for line, turned in zip(system.lines, reverse, strict=True):
        nodes, of = system.nodes_of[line.id], system.links_of[line.id]
        numbers = np.arange(of.start, of.stop)
        if turned:
            nodes, numbers = nodes[::-1], numbers[::-1]
        at = np.arange(pieces + 1) * line.segments / pieces
        i = np.minimum(at.astype(np.int64), line.segments - 1)
        before.append(nodes[i])
        after.append(nodes[i + 1])
        fraction.append(at - i)
        links.append(
            numbers[np.minimum((np.arange(pieces) + 0.5) * line.segments / pieces, line.segments - 1).astype(int)]
        )
    lengths = np.array([line.length for line in system.lines])
    at, to, of = np.array(before), np.array(after), np.array(links)
    return LineRows(at, to, np.array(fraction)[..., None], of, lengths, held, ends_of(system, at, to, of))


def slack_of(system: System) -> tuple[float, float] | None:
    """Horizontal distance [m] at which the first line between vessel and fixed point is straight, and the least length.

    None without such a line.
    """
    points = {point.id: point for point in system.points}
    slacks = []
    for line in system.lines:
        ends = points[line.start], points[line.end]
        if {end.kind for end in ends} == {"fixed", "coupled"}:
            x, y, z = np.subtract(ends[0].position, ends[1].position)
            slacks.append((math.sqrt(max(line.length**2 - z * z, 0.0)) - math.hypot(x, y), line.length))
    return (min(slack for slack, _ in slacks), min(length for _, length in slacks)) if slacks else None


def farthest_offset(system: System, extent: float) -> float:
    """Horizontal distance [m] to which the vessel may be dragged."""
    slack = slack_of(system)
    return ELSEWHERE * extent if slack is None else max(slack[0], 0.0) + STRETCH * slack[1]
