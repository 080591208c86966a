"""A name is one number in one unit, for a sweep (`measures`) and for a task of the lab (`live_values`)."""

import re
from typing import Any

import pytest

from app.scenes import NAMES, scene_named
from app.scenes.contract import Measure
from app.server.loop import SimLoop

SECOND = 60  # frames
# Names that stand in both; a scene that loses one here compares nothing.
SHARED = {"rope": 5, "race": 6, "cloth": 0, "square_sea": 5, "radial_sea": 19, "mooring": 2}
UNIT = re.compile(r"1|%|(m?(N|J|s|m|kg|Pa|rad)[²³]?)([·/](m?(N|J|s|m|kg|Pa)[²³]?))*")


def numbers_after(name: str, frames: int, **changes: object) -> tuple[dict[str, Measure], dict[str, Measure]]:
    """The numbers of a sweep and those of the tasks, of a scene at one moment."""
    kind: Any = scene_named(name)
    loop = SimLoop(kind.make(kind.params(**changes)), effort=lambda: 0.0)
    for _ in range(frames):
        loop.tick(1 / 60)
    measures = kind.measures(loop.scene) if kind.measures else {}
    loop.run.snapshots.publish()
    return measures, kind.live_values(loop.latest) if kind.live_values else {}


@pytest.mark.parametrize("name", NAMES)
def test_a_name_that_sweeps_and_tasks_have_is_one_number_in_one_unit(name: str) -> None:
    measures, live = numbers_after(name, SECOND)
    shared = measures.keys() & live.keys()
    assert len(shared) >= SHARED.get(name, 0)
    for one in shared:
        assert measures[one].unit == live[one].unit, one
        # A frame has single precision.
        assert measures[one].value == pytest.approx(live[one].value, rel=1e-6, nan_ok=True), one


def test_the_numbers_of_bodies_in_oil_are_the_same_too() -> None:
    measures, live = numbers_after("radial_sea", SECOND, spill="layer", thickness=0.2)
    assert measures["oil_viscosity"].unit == "Pa·s"
    assert measures["box_draft"].value != pytest.approx(measures["box_draft_at_rest"].value, abs=1e-3)
    for one in measures.keys() & live.keys():
        assert measures[one].value == pytest.approx(live[one].value, rel=1e-6, nan_ok=True), one


@pytest.mark.parametrize("name", NAMES)
def test_units_are_written_one_way(name: str) -> None:
    for numbers in numbers_after(name, 1):
        assert [(one, m.unit) for one, m in numbers.items() if not UNIT.fullmatch(m.unit)] == []
