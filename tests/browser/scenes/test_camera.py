"""The camera in a real browser: it stays above floor and water, returns, and its picture fills the free area."""

import random
from collections.abc import Callable

import numpy as np
import pytest

from app.lab.course.task import load_tasks
from app.lab.student.workbook import Workbook
from app.scenes import scene_named
from app.server.viewer import Viewer
from sim.parameters import check_record
from tests.browser.conftest import Tab

SCENE = "rope"
# A small sea, so that the page is fast enough for many drags.
SMALL = {"square_sea": {"size": "64", "mesh": "32"}, "radial_sea": {"rings": 32, "spokes": 32}}
# Keeps the lowest height [m] of the camera in any frame: above the water, if there is a sea.
RECORD_HEIGHTS = """() => { const viewer = window.__viserMutable, scene = viewer.scene, earlier = scene.onBeforeRender;
    window.lowest = Infinity;
    scene.onBeforeRender = function (renderer, drawn, camera, target) {
        earlier.call(this, renderer, drawn, camera, target);
        if (camera !== viewer.camera) return;
        const height = camera.matrixWorld.elements[13];
        window.lowest = Math.min(window.lowest, height - waterBelow(viewer, camera, height));
    };
    function waterBelow(viewer, camera, height) {
        const sea = viewer.nodeRefFromName["/sea"], mesh = sea && sea.children.find((child) => child.isMesh);
        if (!mesh || height > 60) return 0;
        const place = mesh.worldToLocal(camera.position.clone().setFromMatrixPosition(camera.matrixWorld));
        const numbers = mesh.geometry.attributes.position.array, last = numbers.length - 3;
        const side = numbers[last] - numbers[0];
        const tiled = side > 0 && Math.abs(numbers[last + 1] - numbers[1] - side) < 1e-3 * side;
        // The distance to the nearest copy of a vertex, along one axis.
        const apart = (a, b) => tiled ? Math.abs(a - b - side * Math.round((a - b) / side)) : Math.abs(a - b);
        let nearest = Infinity, below = 0;
        for (let k = 0; k <= last; k += 3) {
            const distance = Math.hypot(apart(numbers[k], place.x), apart(numbers[k + 1], place.y));
            if (distance < nearest) [nearest, below] = [distance, numbers[k + 2]];
        }
        return below;
    } }"""

# Frames run only as often as the test lets them.
HOLD_FRAMES = """() => { window.held = []; window.realFrame = window.requestAnimationFrame;
    window.requestAnimationFrame = (callback) => window.held.push(callback); }"""
ONE_FRAME = """() => new Promise((done) => window.realFrame.call(window, (now) => {
    for (const callback of window.held.splice(0)) callback(now);
    done(); }))"""
ALL_FRAMES = """() => { window.requestAnimationFrame = window.realFrame;
    for (const callback of window.held.splice(0)) window.requestAnimationFrame(callback); }"""
PAGE_CAMERA = """() => { const { x, y, z } = window.__viserMutable.camera.position; return [-z, -x, y]; }"""


def view_of(viewer: Viewer) -> np.ndarray:
    """(2, 3) position and target [m] of the only browser's camera."""
    (client,) = viewer.server.get_clients().values()
    return np.array([client.camera.position, client.camera.look_at])


def stands_still(viewer: Viewer, tab: Tab) -> bool:
    """True if page and server have the same camera, unchanged for half a second."""
    seen = []
    for _ in range(2):
        seen += [view_of(viewer)[0], np.array(tab.page.evaluate(PAGE_CAMERA))]
        tab.page.wait_for_timeout(500)
    return bool(np.abs(np.array(seen) - seen[0]).max() < 1e-3)


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


@pytest.mark.long
@pytest.mark.parametrize("drags", [4, pytest.param(50, marks=pytest.mark.stress)])
def test_reset_view_after_random_drags_gives_the_first_view(shown: tuple[Viewer, Tab], drags: int) -> None:
    lab, tab = shown
    first = np.array(lab.view.first_view(lab.settings.params))
    tab.wait(lambda: np.abs(view_of(lab) - first).max() < 1e-3)
    tab.page.evaluate(RECORD_HEIGHTS)
    moves = random.Random(1)
    drag_at_random(tab, moves, drags)
    tab.wait(lambda: np.abs(view_of(lab) - first).max() > 0.1)
    assert tab.page.evaluate("window.lowest") > 0.09
    tab.page.get_by_role("button", name="Camera", exact=True).click()
    tab.wait(lambda: np.abs(view_of(lab) - first).max() < 1e-3)
    for key in ("v", "1"):  # the view's key, a preset
        drag_at_random(tab, moves, 3)
        tab.wait(lambda: np.abs(view_of(lab) - first).max() > 0.1)
        tab.page.keyboard.press(key)
        tab.wait(lambda: np.abs(view_of(lab) - first).max() < 1e-3)
    drag_at_random(tab, moves, 3)
    tab.wait(lambda: np.abs(view_of(lab) - first).max() > 0.1)
    tab.wait(lambda: stands_still(lab, tab))  # the last drag has arrived
    placed, act = view_of(lab), lab.loop.latest.status.run.number
    tab.page.keyboard.press("r")  # a reset leaves the camera
    tab.wait(lambda: lab.loop.latest.status.run.number > act)
    tab.page.wait_for_timeout(500)
    assert np.abs(view_of(lab) - placed).max() < 1e-3
    assert not tab.errors


@pytest.mark.long
@pytest.mark.parametrize("scene", ["square_sea", "radial_sea"])
def test_the_camera_stays_above_the_waves_of_a_storm(shown: tuple[Viewer, Tab], scene: str) -> None:
    lab, tab = shown
    tab.follow(lab, scene, check_record(scene_named(scene).params, {"wind_speed": 17.0, **SMALL[scene]}))
    tab.wait(lambda: lab.loop.scene.time > 1.0 and len(tab.vertices("/sea")) > 0)
    first = view_of(lab)
    tab.page.wait_for_timeout(500)
    tab.page.evaluate(RECORD_HEIGHTS)
    drag_at_random(tab, random.Random(2), 12)
    tab.wait(lambda: np.abs(view_of(lab) - first).max() > 1.0)
    assert tab.page.evaluate("window.lowest") > 0.0
    assert not tab.errors


@pytest.mark.long
def test_a_link_with_a_camera_under_water_says_until_the_next_move_that_the_view_begins_above_it(
    open_tab: Callable[..., Tab],
) -> None:
    lab = Viewer("127.0.0.1", 0)
    try:
        lab.open("square_sea", check_record(scene_named("square_sea").params, SMALL["square_sea"]))
        tab = open_tab(lab.port, query="&scene=square_sea&size=64&mesh=32&camera=8,3,-3,0,0,-1")
        notice = tab.page.get_by_text("below the floor or the water")
        tab.wait(notice.count)
        assert view_of(lab)[0, 2] > 0.0
        tab.page.wait_for_timeout(1500)  # waves pass under the camera
        assert notice.count() == 1
        drag_at_random(tab, random.Random(3), 2)
        tab.wait(lambda: notice.count() == 0)
        assert not tab.errors
    finally:
        lab.shut()


@pytest.mark.long
def test_set_this_up_on_a_slow_page_shows_what_the_task_is_about(shown: tuple[Viewer, Tab]) -> None:
    """The page reports the camera of the former scene long after the server has placed that of the task."""
    lab, tab = shown
    tab.follow(lab, "race")
    tab.wait(lambda: tab.page.evaluate(PAGE_CAMERA)[1] < -50.0)  # the ropes are seen from far away
    workbook = Workbook(load_tasks(with_checks=False))
    task = next(task for task in workbook.tasks if task.item == "1.1-2")
    tab.page.evaluate(HOLD_FRAMES)
    try:
        lab.settings.set_up(workbook.set_up_of(task))
        tab.wait(lambda: lab.is_open and lab.panel.kind.name == "radial_sea" and lab.loop.scene.time > 2.0)
        tab.page.evaluate(ONE_FRAME)  # takes the messages; the field of view has the page report its camera
        tab.page.wait_for_timeout(1000)
    finally:
        tab.page.evaluate(ALL_FRAMES)

    def distance() -> float:
        """Distance [m] of the page's camera from its place beside a drifting body."""
        return float(
            np.linalg.norm(tab.page.evaluate(PAGE_CAMERA) - np.array(lab.view.first_view(lab.settings.params)[0]))
        )

    tab.wait(lambda: distance() < 1.0, 30)
    tab.page.wait_for_timeout(1000)
    assert distance() < 2.0  # and it stays with the body
