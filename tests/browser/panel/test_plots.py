"""The plots in a real browser."""

import numpy as np
import pytest

from app.messages import Pause
from app.panel.plots import Plots
from app.server.viewer import Viewer
from tests.browser.conftest import Tab

SCENE = "rope"
# Of the first line of each chart: how many columns of pixels between two times [s] have something of its colour; -1
# before the chart has a scale.
DRAWN = """([first, last]) => Object.values(window.__viserTestpoints?.uplots ?? {}).map(({ chart }) => {
    const from = Math.round(chart.valToPos(first, "x", true)), to = Math.round(chart.valToPos(last, "x", true));
    if (!Number.isFinite(from) || !Number.isFinite(to)) return -1;
    const { top, height } = chart.bbox;
    const { data, width } = chart.ctx.getImageData(from, top, Math.max(to - from, 1), height);
    let columns = 0;
    for (let x = 0; x < width; x++) {
        let found = false;
        for (let y = 0; y < height; y++) {
            const [red, green, blue, alpha] = data.slice(4 * (y * width + x), 4 * (y * width + x) + 4);
            found = found || (alpha > 128 && Math.max(red, green, blue) - Math.min(red, green, blue) > 60);
        }
        columns += found;
    }
    return columns / width; })"""


def test_a_line_is_not_drawn_over_a_gap(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    lab.loop.commands.put(Pause())
    tab.wait(lambda: not lab.loop.run.running)
    t = np.linspace(0.0, 10.0, 101)
    y = np.where((t > 4.0) & (t < 6.0), np.nan, np.sin(t))
    plots: Plots = lab.panel.plots
    rows = [(float(time), *[float(value)] * len(lab.panel.kind.series)) for time, value in zip(t, y, strict=True)]
    lab.settings.set("plot_tip", True)
    tab.wait(lambda: "plot_tip" in plots.open)
    run = lab.loop.latest.status.run._replace(number=lab.loop.latest.status.run.number + 1)
    lab.loop.run.snapshots.plot_rows.extend((run, row) for row in rows)

    def drawn(first: float, last: float) -> float:
        found = tab.page.evaluate(DRAWN, [first, last])
        return found[0] if found else -1.0

    tab.wait(lambda: drawn(1.0, 3.5) > 0.95)
    tab.wait(lambda: drawn(4.2, 5.8) == 0.0, 20)
    assert drawn(6.5, 9.0) > 0.95
    assert not tab.errors


# Of the pane of the charts: its lower edge, the lower edge of the last chart that is whole, whether title and key share
# a line, and the name at the end of each first axis.
FILLED = """() => {
    const pane = document.querySelector(".mantine-ScrollArea-viewport:has(.uplot):not(:has(.springtide-panel))");
    if (!pane) return null;
    const foot = pane.getBoundingClientRect().bottom, box = (node) => node.getBoundingClientRect();
    const charts = [...pane.querySelectorAll(".uplot")].map((chart) => ({ bottom: box(chart).bottom,
        axis: chart.querySelector(".u-over").dataset.springtideAxis,
        beside: Math.abs(box(chart.querySelector(".u-title")).top - box(chart.querySelector(".u-legend")).top),
        keys: chart.querySelectorAll(".u-legend .u-series").length }));
    const whole = charts.filter(({ bottom }) => bottom <= foot);
    return { left: foot - Math.max(0, ...whole.map(({ bottom }) => bottom)), charts, whole: whole.length }; }"""


@pytest.mark.parametrize(
    ("width", "height", "whole"),
    [
        (1000, 420, 1),
        *(pytest.param(*sizes, marks=pytest.mark.long) for sizes in ((1000, 640, 1), (1400, 800, 3))),
    ],
)
def test_charts_fill_their_drawer_at_any_height_with_the_key_beside_the_title(
    shown: tuple[Viewer, Tab], width: int, height: int, whole: int
) -> None:
    lab, tab = shown
    size = tab.page.viewport_size
    tab.page.set_viewport_size({"width": width, "height": height})
    for name in ("plot_energy", "plot_losses", "plot_tip"):
        lab.settings.set(name, True)

    def is_filled() -> bool:
        found = tab.page.evaluate(FILLED)
        return bool(found) and len(found["charts"]) == 3 and found["whole"] == whole and found["left"] < 24

    try:
        tab.wait(is_filled, 30)
        charts = tab.page.evaluate(FILLED)["charts"]
        assert [chart["axis"] for chart in charts] == ["t [s]"] * 3
        if width == 1000:
            tab.wait(lambda: [chart["keys"] for chart in tab.page.evaluate(FILLED)["charts"]] == [5, 2, 1], 20)
            assert tab.page.evaluate(FILLED)["charts"][0]["beside"] < 6
    finally:
        tab.page.set_viewport_size(size)
    assert not tab.errors


# Of each chart: pixels beside the widest words of its second axis, in the type that the axis has.
BESIDE_WORDS = """() => Object.values(window.__viserTestpoints.uplots).map(({ chart: { ctx, axes: [, axis] } }) => {
    ctx.save(), (ctx.font = axis.font[0]);
    const wide = Math.max(...axis._values.map((word) => ctx.measureText(word).width)) * axis.font[2] / axis.font[1];
    ctx.restore();
    return axis._size - wide; })"""


@pytest.mark.parametrize("large", [False, True])
def test_the_words_of_ticks_have_room_in_any_type(shown: tuple[Viewer, Tab], large: bool) -> None:
    """The race's smallest error has the most letters of all ticks: its first one was cut off."""
    lab, tab = shown
    tab.follow(lab, "race")
    tab.page.evaluate("large => document.documentElement.classList.toggle('springtide-large', large)", large)
    try:
        tab.wait(lambda: tab.page.evaluate(BESIDE_WORDS))
        tab.page.wait_for_timeout(1000)
        room = tab.page.evaluate(BESIDE_WORDS)
        assert len(room) == 2
        assert all(15.0 <= one <= 45.0 for one in room), room
    finally:
        tab.page.evaluate("document.documentElement.classList.remove('springtide-large')")
