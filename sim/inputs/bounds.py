"""Physical bounds of data from elsewhere: one table, with the reason of each bound, and the one check against it.

A value outside is not refused, as physics may allow it: the check returns a warning that names the number, where it
stands, and what it would mean.
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

WARNING = "Warning: "


class Bound(NamedTuple):
    """The range of a quantity in data of one kind."""

    kind: str  # of data
    name: str  # of the quantity
    unit: str
    low: float
    high: float
    reason: str  # for the range
    below: str = ""  # likely cause of a smaller value
    above: str = ""  # likely cause of a larger value


BOUNDS = (
    Bound("spectrum", "Hs", "m", 0.0, 20.0, "the highest sea that a buoy recorded has 19 m",
          above="is the unit of the density m2/Hz?"),
    Bound("spectrum", "period", "s", 2.0, 30.0, "gravity waves of wind and swell",
          "is its unit right?", "is its unit right?"),
    Bound("spectrum", "steepness", "", 0.0, 0.1, "the steepest seas have 0.07, then they break",
          above="is the unit of height or of time right?"),
    Bound("record", "largest height over the standard deviation", "", 0.0, 10.0,
          "the highest crest of a million waves is 5.3 times it", above="a spike, or a mark of a missing value?"),
    Bound("spectrum", "density over those beside it", "", 0.0, 25.0, "a swell is wider than one frequency of a buoy",
          above="a slip of the decimal point?"),
    Bound("line type", "density", "kg/m3", 300.0, 30_000.0,
          "floating ropes have 500 and more; chain, with the diameter of its bar, 25 000",
          "lighter than any line: is the mass in t/m, or the diameter in mm?",
          "heavier than any line: is the diameter that of the line, in m?"),
    Bound("line type", "EA over the section", "Pa", 1e5, 1e12, "rubber has 1e6, steel 2.1e11",
          "is EA in kN?", "is EA in N, and the diameter in m?"),
    Bound("line type", "EA over the section of a line of metal", "Pa", 5e8, 1e12, "chain has 5e10, wire rope 1e11",
          "is EA in kN?", "is EA in N?"),
    Bound("line type", "diameter", "m", 1e-4, 1.5, "threads of models, and hoses", "", "is it in mm?"),
    Bound("line type", "Cd", "", 0.0, 5.0, "chain has 2.4, lines with strakes 3", "", "is the point at its place?"),
    Bound("line type", "Ca", "", 0.0, 5.0, "a cylinder has 1", "", "is the point at its place?"),
    Bound("line", "length over the distance of its ends", "", 0.6, math.inf, "ropes break before they stretch so far",
          below="is the length, or the place of an end, right?"),
    Bound("line", "length over the way along the bed and up", "", 0.0, 2.0, "the rest would lie in heaps on the bed",
          above="is the length, or the place of an end, right?"),
    Bound("point", "density", "kg/m3", 10.0, 30_000.0, "foam has 30, lead 11 300",
          "is the mass in t?", "is the volume right?"),
    Bound("deck", "gravity", "m/s2", 9.7, 9.9, "on Earth it is 9.78 to 9.83", "is the point at its place?",
          "is the point at its place?"),
    Bound("deck", "density of the water", "kg/m3", 950.0, 1250.0, "fresh water has 1000, the Dead Sea 1240",
          "is it in t/m3?", "is it in kg/m3?"),
    Bound("deck", "height of an anchor above the bed over the depth", "", -1e-6, 0.02, "anchors lie on the bed"),
    Bound("hull", "length", "m", 0.05, 500.0, "models, and the longest ships", "is its unit right?",
          "is its unit right?"),
    Bound("dataset", "damping over its largest value", "", -0.01, math.inf,
          "waves that a body makes carry energy away, so that its own damping is not below 0",
          below="an irregular frequency, or the other sign?"),
    Bound("dataset", "value over those beside it", "", 0.0, 5.0, "coefficients change smoothly with frequency",
          above="an irregular frequency?"),
    Bound("dataset", "asymmetry", "", 0.0, 0.1, "added mass and damping without speed are symmetric",
          above="another order of motions, or too coarse a mesh?"),
    Bound("dataset", "damping over that of the exciting force", "", 0.3, 3.0,
          "Haskind's relation gives the damping from the exciting force",
          "is the force, or the damping, in another unit?", "is the force, or the damping, in another unit?"),
)  # fmt: skip
TABLE: Mapping[tuple[str, str], Bound] = {(bound.kind, bound.name): bound for bound in BOUNDS}


def beyond(kind: str, name: str, value: float, where: str = "", said: str = "") -> list[str]:
    """A warning about a value outside its bound in the table, none for another one, or for nan.

    where: names the place of the number. said: replaces the words on the value.
    """
    bound = TABLE[kind, name]
    if not (value < bound.low or value > bound.high):
        return []
    is_low = value < bound.low
    limit = f"below {bound.low:g}" if is_low else f"above {bound.high:g}"
    unit = f" {bound.unit}" if bound.unit else ""
    text = said or f"{name} {value:.3g}{unit}"
    meaning = bound.below if is_low else bound.above
    place = f"{where}: " if where else ""
    return [f"{WARNING}{place}{text} is {limit}{unit} ({bound.reason}){': ' + meaning if meaning else ''}"]
