"""The view of the square sea on a viser server without a browser."""

from collections.abc import Iterator

import numpy as np
import pytest
import viser

from app.scenes.square_sea.parameters import Params
from app.scenes.square_sea.scene import SquareSeaScene
from app.scenes.square_sea.view import View


@pytest.fixture
def server() -> Iterator[viser.ViserServer]:
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield server
    server.stop()


def test_a_closed_view_leaves_no_click_callback_behind(server: viser.ViserServer) -> None:
    for _ in range(3):
        view = View(server, lambda command: None)
        view.show(SquareSeaScene(Params(size="64", mesh="32")).frame())
        assert len(server.scene._scene_pointer_cb) == 1
        view.close()
        server.scene.reset()
        assert server.scene._scene_pointer_cb == []


def test_a_closed_view_keeps_the_callbacks_of_others(server: viser.ViserServer) -> None:
    server.scene.on_click()(lambda event: None)
    View(server, lambda command: None).close()
    assert len(server.scene._scene_pointer_cb) == 1


def test_another_length_takes_the_cameras_along(server: viser.ViserServer) -> None:
    view = View(server, lambda command: None)
    scene = SquareSeaScene(Params(size="64", mesh="32", length=64.0))
    view.show(scene.frame())
    camera = server.initial_camera
    camera.position, camera.look_at = (30.0, 20.0, 5.0), (40.0, 20.0, 3.0)
    scene.params = Params(size="64", mesh="32", length=128.0)
    scene.reset()
    view.show(scene.frame())
    np.testing.assert_allclose(camera.position, (62.0, 52.0, 5.0))
    np.testing.assert_allclose(camera.look_at, (72.0, 52.0, 3.0))
