"""A browser that does not draw into floats: its sky is a formula, and looks like that of the photograph."""

from collections.abc import Callable

import numpy as np
import pytest

from app.messages import Pause
from app.server.viewer import Viewer
from tests.browser.conftest import LOADING_ERRORS, NO_FLOATS, Tab
from tests.browser.page.test_lost import final_picture

MAX_DIFFERENCE, IN_HALF = 12.0, 16.0  # of 255, between mean colours: of the picture, and of its halves


def settled_picture(tab: Tab) -> np.ndarray:
    tab.wait(lambda: tab.page.evaluate("window.__springtide?.showsWhole?.()"))
    return final_picture(tab)


@pytest.mark.long
@pytest.mark.parametrize(
    ("scene", "sky"),
    [
        ("square_sea", "park"),
        ("square_sea", "sunset"),
        ("square_sea", "dawn"),
        ("square_sea", "night"),
        ("radial_sea", "sunset"),
    ],
)
def test_the_sea_has_a_sky_that_looks_alike(open_tab: Callable[..., Tab], scene: str, sky: str) -> None:
    viewer = Viewer("127.0.0.1", 0)
    viewer.open(scene)
    viewer.settings.set("sky", sky)
    viewer.loop.commands.put(Pause())
    tab = open_tab(viewer.port, width=480, height=320, drawn=True)
    try:
        ordinary = settled_picture(tab)
        warnings: list[str] = []
        tab.page.on("console", lambda message: warnings.append(message.text))
        tab.page.add_init_script(NO_FLOATS)
        tab.page.reload()
        formed = settled_picture(tab)
        assert tab.page.evaluate("window.__springtide.skiesDrawn") == 0
        half = len(formed) // 2
        # The sky is above, the sea below.
        for part, limit in ((slice(None), MAX_DIFFERENCE), (slice(half), IN_HALF), (slice(half, None), IN_HALF)):
            difference = formed[part].mean((0, 1)) - ordinary[part].mean((0, 1))
            assert np.abs(difference).max() < limit
        assert not any("Mipmap" in words for words in warnings)  # the script makes the smaller copies of the waves
        assert formed[half:].std() > 0.6 * ordinary[half:].std()  # waves are seen
        assert [error for error in tab.errors if LOADING_ERRORS not in error] == []
    finally:
        viewer.shut()
