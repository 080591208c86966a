"""The sky behind pictures is the sky of the page."""

import re
from pathlib import Path

import numpy as np
import pytest

import app.render
from app.render.surroundings import DARK_SKY, LIGHT_SKY, before_sky, set_dark

BACKGROUND = r"canvas\[data-engine\] \{ background: (.*?); \}"


class Connection:
    def queue_message(self, message: object) -> None: ...


class Browser:
    def __init__(self) -> None:
        self._websock_connection = Connection()


def test_the_page_has_the_same_skies() -> None:
    css = (Path(app.render.__file__).parent / "js" / "page.css").read_text()
    assert re.findall(BACKGROUND, css) == [LIGHT_SKY.css, DARK_SKY.css]


def test_what_is_not_drawn_is_sky_light_or_dark_by_browser() -> None:
    pixels = np.zeros((200, 3, 4), np.uint8)
    pixels[:, 1] = (10, 20, 30, 255)  # drawn
    pixels[:, 2] = (10, 20, 30, 51)  # a fifth of it is
    browser, other = Browser(), Browser()
    for sky, dark in ((DARK_SKY, True), (LIGHT_SKY, False)):
        set_dark(browser, dark)  # pyright: ignore[reportArgumentType]
        picture = before_sky(browser, pixels).astype(float)  # pyright: ignore[reportArgumentType]
        assert picture.shape == (200, 3, 3)
        assert picture[0, 0] == pytest.approx(sky.top, abs=1.5)
        assert picture[45, 0] == pytest.approx(np.add(*sky) / 2, abs=1.5)
        assert (picture[95:, 0] == sky.bottom).all()
        assert (picture[:, 1] == (10, 20, 30)).all()
        assert picture[-1, 2] == pytest.approx(0.2 * np.array((10, 20, 30)) + 0.8 * np.array(sky.bottom), abs=0.51)
        assert before_sky(other, pixels)[0, 0].astype(float) == pytest.approx(LIGHT_SKY.top, abs=1.5)  # pyright: ignore
