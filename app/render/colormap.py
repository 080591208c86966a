"""Colour scales that are as clear for colour-blind readers, and in grey."""

import numpy as np
from numpy.typing import NDArray

from app.render.brightness import DARK_LIFT, LUMA
from sim.jit import kernel

# Fates of a disturbance, in the order of `sim.springs.analysis.growth`; light, medium and dark also in grey.
OUTCOME_COLOURS = {"stable": "#CFE6F5", "bounded growth": "#E69F00", "exploding": "#8C2D04"}

# Anchors of matplotlib's "plasma" without its darkest end, sRGB, from violet (low) to yellow (high).
ANCHORS = np.array(
    [[62, 4, 156], [126, 3, 168], [179, 38, 131], [218, 91, 105], [248, 149, 64], [253, 197, 39], [240, 249, 33]]
)
SCALE = ANCHORS.astype(np.float64)  # the same numbers as the kernel takes them


def scale_colours(values: NDArray[np.float64], low: float, high: float) -> NDArray[np.float32]:
    """sRGB in 0..1, (n, 3), of values (n,) on the scale from `low` to `high`; values outside get the end colours."""
    span = high - low
    at = np.clip((values - low) / span if span > 0 else np.zeros_like(values), 0.0, 1.0) * (len(ANCHORS) - 1)
    i = np.minimum(at.astype(int), len(ANCHORS) - 2)
    part = (at - i)[:, None]
    return ((ANCHORS[i] * (1 - part) + ANCHORS[i + 1] * part) / 255.0).astype(np.float32)


@kernel
def set_tube_colours(tension, samples, full, anchors, sides, rgb):
    """Set rgb (rings sides + 2, 3) (float32) of a tube of (n - 1) samples + 1 rings around n points by `scale_colours`.

    tension: (n - 1,) of each link. It is taken at the middle of the link, is linear between two middles, and constant
    beyond the first and the last. The scale goes from 0 to `full`. anchors: `SCALE`.
    """
    links, last = tension.shape[0], anchors.shape[0] - 1
    rings = links * samples + 1
    for ring in range(rings):
        along = min(max(ring / samples - 0.5, 0.0), links - 1.0)
        i = min(int(along), max(links - 2, 0))
        value = tension[i]
        if links > 1:
            value += (along - i) * (tension[i + 1] - tension[i])
        at = min(max(value / full, 0.0), 1.0) * last
        a = min(int(at), last - 1)
        for e in range(3):
            shade = np.float32((anchors[a, e] + (at - a) * (anchors[a + 1, e] - anchors[a, e])) / 255.0)
            for side in range(sides):
                rgb[ring * sides + side, e] = shade
            if ring == 0:
                rgb[rings * sides, e] = shade
            if ring == rings - 1:
                rgb[rings * sides + 1, e] = shade


def lifted(colours: NDArray[np.floating], lift: float = DARK_LIFT) -> NDArray[np.float64]:
    """sRGB colours (n, 3) in 0..255 as they are drawn on a dark floor: brighter, the more the darker they are.

    lift: fraction of white that black gets. `js/shading/dark.js` does the same to colours of vertices.
    """
    dark = 1.0 - colours @ np.array(LUMA) / 255.0
    return colours + lift * dark[:, None] * (255.0 - colours)


def css_scale(*, dark: bool) -> str:
    """The same scale as a CSS gradient; dark: as it is drawn on a dark floor."""
    anchors = lifted(SCALE) if dark else SCALE
    stops = ", ".join(f"rgb({r:.0f},{g:.0f},{b:.0f})" for r, g, b in anchors)
    return f"linear-gradient(90deg, {stops})"


def rgb(colour: str) -> tuple[int, int, int]:
    """The colour "#rrggbb" as numbers in 0..255."""
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)
