"""Numbers and quantities as text: significant digits, readable units, and one form for all of them.

Thousands are separated by a narrow no-break space, and powers of ten are written 1.3 × 10⁸, as the SI brochure asks.
"""

import math

NO_NUMBER = "–"
THOUSANDS = "\u202f"  # narrow no-break space
KILO_FROM = 1e4  # [N] from which a force is given in kN
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
MIN_PLAIN, MAX_PLAIN = 1e-3, 1e6  # numbers outside are written with a power of ten
LENGTH_UNITS = (("m", 1.0), ("mm", 1e-3), ("µm", 1e-6), ("nm", 1e-9))  # [m]
# [s] of each unit, and how many of it there must be at least before it is used.
TIME_UNITS = (
    ("years", 3.156e7, 1.5),
    ("days", 86400.0, 1.5),
    ("h", 3600.0, 1.5),
    ("min", 60.0, 1.5),
    ("s", 1.0, 0.9995),
    ("ms", 1e-3, 0.9995),
    ("µs", 1e-6, 0.0),
)
COUNT_UNITS = (("billion", 1e9), ("million", 1e6))
MIN_STEP_RATE, MAX_STEP_RATE = 10, 10_000  # [1/s] between which a step is written as one over a whole number


def number(value: float, digits: int = 3) -> str:
    """A number with `digits` significant digits; – for NaN, ∞ for infinity. Whole numbers below a million are exact."""
    if math.isnan(value):
        return NO_NUMBER
    if math.isinf(value):
        return "∞" if value > 0.0 else "−∞"
    if value == int(value) and abs(value) < MAX_PLAIN:
        return decimal(value, 0)
    rounded = float(f"{value:.{digits}g}")
    exponent = math.floor(math.log10(abs(rounded)) + 1e-12)
    if MIN_PLAIN <= abs(rounded) < MAX_PLAIN:
        return decimal(rounded, max(digits - 1 - exponent, 0))
    return f"{decimal(rounded / 10.0**exponent, digits - 1)} × 10{str(exponent).translate(SUPERSCRIPTS)}"


def decimal(value: float, decimals: int) -> str:
    """At most `decimals` digits after the point, without trailing zeros; thousands apart, and a real minus sign."""
    text = f"{value:z,.{decimals}f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return text.replace(",", THOUSANDS).replace("-", "−")


def fixed(value: float, decimals: int, *, sign: bool = False) -> str:
    """Always `decimals` digits after the point, for values that change all the time; – for NaN and infinity.

    sign: write a plus, too.
    """
    if not math.isfinite(value):
        return NO_NUMBER
    return f"{value:{'+' if sign else ''}z,.{decimals}f}".replace(",", THOUSANDS).replace("-", "−")


def percent(share: float, digits: int = 2) -> str:
    """A fraction, 0 to 1, in percent, with `digits` significant digits; the space does not break."""
    return f"{number(100.0 * share, digits)}\u00a0%" if math.isfinite(share) else NO_NUMBER


def metres(value: float, digits: int = 3) -> str:
    """A length [m] in the unit in which it is easily read, m to nm; – for NaN."""
    if not math.isfinite(value):
        return number(value)
    for unit, size in LENGTH_UNITS:
        if abs(value) >= 0.9995 * size:
            return f"{number(float(f'{value / size:.{digits}g}'), digits)} {unit}"
    return f"{number(value, digits)} m"


def metres_above(floor: float, value: float, digits: int = 3) -> str:
    """A length [m] that is known to `floor` [m]: "< 1 nm" if it is shorter, – if the floor is NaN."""
    if math.isnan(floor):
        return NO_NUMBER
    return f"< {metres(floor, 2)}" if value < floor else metres(value, digits)


def seconds(value: float, digits: int = 3) -> str:
    """A time [s] in the unit in which it is easily read, years to µs; – for NaN."""
    if not math.isfinite(value):
        return number(value)
    if value == 0.0:
        return "0 s"
    unit, size = next((unit, size) for unit, size, least in TIME_UNITS if abs(value) >= least * size)
    return f"{number(float(f'{value / size:.{digits}g}'), digits)} {unit}"


MAX_SMALL = 0.1  # below which a length [m] or time [s] is written in a multiple
EASY = {"m": metres, "s": seconds}  # unit -> what writes a number in an easily read multiple of it


def with_unit(value: float, unit: str, digits: int = 3) -> str:
    """A number with its unit, a small length [m] or time [s] in an easily read multiple; "1" is no unit."""
    if unit in EASY and 0.0 < abs(value) < MAX_SMALL:
        return EASY[unit](value, digits)
    return number(value, digits) if unit in ("", "1") else f"{number(value, digits)}\u00a0{unit}"


def largest_force(force: float) -> str:
    """Words for the largest force [N] with which the mouse pulls."""
    with_its_unit = f"{number(1e-3 * force)} kN" if force >= KILO_FROM else f"{number(force)} N"
    return f"{with_its_unit}: the largest mouse force"


def short_step(step: float) -> str:
    """A time step [s], for labels: 1/240 s if it is nearly one over a whole number, else in ms or µs."""
    rate = round(1.0 / step)
    if MIN_STEP_RATE <= rate <= MAX_STEP_RATE and abs(rate * step - 1.0) < 1e-4:
        return f"1/{rate} s"
    return seconds(step)


def time_step(step: float) -> str:
    """A time step [s] in both notations, 1/240 s (4.2 ms), or in the one that it has."""
    short = short_step(step)
    return f"{short} ({seconds(step, 2)})" if short.startswith("1/") else short


def longest_step(step: float) -> str:
    """An upper bound of time steps [s], as the longest one over a whole number that is not above it."""
    rate = math.ceil((1.0 - 1e-9) / step)
    return time_step(1.0 / rate) if MIN_STEP_RATE <= rate <= MAX_STEP_RATE else seconds(step)


def counted(value: int, thing: str) -> str:
    """A count with its noun: "1 line", "3 lines"."""
    return f"{number(value)} {thing}{'' if value == 1 else 's'}"


def count(value: float) -> str:
    """A count, in words from a million on: 30 million."""
    for word, size in COUNT_UNITS:
        if abs(value) >= 0.9995 * size:
            return f"{number(float(f'{value / size:.2g}'))} {word}"
    return number(round(value))
