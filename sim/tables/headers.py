"""The header of a column in its parts: name, unit, and the convention of a direction."""

import math
import re
from collections.abc import Collection, Sequence
from typing import NamedTuple

import numpy as np

from sim.units import measure_of
from sim.validation import argument_error

BRACKETS = re.compile(r"[\[(]((?:[^\[\]()]|\([^()]*\))*)[\])]")
ARGUMENT = re.compile(r"(?:f|w|t|ω|omega|θ|theta)(?:,\s*(?:θ|theta))?", re.IGNORECASE)  # of S(f): no unit
MAGNETIC = re.compile(r"magnetic|(?:deg(?:rees?)?|°)[ _]?m\b", re.IGNORECASE)
TRUE_DEGREES = re.compile(r"(?:deg(?:rees?)?|°)[ _]?[TN]")
BEGIN, END = r"(?<![A-Za-z0-9])", r"(?![A-Za-z0-9])"
# Words of conventions, in the order in which they are taken out of a header. "from north" is no "from".
WORDS = tuple(
    (re.compile(rf"{BEGIN}(?:{words}){END}", re.IGNORECASE), said)
    for words, said in (
        (r"(?:counter|anti)[- ]?clockwise|ccw", "ccw"),
        (r"clockwise|cw", "cw"),
        (r"(?:from[ _]+)?(?:true[ _]+)?north|nautical|true", "north"),
        (r"(?:from[ _]+)?(?:the[ _]+)?(?:east|\+?x[- _]?axis|axis|\+x)|cartesian|math(?:ematical)?", "axis"),
        (r"coming[ _]+from|from|meteorological", "from"),
        (r"going[ _]+to|towards?|to|oceanographic", "to"),
        (r"(?:two|double|2)[- _]?sided", "two-sided"),
        (r"(?:one|single|1)[- _]?sided", "one-sided"),
    )
)


class Convention(NamedTuple):
    """Convention of a direction: its zero, its sense of turning, and whether waves come from it or go to it."""

    zero: float  # [rad] from +x
    turn: int  # 1 counterclockwise, -1 clockwise
    comes_from: bool

    def towards(self, angle: np.ndarray) -> np.ndarray:
        """Directions that waves go to [rad], from +x towards +y, of angles [rad] of this convention."""
        return self.zero + self.turn * angle + (math.pi if self.comes_from else 0.0)


class Header(NamedTuple):
    """A header in its parts."""

    name: str  # small letters and digits
    unit: str  # "" without one
    convention: Convention
    is_two_sided: bool


def read_header(text: str, names: Collection[str]) -> Header:
    """The parts of a header; names: those that columns may have, in small letters without signs.

    The unit is in brackets, or behind the name: "frequency (Hz)", "freq_Hz", "S m2/Hz".
    Raises ValueError for directions from magnetic north, whose difference from true north no file has.
    """
    if MAGNETIC.search(text):
        raise argument_error("column", text, "directions from true north, not from magnetic north")
    inside = " ".join(part for part in BRACKETS.findall(text) if not ARGUMENT.fullmatch(part.strip()))
    said: list[str] = []
    outside, unit = plain(BRACKETS.sub(" ", text), said), plain(TRUE_DEGREES.sub("deg", inside), said)
    name = letters_of(outside)
    if not unit and name not in names:
        for gap in reversed(list(re.finditer(r"[ _,/]+", outside))):
            first, rest = letters_of(outside[: gap.start()]), outside[gap.end() :].replace("_", " ")
            if first in names and measure_of(rest) is not None:
                name, unit = first, rest
                break
    return Header(name, "" if unit == "-" else unit, convention_of(said), "two-sided" in said)


def letters_of(text: str) -> str:
    """The letters and digits of a name, in small letters."""
    return re.sub(r"[\W_]", "", text.lower())


def plain(text: str, said: list[str]) -> str:
    """A text without the words of conventions, which go to `said`."""
    for words, meaning in WORDS:
        text, count = words.subn(" ", text)
        said.extend([meaning] * bool(count))
    return text.strip(" ,;:_")


def convention_of(said: Sequence[str]) -> Convention:
    """The convention that words say. Without any: clockwise from north, where waves come from."""
    is_axis = "axis" in said or ("ccw" in said and "north" not in said)
    turn = -1 if "cw" in said else 1 if is_axis or "ccw" in said else -1
    comes_from = "from" in said if is_axis else "to" not in said
    return Convention(0.0 if is_axis else 0.5 * math.pi, turn, comes_from)
