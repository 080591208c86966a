"""A parameter declared once: `parameter(default, low, high, unit, doc)` in a frozen dataclass.

From the declaration come the control in the panel, its range and hint, the command-line flag, the preset file, the
sweep axis and the random test values. It also says what a change of the value affects, so that no scene keeps a list
of parameter names.

Two readings of a value from outside: `clamp_value` bounds it (live controls), `check_value` raises an error that names
the parameter, the value, its range and unit (command line, files).
"""

import dataclasses
import difflib
import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Literal, NamedTuple, TypeVar

from sim.quantities import plain, read_number
from sim.validation import argument_error, as_float, check_kind

P = TypeVar("P")
T = TypeVar("T")
Value = bool | int | float | str

Effect = Literal["look", "forces", "start"]
EFFECTS: tuple[Effect, ...] = ("look", "forces", "start")  # from the least to the greatest

TRUE = ("true", "yes", "on", "1")
FALSE = ("false", "no", "off", "0")
MAX_SHOWN_NAME = 60  # characters of an unknown name that an error repeats


class Parameter(NamedTuple):
    """The declaration of one parameter. `choices` is non-empty for named values only; low and high bound numbers.

    title: in the panel, "" for the name in words. choice_titles: in the panel, of each of `choices`.
    affects: effect of a change. "look": only on the picture or the speed of the clock; "forces": the motion continues
    under other forces; "start": the scene restarts.
    """

    default: Value
    low: float
    high: float
    unit: str
    doc: str
    log_from: float = 0.0
    choices: tuple[str, ...] = ()
    group: str = ""
    affects: Effect = "forces"
    title: str = ""
    choice_titles: tuple[str, ...] = ()

    @property
    def kind(self) -> type:
        """float, int, bool or str."""
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
        return f"{whole}{plain(self.low)} to {plain(self.high)}{unit}"

    def title_of(self, choice: str) -> str:
        """Title in the panel of one of `choices`."""
        return self.choice_titles[self.choices.index(choice)]

    def choice_of(self, title: str) -> str:
        """The choice with this title in the panel. Raises ValueError for an unknown title."""
        return self.choices[self.choice_titles.index(title)]


def parameter(
    default: Any,
    low: float = -math.inf,
    high: float = math.inf,
    unit: str = "",
    doc: str = "",
    *,
    log_from: float = 0.0,
    choices: tuple[str, ...] | Mapping[str, str] = (),
    group: str = "",
    affects: Effect = "forces",
    title: str = "",
) -> Any:
    """A dataclass field that is a parameter; see `Parameter` for `affects` and `title`.

    log_from: above 0, the slider moves over the logarithm from here to `high`; its left end is `low`, which may be 0.
    choices: names in the order of the panel's list, or name -> its title in the panel; by default the name in words.
    Raises ValueError for a declaration that contradicts itself.
    """
    if choices and default not in choices:
        raise argument_error("default", default, f"one of {', '.join(choices)}")
    if not choices and not isinstance(default, bool) and not low <= default <= high:
        raise argument_error("default", default, f"{low:g} to {high:g}")
    if log_from and not max(low, 0.0) <= log_from < high:
        raise argument_error("log_from", log_from, f"{max(low, 0.0):g} to below {high:g}")
    if affects not in EFFECTS:
        raise argument_error("affects", affects, f"one of {', '.join(EFFECTS)}")
    names = tuple(choices)
    titles = tuple(choices.values()) if isinstance(choices, Mapping) else tuple(in_words(name) for name in names)
    if len(set(titles)) < len(titles):
        raise argument_error("choices", choices, "titles that differ")
    declared = Parameter(default, low, high, unit, doc, log_from, names, group, affects, title, titles)
    return dataclasses.field(default=default, metadata={"parameter": declared})


def in_words(name: str) -> str:
    """A name as the panel writes it: "time_step" is "Time step". Names with capitals of their own stay as they are."""
    words = name.replace("_", " ")
    return words[:1].upper() + words[1:]


def redeclare(base: type, name: str, **changes: Any) -> Any:
    """A copy of the field of a parameter of `base`, for a derived class, with parts of its declaration changed.

    changes: fields of `Parameter`, as in `time_step: float = redeclare(Base, "time_step", affects="start")`.
    Raises ValueError if `base` has no such parameter.
    """
    known = parameters_of(base)
    if name not in known:
        raise unknown_parameter(name, known)
    declared = known[name]._replace(**changes)
    return dataclasses.field(default=declared.default, metadata={"parameter": declared})


def with_parameters(declared: Mapping[str, Parameter], **changes: Any) -> Callable[[type[T]], type[T]]:
    """A decorator, below that of a dataclass, which adds parameters that are declared elsewhere at the end of a class.

    changes: fields of `Parameter`, the same for all of them, as in `group="Weather"`. Raises ValueError if the class
    has such a name already.
    """

    def add(cls: type[T]) -> type[T]:
        for name, known in declared.items():
            if name in cls.__annotations__:
                raise argument_error("declared", name, f"names that {cls.__name__} does not have yet")
            cls.__annotations__[name] = known.kind
            setattr(
                cls, name, dataclasses.field(default=known.default, metadata={"parameter": known._replace(**changes)})
            )
        return cls

    return add


def parameters_of(record: Any) -> dict[str, Parameter]:
    """The parameters of a dataclass (or of an instance) by name, in order of declaration."""
    return {f.name: f.metadata["parameter"] for f in dataclasses.fields(record) if "parameter" in f.metadata}


def changed_names(old: object, new: object) -> frozenset[str]:
    """Names of the fields in which two records of one dataclass differ."""
    return frozenset(name for name, value in vars(new).items() if value != getattr(old, name))


def effect_of_change(old: object, new: object) -> Effect | None:
    """The greatest effect of the parameters in which two records differ; None if they are equal.

    A field that is not declared as a parameter affects the start.
    """
    declared = parameters_of(new)
    effects: set[Effect] = {declared[name].affects if name in declared else "start" for name in changed_names(old, new)}
    return max(effects, key=EFFECTS.index, default=None)


def clamp_value(parameter: Parameter, value: object) -> Value:
    """`value` as the parameter's kind, within its range. A value of another kind becomes the default."""
    if parameter.choices:
        return value if isinstance(value, str) and value in parameter.choices else parameter.default
    if parameter.kind is bool:
        return value if isinstance(value, bool) else parameter.default
    if isinstance(value, bool) or not isinstance(value, int | float):
        return parameter.default
    if value != value:  # NaN; a whole number may be too long for math.isnan
        return parameter.default
    bounded = min(max(value, parameter.low), parameter.high)
    if parameter.kind is int:
        return round(bounded) if math.isfinite(as_float(bounded)) else parameter.default
    return as_float(bounded)


def check_value(name: str, parameter: Parameter, value: object) -> Any:
    """`value` as the parameter's kind. Raises ValueError if `clamp_value` would have changed it."""
    if parameter.choices:
        if not isinstance(value, str) or value not in parameter.choices:
            raise choice_error(name, value, parameter.choices)
        return value
    if parameter.kind is bool:
        return check_kind(name, value, bool, parameter.allowed)
    number = as_float(value)  # inf for a whole number that is too long for a float
    if not isinstance(value, int | float) or not parameter.low <= number <= parameter.high:
        raise argument_error(name, value, parameter.allowed)
    if parameter.kind is not int:
        return number
    if not number.is_integer():
        raise argument_error(name, value, parameter.allowed)
    return int(value)


def unknown_parameter(name: str, known: Mapping[str, Parameter]) -> ValueError:
    """The error for a name that is no parameter: it lists similar names, or all names."""
    text = name if name.isidentifier() and len(name) <= MAX_SHOWN_NAME else repr(name[:MAX_SHOWN_NAME])
    close = similar(name, known)
    if close:
        return ValueError(f"{text}: no such parameter; did you mean {' or '.join(close)}?")
    return ValueError(f"{text}: no such parameter; the parameters are {', '.join(known)}")


def similar(word: object, names: Iterable[str]) -> list[str]:
    """At most four of `names` that `word` may have been meant for: written alike, or with it as a part."""
    names = tuple(names)
    lower = str(word).lower()
    parts = [name for name in names if len(lower) > 2 and lower in name.lower()]
    return (parts or difflib.get_close_matches(lower, names, n=2, cutoff=0.6))[:4]


def choice_error(name: str, value: object, choices: Iterable[str], more: str = "") -> ValueError:
    """The error for a value that is not one of the choices, with similar ones. more: further allowed values."""
    choices = tuple(choices)
    close = similar(value, choices) if isinstance(value, str) else []
    hint = f"; did you mean {' or '.join(close)}?" if close else ""
    return ValueError(f"{argument_error(name, value, 'one of ' + ', '.join(choices) + more)}{hint}")


def check_record(cls: type[P], values: Mapping[str, object]) -> P:
    """Make `cls` from named values; raises ValueError for an unknown name or a value out of range."""
    known = parameters_of(cls)
    for name in values:
        if name not in known:
            raise unknown_parameter(name, known)
    return cls(**{name: check_value(name, known[name], value) for name, value in values.items()})


def parse_value(name: str, parameter: Parameter, text: str) -> Value:
    """Read a parameter's value from typed text; numbers as in `read_number`, in the parameter's unit.

    Raises ValueError as `check_value` does, with a reason if one is known.
    """
    word = text.strip()
    if parameter.choices:
        return check_value(name, parameter, word)
    if parameter.kind is bool:
        if word.lower() not in TRUE + FALSE:
            raise argument_error(name, text, parameter.allowed)
        return word.lower() in TRUE
    try:
        number = read_number(word, parameter.unit)
    except ValueError as reason:
        raise argument_error(name, text, f"{parameter.allowed}; {reason}") from None
    try:
        return check_value(name, parameter, number)
    except ValueError:
        raise argument_error(name, text, parameter.allowed) from None


def parse_assignments(cls: type, assignments: list[str]) -> dict[str, Value]:
    """Values from ["name=value", ...]. Raises ValueError for another form, or a value that is not allowed."""
    known = parameters_of(cls)
    values: dict[str, Value] = {}
    for assignment in assignments:
        name, equals, text = assignment.partition("=")
        if not equals:
            raise ValueError(f"--set: {assignment!r} is not allowed; allowed: name=value")
        if name not in known:
            raise unknown_parameter(name, known)
        values[name] = parse_value(name, known[name], text)
    return values
