"""A name is one number in one unit for all that read the table of a scene: sweeps, notebooks, `--list`, and tasks."""

import collections
import dataclasses
import functools
import math
import re
from collections.abc import Callable
from typing import Any

import pytest

from app.__main__ import main
from app.formats.formatting import fixed
from app.lab.course.live_values import LiveNumber, names_in
from app.lab.course.task import Task, load_tasks
from app.notebook.dataset import to_dataset
from app.panel.workbook.guide import SnapshotValues
from app.scenes import NAMES, scene_named
from app.scenes.mooring.readings import report as mooring_report
from app.scenes.quantities import Quantity, measured, read, recorded_quantities, written
from app.scenes.radial_sea import report as radial_report
from app.server.loop.sim_loop import SimLoop
from app.study.sweep.case import run_case
from sim.ocean.weathering import Weathering
from sim.parameters import parameters_of

SECOND = 60  # frames
TASKS = [task for task in load_tasks(with_checks=False) if task.setup is not None]
OF_THE_RUN = {"time", "diverged"}
# Quantities that sweeps and tasks both read; a scene that loses one here compares nothing.
SHARED = {"rope": 8, "race": 9, "cloth": 1, "square_sea": 10, "radial_sea": 24, "mooring": 15}
UNIT = re.compile(r"1|%|(m?(N|J|s|m|kg|Pa|rad)[²³]?)([·/](m?(N|J|s|m|kg|Pa)[²³]?))*")


def loop_of(name: str, frames: int, **changes: object) -> tuple[Any, SimLoop]:
    """A scene after some frames."""
    kind: Any = scene_named(name)
    loop = SimLoop(kind.make(kind.params(**changes)), effort=lambda: 0.0)
    for _ in range(frames):
        loop.tick(1 / 60)
    return kind, loop


def check_one_number(kind: Any, loop: SimLoop) -> set[str]:
    """Compare the numbers of a sweep with those of the tasks; returns the names that both have."""
    recorded = measured(kind, loop.scene)
    loop.run.snapshots.publish()
    shown = SnapshotValues(kind, loop.latest)
    both = recorded.keys() & shown.keys()
    for name in both:
        live = shown[name]
        assert isinstance(live, LiveNumber)
        assert (recorded[name].unit, recorded[name].meaning) == (live.unit, live.meaning), name
        # A frame has single precision.
        assert recorded[name].value == pytest.approx(live.value, rel=1e-6, nan_ok=True), name
    return both


@pytest.mark.parametrize("name", NAMES)
def test_a_name_is_one_number_in_one_unit_for_sweeps_and_tasks(name: str) -> None:
    assert len(check_one_number(*loop_of(name, SECOND))) >= SHARED.get(name, 0)


def test_the_numbers_of_bodies_in_oil_are_the_same_too() -> None:
    kind, loop = loop_of("radial_sea", SECOND, spill="layer", thickness=0.2)
    assert {"oil_viscosity", "slick_area", "box_draft_at_rest"} <= check_one_number(kind, loop)
    found = measured(kind, loop.scene)
    assert found["oil_viscosity"].unit == "Pa·s"
    assert found["box_draft"].value != pytest.approx(found["box_draft_at_rest"].value, abs=1e-3)


@pytest.mark.parametrize("name", NAMES)
def test_all_readers_have_the_names_and_units_of_the_table(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    kind, loop = loop_of(name, 1)
    table = kind.quantities
    recorded = {one: quantity.unit for one, quantity in recorded_quantities(kind).items()}
    outcome = run_case(name, {}, (0.0,))
    assert {one: unit for one, (unit, _) in outcome.labels.items()} == recorded
    dataset = to_dataset(kind, loop.scene, (), "")
    kept = {one: dataset.get(f"measured_{one}", dataset.get(one)) for one in recorded}
    assert {one: variable.attrs["units"] for one, variable in kept.items() if variable is not None} == recorded
    assert main(["run", name, "--list"]) == 0
    listed = dict(re.findall(r"(?m)^  (\w+) \[(.+)\]$", capsys.readouterr().out))
    assert listed == {one: quantity.unit for one, quantity in table.items()}
    shown = SnapshotValues(kind, loop.latest)
    params = parameters_of(kind.params)
    assert set(shown) <= {one for one, quantity in table.items() if quantity.shown} | params.keys() | OF_THE_RUN
    assert not table.keys() & (params.keys() | OF_THE_RUN)  # a name is one number


@pytest.mark.parametrize("task", TASKS, ids=lambda task: task.name)
def test_what_a_task_names_is_in_the_table_of_its_scene(task: Task) -> None:
    assert task.setup is not None
    kind: Any = scene_named(task.setup.scene)
    shown = {one for one, quantity in kind.quantities.items() if quantity.shown}
    conditions = [condition.name for step in task.steps for condition in step.when]
    texts = []
    if task.guide is not None:
        conditions += [condition.name for condition in task.guide.needs]
        texts = [task.guide.answer]
    named = {*conditions, *task.setup.show, *(question.read_off for question in task.questions)} - {""}
    named |= {name for text in texts for name in names_in(text)}
    assert named - shown - parameters_of(kind.params).keys() - OF_THE_RUN == set()


def test_a_name_has_one_unit_in_all_scenes() -> None:
    units: dict[str, set[str]] = collections.defaultdict(set)
    for scene in NAMES:
        for name, quantity in scene_named(scene).quantities.items():
            units[name].add(quantity.unit)
    assert {name: found for name, found in units.items() if len(found) > 1} == {}
    assert [unit for found in units.values() for unit in found if not UNIT.fullmatch(unit) and unit != "J/m²"] == []


@pytest.mark.parametrize(
    ("name", "method", "count"),
    [
        ("square_sea", "fields", 1),
        ("radial_sea", "readings", 1),
        ("race", "readings", 1),
        ("mooring", "readings", 1),
        ("rope", "assess_stability", 1),
        ("rope", "tension", 1),
        ("cloth", "assess_stability", 0),
    ],
)
def test_a_sweep_computes_each_part_once_and_draws_no_frame(
    name: str, method: str, count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    kind: Any = scene_named(name)
    scene = kind.make(kind.params())
    calls: list[str] = []

    def counted(part: str, compute: Callable[[], object]) -> object:
        calls.append(part)
        return compute()

    for part in (method, "frame"):
        monkeypatch.setattr(scene, part, functools.partial(counted, part, getattr(scene, part)))
    measured(kind, scene)
    assert calls == [method] * count


def test_a_spill_is_found_once_for_all_its_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    kind: Any = scene_named("radial_sea")
    found: list[float] = []
    plain = Weathering.at
    monkeypatch.setattr(Weathering, "at", lambda self, hours: (found.append(hours), plain(self, hours))[1])
    scene = kind.make(kind.params(spill="layer", spill_hours=37.5, bodies=0))
    spilled = measured(kind, scene)
    assert found == [37.5]
    assert 0.0 < spilled["evaporated"].value < 1.0
    assert spilled["slick_area"].value > 0.0


def test_texts_of_the_panel_have_the_numbers_of_the_table() -> None:
    table = {"length": Quantity("m", "", lambda now: now), "force": Quantity("N", "", lambda now: now),
             "gone": Quantity("1", "", lambda now: None)}  # fmt: skip
    assert [written(table, "length", value) for value in (12.345, 0.0123)] == ["12.3\u00a0m", "12.3 mm"]
    assert [written(table, name, 0.0123) for name in ("force", "gone")] == ["0.0123\u00a0N", "–"]
    assert math.isnan(read(table, "gone", 1.0))
    for name, number, heading, notes_of in (
        ("mooring", "offset", "Tensions", mooring_report.notes_of),
        ("radial_sea", "red_buoy_draft_at_rest", "Archimedes' principle", radial_report.notes_of),
    ):
        kind, loop = loop_of(name, 2)
        loop.run.snapshots.publish()
        shown = fixed(read(kind.quantities, number, loop.latest), 3)
        said = shown if name == "radial_sea" else written(kind.quantities, number, loop.latest)
        assert said in notes_of(loop.latest)[heading]


def test_a_quantity_of_a_snapshot_is_computed_once_and_only_if_it_is_asked_for() -> None:
    kind, loop = loop_of("rope", 1)
    calls: list[str] = []

    def quantity(name: str, value: float | None, **options: bool) -> Quantity:
        return Quantity("m", name, lambda _: (calls.append(name), value)[1], **options)

    table = {"a": quantity("a", 1.0), "b": quantity("b", None), "c": quantity("c", 1.0, shown=False)}
    values = SnapshotValues(dataclasses.replace(kind, quantities=table), loop.latest)
    assert values["time"] == LiveNumber(loop.latest.status.time, "s", "Time")
    assert values["diverged"] is False
    assert calls == []
    assert [values.get(name) for name in ("a", "a", "b", "b", "c", "d")] == [LiveNumber(1.0, "m", "a")] * 2 + [None] * 4
    assert calls == ["a", "b"]
    assert {"a", "b", "c"} & set(values) == {"a"}
    assert calls == ["a", "b"]


def test_the_largest_stiffness_of_a_rope_is_that_of_a_link_whichever_parameter_sets_it() -> None:
    kind: Any = scene_named("rope")
    lab = kind.params(units="lab")
    rest = lab.length / (lab.points - 1)  # [m] of a link
    material = kind.params(
        units="material", axial_stiffness=lab.stiffness * rest, mass_per_length=lab.mass / rest,
        axial_viscosity=lab.damping * rest, drag_per_length=lab.drag / rest,
    )  # fmt: skip
    readings = [kind.make(params).readings() for params in (lab, material)]
    assert [one.parameter for one in readings] == ["stiffness", "axial_stiffness"]
    found = [measured(kind, kind.make(params))["largest_stiffness"].value for params in (lab, material)]
    assert found == [readings[0].largest_stiffness, pytest.approx(readings[1].largest_stiffness / rest)]
    assert found[1] == pytest.approx(found[0], rel=0.05)  # its last point is lighter


@pytest.mark.parametrize(("size", "length"), [("64", 100.0), ("128", 320.0)])
def test_the_square_grid_has_its_points_and_spacing(size: str, length: float) -> None:
    kind: Any = scene_named("square_sea")
    loop = SimLoop(kind.make(kind.params(size=size, mesh="32", length=length)), paused=True)
    assert read(kind.quantities, "square_grid_points", loop.latest) == int(size) ** 2
    assert read(kind.quantities, "square_spacing", loop.latest) == pytest.approx(length / int(size))
