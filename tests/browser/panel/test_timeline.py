"""The time line along the foot of the scene, in a real browser."""

import io
from collections.abc import Callable

import numpy as np
import pytest
from PIL import Image

from app.messages import Pause, Play
from app.server.viewer import Viewer
from tests.browser.conftest import Tab

SCENE = "rope"
# The time [s] at which each chart has a line, if its whole time axis is visible.
MOMENT_PLACES = """() => Object.values(window.__viserTestpoints?.uplots ?? {}).flatMap(({ chart }) => {
    const line = chart.over.querySelector(".springtide-moment"), times = chart.data[0];
    const whole = chart.scales.x.min === times[0] && chart.scales.x.max === times[times.length - 1];
    return line && whole ? [chart.posToVal(parseFloat(line.style.left), "x")] : []; })"""
BOXES = """() => ["#springtide-time", "#springtide-time input", "canvas[data-engine]"].map((name) => {
    const { left, right, top, bottom } = document.querySelector(name).getBoundingClientRect();
    return { left, right, top, bottom }; })"""
PANEL_EDGE = """() => { const box = document.querySelector(
    "[data-floating-window], .mantine-Paper-root:has(> * > .mantine-ScrollArea-root)").getBoundingClientRect();
    return [box.left, box.top]; }"""
# Fill the canvas with red.
FILL = """() => { const gl = document.querySelector("canvas[data-engine]").getContext("webgl2");
    gl.bindFramebuffer(gl.FRAMEBUFFER, null); gl.clearColor(1, 0, 0, 1); gl.clear(gl.COLOR_BUFFER_BIT); }"""
# True if a press at the middle of the line reaches it.
IS_ON_TOP = """() => {
    const line = document.querySelector("#springtide-time input"), box = line.getBoundingClientRect();
    return document.elementFromPoint((box.left + box.right) / 2, (box.top + box.bottom) / 2) === line; }"""
THUMB = 14  # [pixels] about, of a range: its middle goes from half of that to as much before the end


def place_of(tab: Tab, moment: float) -> tuple[float, float]:
    """The place of a time [s] on the bar [pixels]."""
    low, high = (float(tab.page.locator("#springtide-time input").get_attribute(end) or 0) for end in ("min", "max"))
    box = tab.page.locator("#springtide-time input").bounding_box()
    assert box is not None
    part = (moment - low) / (high - low)
    return box["x"] + THUMB / 2 + part * (box["width"] - THUMB), box["y"] + box["height"] / 2


def test_one_drag_and_one_click_lead_20_s_back_and_on_from_there(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    recorder, number = lab.panel.recorder, lab.loop.run.identity.number
    lab.settings.set("speed", 10.0)
    lab.loop.commands.put(Play())
    tab.wait(lambda: recorder.span()[1] > 24.0, 60)
    lab.settings.set("speed", 1.0)
    high = recorder.span()[1]
    tab.wait(lambda: float(tab.page.locator("#springtide-time input").get_attribute("max") or 0) >= round(high, 3), 30)
    bar, line, scene = tab.page.evaluate(BOXES)
    # As wide as the scene, up to the panel.
    assert (bar["left"], bar["right"]) == pytest.approx((scene["left"], tab.page.evaluate(PANEL_EDGE)[0]), abs=1)
    assert line["right"] - line["left"] > 0.8 * (bar["right"] - bar["left"])
    assert bar["bottom"] == pytest.approx(scene["bottom"], abs=1)
    back = high - 20.0
    x, y = place_of(tab, back)
    tab.drag((line["right"] - THUMB / 2, y), (x, y), 10)
    tab.release()
    tab.wait(lambda: recorder.shown_frame is not None and abs(recorder.shown_frame.time - back) < 1.5, 20)
    tab.wait(lambda: not lab.loop.run.running, 10)
    assert tab.page.locator("#springtide-time output").is_visible()
    tab.page.get_by_role("button", name="Continue from here").click()
    tab.wait(lambda: lab.loop.run.running and recorder.shown_frame is None, 20)
    assert lab.loop.run.identity.number == number + 1
    assert lab.loop.scene.time < high - 10.0
    tab.wait(lambda: recorder.span()[1] < high - 10.0, 10)
    tab.wait(lambda: not tab.page.locator("#springtide-time output").is_visible(), 10)


def test_the_keys_of_the_focused_line_do_what_its_hint_says(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    recorder, line, keys = lab.panel.recorder, tab.page.locator("#springtide-time input"), tab.page.keyboard
    lab.loop.commands.put(Play())
    tab.wait(lambda: recorder.span()[1] - recorder.span()[0] > 8.0 and line.is_enabled(), 60)
    hint = line.get_attribute("title") or ""
    assert hint.endswith("Drag or press an arrow key to look back; Space plays the recording")
    line.focus()
    keys.press("ArrowLeft")
    tab.wait(lambda: recorder.position == len(recorder.frames) - 2 and not lab.loop.run.running, 20)
    keys.press("Home")
    tab.wait(lambda: recorder.position == 0, 20)
    for is_playing in (True, False):
        keys.press("Space")
        tab.wait(lambda is_playing=is_playing: recorder.playing is is_playing, 20)
        tab.page.wait_for_timeout(500)  # what else the key does would be done
        assert not lab.loop.run.running
    assert 0 < recorder.position < len(recorder.frames) - 1
    line.blur()
    keys.press("Space")  # elsewhere the key is the lab's
    tab.wait(lambda: lab.loop.run.running, 20)
    recorder.show_present()


def test_the_bar_is_inside_the_window_at_every_size_in_any_order(shown: tuple[Viewer, Tab]) -> None:
    """A window of 640 x 400 is one of 1280 x 800 at 200 %: there the panel covers more than half of it."""
    lab, tab = shown
    size = tab.page.viewport_size
    lab.settings.set("plot_tip", True)
    tab.wait(lambda: tab.page.locator(".uplot").count() > 0, 30)
    try:
        for width, height in ((1280, 800), (640, 400), (1024, 700), (1280, 800), (600, 300), (900, 420), (500, 300)):
            tab.page.set_viewport_size({"width": width, "height": height})

            def is_inside(width: int = width, height: int = height) -> bool:
                bar, line, scene = tab.page.evaluate(BOXES)
                across = 0 <= bar["left"] < line["left"] + 60 < line["right"] < bar["right"] <= width
                is_within = across and 0 <= bar["top"] < bar["bottom"] <= min(height, scene["bottom"]) + 1
                return is_within and tab.page.evaluate(IS_ON_TOP)

            tab.wait(is_inside, 20)
    finally:
        lab.settings.set("plot_tip", False)
        tab.page.set_viewport_size(size)


@pytest.mark.long
def test_under_a_bar_of_the_whole_width_the_picture_is_new_up_to_the_top(open_tab: Callable[..., Tab]) -> None:
    """Chromium kept an old picture at the top, as high as an opaque bar at the foot."""
    lab = Viewer("127.0.0.1", 0)
    try:
        lab.open(SCENE)
        tab = open_tab(lab.port, width=900, height=1000, drawn="no shader has this")
        tab.wait(lambda: tab.page.locator("#springtide-time").is_visible(), 60)
        tab.wait(lambda: tab.page.locator("#springtide-cover.springtide-hidden").count(), 60)
        lab.loop.commands.put(Pause())
        tab.wait(lambda: not lab.loop.run.running, 20)
        # A high panel ends the bar at its side.
        tab.page.add_style_tag(content="[data-floating-window] { display: none; }")
        tab.wait(lambda: tab.page.evaluate(BOXES)[0]["right"] == pytest.approx(900, abs=1), 10)
        bar, _, scene = tab.page.evaluate(BOXES)
        assert (bar["left"], bar["right"]) == pytest.approx((scene["left"], scene["right"]), abs=1)

        def is_red() -> bool:
            tab.page.evaluate(FILL)
            tab.page.wait_for_timeout(200)
            picture = np.asarray(Image.open(io.BytesIO(tab.page.screenshot())).convert("RGB")).astype(int)
            return np.abs(picture[: 3 * int(bar["bottom"] - bar["top"]), 100] - (255, 0, 0)).max() <= 2

        tab.wait(is_red, 10)
    finally:
        lab.shut()


@pytest.mark.long
def test_every_visitor_sees_the_moment_and_keys_lead_through_it(
    shown: tuple[Viewer, Tab], open_tab: Callable[..., Tab]
) -> None:
    """The other visitor has a phone, on which the bar stands above the panel."""
    lab, tab = shown
    other = open_tab(lab.port, width=390, height=844)
    recorder = lab.panel.recorder
    line = other.page.locator("#springtide-time input")
    other.wait(line.is_visible, 60)
    other.wait(lambda: len(recorder.frames) > 10, 30)
    line.focus()
    for key in ("ArrowLeft", "ArrowLeft", "ArrowRight"):
        other.page.keyboard.press(key)
        other.page.wait_for_timeout(100)
    other.wait(lambda: recorder.position == len(recorder.frames) - 2 and not lab.loop.run.running, 20)
    moment = recorder.shown_frame
    assert moment is not None
    words = f"t = {moment.time:.2f} s"
    for one in (tab, other):
        one.wait(lambda one=one: one.page.locator("#springtide-time").inner_text().endswith(words), 20)
    bar, _, _ = other.page.evaluate(BOXES)
    assert 0 <= bar["left"] < 5
    assert 385 < bar["right"] <= 390
    assert bar["bottom"] == pytest.approx(other.page.evaluate(PANEL_EDGE)[1], abs=1)
    buttons = other.page.locator("#springtide-time button")
    for number in range(buttons.count()):
        buttons.nth(number).click(trial=True, timeout=5000)
    other.page.keyboard.press("Home")
    other.wait(lambda: recorder.position == 0, 20)
    for playing in (True, False):
        other.page.keyboard.press("Space")
        other.wait(lambda playing=playing: recorder.playing is playing, 20)
    other.page.get_by_role("button", name="Live", exact=True).click()
    tab.wait(lambda: recorder.shown_frame is None and lab.loop.run.running, 20)
    tab.wait(lambda: tab.page.locator("#springtide-time").inner_text().endswith("Live"), 20)


def test_the_plots_show_the_moment(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    lab.settings.set("plot_tip", True)
    lab.loop.commands.put(Play())
    tab.wait(lambda: lab.loop.scene.time > lab.panel.recorder.span()[0] + 2.0, 60)
    lab.panel.recorder.show_time(lab.panel.recorder.span()[0] + 1.0)
    lab.loop.commands.put(Pause())
    shown_frame = tab.wait(lambda: lab.panel.recorder.shown_frame, 20)
    assert tab.wait(lambda: tab.page.evaluate(MOMENT_PLACES), 30)[0] == pytest.approx(shown_frame.time, abs=0.05)
    lab.panel.recorder.show_present()
    tab.wait(lambda: not tab.page.evaluate(MOMENT_PLACES), 20)
    lab.settings.set("plot_tip", False)
