"""The mooring that the parameters describe: sea, body, anchors, fairleads and lines as a `System`."""

import dataclasses
import functools
import itertools
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.messages import Vector, vector_of
from app.scenes.mooring.files.from_file import opened
from app.scenes.mooring.parameters import MooringParams
from app.scenes.mooring.rows import LineRows, ends_of
from sim import floating
from sim.mooring import Line, LineType, MooredBody, Point, System, moored
from sim.ocean.radial.gerstner import draw_waves, waves_under
from sim.ocean.spectra import SPECTRA
from sim.water import Water
from sim.waves import Waves

GRAVITY, DENSITY = Water.gravity, Water.density  # [m/s2], [kg/m3]
WAVE_COUNT = 16  # of an irregular sea: each node feels each of them
BODY = 1
BODY_DRAG = 1.0  # coefficient of drag on the wet side of the body
HEIGHT_OVER_WIDTH = 0.55  # of a buoy and of a box
# Of a vessel from a file as drawn: over the distance of its fairleads, over the extent, and its height over its width.
VESSEL_WIDTH, LEAST_VESSEL, LARGEST_VESSEL, VESSEL_HEIGHT = 2.0, 0.04, 0.25, 0.3
BOX_LENGTH = 1.6  # of a box, over its width
BODY_TOP = 0.9  # height of what the first view shows of the body above still water, over its width
FLOATING_PART = 0.4, 0.65  # of the length from the anchor: where floats are
MAX_SURFACE_POINTS = 49  # along a side of the drawn surface
SURFACE_SIDE = 2.6  # of the drawn surface, in `extent`s


class Places(NamedTuple):
    """Anchors and fairleads, which a user may drag."""

    anchors: tuple[Vector, ...]  # [m]
    fairleads: tuple[Vector, ...]  # [m] from the body's centre

    def slack(self, body: NDArray[np.float64], length: float) -> float:
        """Level way [m] from the body's place to where the first line of this length [m] is straight."""
        ways = body + np.subtract(self.fairleads, self.anchors)
        straight = np.sqrt(np.maximum(length**2 - ways[:, 2] ** 2, 0.0))
        return float((straight - np.hypot(ways[:, 0], ways[:, 1])).min())


def at_most(length: float, vector: NDArray[np.float64]) -> NDArray[np.float64]:
    """A vector, shortened where it is longer."""
    return vector * min(1.0, length / max(float(np.linalg.norm(vector)), 1e-9))


def water_of(params: MooringParams) -> Water:
    """The water of the parameters, or that of their file."""
    if not params.moordyn_file:
        return Water(params.depth)
    return opened(params).system.water


def depth_of(params: MooringParams) -> float:
    """Depth of the water [m]."""
    return water_of(params).depth


def extent(params: MooringParams) -> float:
    """A length [m] that the picture is made for."""
    if params.moordyn_file:
        return opened(params).extent
    return max(params.reach, 1.2 * params.depth)


def diameter_of(params: MooringParams) -> float:
    """Diameter [m] of the lines; of a file the largest."""
    if params.moordyn_file:
        return max(line.type.diameter for line in opened(params).system.lines)
    return params.diameter


def has_body(params: MooringParams) -> bool:
    """False of a file without coupled points, which has no vessel."""
    return not params.moordyn_file or bool(opened(params).vessel)


def width_of(params: MooringParams) -> float:
    """Width [m] of the body; a vessel from a file is drawn within its fairleads, as no file has its shape."""
    if not params.moordyn_file:
        return params.size
    mooring = opened(params)
    return min(max(VESSEL_WIDTH * mooring.radius, LEAST_VESSEL * mooring.extent), LARGEST_VESSEL * mooring.extent)


def is_round(params: MooringParams) -> bool:
    """True if the body is round as seen from above."""
    return bool(params.moordyn_file) or params.body == "buoy"


def hull_of(params: MooringParams) -> floating.Hull:
    """The body's hull."""
    if params.moordyn_file:
        return floating.Hull.cylinder(0.5 * width_of(params), VESSEL_HEIGHT * width_of(params))
    width, height = params.size, HEIGHT_OVER_WIDTH * params.size
    if params.body == "buoy":
        return floating.Hull.cylinder(0.5 * width, height)
    return floating.Hull.box(BOX_LENGTH * width, width, height)


def bearings(params: MooringParams) -> NDArray[np.float64]:
    """Directions (lines,) [rad] from body to anchors; the first is up-wave."""
    return math.radians(params.direction) + math.pi * (1.0 + 2.0 * np.arange(params.lines) / params.lines)


def first_places(params: MooringParams) -> Places:
    """Anchors and fairleads that nobody has moved."""
    (x, y, z), _ = np.abs(hull_of(params).extents).T
    anchors, fairleads = [], []
    for bearing in bearings(params):
        c, s = math.cos(bearing), math.sin(bearing)
        anchors.append((params.reach * c, params.reach * s, -params.depth))
        # On the lower edge of the hull.
        rim = min(x, y) if params.body == "buoy" else min(x / max(abs(c), 1e-9), y / max(abs(s), 1e-9))
        fairleads.append((rim * c, rim * s, -float(z)))
    return Places(tuple(anchors), tuple(fairleads))


def shown_points(params: MooringParams) -> NDArray[np.float64]:
    """Points (n, 3) [m] that the first view shows: ends of lines, the body with its mast, the bed under it."""
    wide, x, y = width_of(params), 0.0, 0.0
    if params.moordyn_file:
        mooring = opened(params)
        ends, (x, y, _) = [point.position for point in mooring.system.points], mooring.middle
    else:
        ends = list(first_places(params).anchors)
        if params.lines == 1 and params.length > params.depth:  # it drifts until its line is nearly straight
            drift = max(math.sqrt(params.length**2 - params.depth**2) - params.reach, 0.0)
            bearing = math.radians(params.direction)
            x, y = drift * math.cos(bearing), drift * math.sin(bearing)
    body = [(x + side * wide, y, BODY_TOP * wide) for side in (-1.0, 1.0)]
    return np.array([*ends, *body, (x, y, -depth_of(params))])


def sea_of(params: MooringParams) -> Waves | None:
    """The waves, all in one direction; None for a level sea."""
    if params.wave_height == 0.0:
        return None
    spectrum = SPECTRA["sea_state"]
    water = dataclasses.asdict(water_of(params))
    conditions = spectrum.conditions(hs=params.wave_height, tp=params.wave_period, **water)
    c, s = math.cos(math.radians(params.direction)), math.sin(math.radians(params.direction))
    if params.regular:
        k = conditions.wavenumber(2.0 * math.pi / params.wave_period)
        drawn = waves_under(conditions, *(np.array([value]) for value in (k, 0.0, 0.5 * params.wave_height, 0.0)))
    else:
        drawn = draw_waves(spectrum, conditions, WAVE_COUNT)
    return dataclasses.replace(drawn, kx=drawn.k * c, ky=drawn.k * s)


def surface_side(params: MooringParams) -> float:
    """Side of the drawn surface [m]."""
    return SURFACE_SIDE * extent(params)


def surface_heights(params: MooringParams, sea: Waves | None, t: float, fade: float) -> NDArray[np.float32]:
    """Heights (m, m) [m] of the drawn surface, which lies about the origin, at time t [s]; fade: of all."""
    side = surface_side(params)
    if sea is None:
        return np.zeros((MAX_SURFACE_POINTS, MAX_SURFACE_POINTS), np.float32)
    axis = np.linspace(-0.5 * side, 0.5 * side, MAX_SURFACE_POINTS)
    along = np.linspace(-0.75 * side, 0.75 * side, 512)
    bearing = math.radians(params.direction)
    c, s = math.cos(bearing), math.sin(bearing)
    heights = fade * sea.elevation(np.outer(along, (c, s)), t)
    return np.interp(axis[:, None] * c + axis[None] * s, along, heights).astype(np.float32)


def line_types(params: MooringParams) -> tuple[LineType, LineType]:
    """The line, and its part with floats."""
    plain = LineType(
        "line", params.diameter, params.line_mass, params.axial_stiffness, -params.line_damping, params.added_mass,
        params.drag_across, 0.0, params.drag_along,
    )  # fmt: skip
    area = (params.line_mass + params.lift / GRAVITY) / DENSITY
    return plain, plain._replace(name="line with floats", diameter=math.sqrt(4.0 * area / math.pi))


def first_line(params: MooringParams) -> tuple[LineType, float]:
    """Type and length [m] of line 1."""
    if params.moordyn_file:
        line = opened(params).system.lines[0]
        return line.type, line.length
    return line_types(params)[0], params.length


def sections(params: MooringParams) -> tuple[tuple[LineType, float, int], ...]:
    """Parts of a line from its anchor: (type, length [m], segments) of each."""
    plain, lifted = line_types(params)
    if not params.floats:
        return ((plain, params.length, params.segments),)
    ends = (0.0, *FLOATING_PART, 1.0)
    at = [round(end * params.segments) for end in ends]
    counts = [b - a for a, b in itertools.pairwise(at)]
    types = plain, lifted, plain
    return tuple((kind, params.length * n / params.segments, n) for kind, n in zip(types, counts, strict=True))


def body_of(params: MooringParams, sea: Waves | None) -> MooredBody:
    """The body, with the forces of waves and the steady force."""
    body = floating.Body(hull_of(params), density=params.density)
    moored_body = moored(BODY, body, 2.0 * math.pi / params.wave_period, sea)
    c, s = math.cos(math.radians(params.direction)), math.sin(math.radians(params.direction))
    force = 1e3 * params.steady_force
    return moored_body._replace(steady=(force * c, force * s, 0.0, 0.0, 0.0, 0.0))


def build(params: MooringParams, places: Places, body: MooredBody, sea: Waves | None) -> System:
    """The system. Anchors are points that are moved, since a user may drag them."""
    # Drag on the body acts in the middle of its wet side.
    draft = params.density / DENSITY * HEIGHT_OVER_WIDTH * params.size
    points = [Point(1, "body", (0.0, 0.0, -0.5 * draft), drag_area=BODY_DRAG * params.size * draft, body=BODY)]
    lines: list[Line] = []
    parts = sections(params)
    for i, (anchor, fairlead) in enumerate(zip(places.anchors, places.fairleads, strict=True)):
        first = 10 * (i + 1)
        points.append(Point(first, "coupled", anchor))
        end = vector_of(np.add(body.place, fairlead))
        points.append(Point(first + 9, "body", end, body=BODY))
        for j, (kind, length, count) in enumerate(parts):
            last = j == len(parts) - 1
            if not last:
                place = np.array(anchor) + (j + 1) / len(parts) * np.subtract(end, anchor)
                points.append(Point(first + j + 1, "free", vector_of(place)))
            lines.append(Line(first + j, kind, first + j, first + 9 if last else first + j + 1, length, count))
    c, s = math.cos(math.radians(params.direction)), math.sin(math.radians(params.direction))
    return System(
        tuple(lines), tuple(points), water_of(params), (body,), friction=params.friction,
        current=(params.current * c, params.current * s, 0.0), waves=sea,
    )  # fmt: skip


@functools.lru_cache(maxsize=2)
def held(lines: tuple[Line, ...], points: tuple[Point, ...], moved: Vector, depth: float) -> System:
    """The lines in still water between fixed anchors and a body that is held: its points are coupled, `moved` [m]."""
    placed = [
        point._replace(kind="coupled", position=vector_of(np.add(point.position, moved)), body=None)
        if point.kind == "body"
        else point._replace(kind="fixed" if point.kind == "coupled" else point.kind)
        for point in points
    ]
    return System(lines, tuple(placed), Water(depth))


def rows_of(system: System, params: MooringParams) -> LineRows:
    """The lines from their anchors to the body, a piece for each segment."""
    nodes, links = [], []
    for i in range(params.lines):
        ids = [10 * (i + 1) + j for j in range(len(sections(params)))]
        chains = [system.nodes_of[one] for one in ids]
        nodes.append(np.concatenate([chains[0], *(chain[1:] for chain in chains[1:])]))
        links.append(np.concatenate([np.arange(system.links_of[one].start, system.links_of[one].stop) for one in ids]))
    at, of, lengths = np.array(nodes), np.array(links), np.full(params.lines, params.length)
    held = tuple((i, -1) for i in range(params.lines))
    return LineRows(at, at, np.zeros((*at.shape, 1)), of, lengths, held, ends_of(system, at, at, of))
