"""The style of the panel: what the page marks for it, and how much of it a new number asks the browser for."""

import json
from typing import Any

import pytest

from app.server.viewer import Viewer
from tests.browser.conftest import Tab

RUNNING = '.springtide-panel[data-state="running"]'
TRACED = ["devtools.timeline", "disabled-by-default-devtools.timeline"]
MAX_RESTYLED = 100  # elements, of about 450
MARKED = """() => [...document.querySelectorAll("[data-springtide-is]")]
    .flatMap((one) => one.dataset.springtideIs.trim().split(" "))"""


def restyled(chromium: Any, page: Any, seconds: float) -> list[int]:
    """The number of elements whose style the browser computes, each time that it does."""
    chromium.start_tracing(page=page, categories=TRACED)
    page.wait_for_timeout(1000 * seconds)
    events = json.loads(chromium.stop_tracing())["traceEvents"]
    return [one["args"]["elementCount"] for one in events if "elementCount" in one.get("args", {})]


@pytest.mark.long
def test_a_number_of_the_panel_restyles_little_else(chromium: Any) -> None:
    viewer = Viewer("127.0.0.1", 0)
    viewer.open("rope")
    tab = Tab(chromium, viewer.port)
    try:
        tab.wait(tab.page.locator(RUNNING).count)
        tab.wait(tab.page.locator("#springtide-cover.springtide-hidden").count)
        tab.wait(lambda: viewer.loop.scene.time > 2.0)  # the panel is complete
        counts = restyled(chromium, tab.page, 3.0)
        assert len(counts) > 3
        assert sum(count > MAX_RESTYLED for count in counts) <= 1  # what has another cause is done once
    finally:
        tab.page.close()
        viewer.shut()


def test_marks_follow_what_panels_hold(chromium: Any) -> None:
    viewer = Viewer("127.0.0.1", 0)
    viewer.open("rope")
    tab = Tab(chromium, viewer.port)
    try:
        of_panel = {"alone", "scrolled", "lab", "name", "choice", "row", "sliders", "field", "slider"}
        of_charts = {"docked", "charted", "charted-left", "before", "before-left", "charts", "single"}
        marked = lambda: set(tab.page.evaluate(MARKED))  # noqa: E731
        for _ in range(2):
            tab.wait(lambda: of_panel <= marked() and not of_charts & marked())
            tab.page.keyboard.press("p")
            tab.wait(lambda: of_panel | of_charts <= marked())
            tab.page.keyboard.press("p")
    finally:
        tab.page.close()
        viewer.shut()
