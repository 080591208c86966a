"""The square sea in a real browser."""

from typing import Any

import numpy as np
import pytest

from app.scenes.square_sea.rain_view import SPRAY_DROPS
from app.scenes.square_sea.scene import SquareSeaParams
from app.server.viewer import Viewer
from tests.browser.conftest import Tab

SCENE = "square_sea"
PARAMS = SquareSeaParams(size="64", mesh="32", length=64.0)  # a small sea, in place of the scene's own


def set_parameters(viewer: Viewer, **values: Any) -> None:
    """Set parameters through the controls of the panel, as a browser does."""
    for name, value in values.items():
        viewer.panel.controls[name].set(value)


def has_shader(lab: Viewer) -> bool:
    water = lab.view.water
    return water is not None and water.has_shader is True


def heights(tab: Any) -> np.ndarray:
    return tab.vertices("/sea")[:, 2]


@pytest.mark.stress  # compiles the sea's shaders again, as test_water does
def test_the_water_has_its_shader_moves_and_leaves_no_console_errors(lab: Viewer, open_tab) -> None:
    tab = open_tab(lab.port, width=420, height=260, drawn=True)
    tab.wait(lambda: has_shader(lab))
    first = heights(tab)
    assert len(first) == 33 * 33
    tab.wait(lambda: np.abs(heights(tab) - first).max() > 0.1)
    assert np.isfinite(tab.vertices("/sea")).all()
    assert tab.errors == []


def test_the_wind_changes_the_sea_and_a_calm_flattens_it(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    tab.wait(lambda: has_shader(lab))
    rough = heights(tab).std()
    set_parameters(lab, transition=0.2, wind_speed=2.0)
    tab.wait(lambda: heights(tab).std() < 0.3 * rough)
    assert tab.errors == []


def test_the_table_of_the_sky_is_drawn_where_the_sky_changes_and_not_where_the_waves_do(
    shown: tuple[Viewer, Tab],
) -> None:
    lab, tab = shown
    tab.wait(lambda: has_shader(lab))

    def drawn() -> int:
        return tab.page.evaluate("window.__springtide.skiesDrawn")

    def still() -> bool:
        before = drawn()
        tab.page.wait_for_timeout(1000)
        return before == drawn() > 0

    tab.wait(still)
    count, first = drawn(), heights(tab)
    set_parameters(lab, transition=0.5, wind_speed=15.0)
    tab.wait(lambda: heights(tab).std() > 1.5 * first.std())
    assert drawn() == count
    set_parameters(lab, clouds=1.0)  # they tint the photograph
    tab.wait(lambda: drawn() > count)
    assert tab.errors == []


def test_rain_draws_drops_and_makes_rings(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    tab.wait(lambda: has_shader(lab))
    set_parameters(lab, length=32.0, size="128", transition=0.0, wind_speed=0.0, rain=50.0, drops=400)
    tab.wait(lambda: len(tab.vertices("/rain/drops")) == 4 * 400)
    # Without wind there is no other wave.
    tab.wait(lambda: lab.scene.counts["rings"] > 20 and heights(tab).std() > 1e-4)
    set_parameters(lab, rain=0.0)
    tab.wait(lambda: len(tab.vertices("/rain/drops")) == 0)
    assert tab.errors == []


def test_breaking_crests_in_a_storm_throw_spray_which_people_who_want_less_motion_do_not_see(
    shown: tuple[Viewer, Tab],
) -> None:
    lab, tab = shown
    tab.wait(lambda: has_shader(lab))

    def drawn() -> int:
        mesh = "window.__viserMutable.nodeRefFromName['/spray']?.children.find((child) => child.isMesh)"
        return tab.page.evaluate(f"{mesh}?.parent.visible ? {mesh}.geometry.drawRange.count : 0")

    assert drawn() == 0
    set_parameters(lab, transition=0.0, wind_speed=30.0)
    tab.wait(lambda: 9 < drawn() <= 9 * SPRAY_DROPS)
    material = "window.__viserMutable.nodeRefFromName['/spray'].children.find((child) => child.isMesh).material"
    assert tab.page.evaluate(f"{material}.userData.springtide").startswith("springtide-rain/spray")
    assert tab.page.evaluate(f"{material}.depthWrite") is False
    tab.page.emulate_media(reduced_motion="reduce")
    tab.wait(lambda: drawn() == 0)
    tab.page.emulate_media(reduced_motion="no-preference")
    tab.wait(lambda: drawn() > 9)
    set_parameters(lab, foam=False)
    tab.wait(lambda: drawn() == 0)
    assert tab.errors == []


def test_a_click_on_the_water_places_the_wave_gauge(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    tab.wait(lambda: has_shader(lab))
    first = lab.loop.latest.frame.gauge
    tab.page.mouse.click(300, 480)
    x, y, z = tab.wait(lambda: (gauge := lab.loop.latest.frame.gauge)[:2] != first[:2] and gauge)
    (client,) = lab.server.get_clients().values()
    assert np.hypot(x - client.camera.position[0], y - client.camera.position[1]) < 64.0
    assert np.isfinite(z)
    set_parameters(lab, plot_wave_gauge=True)
    tab.page.wait_for_selector(".uplot", state="attached", timeout=120_000)  # too small a window to show it
    assert tab.errors == []
