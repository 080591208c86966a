"""The stars of a clear night."""

from typing import Any

import numpy as np

from app.render.skies import CAMERA_RANGE, LOWEST_STAR, STAR_COUNT, STAR_DISTANCE, Stars, star_field
from app.scenes.square_sea.parameters import SquareSeaParams
from app.scenes.square_sea.scene import SquareSeaScene
from app.scenes.square_sea.view import OVERCAST_FROM, SquareSeaView


def test_stars_are_above_the_horizon_on_all_sides_and_within_the_picture() -> None:
    points, colours = star_field()
    assert points.shape == colours.shape == (STAR_COUNT, 3)
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), STAR_DISTANCE, rtol=1e-6)
    assert CAMERA_RANGE > STAR_DISTANCE
    elevation = np.degrees(np.arcsin(points[:, 2] / STAR_DISTANCE))
    assert LOWEST_STAR - 1e-3 <= elevation.min() < 6.0
    assert abs(points.mean(axis=0)[:2]).max() < 0.1 * STAR_DISTANCE
    assert colours[elevation < 10.0].max() < 0.5 * colours.max()
    assert np.mean(colours.max(axis=1) > 128) < 0.3  # few are bright


def test_stars_are_made_once_and_hidden_by_day(server: Any) -> None:
    stars = Stars(server)
    stars.show(False)
    assert stars.handle is None
    stars.show(True)
    handle = stars.handle
    assert handle is not None
    for shown in (False, True):
        stars.show(shown)
        assert stars.handle is handle
        assert handle.visible is shown


def test_clouds_hide_the_stars_of_a_sea(server: Any) -> None:
    view = SquareSeaView(server, lambda command: None)
    for sky, clouds, shown in (
        ("night", 0.1, True),
        ("night", OVERCAST_FROM, False),
        ("night", 0.2, True),
        ("park", 0.2, False),
    ):
        view.show(SquareSeaScene(SquareSeaParams(size="64", mesh="32", sky=sky, clouds=clouds)).frame())
        assert (view.stars.handle is not None and view.stars.handle.visible) is shown
