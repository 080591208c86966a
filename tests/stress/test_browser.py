"""A real Chromium, killed as a task manager kills."""

import contextlib
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from app.messages import Pause
from app.server.viewer import Viewer
from tests.browser.conftest import CHROMIUM, FLAGS, Tab
from tests.stress.clients import until
from tests.stress.tally import Tally


@pytest.fixture
def process(tmp_path: Path) -> Iterator[tuple[subprocess.Popen, Any]]:
    """A Chromium of our own and a handle on it by its debugging port."""
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    if CHROMIUM is None:
        pytest.skip("no Chromium on the search path")
    chromium = subprocess.Popen(
        [CHROMIUM, "--headless", *FLAGS, "--remote-debugging-port=0", f"--user-data-dir={tmp_path}", "about:blank"],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    try:
        port = tmp_path / "DevToolsActivePort"
        until(lambda: port.exists() and port.read_text("utf-8").count("\n"), "Chromium starts")
        with playwright.sync_playwright() as driver:
            browser = driver.chromium.connect_over_cdp(f"http://127.0.0.1:{port.read_text('utf-8').split()[0]}")
            yield chromium, browser
    finally:
        chromium.kill()
        chromium.wait()


def test_a_chromium_killed_while_it_drags(lab: Viewer, process: tuple[subprocess.Popen, Any], tally: Tally) -> None:
    chromium, browser = process
    tab = Tab(browser, lab.port)
    tab.wait(lambda: lab.audience() == 1 and lab.loop.scene.time > 6)
    lab.commands.put(Pause())  # a slow page must hit what it sees
    tab.page.wait_for_timeout(1500)
    with tally.fault("Chromium killed in mid-drag"):
        place = lambda: tab.pixel(lab.scene.state.x[:, 0, 6])  # noqa: E731
        tab.hold(place, (60, -30), lambda: lab.scene.handles.grab.grabbed is not None)
        chromium.kill()
        until(lambda: lab.audience() == 0, "it is gone")
        until(lambda: lab.scene.handles.grab.grabbed is None, "what it held is let go")
        assert all(thread.is_alive() for thread in lab.served.threads)
        with contextlib.suppress(Exception):
            browser.close()
