"""A chart for the report: the reference as a line, the student's function as points. SVG, without a script."""

import math

import numpy as np

from app.lab.program_check import Points
from app.render.html import Html, fill, join
from app.render.line_chart import ticks

WIDTH, HEIGHT = 520, 240  # [px]
LEFT, RIGHT, TOP, BOTTOM = 70, 12, 10, 42  # [px] margins
SPACE = 0.05  # of the range of y, above and below


def chart(points: Points) -> Html:
    """The chart of a function; empty where the reference has no finite value to draw."""
    x = np.asarray(points.x, np.float64)
    ys = [np.asarray(y, np.float64) for y in (points.reference, points.student) if y is not None]
    finite = np.concatenate([y[np.isfinite(y)] for y in ys])
    if finite.size == 0:
        return Html()
    # A wrong function can be far off: the range is that of the reference, three times as wide at most.
    known = ys[0][np.isfinite(ys[0])]
    low, high = (known.min(), known.max()) if known.size else (finite.min(), finite.max())
    height = (high - low) or abs(high) or 1.0
    low, high = max(finite.min(), low - height), min(finite.max(), high + height)
    space = SPACE * ((high - low) or abs(high) or 1.0)
    low, high = low - space, high + space

    def px(value: float) -> float:
        return LEFT + (value - x.min()) / ((x.max() - x.min()) or 1.0) * (WIDTH - LEFT - RIGHT)

    def py(value: float) -> float:
        return TOP + (high - value) / (high - low) * (HEIGHT - TOP - BOTTOM)

    def pixels(y: np.ndarray) -> list[tuple[float, float]]:
        return [(px(a), py(b)) for a, b in zip(x, y, strict=True) if math.isfinite(b) and low <= b <= high]

    line = " ".join(f"{a:.1f},{b:.1f}" for a, b in pixels(ys[0]))
    dots = join(
        fill('<circle cx="{:.1f}" cy="{:.1f}" r="3"/>', a, b) for a, b in (pixels(ys[1]) if len(ys) > 1 else ())
    )
    across = join(
        fill('<text x="{:.1f}" y="{}" text-anchor="middle">{:g}</text>', px(tick), HEIGHT - BOTTOM + 16, tick)
        for tick in ticks(x.min(), x.max())
    )
    up = join(
        fill('<text x="{}" y="{:.1f}" text-anchor="end">{:g}</text>', LEFT - 6, py(tick) + 4, tick)
        for tick in ticks(low, high)
    )
    return fill(
        '<figure><svg viewBox="0 0 {w} {h}" width="{w}" height="{h}" role="img" font-size="12" fill="#1b2a3a">'
        '<path d="M{l} {t}V{b}H{r}" fill="none" stroke="#4d5560"/>{across}{up}'
        '<text x="{middle}" y="{last}" text-anchor="middle">{x_label}</text>'
        '<text transform="translate(14 {centre}) rotate(-90)" text-anchor="middle">{y_label}</text>'
        '<polyline points="{line}" fill="none" stroke="#1c6aa8" stroke-width="2"/><g fill="#c2410c">{dots}</g></svg>'
        "<figcaption>Line: reference. Points: your function.</figcaption></figure>",
        w=WIDTH, h=HEIGHT, l=LEFT, t=TOP, b=HEIGHT - BOTTOM, r=WIDTH - RIGHT, across=across, up=up,
        middle=(LEFT + WIDTH - RIGHT) // 2, last=HEIGHT - 8, centre=(TOP + HEIGHT - BOTTOM) // 2,
        x_label=points.x_label, y_label=points.y_label, line=line, dots=dots,
    )  # fmt: skip
