"""Claims that every scene has to keep, and those of every scene of springs."""

import dataclasses
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import pytest

from app.messages import GrabTo, Release, Reset
from app.scenes import NAMES, scene_named
from app.scenes.charts import Chart
from app.server.loop.sim_loop import SimLoop
from sim.parameters import Parameter, check_record, parameters_of

PRESETS = [(name, preset) for name in NAMES for preset in scene_named(name).presets]


@pytest.mark.parametrize("name", NAMES)
def test_the_first_preset_is_the_defaults(name: str) -> None:
    kind = scene_named(name)
    assert check_record(kind.params, next(iter(kind.presets.values()))) == kind.params()


@pytest.mark.parametrize(("name", "preset"), PRESETS)
def test_hidden_parameters_are_parameters(name: str, preset: str) -> None:
    kind = scene_named(name)
    assert kind.hidden(check_record(kind.params, kind.presets[preset])) < set(parameters_of(kind.params))


def another(parameter: Parameter, value: Any) -> Any:
    """Another value of a parameter; the same of a text."""
    if parameter.choices:
        return next(choice for choice in parameter.choices if choice != value)
    if parameter.kind is bool:
        return not value
    if parameter.kind is str:
        return value
    found = 1.3 * value if value and 1.3 * value <= parameter.high else 0.63 * parameter.low + 0.37 * parameter.high
    return parameter.kind(found)


def leaves(value: Any, params: type, at: str = "") -> Iterator[tuple[str, Any]]:
    """Arrays, numbers and texts of a record, with where they are; without the parameters."""
    if isinstance(value, params):
        return
    if isinstance(value, Mapping):
        entries = [(f"{at}[{key}]", one) for key, one in value.items()]
    elif hasattr(value, "_fields"):
        entries = [(f"{at}.{name}", getattr(value, name)) for name in value._fields]
    elif dataclasses.is_dataclass(value):
        entries = [(f"{at}.{field.name}", getattr(value, field.name)) for field in dataclasses.fields(value)]
    elif isinstance(value, list | tuple):
        entries = [(f"{at}[{number}]", one) for number, one in enumerate(value)]
    else:
        if isinstance(value, np.ndarray | int | float | str | bool | None):
            yield at, value
        return
    for name, one in entries:
        yield from leaves(one, params, name)


def same(one: Any, other: Any) -> bool:
    """True if two arrays, numbers or texts are one, to rounding and NaN included."""
    if isinstance(one, np.ndarray | float) and np.asarray(one).dtype.kind == "f":
        return np.shape(one) == np.shape(other) and np.allclose(one, other, rtol=1e-6, atol=1e-12, equal_nan=True)
    return np.array_equal(one, other)


# What is not there, as oil, hulls or the ball, has numbers in the records too; and how long something took.
UNSEEN = ("time", "cost", ".column", ".past", ".hulls", "sphere_home")
# One change from the defaults each, of those that decide what is hidden.
CHANGES: dict[str, tuple[dict[str, Any], ...]] = {
    "cloth": ({"sphere": True}, {"thickness": 0.0, "air": 0.0}, {"wind": 5.0}),
    "mooring": ({"wave_height": 0.0}, {"regular": False}, {"watch": False}),
    "race": ({"ropes": 1}, {"ropes": 5}, {"race_steps": "own steps"}),
    "radial_sea": (
        {"surface": "fft"}, {"waves": False}, {"spectrum": "regular"}, {"bodies": 0}, {"spill": "mixed"},
        {"rig": True, "jet": True}, {"own_densities": True, "bodies": 2},
    ),
    "rope": ({"floor": False}, {"sphere": True}, {"integrator": "auto"}),
    "square_sea": (
        {"planet": "by gravity"}, {"planet": "Mars"}, {"foam": False}, {"foam_by_wind": False}, {"deep": False},
        {"start": "breather", "dispersion_scale": 0.7}, {"order": 3}, {"spectrum": "regular"}, {"rain": 10.0},
    ),
}  # fmt: skip


def setups() -> list[Any]:
    """Presets and changes; `long` where an earlier one of the scene hides the same parameters."""
    found, seen = [], set()
    changes = [(name, number) for name, changes in CHANGES.items() for number in range(len(changes))]
    for name, setup in [*PRESETS, *changes]:
        kind = scene_named(name)
        hidden = name, frozenset(kind.hidden(params_of(name, setup)))
        found.append(pytest.param(name, setup, marks=pytest.mark.long if hidden in seen else ()))
        seen.add(hidden)
    return found


def params_of(name: str, setup: str | int) -> Any:
    """The parameters of a preset, or of a change by its number."""
    kind = scene_named(name)
    return check_record(kind.params, kind.presets[setup] if isinstance(setup, str) else CHANGES[name][setup])


@pytest.mark.parametrize(("name", "setup"), setups())
def test_hidden_parameters_change_nothing(name: str, setup: str | int) -> None:
    """All of them at once: what a scene shows and tells after a few steps is the same."""
    kind, params = scene_named(name), params_of(name, setup)
    declared = parameters_of(kind.params)
    changes = {one: another(declared[one], getattr(params, one)) for one in kind.hidden(params)}
    found = []
    for one in (params, dataclasses.replace(params, **changes)):
        scene: Any = kind.make(one)
        scene.advance(6)
        told = {"frame": scene.frame(), "rows": scene.take_plot_rows(), "readings": scene.readings()}
        found.append({at: value for at, value in leaves(told, kind.params) if not any(part in at for part in UNSEEN)})
    assert found[0].keys() == found[1].keys()
    assert [at for at, value in found[0].items() if not same(value, found[1][at])] == []


@pytest.mark.parametrize("name", NAMES)
def test_arrays_for_files_are_finite_and_have_units(name: str) -> None:
    kind = scene_named(name)
    arrays = kind.make(kind.params()).arrays().values()
    assert all(np.isfinite(array).all() for array, _ in arrays)
    assert any(unit for _, unit in arrays)


@pytest.mark.parametrize(
    ("name", "values", "held", "other"),
    [
        ("rope", {}, 7, 5),
        ("race", {"ropes": 2}, 14, 5),
        ("cloth", {"rows": 10, "cols": 10, "time_step": 1 / 1200, "wind": 0.0}, 74, 20),
    ],
)
def test_what_one_browser_holds_no_other_takes_or_releases(name: str, values: dict, held: int, other: int) -> None:
    kind = scene_named(name)
    scene: Any = kind.make(kind.params(**values))
    scene.handle(GrabTo(held, (0.0, 0.0, 2.0), client=1))
    scene.handle(GrabTo(other, (1.0, 0.0, 2.0), client=2))
    if name != "cloth":
        scene.handle(GrabTo(0, (1.0, 0.0, 2.0), client=2))  # the root as a bead
    scene.handle(Release(client=2))
    scene.advance(2)
    assert scene.frame().grab.particle == held
    assert scene.frame().grab.target[0] < 0.5
    assert name == "cloth" or scene.handles.root.at_rest
    scene.handle(Release(client=1))
    assert scene.frame().grab is None
    scene.handle(GrabTo(other, (1.0, 0.0, 2.0), client=2))
    assert scene.frame().grab.particle == other


@pytest.mark.parametrize("name", NAMES)
def test_plots_begin_at_the_start_of_a_run(name: str) -> None:
    kind = scene_named(name)
    params = kind.params()
    charts = dict.fromkeys((*kind.plots, *kind.curves), True)
    loop = SimLoop(kind.make(dataclasses.replace(params, **charts)), effort=lambda: 0.0)
    for _ in range(2):
        loop.commands.put(Reset())
        loop.run.snapshots.plot_rows.clear()
        for _ in range(10):
            loop.tick(1 / 60)
        times = [row[0] for _, row in loop.run.snapshots.plot_rows]
        assert times[:1] == ([0.0] if kind.plots else [])
        over_time = [c for c in (loop.latest.curves or {}).values() if isinstance(c, Chart) and c.first == "t [s]"]
        assert all(chart.columns[0][0] == 0.0 for chart in over_time)
        assert times or over_time
