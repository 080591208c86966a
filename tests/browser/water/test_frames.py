"""Frames are drawn only if something in them has changed."""

import threading
from typing import Any

import numpy as np
import pytest

from app.messages import Pause, Play
from app.server.viewer import Viewer
from tests.browser.conftest import Tab

WATCHED = 3000  # [ms], in which viser by itself draws three times
SETTLED = 400  # [ms] without a frame, after a change that has been drawn: frames continue for 250 ms
# Count the frames of the scene that are drawn for the page, and those for images that the server asks for.
COUNT = """() => { const viewer = window.__viserMutable, scene = viewer.scene, earlier = scene.onBeforeRender;
    window.drawnFrames = [0, 0];
    if (scene.isCounted) return;
    scene.isCounted = true;
    scene.onBeforeRender = function (renderer, of, camera, target) {
        if (of === scene) window.drawnFrames[camera === viewer.camera ? 0 : 1] += 1;
        return earlier.call(this, renderer, of, camera, target); }; }"""

# Turn the camera before each frame that the browser offers; the number of these that are drawn.
TURN = """count => new Promise((done) => { const viewer = window.__viserMutable, before = window.drawnFrames[0];
    const turn = () => {
        if (count-- === 0) return void done(window.drawnFrames[0] - before);
        viewer.cameraControl.rotate(0.001, 0.0, false);
        viewer.requestRender();
        requestAnimationFrame(turn); };
    requestAnimationFrame(turn); })"""


@pytest.fixture(params=["rope", *(pytest.param(name, marks=pytest.mark.long) for name in ("square_sea", "mooring"))])
def paused(request: pytest.FixtureRequest, one_page: tuple[Viewer, Tab]) -> tuple[Viewer, Tab]:
    """A scene that runs no longer, and of which the page has drawn the last frame."""
    lab, tab = one_page
    tab.errors.clear()
    tab.follow(lab, request.param)
    tab.wait(lambda: lab.loop.run.counts["steps"] > 10)
    lab.loop.commands.put(Pause())
    tab.page.evaluate(COUNT)
    tab.wait(lambda: drawn_while(tab, 1500) == 0)
    return lab, tab


def drawn_while(tab: Tab, time: int) -> int:
    """Number of frames that the page draws in this time [ms]."""
    before = tab.page.evaluate("drawnFrames[0]")
    tab.page.wait_for_timeout(time)
    return tab.page.evaluate("drawnFrames[0]") - before


def test_a_paused_page_draws_nothing_and_draws_what_changes(paused: tuple[Viewer, Tab]) -> None:
    lab, tab = paused
    assert drawn_while(tab, WATCHED) == 0
    tab.page.evaluate("window.__viserMutable.requestRender()")
    assert drawn_while(tab, 1000) == 0

    def is_drawn_after(change: Any) -> bool:
        before = tab.page.evaluate("drawnFrames[0]")
        change()
        tab.wait(lambda: tab.page.evaluate("drawnFrames[0]") > before, 20)
        tab.wait(lambda: drawn_while(tab, SETTLED) == 0, 20)
        return True

    # The camera, a node of the server's in place, colour and text, the size of the page, and what a script may change.
    assert is_drawn_after(lambda: tab.page.evaluate("window.__viserMutable.cameraControl.rotate(0.1, 0.0, false)"))
    ball = lab.server.scene.add_icosphere("/test_ball", 0.1, color=(255, 0, 0))
    assert is_drawn_after(lambda: setattr(ball, "position", (0.0, 0.0, 1.0)))
    assert is_drawn_after(lambda: setattr(ball, "color", (0, 255, 0)))
    assert is_drawn_after(lambda: setattr(ball, "opacity", 0.5))
    label = lab.server.scene.add_label("/test_label", "one", position=(0.0, 0.0, 2.0))
    assert is_drawn_after(lambda: setattr(label, "text", "another"))
    assert is_drawn_after(lambda: setattr(label, "position", (0.0, 1.0, 2.0)))
    assert is_drawn_after(lambda: setattr(label, "visible", False))
    size = tab.page.viewport_size
    assert is_drawn_after(lambda: tab.page.set_viewport_size({"width": size["width"] + 40, "height": size["height"]}))
    assert is_drawn_after(lambda: tab.page.set_viewport_size(size))
    assert is_drawn_after(lambda: (ball.remove(), label.remove()))
    assert is_drawn_after(lambda: tab.page.evaluate("document.documentElement.classList.toggle('springtide-dark')"))
    assert is_drawn_after(lambda: tab.page.evaluate("document.documentElement.classList.toggle('springtide-dark')"))
    assert tab.errors == []


def test_a_picture_that_is_drawn_in_time_follows_in_each_frame_of_the_browser(paused: tuple[Viewer, Tab]) -> None:
    """A page that looked for the end of a picture too late left out every other frame."""
    tab = paused[1]
    tab.wait(lambda: tab.page.evaluate(TURN, 60) > 45, 30)  # a busy machine leaves out some


def test_a_running_page_draws_and_an_image_is_drawn_while_paused(paused: tuple[Viewer, Tab]) -> None:
    lab, tab = paused
    (client,) = lab.server.get_clients().values()
    images: list[np.ndarray] = []
    before = tab.page.evaluate("drawnFrames[1]")

    def ask() -> None:
        images.append(client.get_render(height=40, width=60))

    asking = threading.Thread(target=ask)
    asking.start()
    tab.wait(lambda: not asking.is_alive(), 30)
    assert images[0].shape[:2] == (40, 60)
    assert tab.page.evaluate("drawnFrames[1]") == before + 1
    lab.loop.commands.put(Play())
    tab.wait(lambda: drawn_while(tab, 500) > 2, 20)
    lab.loop.commands.put(Pause())
