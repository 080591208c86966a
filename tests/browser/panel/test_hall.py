"""Charts and pictures for a lecture hall, in a real browser."""

import itertools
from collections.abc import Iterator
from typing import Any

import pytest

from app.server.viewer import Viewer
from tests.browser.conftest import Tab

SCENE = "rope"
SIZE = {"width": 1280, "height": 800}
# Of each chart that is seen: width and height of its curves and size of its numbers and of its thinnest line [pixels].
CHARTS = """() => Object.values(window.__viserTestpoints?.uplots ?? {}).map(({ chart }) => chart)
    .filter(({ over }) => over.offsetHeight > 0).map(({ over, axes, series }) => ({ width: over.offsetWidth,
        height: over.offsetHeight, ticks: axes.map(({ font }) => parseFloat(font[0])),
        line: Math.min(...series.slice(1).map(({ width }) => width)) }))"""
BOX = "(name) => document.querySelector(name)?.getBoundingClientRect().toJSON() ?? null"
# Choose large text or not, as another tab of the browser does.
LARGE = """choice => { localStorage.setItem("springtide-large", choice);
    window.dispatchEvent(new StorageEvent("storage", { key: "springtide-large" })); }"""


@pytest.fixture
def hall(shown: tuple[Viewer, Tab]) -> Iterator[tuple[Viewer, Tab]]:
    """A page as large as a projector's picture, with two charts; it gets its size back."""
    lab, tab = shown
    size = tab.page.viewport_size
    tab.page.set_viewport_size(SIZE)
    for name in ("plot_energy", "plot_tip"):
        lab.settings.set(name, True)
    tab.wait(lambda: len(charts(tab)) == 2, 30)
    yield lab, tab
    tab.page.evaluate(LARGE, "no")
    tab.page.keyboard.press("Escape")
    tab.page.keyboard.press("Escape")
    for name in ("plot_energy", "plot_tip"):
        lab.settings.set(name, False)
    tab.page.set_viewport_size(size)


# Makes a chart low, and gives the places of its ticks with words [pixels].
LOW = """async () => { const { chart } = Object.values(window.__viserTestpoints.uplots)[0], [, axis] = chart.axes;
    chart.setSize({ width: chart.width, height: 80 });
    await new Promise(queueMicrotask); // uPlot draws then, and the page gives the chart its height again later
    return axis._splits.filter((_, k) => axis._values[k]).map((value) => chart.valToPos(value, axis.scale)); }"""


def charts(tab: Tab) -> list[dict[str, Any]]:
    return tab.page.evaluate(CHARTS)


def edges(tab: Tab, name: str) -> tuple[float, float, float]:
    """Left, right and lower edge of an element [pixels]."""
    box = tab.page.evaluate(BOX, name)
    return box["left"], box["right"], box["bottom"]


def enlarge(tab: Tab) -> None:
    """Press the button at the corner of the first chart that is seen."""
    container = tab.page.locator(".uplot-container:visible").first
    container.hover()
    container.get_by_role("button").click()


def test_the_words_of_ticks_do_not_overlap_in_a_low_chart(hall: tuple[Viewer, Tab]) -> None:
    _, tab = hall
    tab.page.keyboard.press("l")
    tab.wait(lambda: charts(tab)[0]["ticks"] == [22, 22], 20)
    places = tab.page.evaluate(LOW)
    assert len(places) >= 1
    assert all(abs(one - other) >= 22 for one, other in itertools.pairwise(places))


def test_an_enlarged_chart_fills_the_window_and_its_type_follows(hall: tuple[Viewer, Tab]) -> None:
    _, tab = hall
    before = charts(tab)
    assert [chart["ticks"] for chart in before] == [[12, 12]] * 2
    enlarge(tab)
    tab.wait(lambda: len(charts(tab)) == 1 and charts(tab)[0]["height"] >= 500 and charts(tab)[0]["width"] > 1100, 20)
    (large,) = charts(tab)
    assert large["ticks"] == [22, 22]
    assert large["line"] >= 1.8 * before[0]["line"]
    foot = (0, SIZE["width"], SIZE["height"])
    tab.wait(lambda: edges(tab, "#springtide-time") == pytest.approx(foot, abs=1), 20)
    tab.page.evaluate(LARGE, "yes")
    tab.wait(lambda: charts(tab)[0]["ticks"] == [29, 29] and charts(tab)[0]["height"] >= 500, 20)
    enlarge(tab)  # the same button leads back
    tab.wait(lambda: [chart["ticks"] for chart in charts(tab)] == [[16, 16]] * 2, 20)
    tab.page.evaluate(LARGE, "no")
    type_of = lambda charts: [(chart["ticks"], chart["line"]) for chart in charts]  # noqa: E731
    tab.wait(lambda: type_of(charts(tab)) == type_of(before) and charts(tab)[0]["width"] < 400, 20)
    assert tab.page.get_by_role("dialog").count() == 0  # viser's copy
    assert not tab.errors


def test_a_chart_that_is_closed_leaves_the_window_to_the_picture(hall: tuple[Viewer, Tab]) -> None:
    lab, tab = hall
    enlarge(tab)
    tab.wait(lambda: len(charts(tab)) == 1, 20)
    for name in ("plot_energy", "plot_tip"):
        lab.settings.set(name, False)
    tab.wait(lambda: tab.page.locator("[data-floating-window]").first.is_visible(), 20)
    assert not tab.page.locator("#springtide-words").is_visible()


@pytest.mark.long
def test_one_key_projects_the_picture_and_the_charts_without_the_panel(hall: tuple[Viewer, Tab]) -> None:
    lab, tab = hall
    panel, words = tab.page.locator("[data-floating-window]").first, tab.page.locator("#springtide-words")
    two_thirds = pytest.approx((0, SIZE["width"], 2 / 3 * SIZE["height"]), abs=2)
    for _ in range(2):
        assert panel.is_visible()
        tab.page.keyboard.press("l")
        tab.wait(lambda: edges(tab, "canvas[data-engine]") == two_thirds, 20)
        tab.wait(lambda: edges(tab, "#springtide-time") == two_thirds, 20)
        assert not panel.is_visible()
        tab.wait(lambda: words.inner_text().startswith("Running t = "), 20)
        tab.wait(lambda: charts(tab)[0]["ticks"] == [22, 22], 20)
        # One chart alone, and back to both.
        enlarge(tab)
        tab.wait(lambda: len(charts(tab)) == 1 and charts(tab)[0]["height"] >= 500, 20)
        tab.page.keyboard.press("Escape")
        tab.wait(lambda: len(charts(tab)) == 2, 20)
        tab.page.get_by_role("button", name="End").click()
        tab.wait(panel.is_visible, 20)
    tab.page.keyboard.press("l")
    lab.settings.load("Euler explodes")
    tab.wait(lambda: "Stopped" in words.inner_text() and "explicit Euler" in words.inner_text(), 60)
    assert not tab.errors
