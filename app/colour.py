"""Colour scales that read alike for colour-blind eyes and in grey."""

import numpy as np
from numpy.typing import NDArray

# Okabe and Ito's palette, told apart with any colour vision; black and yellow last.
TOLD_APART = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#F0E442")

# Anchors of matplotlib's "plasma" without its darkest end, sRGB; from calm violet to hot yellow.
ANCHORS = np.array(
    [[62, 4, 156], [126, 3, 168], [179, 38, 131], [218, 91, 105], [248, 149, 64], [253, 197, 39], [240, 249, 33]]
)


def scale_colours(values: NDArray[np.float64], low: float, high: float) -> NDArray[np.float32]:
    """sRGB in 0..1, (n, 3), of values on the scale from `low` to `high`, clipped at its ends."""
    span = high - low
    at = np.clip((values - low) / span if span > 0 else np.zeros_like(values), 0.0, 1.0) * (len(ANCHORS) - 1)
    i = np.minimum(at.astype(int), len(ANCHORS) - 2)
    part = (at - i)[:, None]
    return ((ANCHORS[i] * (1 - part) + ANCHORS[i + 1] * part) / 255.0).astype(np.float32)


def css_scale() -> str:
    """The same scale as a CSS gradient."""
    stops = ", ".join(f"rgb({r},{g},{b})" for r, g, b in ANCHORS)
    return f"linear-gradient(90deg, {stops})"


def rgb(colour: str) -> tuple[int, int, int]:
    """A colour written #rrggbb, as numbers in 0..255."""
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)
