"""A preset with other values makes the same record, whichever way it is asked for."""

import json
from collections.abc import Callable

import pytest

from app.__main__ import make_parser
from app.commands.options import read_params
from app.lab.course import task
from app.messages import BaseParams
from app.notebook.lab import read_setup as read_notebook
from app.panel.workbook.task_setups import setup_of_task
from app.scenes import NAMES, scene_named
from app.scenes.contract import AnyKind
from app.scenes.setups import make_setup, read_file, read_query, write_value
from app.study.sweep.spec import make_spec
from sim.parameters import Value

Values = dict[str, Value]
ALLOWED = r"speed: \S+ is not allowed; allowed: 0\.\d+ to \d"


def by_command_line(kind: AnyKind, preset: str, values: Values) -> BaseParams:
    assignments = [f"{name}={write_value(value)}" for name, value in values.items()]
    arguments = make_parser().parse_args(["run", kind.name, "--preset", preset, "--set", *assignments])
    return read_params(kind, arguments)


def by_link(kind: AnyKind, preset: str, values: Values) -> BaseParams:
    words = "".join(f"&{name}={write_value(value)}" for name, value in values.items())
    return read_query(f"?scene={kind.name}&preset={preset.replace('+', '%2B')}{words}").params


def by_file(kind: AnyKind, preset: str, values: Values) -> BaseParams:
    return read_file(json.dumps({"scene": kind.name, "preset": preset, "parameters": values})).params


def by_notebook(kind: AnyKind, preset: str, values: Values) -> BaseParams:
    return read_notebook(kind.name, preset, values)[1]


def by_task(kind: AnyKind, preset: str, values: Values) -> BaseParams:
    return setup_of_task(task.TaskSetup(scene=kind.name, look="at it", preset=preset, parameters=values)).params


def by_sweep(kind: AnyKind, preset: str, values: Values) -> BaseParams:
    """With the plots that the preset does not name switched on, as measures need them."""
    swept = {"speed": [values["speed"]]}
    spec = make_spec({"scene": kind.name, "seconds": 1.0, "preset": preset, "parameters": swept})
    off = {name: False for name in kind.plots if name not in kind.presets[preset]}
    return make_setup(kind, "", {**spec.fixed, **spec.cases[0], **off}).params


WAYS = [by_command_line, by_link, by_file, by_notebook, by_task, by_sweep]


@pytest.mark.parametrize("way", WAYS, ids=lambda way: way.__name__)
@pytest.mark.parametrize("scene", NAMES)
def test_all_ways_make_the_record_of_a_preset_and_values(
    scene: str, way: Callable[[AnyKind, str, Values], BaseParams]
) -> None:
    kind = scene_named(scene)
    for preset in kind.presets:
        values: Values = {"speed": 0.25}
        expected = kind.params(**{**kind.presets[preset], **values})
        assert way(kind, preset, values) == expected, preset
        assert make_setup(kind, preset, values).params == expected
    with pytest.raises(ValueError, match=ALLOWED):
        way(kind, next(iter(kind.presets)), {"speed": 1e9})
    with pytest.raises(ValueError, match="'nothing' is not allowed"):
        way(kind, "nothing", {"speed": 1.0})


@pytest.mark.parametrize("scene", NAMES)
def test_a_scene_alone_is_as_it_opens_and_one_with_values_as_its_defaults(scene: str) -> None:
    kind = scene_named(scene)
    opening = kind.params(**kind.presets[kind.opening] if kind.opening else {})
    assert make_setup(kind).params == read_query(f"?scene={scene}").params == read_notebook(scene, "", {})[1] == opening
    assert make_setup(kind, None, {"speed": 0.5}).params == make_setup(kind, "", {"speed": 0.5}).params
    assert make_setup(kind, "").params == kind.params()
