"""The first whole picture is the true one: its mean colour is that of half a minute later, at each quality.

The lab is paused: waves near the camera hide more of the sky, or less. One preset is looked at by default; the others
take a minute each, and are stress tests. A run that is not paused stands at its start in the first whole picture.
"""

import io
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from app.messages import Pause
from app.scenes import NAMES, scene_named
from app.scenes.setups import make_setup, read_query
from app.server.viewer import Viewer
from docs.make_replays import CLIPS, page_of
from tests.browser.conftest import NO_NOTES, new_page, vertices_of
from tests.browser.water.test_water import wait

QUALITIES = ("low", "medium", "high")
LATER = 30.0  # [s]
LARGEST_CHANGE = 3.0  # of 255, of the mean of any of the three colours
LATEST = 0.1  # [s] time of the run in the first whole picture
SAMPLE = ("square_sea", "Storm arriving", "low")  # it began under a blue sky
NOTHING_OVER_THE_PICTURE = NO_NOTES + " .mantine-Paper-root { display: none !important }"
PRESETS = [(scene, preset) for scene in NAMES for preset in scene_named(scene).presets]
CASES = [(*preset, quality) for preset in PRESETS for quality in QUALITIES]
PAIRS = {  # of panes side by side
    "planets": ("?scene=square_sea&planet=Earth", "?scene=square_sea&planet=Mars"),
    "storms": ("?scene=square_sea&preset=Storm arriving", "?scene=square_sea&preset=Storm over"),
}

# Holds the photographs back that the server sends: until `letSkyCome` viser's client shows its own.
LATE_SKY = """const get = window.fetch;
const held = new Promise((go) => { window.letSkyCome = go; });
window.fetch = (asked, how) => {
    const isOfServer = (asked.url ?? String(asked)).startsWith("blob:");
    return (isOfServer ? held : Promise.resolve()).then(() => get(asked, how)); };"""
SHOWS_OTHER_SKY = "Boolean(window.__viserMutable?.scene?.environment)"
SKY = "window.__viserMutable.scene.environment?.uuid ?? ''"
WATCH_SKY = f"window.skies = new Set(), setInterval(() => window.skies.add({SKY}), 20)"
# Keeps the clock's words of the moment at which the cover goes, in a replay the number in its time box: `firstClock`.
WATCH_CLOCK = """window.firstClock = "";
const TIME_BOX = "input.mantine-NumberInput-input";
new MutationObserver(() => {
    if (window.firstClock || !document.querySelector("#springtide-cover.springtide-hidden")) return;
    const panel = document.querySelector(".springtide-panel[data-state]"), box = document.querySelector(TIME_BOX);
    window.firstClock = panel?.innerText ?? box?.value ?? "no clock";
}).observe(document, { subtree: true, childList: true, attributes: true, attributeFilter: ["class"] });"""
COVERED = "document.querySelector('#springtide-cover:not(.springtide-hidden)')?.innerText ?? ''"


def mean_colour(page: Any) -> np.ndarray:
    """(3,), 0 to 255, of the page."""
    picture = Image.open(io.BytesIO(page.screenshot(timeout=240_000))).convert("RGB")
    return np.asarray(picture, float).mean(axis=(0, 1))


def pane_colours(page: Any) -> np.ndarray:
    """(2, 3), 0 to 255, of the left and the right half of the page."""
    picture = np.asarray(Image.open(io.BytesIO(page.screenshot(timeout=240_000))).convert("RGB"), float)
    return np.array([half.mean(axis=(0, 1)) for half in np.array_split(picture, 2, axis=1)])


def colours(chromium: Any, scene: str, preset: str, quality: str) -> tuple[np.ndarray, np.ndarray]:
    """Mean colours of the first whole frame, and of the frame LATER seconds later, of a lab that is paused."""
    lab = Viewer("127.0.0.1", 0)
    try:
        lab.open(scene, make_setup(scene_named(scene), preset).params, paused=True)
        page = new_page(chromium, 400, 260, drawn=True)
        errors: list[str] = []
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.add_init_script(f'localStorage.setItem("springtide-quality", "{quality}")')
        page.goto(f"http://127.0.0.1:{lab.port}/?hideViserLogo")
        page.add_style_tag(content=NOTHING_OVER_THE_PICTURE)
        assert wait(page, lambda: page.locator("#springtide-cover.springtide-hidden").count() > 0, 300.0)
        page.add_style_tag(content="#springtide-cover { display: none !important }")  # it fades
        first = mean_colour(page)
        page.wait_for_timeout(1e3 * LATER)
        later = mean_colour(page)
        page.close()
        assert not errors
    finally:
        lab.shut()
    return first, later


@pytest.mark.timeout(1200)
@pytest.mark.parametrize(
    ("scene", "preset", "quality"),
    [pytest.param(*case, marks=pytest.mark.long if case == SAMPLE else pytest.mark.stress) for case in CASES],
)
def test_the_first_whole_frame_has_the_colour_of_the_later_ones(
    scene: str, preset: str, quality: str, chromium: Any
) -> None:
    first, later = colours(chromium, scene, preset, quality)
    assert later.mean() > 10.0  # there is a picture
    assert first == pytest.approx(later, abs=LARGEST_CHANGE)


@pytest.mark.timeout(600)
@pytest.mark.parametrize(("scene", "preset"), [pytest.param(*case, marks=pytest.mark.stress) for case in PRESETS])
@pytest.mark.parametrize("drawn", [True, False], ids=["slow", "quick"])
def test_a_run_stands_at_its_start_in_the_first_whole_picture(
    scene: str, preset: str, drawn: bool, chromium: Any
) -> None:
    lab = Viewer("127.0.0.1", 0)
    try:
        lab.open(scene, make_setup(scene_named(scene), preset).params)
        page = new_page(chromium, 400, 260, drawn=drawn)
        page.add_init_script(WATCH_CLOCK)
        page.goto(f"http://127.0.0.1:{lab.port}/?hideViserLogo")
        assert wait(page, lambda: page.evaluate("window.firstClock"), 300.0)
        clock = re.search(r"t = ([0-9.]+) s", page.evaluate("window.firstClock"))
        assert wait(page, lambda: lab.loop.scene.time > 0.0)
        page.close()
    finally:
        lab.shut()
    assert clock is not None
    assert float(clock[1]) <= LATEST


@pytest.mark.timeout(600)
@pytest.mark.parametrize(
    "scene", [pytest.param(name, marks=pytest.mark.long if name == "rope" else pytest.mark.stress) for name in CLIPS]
)
@pytest.mark.parametrize("drawn", [True, False], ids=["slow", "quick"])
def test_a_replay_stands_at_its_first_frame_in_its_first_whole_picture(
    scene: str, drawn: bool, chromium: Any, tmp_path: Path
) -> None:
    file = tmp_path / "replay.html"
    clip = CLIPS[scene]
    file.write_text(page_of(scene, clip._replace(end=clip.start + 2.0, rate=5.0)), "utf-8")
    page = new_page(chromium, 400, 260, drawn=drawn)
    try:
        page.add_init_script(WATCH_CLOCK)
        page.goto(file.as_uri(), wait_until="commit")
        assert wait(page, lambda: page.evaluate("window.firstClock"), 300.0)
        assert float(page.evaluate("window.firstClock")) <= LATEST
        box = page.locator("input.mantine-NumberInput-input").first
        assert wait(page, lambda: float(box.input_value()) > 0.5)
    finally:
        page.close()


@pytest.mark.stress
@pytest.mark.timeout(900)
@pytest.mark.parametrize("queries", PAIRS.values(), ids=PAIRS)
@pytest.mark.parametrize("drawn", [True, False], ids=["slow", "quick"])
def test_two_panes_stand_at_their_start_in_their_first_whole_pictures(
    queries: tuple[str, str], drawn: bool, chromium: Any
) -> None:
    lab = Viewer("127.0.0.1", 0)
    try:
        lab.comparing.begin([read_query(query) for query in queries], True)
        assert lab.comparison is not None
        viewers = lab.comparison.viewers
        page = new_page(chromium, 700, 300, drawn=drawn)
        page.add_init_script(WATCH_CLOCK)
        page.goto(f"http://127.0.0.1:{lab.port}/beside?hideViserLogo")

        def clocks() -> list[str]:
            shown = [frame.evaluate("window.firstClock ?? ''") for frame in page.frames if "index.html" in frame.url]
            return [clock for clock in shown if clock]

        assert wait(page, lambda: len(clocks()) == 2, 300.0)
        found = [re.search(r"t = ([0-9.]+) s", clock) for clock in clocks()]
        assert wait(page, lambda: all(viewer.scene.time > 0.0 for viewer in viewers))
        page.close()
    finally:
        lab.shut()
    assert all(found)
    assert max(float(clock[1]) for clock in found if clock) <= LATEST


@pytest.mark.stress
@pytest.mark.timeout(900)
@pytest.mark.parametrize("queries", PAIRS.values(), ids=PAIRS)
def test_the_first_whole_frames_of_two_panes_have_the_colours_of_the_later_ones(
    queries: tuple[str, str], chromium: Any
) -> None:
    lab = Viewer("127.0.0.1", 0)
    try:
        lab.comparing.begin([read_query(query) for query in queries], True)
        assert lab.comparison is not None
        for viewer in lab.comparison.viewers:
            viewer.commands.put(Pause())
        page = new_page(chromium, 700, 300, drawn=True)
        page.goto(f"http://127.0.0.1:{lab.port}/beside?hideViserLogo")

        def panes() -> list[Any]:
            return [frame for frame in page.frames if "index.html" in frame.url]

        def are_whole() -> bool:
            return len(panes()) == 2 and all(
                pane.locator("#springtide-cover.springtide-hidden").count() for pane in panes()
            )

        assert wait(page, are_whole, 300.0)
        for pane in panes():
            pane.add_style_tag(content=NOTHING_OVER_THE_PICTURE + "#springtide-cover { display: none !important }")
        first = pane_colours(page)
        page.wait_for_timeout(1e3 * LATER)
        later = pane_colours(page)
        page.close()
    finally:
        lab.shut()
    assert later.mean() > 10.0
    assert first == pytest.approx(later, abs=LARGEST_CHANGE)


@pytest.mark.long
@pytest.mark.parametrize("form", ["lab", "replay"])
def test_the_cover_stays_until_the_scene_has_its_own_sky(form: str, chromium: Any, tmp_path: Path) -> None:
    page = new_page(chromium, 400, 260, drawn=False)
    page.add_init_script(LATE_SKY)
    lab = Viewer("127.0.0.1", 0) if form == "lab" else None
    try:
        if lab is not None:
            page.goto(f"http://127.0.0.1:{lab.port}/?hideViserLogo&fixedDpr=0.2", wait_until="commit")
            assert wait(page, lambda: page.evaluate(SHOWS_OTHER_SKY), 60.0)  # no scene is open
            lab.open("square_sea", paused=True)
        else:
            file = tmp_path / "sea.html"
            file.write_text(page_of("square_sea", CLIPS["square_sea"]._replace(start=0.0, end=2.0, rate=5.0)), "utf-8")
            page.goto(file.as_uri(), wait_until="commit")
            assert wait(page, lambda: "Opening Square sea …" in page.evaluate(COVERED), 60.0)
        page.wait_for_timeout(6000)  # in which all else arrives
        assert page.evaluate(COVERED)
        page.evaluate("letSkyCome()")
        assert wait(page, lambda: not page.evaluate(COVERED), 40.0)
        if lab is None:  # the sky stays from round to round
            sky = page.evaluate(SKY)
            page.evaluate(WATCH_SKY)
            page.wait_for_timeout(7000)
            assert page.evaluate("[...window.skies]") == [sky]
            at_rest, waves = (vertices_of(page, name)[:, 2] for name in ("/sea/water_rest", "/sea"))
            assert (at_rest == 0.0).all()  # a recording holds it once, with the vertices of the sea at the start
            assert 0.1 < waves.std() < 2.0
    finally:
        page.close()
        if lab is not None:
            lab.shut()
