"""Links of one browser of a shared lab: the last one wins, all see it for some seconds, and it can be undone."""

import asyncio
import types
from typing import Any
from unittest.mock import Mock

import pytest

from app.panel.sharing.scene_switches import SHOWN_TIME, UNDO, SceneSwitch, SceneSwitches, SwitchNotice
from app.scenes import scene_named
from app.scenes.setups import make_setup
from app.server.viewer import Viewer
from tests import coroutines
from tests.app.channels import text_of
from tests.app.server.visitors import Visitor, until, visitor


def field_of(lab: Viewer) -> Any:
    """The field for messages of pages."""
    return lab.panel.share.channel.field


async def follow(browser: Visitor, query: str) -> None:
    """Follow a link, and wait until the line about it is drawn."""
    await browser.send(field_of(browser.lab), text_of("open", query, page=f"page{browser.client}"))
    await until(lambda: f'data-page="page{browser.client}"' in shown(browser.lab))


async def undo(browser: Visitor) -> None:
    """Press the button below the line."""
    await browser.send(browser.lab.panel.share.notice.undo, UNDO)


def shown(lab: Viewer) -> str:
    """The line in the panel; "" for none."""
    notice = lab.panel.share.notice
    assert notice.text.visible == notice.undo.visible
    return notice.text.content if notice.text.visible else ""


def test_the_time_of_a_change_begins_in_the_scene_that_it_opened(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = [100.0]
    monkeypatch.setattr("app.panel.sharing.scene_switches.time", types.SimpleNamespace(monotonic=lambda: clock[0]))
    before = make_setup(scene_named("rope"))
    changes = SceneSwitches()
    changes.latest = SceneSwitch("page", "cloth", make_setup(scene_named("cloth")), before)
    for _ in range(2):  # while the cloth is compiled
        assert changes.shown_in("rope") is None
        clock[0] += 2.0 * SHOWN_TIME
    assert changes.shown_in("cloth") is not None
    clock[0] += 1.01 * SHOWN_TIME
    assert changes.shown_in("cloth") is None
    assert changes.latest is None


def test_a_change_is_undone_once() -> None:
    undone: list[SceneSwitch] = []
    changes, gui = SceneSwitches(), Mock()
    notice = SwitchNotice(gui, "rope", changes, undone.append, lambda change: False)
    rope = make_setup(scene_named("rope"))
    changes.latest = change = SceneSwitch("page", "rope", rope, rope)
    for _ in range(2):
        coroutines.run(notice.on_undo(Mock()))
    assert undone == [change]


def test_all_see_for_some_seconds_who_opened_what(lab: Viewer, monkeypatch: pytest.MonkeyPatch) -> None:
    clock = [100.0]
    monkeypatch.setattr("app.panel.sharing.scene_switches.time", types.SimpleNamespace(monotonic=lambda: clock[0]))

    async def follow_links() -> None:
        async with visitor(lab) as first:
            await first.send(field_of(lab), text_of("open", "?scene=rope&points=9"))  # nobody else is there
            await until(lambda: vars(lab.settings.params)["points"] == 9)
            assert lab.changes.latest is None
            async with visitor(lab) as second:
                await follow(first, "?scene=rope&preset=Pendulum")
                assert "You switched everyone to <b>Rope</b> (Pendulum)." in shown(lab)
                assert "Someone else switched everyone to <b>Rope</b> (Pendulum)." in shown(lab)
                await follow(second, "?scene=rope&points=11")  # the last one wins
                assert vars(lab.settings.params)["points"] == 11
                clock[0] += 0.9 * SHOWN_TIME
                await asyncio.sleep(0.3)
                assert shown(lab)
                clock[0] += 0.2 * SHOWN_TIME
                await until(lambda: not shown(lab))
                assert vars(lab.settings.params)["points"] == 11

    coroutines.run(follow_links())


def test_a_change_can_be_undone_by_all_also_one_of_the_scene(lab: Viewer, monkeypatch: pytest.MonkeyPatch) -> None:
    # No line goes because its time is over.
    monkeypatch.setattr("app.panel.sharing.scene_switches.time", types.SimpleNamespace(monotonic=lambda: 100.0))

    async def undo_links() -> None:
        async with visitor(lab) as first, visitor(lab) as second:
            await first.send(field_of(lab), text_of("open", "?scene=rope&points=9&stiffness=500"))
            await until(lambda: vars(lab.settings.params)["points"] == 9 and shown(lab))
            before = lab.settings.params
            await follow(first, "?scene=cloth")
            assert lab.panel.kind.name == "cloth"
            # In the panel of the scene that it opened:
            assert "Someone else switched everyone to <b>Cloth</b>" in shown(lab)
            await undo(second)
            await until(lambda: lab.panel.kind.name == "rope" and not shown(lab))
            assert lab.settings.params == before
            await undo(first)  # again, and too late; sent by the browser of the next link, so that it comes before that
            await follow(first, "?scene=rope&points=13")
            await undo(second)
            await until(lambda: lab.settings.params == before and not shown(lab))
            await follow(first, "?scene=rope&points=14")
            await second.send(lab.panel.head.buttons, "Undo")  # of the last act, which is the link
            await until(lambda: lab.settings.params == before and not shown(lab))
            assert lab.changes.latest is None

    coroutines.run(undo_links())


def test_a_text_is_taken_once_by_a_panel_that_is_open(lab: Viewer) -> None:
    """A page sends its last text to the next panel too."""
    params = lambda: vars(lab.settings.params)  # noqa: E731

    async def send_again() -> None:
        async with visitor(lab) as browser:
            old, text = field_of(lab), text_of("open", "?scene=rope&points=9", number=1)
            lab.panel.close()
            await browser.send(old, text)
            await until(lambda: old.value)
            await asyncio.sleep(0.3)
            assert params()["points"] != 9
            lab.open("rope")
            await browser.send(field_of(lab), text)
            await until(lambda: params()["points"] == 9)
            lab.settings.set("points", 12)
            for number, stiffness in ((1, 300.0), (2, 400.0), (2, 500.0)):
                again = text_of("open", f"?scene=rope&stiffness={stiffness:g}", number=number)
                await browser.send(field_of(lab), again)
                await asyncio.sleep(0.1)
            await until(lambda: params()["stiffness"] == 400.0)
            assert lab.panel.share.channel.state_of("answers") == [("page", 1, "taken"), ("page", 2, "taken")]

    coroutines.run(send_again())
