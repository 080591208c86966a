"""Steps of sliders and scales."""

import math


def round_step(rough: float) -> float:
    """The least of 1, 2 or 5 times a power of ten that is not below `rough`, which is above 0."""
    decade = 10.0 ** math.floor(math.log10(rough))
    return next(m * decade for m in (1, 2, 5, 10) if m * decade >= rough * 0.999)
