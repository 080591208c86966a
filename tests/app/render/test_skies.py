"""The stars of a clear night."""

from typing import Any

import numpy as np

from app.render.skies import CAMERA_RANGE, LOWEST_STAR, NIGHT, STAR_COUNT, STAR_DISTANCE, Sky, star_field
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
    sky = Sky(server)
    sky.show_stars(is_clear=True)
    sky.set("park", 0.0)
    sky.show_stars(is_clear=True)
    assert sky.stars is None
    sky.set(NIGHT, 0.0)
    sky.show_stars(is_clear=True)
    stars = sky.stars
    assert stars is not None
    for name in ("dawn", NIGHT):
        sky.set(name, 0.0)
        sky.show_stars(is_clear=True)
        assert sky.stars is stars
        assert stars.visible is (name == NIGHT)


def test_clouds_hide_the_stars_of_a_sea(server: Any) -> None:
    view = SquareSeaView(server, lambda command: None)
    for sky, clouds, shown in (
        ("night", 0.1, True),
        ("night", OVERCAST_FROM, False),
        ("night", 0.2, True),
        ("park", 0.2, False),
    ):
        view.show(SquareSeaScene(SquareSeaParams(size="64", mesh="32", sky=sky, clouds=clouds)).frame())
        assert (view.sky.stars is not None and view.sky.stars.visible) is shown
