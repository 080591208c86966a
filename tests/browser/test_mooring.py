"""The mooring in pixels: sky above a sea to the horizon, and under it the lit bed amid deep water."""

import io
from collections.abc import Callable

import numpy as np
from PIL import Image

from app.messages import Pause
from app.server.viewer import Viewer
from tests.browser.conftest import NO_NOTES, Tab
from tests.browser.test_water import PANEL_HIDDEN


def test_open_water_lies_around_the_mooring(open_tab: Callable[..., Tab]) -> None:
    lab = Viewer("127.0.0.1", 0)
    try:
        lab.open("mooring")
        tab = open_tab(lab.port, width=400, height=260, drawn=True, ratio=1.0)
        tab.wait(lambda: lab.view.built and lab.view.water.has_shader is True and lab.view.sand.has_shader is True)
        lab.loop.commands.put(Pause())
        tab.page.add_style_tag(content=NO_NOTES + PANEL_HIDDEN + "#springtide-cover { display: none }")
        tab.page.wait_for_timeout(3000)
        picture = np.asarray(Image.open(io.BytesIO(tab.page.screenshot())).convert("RGB")).astype(float)
        errors = tab.errors
    finally:
        lab.shut()
    sky, sea, corners = picture[:30], picture[60:90], picture[-25:, [*range(40), *range(360, 400)]]
    x, y = 200, 190  # the bed, before the body
    bed = picture[y - 10 : y + 10, x - 60 : x - 20]
    assert sky.mean() > 1.3 * sea.mean()
    assert sky.std(axis=(0, 1)).min() > 2.0  # clouds
    assert bed.mean() > 1.5 * corners.mean()
    assert corners[..., 2].mean() > 1.5 * corners[..., 0].mean()  # blue, and not the white hall of the springs
    assert errors == []
