"""Factors of common mistakes: small fractions, powers of 2 and 10, pi, units."""

import math
from fractions import Fraction

SAME = 1e-5  # relative: results of single precision have such a factor
LARGEST = 12  # numerator and denominator of a fraction
# Those with pi in words.
NAMED = {
    math.pi: "pi", 2.0 * math.pi: "2 pi", 4.0 * math.pi: "4 pi", math.pi / 2.0: "pi/2", math.pi / 4.0: "pi/4",
    1.0 / math.pi: "1/pi", 0.5 / math.pi: "1/(2 pi)", 0.25 / math.pi: "1/(4 pi)", math.pi**2: "pi²",
    4.0 * math.pi**2: "(2 pi)²", 0.25 / math.pi**2: "1/(2 pi)²", math.pi / 180.0: "pi/180 (degrees for radians)",
    180.0 / math.pi: "180/pi (radians for degrees)", math.sqrt(2.0): "the root of 2", math.sqrt(0.5): "1/(root of 2)",
}  # fmt: skip


def factor_text(factor: float) -> str:
    """A simple factor in words: "2", "1/3", "1/(2 pi)", "-0.001"."""
    sign, size = ("-" if factor < 0.0 else ""), abs(factor)
    for value, name in NAMED.items():
        if is_same(size, value):
            return sign + name
    fraction = Fraction(size).limit_denominator(LARGEST)
    if (
        is_same(size, float(fraction))
        and fraction.numerator <= LARGEST
        and fraction.denominator not in (1, 2, 4, 5, 10)
    ):
        return f"{sign}{fraction}"
    return f"{factor:.6g}"


def is_simple(factor: float) -> bool:
    """True for a factor that a person may omit: a small fraction, a power of 2 or 10, one with pi."""
    size = abs(factor)
    if size == 0.0 or not math.isfinite(size):
        return False
    fraction = Fraction(size).limit_denominator(LARGEST)
    powers = (base ** round(math.log(size, base)) for base in (2.0, 10.0))
    small = float(fraction) if 0 < fraction.numerator <= LARGEST else math.nan
    return any(is_same(size, value) for value in (small, *powers, *NAMED))


def is_same(one: float, other: float) -> bool:
    """True if two factors agree within the accuracy of results."""
    return abs(one - other) <= SAME * abs(other)
