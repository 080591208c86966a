"""Check of a mooring before it runs: lines that are too short, or too soft for their load, and points above the bed."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.formats.formatting import number, percent
from app.messages import Vector
from app.scenes.contract import Advice
from app.scenes.mooring.arrangement import DENSITY, GRAVITY, Places, hull_of
from app.scenes.mooring.files.from_file import FileMooring
from app.scenes.mooring.parameters import MooringParams
from sim.parameters import parameters_of

MAX_REST_STRETCH = 0.05  # of a line at rest, over its length: moorings are laid with less
# Beyond this a line is too short for its anchor, or too soft for its load, which no shorter step mends.
MAX_STRETCH = 0.2
DIGITS = 3  # of an advised value, rounded up
EQUAL = 1e-6  # between the stretches of lines that are stretched equally
BLAMED = ("length", "axial_stiffness", "steady_force")  # parameters under which a fault may stand
HEIGHT_ROUNDING = 1e-3  # of the depth, by which an anchor may lie above the bed


class Fault(NamedTuple):
    """A fault of the state that a mooring starts with."""

    said: str  # the whole sentence
    short: str  # for the line above the tabs
    parameter: str  # under whose control the sentence stands; "" if none sets it
    advice: Advice | None  # value that mends it
    is_grave: bool  # the cause of a divergence, rather than the time step


def rounded_up(value: float) -> float:
    """The value, rounded up to `DIGITS` digits."""
    unit = 10.0 ** (math.floor(math.log10(value)) - DIGITS + 1)
    return float(f"{math.ceil(value / unit * (1.0 - 1e-9)) * unit:.{DIGITS}g}")


def advice_on(name: str, least: float) -> Advice | None:
    """The least value of a parameter, rounded up; None if the parameter does not reach it."""
    parameter, value = parameters_of(MooringParams)[name], rounded_up(least)
    return Advice(name, value, f"{number(value)} {parameter.unit}") if value <= float(parameter.high) else None


def fault_of(params: MooringParams, places: Places, body: Vector, stretch: NDArray[np.float64]) -> Fault | None:
    """The fault of a mooring of the parameters, or None.

    body: [m] where it rests without lines. stretch: (lines,) at rest, over the length.
    """
    ways = np.linalg.norm(np.add(body, places.fairleads) - np.array(places.anchors), axis=1)  # [m] straight
    short, longest = float(ways.max()) / params.length - 1.0, float(stretch.max())
    line = int((stretch > longest - EQUAL).argmax()) + 1
    is_grave = max(short, longest) > MAX_STRETCH
    if short > MAX_REST_STRETCH:
        advice = advice_on("length", float(ways.max()))
        least = f"at least {number(rounded_up(float(ways.max())))} m"
        if MAX_REST_STRETCH < longest <= MAX_STRETCH:
            head = f"Line {line} is stretched by {percent(longest)} at rest"
            return Fault(f"{head}: shorter than the way to its anchor, {least}.", head, "length", advice, is_grave)
        reach = math.hypot(*places.anchors[int(ways.argmax())][:2])
        said = (
            f"{number(params.length)} m cannot reach an anchor {number(reach)} m away in {number(params.depth)} "
            f"m of water: {least}."
        )
        return Fault(said, "The lines cannot reach their anchors", "length", advice, is_grave)
    if longest > MAX_REST_STRETCH:
        # A line that is stretched less leads more steeply to its load, and pulls harder.
        needed = params.axial_stiffness * longest / MAX_REST_STRETCH * (1.0 + longest)
        advice = advice_on("axial_stiffness", needed)
        head = f"Line {line} is stretched by {percent(longest)} at rest"
        least = "" if advice is None else f", at least {advice.words}"
        return Fault(f"{head}: EA is low for its load{least}.", head, "axial_stiffness", advice, is_grave)
    return None


def overload_of(params: MooringParams) -> Fault | None:
    """The steady force, if lines or body cannot bear it: the fault of a mooring without a state of rest.

    Of n lines one carries at least the nth part of a level force. A force beyond the buoyancy of the whole body turns
    it over or lifts it, and its statics are those of small angles.
    """
    force = 1e3 * params.steady_force  # [N]
    stretch = force / (params.lines * params.axial_stiffness)
    if stretch > MAX_STRETCH:
        advice = advice_on("axial_stiffness", force / (params.lines * MAX_REST_STRETCH))
        least = "" if advice is None else f", at least {advice.words}"
        head = f"A steady force of {number(params.steady_force)} kN stretches a line by {percent(stretch)} or more"
        return Fault(f"{head}: EA is low for its load{least}.", head, "axial_stiffness", advice, True)
    most = DENSITY * GRAVITY * hull_of(params).volume
    if force > most:
        said = (
            f"A steady force of {number(params.steady_force)} kN is more than the buoyancy of the whole body, "
            f"{number(1e-3 * most)} kN: reduce it, or enlarge the body."
        )
        return Fault(said, "The steady force is too large for the body", "steady_force", None, True)
    return None


def fault_of_file(file: FileMooring, stretch: NDArray[np.float64]) -> Fault | None:
    """The fault of a mooring from a file, or None. stretch: (lines,) at rest, over the length."""
    points = {point.id: point for point in file.system.points}
    faults: list[tuple[float, str]] = []
    for line in file.system.lines:
        ends = points[line.start], points[line.end]
        way = math.dist(ends[0].position, ends[1].position)
        if all(end.kind in ("fixed", "coupled") for end in ends) and way > (1.0 + MAX_REST_STRETCH) * line.length:
            said = f"Line {line.id} of {number(line.length)} m cannot reach from point {line.start} to point {line.end}"
            faults.append((way / line.length - 1.0, f"{said}: at least {number(rounded_up(way))} m."))
    longest, line = float(stretch.max()), file.system.lines[int(stretch.argmax())].id
    if not faults and longest > MAX_REST_STRETCH:
        faults.append((longest, f"Line {line} of the file is stretched by {percent(longest)} at rest."))
    if not faults:
        return None
    worst, said = max(faults)
    return Fault(said, said.partition(":")[0].removesuffix("."), "", None, max(worst, longest) > MAX_STRETCH)


def raised_points(file: FileMooring) -> Sequence[str]:
    """Sentences on the fixed points of a file that are not on the bed: an anchor may be meant."""
    depth = file.system.water.depth
    if file.system.bed_stiffness == 0.0:
        return []
    heights = [(point.id, point.position[2] + depth) for point in file.system.points if point.kind == "fixed"]
    return [
        f"Point {one} is fixed {number(height - depth)} m above the water."
        if height > depth
        else f"Point {one} is fixed {number(height)} m above the bed."
        for one, height in heights
        if height > HEIGHT_ROUNDING * depth
    ]
