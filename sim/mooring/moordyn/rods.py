"""Rods of a MoorDyn file: rigid lines with volume, drag and added mass along them; lines hang from their ends.

A rod that is held, or moves with the vessel, is the two points at its ends. One on a free body is a row of points of
that body. One that is free, or pinned at its first end, is a line that is so stiff that it stays straight. Drag and
added mass of the flat ends are left out.
"""

import math
import re
from collections.abc import Collection, Iterable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.mooring.moordyn.rows import COUPLED, FIXED, FREE, PINNED, FileBody, RodEnd, listed
from sim.mooring.moordyn.sections import ROD_TYPES, RODS, check_columns, number_in, whole_in
from sim.mooring.parts import Line, LineType, Point, Vector
from sim.tables import Row
from sim.validation import argument_error

ON_BODY = re.compile(r"body(\d+)(pinned|pin)?", re.IGNORECASE | re.ASCII)
ROD_PINNED = ("pinned", "pin")
SHORTEST = 1e-6  # [m] between the ends of a rod: below it they are one point
LEAST_SEGMENTS, MOST_SEGMENTS = 2, 10  # of a rod that turns: its mass is in its nodes
STIFFER = 10.0  # EA of such a rod over that of its lines
SHARE = 1e-3  # of EA of its lines: the force across it that bends it by as little of its length


class RodType(NamedTuple):
    """A row of ROD TYPES."""

    name: str
    diameter: float  # [m]
    mass: float  # [kg/m]
    drag: float
    added: float
    has_ends: bool  # drag or added mass of its flat ends


class Rod(NamedTuple):
    """A row of RODS. One of 0 segments has no length, but a direction, as in MoorDyn."""

    id: int
    type: RodType
    kind: str  # fixed, coupled, free, or "body" of a free one, at its first end
    is_pinned: bool  # free to turn about its first end
    body: int | None
    ends: NDArray[np.float64]  # (2, 3) [m]
    segments: int

    @property
    def length(self) -> float:
        """Length [m]."""
        return float(np.linalg.norm(self.ends[1] - self.ends[0])) if self.segments else 0.0

    @property
    def turns(self) -> bool:
        """True for a rod that forces turn."""
        return (self.kind == "free" or self.is_pinned) and self.length > SHORTEST


def read_rod_type(row: Row) -> RodType:
    """Name Diam Mass Cd Ca CdEnd CaEnd, and a further column of MoorDyn-F that has to be 0."""
    where = f"{ROD_TYPES}, line {row.number}"
    name, *rest = check_columns(where, row.words, 7, 8, 7)
    diameter, mass, drag, added, *_ = numbers = [number_in(where, text) for text in rest]
    if min(numbers) < 0.0 or diameter == 0.0:
        raise argument_error(where, " ".join(row.words), "a diameter above 0, and no number below 0")
    if len(numbers) == 7 and numbers[6] != 0.0:
        raise argument_error(where, rest[6], "0: linear damping of rods is not modelled")
    return RodType(name, diameter, mass, drag, added, any(numbers[4:6]))


def read_rod(row: Row, types: Mapping[str, RodType], bodies: Mapping[int, FileBody]) -> Rod:
    """ID RodType Attachment Xa Ya Za Xb Yb Zb NumSegs [Outputs]; on a body the ends are at places in its axes."""
    where = f"{RODS}, line {row.number}"
    words = check_columns(where, row.words, 10, 11, 11)
    if words[1] not in types:
        raise argument_error(f"{where}: type", words[1], f"one of {listed(types)}")
    ends = np.array([number_in(where, text) for text in words[3:9]]).reshape(2, 3)
    segments = whole_in(where, words[9])
    if segments < 0:
        raise argument_error(f"{where}: NumSegs", segments, "0 or above")
    word, body = words[2].lower(), None
    on_body = ON_BODY.fullmatch(word)
    if on_body is not None:
        number = int(on_body[1])
        if number not in bodies:
            raise argument_error(f"{where}: attachment", words[2], f"a body of the file: {listed(bodies)}")
        owner = bodies[number]
        ends = owner.place + ends @ owner.turn.T
        kind, body = ("body", number) if owner.kind == "free" else (owner.kind, None)
        is_pinned = bool(on_body[2])
    else:
        is_pinned = word in ROD_PINNED or word in PINNED
        known = {**dict.fromkeys((*FIXED, *ROD_PINNED), "fixed"), **dict.fromkeys((*COUPLED, *PINNED), "coupled"),
                 **dict.fromkeys(FREE, "free")}  # fmt: skip
        if word not in known:
            raise argument_error(
                f"{where}: attachment", words[2], "Fixed, Pinned, Coupled, CoupledPinned, Free, BodyN or BodyNPinned"
            )
        kind = known[word]
    return Rod(whole_in(where, words[0]), types[words[1]], kind, is_pinned, body, ends, segments)


def add_ends(rods: Iterable[Rod], points: dict[int, Point]) -> dict[str, RodEnd]:
    """Add the points at the ends of rods, and those along rods on free bodies; returns the ends by "1a", "1b"."""
    ends: dict[str, RodEnd] = {}
    for rod in rods:
        number = max(points, default=0) + 1
        along = rod.ends[1] - rod.ends[0]
        along = along / max(float(np.linalg.norm(along)), SHORTEST)
        is_held = rod.kind in ("fixed", "coupled") and not rod.is_pinned and bool(along.any())
        ends[f"{rod.id}a"] = RodEnd(number, vector(-along) if is_held else None)
        if rod.length <= SHORTEST:
            points[number] = Point(number, rod.kind, vector(rod.ends[0]), body=rod.body)
            ends[f"{rod.id}b"] = RodEnd(number, vector(along) if is_held else None)
            continue
        count = rod.segments if rod.kind == "body" and not rod.turns else 1
        for i, share in enumerate(np.linspace(0.0, 1.0, count + 1)):
            place = vector(rod.ends[0] + share * (rod.ends[1] - rod.ends[0]))
            kind = "free" if rod.turns and i else rod.kind
            point = Point(number + i, kind, place, body=rod.body if kind == "body" else None)
            if rod.kind == "body" and not rod.turns:
                part, of = rod.length / count * (0.5 if i in (0, count) else 1.0), rod.type
                point = point._replace(
                    mass=part * of.mass, volume=part * 0.25 * math.pi * of.diameter**2,
                    drag_area=part * of.diameter * of.drag, added_mass=of.added,
                )  # fmt: skip
            points[number + i] = point
        ends[f"{rod.id}b"] = RodEnd(number + count, vector(along) if is_held else None)
    return ends


def add_lines(rods: Collection[Rod], ends: Mapping[str, RodEnd], lines: dict[int, Line]) -> list[str]:
    """Add the stiff lines of rods that turn. Returns a sentence on each, and on the ends of rods.

    EA and EI are those with which the lines of the file stretch and bend such a rod by a thousandth or less.
    """
    said = []
    types = [line.type for line in lines.values()]
    pull = max((kind.stiffness for kind in types), default=1e6)
    for rod in rods:
        if not rod.turns:
            continue
        kind = rod.type
        segments = min(max(rod.segments, LEAST_SEGMENTS), MOST_SEGMENTS)
        steel = LineType(
            f"rod{rod.id}", kind.diameter, kind.mass, STIFFER * pull, -1.0, kind.added, kind.drag, 0.0, 0.0,
            SHARE * pull * rod.length**2 / (3.0 * SHARE),
        )  # fmt: skip
        number = max(lines, default=0) + 1
        start, end = ends[f"{rod.id}a"].point, ends[f"{rod.id}b"].point
        lines[number] = Line(number, steel, start, end, rod.length, segments)
        said.append(f"rod {rod.id} is the stiff line {number}")
    if any(rod.type.has_ends and (rod.turns or rod.kind == "body") for rod in rods):
        said.append("left out: drag and added mass of the flat ends of rods")
    return said


def vector(place: NDArray[np.float64]) -> Vector:
    """Three numbers as a tuple."""
    x, y, z = place.tolist()
    return x, y, z
