"""A press near a rope or a cloth takes it and not the camera."""

from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

import numpy as np
import pytest

from app.messages import Advance, Pause
from app.server.viewer import Viewer
from tests.browser.conftest import Tab

SCENE = "rope"
SLOWNESS = 0.1  # of lab and page, so that a press of the driver comes as promptly as that of a hand
SLOW_FRAMES = f"""const frame = window.requestAnimationFrame.bind(window);
window.requestAnimationFrame = (call) => frame((now) => call({SLOWNESS} * now));"""
CAMERA = "() => window.__viserMutable.camera.position.toArray()"
PLACES = """name => { const viewer = window.__viserMutable, node = viewer?.nodeRefFromName?.[name];
    const mesh = node?.children.find((child) => child.isMesh), box = viewer?.canvas?.getBoundingClientRect();
    const numbers = mesh?.geometry.attributes.position.array ?? [], places = [];
    for (let k = 0; k < numbers.length; k += 3) {
        const place = mesh.localToWorld(viewer.camera.position.clone().fromArray(numbers, k)).project(viewer.camera);
        places.push([box.left + box.width * (1 + place.x) / 2, box.top + box.height * (1 - place.y) / 2]);
    }
    return places; }"""
HANGING = 1.2  # [s] after the start: nothing swings out of the window
MISSED = 30.0  # [pixels] from what is drawn now: beyond the reach of a mouse


def drawn(tab: Tab, node: str) -> np.ndarray:
    """The vertices (n, 2) of a mesh on the page [pixels]."""
    return np.array(tab.page.evaluate(PLACES, node))


def press(tab: Tab, place: tuple[float, float]) -> None:
    """Press and pull."""
    mouse = tab.page.mouse
    mouse.move(*place)
    mouse.down()
    for step in range(1, 9):
        mouse.move(place[0] + 5.0 * step, place[1])
        tab.page.wait_for_timeout(30)


def touch(tab: Tab, place: tuple[float, float]) -> Callable[[], Any]:
    """The same with a finger; returns what lifts it."""
    screen = tab.page.context.new_cdp_session(tab.page)
    for step in range(9):
        kind, finger = "touchMove" if step else "touchStart", {"x": place[0] + 5.0 * step, "y": place[1]}
        screen.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": [finger]})
        tab.page.wait_for_timeout(30)
    return lambda: screen.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})


@pytest.mark.long
def test_a_press_where_the_tip_was_a_moment_before_takes_it(lab: Viewer, open_tab: Callable[..., Tab]) -> None:
    lab.settings.set("show_points", False)
    lab.settings.set("speed", SLOWNESS)
    tab = open_tab(lab.port)
    tab.page.add_init_script(SLOW_FRAMES)
    tab.page.reload()
    tab.wait(lambda: len(drawn(tab, "/rope")) > 0 and lab.scene.time > 0.25)
    x, y = drawn(tab, "/rope")[-1]
    tab.wait(lambda: np.linalg.norm(drawn(tab, "/rope") - (x, y), axis=1).min() > MISSED, 20)
    before = tab.page.evaluate(CAMERA)
    press(tab, (x, y))
    tab.wait(lambda: lab.scene.handles.grab.grabbed is not None, 10)
    assert tab.page.evaluate(CAMERA) == before
    assert lab.scene.handles.grab.grabbed.particle >= lab.scene.params.points - 2
    tab.release()
    assert tab.errors == []


@pytest.mark.long
@pytest.mark.parametrize(
    "scene", ["rope", *(pytest.param(name, marks=pytest.mark.stress) for name in ("race", "cloth"))]
)
def test_the_reach_is_marked_and_ends(shown: tuple[Viewer, Tab], scene: str) -> None:
    lab, tab = shown
    tab.follow(lab, scene)
    if scene != "cloth":
        lab.settings.set("show_points", False)
    lab.loop.commands.put(Pause())
    lab.settings.reset()
    hanging: Future[float] = Future()
    lab.loop.commands.put(Advance(HANGING, hanging))
    node = "/race/rope_1" if scene == "race" else f"/{scene}"
    tab.wait(lambda: hanging.done() and lab.served.shown_serial == lab.loop.latest.serial and len(drawn(tab, node)) > 0)
    tab.page.wait_for_timeout(500)
    ring = tab.page.locator("#springtide-ring")

    def held() -> bool:
        return lab.loop.latest.frame.grab is not None

    def lowest() -> tuple[float, float] | None:
        """The lowest point on the page; None while the camera moves."""
        points = drawn(tab, node)
        tab.page.wait_for_timeout(300)
        x, y = points[np.argmax(points[:, 1])]
        return (x, y) if np.array_equal(drawn(tab, node), points) else None

    for gap, taken in ((40.0, False), (18.0, True)):
        below = tab.wait(lowest)
        before = tab.page.evaluate(CAMERA)
        place = below[0], below[1] + gap
        tab.page.mouse.move(*place)
        tab.wait(lambda taken=taken: ring.is_visible() is taken, 10)
        if taken:
            box: Any = ring.bounding_box()
            assert (box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"]) == pytest.approx(below, abs=4.0)
        press(tab, place)
        tab.wait(lambda before=before: held() or tab.page.evaluate(CAMERA) != before, 10)
        assert held() is taken
        assert (tab.page.evaluate(CAMERA) == before) is taken
        tab.release()
        tab.wait(lambda: not held(), 10)
    before = tab.page.evaluate(CAMERA)
    lift = touch(tab, (below[0], below[1] + 40.0))
    tab.wait(held, 10)
    assert tab.page.evaluate(CAMERA) == before
    lift()
    assert tab.errors == []
