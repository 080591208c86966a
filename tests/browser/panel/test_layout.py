"""The layout of the page at several sizes, by measuring boxes; all presets under `-m stress`."""

import io
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from PIL import Image

from app.scenes import NAMES, scene_named
from app.scenes.setups import make_setup
from app.scenes.springs.methods import METHODS_AND_AUTO
from app.server.viewer import Viewer
from tests.browser.boxes import MEASURE, SIZES, faults, faults_after_change
from tests.browser.conftest import NO_NOTES, Tab, new_page

SCENE = "rope"
# Right edges [pixels] of the fields of numbers and of the list of methods, the width of the panel, and the width that
# its list of presets leaves for the chevron.
LARGE_BOXES = """() => {
    const shown = (one) => one.checkVisibility() && one.offsetWidth > 20;
    const right = (one) => one.getBoundingClientRect().right;
    const list = [...document.querySelectorAll(".mantine-Select-input")].filter(shown);
    const fields = [...document.querySelectorAll("input.mantine-TextInput-input[aria-label]")].filter(shown);
    return { panel: document.querySelector("[data-floating-window]").offsetWidth, list: list[2] ? right(list[2]) : 0,
        fields: fields.map((one) => [one.ariaLabel, right(one)]),
        gap: list[1] ? Number.parseFloat(getComputedStyle(list[1]).paddingRight) : 0 }; }"""
# The words of lists that are shown cut off.
CUT_OFF = """() => [...document.querySelectorAll(".mantine-Select-input")]
    .filter((one) => one.offsetWidth > 20 && one.scrollWidth > one.clientWidth + 1).map((one) => one.value)"""
# The buttons of the lab that a mouse can press where they are: a click of Playwright would scroll first.
ICONS_ON_TOP = """() => [...document.querySelectorAll("[data-springtide-icon]")].filter((one) => {
    const box = one.getBoundingClientRect();
    return one.contains(document.elementFromPoint((box.left + box.right) / 2, (box.top + box.bottom) / 2));
}).map((one) => one.textContent)"""
ON_TOP = "([x, y]) => document.elementFromPoint(x, y)?.tagName ?? ''"


@pytest.fixture
def resized(shown: tuple[Viewer, Tab]) -> Iterator[tuple[Viewer, Tab]]:
    """A page that gets its size back."""
    size = shown[1].page.viewport_size
    yield shown
    shown[1].page.set_viewport_size(size)


@pytest.mark.parametrize(
    "size", [SIZES[1], *(pytest.param(size, marks=pytest.mark.long) for size in (SIZES[0], *SIZES[2:]))]
)
def test_nothing_covers_a_text_a_control_or_the_picture(resized: tuple[Viewer, Tab], size: tuple[int, int]) -> None:
    lab, tab = resized
    target = np.array(lab.view.first_view(lab.settings.params)[1])
    for plots in (False, True):
        assert not faults_after_change(tab, lab, size, plots=plots)
        tab.wait(lambda: tab.page.evaluate(ON_TOP, tab.pixel(target)) == "CANVAS", 30)


@pytest.mark.long
@pytest.mark.parametrize(
    ("style", "fault"),
    [
        (".springtide-panel[data-state] { height: 0; }", "text over text: Running"),  # what follows moves up into it
        ("[data-floating-window] { left: 700px !important; }", "out of reach: Undo"),
        ("[data-floating-window] { left: 0 !important; width: 880px !important; }", "the picture shows in"),
    ],
)
def test_the_measure_finds_what_is_wrong(shown: tuple[Viewer, Tab], style: str, fault: str) -> None:
    _, tab = shown
    tab.wait(lambda: not faults(tab.page), 20)
    planted = tab.page.add_style_tag(content=style)
    try:
        tab.wait(lambda: any(words.startswith(fault) for words in faults(tab.page)), 20)
    finally:
        planted.evaluate("style => style.remove()")


@pytest.mark.long
def test_viser_s_note_on_software_drawing_does_not_cover_the_picture(
    shown: tuple[Viewer, Tab], open_tab: Callable[..., Tab]
) -> None:
    lab, _ = shown
    tab = open_tab(lab.port)  # a new page: an older one has closed its note
    note = tab.page.locator("#webgl-software-rendering")
    tab.wait(note.count, 30)  # this Chromium draws in software
    assert not note.is_visible()
    tab.wait(lambda: tab.page.evaluate(ON_TOP, (100, 100)) == "CANVAS", 30)  # the cover goes


@pytest.mark.long
def test_a_phone_shows_the_race_first_and_its_plots_when_asked(
    one_page: tuple[Viewer, Tab], open_tab: Callable[..., Tab]
) -> None:
    lab, _ = one_page
    tab = open_tab(lab.port, width=390, height=844)
    tab.page.add_style_tag(content=NO_NOTES)
    tab.follow(lab, "race", make_setup(scene_named("race")).params)  # other tests leave theirs without plots
    tab.wait(lambda: lab.panel.plots.open)
    bar = tab.page.get_by_role("button", name="Expand panel Plots")
    tab.wait(bar.is_visible, 20)
    assert bar.bounding_box()["y"] < 5
    tab.wait(lambda: tab.page.evaluate(MEASURE)["picture"] > 0.45, 20)
    bar.click()
    tab.wait(lambda: tab.page.evaluate(MEASURE)["picture"] < 0.3 and not faults(tab.page), 20)


@pytest.mark.long
@pytest.mark.parametrize("size", [(390, 844), (560, 340)])
def test_a_small_window_shows_all_of_the_picture(
    one_page: tuple[Viewer, Tab], open_tab: Callable[..., Tab], size: tuple[int, int]
) -> None:
    """Chromium leaves out what it takes for covered: an opaque block that sticks above its list hid a band."""
    lab, _ = one_page
    lab.open("rope")
    tab = open_tab(lab.port, width=size[0], height=size[1], drawn="no shader has this")  # all is drawn in one colour
    tab.wait_for_panel(lab)
    foot = tab.page.locator("#springtide-time")
    foot.wait_for()

    def left_column() -> np.ndarray:
        picture = Image.open(io.BytesIO(tab.page.screenshot(timeout=120_000))).convert("RGB")
        bottom = int(foot.bounding_box()["y"])
        return np.asarray(picture).astype(int)[bottom // 2 : bottom - 10, 10]  # below the horizon is the ground

    tab.wait(lambda: np.abs(left_column() - (76, 128, 153)).max() < 4, 30)


def scroll_to_end(tab: Tab) -> None:
    """Scroll the panel to its end."""
    tab.page.evaluate(
        """() => { const panel = document.querySelector(".mantine-ScrollArea-viewport:has(.springtide-panel)");
            panel.scrollTop = panel.scrollHeight; }"""
    )


@pytest.mark.parametrize("size", [(780, 437), pytest.param((390, 844), marks=pytest.mark.long)])
def test_the_buttons_of_the_lab_stay_while_a_small_panel_is_scrolled(
    resized: tuple[Viewer, Tab], size: tuple[int, int]
) -> None:
    _, tab = resized
    tab.page.set_viewport_size({"width": size[0], "height": size[1]})
    tab.page.wait_for_timeout(500)
    preset = tab.page.get_by_label("Preset")
    top = preset.bounding_box()["y"]
    scroll_to_end(tab)
    tab.wait(lambda: preset.bounding_box()["y"] < top - 30, 10)  # it is scrolled
    assert {"Step", "Reset", "Undo"} <= set(tab.page.evaluate(ICONS_ON_TOP))


@pytest.mark.long
def test_large_text_fits_the_panel(resized: tuple[Viewer, Tab]) -> None:
    """No field or button lies beyond the lists above and below it, and no list cuts its words off."""
    lab, tab = resized
    tab.page.set_viewport_size({"width": 900, "height": 600})
    tab.page.evaluate("localStorage.setItem('springtide-large', 'yes')")
    try:
        tab.page.reload()
        tab.wait(lambda: tab.page.get_by_label("Preset").is_visible(), 60)
        tab.wait(lambda: tab.page.evaluate(LARGE_BOXES)["panel"] == 400, 20)
        found = tab.page.evaluate(LARGE_BOXES)
        assert len(found["fields"]) > 4
        assert [name for name, right in found["fields"] if abs(right - found["list"]) > 1] == [], found
        assert found["gap"] >= 18, found  # [pixels] of a chevron
        listed = "words => [...document.querySelectorAll('.mantine-Select-input')].some((one) => one.value === words)"
        for method, title in METHODS_AND_AUTO.items():
            lab.settings.set("integrator", method)
            tab.wait(lambda title=title: tab.page.evaluate(listed, title), 20)
            assert tab.page.evaluate(CUT_OFF) == []
    finally:
        tab.page.evaluate("localStorage.clear()")
        tab.page.reload()
        tab.wait(lambda: tab.page.locator(".springtide-panel[data-state]").count(), 60)


@pytest.mark.long
def test_the_line_on_slow_drawing_lies_beside_the_panel_and_above_the_time_line(chromium: Any) -> None:
    """In a window of 700 x 450 its buttons would lie behind the panel."""
    lab = Viewer("127.0.0.1", 0, plain=False)
    lab.open("rope")
    page = new_page(chromium, 700, 450, drawn=False)
    try:
        page.goto(f"http://127.0.0.1:{lab.port}/?hideViserLogo")  # without "fixedDpr", which keeps the quality
        line = page.locator("#springtide-slow")
        line.wait_for(timeout=60_000)  # this Chromium draws in software
        page.locator("#springtide-time").wait_for(timeout=60_000)
        page.wait_for_timeout(1000)
        for button in line.get_by_role("button").all():
            button.click(trial=True, timeout=5000)
        box, panel = line.bounding_box(), page.locator("[data-floating-window]").bounding_box()
        bar = page.locator("#springtide-time").bounding_box()
        assert box["x"] + box["width"] <= panel["x"]
        assert box["y"] + box["height"] <= bar["y"]
        assert box["height"] < 60
        # The picture is centred above it, so that it covers no label.
        middle = "(({ fullHeight, offsetY }) => fullHeight / 2 - offsetY)(window.__viserMutable.camera.view)"
        assert page.evaluate(middle) == pytest.approx(0.5 * box["y"], abs=2.0)
    finally:
        page.close()
        lab.shut()


@pytest.mark.stress
@pytest.mark.timeout(900)
@pytest.mark.parametrize(
    ("scene", "preset"), [(name, preset) for name in NAMES for preset in scene_named(name).presets]
)
def test_nothing_is_covered_with_any_preset(resized: tuple[Viewer, Tab], scene: str, preset: str) -> None:
    lab, tab = resized
    tab.follow(lab, scene)
    lab.settings.load(preset)
    found = {
        f"{width} x {height}, plots {'open' if plots else 'closed'}": faults
        for width, height in SIZES
        for plots in (False, True)
        if (faults := faults_after_change(tab, lab, (width, height), plots=plots))
    }
    assert not found
