"""The race scene in a real browser: ropes, labels and charts."""

import io
from collections.abc import Callable

import numpy as np
import pytest
from PIL import Image

from app.scenes.race.parameters import PRESETS, RaceParams
from app.scenes.springs.rope_parameters import ROOT
from app.server.viewer import Viewer
from sim.parameters import check_record
from tests.browser.conftest import NO_NOTES, Tab

SCENE = "race"
CHARTS = """() => Object.values(window.__viserTestpoints?.uplots ?? {}).map(({chart}) => ({
    title: chart.root.querySelector('.u-title')?.textContent, labels: chart.series.map(s => s.label),
    rows: chart.data[0].length, log: chart.scales.y.distr === 3}))"""


@pytest.mark.long
@pytest.mark.parametrize("presets", [list(PRESETS)[::3], pytest.param(list(PRESETS), marks=pytest.mark.stress)])
def test_every_race_is_drawn_with_its_charts_and_no_console_errors(
    shown: tuple[Viewer, Tab], presets: list[str]
) -> None:
    lab, tab = shown
    for preset in presets:
        lab.settings.load(preset)
        params = check_record(RaceParams, PRESETS[preset])
        ropes = params.ropes
        tab.wait(lambda params=params: lab.loop.latest.params == params)

        def drawn(ropes=ropes) -> bool:
            counts = [len(tab.vertices(f"/race/rope_{number + 1}")) for number in range(ropes + 1)]
            return all(counts[:ropes]) and counts[ropes] == 0 and len(tab.vertices("/race/references")) == sum(counts)

        tab.wait(drawn)
        # They start level at the root's height; a slow page may miss the swing, not that it was.
        tab.wait(lambda: tab.vertices("/race/references")[:, 2].min() < ROOT[2] - 1.0)

        def charts(ropes=ropes) -> list:
            found = {chart["title"]: chart for chart in tab.page.evaluate(CHARTS)}
            errors, energies = found.get("Distance from the reference"), found.get("Energy error [J]")
            full = errors and energies and min(errors["rows"], energies["rows"]) > 5
            return (
                [errors, energies]
                if full and len(errors["labels"]) == ropes + 2 and len(energies["labels"]) == ropes + 1
                else []
            )

        errors, energies = tab.wait(charts)
        assert errors["log"]
        assert errors["labels"][1] == "below the accuracy of the reference"
        named = energies["labels"][1:]
        assert named == errors["labels"][2:]
        assert [label.split()[0] for label in named] == [str(number + 1) for number in range(ropes)]
    assert not lab.loop.run.halted
    assert tab.errors == []


@pytest.mark.long
def test_a_bead_is_dragged_and_another_preset_starts_at_once(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    without_charts = {"plot_errors": False, "plot_energies": False, "speed": 4.0}
    tab.follow(lab, SCENE, check_record(RaceParams, {**PRESETS["Leapfrog read literally"], **without_charts}))
    tab.wait(lambda: lab.scene.time > 5)
    lab.settings.set("speed", 1.0)
    tab.wait(lambda: len(tab.vertices("/race/rope_4")) > 0)

    def grabbed() -> bool:
        return lab.scene.handles.grab.grabbed is not None

    tab.hold(lambda: tab.pixel(lab.scene.frame().ropes[0, 7]), (-60, -40), grabbed)
    tab.release()
    tab.wait(lambda: not grabbed(), 30)
    tab.page.keyboard.press("1")
    tab.wait(lambda: len(tab.vertices("/race/rope_3")) > 0 and len(tab.vertices("/race/rope_4")) == 0)
    assert len(lab.scene.race.entrants) == 3
    assert tab.errors == []


@pytest.mark.long
def test_labels_are_dark_in_dark_mode_and_light_again(
    one_page: tuple[Viewer, Tab], open_tab: Callable[..., Tab]
) -> None:
    lab, _ = one_page
    tab = open_tab(lab.port, drawn="vAlpha")  # of the shaders of labels
    tab.page.add_style_tag(content=NO_NOTES)
    tab.follow(lab, SCENE, check_record(RaceParams, {"plot_errors": False, "plot_energies": False}))

    def brightness() -> float:
        """Of the last label and its text [0..255], to the right of its pole and above it; that of the sky is 115."""
        x, y = tab.pixel(np.array(lab.view.ropes.labels.handles[-1].position))
        picture = tab.page.screenshot(clip={"x": x + 4, "y": y - 16, "width": 60, "height": 12})
        return float(np.median(np.asarray(Image.open(io.BytesIO(picture)).convert("L"))))

    tab.wait(lambda: len(tab.vertices("/race/rope_1")) > 0 and brightness() > 150)
    tab.page.emulate_media(color_scheme="dark")
    try:
        tab.wait(lambda: brightness() < 105)
    finally:
        tab.page.emulate_media(color_scheme="light")
    tab.wait(lambda: brightness() > 150)
    assert tab.errors == []


DRAWN = """() => { const chart = Object.values(window.__viserTestpoints?.uplots ?? {}).map((one) => one.chart)
    .find((one) => one.root.querySelector(".u-title")?.textContent === "Distance from the reference");
  if (!chart) return null;
  // The points of each line, in the order of the series: uPlot keeps none, so they are noted as it makes paths again.
  const spied = chart.series.map((series, k) => {
    if (k === 0) return [];
    const points = [], put = Path2D.prototype.lineTo;
    Path2D.prototype.lineTo = function (x, y) { points.push([this, x, y]); put.call(this, x, y); };
    let made;
    try { made = series.paths(chart, k, 0, chart.data[0].length - 1); } finally { Path2D.prototype.lineTo = put; }
    return points.filter(([path]) => path === made.stroke).map(([, x, y]) => [x, y]);
  });
  return { labels: chart.series.map((series) => series.label), lowest: chart.bbox.top + chart.bbox.height,
    points: spied, data: chart.data.map((column) => [...column]),
    crosses: [...chart.over.querySelectorAll(".springtide-placed-cross")].map((mark) =>
      [mark.textContent, mark.getBoundingClientRect().top - chart.over.getBoundingClientRect().top]) }; }"""


def test_the_error_of_a_rope_that_has_diverged_ends_in_a_cross_and_is_not_drawn_as_the_best(
    shown: tuple[Viewer, Tab],
) -> None:
    lab, tab = shown
    tab.follow(lab, SCENE, check_record(RaceParams, {**PRESETS["Shaken at the root"], "time_step": 1 / 60}))
    tab.wait(lambda: lab.scene.race.entrants[0].failure and lab.scene.race.entrants[1].failure)
    tab.wait(lambda: (found := tab.page.evaluate(DRAWN)) and len(found["crosses"]) == 2)
    found = tab.page.evaluate(DRAWN)
    for rope in (0, 1):
        errors, points = found["data"][2 + rope], np.array(found["points"][2 + rope])
        assert errors[-1] is None
        assert min(error for error in errors if error is not None) > 1e-6
        assert points[:, 1].max() < 0.7 * found["lowest"]  # the scale goes down to 0.1 nm
        said = lab.scene.race.entrants[rope].failure.partition(":")[0]
        assert f"× {rope + 1}: {said}" in found["labels"]
        assert [f"× {rope + 1}: {said}", pytest.approx(14 * rope - 7, abs=1)] in found["crosses"]
    assert tab.errors == []
