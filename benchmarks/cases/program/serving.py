"""The lab as it is served: time to its first drawing, and processor time in each state of a scene."""

import importlib.util
import shutil
import time
from typing import Any

from app.messages import Pause, Play, Reset
from app.scenes import NAMES
from benchmarks.labs import viewer_here

BROWSER_FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
STATES = ("nobody looking", "paused", "running", "running with plots")


def processor_share(seconds: float) -> float:
    """Per cent of one core that this process takes during `seconds` [s]."""
    before = time.process_time()
    time.sleep(seconds)
    return 100.0 * (time.process_time() - before) / seconds


def scene_rows(name: str, browser: Any, seconds: float) -> list[dict[str, Any]]:
    """One scene in each state, with one browser of a small window."""
    with viewer_here() as viewer:
        viewer.open(name)
        found = [{"what": f"{name}: {STATES[0]}", "per cent of a core": processor_share(seconds)}]
        if browser is None:
            return found
        start = time.perf_counter()
        page = browser.new_page(viewport={"width": 480, "height": 320})
        page.goto(f"http://127.0.0.1:{viewer.port}/?hideViserLogo&fixedDpr=1")
        while viewer.loop.run.counts["steps"] < 10:
            page.wait_for_timeout(20)
        found.append({"what": f"{name}: from the page's address to its running", "s": time.perf_counter() - start})
        page.wait_for_timeout(2000)
        viewer.loop.commands.put(Pause())
        page.wait_for_timeout(1000)
        found.append({"what": f"{name}: {STATES[1]}", "per cent of a core": processor_share(seconds)})
        # Each state begins with a reset, because a rope that hangs still takes less time.
        for state in STATES[2:]:
            if state == STATES[3]:
                viewer.settings.toggle_plots()
                page.wait_for_timeout(1000)
            viewer.loop.commands.put(Reset())
            viewer.loop.commands.put(Play())
            found.append({"what": f"{name}: {state}", "per cent of a core": processor_share(seconds)})
        page.close()
        return found


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Rows with a browser need playwright and Chromium, which renders in software.

    Quick: no browser, the rope only.
    """
    if quick:
        return scene_rows("rope", None, 3.0)
    chromium = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if chromium is None or importlib.util.find_spec("playwright") is None:
        return [row for name in NAMES for row in scene_rows(name, None, 3.0)]
    from playwright.sync_api import sync_playwright  # type: ignore[import-not-found]

    table: list[dict[str, Any]] = []
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=chromium, args=BROWSER_FLAGS)
        for name in NAMES:
            table += scene_rows(name, browser, 10.0)
        browser.close()
    return table
