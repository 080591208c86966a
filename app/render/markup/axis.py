"""Axes of charts: round scales, and their drawing as SVG in the colour of the text around it."""

import math
from typing import NamedTuple

from app.formats.formatting import SUPERSCRIPTS
from app.formats.round_step import round_step
from app.render.markup.html import Html, fill, join

INTERVALS = 4  # approximate number of them on a scale
MIN_SPAN = 1e-3  # of a scale, over the size of its numbers: a constant has a scale too
MIN_FILLED = 0.3  # fraction of a scale that its data must fill, or the scale is replaced
TICK, SHORT_TICK = 5, 3  # [px] lengths
GRID_OPACITY = 0.2
NAME_ABOVE, NAME_BELOW = 12, 38  # [px] from the corner of both axes' ends to the lines of their names


class Scale(NamedTuple):
    """A linear scale from one round number to another, with a tick every `step`."""

    low: float
    high: float
    step: float

    @property
    def ticks(self) -> tuple[float, ...]:
        """From end to end."""
        return tuple(self.low + k * self.step for k in range(round((self.high - self.low) / self.step) + 1))

    @property
    def words(self) -> tuple[str, ...]:
        """At the ticks, with the digits that tell them apart."""
        if 1e-4 <= self.step < 1e5:
            digits = max(0, -math.floor(math.log10(self.step) + 1e-9))
            words = [f"{tick + 0.0:.{digits}f}" for tick in self.ticks]
        else:
            words = [f"{tick:.3g}" if abs(tick) > 1e-9 * self.step else "0" for tick in self.ticks]
        return tuple(word.replace("-", "\N{MINUS SIGN}") for word in words)

    def fits(self, low: float, high: float) -> bool:
        """True if data from low to high lie within, and fill enough of it."""
        return self.low <= low and high <= self.high and high - low >= MIN_FILLED * (self.high - self.low)


def scale_of(low: float, high: float, least: float = 0.0) -> Scale:
    """A scale for data from low to high; it spans at least `least`, about the middle of the data."""
    size = max(abs(low), abs(high))
    if high - low < least:
        middle = 0.5 * (low + high)
        low, high = middle - 0.5 * least, middle + 0.5 * least
    rough = max(high - low, MIN_SPAN * size) / INTERVALS if size or least else 1.0 / INTERVALS
    step = round_step(rough)
    first, last = math.floor(low / step + 1e-9), math.ceil(high / step - 1e-9)
    return Scale(first * step, max(last, first + 1) * step, step)


class Axis(NamedTuple):
    """An axis in pixels. One of a logarithmic scale has the common logarithms of its numbers."""

    name: str  # with its unit
    low: float
    high: float
    start: float  # [px] of `low`
    length: float  # [px] to `high`; below 0 it goes up
    ticks: tuple[tuple[float, str], ...]  # (number, word); a short tick has none

    def share(self, value: float) -> float:
        """Place of a number between `low`, 0, and `high`, 1."""
        return (value - self.low) / (self.high - self.low)

    def at(self, value: float) -> float:
        """Place of a number [px]."""
        return self.start + self.length * self.share(value)

    def within(self, value: float) -> float:
        """A number, or the end beyond which it lies."""
        return min(max(value, self.low), self.high)


def fitted(name: str, low: float, high: float, start: float, length: float, intervals: int = INTERVALS) -> Axis:
    """An axis from `low` to `high`, which need not be round, with the round numbers between them."""
    step = round_step((high - low) / intervals)
    scale, slack = Scale(math.floor(low / step) * step, math.ceil(high / step) * step, step), 1e-9 * step
    marks = zip(scale.ticks, scale.words, strict=True)
    inside = tuple(mark for mark in marks if low - slack <= mark[0] <= high + slack)
    return Axis(name, low, high, start, length, inside)


def rounded(name: str, low: float, high: float, start: float, length: float) -> Axis:
    """An axis over a scale for data from `low` to `high`."""
    scale = scale_of(low, high)
    ticks = tuple(zip(scale.ticks, scale.words, strict=True))
    return Axis(name, min(low, scale.low), max(high, scale.high), start, length, ticks)


def decades(name: str, low: float, high: float, start: float, length: float) -> Axis:
    """A logarithmic axis with ticks at the powers of ten and short ones at their whole multiples."""
    ends = math.log10(low), math.log10(high)
    exponents = range(math.floor(ends[0]), math.floor(ends[1] + 1e-9) + 1)
    ticks = ((e + math.log10(digit), power_text(e) if digit == 1 else "") for e in exponents for digit in range(1, 10))
    return Axis(name, *ends, start, length, tuple(one for one in ticks if ends[0] - 1e-9 <= one[0] <= ends[1] + 1e-9))


def power_text(exponent: int) -> str:
    """A power of ten, with its exponent raised."""
    return f"{10.0**exponent:g}" if -2 <= exponent <= 2 else f"10{str(exponent).translate(SUPERSCRIPTS)}"


def draw_axes(x: Axis, y: Axis, *, grid: bool = True) -> Html:
    """Both axes with their ticks and names: that of y above, that of x at its end. grid: lines at the ticks of y."""
    left, right, base, top = x.start, x.start + x.length, y.start, y.start + y.length
    parts: list[Html] = []
    for value, word in x.ticks:
        at, length = x.at(value), TICK if word else SHORT_TICK
        parts.append(fill('<path d="M{:.1f} {}v{}" stroke="currentColor"/>', at, base, length))
        parts.append(label(at, base + 18, "middle", word))
    for value, word in y.ticks:
        at, length = y.at(value), x.length if grid else -(TICK if word else SHORT_TICK)
        opacity = GRID_OPACITY if grid else 1
        parts.append(fill('<path d="M{} {:.1f}h{}" stroke="currentColor" opacity="{}"/>', left, at, length, opacity))
        parts.append(label(left - 6, at + 4, "end", word))
    parts.append(fill('<path d="M{} {}V{}H{}" fill="none" stroke="currentColor"/>', left, top, base, right))
    parts.append(fill('<text x="{}" y="{}" font-weight="bold">{}</text>', left, top - NAME_ABOVE, y.name))
    parts.append(label(right, base + NAME_BELOW, "end", x.name))
    return join(parts)


def label(x: float, y: float, anchor: str, word: str) -> Html:
    """A word at a place [px]; nothing if it is empty."""
    text = fill('<text x="{:.1f}" y="{:.1f}" text-anchor="{}">{}</text>', x, y, anchor, word)
    return text if word else Html()
