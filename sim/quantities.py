"""Numbers as people write them: `read_number` takes "1e4", "1/60", "0,02", "20k", "5 ms"; `write_number` shows one.

A number is written so that reading it again gives the very same number.
"""

import re
from decimal import Decimal
from fractions import Fraction

PREFIXES = {"n": -9, "u": -6, "µ": -6, "μ": -6, "m": -3, "k": 3, "K": 3, "M": 6, "G": 9}
CENTI = {"c": -2}  # with a unit only: "5 c" is not a number
TIMES = {"min": 60, "h": 3600}  # [s] that are typed for seconds
MAX_LENGTH = 64  # characters of a number
MAX_EXPONENT = 400  # beyond it every float is 0 or infinite
MAX_DENOMINATOR = 100_000  # of a number that is written as 1/n
MIN_PLAIN, MAX_PLAIN = 1e-4, 1e6  # below and from there a number is written with an exponent
LONGEST_PLAIN = 7  # significant digits; of a number with more of them, 1/n is tried first

DIGITS = r"[+-]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eE][+-]?\d+)?"
NUMBER = re.compile(rf"(?P<number>{DIGITS})(?:\s*/\s*(?P<divisor>{DIGITS}))?\s*(?P<suffix>[^\d\s].*)?")
GROUPED = re.compile(r"[+-]?[1-9]\d{0,2}(?:,\d{3})+")  # 1,000: one or one thousand, according to the country


def plain_unit(unit: str) -> str:
    """A unit in characters that every keyboard has: m/s^2 for m/s²."""
    for sign, typed in (("²", "^2"), ("³", "^3"), ("·", " "), ("°", "deg")):
        unit = unit.replace(sign, typed)
    return unit


def factor_of(suffix: str, unit: str) -> Fraction:
    """The factor that a suffix stands for: a prefix, the unit, or both. Raises ValueError for any other suffix."""
    suffix, plain = plain_unit(suffix), plain_unit(unit)
    if suffix in ("", plain):
        return Fraction(1)
    if suffix == "m":  # a thousandth, a minute or a metre
        raise ValueError(f"'m' alone may mean two things: write {'ms or min' if plain == 's' else 'e-3'}")
    if plain == "s" and suffix in TIMES:
        return Fraction(TIMES[suffix])
    power = None
    prefixes = PREFIXES
    if plain and suffix.endswith(plain):
        power = re.match(r"[A-Za-z]+\^(\d)", plain)  # of a prefix: 1 mm² is 1e-6 m²
        prefixes = PREFIXES | CENTI
        suffix = suffix.removesuffix(plain).strip()
    if suffix not in prefixes:
        raise ValueError(f"{suffix!r} is no unit of it")
    return Fraction(10) ** (prefixes[suffix] * (int(power[1]) if power else 1))


def fraction_of(digits: str) -> Fraction:
    """Decimal digits as an exact number. Raises ValueError for a number beyond every float."""
    _, _, exponent = digits.lower().partition("e")
    if exponent and abs(int(exponent)) > MAX_EXPONENT:
        raise ValueError(f"{digits}: not a number that can be stored")
    return Fraction(digits.replace(",", "."))


def read_number(text: str, unit: str = "") -> float:
    """Parse a number, rounded once.

    It may be a quotient, have a decimal comma, and end in a prefix (n, µ or u, k, M, G), in the unit, or in both;
    "cm" too, and "min" or "h" for seconds.
    Raises ValueError for text that is not a number, for "1,000", which depends on the country, and for "5m" where
    the unit is not the metre: five thousandths, or five minutes.
    """
    word = text.strip().replace("\u2212", "-")
    word = re.sub(r"(?<=\d)[\u00a0\u2009\u202f ](?=\d{3}(?!\d))", "", word)  # spaces between groups of digits
    match = NUMBER.fullmatch(word) if len(word) <= MAX_LENGTH else None
    if match is None:
        raise ValueError("not a number")
    number, divisor, suffix = match["number"], match["divisor"], (match["suffix"] or "").strip()
    if GROUPED.fullmatch(number):
        raise ValueError("the comma may mean two things: write 1000 or 1.000")
    value = fraction_of(number) * factor_of(suffix, unit)
    if divisor is not None:
        if fraction_of(divisor) == 0:
            raise ValueError("divided by zero")
        value /= fraction_of(divisor)
    try:
        return float(value)
    except OverflowError:
        raise ValueError("too large a number") from None


def write_number(value: float) -> str:
    """The shortest text that `read_number` reads as the same number: decimal digits, 1/n, or digits and exponent.

    A float below ten that is whole has a decimal place, "5.0", so that one sees that it may have others.
    """
    if isinstance(value, int):
        return str(value)
    decimal = Decimal(repr(float(value))).normalize()
    if value and len(decimal.as_tuple().digits) > LONGEST_PLAIN:
        divisor = round(1 / value)
        if 1 < divisor <= MAX_DENOMINATOR and 1 / divisor == value:
            return f"1/{divisor}"
    if value and not MIN_PLAIN <= abs(value) < MAX_PLAIN:
        return f"{decimal.scaleb(-decimal.adjusted()):f}e{decimal.adjusted()}"
    whole = value == int(value) and abs(value) < 10
    return f"{value:.1f}" if whole else f"{decimal:f}"


def plain(value: float) -> str:
    """A number as it is typed: 0.5, 1000, 1e9. For ranges and messages."""
    text = f"{value:g}"
    mantissa, e, exponent = text.partition("e")
    return f"{mantissa}e{int(exponent)}" if e else text
