"""The first views of both seas in pixels: the sun's path glints, and is no white column."""

import io
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from PIL import Image

from app.messages import Pause
from app.server.viewer import Viewer
from tests.browser.conftest import NO_NOTES, Tab
from tests.browser.water.test_water import PANEL_HIDDEN

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


@pytest.mark.stress  # compiles the shaders of two seas, and draws every pixel
@pytest.mark.timeout(600)
@pytest.mark.parametrize("scene", ["square_sea", "radial_sea"])
def test_glints_stand_out_and_nothing_is_clipped(scene: str, chromium: Any, open_tab: Callable[..., Tab]) -> None:
    lab = Viewer("127.0.0.1", 0)
    try:
        lab.open(scene)
        tab = open_tab(lab.port, width=400, height=260, drawn=True, ratio=1.0)
        tab.wait(lambda: lab.view.water is not None and lab.view.water.has_shader is True)
        lab.loop.commands.put(Pause())
        tab.page.add_style_tag(content=NO_NOTES + PANEL_HIDDEN + "#springtide-cover { display: none }")
        tab.page.wait_for_timeout(8000)  # viser fades its canvas in while the sky loads
        picture = np.asarray(Image.open(io.BytesIO(tab.page.screenshot(timeout=120_000))).convert("RGB"))
    finally:
        lab.shut()
    assert (picture == 255).all(axis=-1).mean() < 0.01
    # The lower half is water. sRGB to linear light, as IEC 61966-2-1 has it.
    light = (((picture[len(picture) // 2 + 10 :] / 255 + 0.055) / 1.055) ** 2.4) @ LUMINANCE
    assert np.quantile(light, 0.999) >= 6.0 * np.median(light)
