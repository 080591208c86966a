"""The lab as it is served: time to its first answer and first drawing, and processor time in each state of a scene."""

import importlib.util
import os
import shutil
import statistics
import subprocess
import sys
import time
import urllib.request
from typing import Any

from app.messages import Pause, Play, Reset
from app.scenes import NAMES

BROWSER_FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
STATES = ("nobody looking", "paused", "running", "running with plots")


def answer_time() -> float:
    """Seconds from the command until the page can be fetched."""
    start = time.perf_counter()
    server = subprocess.Popen(
        [sys.executable, "-m", "app", "--no-open", "--port", "0"], stdout=subprocess.PIPE, text=True
    )  # fmt: skip
    assert server.stdout is not None
    try:
        words = (word for line in server.stdout for word in line.split())
        address = next(word for word in words if word.startswith("http"))
        urllib.request.urlopen(address, timeout=30).read()
        return time.perf_counter() - start
    finally:
        server.terminate()
        server.wait()


def processor_share(seconds: float) -> float:
    """Per cent of one core that this process takes during `seconds` [s]."""
    before = os.times()
    time.sleep(seconds)
    after = os.times()
    return 100.0 * (after.user + after.system - before.user - before.system) / seconds


def scene_rows(name: str, browser: Any, seconds: float) -> list[dict[str, Any]]:
    """One scene in each state, with one browser of a small window."""
    from app.server.viewer import Viewer

    viewer = Viewer("127.0.0.1", 0)
    try:
        viewer.open(name)
        found = [{"what": f"{name}: {STATES[0]}", "per cent of a core": processor_share(seconds)}]
        if browser is None:
            return found
        start = time.perf_counter()
        page = browser.new_page(viewport={"width": 480, "height": 320})
        page.goto(f"http://127.0.0.1:{viewer.port}/?hideViserLogo&fixedDpr=1")
        while viewer.loop.counts["steps"] < 10:
            page.wait_for_timeout(20)
        found.append({"what": f"{name}: from the page's address to its running", "s": time.perf_counter() - start})
        page.wait_for_timeout(2000)
        viewer.loop.commands.put(Pause())
        page.wait_for_timeout(1000)
        found.append({"what": f"{name}: {STATES[1]}", "per cent of a core": processor_share(seconds)})
        # Each state begins with a reset, because a rope that hangs still takes less time.
        for state in STATES[2:]:
            if state == STATES[3]:
                viewer.panel.toggle_plots()
                page.wait_for_timeout(1000)
            viewer.loop.commands.put(Reset())
            viewer.loop.commands.put(Play())
            found.append({"what": f"{name}: {state}", "per cent of a core": processor_share(seconds)})
        page.close()
        return found
    finally:
        viewer.shut()


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Rows with a browser need playwright and Chromium, which renders in software.

    Quick: no browser, the rope only, one start.
    """
    answers = [answer_time() for _ in range(1 if quick else 7)]
    table: list[dict[str, Any]] = [{"what": "the command to the page's answer", "s": statistics.median(answers)}]
    if quick:
        return table + scene_rows("rope", None, 3.0)
    chromium = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if chromium is None or importlib.util.find_spec("playwright") is None:
        return table + [row for name in NAMES for row in scene_rows(name, None, 3.0)]
    from playwright.sync_api import sync_playwright  # type: ignore[import-not-found]

    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=chromium, args=BROWSER_FLAGS)
        for name in NAMES:
            table += scene_rows(name, browser, 10.0)
        browser.close()
    return table
