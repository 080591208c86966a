"""The radial scene in a real browser: every preset as water, a buoy dragged under, oil poured on."""

from typing import Any

import numpy as np
import pytest

from app.messages import Pause, Play, Reset
from app.render.material import WATER_UNIFORMS
from app.scenes.radial_sea.parameters import PRESETS
from app.server.viewer import Viewer
from tests.browser.conftest import LATE_UPDATE, Tab

SCENE = "radial_sea"


def uniform(tab: Tab, name: str) -> np.ndarray:
    """Three numbers of the page's material."""
    return tab.vertices("/sea/water_material")[WATER_UNIFORMS.index(name)]


def drawn(lab: Viewer) -> bool:
    """Check that the sea is drawn as water, and moves."""
    return lab.view.water is not None and lab.view.water.has_shader is True and lab.scene.time > 0.3


def load(lab: Viewer, **changes: Any) -> None:
    """Set parameters as the panel would."""
    for name, value in changes.items():
        lab.settings.set(name, value)


@pytest.mark.stress  # half a minute of drawing in software
def test_a_burning_rig_has_flames_and_a_slick(lab: Viewer, open_tab) -> None:
    lab.settings.load("Burning rig")
    tab = open_tab(lab.port, width=420, height=260, drawn=True)
    tab.wait(lambda: drawn(lab))
    tab.wait(lambda: lab.view.flames is not None and lab.view.flames.handle.visible)
    tab.wait(lambda: lab.view.material.slick is not None and lab.view.material.slick.radius > 3.0)
    tab.wait(lambda: uniform(tab, "slick")[2] > 3.0)
    # The picture is shifted towards the area that the panel leaves free, with the flames.
    splats, camera = tab.page.evaluate(
        """() => {
          const { scene, camera } = window.__viserMutable;
          let found = null;
          scene.traverse((one) => { found = one.material?.uniforms?.projectionMatrixCustom ?? found; });
          return [found.value.elements, camera.projectionMatrix.elements];
        }"""
    )
    assert abs(camera[8]) + abs(camera[9]) > 0.05
    assert splats == camera
    assert tab.errors == []


@pytest.mark.long
@pytest.mark.parametrize("presets", [list(PRESETS)[::5], pytest.param(list(PRESETS), marks=pytest.mark.stress)])
def test_every_preset_is_drawn_as_water_without_console_errors(shown: tuple[Viewer, Tab], presets: list[str]) -> None:
    lab, tab = shown
    for preset in presets:
        lab.settings.load(preset)
        tab.wait(lambda: lab.scene.params == lab.settings.params)
        tab.wait(lambda: drawn(lab) and len(tab.vertices("/sea")) == len(lab.scene.grid))
        first = tab.vertices("/sea")
        tab.wait(lambda first=first: np.abs(tab.vertices("/sea") - first).max() > 0.02)
        assert np.isfinite(tab.vertices("/sea")).all()
        assert lab.loop.run.halted == "", preset
        assert [error for error in tab.errors if LATE_UPDATE not in error] == [], preset


def test_a_window_shows_the_interface_and_the_camera_goes_along(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    load(lab, spill="layer", thickness=0.4, cutaway=True, follow="cutaway", rings=32, spokes=32, bodies=1)
    lab.loop.commands.put(Reset())
    tab.wait(lambda: drawn(lab))
    tab.wait(lambda: len(tab.vertices("/cutaway")) > 0)
    tab.wait(lambda: lab.view.walls.mesh.has_shader is True)
    n = (len(tab.vertices("/cutaway")) - 1) // 4

    def thickness() -> float:
        walls = tab.vertices("/cutaway")
        return float((walls[:n, 2] - walls[n : 2 * n, 2]).mean())

    tab.wait(lambda: abs(thickness() - 0.4) < 0.05)

    def beside() -> float:
        """Distance of the page's camera from its place beside the buoy [m]."""
        (client,) = lab.server.get_clients().values()
        wanted = lab.scene.bodies.fleet.position[0, :2] + lab.view.follow_camera.start_offset[0, :2]
        return float(np.abs(np.asarray(client.camera.position)[:2] - wanted).max())

    lab.loop.commands.put(Pause())
    tab.wait(lambda: not lab.loop.run.running)
    fleet = lab.scene.bodies.fleet
    before = fleet.position[0, :2].copy()
    fleet.velocity[0] = (3.0, 2.0, 0.0)
    lab.loop.commands.put(Play())
    tab.wait(lambda: np.hypot(*(fleet.position[0, :2] - before)) > 1.0)
    tab.wait(lambda: beside() < 0.5)
    assert tab.errors == []


@pytest.mark.long
def test_a_buoy_dragged_under_bobs_back(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    load(lab, waves=False, rig=False, rings=32, spokes=32)
    lab.loop.commands.put(Reset())
    tab.wait(lambda: drawn(lab))
    lab.loop.commands.put(Pause())
    tab.wait(lambda: not lab.loop.run.running)
    rest = lab.scene.bodies.fleet.position[0].copy()
    tab.page.mouse.move(*tab.pixel(rest))
    lab.loop.commands.put(Play())
    place = lambda: tab.pixel(lab.scene.bodies.fleet.position[0])  # noqa: E731
    tab.hold(place, (0, 110), lambda: bool(lab.scene.bodies.pulls), pause=100)
    tab.wait(lambda: lab.scene.bodies.fleet.position[0, 2] < rest[2] - 0.15)
    tab.release()
    tab.wait(lambda: not lab.scene.bodies.pulls)
    tab.wait(lambda: abs(lab.scene.bodies.fleet.position[0, 2] - rest[2]) < 0.02)
    assert tab.errors == []


@pytest.mark.long
def test_oil_darkens_the_water_and_bodies_settle_to_the_readout(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    load(lab, waves=False, rig=False, rings=32, spokes=32, ripples=False)
    lab.loop.commands.put(Reset())
    tab.wait(lambda: drawn(lab))

    def blue() -> float:
        """Blue light from below by the numbers that the page holds."""
        through = np.exp(-uniform(tab, "oilExtinction") * uniform(tab, "slickOptics")[0])
        return float((through * uniform(tab, "deepColor") + (1.0 - through) * uniform(tab, "oilColor"))[2])

    tab.wait(lambda: len(tab.vertices("/sea/water_material")) > 0)
    clear = blue()
    load(lab, spill="layer", thickness=0.3, speed=4.0)
    tab.wait(lambda: blue() < 0.3 * clear)
    theory = lab.scene.readings().bodies[0].prediction
    tab.wait(lambda: np.abs(lab.scene.bodies.meters.draft - theory.draft).max() < 2e-3)
    assert (lab.scene.bodies.meters.draft > theory.draft_in_water + 0.03).all()
    tab.wait(lambda: tab.page.get_by_text(f"{theory.draft:.3f}").count() > 0)
    assert tab.errors == []
