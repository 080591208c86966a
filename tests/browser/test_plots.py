"""The plots in a real browser."""

import numpy as np

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
    tab.wait(lambda: not lab.loop.running)
    t = np.linspace(0.0, 10.0, 101)
    y = np.where((t > 4.0) & (t < 6.0), np.nan, np.sin(t))
    plots: Plots = lab.panel.plots
    rows = [(float(time), *[float(value)] * len(lab.panel.kind.series)) for time, value in zip(t, y, strict=True)]
    lab.panel.set("plot_tip", True)
    tab.wait(lambda: "plot_tip" in plots.open)
    lab.loop.plot_rows.extend([(float("nan"),) * len(rows[0]), *rows])

    def drawn(first: float, last: float) -> float:
        found = tab.page.evaluate(DRAWN, [first, last])
        return found[0] if found else -1.0

    tab.wait(lambda: drawn(1.0, 3.5) > 0.95)
    tab.wait(lambda: drawn(4.2, 5.8) == 0.0, 20)
    assert drawn(6.5, 9.0) > 0.95
    assert not tab.errors
