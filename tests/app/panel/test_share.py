"""The link to a set-up."""

from types import SimpleNamespace

import numpy as np

from app.panel.share import camera_of


def test_a_link_has_the_camera_of_the_browser_that_asks() -> None:
    camera = SimpleNamespace(position=np.array([1.0, 2.0, 3.0]), look_at=np.array([4.0, 5.0, 6.0]))
    assert camera_of(SimpleNamespace(camera=camera)) == ((1.0, 2.0, 3.0), (4.0, 5.0, 6.0))  # type: ignore[arg-type]
