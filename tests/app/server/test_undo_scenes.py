"""Undo and redo through the scenes of a lab: random sequences against a model of what a person sees."""

import dataclasses
import random
import time
from typing import Any, NamedTuple

import pytest

from app.messages import Play
from app.panel.history import MAX_SETTINGS
from app.scenes import scene_named
from app.server.viewer import Viewer
from sim.parameters import check_record, in_words
from tests.waiting import wait_for

SMALL: dict[str, dict[str, Any]] = {
    "rope": {"points": 5},
    "race": {"ropes": 2, "points": 4},
    "square_sea": {"size": "64"},
}
NUMBERS = {"rope": "stiffness", "race": "mass", "square_sea": "amplitude"}
ACTS = 12


class Screen(NamedTuple):
    """What a person sees."""

    scene: str
    params: Any
    preset: str


@pytest.fixture(autouse=True)
def prompt_scenes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.server.viewer.MIN_SCENE_TIME", 0.0)


def screen(lab: Viewer) -> Screen:
    settings = lab.settings
    return Screen(settings.kind.name, settings.params, settings.loaded)


def shows(lab: Viewer, expected: Screen) -> bool:
    """True if a scene with these settings is open, and its run has them."""
    return lab.is_open and screen(lab) == expected and lab.loop.scene.params == expected.params


def open_scene(lab: Viewer, scene: str) -> None:
    before = lab.current
    lab.want(scene, check_record(scene_named(scene).params, SMALL[scene]))
    wait_for(lambda: lab.is_open and lab.current is not before)


def test_an_undo_after_another_scene_goes_back_to_the_first_with_its_parameters_and_preset(lab: Viewer) -> None:
    lab.settings.load("Pendulum")
    lab.settings.set("mass", 0.3)
    before = screen(lab)
    lab.settings.open_first_view_of("race")
    wait_for(lambda: lab.is_open and lab.settings.kind.name == "race")
    after = screen(lab)
    assert lab.settings.undo_words == f"back to {in_words('rope')}, in a new run"
    lab.settings.undo()
    wait_for(lambda: shows(lab, before))
    assert lab.settings.redo_words == f"forward to {in_words('race')}, in a new run"
    lab.settings.undo()
    assert lab.settings.params == dataclasses.replace(before.params, mass=lab.settings.params_of("Pendulum").mass)  # type: ignore[attr-defined]
    lab.settings.redo()
    wait_for(lambda: shows(lab, before))
    lab.settings.redo()
    wait_for(lambda: shows(lab, after))
    assert lab.settings.redo_words == ""


def test_an_undo_pressed_twice_goes_through_one_scene_and_acts_meanwhile_are_kept(lab: Viewer) -> None:
    first = screen(lab)
    open_scene(lab, "race")
    second = screen(lab)
    open_scene(lab, "square_sea")
    with lab.changing:  # until then no scene is opened
        lab.settings.undo()
        wait_for(lambda: lab.requests.waiting.empty())
        lab.settings.undo()
    wait_for(lambda: shows(lab, second) and lab.requests.waiting.empty())
    time.sleep(0.3)  # the second press is taken out of the queue before its scene would be opened
    with lab.changing:
        words = lab.settings.undo_words, lab.settings.redo_words
        assert words == ("back to Rope, in a new run", "forward to Square sea, in a new run")
    with lab.changing:
        lab.settings.undo()
        wait_for(lambda: lab.requests.waiting.empty())  # it waits for the scene
        lab.settings.set("mass", 0.02)
        changed = screen(lab)
    wait_for(lambda: shows(lab, first))
    lab.settings.undo()
    wait_for(lambda: shows(lab, changed))


def test_a_scene_that_could_not_be_opened_does_not_lose_the_one_before(
    lab: Viewer, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = screen(lab)
    race = scene_named("race")

    def fail(params: Any) -> Any:
        raise MemoryError("no room")

    with monkeypatch.context() as patch:
        broken = dataclasses.replace(race, make=fail)
        patch.setattr("app.server.viewer.scene_named", lambda name: broken if name == "race" else scene_named(name))
        lab.want("race")
        wait_for(lambda: not lab.is_open)
    open_scene(lab, "square_sea")
    lab.settings.undo()
    wait_for(lambda: shows(lab, before))


@pytest.mark.parametrize("seed", [1, *(pytest.param(seed, marks=pytest.mark.stress) for seed in range(2, 20))])
def test_random_acts_in_several_scenes_are_undone_and_repeated_one_by_one(lab: Viewer, seed: int) -> None:
    rng = random.Random(seed)
    before: list[Screen] = []
    after: list[Screen] = []
    open_scene(lab, "rope")  # the same scene anew is an act, too
    lab.commands.put(Play())
    lab.loop.run.audience = lambda: 1
    for _ in range(ACTS):
        now = screen(lab)
        match rng.choice(["scene", "scene", "number", "preset", "undo", "undo", "redo"]):
            case "scene":
                open_scene(lab, rng.choice([scene for scene in SMALL if scene != now.scene]))
            case "number":
                lab.settings.set(NUMBERS[now.scene], getattr(now.params, NUMBERS[now.scene]) * 0.99)
                lab.settings.history.changed_at -= 100.0  # [s]
            case "preset":
                lab.settings.load_params(now.params, rng.choice(list(lab.settings.kind.presets)))
            case "undo" if before:
                lab.settings.undo()
                after.append(now)
                wait_for(lambda: shows(lab, before[-1]))
                before.pop()
                continue
            case "redo" if after:
                lab.settings.redo()
                before.append(now)
                wait_for(lambda: shows(lab, after[-1]))
                after.pop()
                continue
            case _:
                continue
        before.append(now)
        after.clear()
        wait_for(lambda: shows(lab, screen(lab)))
    assert len(lab.settings.history.settings) == 1 + len(before) < MAX_SETTINGS
    for earlier in reversed(before):
        lab.settings.undo()
        wait_for(lambda earlier=earlier: shows(lab, earlier))
