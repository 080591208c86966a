"""The parts of a mooring, and where each lies among the nodes and links of the kernels' view."""

import functools
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.mooring.end_forces import LineEnds
from sim.mooring.run import MooringRun
from sim.records import equal_to_itself
from sim.springs.points.point_system import PointSystem

Vector = tuple[float, float, float]


class LineType(NamedTuple):
    """Material and hydrodynamic coefficients of a line."""

    name: str
    diameter: float  # [m], of the volume
    mass: float  # [kg/m] in air
    stiffness: float  # EA [N]
    damping: float = -1.0  # BA [N s]; negative: the damping ratio of a segment, with the sign changed
    added_across: float = 1.0  # C_an
    drag_across: float = 1.2  # C_dn
    added_along: float = 0.0  # C_at
    drag_along: float = 0.05  # C_dt
    bending: float = 0.0  # EI [N m^2]
    # (strain, tension [N]) rows, from (0, 0) on, instead of a constant EA; `stiffness` then is that of `damping`.
    curve: tuple[tuple[float, float], ...] = ()

    @property
    def volume(self) -> float:
        """Volume of a metre of line [m^3/m]."""
        return math.pi / 4.0 * self.diameter**2


class Point(NamedTuple):
    """An end of lines: fixed, "coupled" (moved by the caller), free, or carried by a body."""

    id: int
    kind: str
    position: Vector  # [m]; of a body's, at the body's rest position
    mass: float = 0.0  # [kg]
    volume: float = 0.0  # [m^3]
    drag_area: float = 0.0  # C_d A [m^2]
    added_mass: float = 0.0  # C_a
    body: int | None = None  # id of the body that carries it
    force: Vector = (0.0, 0.0, 0.0)  # [N] steady, on a free point or on one that a body carries


class Line(NamedTuple):
    """A line from point `start` to point `end`."""

    id: int
    type: LineType
    start: int
    end: int
    length: float  # [m], unstretched
    segments: int
    # Direction of the line, from start to end, in which a clamp holds it; None: free to turn. Only for lines with EI.
    clamp_at_start: Vector | None = None
    clamp_at_end: Vector | None = None


@equal_to_itself
class MooredBody(NamedTuple):
    """A floating body of linear theory about its rest position without lines: M q'' + B q' + C q = forces.

    q: displacement [m] and small rotation [rad] about `place`. mass holds the added mass. `moored` makes it of a hull.
    """

    id: int
    place: Vector  # [m]
    mass: NDArray[np.float64]  # (6, 6) [kg, kg m, kg m^2]
    stiffness: NDArray[np.float64]  # (6, 6) [N/m, N, N m]
    damping: NDArray[np.float64] | None = None  # (6, 6)
    # (waves, 6) complex [N/m, N]: each of the system's waves pushes by a Re(X exp(i theta)) where the body is; None: 0
    excitation: NDArray[np.complex128] | None = None
    steady: Sequence[float] = (0.0,) * 6  # [N, N m] force and moment that stay


class MooringParts(PointSystem[MooringRun]):
    """Lines, points and bodies by their places; `System` adds the water."""

    lines: tuple[Line, ...]
    points: tuple[Point, ...]
    bodies: tuple[MooredBody, ...]

    @functools.cached_property
    def node_of_point(self) -> dict[int, int]:
        """The node of each point, by its id."""
        return {point.id: i for i, point in enumerate(self.points)}

    @functools.cached_property
    def coupled_nodes(self) -> dict[int, int]:
        """The node of each coupled point, by its id."""
        return {point.id: i for i, point in enumerate(self.points) if point.kind == "coupled"}

    @functools.cached_property
    def nodes_of(self) -> dict[int, NDArray[np.int64]]:
        """Node numbers of each line (segments + 1,), by its id: points first, in their order, then inner nodes."""
        index, nodes, used = self.node_of_point, {}, len(self.points)
        for line in self.lines:
            inner = np.arange(used, used + line.segments - 1)
            nodes[line.id] = np.concatenate(([index[line.start]], inner, [index[line.end]])).astype(np.int64)
            used += line.segments - 1
        return nodes

    @functools.cached_property
    def links_of(self) -> dict[int, slice]:
        """Places of each line's links among all, by its id."""
        ends = np.cumsum([line.segments for line in self.lines]).tolist()
        return {line.id: slice(end - line.segments, end) for line, end in zip(self.lines, ends, strict=True)}

    @functools.cached_property
    def line_ends(self) -> LineEnds:
        """The start and the end of each line in turn."""
        nodes, links, parts, part = [], [], [], 0
        for line in self.lines:
            at, own = self.nodes_of[line.id], self.links_of[line.id]
            nodes += [at[0], at[-1]]
            links += [own.start, own.stop - 1]
            parts += [part, part + line.segments]  # as `part_tables` has them: one at each node, line after line
            part += line.segments + 1
        return LineEnds(*(np.array(values, np.int64) for values in (nodes, parts, links)))

    @functools.cached_property
    def node_count(self) -> int:
        return len(self.points) + sum(line.segments - 1 for line in self.lines)
