"""The interleavings of tests/app/server/test_interleavings.py, 1,000 times each."""

# ruff: noqa: F401, F811  fixtures are imported

import pytest

from app.server.viewer import Viewer
from tests.app.server.test_interleavings import (
    change_scene_during,
    end_a_comparison_in_a_tick,
    pane,
    settle_a_preset_late,
    undo_during_a_compile,
    watched,
)
from tests.stress.tally import Tally

TIMES = 1000


@pytest.mark.parametrize("what", ["picture", "solve"])
def test_scene_changes_during_what_is_slow(what: str, watched: Viewer, tally: Tally) -> None:
    with tally.fault(f"scene changed during a slow {what}", TIMES):
        change_scene_during(what, watched, TIMES)


def test_presets_undone_while_they_are_compiled(watched: Viewer, monkeypatch: pytest.MonkeyPatch, tally: Tally) -> None:
    with tally.fault("preset undone during a compile", TIMES):
        undo_during_a_compile(watched, monkeypatch, TIMES)


def test_presets_that_settle_late(watched: Viewer, monkeypatch: pytest.MonkeyPatch, tally: Tally) -> None:
    with tally.fault("preset that settled late", TIMES):
        settle_a_preset_late(watched, monkeypatch, TIMES)


def test_comparisons_that_end_in_a_tick(
    watched: Viewer,
    pane: Viewer,
    monkeypatch: pytest.MonkeyPatch,
    tally: Tally,
) -> None:
    with tally.fault("comparison ended in a tick", TIMES):
        end_a_comparison_in_a_tick(watched, pane, monkeypatch, TIMES)
