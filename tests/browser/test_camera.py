"""The camera in a real browser: it stays above floor and water, finds back, and its picture stands in the free area."""

import random

import numpy as np

from app.server.viewer import Viewer
from tests.browser.conftest import Tab

SCENE = "rope"
DRAGS = 50
# Keeps the lowest height [m] of the camera in any frame, and its lowest height above the mesh "/sea".
RECORD_HEIGHTS = """() => { const viewer = window.__viserMutable, scene = viewer.scene, earlier = scene.onBeforeRender;
    window.lowest = Infinity;
    scene.onBeforeRender = function (renderer, drawn, camera, target) {
        earlier.call(this, renderer, drawn, camera, target);
        if (camera === viewer.camera) window.lowest = Math.min(window.lowest, camera.matrixWorld.elements[13]);
    }; }"""


def view_of(viewer: Viewer) -> np.ndarray:
    """(2, 3) position and target [m] of the only browser's camera."""
    (client,) = viewer.server.get_clients().values()
    return np.array([client.camera.position, client.camera.look_at])


def drag_at_random(tab: Tab, moves: random.Random, count: int) -> None:
    """Turn, shift and zoom the picture."""
    mouse = tab.page.mouse
    for _ in range(count):
        button = moves.choice(["left", "left", "right"])
        x, y = moves.uniform(100, 500), moves.uniform(60, 500)
        mouse.move(x, y)
        mouse.down(button=button)
        mouse.move(x + moves.uniform(-250, 250), y + moves.uniform(-250, 250), steps=4)
        mouse.up(button=button)
        if moves.random() < 0.3:
            mouse.wheel(0, moves.choice([-300, 300]))


def test_reset_view_after_random_drags_gives_the_first_view(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    first = np.array(lab.view.first_view(lab.panel.params))
    tab.wait(lambda: np.abs(view_of(lab) - first).max() < 1e-3)
    tab.page.evaluate(RECORD_HEIGHTS)
    moves = random.Random(1)
    drag_at_random(tab, moves, DRAGS)
    tab.wait(lambda: np.abs(view_of(lab) - first).max() > 0.1)
    assert tab.page.evaluate("window.lowest") > 0.09
    tab.page.get_by_role("button", name="Reset view").click()
    tab.wait(lambda: np.abs(view_of(lab) - first).max() < 1e-3)
    for key in ("v", "r", "1"):  # reset view, reset, preset
        drag_at_random(tab, moves, 3)
        tab.wait(lambda: np.abs(view_of(lab) - first).max() > 0.1)
        tab.page.keyboard.press(key)
        tab.wait(lambda: np.abs(view_of(lab) - first).max() < 1e-3)
    assert not tab.errors
