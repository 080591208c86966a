"""Labels in pixels: as sharp at the least quality of the picture, apart at any distance, and part of pictures."""

import io
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from PIL import Image

from app.messages import Pause
from app.panel.recording.picture import take_picture
from app.render.cameras import place_cameras
from app.scenes.race.parameters import PRESETS, RaceParams
from app.server.viewer import Viewer
from sim.parameters import check_record
from tests.browser.conftest import NO_NOTES, new_page
from tests.browser.water.test_water import PANEL_HIDDEN

DARK_SKY = "canvas[data-engine] { background: black !important } #springtide-cover { display: none }"
WIDTH = "() => document.querySelector('canvas[data-engine]')?.width"
CHOOSE = """name => { const select = document.querySelector("[data-springtide-choice=quality]"); select.value = name;
    select.dispatchEvent(new Event("change", { bubbles: true })); }"""
BRIGHT = 180  # of 255: backgrounds of labels on black reach 217, and nothing else that is drawn 160


@pytest.fixture(scope="module")
def race(chromium: Any) -> Iterator[tuple[Viewer, Any]]:
    """A paused race of five ropes, and a page with the shaders of labels only."""
    viewer = Viewer("127.0.0.1", 0)
    without_charts = {"plot_errors": False, "plot_energies": False}
    viewer.open("race", check_record(RaceParams, {**PRESETS["Undamped until chaos"], **without_charts}), paused=True)
    page = new_page(chromium, 640, 420, drawn="vAlpha")
    page.goto(f"http://127.0.0.1:{viewer.port}/?hideViserLogo")
    page.get_by_role("tab", name="View", exact=True).click(timeout=60_000)
    page.add_style_tag(content=NO_NOTES + PANEL_HIDDEN + DARK_SKY)
    viewer.loop.commands.put(Pause())
    yield viewer, page
    page.close()
    viewer.shut()


def steady(page: Any) -> np.ndarray:
    """The page in pixels, once it no longer changes and labels are on it."""
    shots: list[np.ndarray] = []
    for _ in range(60):
        page.wait_for_timeout(500)
        shots.append(np.asarray(Image.open(io.BytesIO(page.screenshot())).convert("RGB")).astype(int))
        if len(shots) > 2 and area(shots[-1]) and all((one == shots[-1]).all() for one in shots[-3:]):
            return shots[-1]
    pytest.fail("the page does not come to rest, or shows no label")


def area(pixels: np.ndarray) -> int:
    """Number of pixels of the backgrounds of labels."""
    return int((pixels.min(axis=-1) > BRIGHT).sum())


@pytest.mark.long
def test_labels_at_low_quality_are_those_at_high_pixel_for_pixel(race: tuple[Viewer, Any]) -> None:
    _, page = race
    found = {}
    for quality, width in (("high", 640), ("low", 320)):
        page.evaluate(CHOOSE, quality)
        page.wait_for_function(f"() => ({WIDTH})() === {width}", timeout=60_000)
        found[quality] = steady(page)
    bright = found["high"].min(axis=-1) > BRIGHT
    assert bright.sum() > 5000  # of five labels
    # Letters and all: what stands between bright pixels of a row, without the poles at the ends.
    inside = bright & np.roll(bright, 3, axis=1) & np.roll(bright, -3, axis=1)
    around = inside | np.roll(inside, 1, axis=1) | np.roll(inside, 2, axis=1)
    assert (found["low"][around] == found["high"][around]).all()


@pytest.mark.long
def test_no_label_covers_another_however_far_the_camera_is(race: tuple[Viewer, Any]) -> None:
    lab, page = race
    page.evaluate(CHOOSE, "high")
    position, target = lab.view.first_view(lab.loop.latest.params)
    found = []
    for scale in (1.0, 2.5, 6.0):
        x, y, z = (t + scale * (p - t) for p, t in zip(position, target, strict=True))
        place_cameras(lab.server, (x, y, z), target)
        page.wait_for_timeout(1000)
        found.append(area(steady(page)))
    place_cameras(lab.server, position, target)
    # Labels have one size on the screen: where one covers another, less of their backgrounds is seen.
    assert min(found[1:]) > 0.97 * found[0]


@pytest.mark.long
def test_labels_keep_their_size_where_panels_leave_less_of_the_picture(race: tuple[Viewer, Any]) -> None:
    _, page = race
    page.evaluate(CHOOSE, "high")
    whole = steady(page)
    page.evaluate(
        """() => { const panel = document.body.appendChild(document.createElement("div"));
        Object.assign(panel, { id: "test-panel" }).dataset.floatingWindow = "";
        panel.style.cssText = "position: fixed; bottom: 0; width: 100%; height: 170px; opacity: 0"; }"""
    )
    page.wait_for_timeout(1500)
    smaller = steady(page)
    page.evaluate("document.getElementById('test-panel').remove()")
    assert (smaller != whole).any()
    assert smaller[260:].max() < BRIGHT
    assert area(smaller) == pytest.approx(area(whole), rel=0.05)


def test_a_picture_has_the_labels(race: tuple[Viewer, Any]) -> None:
    lab, page = race
    page.evaluate(CHOOSE, "low")
    shown = area(steady(page))
    [client] = lab.server.get_clients().values()
    picture = Image.open(io.BytesIO(take_picture(client, (640, 420), transparent=True)))
    on_black = Image.alpha_composite(Image.new("RGBA", picture.size, "black"), picture)
    assert abs(area(np.asarray(on_black.convert("RGB"))) - shown) < 0.05 * shown
    assert area(steady(page)) == shown  # the page has them again
