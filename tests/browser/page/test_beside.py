"""Two labs side by side in a real browser: one clock, linked cameras, words on what differs, and one lab again."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from app.scenes.setups import read_query
from app.scenes.square_sea.parameters import SquareSeaParams
from app.scenes.square_sea.view import camera_of
from app.server.viewer import Viewer

# Position and target of the camera in a frame, and its field of view.
CAMERA = """() => { const { cameraControl: controls, camera } = window.__viserMutable, place = camera.position.clone();
    return [...controls.getPosition(place).toArray(), ...controls.getTarget(place).toArray(), camera.fov]; }"""
SHOWN_PANELS = "() => [...document.querySelectorAll('.springtide-lab')].filter(e => e.offsetParent !== null).length"


@pytest.fixture
def pair() -> Iterator[Viewer]:
    viewer = Viewer("127.0.0.1", 0)
    viewer.open("rope")
    yield viewer
    viewer.shut()


@pytest.mark.long
def test_a_pane_whose_lab_opens_late_is_loaded_again(pair: Viewer, open_tab: Any) -> None:
    tab = open_tab(pair.port, width=900, height=500)
    early: list[str] = []

    def answer(route: Any) -> None:
        """Refuse the first request, as the server does before the lab of the pane is open."""
        early.append(route.request.url)
        if len(early) > 1:
            route.fallback()
        else:
            route.fulfill(status=404, content_type="text/plain", body="No second pane is open.")

    tab.page.route("**/pane/2/index.html*", answer)
    pair.comparing.begin([read_query("?scene=rope&stiffness=2000")], False)
    tab.page.wait_for_url("**/beside")
    assert pair.comparison is not None
    second = pair.comparison.viewers[1]
    tab.wait(lambda: pair.visitors() and second.visitors())
    assert len(early) == 2


@pytest.mark.long
def test_two_ropes_on_one_clock_with_linked_cameras(pair: Viewer, open_tab: Any) -> None:
    tab = open_tab(pair.port, width=900, height=500)
    page = tab.page
    tab.wait(lambda: page.locator(".springtide-panel[data-state]").count())
    tab.errors.clear()
    pair.comparing.begin([read_query("?scene=rope&stiffness=2000")], False)
    page.wait_for_url("**/beside")
    assert pair.comparison is not None
    second = pair.comparison.viewers[1]
    tab.wait(lambda: pair.visitors() and second.visitors() and min(pair.scene.time, second.scene.time) > 0.3)
    headings = [heading.strip() for heading in page.locator("h2 span").all_inner_texts()]
    assert headings == ["Stiffness: 800 N/m", "Stiffness: 2\u202f000 N/m"]
    left, right = (page.frames[1], page.frames[2])

    # One camera drives the other, from either side.
    tab.wait(lambda: left.evaluate(CAMERA) == pytest.approx(right.evaluate(CAMERA), abs=1e-3))
    before = left.evaluate(CAMERA)
    box = page.locator("iframe").nth(1).bounding_box()
    start = box["x"] + 0.15 * box["width"], box["y"] + 0.75 * box["height"]
    tab.drag(start, (start[0] + 80, start[1] + 20))
    tab.release()
    tab.wait(lambda: left.evaluate(CAMERA) != pytest.approx(before, abs=0.05))
    tab.wait(lambda: left.evaluate(CAMERA) == pytest.approx(right.evaluate(CAMERA), abs=1e-3))
    tab.wait(lambda: page.locator("#scale span").inner_text() in ("50 cm", "1 m", "2 m", "5 m"))

    # The buttons and keys act on both, and once they stand still both show the same time.
    page.click("#play")
    tab.wait(lambda: not pair.loop.run.running and not second.loop.run.running)
    tab.wait(lambda: abs(pair.scene.time - second.scene.time) < max(pair.scene.step, second.scene.step))
    page.click("#reset")
    tab.wait(lambda: pair.scene.time == second.scene.time == 0.0)
    page.click("#step")
    tab.wait(lambda: pair.scene.time > 0.0 and second.scene.time > 0.0)
    page.keyboard.press("Space")
    tab.wait(lambda: pair.loop.run.running and second.loop.run.running)

    # A panel opens where it is asked for, and the picture stays as large.
    assert left.evaluate(SHOWN_PANELS) == 0
    page.locator("h2 button").first.click()
    tab.wait(lambda: left.evaluate(SHOWN_PANELS) == 1)
    assert right.evaluate(SHOWN_PANELS) == 0

    assert tab.errors == []
    page.click("#end")
    page.wait_for_url(lambda address: "beside" not in address)
    tab.wait(lambda: page.locator(".springtide-panel[data-state]").count())
    tab.wait(lambda: pair.comparison is None and second.ended)


@pytest.mark.long
def test_a_pane_that_lost_its_line_says_so_and_comes_back_by_itself(pair: Viewer, open_tab: Any) -> None:
    pair.comparing.begin([read_query("?scene=rope&stiffness=2000")], False)
    assert pair.comparison is not None
    second = pair.comparison.viewers[1]
    tab = open_tab(pair.port, width=900, height=500, address=f"http://127.0.0.1:{pair.port}/beside?")
    clock = tab.page.locator("#clock")
    tab.wait(lambda: pair.visitors() and second.visitors() and min(pair.scene.time, second.scene.time) > 0.3)
    tab.page.locator("#reset").click()  # the first pane has the focus
    pane = pair.panes.servers.pop(2)  # lets nobody in
    assert pane.loop is not None
    pane.loop.call_soon_threadsafe(lambda: [task.cancel() for task in pane.open])
    tab.wait(lambda: "Waiting for lab 2 to connect" in clock.inner_text(), 20)
    assert not second.visitors()
    time = second.scene.time
    tab.page.wait_for_timeout(1000)
    assert second.scene.time == time
    pair.panes.servers[2] = pane
    tab.wait(lambda: second.visitors() and second.scene.time > time, 30)
    tab.wait(lambda: "t = " in clock.inner_text(), 10)


@pytest.mark.long
def test_the_camera_over_a_sea_is_as_far_from_its_middle_in_both_panes(open_tab: Any) -> None:
    viewer = Viewer("127.0.0.1", 0)
    try:
        seas = [read_query(f"?scene=square_sea&size=64&mesh=32&length={length}") for length in (128, 512)]
        viewer.comparing.begin(seas, True)
        assert viewer.comparison is not None
        second = viewer.comparison.viewers[1]
        tab = open_tab(viewer.port, width=900, height=400)
        tab.page.wait_for_url("**/beside")

        def offsets() -> list[np.ndarray]:
            """Position and target of each camera from the middle of its sea [m]."""
            found = []
            for lab, length in ((viewer, 128.0), (second, 512.0)):
                for client in lab.server.get_clients().values():
                    middle = np.array([0.5 * length, 0.5 * length, 0.0])
                    found.append(np.array([client.camera.position, client.camera.look_at]) - middle)
            return found

        expected = np.array(camera_of(SquareSeaParams(length=128.0))) - (64.0, 64.0, 0.0)
        tab.wait(lambda: len(offsets()) == 2 and np.allclose(offsets(), [expected, expected], atol=0.05))
    finally:
        viewer.shut()
