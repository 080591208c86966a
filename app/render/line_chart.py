"""A chart of lines over time as SVG, for files: it needs no script and no font of its own."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from app.render.html import Html, fill, join

WIDTH, HEIGHT = 560, 240  # [px]
LEFT, RIGHT, TOP, BOTTOM = 70, 14, 30, 56  # [px] margins
KEY_WIDTH = 110  # [px] for each line's name below the chart
MAX_TICKS = 5  # on each axis, at most
SPACE = 0.05  # of the range, above and below
COLOURS = ("#7048e8", "#1c7ed6", "#e8590c", "#099268", "#d6336c", "#868e96", "#e03131")


def ticks(low: float, high: float) -> Sequence[float]:
    """Round numbers from `low` to `high`, at most `MAX_TICKS` intervals apart."""
    if not high > low:
        return (low,)
    rough = (high - low) / MAX_TICKS
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(power * factor for factor in (1.0, 2.0, 5.0, 10.0) if power * factor >= rough * (1.0 - 1e-9))
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [round(step * i, 12) + 0.0 for i in range(first, last + 1)]


def line_chart(title: str, times: NDArray[np.float64], series: Mapping[str, NDArray[np.float64]]) -> Html:
    """An SVG element with one line for each series over `times` [s]; lines stop where a number is not finite.

    times: (n,), ascending. series: name -> (n,), in the unit that `title` names. Empty where nothing is finite.
    """
    values = np.array([*series.values()], np.float64).reshape(len(series), len(times))
    finite = values[np.isfinite(values)]
    if finite.size == 0:
        return Html()
    low, high = float(finite.min()), float(finite.max())
    space = SPACE * ((high - low) or abs(high) or 1.0)
    low, high, start = low - space, high + space, float(times[0])
    duration = float(times[-1]) - start or 1.0

    def px(t: float) -> float:
        return LEFT + (t - start) / duration * (WIDTH - LEFT - RIGHT)

    def py(value: float) -> float:
        return TOP + (high - value) / (high - low) * (HEIGHT - TOP - BOTTOM)

    def path(y: NDArray[np.float64]) -> str:
        words, on = [], False
        for t, value in zip(times, y, strict=True):
            if math.isfinite(value):
                words.append(f"{'L' if on else 'M'}{px(t):.1f} {py(value):.1f}")
            on = math.isfinite(value)
        return "".join(words)

    lines = join(
        fill('<path d="{}" fill="none" stroke="{}" stroke-width="1.8"/>', path(y), COLOURS[i % len(COLOURS)])
        for i, y in enumerate(values)
    )
    key = join(
        fill(
            '<path d="M{} {}h18" stroke="{}" stroke-width="3"/><text x="{}" y="{}">{}</text>',
            LEFT + i * KEY_WIDTH, HEIGHT - 12, COLOURS[i % len(COLOURS)], LEFT + i * KEY_WIDTH + 24, HEIGHT - 8, name,
        )
        for i, name in enumerate(series)
    )  # fmt: skip
    across = join(
        fill('<path d="M{0:.1f} {1}v5" stroke="#4d5560"/><text x="{0:.1f}" y="{2}" text-anchor="middle">{3:g}</text>',
             px(tick), HEIGHT - BOTTOM, HEIGHT - BOTTOM + 18, tick)
        for tick in ticks(start, start + duration)
    )  # fmt: skip
    up = join(
        fill('<path d="M{0} {1:.1f}h{2}" stroke="#d8dde3"/><text x="{3}" y="{4:.1f}" text-anchor="end">{5:g}</text>',
             LEFT, py(tick), WIDTH - LEFT - RIGHT, LEFT - 6, py(tick) + 4, tick)
        for tick in ticks(low, high)
    )  # fmt: skip
    return fill(
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {w} {h}" width="{w}" height="{h}" role="img"'
        ' font-family="sans-serif" font-size="12" fill="#1b2a3a">'
        '<rect width="{w}" height="{h}" fill="#ffffff"/><text x="{l}" y="18" font-weight="bold">{title}</text>'
        '<text x="{r}" y="{key_y}" text-anchor="end">t [s]</text>{up}{across}'
        '<path d="M{l} {t}V{b}H{r}" fill="none" stroke="#4d5560"/>{lines}{key}</svg>',
        w=WIDTH, h=HEIGHT, l=LEFT, t=TOP, b=HEIGHT - BOTTOM, r=WIDTH - RIGHT, key_y=HEIGHT - 8,
        title=title, up=up, across=across, lines=lines, key=key,
    )  # fmt: skip
