"""Decks that cannot be meant: numbers outside the bounds of physics, and those that their neighbours contradict."""

import math
from collections.abc import Iterable, Mapping, Sequence

from sim.inputs.bounds import BOUNDS, WARNING, beyond
from sim.mooring.parts import Line, LineType, Point
from sim.water import Water

METAL = 4000.0  # [kg/m3] of a line that no fibre has
SAME = 0.02  # of a length or a depth, up to which two are those of one design
ON_BED = next(bound.high for bound in BOUNDS if bound.name.startswith("height of an anchor"))


def doubts(
    types: Iterable[LineType],
    points: Mapping[int, Point],
    lines: Mapping[int, Line],
    water: Water,
) -> list[str]:
    """A warning on each part of a deck that physics, or the other parts, contradict."""
    warnings = [text for kind in types for text in doubts_of_type(kind)]
    warnings += beyond("deck", "gravity", water.gravity, "OPTIONS")
    warnings += beyond("deck", "density of the water", water.density, "OPTIONS") if water.density else []
    for point in points.values():
        if point.mass > 0.0 and point.volume > 0.0:
            warnings += beyond("point", "density", point.mass / point.volume, f"point {point.id}")
    return [*warnings, *doubts_of_places(points, lines, water.depth), *doubts_of_lengths(points, lines)]


def doubts_of_type(kind: LineType) -> list[str]:
    """Warnings on the numbers of a line type."""
    where = f"line type {kind.name}"
    warnings = beyond("line type", "diameter", kind.diameter, where)
    if not kind.volume > 0.0:
        return warnings
    density, modulus = kind.mass / kind.volume, kind.stiffness / kind.volume
    said = f"{kind.mass:g} kg/m in a diameter of {kind.diameter:g} m, {density:.3g} kg/m3,"
    warnings += beyond("line type", "density", density, where, said) if kind.mass > 0.0 else []
    name = "EA over the section of a line of metal" if density > METAL else "EA over the section"
    said = f"EA {kind.stiffness:g} N in a diameter of {kind.diameter:g} m, {modulus:.3g} Pa,"
    warnings += beyond("line type", name, modulus, where, said) if not kind.curve else []
    for name, value in (("Cd", kind.drag_across), ("Ca", kind.added_across), ("Cd", kind.drag_along),
                        ("Ca", kind.added_along)):  # fmt: skip
        warnings += beyond("line type", name, value, where)
    return warnings


def doubts_of_places(points: Mapping[int, Point], lines: Mapping[int, Line], depth: float) -> list[str]:
    """Warnings on points that are not where the others say: above the water, above the bed, with the other sign."""
    held = [point for point in points.values() if point.kind == "fixed"]
    if points and all(point.position[2] > 0.0 for point in points.values()):
        return [f"{WARNING}no point is under water: is z positive downwards? Here z is up from the surface"]
    warnings = []
    for point in held:
        z = point.position[2]
        others = [one for one in held if one.id != point.id and is_alike(one, point, lines)]
        on_bed = [one for one in others if abs(one.position[2] + depth) <= ON_BED * depth]
        if z > 0.0 and any(abs(one.position[2] + z) <= SAME * z for one in others):
            warnings.append(
                f"{WARNING}point {point.id} lies {z:g} m above the water, {named(others)} {z:g} m below it: its sign?"
            )
        elif on_bed and (z + depth) / depth > ON_BED:
            warnings.append(f"{WARNING}anchor {point.id} lies {z + depth:.4g} m above the bed, {named(on_bed)} on it")
    return warnings


def named(points: Sequence[Point]) -> str:
    """The numbers of points that lie otherwise."""
    return f"point{'s' if len(points) > 1 else ''} {', '.join(str(one.id) for one in points[:3])}"


def is_alike(one: Point, other: Point, lines: Mapping[int, Line]) -> bool:
    """True for two points from which lines of the same type and about the same length lead."""
    first, second = ([line for line in lines.values() if point.id in (line.start, line.end)] for point in (one, other))
    return any(
        a.type.name == b.type.name and a.id != b.id and abs(a.length - b.length) <= SAME * max(a.length, b.length)
        for a in first
        for b in second
    )


def doubts_of_lengths(points: Mapping[int, Point], lines: Mapping[int, Line]) -> list[str]:
    """Warnings on lines that are much shorter or longer than the distance of their ends."""
    warnings = []
    for line in lines.values():
        if {line.start, line.end} - points.keys():
            continue
        start, end = points[line.start].position, points[line.end].position
        distance = math.dist(start, end)
        if not distance > 0.0 or {points[line.start].kind, points[line.end].kind} & {"free", "body"}:
            continue  # where it comes to rest is not known
        way = math.dist(start[:2], end[:2]) + abs(start[2] - end[2])
        where = f"line {line.id}"
        said = f"{line.length:g} m between ends that are {distance:.4g} m apart"
        warnings += beyond("line", "length over the distance of its ends", line.length / distance, where,
                           f"{said}, {line.length / distance:.3g} of the distance,")  # fmt: skip
        warnings += beyond("line", "length over the way along the bed and up", line.length / way, where,
                           f"{said}, {line.length / way:.3g} times the way along the bed and up,")  # fmt: skip
    return warnings
