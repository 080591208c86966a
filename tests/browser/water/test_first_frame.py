"""The first whole picture is the true one: its mean colour is that of half a minute later, at each quality.

The lab is paused: waves near the camera hide more of the sky, or less. One preset is looked at by default; the others
take a minute each, and are stress tests.
"""

import io
from typing import Any

import numpy as np
import pytest
from PIL import Image

from app.scenes import NAMES, scene_named
from app.scenes.setups import make_setup
from app.server.viewer import Viewer
from tests.browser.conftest import NO_NOTES, new_page
from tests.browser.water.test_water import wait

QUALITIES = ("low", "medium", "high")
LATER = 30.0  # [s]
LARGEST_CHANGE = 12.0  # of 255, of the mean of any of the three colours
SAMPLE = ("square_sea", "Storm arriving", "low")  # it began under a blue sky
NOTHING_OVER_THE_PICTURE = NO_NOTES + " .mantine-Paper-root { display: none !important }"
CASES = [(scene, preset, quality) for scene in NAMES for preset in scene_named(scene).presets for quality in QUALITIES]


def mean_colour(page: Any) -> np.ndarray:
    """(3,), 0 to 255, of the page."""
    picture = Image.open(io.BytesIO(page.screenshot(timeout=240_000))).convert("RGB")
    return np.asarray(picture, float).mean(axis=(0, 1))


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
