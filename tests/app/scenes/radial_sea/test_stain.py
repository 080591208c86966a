"""The stain that oil leaves on the bodies of the radial sea: how high it reaches, and its mesh."""

import numpy as np
import pytest
import viser

from app.scenes.radial_sea.drawing.stain_view import SKIN, Stains, stain_of
from app.scenes.radial_sea.parameters import RadialSeaParams
from app.scenes.radial_sea.scene import RadialSeaScene
from sim.parameters import check_record


def scene_with(**changes) -> RadialSeaScene:
    return RadialSeaScene(check_record(RadialSeaParams, {"rig": False, "ripples": False, **changes}))


def test_a_stain_reaches_to_the_deepest_that_a_body_has_been_in_oil_and_stays() -> None:
    scene = scene_with(spill="layer", thickness=0.2, wind_speed=12.0)
    deepest = np.zeros(scene.bodies.count)
    for _ in range(120):
        scene.advance(1)
        deepest = np.maximum(deepest, scene.bodies.meters.draft)
    np.testing.assert_allclose(scene.bodies.meters.stain, deepest)
    assert (scene.bodies.meters.stain > scene.bodies.meters.draft.min() + 0.01).all()
    np.testing.assert_allclose(scene.frame().stains, deepest, rtol=1e-6)
    scene.bodies.set_fluids(500.0, scene_with().column)  # the oil is taken away
    scene.advance(30)
    np.testing.assert_allclose(scene.bodies.meters.stain, deepest)


def test_clean_water_leaves_no_stain() -> None:
    scene = scene_with()
    scene.advance(60)
    assert not scene.bodies.meters.stain.any()


def test_the_skin_lies_on_the_hull_up_to_its_height() -> None:
    for hull in scene_with().bodies.hulls.values():
        vertices, faces = stain_of(hull.vertices, hull.faces, 0.3)
        low = float(hull.vertices[:, 2].min())
        assert vertices[:, 2].min() == pytest.approx(low, abs=1e-5)
        assert vertices[:, 2].max() == pytest.approx(low + 0.3, abs=1e-5)
        assert faces.max() < len(vertices)
        rim = vertices[np.isclose(vertices[:, 2], low + 0.3, atol=1e-5), :2] / SKIN
        if hull.shape.is_round:
            radius = -low
            circle = np.sqrt(radius**2 - (radius - 0.3) ** 2)
            np.testing.assert_allclose(np.hypot(*rim.T), circle, rtol=0.02)


def test_stains_are_drawn_grow_and_go_with_a_new_beginning(server: viser.ViserServer) -> None:
    scene = scene_with(spill="layer", thickness=0.2)
    scene.advance(30)
    stains, frame = Stains(server), scene.frame()
    stains.show(frame)
    assert len(stains.drawn) == len(frame.positions)
    top = stains.drawn[0][0].vertices[:, 2].max()
    stains.show(frame._replace(stains=frame.stains + np.float32(0.1)))
    assert stains.drawn[0][0].vertices[:, 2].max() == pytest.approx(top + 0.1, abs=1e-5)
    stains.show(frame._replace(stains=0.0 * frame.stains))
    assert stains.drawn == {}
