"""The layout of the page at several sizes, by measuring boxes; all presets under `-m stress`."""

from collections.abc import Callable, Iterator

import numpy as np
import pytest

from app.scenes import NAMES, scene_named
from app.server.viewer import Viewer
from tests.browser.boxes import MEASURE, SIZES, faults, faults_after_change
from tests.browser.conftest import NO_NOTES, Tab

SCENE = "rope"
ON_TOP = "([x, y]) => document.elementFromPoint(x, y)?.tagName ?? ''"


@pytest.fixture
def resized(shown: tuple[Viewer, Tab]) -> Iterator[tuple[Viewer, Tab]]:
    """A page that gets its size back."""
    size = shown[1].page.viewport_size
    yield shown
    shown[1].page.set_viewport_size(size)


@pytest.mark.parametrize("size", SIZES)
def test_nothing_covers_a_text_a_control_or_the_picture(resized: tuple[Viewer, Tab], size: tuple[int, int]) -> None:
    lab, tab = resized
    target = np.array(lab.view.first_view(lab.panel.params)[1])
    for plots in (False, True):
        assert not faults_after_change(tab, lab, size, plots=plots)
        tab.wait(lambda: tab.page.evaluate(ON_TOP, tab.pixel(target)) == "CANVAS", 30)


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


def test_viser_s_note_on_software_drawing_does_not_cover_the_picture(
    shown: tuple[Viewer, Tab], open_tab: Callable[..., Tab]
) -> None:
    lab, _ = shown
    tab = open_tab(lab.port)  # a new page: an older one has closed its note
    note = tab.page.locator("#webgl-software-rendering")
    tab.wait(note.count, 30)  # this Chromium draws in software
    assert not note.is_visible()
    tab.wait(lambda: tab.page.evaluate(ON_TOP, (100, 100)) == "CANVAS", 30)  # the cover goes


def test_a_phone_shows_the_race_first_and_its_plots_when_asked(
    one_page: tuple[Viewer, Tab], open_tab: Callable[..., Tab]
) -> None:
    lab, _ = one_page
    tab = open_tab(lab.port, width=390, height=844)
    tab.page.add_style_tag(content=NO_NOTES)
    tab.follow(lab, "race")
    lab.panel.load(next(iter(lab.panel.kind.presets)))  # another test may have left its plots closed
    tab.wait(lambda: lab.panel.plots.open)
    bar = tab.page.get_by_role("button", name="Expand panel Plots")
    tab.wait(bar.is_visible, 20)
    assert bar.bounding_box()["y"] < 5
    tab.wait(lambda: tab.page.evaluate(MEASURE)["picture"] > 0.45, 20)
    bar.click()
    tab.wait(lambda: tab.page.evaluate(MEASURE)["picture"] < 0.3 and not faults(tab.page), 20)


@pytest.mark.stress
@pytest.mark.timeout(900)
@pytest.mark.parametrize(
    ("scene", "preset"), [(name, preset) for name in NAMES for preset in scene_named(name).presets]
)
def test_nothing_is_covered_with_any_preset(resized: tuple[Viewer, Tab], scene: str, preset: str) -> None:
    lab, tab = resized
    tab.follow(lab, scene)
    lab.panel.load(preset)
    found = {
        f"{width} x {height}, plots {'open' if plots else 'closed'}": faults
        for width, height in SIZES
        for plots in (False, True)
        if (faults := faults_after_change(tab, lab, (width, height), plots=plots))
    }
    assert not found
