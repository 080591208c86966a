"""The view of the square sea on a viser server without a browser."""

import dataclasses
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import trimesh
import viser
from viser._messages import SetOrientationMessage, SetPositionMessage

from app.formats.formatting import number
from app.formats.round_step import round_step
from app.render.injection import disable_shaders
from app.render.material import blend
from app.render.staff import UPRIGHT_SIDES, upright
from app.scenes.square_sea import rain_view
from app.scenes.square_sea.parameters import RainSettings, SquareSeaParams
from app.scenes.square_sea.quantities import here
from app.scenes.square_sea.scene import SquareSeaScene
from app.scenes.square_sea.view import (
    DRYING_TIME,
    FLOAT_DRAFT,
    FLOAT_RADIUS,
    FLOAT_TOP,
    MAX_RIPPLE_SLOPE,
    OVERCAST_DEEP,
    OVERCAST_FROM,
    OVERCAST_TINT,
    SPAR_TOP,
    SquareSeaView,
    WaveGaugeMesh,
    reach_at,
)


def test_a_closed_view_leaves_no_click_callback_behind(server: viser.ViserServer) -> None:
    for _ in range(3):
        view = SquareSeaView(server, lambda command: None)
        view.show(SquareSeaScene(SquareSeaParams(size="64", mesh="32")).frame())
        assert len(server.scene._scene_pointer_cb) == 1
        view.close()
        server.scene.reset()
        assert server.scene._scene_pointer_cb == []


def test_a_closed_view_keeps_the_callbacks_of_others(server: viser.ViserServer) -> None:
    server.scene.on_click()(lambda event: None)
    SquareSeaView(server, lambda command: None).close()
    assert len(server.scene._scene_pointer_cb) == 1


def test_float_and_spar_of_the_gauge_are_cylinders() -> None:
    vertices, faces = upright(0.4, -1.0, 2.0)
    mesh = trimesh.Trimesh(vertices, faces)
    assert mesh.is_watertight
    half_step = math.pi / UPRIGHT_SIDES
    assert mesh.volume == pytest.approx(3.0 * UPRIGHT_SIDES * 0.4**2 * math.sin(half_step) * math.cos(half_step))
    assert np.hypot(*vertices[: 2 * UPRIGHT_SIDES, :2].T) == pytest.approx(0.4)


@pytest.mark.parametrize(("clouds", "share"), [(0.0, 0.0), (OVERCAST_FROM, 0.0), (1.0, 1.0)])
def test_an_overcast_sky_tints_the_water_grey(server: viser.ViserServer, clouds: float, share: float) -> None:
    view = SquareSeaView(server, lambda _: None)
    frame = SquareSeaScene(SquareSeaParams(size="64", mesh="32", clouds=clouds)).frame()
    view.show(frame)
    material, sky = view.material_of(frame), view.sky_material
    assert material.sky_tint == pytest.approx(blend(sky.sky_tint, OVERCAST_TINT, share))
    assert material.deep_color == pytest.approx(blend(sky.deep_color, OVERCAST_DEEP, share))


def test_drops_fall_as_fast_as_the_root_of_gravity(server: viser.ViserServer, monkeypatch: pytest.MonkeyPatch) -> None:
    """Against their drag, which grows with the square of the speed."""
    made: list[dict[str, tuple[float, ...]]] = []
    monkeypatch.setattr(rain_view, "StreakMesh", lambda *arguments: made.append(arguments[3]))
    frame = SimpleNamespace(drops=np.zeros((10, 3)))
    for gravity in (9.80665, 4.0 * 9.80665):
        settings = RainSettings(5.0, 10, 0.0, (1.0, 2.0), gravity, 64, 1.0)
        rain_view.RainMesh(server, frame, settings, 1.0)  # type: ignore[arg-type]
    first, last = made[0]["dropSizes"], made[-1]["dropSizes"]
    assert last[1] / first[1] == pytest.approx(2.0)
    assert first[1] == pytest.approx(1.0, abs=1e-3)


def test_spray_needs_foam_and_a_wind_of_more_than_beaufort_6(server: viser.ViserServer) -> None:
    for params in (SquareSeaParams(wind_speed=13.8), SquareSeaParams(wind_speed=25.0, foam=False)):
        assert rain_view.spray_settings(params) is None
    gale, storm, hurricane = (
        rain_view.spray_settings(SquareSeaParams(wind_speed=wind, wind_direction=90.0, foam_fade=3.0))
        for wind in (19.0, 26.0, 50.0)
    )
    assert gale is not None
    assert storm is not None
    assert hurricane is not None
    assert 0 < gale.drops < storm.drops == hurricane.drops == rain_view.SPRAY_DROPS
    assert storm.wind == pytest.approx((0.0, 26.0), abs=1e-12)
    # Foam that was full SPRAY_TIME ago: `tile_mesh.set_mesh` fades it so.
    assert storm.least_foam == pytest.approx(math.exp(-rain_view.SPRAY_TIME / 3.0))


@pytest.mark.parametrize("has_shaders", [True, False])
def test_spray_is_shown_only_while_foam_is_fresh(server: viser.ViserServer, has_shaders: bool) -> None:
    if not has_shaders:
        disable_shaders(server)
    view = SquareSeaView(server, lambda command: None)
    scene = SquareSeaScene(SquareSeaParams(size="64", mesh="32", wind_speed=30.0))
    frame = scene.frame()
    limit = math.exp(-rain_view.SPRAY_TIME / scene.params.foam_fade)

    def show(largest: float) -> None:
        foam = np.zeros_like(frame.foam)
        foam[3, 5] = largest
        view.show(frame._replace(foam=foam, vertices=frame.vertices.copy()))

    show(0.99 * limit)
    if not has_shaders:
        assert view.spray is None
        return
    assert view.spray is not None
    spray = view.spray
    assert not spray.mesh.visible
    show(1.01 * limit)
    assert spray.mesh.visible
    assert view.spray is spray
    calm = dataclasses.replace(frame.params, wind_speed=5.0)
    view.show(frame._replace(params=calm, vertices=frame.vertices.copy()))
    assert view.spray is None


def test_the_float_is_wet_up_to_where_water_reached_lately_and_dries(server: viser.ViserServer) -> None:
    gauge = WaveGaugeMesh(server)

    def foot(time: float, reach: float) -> tuple[float, float]:
        """Lower and upper end [m] of the wet part, above the water."""
        gauge.show((3.0, 4.0, 1.5), time, reach)
        part = gauge.parts["foot"]
        low = float(part.batched_positions[0, 2]) - 1.5
        return low, low + float(part.batched_scales[0, 2])  # type: ignore[index]

    assert foot(10.0, 0.04) == pytest.approx((-FLOAT_DRAFT, 0.04), abs=1e-6)
    assert foot(11.0, 0.3)[1] == pytest.approx(0.3, abs=1e-6)
    assert foot(11.0, 0.04)[1] == pytest.approx(0.3, abs=1e-6)  # a pause dries nothing
    assert foot(11.0 + 0.2 * DRYING_TIME, 0.04)[1] == pytest.approx(0.3 - 0.2 * FLOAT_TOP, abs=1e-6)
    assert foot(11.0 + 3.0 * DRYING_TIME, 0.04)[1] == pytest.approx(0.04, abs=1e-6)
    assert foot(12.0, 0.3)[1] == pytest.approx(0.3, abs=1e-6)
    assert foot(0.0, 0.05)[1] == pytest.approx(0.05, abs=1e-6)  # a new run


def test_water_reaches_up_the_float_by_its_slope_and_fresh_foam_wets_all_of_it() -> None:
    frame = SquareSeaScene(SquareSeaParams(size="64", mesh="32", length=64.0, wind_speed=30.0)).frame()
    slopes, foam = np.zeros_like(frame.slopes), np.zeros_like(frame.foam)
    frame = frame._replace(gauge=(20.0, 50.0, 0.0), slopes=slopes, foam=foam)
    level = reach_at(frame)
    slopes[10, 25] = 0.3, -0.4
    assert reach_at(frame) - level == pytest.approx(0.5 * FLOAT_RADIUS)
    slopes[10, 25] = 3.0, 0.0
    assert reach_at(frame) == FLOAT_TOP
    foam[10, 25] = 1.0
    assert reach_at(frame) > FLOAT_TOP
    calm = frame._replace(params=dataclasses.replace(frame.params, wind_speed=5.0))
    assert reach_at(calm) == FLOAT_TOP
    assert reach_at(frame._replace(gauge=None)) == 0.0


def test_another_length_takes_the_cameras_along(server: viser.ViserServer) -> None:
    view = SquareSeaView(server, lambda command: None)
    scene = SquareSeaScene(SquareSeaParams(size="64", mesh="32", length=64.0))
    view.show(scene.frame())
    camera = server.initial_camera
    camera.position, camera.look_at = (30.0, 20.0, 5.0), (40.0, 20.0, 3.0)
    scene.params = SquareSeaParams(size="64", mesh="32", length=128.0)
    scene.reset()
    view.show(scene.frame())
    np.testing.assert_allclose(camera.position, (62.0, 52.0, 5.0))
    np.testing.assert_allclose(camera.look_at, (72.0, 52.0, 3.0))


def test_the_wave_gauge_moves_with_the_vertices_of_the_water_and_not_as_a_node(server: viser.ViserServer) -> None:
    """viser's page draws new vertices, and instances of a batch, frames after it has moved a node."""
    view, scene = (
        SquareSeaView(server, lambda command: None),
        SquareSeaScene(SquareSeaParams(size="64", mesh="32", plot_wave_gauge=True)),
    )
    scene.advance(1)
    view.show(scene.frame())
    sent: list[Any] = []
    server._websock_server.queue_message = sent.append  # type: ignore[method-assign]
    scene.advance(30)
    frame = scene.frame()
    view.show(frame)
    assert frame.gauge is not None
    changes = {message.name: message.updates for message in sent if hasattr(message, "updates")}
    for part in ("spar", "float", "ball"):  # the foot's place depends on its height
        np.testing.assert_allclose(changes[f"/gauge/{part}"]["batched_positions"], [frame.gauge], atol=1e-5)
    assert not any(isinstance(message, SetPositionMessage | SetOrientationMessage) for message in sent)


@pytest.mark.parametrize("wind", [2.0, 8.0, 30.0])
def test_ripples_have_the_slope_that_the_mesh_lacks_up_to_a_bound(server: viser.ViserServer, wind: float) -> None:
    view = SquareSeaView(server, lambda command: None)
    view.show(SquareSeaScene(SquareSeaParams(size="64", mesh="32", wind_speed=wind, length=400.0)).frame())
    assert view.last is not None
    cox_munk = min(0.003, 0.0015 * wind) + 0.00512 * wind
    missing = cox_munk - view.last.slope_resolved - 2.0 * view.sky_material.roughness**2
    assert missing > 0.001
    assert view.material.ripple_slope == pytest.approx(min(math.sqrt(missing), MAX_RIPPLE_SLOPE), abs=5e-4)
    assert (view.material.ripple_slope == MAX_RIPPLE_SLOPE) is (wind == 30.0)


def test_a_nonlinear_sea_has_a_staff_beside_which_its_camera_stands(server: viser.ViserServer) -> None:
    params = SquareSeaParams(size="64", mesh="32", order=3, start="rogue", view="gauge", length=800.0, wind_speed=15.0)
    view, scene = SquareSeaView(server, lambda command: None), SquareSeaScene(params)
    view.show(scene.frame())
    staff, (x, y) = view.staff, scene.gauge.at
    assert view.gauge is None
    assert staff is not None
    hs = here(params).height
    bands = staff.handles[0]
    feet, band = bands.batched_positions, bands.vertices[:, 2].max()
    np.testing.assert_allclose(feet[:, :2], np.broadcast_to((x, y), (len(feet), 2)), rtol=1e-6)
    assert band == pytest.approx(round_step(hs / 3.0))
    assert feet[:, 2].min() < -1.5 * hs
    assert feet[:, 2].max() + band > 2.0 * hs
    texts = {label.text: label.position[2] for label in staff.handles[2:]}
    assert texts.pop("still water") == 0.0
    assert all(number(height) + " m" == text for text, height in texts.items())
    (eye_x, eye_y, eye_z), target = view.first_view(params)
    assert target == (x, y, 0.5 * hs)
    assert math.hypot(eye_x - x, eye_y - y) == pytest.approx(math.hypot(2.0, 6.0) * hs)
    assert eye_z > 0.5 * hs
    scene.change_forces(dataclasses.replace(params, order=1, start="as set"))
    scene.reset()
    view.show(scene.frame())
    assert view.staff is None
    assert view.gauge is not None


def test_the_parts_of_the_wave_gauge_stand_on_one_another(server):
    spar, float_, ball = (
        part.batched_positions[0] + part.vertices for part in list(WaveGaugeMesh(server).parts.values())[:3]
    )
    assert (spar[:, 2].min(), spar[:, 2].max()) == pytest.approx((-1.2, SPAR_TOP))
    assert float_[:, 2].min() == pytest.approx(-0.1)  # in the water
    assert 0.0 < float_[:, 2].max() < SPAR_TOP
    assert np.hypot(*float_[:, :2].T).max() > 2.0 * np.hypot(*spar[:, :2].T).max() > 0.0
    assert ball.mean(axis=0) == pytest.approx((0.0, 0.0, SPAR_TOP), abs=0.05)
