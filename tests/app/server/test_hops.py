"""The way of a value from a browser to the kernel, by the calls that are made, and the names of page and lab."""

import re
import sys
from pathlib import Path
from types import FrameType
from typing import Any

import pytest

from app.messages import Change
from app.render.handles.viser_inside import uuid_of
from app.scenes.rope import scene as rope_scene
from app.scenes.springs import net_motion
from app.server.viewer import Viewer
from tests import coroutines
from tests.app.server.visitors import until, visitor

ROOT = Path(__file__).parents[3]
MAX_HOPS, MAX_FILES = 12, 12
MAX_NAMES = 15  # of data attributes


def contents(lab: Viewer) -> list[str]:
    """All texts of the panel in HTML."""
    messages = lab.server._websock_server.get_message_buffer().message_from_id.values()  # type: ignore[attr-defined]
    return [text for message in messages for text in re.findall(r"<.*>", str(vars(message)))]


def calls() -> list[tuple[str, str]]:
    """File and function of each call of the project on the way here, the first one first."""
    found: list[tuple[str, str]] = []
    frame: FrameType | None = sys._getframe(2)
    while frame is not None:
        path = Path(frame.f_code.co_filename)
        if path.is_relative_to(ROOT / "app") or path.is_relative_to(ROOT / "sim"):
            found.append((path.relative_to(ROOT).as_posix(), frame.f_code.co_name))
        frame = frame.f_back
    return found[::-1]


def from_handling(way: list[tuple[str, str]]) -> list[tuple[str, str]]:
    """The calls from the one that takes the value out of a queue."""
    return way[[name for _, name in way].index("handle") :]


def test_a_slider_reaches_the_kernel_in_few_calls_of_few_files(lab: Viewer, monkeypatch: pytest.MonkeyPatch) -> None:
    ways: dict[str, list[tuple[str, str]]] = {}
    post, build, advance = lab.settings.post, rope_scene.build, net_motion.advance

    def noted_post(command: Any) -> None:
        if isinstance(command, Change):
            ways["command"] = calls()
        post(command)

    def noted_build(*values: Any, **more: Any) -> Any:
        if "command" in ways:
            ways.setdefault("net", [*calls(), ("app/scenes/rope/scene.py", "build")])
        return build(*values, **more)

    def noted_advance(*values: Any, **more: Any) -> Any:
        if "net" in ways:
            ways.setdefault("kernel", [*calls(), ("sim/springs/state.py", "advance")])
        return advance(*values, **more)

    async def slide() -> None:
        async with visitor(lab) as browser:
            slider = lab.panel.controls["stiffness"].slider
            await browser.send(slider, [0.9 * value for value in slider.value])
            await until(lambda: "kernel" in ways)

    lab.settings.load(next(iter(lab.settings.kind.presets)))
    monkeypatch.setattr(lab.settings, "post", noted_post)
    monkeypatch.setattr(rope_scene, "build", noted_build)
    monkeypatch.setattr(net_motion, "advance", noted_advance)
    coroutines.run(slide())
    hops = [*from_handling(ways["command"]), *from_handling(ways["net"])]
    assert len(hops) <= MAX_HOPS, hops
    files = {file for way in ways.values() for file, _ in way}
    assert len(files) <= MAX_FILES, files
    assert {"app/server/web/guard.py", "app/panel/settings.py", "app/server/loop/run.py"} <= files


def test_pages_and_lab_share_few_names() -> None:
    files = [path for path in (ROOT / "app").rglob("*") if path.suffix in (".css", ".html", ".js", ".py")]
    names = {name for file in files for name in re.findall(r"data-springtide-[a-z-]+", file.read_text("utf-8"))}
    assert {"data-springtide-topic", "data-springtide-act"} <= names
    assert len(names) <= MAX_NAMES, sorted(names)


def test_a_page_knows_one_element_to_send_to(lab: Viewer) -> None:
    handles = lab.server.gui._gui_input_handle_from_uuid  # type: ignore[attr-defined]
    texts = contents(lab)
    known = {uuid for uuid in handles for text in texts if uuid in text}
    assert len(handles) > 50
    assert uuid_of(lab.panel.share.channel.field) in known
    assert {handles[uuid].label for uuid in known} == {lab.panel.share.channel.field.label}
