"""The cloth scene in a real browser, driven by mouse and keyboard."""

import io

import numpy as np
import pytest
from PIL import Image

from app.messages import Pause, Play
from app.server.viewer import Viewer
from tests.browser.conftest import NO_NOTES, Tab
from tests.browser.water.test_water import PANEL_HIDDEN

SCENE = "cloth"
COUNT_FRAMES = """() => { const scene = window.__viserMutable.scene, earlier = scene.onBeforeRender; window.frames = 0;
    scene.onBeforeRender = function (...all) { window.frames++; return earlier.apply(this, all); }; }"""

# A browser that draws into no floats, as some graphics cards do.
NO_FLOATS = """const get = WebGL2RenderingContext.prototype.getExtension;
    WebGL2RenderingContext.prototype.getExtension = function (name) {
        return name === "EXT_color_buffer_float" ? null : get.call(this, name); };"""
MAX_DIFFERENCE = 12.0  # of 255, mean around the middle of the cloth; 8 was seen, and 49 with x and y exchanged


PRESETS = {"1": 32 * 32, "2": 48 * 32, "3": 64 * 64, "4": 48 * 48}  # key -> particles


@pytest.mark.parametrize("keys", ["12", pytest.param("1234", marks=pytest.mark.long)])
def test_every_preset_is_drawn_and_moves_without_console_errors(shown: tuple[Viewer, Tab], keys: str) -> None:
    lab, tab = shown
    for key in keys:
        particles = PRESETS[key]
        tab.page.keyboard.press(key)
        tab.wait(lambda particles=particles: len(tab.vertices("/cloth")) == particles)
        first = tab.vertices("/cloth")
        tab.wait(lambda first=first: np.abs(tab.vertices("/cloth") - first).max() > 0.02)
        assert np.isfinite(tab.vertices("/cloth")).all()
    assert not lab.loop.run.halted
    assert tab.errors == []


def test_a_browser_draws_nothing_while_paused_whatever_was_shown_before(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    tab.follow(lab, "rope")
    tab.wait(lambda: len(tab.vertices("/rope")) > 0)
    lab.loop.commands.put(Pause())
    tab.page.evaluate(COUNT_FRAMES)

    def still() -> bool:
        before = tab.page.evaluate("window.frames")
        tab.page.wait_for_timeout(1500)
        # viser draws once a second in any case.
        return tab.page.evaluate("window.frames") - before <= 2

    tab.wait(still, 30)


@pytest.mark.long
def test_a_particle_is_dragged_by_the_mouse(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    tab.wait(lambda: lab.loop.scene.time > 1)
    lab.loop.commands.put(Pause())
    tab.wait(lambda: not lab.loop.run.running)
    here = lab.scene.state.x[:, 16, 10].copy()
    tab.page.mouse.move(*tab.pixel(here))
    lab.loop.commands.put(Play())
    tab.hold(lambda: tab.pixel(lab.scene.state.x[:, 16, 10]), (-80, -30), lambda: lab.scene.grab.grabbed is not None)
    row, col = divmod(lab.scene.grab.grabbed.particle, 32)
    assert np.linalg.norm(lab.scene.state.x[:, row, col] - here) < 1.0
    tab.wait(lambda: lab.loop.latest.frame.grab is not None, 20)
    tab.release()
    tab.wait(lambda: lab.scene.grab.grabbed is None, 20)
    assert tab.errors == []


@pytest.mark.long
def test_a_pin_is_moved_by_its_arrow(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    pin = lab.scene.state.x[:, 0, 0].copy()
    arrow = pin + (0.0, 0.0, 0.15)
    # viser's note on drawing in software lies over the arrow.
    tab.page.evaluate("document.querySelectorAll('.mantine-Notification-root button').forEach(close => close.click())")

    (x, y), (x1, y1) = tab.pixel(arrow), tab.pixel(arrow + (0.0, 0.0, 0.4))
    tab.hold(lambda: (x, y), (x1 - x, y1 - y), lambda: lab.scene.pins.handles[0].position[2] > pin[2] + 0.1)
    tab.release()
    tab.wait(lambda: lab.scene.state.x[2, 0, 0] > pin[2] + 0.1)
    assert tab.errors == []


def test_the_sphere_moves_by_its_vertices_like_the_cloth(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    lab.settings.load("Trampoline")
    tab.wait(lambda: lab.loop.latest.frame.sphere is not None and lab.scene.time > 0.3)
    lab.loop.commands.put(Pause())
    tab.wait(lambda: not lab.loop.run.running and lab.served.shown_serial == lab.loop.latest.serial)
    *centre, radius = lab.loop.latest.frame.sphere

    def drawn() -> bool:
        sphere = tab.vertices("/sphere/ball")
        return len(sphere) > 0 and np.allclose(np.linalg.norm(sphere - centre, axis=1), radius, atol=1e-5)

    tab.wait(drawn, 30)
    assert np.array_equal(lab.view.sphere.ball.position, (0.0, 0.0, 0.0))


@pytest.mark.long
def test_a_polynomial_lights_the_cloth_as_the_photograph_of_the_sky_does(lab: Viewer, open_tab) -> None:
    def cloth(tab: Tab) -> np.ndarray:
        """The pixels (n, 3) around the middle of the cloth, 0 to 255, as soon as they do not change."""
        tab.page.add_style_tag(content=NO_NOTES + PANEL_HIDDEN)
        tab.wait(lambda: len(tab.vertices("/cloth")) > 0)
        shots: list[np.ndarray] = []

        def is_still() -> bool:
            tab.page.wait_for_timeout(700)
            shots.append(np.asarray(Image.open(io.BytesIO(tab.page.screenshot(timeout=120_000))).convert("RGB"), float))
            return len(shots) > 2 and bool((shots[-1] == shots[-2]).all() and (shots[-1] == shots[-3]).all())

        tab.wait(is_still)
        x, y = (round(at) for at in tab.pixel(lab.scene.state.x[:, 16, 16]))
        return shots[-1][y - 10 : y + 10, x - 10 : x + 10]

    tab = open_tab(lab.port, width=300, height=200, drawn=True, ratio=1.0)
    tab.wait(lambda: lab.loop.scene.time > 1)
    lab.loop.commands.put(Pause())
    tab.page.wait_for_timeout(500)
    by_polynomial = cloth(tab)
    assert tab.errors == []
    tab.page.add_init_script(NO_FLOATS)
    tab.page.reload()
    by_photograph = cloth(tab)
    assert by_polynomial.std() > 5.0
    difference = float(np.abs(by_polynomial - by_photograph).mean())
    assert 0.0 < difference < MAX_DIFFERENCE
