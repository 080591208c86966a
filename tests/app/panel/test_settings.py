"""The settings of a scene without a server: each change is one command, and is told once."""

import dataclasses
from types import SimpleNamespace
from typing import Any

import pytest

from app.messages import Change, GoBack
from app.panel.history import SceneRequest
from app.panel.settings import Placing, SceneSettings
from app.render.cameras import ClientCamera
from app.scenes import scene_named
from app.scenes.contract import Advice
from app.scenes.mooring.parameters import MooringParams
from app.scenes.rope.parameters import RopeParams
from app.scenes.setups import Setup
from sim.parameters import Effect

CAMERA = (1.0, 2.0, 3.0), (0.0, 0.0, 1.0)


class Told:
    """Settings of the rope, and what they post, ask for and tell."""

    def __init__(self) -> None:
        self.posted: list[Any] = []
        self.asked: list[Any] = []
        self.shown: list[Any] = []
        server: Any = SimpleNamespace(get_clients=dict)
        self.settings = SceneSettings(server, scene_named("rope"), RopeParams(), self.posted.append, self.asked.append)
        self.settings.watchers.append(lambda: self.shown.append(self.settings.params))


@pytest.fixture
def told(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> Told:
    monkeypatch.setenv("SPRINGTIDE_DATA", str(tmp_path_factory.mktemp("data")))
    return Told()


def test_a_value_is_bounded_posted_and_told_once(told: Told) -> None:
    told.settings.set("points", 10**6)
    expected = RopeParams(points=1000)
    assert told.settings.params == expected
    assert told.posted == [Change(expected, "forces", 1)]
    assert told.shown == [expected]
    told.settings.set("points", 1000)
    assert (len(told.posted), len(told.shown)) == (1, 1)


def test_an_advice_is_set_and_the_scene_begins_again(told: Told) -> None:
    told.settings.follow(Advice("time_step", 1 / 500, "1/500 s"))
    assert told.posted == [Change(RopeParams(time_step=1 / 500), "start", 2)]
    told.settings.undo()
    assert told.posted[1:] == [GoBack(RopeParams(), 1)]
    assert (told.settings.params, len(told.posted)) == (RopeParams(), 2)


@pytest.mark.parametrize(
    ("name", "value", "effect"), [("grid", False, "look"), ("gravity", 3.0, "forces"), ("stiffness", 90.0, "forces")]
)
def test_a_change_and_its_undo_carry_their_effect(told: Told, name: str, value: object, effect: Effect) -> None:
    told.settings.set(name, value)
    told.settings.undo()
    changed = dataclasses.replace(RopeParams(), **{name: value})
    assert told.posted == [Change(changed, effect, 1), Change(RopeParams(), effect, 1)]


def test_all_plots_open_and_close_together(told: Told) -> None:
    settings = told.settings
    names = [*settings.kind.plots, *settings.kind.curves]
    settings.set(names[0], True)
    for on in (False, True, False):
        settings.toggle_plots()
        assert [getattr(settings.params, name) for name in names] == [on] * len(names)
    assert len(told.posted) == 4
    settings.undo()
    assert all(getattr(settings.params, name) for name in names)


def test_a_setup_is_loaded_with_its_camera_or_asked_for_in_another_scene(told: Told) -> None:
    settings, cloth = told.settings, scene_named("cloth").params()
    settings.show_setup(Setup("rope", RopeParams(mass=0.3), {}, "Pendulum", CAMERA), 7)
    assert settings.placing == Placing(2, first_view=True, cameras=(ClientCamera(7, *CAMERA),))
    assert (settings.params, settings.loaded) == (RopeParams(mass=0.3), "Pendulum")
    assert settings.other_name == "Pendulum (changed)"
    settings.show_setup(Setup("cloth", cloth, {}, "", CAMERA), 7)
    assert told.asked == [SceneRequest("cloth", cloth, (ClientCamera(7, *CAMERA),))]
    assert len(told.posted) == 1
    settings.undo()
    assert settings.params == RopeParams()
    assert told.posted[-1] == GoBack(RopeParams(), 1)


def test_a_file_whose_lines_were_changed_says_so_in_the_list_of_presets(told: Told) -> None:
    server: Any = SimpleNamespace(get_clients=dict)
    kind, params = scene_named("mooring"), MooringParams(moordyn_file="three.txt")
    settings = SceneSettings(server, kind, params, told.posted.append, told.asked.append, {"mooring": params})
    edited = dataclasses.replace(params, file_changes=(("length", "1", 192.0),))
    names = []
    for shown in (params, dataclasses.replace(params, depth=70.0), edited):
        settings.params = shown
        names.append(settings.other_name)
    assert names == ["", "three.txt", "three.txt (changed)"]


def test_an_error_of_one_watcher_silences_no_other(told: Told) -> None:
    def broken() -> None:
        raise KeyError("broken")

    told.settings.watchers[:0] = [broken, broken]
    with pytest.raises(KeyError, match="broken"):
        told.settings.set("points", 20)
    assert told.shown == [RopeParams(points=20)]
