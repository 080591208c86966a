"""The lab is made behind a page that is served already; page and terminal say what fails there."""

import asyncio
import subprocess
import sys
import threading
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from app.commands import serve
from app.commands.serve import Opening
from app.server.viewer import Viewer
from app.server.web.guard import open_server
from benchmarks.labs import connected

ROOT = Path(__file__).parents[3]
# A program whose numba cannot be imported.
BROKEN = """
import sys
sys.modules["numba"] = None
from app.__main__ import main
from app.commands import serve
serve.REASON_TIME = 0.1
sys.exit(main(["--no-open", "--port", "0"]))
"""


class Page:
    """The panel of a server, as lines."""

    def __init__(self) -> None:
        self.lines: list[str] = []

    def add_html(self, text: str) -> None:
        """Add a line."""
        self.lines.append(text)

    def reset(self) -> None:
        """Remove all."""
        self.lines.clear()


@pytest.fixture
def page() -> Page:
    return Page()


def opening_of(page: Page, make: Any, show: Any = lambda viewer: None) -> Opening:
    """A start behind this page."""
    server = SimpleNamespace(gui=page, stop=lambda: page.lines.append("stopped"))
    return Opening(SimpleNamespace(server=server), make, show)  # type: ignore[arg-type]


class Lab:
    """A lab that notes what it is told."""

    def __init__(self) -> None:
        self.told: list[str] = []

    def stop_opening(self) -> None:
        """See `Viewer`."""
        self.told.append("stop opening")

    def shut(self) -> None:
        """See `Viewer`."""
        self.told.append("shut")


def test_the_page_says_what_is_done_and_why_it_failed(page: Page, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(serve, "REASON_TIME", 0.0)

    def make() -> Any:
        raise ImportError("no <b>numba</b>")

    opening = opening_of(page, make)
    assert "springtide-progress" in page.lines[0]  # the words that cover the page
    opening.start()
    assert opening.done.wait(30.0)
    (line,) = page.lines
    assert "springtide-panel" in line  # which takes the cover away
    assert "could not be started" in line
    assert "ImportError: no &lt;b&gt;numba" in line
    with pytest.raises(ImportError, match="numba"):
        opening.check()
    opening.shut()
    assert page.lines[1:] == ["stopped"]


def test_a_lab_that_is_made_after_the_end_opens_nothing(page: Page) -> None:
    lab, go_on = Lab(), threading.Event()

    def make() -> Any:
        assert go_on.wait(30.0)
        return lab

    opening = opening_of(page, make, lambda viewer: lab.told.append("show"))
    opening.start()
    opening.stop()  # there is no lab to tell
    assert opening.done.is_set()
    go_on.set()
    opening.thread.join(30.0)
    assert lab.told[0] == "stop opening"
    opening.shut()
    assert lab.told[-1] == "shut"
    opening.check()  # no error


def test_without_numba_the_terminal_says_so() -> None:
    done = subprocess.run(
        [sys.executable, "-c", BROKEN], cwd=ROOT, capture_output=True, encoding="locale", timeout=120, check=False
    )
    assert done.returncode == 1
    assert "Springtide is on http://" in done.stdout
    assert "numba" in done.stderr.splitlines()[-1]


def test_a_browser_that_was_there_before_the_lab_is_counted(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    opened = open_server("127.0.0.1", 0)
    port, register = opened.server.get_port(), opened.server.on_client_connect

    def slowly(callback: Any) -> None:
        register(callback)
        time.sleep(0.2)  # it is called for the browser meanwhile

    monkeypatch.setattr(opened.server, "on_client_connect", slowly)

    async def come_first() -> None:
        async with asyncio.timeout(60.0), connected(port):
            while not opened.server.get_clients():
                await asyncio.sleep(0.01)
            viewer = await asyncio.to_thread(Viewer, "", 0, opened=opened)
            try:
                assert viewer.port == port
                assert await asyncio.to_thread(viewer.came.wait, 10.0)
                assert len(viewer.visitors()) == 1
            finally:
                await asyncio.to_thread(viewer.shut)

    asyncio.run(come_first())
    assert "Traceback" not in capfd.readouterr().err
