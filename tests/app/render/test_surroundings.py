"""The sky behind pictures is the sky of the page."""

import re
from pathlib import Path

import numpy as np
import pytest
import viser
from viser import _messages as vm

import app.render
from app.render.surroundings import AROUND, DARK_SKY, LIGHT_SKY, MIDDLE, Surroundings, before_sky, set_dark

BACKGROUND = r"canvas\[data-engine\] \{ background: (.*?); \}"


class Connection:
    def queue_message(self, message: object) -> None: ...


class Browser:
    def __init__(self) -> None:
        self._websock_connection = Connection()


def test_the_page_has_the_same_skies() -> None:
    css = (Path(app.render.__file__).parent / "js" / "page.css").read_text("utf-8")
    assert [one for one in re.findall(BACKGROUND, css) if "var(" not in one] == [LIGHT_SKY.css, DARK_SKY.css]


def test_what_is_not_drawn_is_sky_light_or_dark_by_browser() -> None:
    pixels = np.zeros((200, 301, 4), np.uint8)
    pixels[:, :10] = (10, 20, 30, 255)  # drawn
    pixels[:, -10:] = (10, 20, 30, 51)  # a fifth of it is
    browser, other = Browser(), Browser()
    middle = round(MIDDLE[1] * 200), round(MIDDLE[0] * 300)
    for sky, dark in ((DARK_SKY, True), (LIGHT_SKY, False)):
        set_dark(browser, dark)  # pyright: ignore[reportArgumentType]
        picture = before_sky(browser, pixels).astype(float)  # pyright: ignore[reportArgumentType]
        assert picture.shape == (200, 301, 3)
        assert picture[middle] == pytest.approx(sky.middle, abs=1.5)
        # A CSS ellipse to the farthest corner is sqrt(2) times as far as its farthest sides.
        halfway = middle[0], middle[1] + round(0.5 * AROUND * 150 * 2**0.5)
        assert picture[halfway] == pytest.approx(np.add(sky.middle, sky.around) / 2, abs=1.5)
        assert (picture[:, :10] == (10, 20, 30)).all()
        assert picture[-1, -1] == pytest.approx(0.2 * np.array((10, 20, 30)) + 0.8 * np.array(sky.corner), abs=1.5)
        assert before_sky(other, pixels)[middle].astype(float) == pytest.approx(LIGHT_SKY.middle, abs=1.5)  # pyright: ignore


def test_the_surroundings_take_the_fog_of_the_scene_before_away(server: viser.ViserServer) -> None:
    sent: list[object] = []
    server.scene.configure_fog(1.0, 2.0, enabled=True)
    server.scene._websock_interface.queue_message = sent.append  # type: ignore[method-assign, assignment]
    Surroundings(server)
    (fog,) = [message for message in sent if isinstance(message, vm.FogMessage)]
    assert fog.enabled is False
