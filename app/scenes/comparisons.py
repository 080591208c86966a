"""Set-ups side by side: the ready ones, the parameters that two have in common, and their differences in words."""

import dataclasses
from collections.abc import Sequence
from typing import Any, NamedTuple

from app.formats.formatting import number
from app.messages import BaseParams
from app.scenes import scene_named
from app.scenes.contract import AnyKind
from app.scenes.setups import Setup, read_query, read_setup, shortened
from sim.parameters import Parameter, Value, choice_error, clamp_value, in_words, parameters_of
from sim.validation import argument_error

MAX_PANES = 3  # each is a lab with a simulation and a page of its own
MAX_NAMED = 4  # differences that are written out above a pane


class Comparison(NamedTuple):
    """Set-ups that are shown side by side."""

    title: str
    queries: tuple[str, ...]  # of the set-ups, as of an address


PLANET_SEA = "?scene=square_sea&length=384&mesh=256&wind_speed=8&view=mast&plot_wave_gauge=true&visibility=6000"
COMPARISONS = {
    "planets": Comparison("Earth beside Mars", (f"{PLANET_SEA}&planet=Earth", f"{PLANET_SEA}&planet=Mars")),
    "moons": Comparison(
        "Earth beside Mars and Titan",
        (f"{PLANET_SEA}&planet=Earth", f"{PLANET_SEA}&planet=Mars", f"{PLANET_SEA}&planet=Titan"),
    ),
    "oil": Comparison(
        "Clean water beside oil",
        ("?scene=radial_sea&rig=false", "?scene=radial_sea&rig=false&spill=layer&thickness=0.2&exposure=300"),
    ),
    "grids": Comparison(
        "Radial grid beside square grid",
        (
            "?scene=radial_sea&rig=false&bodies=0&grid=true",
            "?scene=square_sea&spectrum=jonswap&wind_speed=7&wind_direction=25&grid=true&sun=71.6",
        ),
    ),
    "methods": Comparison(
        "Leapfrog beside Euler",
        (
            "?scene=rope&integrator=leapfrog&time_step=1/240&damping=3.5&drag=0",
            "?scene=rope&integrator=explicit_euler&time_step=1/240&damping=3.5&drag=0",
        ),
    ),
}


def comparison_named(name: str) -> tuple[Setup, ...]:
    """The set-ups of a ready-made comparison. Raises ValueError for an unknown name."""
    if name not in COMPARISONS:
        raise choice_error("compare", shortened(name), COMPARISONS)
    return tuple(read_query(query) for query in COMPARISONS[name].queries)


def check_count(setups: Sequence[object]) -> None:
    """Raises ValueError if that many set-ups cannot be shown side by side."""
    if not 2 <= len(setups) <= MAX_PANES:
        raise argument_error("set-ups side by side", len(setups), f"2 to {MAX_PANES}")


def read_comparison(words: Sequence[str]) -> tuple[Setup, ...]:
    """Set-ups as `read_setup` reads them, or the name of a comparison. Raises ValueError if one is not allowed."""
    if len(words) == 1 and words[0] in COMPARISONS:
        return comparison_named(words[0])
    if len(words) == 1:
        raise choice_error("set-ups side by side", words[0], COMPARISONS, f"; or 2 to {MAX_PANES} set-ups")
    setups = tuple(read_setup(word) for word in words)
    check_count(setups)
    return setups


def shared_parameters(a: BaseParams, b: BaseParams) -> dict[str, Parameter]:
    """Parameters that two records have in common and that are equal in all panes: sky, sun, light, speed."""
    ours, theirs = parameters_of(a), parameters_of(b)
    return {
        name: parameter
        for name, parameter in theirs.items()
        if (parameter.group == "Look" or name == "speed")
        and name in ours
        and (ours[name].kind, ours[name].choices) == (parameter.kind, parameter.choices)
    }


def with_shared(params: BaseParams, of: BaseParams) -> BaseParams:
    """Parameters with the common ones taken from another record, within their own ranges."""
    values: dict[str, Any] = {
        name: clamp_value(parameter, getattr(of, name)) for name, parameter in shared_parameters(of, params).items()
    }
    return dataclasses.replace(params, **values)


def written(parameter: Parameter, value: Value) -> str:
    """A value as the panel shows it, with its unit."""
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, str):
        return parameter.title_of(value) if parameter.choices else value
    return f"{number(value)} {parameter.unit}".strip()


def same_meaning(parameter: Parameter, other: Parameter | None) -> bool:
    """True if a parameter has one meaning in two scenes: "size" is that of a body in one and of a grid in another."""
    return other is not None and (parameter.doc, parameter.unit) == (other.doc, other.unit)


def differences(panes: Sequence[tuple[AnyKind, BaseParams]]) -> list[list[str]]:
    """Distinguishing values of each pane: "Gravity 9.81 m/s²", without parameters that have no effect there."""
    records = [params for _, params in panes]
    hidden = [kind.hidden(params) for kind, params in panes]
    first = parameters_of(records[0])
    common = {
        name for name in first if all(same_meaning(first[name], parameters_of(params).get(name)) for params in records)
    }
    shared = set.intersection(*(set(shared_parameters(records[0], params)) for params in records))
    kinds = {kind.name for kind, _ in panes}
    labels: list[list[str]] = [[kind.title] if len(kinds) > 1 else [] for kind, _ in panes]
    for name, parameter in first.items():
        if name not in common - shared or all(name in names for names in hidden):
            continue
        if all(getattr(params, name) == getattr(records[0], name) for params in records):
            continue
        title = parameter.title or in_words(name)
        for words, params, names in zip(labels, records, hidden, strict=True):
            own = parameters_of(params)[name]
            if name not in names:
                words.append(f"{title}: {written(own, getattr(params, name))}")
    return labels


def headings(panes: Sequence[tuple[AnyKind, BaseParams]]) -> list[str]:
    """Title of each pane: its differences."""
    titles: list[str] = []
    for (kind, _), words in zip(panes, differences(panes), strict=True):
        more = f" · and {len(words) - MAX_NAMED} more" if len(words) > MAX_NAMED else ""
        titles.append((" · ".join(words[:MAX_NAMED]) or kind.title) + more)
    return titles


def middle_of(name: str, params: BaseParams) -> tuple[float, float]:
    """Point (x, y) [m] on which side-by-side cameras are aligned."""
    middle = scene_named(name).middle
    return (0.0, 0.0) if middle is None else middle(params)
