"""Claims that every scene has to keep, and those of every scene of springs."""

import dataclasses
from typing import Any

import numpy as np
import pytest

from app.messages import GrabTo, Release, Reset
from app.scenes import NAMES, scene_named
from app.scenes.charts import Chart
from app.server.loop import SimLoop
from sim.parameters import check_record, parameters_of

PRESETS = [(name, preset) for name in NAMES for preset in scene_named(name).presets]


@pytest.mark.parametrize("name", NAMES)
def test_the_first_preset_is_the_defaults(name: str) -> None:
    kind = scene_named(name)
    assert check_record(kind.params, next(iter(kind.presets.values()))) == kind.params()


@pytest.mark.parametrize(("name", "preset"), PRESETS)
def test_hidden_parameters_are_parameters(name: str, preset: str) -> None:
    kind = scene_named(name)
    assert kind.hidden(check_record(kind.params, kind.presets[preset])) < set(parameters_of(kind.params))


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
        times = [row[0] for row in loop.run.snapshots.plot_rows]
        assert times[1:2] == ([0.0] if kind.plots else [])  # after the row that clears the plots
        over_time = [c for c in (loop.latest.curves or {}).values() if isinstance(c, Chart) and c.first == "t [s]"]
        assert all(chart.columns[0][0] == 0.0 for chart in over_time)
        assert times or over_time
