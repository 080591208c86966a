"""The mooring in pixels: sky above a sea to the horizon, and under it the lit bed amid deep water."""

import io
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from app.messages import Pause
from app.scenes.mooring.parameters import MooringParams
from app.server.viewer import Viewer
from tests.browser.conftest import LATE_UPDATE, NO_NOTES, Tab
from tests.browser.water.test_water import PANEL_HIDDEN

FILES = Path(__file__).parents[2] / "sim/mooring/moordyn/files"


@pytest.mark.long
def test_open_water_lies_around_the_mooring(open_tab: Callable[..., Tab]) -> None:
    lab = Viewer("127.0.0.1", 0)
    try:
        lab.open("mooring")
        tab = open_tab(lab.port, width=400, height=260, drawn=True, ratio=1.0)
        tab.wait(lambda: lab.view.drawn is not None)
        drawn = lab.view.drawn
        tab.wait(lambda: drawn.water.surface.has_shader is True and drawn.bed.sand.has_shader is True)
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


@pytest.mark.long
def test_the_shadow_on_the_bed_is_that_of_the_body_where_it_is(open_tab: Callable[..., Tab]) -> None:
    still = {"wave_height": 0.0, "watch": False, "handles": False, "steady_force": 300.0}
    lab = Viewer("127.0.0.1", 0)
    try:
        lab.open("mooring", MooringParams(direction=30.0, **still), paused=True)
        tab = open_tab(lab.port, width=400, height=400, drawn=True, ratio=1.0)
        tab.wait(lambda: lab.view.drawn is not None)
        drawn = lab.view.drawn
        tab.wait(lambda: drawn.water.surface.has_shader is True and drawn.bed.sand.has_shader is True)
        tab.page.add_style_tag(content=NO_NOTES + PANEL_HIDDEN + "#springtide-cover { display: none }")
        tab.page.wait_for_timeout(3000)
        x, y, _ = lab.loop.latest.frame.body.tolist()
        # The sun stands over +y, a little towards -x (js/sea/open_water.js): the shadow falls the other way.
        depth = lab.loop.latest.params.depth
        places = [(x + 0.12 * depth, y - 0.31 * depth), (0.12 * depth, -0.31 * depth), (0.5 * x, -0.7 * depth)]
        pixels = [tab.pixel((*place, -depth)) for place in places]
        picture = np.asarray(Image.open(io.BytesIO(tab.page.screenshot())).convert("RGB")).astype(float)
    finally:
        lab.shut()
    assert x > 5.0
    assert y > 3.0
    shadow, *lit = (picture[round(v) - 2 : round(v) + 3, round(u) - 2 : round(u) + 3].mean() for u, v in pixels)
    assert shadow < 0.8 * min(lit)


@pytest.mark.long
def test_the_mooring_of_a_file_is_drawn_and_its_vessel_is_dragged(open_tab: Callable[..., Tab]) -> None:
    lab = Viewer("127.0.0.1", 0)
    try:
        lab.open("mooring", MooringParams(moordyn_file=str(FILES / "shared_line.txt"), wave_height=0.0, time_step=4e-3))
        tab = open_tab(lab.port)
        tab.wait(lambda: lab.view.built and len(tab.vertices("/line_3")) > 0)
        assert len(lab.view.drawn.lines.tubes) == 3
        assert len(lab.view.drawn.ends.anchors.batched_positions) == 2
        assert len(lab.view.drawn.ends.fairleads.batched_positions) == 4
        assert not any(gizmo.handle.visible for gizmo in lab.view.gizmos.values())
        tab.wait(lambda: lab.loop.scene.readings().most_offset == 0.0)
        tab.hold(lambda: tab.pixel(lab.loop.scene.middle), (-60, 0), lambda: lab.loop.scene.readings().offset > 0.02)
        tab.wait(lambda: lab.loop.scene.readings().offset > 0.2)
        errors = tab.errors
    finally:
        lab.shut()
    assert errors == []


@pytest.mark.long
def test_files_without_a_vessel_or_without_anchors_are_drawn(tmp_path: Path, open_tab: Callable[..., Tab]) -> None:
    path = tmp_path / "hanging.txt"
    text = (FILES / "stiff_cable.txt").read_text(encoding="utf-8")
    path.write_text(text.replace("Coupled", "Fixed"), encoding="utf-8")
    lab = Viewer("127.0.0.1", 0)
    try:
        lab.open("mooring", MooringParams(moordyn_file=str(path), time_step=2e-4))
        tab = open_tab(lab.port)
        tab.wait(lambda: lab.view.built and len(tab.vertices("/line_1")) > 0)
        assert not lab.view.drawn.body.handle.visible
        tab.wait(lambda: lab.loop.scene.time > 0.1)
        assert lab.loop.scene.readings().most_offset == 0.0
        lab.open("mooring", MooringParams(moordyn_file=str(FILES / "hanging_body.txt"), time_step=5e-4))
        tab.wait(lambda: lab.view.built and len(tab.vertices("/line_2")) > 0)
        assert lab.view.drawn.body.handle.visible
        # Two on the vessel, and the body's with that of its drag.
        assert len(lab.view.drawn.ends.fairleads.batched_positions) == 4
        errors = [error for error in tab.errors if LATE_UPDATE not in error]
    finally:
        lab.shut()
    assert errors == []
