"""A lab that was ended comes back with its set-up."""

import dataclasses
import os
import signal
import subprocess
import sys
import time
import urllib.request
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from app.__main__ import main
from app.commands.serve import SetupSaver
from app.scenes import scene_named
from app.scenes.last_setup import keep_last, last_path, read_last

ROOT = Path(__file__).parents[3]
ROPE = scene_named("rope")
STIFF = dataclasses.replace(ROPE.params(), stiffness=1234.0)


@pytest.fixture
def data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("SPRINGTIDE_DATA", str(tmp_path))
    return tmp_path


def lab_with(params: Any) -> Any:
    """A lab that shows a rope."""
    settings = SimpleNamespace(kind=ROPE, params=params, loaded="")
    return SimpleNamespace(viewer=SimpleNamespace(current=SimpleNamespace(settings=settings)))


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> Callable[..., tuple[Any, ...]]:
    """The scene and parameters with which a command line would begin."""
    served: list[tuple[Any, ...]] = []
    serve = lambda name, params, **_: served.append((name, params and params())) or 0  # noqa: E731
    monkeypatch.setattr("app.commands.serve.serve_lab", serve)

    def opened_by(*words: str) -> tuple[Any, ...]:
        assert main([*words, "--no-open"]) == 0
        return served[-1]

    return opened_by


def test_the_next_start_has_the_setup_that_was_left(data: Path, opened: Callable[..., tuple[Any, ...]]) -> None:
    assert opened("--resume") == opened()  # nothing was left
    lab = lab_with(STIFF)
    saver = SetupSaver(lab)
    saver.store()
    assert opened("--resume", "--scene", "cloth") == ("rope", STIFF)
    assert opened() != ("rope", STIFF)
    written = last_path().stat().st_mtime_ns
    saver.store()
    assert last_path().stat().st_mtime_ns == written  # nothing has changed
    lab.viewer.current.settings.params = ROPE.params()
    saver.store()
    assert opened("--resume") == ("rope", ROPE.params())


@pytest.mark.parametrize("text", ["", "?scene=nothing", "?scene=rope&stiffness=much", "\0", "?" + "a" * 10**6])
def test_what_cannot_be_read_is_as_if_nothing_was_left(data: Path, text: str) -> None:
    keep_last(text)
    assert read_last() is None


def test_where_nothing_can_be_written_the_lab_goes_on(data: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (data / "file").write_text("", "utf-8")
    monkeypatch.setenv("SPRINGTIDE_DATA", str(data / "file" / "below"))
    SetupSaver(lab_with(STIFF)).store()
    for viewer in (None, SimpleNamespace(current=None)):  # before there is a lab, and before a scene is open
        SetupSaver(SimpleNamespace(viewer=viewer)).store()  # type: ignore[arg-type]
    assert read_last() is None


@pytest.mark.skipif(os.name != "posix", reason="Windows ends a process without telling it")
def test_a_lab_that_is_told_to_end_keeps_its_setup(data: Path) -> None:
    command = [sys.executable, "-m", "app", "--no-open", "--port", "0", "--resume", "--set", "stiffness=1234"]
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, encoding="locale")
    assert process.stdout is not None
    try:
        address = next(word for line in process.stdout for word in line.split() if word.startswith("http"))
        assert urllib.request.urlopen(address, timeout=30).status == 200
        while not last_path().exists():
            assert process.poll() is None
            time.sleep(0.05)
        process.send_signal(signal.SIGTERM)
        assert process.wait(60) == 0
    finally:
        process.kill()
        process.wait()
        process.stdout.close()
    last = read_last()
    assert last is not None
    assert (last.scene, last.params) == ("rope", STIFF)
