"""A parameter declared once: `knob(default, lo, hi, unit, doc)` in a frozen dataclass.

From the declaration come the slider, its range and hint, the command-line flag, the preset file and the clamp.
Two readings of a value that comes from outside: `clamp` bounds it (live sliders), `check` refuses it (command
line, files), naming knob, value, range and unit.
"""

import dataclasses
import math
from collections.abc import Mapping
from typing import Any, NamedTuple, TypeVar

P = TypeVar("P")

TRUE = ("true", "yes", "on", "1")
FALSE = ("false", "no", "off", "0")


class Knob(NamedTuple):
    """What a parameter may be. `choices` is non-empty for named values only; lo and hi bound numbers."""

    default: Any
    lo: float
    hi: float
    unit: str
    doc: str
    log_from: float = 0.0
    choices: tuple[str, ...] = ()
    group: str = ""

    @property
    def kind(self) -> type:
        return type(self.default)

    @property
    def allowed(self) -> str:
        """The allowed values in words, for messages and hints."""
        if self.choices:
            return "one of " + ", ".join(self.choices)
        if self.kind is bool:
            return "true or false"
        unit = f" {self.unit}" if self.unit else ""
        whole = "a whole number from " if self.kind is int else ""
        return f"{whole}{self.lo:g} to {self.hi:g}{unit}"


def knob(
    default: Any,
    lo: float = -math.inf,
    hi: float = math.inf,
    unit: str = "",
    doc: str = "",
    *,
    log_from: float = 0.0,
    choices: tuple[str, ...] = (),
    group: str = "",
) -> Any:
    """A dataclass field that is a knob.

    log_from: above 0, the slider moves over the logarithm from here to hi; its left end is lo, which may be 0.
    """
    if choices and default not in choices:
        raise ValueError(f"default: {default!r} is not allowed; allowed: one of {', '.join(choices)}")
    if not choices and not isinstance(default, bool) and not lo <= default <= hi:
        raise ValueError(f"default: {default!r} is not allowed; allowed: {lo:g} to {hi:g}")
    if log_from and not max(lo, 0.0) <= log_from < hi:
        raise ValueError(f"log_from: {log_from!r} is not allowed; allowed: {max(lo, 0.0):g} to below {hi:g}")
    meta = Knob(default, lo, hi, unit, doc, log_from, choices, group)
    return dataclasses.field(default=default, metadata={"knob": meta})


def knobs(params: Any) -> dict[str, Knob]:
    """The knobs of a dataclass (or of an instance) by name, in order of declaration."""
    return {f.name: f.metadata["knob"] for f in dataclasses.fields(params) if "knob" in f.metadata}


def clamp_value(knob: Knob, value: Any) -> Any:
    """`value` as the knob's kind, within its range. What is no such value at all becomes the default."""
    if knob.choices:
        return value if isinstance(value, str) and value in knob.choices else knob.default
    if knob.kind is bool:
        return value if isinstance(value, bool) else knob.default
    if isinstance(value, bool) or not isinstance(value, int | float):
        return knob.default
    if value != value:  # NaN; a whole number may be too long for math.isnan
        return knob.default
    bounded = min(max(value, knob.lo), knob.hi)
    return round(bounded) if knob.kind is int else float(bounded)


def clamp(params: P) -> P:
    """The same parameters with every knob bounded: NaN and wrong types become defaults."""
    fixed = {name: clamp_value(k, getattr(params, name)) for name, k in knobs(params).items()}
    return dataclasses.replace(params, **fixed)  # type: ignore[type-var]


def refusal(name: str, value: Any, allowed: str) -> ValueError:
    """The one form of a refusal: the name, the value given, and what is allowed."""
    return ValueError(f"{name}: {value!r} is not allowed; allowed: {allowed}")


def check_value(name: str, knob: Knob, value: Any) -> Any:
    """`value` as the knob's kind. Raises ValueError where `clamp_value` would have changed it."""
    if knob.choices or knob.kind is bool:
        good = clamp_value(knob, value)
        if good is not value and good != value:
            raise refusal(name, value, knob.allowed)
        return good
    number = isinstance(value, int | float) and not isinstance(value, bool)
    if not number or not knob.lo <= value <= knob.hi:
        raise refusal(name, value, knob.allowed)
    if knob.kind is int and value != int(value):
        raise refusal(name, value, knob.allowed)
    return knob.kind(value)


def check(cls: type[P], values: Mapping[str, Any]) -> P:
    """Make `cls` from named values; raises ValueError for an unknown name or a value out of range."""
    known = knobs(cls)
    for name in values:
        if name not in known:
            raise ValueError(f"{name}: no such knob; the knobs are {', '.join(known)}")
    return cls(**{name: check_value(name, known[name], value) for name, value in values.items()})


def parse_value(name: str, knob: Knob, text: str) -> Any:
    """Read a knob's value from command-line text. Raises ValueError as `check_value` does."""
    word = text.strip()
    if knob.choices:
        return check_value(name, knob, word)
    if knob.kind is bool:
        if word.lower() not in TRUE + FALSE:
            raise refusal(name, text, knob.allowed)
        return word.lower() in TRUE
    try:
        number = float(word)
    except ValueError:
        raise refusal(name, text, knob.allowed) from None
    return check_value(name, knob, number)


def parse(cls: type, assignments: list[str]) -> dict[str, Any]:
    """Values from ["name=value", ...]. Raises ValueError for what is not of that form or not allowed."""
    known = knobs(cls)
    values: dict[str, Any] = {}
    for assignment in assignments:
        name, equals, text = assignment.partition("=")
        if not equals:
            raise ValueError(f"--set: {assignment!r} is not allowed; allowed: knob=value")
        if name not in known:
            raise ValueError(f"{name}: no such knob; the knobs are {', '.join(known)}")
        values[name] = parse_value(name, known[name], text)
    return values
