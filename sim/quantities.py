"""Numbers as people write them: `read_number` takes "1e4", "1/60", "0,02", "20k", "36 km/h"; `write_number` shows one.

A number is written so that reading it again gives the very same number.
"""

import math
import re
from decimal import Decimal
from fractions import Fraction

from sim.units import measure_of

PREFIXES = {"n": -9, "u": -6, "µ": -6, "μ": -6, "m": -3, "k": 3, "K": 3, "M": 6, "G": 9}
CENTI = {"c": -2}  # with a unit only: "5 c" is not a number
TIMES = {"min": 60, "h": 3600}  # [s] that are typed for seconds
MAX_LENGTH = 64  # characters of a number
MAX_EXPONENT = 400  # beyond it every float is 0 or infinite
MAX_DENOMINATOR = 100_000  # of a number that is written as 1/n
MIN_PLAIN, MAX_PLAIN = 1e-4, 1e6  # below and from there a number is written with an exponent
LONGEST_PLAIN = 7  # significant digits; of a number with more of them, 1/n is tried first

MINUS = str.maketrans(
    dict.fromkeys("\u2212\u2010\u2011\u2012\u2013\ufe63\uff0d", "-")
)  # signs that typing programs put for it
SUPERSCRIPTS = str.maketrans("\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079\u207a\u207b", "0123456789+-")
RAISED = re.compile("[\u2070\u00b9\u00b2\u00b3\u2074-\u207b]+")
GROUP_GAP = re.compile(r"(?<=\d)[\u00a0\u2009\u202f '\u2019](?=\d{3}(?!\d))")  # between groups of digits
DIGITS = (
    r"[+-]?(?:10(?:\^|\*\*)[+-]?\d+"
    r"|(?:\d+(?:[.,]\d+)*[.,]?|[.,]\d+)(?:[eEdD][+-]?\d+|\s*[*x\u00d7\u00b7\u22c5]\s*10(?:\^|\*\*)[+-]?\d+)?)"
)
NUMBER = re.compile(rf"(?P<number>{DIGITS})(?:\s*/\s*(?P<divisor>{DIGITS}))?\s*(?P<suffix>[^\d\s].*)?", re.ASCII)
ALONE = re.compile(DIGITS, re.ASCII)
POWER = re.compile(r"\s*[*x\u00d7\u00b7\u22c5]?\s*10(?:\^|\*\*)([+-]?\d+)$", re.ASCII)
EXPONENT = re.compile(r"(?:[eEdD]|\s*[*x\u00d7\u00b7\u22c5]\s*10(?:\^|\*\*))[+-]?\d+$", re.ASCII)
# 1,000: one or one thousand, according to the country
AMBIGUOUS = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}", re.ASCII)
GROUPED = re.compile(r"[+-]?[1-9]\d{0,2}(?:([.,])\d{3})(?:\1\d{3})*", re.ASCII)


def plain_unit(unit: str) -> str:
    """A unit in characters that every keyboard has: m/s^2 for m/s²."""
    for sign, typed in (("²", "^2"), ("³", "^3"), ("·", " "), ("°", "deg")):
        unit = unit.replace(sign, typed)
    return unit


def factor_of(suffix: str, unit: str) -> Fraction:
    """The factor that a suffix stands for: a prefix, the unit, another unit of the same quantity, or both.

    Raises ValueError for any other suffix.
    """
    suffix, plain = plain_unit(suffix), plain_unit(unit)
    if suffix in ("", plain):
        return Fraction(1)
    if suffix in PREFIXES and suffix != "m":
        return Fraction(10) ** PREFIXES[suffix]
    if plain == "s" and suffix in TIMES:
        return Fraction(TIMES[suffix])
    if plain and suffix.endswith(plain):
        power = re.match(r"[A-Za-z]+\^(\d)", plain)  # of a prefix: 1 mm² is 1e-6 m²
        prefix = suffix.removesuffix(plain).strip()
        if prefix in PREFIXES | CENTI:
            return Fraction(10) ** ((PREFIXES | CENTI)[prefix] * (int(power[1]) if power else 1))
    factor = measured(suffix, plain)
    if factor is None and suffix == "m":  # a thousandth, a minute or a metre
        raise ValueError(f"'m' alone may mean two things: write {'ms or min' if plain == 's' else 'e-3'}")
    if factor is None:
        raise ValueError(f"{suffix!r} is no unit of it")
    return factor


def measured(suffix: str, unit: str) -> Fraction | None:
    """The factor of a unit of the same quantity, as km/h is 1/3.6 of m/s; None for another quantity or no unit."""
    own = measure_of(unit) if unit else None
    other = measure_of(suffix) if own is not None else None
    if own is None or other is None or (own.dimensions, own.angle) != (other.dimensions, other.angle):
        return None
    return Fraction(other.factor / own.factor)


def written_plainly(text: str) -> str:
    """A number in characters of every keyboard: a plain minus, raised digits as powers, no gaps between groups."""
    word = RAISED.sub(lambda match: "^" + match[0].translate(SUPERSCRIPTS), text.strip().translate(MINUS))
    return GROUP_GAP.sub("", word)


def with_point(digits: str, decimal: str = "") -> str:
    """Digits with a point as the decimal sign and no signs between groups: 1234.5 for 1.234,5 and for 1,234.5.

    decimal: the decimal sign if it is known. Raises ValueError for "1,000" where it is not, and for signs that have
    no meaning.
    """
    marks = re.findall(r"[.,]", digits)
    last = marks[-1] if marks else ""
    if not decimal and AMBIGUOUS.fullmatch(digits):
        whole = digits.replace(",", "")
        raise ValueError(f"the comma may mean two things: write {whole} or {digits.replace(',', '.')}")
    is_grouped = last not in ("", decimal) if decimal else len(marks) > 1 and len(set(marks)) == 1
    whole, fraction = (digits, "") if is_grouped else digits.rsplit(last, 1) if last else (digits, "")
    if re.search(r"[.,]", whole):
        groups = GROUPED.fullmatch(whole)
        if groups is None or (not is_grouped and groups[1] == last):
            raise ValueError("not a number")
        whole = whole.replace(groups[1], "")
    return f"{whole}.{fraction}" if fraction else whole


def decimal_sign(text: str) -> str:
    """The decimal sign that a number shows, "." or ","; "?" if it may be a sign between groups, "" without one.

    "" for a text that is no number.
    """
    word = written_plainly(text)
    if len(word) > MAX_LENGTH or not ALONE.fullmatch(word):
        return ""
    mantissa = EXPONENT.sub("", word)
    marks = re.findall(r"[.,]", mantissa)
    if len(marks) == 1 and mantissa == word and GROUPED.fullmatch(mantissa):
        return "?"
    if len(marks) > 1 and len(set(marks)) == 1:
        return "," if marks[0] == "." else "."
    return marks[-1] if marks else ""


def fraction_of(digits: str, decimal: str = "") -> Fraction:
    """The exact number of a text of DIGITS. Raises ValueError for a number beyond every float."""
    power = POWER.search(digits)
    mantissa = digits[: power.start()] if power else digits
    mantissa, _, exponent = mantissa.lower().replace("d", "e").partition("e")
    tens = int(power[1]) if power else int(exponent or 0)
    if abs(tens) > MAX_EXPONENT:
        raise ValueError(f"{digits}: not a number that can be stored")
    if mantissa in ("", "+", "-"):
        mantissa += "1"
    # of a number with an exponent the comma is the decimal sign: nobody writes groups there
    return Fraction(with_point(mantissa, decimal or ("," if (power or exponent) and "." not in mantissa else ""))) * (
        Fraction(10) ** tens
    )


def read_number(text: str, unit: str = "") -> float:
    """Parse a number, rounded once.

    It may have a decimal comma, groups of digits ("4,004,001", "1 000"), a power ("1.1 x 10^-3", "1,1e-3"), be a
    quotient, and end in a prefix (n, µ or u, k, M, G), in the unit, in both, or in another unit of the same quantity:
    "36 km/h" for m/s.
    Raises ValueError for text that is not a number, for "1,000", which depends on the country, and for "5m" where
    the unit is not the metre: five thousandths, or five minutes.
    """
    word = written_plainly(text)
    match = NUMBER.fullmatch(word) if len(word) <= MAX_LENGTH else None
    if match is None:
        raise ValueError("not a number")
    number, divisor, suffix = match["number"], match["divisor"], (match["suffix"] or "").strip()
    value = fraction_of(number) * factor_of(suffix, unit)
    if divisor is not None:
        if fraction_of(divisor) == 0:
            raise ValueError("divided by zero")
        value /= fraction_of(divisor)
    try:
        return float(value)
    except OverflowError:
        raise ValueError("too large a number") from None


def number_alone(text: str, decimal: str = "") -> float | None:
    """A text that is a number and nothing else, as `read_number` reads it; inf for a huge one, None for another text.

    decimal: the decimal sign, where other numbers tell it. Raises ValueError for "1,000" without one.
    """
    word = written_plainly(text)
    if len(word) > MAX_LENGTH or not ALONE.fullmatch(word):
        return None
    try:
        return float(fraction_of(word, decimal))
    except OverflowError:
        return math.inf


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
