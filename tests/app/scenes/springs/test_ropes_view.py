"""Rope and race on a viser server without a browser: what both views draw of ropes."""

import dataclasses
import math
from collections.abc import Iterator
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest
import viser

from app.messages import GrabTo, Release
from app.render.colormap import css_scale
from app.render.handles.dragging import GRAB_COLOUR
from app.scenes.race.parameters import RaceParams
from app.scenes.race.scene import RaceScene
from app.scenes.race.view import RaceView
from app.scenes.rope.parameters import RopeParams
from app.scenes.rope.scene import RopeScene
from app.scenes.rope.view import LOWER, RopeView
from app.scenes.springs.drawing.html import colour_scale
from app.scenes.springs.drawing.ropes_view import bead_radius
from app.scenes.springs.drawing.view import SecondNet, Sphere
from app.scenes.springs.net_motion import rope_lengths
from app.scenes.springs.rope_handles import offset_of
from app.scenes.springs.rope_parameters import ROOT, build_rope

RaceDrawing: Any = RaceView  # whose types the tests know


@pytest.fixture(scope="module")
def server() -> Iterator[viser.ViserServer]:
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield server
    server.stop()


@pytest.fixture(params=[(RopeScene, RopeParams, RopeView), (RaceScene, RaceParams, RaceView)], ids=["rope", "race"])
def shown(request: pytest.FixtureRequest, server: viser.ViserServer) -> Iterator[tuple[Any, Any]]:
    """A scene, and its view that has shown a frame."""
    kind, params, view_of = request.param
    scene, view = kind(params()), view_of(server, lambda command: None)
    view.show(scene.frame())
    yield scene, view
    server.scene.reset()


def grabbed_beads(colours: np.ndarray) -> list[int]:
    """The beads in the colour of a grabbed one."""
    return np.flatnonzero((colours == GRAB_COLOUR).all(axis=1)).tolist()


def test_the_grabbed_bead_is_drawn_in_a_colour_of_its_own(shown: tuple[Any, Any]) -> None:
    scene, view = shown
    scene.handle(GrabTo(7, (0.0, 0.0, 2.0)))
    scene.advance(1)
    view.show(scene.frame())
    assert grabbed_beads(view.ropes.beads.batched_colors) == [7]
    scene.handle(Release())
    view.show(scene.frame())
    assert grabbed_beads(view.ropes.beads.batched_colors) == []


def test_beads_line_of_the_grab_and_picking_have_the_points_as_drawn(shown: tuple[Any, Any]) -> None:
    scene, view = shown
    scene.handle(GrabTo(7, (0.0, 0.0, 2.0)))
    scene.advance(5)
    frame = scene.frame()
    view.show(frame)
    points = (frame.ropes if isinstance(view, RaceView) else frame.points).reshape(-1, 3)
    for drawn in (view.points, view.ropes.beads.batched_positions):
        np.testing.assert_array_equal(drawn, points)
    np.testing.assert_array_equal(view.grab.line.points[0, 0], points[7])


def test_another_number_of_points_makes_other_nodes(shown: tuple[Any, Any]) -> None:
    scene, view = shown
    scene.params = dataclasses.replace(scene.params, points=23)
    scene.reset()
    view.show(scene.frame())
    ropes = getattr(scene.params, "ropes", 1)
    assert len(view.ropes.beads.batched_positions) == 23 * ropes == len(view.points)
    assert all(mesh.faces.max() + 1 == len(mesh.vertices) for mesh in view.ropes.meshes)


def test_a_grabbed_bead_of_a_race_stays_dark_for_a_browser_with_a_dark_floor(
    server: viser.ViserServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[Any] = []
    client: Any = Mock(client_id=3)
    client._websock_connection.queue_message = told.append
    scene, view = RaceScene(RaceParams()), RaceDrawing(server, lambda command: None)
    view.show(scene.frame())
    monkeypatch.setattr(server, "get_clients", lambda: {3: client})
    view.set_dark(client, True)
    scene.handle(GrabTo(7, (0.0, 0.0, 2.0)))
    view.show(scene.frame())
    colours = next(m.updates["batched_colors"] for m in reversed(told) if "batched_colors" in getattr(m, "updates", ()))
    assert grabbed_beads(colours) == [7]
    others = np.delete(colours, 7, axis=0)
    np.testing.assert_array_equal(others, np.delete(view.ropes.bead_colours(dark=True), 7, axis=0))
    server.scene.reset()


def test_a_rope_that_has_stopped_is_drawn_where_another_spacing_puts_it(server: viser.ViserServer) -> None:
    scene, view = RaceScene(RaceParams(ropes=2, integrator_2="pefrl")), RaceDrawing(server, lambda command: None)
    scene.advance(3)
    assert scene.frame().failed == (False, True)
    view.show(scene.frame())
    scene.params = dataclasses.replace(scene.params, spacing=1.5)
    view.show(scene.frame())
    for number, mesh in enumerate(view.ropes.meshes):
        assert mesh.vertices[:, 1].mean() == pytest.approx(offset_of(number, 2, 1.5), abs=1e-3)
    assert [mesh.opacity for mesh in view.ropes.meshes] == [None, 0.35]
    server.scene.reset()


def test_a_sphere_is_hidden_until_there_is_one(server: viser.ViserServer) -> None:
    sphere = Sphere(server, lambda _: None, 0.3, 0.1)
    assert not sphere.ball.visible
    for place in ((1.0, 2.0, 3.0, 0.5), None):
        sphere.show(place, None)
        assert sphere.ball.visible is (place is not None)


@pytest.mark.parametrize("floor", [True, False])
def test_the_first_view_of_a_long_rope_ends_at_the_floor(floor: bool) -> None:
    params = RopeParams(length=12.0, floor=floor)
    position, target = map(np.array, RopeView.first_view(object.__new__(RopeView), params))
    height = 2.0 * float(np.linalg.norm(position - target)) * math.tan(0.5 * RopeView.FIELD_OF_VIEW)
    fall = ROOT[2] if floor else sum(rope_lengths(build_rope(params)))
    assert target[2] == pytest.approx(ROOT[2] - 0.5 * fall - LOWER * height)
    assert target[2] - 0.5 * height < (0.0 if floor else ROOT[2] - 12.0)
    assert target[2] + 0.5 * height > ROOT[2]


def test_a_scale_has_its_colours_light_and_dark() -> None:
    text = colour_scale("0", "strain", "4 %", clipped=True)
    for dark in (False, True):
        assert f"--{'dark' if dark else 'light'}-scale:{css_scale(dark=dark)}" in text
    assert css_scale(dark=True) != css_scale(dark=False)
    assert "4 % and more" in text


def test_beads_are_a_part_of_their_spacing_within_bounds_of_the_rope() -> None:
    def radius(spacing: float) -> float:
        return bead_radius(spacing * np.arange(5.0)[:, None] * np.array([0.0, 0.6, 0.8]), 0.02)

    assert radius(0.05) == pytest.approx(0.02)
    assert radius(0.09) == pytest.approx(0.036)
    assert radius(1.0) == pytest.approx(1.9 * 0.02)
    assert radius(1e-4) == pytest.approx(0.5 * 0.02)
    assert bead_radius(np.zeros((1, 3)), 0.02) == pytest.approx(0.01)


def test_of_a_second_net_that_is_hidden_the_labels_are_too(server: viser.ViserServer) -> None:
    net = SecondNet(server, "/second", "yours", color=(1, 2, 3))
    vertices, faces = np.eye(3), np.array([[0, 1, 2]])
    for _ in range(2):
        net.show(vertices, faces, vertices[0], vertices[1])
        assert [label.visible for label in net.labels] == [True, True]
        assert [tuple(label.position) for label in net.labels] == [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)]
        net.hide()
        assert [label.visible for label in net.labels] == [False, False]
