"""The rope scene in a real browser, driven by mouse and keyboard."""

import math
from concurrent.futures import Future

import numpy as np
import pytest

from app.messages import Advance, Pause, Play
from app.panel.controls import stability_map as live
from app.render.surroundings import SUN_INTENSITY
from app.scenes.rope.view import RopeView
from app.scenes.springs.rope_parameters import ROOT
from app.server.viewer import Viewer
from tests.browser.conftest import Tab

SCENE = "rope"
# The intensities of the drawn lights with a shadow, and the number of all those.
SUNS = """() => {
    const suns = window.__viserMutable.scene.children.filter((one) => one.isDirectionalLight && one.castShadow);
    return [suns.filter((one) => one.visible).map((one) => one.intensity), suns.length]; }"""


@pytest.mark.long
def test_the_rope_is_drawn_and_swings_without_console_errors(lab: Viewer, open_tab) -> None:
    tab = open_tab(lab.port, width=420, height=260, drawn=True)
    tab.wait(lambda: len(tab.vertices("/rope")) > 0)
    first = tab.vertices("/rope")
    tab.wait(lambda: np.abs(tab.vertices("/rope") - first).max() > 0.2)
    assert np.isfinite(tab.vertices("/rope")).all()
    assert tab.errors == []


@pytest.mark.long
def test_drag_me_stands_at_the_free_end_until_the_first_drag_of_a_browser(lab: Viewer, open_tab) -> None:
    hanging: Future[float] = Future()
    lab.loop.commands.put(Pause())
    lab.loop.commands.put(Advance(1.2, hanging))
    hanging.result(60.0)
    tab = open_tab(lab.port)
    hint = tab.page.locator("#springtide-drag-me")
    tab.wait(hint.is_visible)
    points = np.array([tab.pixel(point) for point in lab.loop.latest.frame.points])
    end, box = points[-1], hint.bounding_box()
    assert box["x"] + 0.5 * box["width"] == pytest.approx(end[0], abs=12.0)
    assert 0.0 < box["y"] - end[1] < 40.0
    tab.drag(tuple(end), tuple(end + 30.0))
    tab.wait(lambda: hint.count() == 0, 10)
    tab.release()
    tab.page.reload()
    tab.wait(lambda: len(tab.vertices("/rope")) > 0)
    tab.wait(tab.page.locator("#springtide-cover.springtide-hidden").count)
    tab.page.wait_for_timeout(500)
    assert hint.count() == 0
    assert tab.errors == []


def test_nothing_steps_until_somebody_looks(lab: Viewer, open_tab) -> None:
    assert lab.loop.run.counts["steps"] == 0
    tab = open_tab(lab.port)
    tab.wait(lambda: lab.loop.run.counts["steps"] > 10)
    tab.page.close()
    while lab.audience():
        lab.served.stop.wait(0.01)
    lab.served.stop.wait(0.5)  # what was under way ends
    steps = lab.loop.run.counts["steps"]
    lab.served.stop.wait(0.5)
    assert lab.loop.run.counts["steps"] == steps


def test_one_light_with_one_shadow_stands_for_the_sun(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    tab.wait(lambda: tab.page.evaluate(SUNS) == [[pytest.approx(SUN_INTENSITY)], 3])
    assert isinstance(lab.view, RopeView)
    lab.view.surroundings.sun.intensity = 0.9  # viser makes new lights
    tab.wait(lambda: tab.page.evaluate(SUNS) == [[pytest.approx(0.9)], 3])


@pytest.mark.long
def test_dragging_the_arrows_moves_the_root(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    arrow = np.array(ROOT) + (0.0, 0.0, 0.2)

    (x, y), (x1, y1) = tab.pixel(arrow), tab.pixel(arrow + (0.0, 0.0, 0.5))
    tab.hold(lambda: (x, y), (x1 - x, y1 - y), lambda: lab.scene.handles.root.position[2] > ROOT[2] + 0.2)
    tab.release()
    assert lab.scene.state.x[2, 0, 0] == pytest.approx(lab.scene.handles.root.position[2], abs=0.2)
    assert tab.errors == []


@pytest.mark.long
def test_dragging_a_bead_pulls_it_and_lets_go(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    lab.settings.set("speed", 4.0)
    tab.wait(lambda: lab.scene.time > 6)
    lab.settings.set("speed", 1.0)
    lab.loop.commands.put(Pause())
    tab.wait(lambda: not lab.loop.run.running)
    particle = 6
    bead = lab.scene.state.x[:, 0, particle].copy()
    tab.page.mouse.move(*tab.pixel(bead))
    lab.loop.commands.put(Play())
    place = lambda: tab.pixel(lab.scene.state.x[:, 0, particle])  # noqa: E731
    tab.hold(place, (70, -40), lambda: lab.scene.handles.grab.grabbed is not None)
    held = lab.scene.handles.grab.grabbed.particle
    assert abs(held - particle) <= 1
    tab.wait(lambda: np.linalg.norm(lab.scene.state.x[:, 0, held] - bead) > 0.15)
    assert lab.loop.latest.frame.grab is not None
    tab.release()
    tab.wait(lambda: lab.scene.handles.grab.grabbed is None)
    assert tab.errors == []


def test_a_number_typed_in_the_panel_reaches_the_simulation(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    field = tab.page.get_by_label("Stiffness [N/m]").first
    field.fill("1234")
    field.press("Enter")
    tab.wait(lambda: lab.scene.params.stiffness == 1234.0)
    assert lab.scene.net.families[0].stiffness == 1234.0


def test_keys_play_pause_and_load_presets(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    tab.page.keyboard.press("Space")
    tab.wait(lambda: not lab.loop.run.running)
    steps = lab.loop.run.counts["steps"]
    tab.page.keyboard.press("n")
    tab.wait(lambda: lab.loop.run.counts["steps"] == steps + 1)
    tab.page.keyboard.press("2")
    tab.wait(lambda: lab.scene.params.points == 50)


def test_an_explosion_pauses_with_a_finite_picture_and_says_why(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    tab.page.keyboard.press("3")
    tab.wait(lambda: lab.scene.params.integrator == "explicit_euler")
    lab.settings.set("speed", 4.0)  # until the last second before the bounds, which is in slow motion
    tab.wait(lambda: lab.loop.run.halted)
    assert "explicit Euler" in lab.loop.run.halted
    assert "hω" in lab.loop.run.halted
    tab.wait(lambda: tab.page.get_by_text("became unstable at").count() > 0)
    assert np.isfinite(tab.vertices("/rope")).all()
    assert not lab.loop.run.running


@pytest.mark.long
def test_reload_and_a_second_tab_show_the_same_rope(shown: tuple[Viewer, Tab], open_tab) -> None:
    lab, first = shown
    first.wait(lambda: lab.scene.time > 1)
    lab.loop.commands.put(Pause())
    first.wait(lambda: not lab.loop.run.running and lab.served.shown_serial == lab.loop.latest.serial)
    second = open_tab(lab.port)
    second.wait(lambda: len(second.vertices("/rope")) > 0)
    # A slow page may still have frames to draw from before the pause.
    second.wait(lambda: np.array_equal(second.vertices("/rope"), first.vertices("/rope")))
    first.page.reload()
    first.wait(lambda: np.array_equal(first.vertices("/rope"), second.vertices("/rope")))


def test_handles_are_assigned_to_and_never_added_again(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    lab.settings.set("speed", 4.0)
    before = set(lab.server.scene._handle_from_node_name)
    tab.wait(lambda: lab.scene.time > 2)
    assert set(lab.server.scene._handle_from_node_name) == before


@pytest.mark.long
def test_without_the_script_the_rope_is_drawn_in_its_plain_colour(open_tab) -> None:
    viewer = Viewer("127.0.0.1", 0, plain=True)
    try:
        viewer.open("rope")
        tab = open_tab(viewer.port)
        tab.wait(lambda: len(tab.vertices("/rope")) > 0)
        assert len(tab.vertices("/rope/vertex_colors")) == 0
        assert tab.errors == []
    finally:
        viewer.shut()


def test_a_click_on_the_map_sets_step_and_stiffness(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    lab.loop.commands.put(Pause())
    lab.panel.controls_tab.map.ask()
    tab.wait(lambda: len(lab.panel.controls_tab.map.rows) == live.ROWS)
    tab.page.get_by_text("Stability map", exact=True).first.click()
    picture = tab.page.locator("svg.springtide-map")
    picture.hover(timeout=60_000)  # scrolls, and waits until the folder has unfolded
    unit = tab.wait(picture.bounding_box)["width"] / live.PICTURE[0]  # none while a page replaces the picture
    x, y = live.LEFT + 0.25 * live.WIDE, live.TOP + 0.25 * live.HIGH
    params = lab.settings.params
    picture.click(position={"x": unit * x, "y": unit * y}, timeout=60_000)
    tab.wait(lambda: lab.settings.params.stiffness != params.stiffness)
    across, up = live.drawn_axes(lab.panel.controls_tab.map.axes)
    assert across.share(math.log10(lab.settings.params.time_step)) == pytest.approx(0.25, abs=0.02)
    assert up.share(math.log10(lab.settings.params.stiffness)) == pytest.approx(0.75, abs=0.02)
    assert not tab.errors
