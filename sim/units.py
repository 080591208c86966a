"""Units as people write them, in headers of columns and behind numbers, by the library `pint`.

It is imported when a unit has to be understood. It counts 1 rad/s as 1 Hz; here an angle is a dimension of its own.
"""

import functools
import re
from typing import Any, NamedTuple

MAX_LENGTH = 40  # characters of a unit
SIGNS = {"²": "^2", "³": "^3", "⁻¹": "^-1", "⁻²": "^-2", "·": "*", "×": "*", "°": "deg", "**": "^", "$": "", "{": "",
         "}": "", "µ": "u", "μ": "u", "\\": ""}  # fmt: skip
# A unit with an exponent of one digit: pint computes powers as they are written, however large.
FACTOR = r"(?:[A-Za-z]+(?:\^[-+]?[1-9])?|1|%)"
TERM = rf"(?:{FACTOR}|\({FACTOR}(?:[*/]{FACTOR})*\))"
FORM = re.compile(rf"{TERM}(?:[*/]{TERM})*")
ALIASES = {
    "hz": "Hz", "HZ": "Hz", "rads": "rad/s", "degs": "deg", "DEG": "deg", "mtr": "m", "secs": "s", "SEC": "s",
    "SECS": "s", "M": "m", "FT": "ft", "hr": "h", "hrs": "h", "mins": "min", "msec": "ms", "millisec": "ms",
    "milisec": "ms", "usec": "us", "tonne": "t", "tonnes": "t", "te": "t", "kn": "knot", "kt": "knot", "kts": "knot",
    "kmh": "(km/h)", "kph": "(km/h)", "Ns": "(N*s)", "kNs": "(kN*s)", "Nm": "(N*m)", "kNm": "(kN*m)", "MNm": "(MN*m)",
    "Nms": "(N*m*s)", "kNms": "(kN*m*s)", "Pas": "(Pa*s)", "mPas": "(mPa*s)",
}  # fmt: skip
CONSTANTS = ("c", "k", "e", "R")  # of physics, which pint takes for units


class UnitMeasure(NamedTuple):
    """A unit in metre, kilogram, second and radian."""

    factor: float
    dimensions: dict[str, float]  # "[length]" -> its power; angles apart
    angle: float  # power of an angle
    is_cyclic: bool  # it has a unit of cycles in time, as Hz


def written_plainly(text: str) -> str:
    """A unit with * and ^ between its factors: m^2*s for "m2 s" or "m² s"."""
    for sign, plain in SIGNS.items():
        text = text.replace(sign, plain)
    text = re.sub(r"([A-Za-z])([-+]?\d)", r"\1^\2", text.strip())
    text = re.sub(r"\s*([*/^()])\s*", r"\1", text)
    text = re.sub(r"(?<=[A-Za-z])-(?=[A-Za-z])", "*", text)  # N-s
    text = re.sub(r"(?<=\d)(?=[A-Za-z])|[ .]+(?=[A-Za-z1])", "*", text)
    text = re.sub(r"(?<!^1)/(rad|deg)/(s|Hz)\b", r"/(\1/\2)", text)  # m2/rad/s: people mean m2/(rad/s)
    return re.sub(r"[A-Za-z]+", lambda match: ALIASES.get(match[0], match[0]), text)


@functools.cache
def registry() -> Any:
    """The units that pint knows."""
    import pint

    return pint.UnitRegistry()


@functools.lru_cache(maxsize=256)
def measure_of(text: str) -> UnitMeasure | None:
    """The measure of a unit, None for an unknown one."""
    plain = written_plainly(text)
    if len(text) > MAX_LENGTH or plain in CONSTANTS or not FORM.fullmatch(plain):
        return None
    units = registry()
    try:
        parts = dict(units.parse_units_as_container(plain))
        factor, base = units.get_base_units(units.parse_units(plain))
        dimensions = {str(name): float(power) for name, power in base.dimensionality.items()}
        angle = float(dict(units.parse_units_as_container(str(base))).get("radian", 0.0))
        return UnitMeasure(float(factor), dimensions, angle, any(name.endswith("hertz") for name in parts))
    except Exception:  # its parser raises errors of many types
        return None
