"""White water in a gale, in pixels: as much as Monahan measured within a factor of 2, at the lowest quality too."""

import io
from concurrent.futures import Future
from typing import Any

import numpy as np
import pytest
from PIL import Image

from app.messages import Advance
from app.render.cameras import place_cameras
from app.scenes.square_sea.parameters import SquareSeaParams
from app.server.viewer import Viewer
from sim.ocean.statistics.foam import whitecaps
from tests.browser.conftest import NO_NOTES, new_page
from tests.browser.water.test_water import PANEL_HIDDEN, wait

WIND = 24.0  # [m/s]
# No sun, whose glitter is as white.
GALE = SquareSeaParams(
    wind_speed=WIND, spectrum="jonswap", fetch=200e3, length=600.0, choppiness=1.2, clouds=1.0, gauge=False
)
HEIGHT = 400.0  # [m] of the camera, which looks straight down at a half of the tile
LEAST_CONTRAST = 2.5  # of white water over dark water
SETTLED = 4000  # [ms] for the picture after the camera was moved


def share_of_white(picture: np.ndarray) -> float:
    """Fraction of the pixels that are nearer to white water than to dark water; brightness (rows, columns)."""
    dark, white = np.quantile(picture, (0.1, 0.995))
    assert white > LEAST_CONTRAST * dark
    return float((picture > 0.5 * (dark + white)).mean())


@pytest.mark.long
@pytest.mark.timeout(600)
@pytest.mark.parametrize(
    "quality", ["low", *(pytest.param(one, marks=pytest.mark.stress) for one in ("medium", "high"))]
)
def test_white_water_in_a_gale_covers_what_monahan_measured(quality: str, chromium: Any) -> None:
    lab = Viewer("127.0.0.1", 0)
    try:
        lab.open("square_sea", GALE, paused=True)
        there: Future[float] = Future()
        lab.loop.commands.put(Advance(5.0, there))
        there.result(120.0)
        page = new_page(chromium, 320, 320, drawn=True)
        page.add_init_script(f'localStorage.setItem("springtide-quality", "{quality}")')
        page.goto(f"http://127.0.0.1:{lab.port}/?hideViserLogo")
        assert wait(page, lambda: page.locator("#springtide-cover.springtide-hidden").count() > 0, 300.0)
        page.add_style_tag(content=NO_NOTES + PANEL_HIDDEN)
        x = 0.5 * GALE.length
        place_cameras(lab.server, (x, x - 0.02 * HEIGHT, HEIGHT), (x, x, 0.0))
        page.wait_for_timeout(SETTLED)
        picture = np.asarray(Image.open(io.BytesIO(page.screenshot(timeout=240_000))).convert("RGB"), float)
        page.close()
    finally:
        lab.shut()
    assert 0.5 < share_of_white(picture.mean(axis=-1)) / whitecaps(WIND) < 2.0
