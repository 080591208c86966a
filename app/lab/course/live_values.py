"""Values of a running scene for tasks: in answers, conditions and readings."""

import math
import operator
import string
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from app.formats.formatting import EASY, count, fixed, metres_above, number, percent, with_unit
from sim.validation import argument_error

UNKNOWN = "…"  # where the scene has no such value


class LiveNumber(NamedTuple):
    """A present number of a scene."""

    value: float
    unit: str = ""
    meaning: str = ""
    floor: float = 0.0  # of a length, to which it is known; NaN: it is not known

    def __format__(self, spec: str) -> str:
        """The number with its unit. spec: how many significant digits, 3 by default, or one of these.

        "%" percent; "n" a rounded number of things; ".2" two fixed decimals; "3u" three digits in an easy unit (mm).
        """
        if spec == "%":
            return percent(self.value, 3)
        if spec == "n":
            return count(self.value)
        if self.floor != 0.0:
            return metres_above(self.floor, self.value)
        if not spec:
            return with_unit(self.value, self.unit)
        if spec.endswith("u"):
            spec = spec[:-1]
            if self.unit in EASY:
                return EASY[self.unit](self.value, int(spec or 3))
        text = fixed(self.value, int(spec[1:])) if spec.startswith(".") else number(self.value, int(spec or 3))
        return f"{text}\u00a0{self.unit}" if self.unit not in ("", "1") else text


LiveValue = bool | str | LiveNumber
LiveValues = Mapping[str, LiveValue]

RELATIONS: dict[str, Callable[[float, float], bool]] = {
    ">=": operator.ge, "<=": operator.le, ">": operator.gt, "<": operator.lt,
}  # fmt: skip


class Condition(NamedTuple):
    """A condition on one live value: that it equals `value`, or the relation to a number."""

    name: str
    relation: str  # one of RELATIONS, or "="
    value: bool | str | float

    def holds(self, values: LiveValues) -> bool:
        """True if it holds; a missing value fulfils no condition."""
        live_value = values.get(self.name)
        if isinstance(live_value, LiveNumber) and isinstance(self.value, float):
            if self.relation == "=":
                return math.isclose(live_value.value, self.value, rel_tol=1e-6, abs_tol=1e-12)
            return RELATIONS[self.relation](live_value.value, self.value)
        return type(live_value) is type(self.value) and live_value == self.value


def read_conditions(where: str, table: Mapping[str, Any]) -> tuple[Condition, ...]:
    """The conditions of a TOML table: name = value, or name = "> 5". Raises ValueError for another form."""
    conditions = []
    for name, value in table.items():
        relation = next((r for r in RELATIONS if isinstance(value, str) and value.startswith(r)), "=")
        if relation != "=":
            try:
                value = float(value[len(relation) :])
            except ValueError:
                raise argument_error(f"{where}: {name}", value, 'a relation to a number, as in "> 5"') from None
        elif isinstance(value, int | float) and not isinstance(value, bool):
            value = float(value)
        if not isinstance(value, bool | str | float):
            raise argument_error(f"{where}: {name}", value, "a number, a text, true or false")
        conditions.append(Condition(name, relation, value))
    return tuple(conditions)


class NamesOnly(string.Formatter):
    """Formats live values by name; a field is never more than a name."""

    def get_field(self, field_name: str, args: Any, kwargs: Any) -> tuple[Any, str]:
        """The value of a field, or `UNKNOWN`."""
        return kwargs.get(field_name, UNKNOWN), field_name

    def format_field(self, value: Any, format_spec: str) -> str:
        """A number as `LiveNumber` writes it, anything else as it is."""
        return format(value, format_spec) if isinstance(value, LiveNumber) else str(value)


def names_in(template: str) -> set[str]:
    """The names of the live values that a text uses. Raises ValueError if `fill_in` cannot fill one in."""
    fields = [(name, spec) for _, name, spec, _ in string.Formatter().parse(template) if name is not None]
    for _, spec in fields:
        format(LiveNumber(1.0), spec or "")
    return {name for name, _ in fields}


def fill_in(template: str, values: LiveValues) -> str:
    """A text with the live values in place of their names in braces."""
    return NamesOnly().vformat(template, (), values)
