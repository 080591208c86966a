"""The cameras of all browsers."""

from collections.abc import Iterator

import viser

from app.messages import Vector

Camera = viser.CameraHandle | viser.InitialCameraConfig


def all_cameras(server: viser.ViserServer) -> Iterator[Camera]:
    """The camera of each connected browser, and the one that a new browser starts with."""
    yield server.initial_camera
    for client in server.get_clients().values():
        yield client.camera


def place_cameras(
    server: viser.ViserServer, position: Vector, target: Vector, field_of_view: float | None = None
) -> None:
    """Place every camera at `position` [m], looking at `target` [m]; field_of_view: vertical [rad], None to keep it."""
    for camera in all_cameras(server):
        place_camera(camera, position, target, field_of_view)


def place_camera(camera: Camera, position: Vector, target: Vector, field_of_view: float | None = None) -> None:
    """The same for one camera."""
    camera.position, camera.look_at = position, target
    if field_of_view is not None:
        camera.fov = field_of_view
