"""The cameras of all browsers."""

import math
from collections.abc import Iterator
from typing import NamedTuple

import viser

from app.messages import Vector

NEAR, FAR = 0.01, 1000.0  # [m] from the camera, where the picture begins and ends: viser's own
FIT_MARGIN = 1.1  # room around what a camera shows
Camera = viser.CameraHandle | viser.InitialCameraConfig


class ClientCamera(NamedTuple):
    """Where the camera of one browser is to be."""

    client: int
    position: Vector  # [m]
    target: Vector  # [m]


def all_cameras(server: viser.ViserServer) -> Iterator[Camera]:
    """The camera of each connected browser, and the one that a new browser starts with."""
    yield server.initial_camera
    for client in server.get_clients().values():
        yield client.camera


def lowest_camera(server: viser.ViserServer) -> float | None:
    """Height [m] of the lowest camera of a browser; None where there is no browser."""
    heights = [float(client.camera.position[2]) for client in server.get_clients().values()]
    return min((height for height in heights if math.isfinite(height)), default=None)


def set_clipping(server: viser.ViserServer, near: float = NEAR, far: float = FAR) -> None:
    """Draw from `near` to `far` [m] from every camera: viser keeps the distances of the scene before."""
    for camera in all_cameras(server):
        camera.near, camera.far = near, far


def place_cameras(
    server: viser.ViserServer, position: Vector, target: Vector, field_of_view: float | None = None
) -> None:
    """Place every camera at `position` [m], looking at `target` [m]; field_of_view: vertical [rad], None to keep it."""
    for camera in all_cameras(server):
        place_camera(camera, position, target, field_of_view)


def fit_cameras(
    server: viser.ViserServer, view: tuple[Vector, Vector], field_of_view: float, corners: tuple[Vector, Vector]
) -> None:
    """Place the camera of each browser where `view` looks from, but far enough away to show a box; all in [m].

    view: position and target. field_of_view: vertical [rad]. corners: of the box.
    """
    position, target = view
    offset = [a - b for a, b in zip(position, target, strict=True)]
    radius = math.hypot(*(max(abs(low - c), abs(high - c)) for low, high, c in zip(*corners, target, strict=True)))
    scale = max(1.0, FIT_MARGIN * radius / math.sin(0.5 * field_of_view) / math.hypot(*offset))
    x, y, z = (c + scale * d for c, d in zip(target, offset, strict=True))
    for client in server.get_clients().values():
        place_camera(client.camera, (x, y, z), target)


def place_camera(camera: Camera, position: Vector, target: Vector, field_of_view: float | None = None) -> None:
    """The same for one camera."""
    camera.position, camera.look_at = position, target
    if field_of_view is not None:
        camera.fov = field_of_view


def place_client_camera(server: viser.ViserServer, camera: ClientCamera | None) -> None:
    """Place the camera of one browser, if there is one to place and the browser is still there."""
    client = None if camera is None else server.get_clients().get(camera.client)
    if camera is not None and client is not None:
        place_camera(client.camera, camera.position, camera.target)
