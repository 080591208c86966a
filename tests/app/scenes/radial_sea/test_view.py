"""What the view of the radial sea makes of a frame."""

import dataclasses

import numpy as np
import pytest
import viser

from app.render.material import Material
from app.scenes import scene_named, view_named
from app.scenes.radial_sea.cutaway import DIRECTION
from app.scenes.radial_sea.drawing import cutaway_view
from app.scenes.radial_sea.drawing.cutaway_view import Walls
from app.scenes.radial_sea.drawing.materials import SPILL_RADIUS, material_of
from app.scenes.radial_sea.drawing.moorings_view import LINE_SIDES, NEAR_END, DrawnMoorings, Rods
from app.scenes.radial_sea.parameters import RadialSeaParams
from app.scenes.radial_sea.view import keel_of, offset_of_view


def frame_of(**values: object):
    kind = scene_named("radial_sea")
    return kind.make(dataclasses.replace(kind.params(), **values)).frame()


def test_the_labels_of_the_window_say_what_is_there(server: viser.ViserServer) -> None:
    frame = frame_of(spill="layer", thickness=0.3, cutaway=True, waves=False)
    assert frame.cutaway is not None
    walls = Walls(server, "/cutaway", frame.cutaway)
    keel = keel_of(frame)
    assert keel is not None
    walls.show(frame, keel)
    assert walls.labels["oil"].text == "oil, 866 kg/m³, 0.3 m"
    assert walls.labels["draft"].text == f"lowest point {-keel:.2f} m deep"
    assert walls.labels["water"].text.startswith("water, ")
    heights = [walls.labels[part].position[2] for part in ("oil", "draft", "water")]
    assert heights[0] == pytest.approx(-0.15, abs=0.01)
    assert -np.diff(heights) == pytest.approx(np.array([0.5, 1.0]), abs=0.2)  # no line is over another
    arrow = walls.arrow.points[0]
    assert arrow[:, 2] == pytest.approx([0.0, keel], abs=0.01)
    # They stand before the wall, at ticks of their own heights, and move along with it.
    before = np.asarray(arrow[0, :2]) @ np.array(DIRECTION)
    assert 0.0 < before < 0.2
    assert walls.ruler.position[:2] == pytest.approx(frame.cutaway.middle)
    ticks = np.sort(walls.ruler.points[1:, 0, 2])[::-1]
    assert ticks[:3] == pytest.approx([0.0, -0.1, -0.2])
    walls.show(frame._replace(cutaway=None), None)
    assert not walls.ruler.visible


def test_the_cutaway_has_only_the_lines_of_the_body_beside_it(server: viser.ViserServer) -> None:
    """Others cross it as sticks that hang in the air."""
    moorings = DrawnMoorings(server)
    rod = 2 * LINE_SIDES + 2  # vertices
    for cutaway, bodies in ((True, 1), (False, 3), (True, 1)):
        frame = frame_of(bodies=3, cutaway=cutaway)
        moorings.show(frame)
        assert moorings.rods is not None
        rods = moorings.rods.handle.vertices.reshape(-1, 4, rod, 3)
        fairleads = rods[:, :, NEAR_END].mean(axis=2)
        np.testing.assert_allclose(fairleads, np.repeat(frame.fairleads[:bodies, None], 4, axis=1), atol=1e-4)


def test_rods_are_drawn_anew_for_another_number_of_bodies_or_other_anchors(server: viser.ViserServer) -> None:
    anchors, fairleads = np.zeros((3, 4, 3)), np.ones((2, 3), np.float32)
    rods = Rods(server, anchors, fairleads, 1.0)
    assert rods.are_of(anchors, 2)
    assert not rods.are_of(anchors, 3)
    assert not rods.are_of(anchors.copy(), 2)


@pytest.mark.parametrize("follow", ["first buoy", "cutaway"])
def test_the_larger_the_bodies_the_farther_is_the_camera(follow: str) -> None:
    near, far = (offset_of_view(RadialSeaParams(follow=follow, size=size)) for size in (1.5, 3.0))
    assert far == pytest.approx(2.0 * near)
    assert np.linalg.norm(near[0] - near[1]) == pytest.approx(8.45 if follow == "first buoy" else 4.87, abs=0.05)


@pytest.mark.parametrize("name", ["radial_sea", "square_sea"])
def test_the_lights_of_a_sea_cast_no_shadows(server: viser.ViserServer, name: str) -> None:
    """Each shadow would draw all bodies again in every frame, and the water shows none."""
    kind = scene_named(name)
    view = view_named(name)(server, lambda _: None)
    view.show(kind.make(kind.params()).frame())
    lights = [
        node for node in server.scene._handle_from_node_name.values() if type(node).__name__.endswith("LightHandle")
    ]
    assert lights or name == "square_sea"
    assert not any(light.cast_shadow for light in lights if hasattr(light, "cast_shadow"))


BOX_HEIGHT = 1.6  # of a label, over the height of its letters


@pytest.mark.parametrize("size", [1.0, 1.5, 3.0])
def test_no_label_of_the_window_lies_over_another_however_far_the_camera_is(
    server: viser.ViserServer, size: float
) -> None:
    """Their letters have a height in the scene: what is apart there is apart in the picture."""
    frame = frame_of(spill="layer", thickness=0.2, cutaway=True, waves=False, size=size)
    assert frame.cutaway is not None
    walls = Walls(server, "/cutaway", frame.cutaway)
    walls.show(frame, keel_of(frame))
    nodes = server.scene._handle_from_node_name
    ticks = [node for name, node in nodes.items() if name.startswith("/cutaway/ruler/tick_")]
    for labels in (ticks, list(walls.labels.values())):
        assert all(label.font_size_mode == "scene" for label in labels)
        heights = np.sort([label.position[2] for label in labels])
        assert len(labels) > 2
        assert np.diff(heights).min() > BOX_HEIGHT * max(label.font_scene_height for label in labels)


def test_clear_water_has_no_label_of_oil_and_no_body_has_no_draft(server: viser.ViserServer) -> None:
    frame = frame_of(cutaway=True, waves=False, bodies=0)
    assert frame.cutaway is not None
    walls = Walls(server, "/cutaway", frame.cutaway)
    walls.show(frame, keel_of(frame))
    assert [part for part, label in walls.labels.items() if label.visible] == ["water"]
    assert not walls.arrow.visible


def test_labels_are_written_some_times_a_second_and_at_once_where_the_sea_stands(
    server: viser.ViserServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    frame = frame_of(cutaway=True, waves=False)
    assert frame.cutaway is not None
    walls, clock, step = Walls(server, "/cutaway", frame.cutaway), [100.0], frame.params.time_step
    monkeypatch.setattr(cutaway_view.time, "monotonic", lambda: clock[0])

    def said(at: float, keel: float) -> bool:
        walls.show(frame._replace(time=at), keel)
        assert walls.arrow.points[0, 1, 2] == pytest.approx(keel)  # the arrow is of the picture
        return walls.labels["draft"].text == f"lowest point {-keel:.2f} m deep"

    assert said(0.0, -0.50)
    assert not said(2.0 * step, -0.51)  # runs
    clock[0] += cutaway_view.LABEL_INTERVAL
    assert said(4.0 * step, -0.52)
    assert not said(6.0 * step, -0.53)
    assert said(6.0 * step, -0.53)  # paused
    assert said(7.0 * step, -0.54)  # a single step
    assert said(0.0, -0.55)  # begun again


@pytest.mark.parametrize("name", ["Light crude spill 0.2 m", "Heavy fuel oil", "Entirely mixed", "A day after a spill"])
def test_every_spill_has_an_edge_in_view_with_clean_water_beyond(name: str) -> None:
    presets = scene_named("radial_sea").presets
    frame, light = frame_of(**presets[name]), Material()
    material = material_of(light, frame)
    assert material.slick is not None
    assert material.oil is not None
    assert SPILL_RADIUS <= material.slick.radius < 100.0  # the rig, which is in view, is 111 m away
    assert np.hypot(*frame.positions[:, :2].T).max() < material.slick.radius - 20.0
    assert material.slick.ripple_factor <= 1.0
    assert material.deep_color == light.deep_color
    clean = material_of(light, frame_of(**(presets[name] | {"spill": "none"})))
    assert material.ripple_slope == pytest.approx(clean.ripple_slope, rel=0.01)
    assert not np.allclose(material.seen_color(material.slick.thickness), light.deep_color, atol=0.03)


def test_only_oil_mirrors_less_with_the_lab_s_optics() -> None:
    material = material_of(Material(), frame_of(spill="layer", optics="lab"))
    assert material.reflection_factor == 1.0
    assert material.oil is not None
    assert material.oil.reflection_factor < 1.0


def test_a_crowd_of_bodies_is_within_the_spill() -> None:
    frame = frame_of(spill="layer", bodies=200, waves=False)
    slick = material_of(Material(), frame).slick
    assert slick is not None
    assert np.hypot(*frame.positions[:, :2].T).max() < slick.radius
