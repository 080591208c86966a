"""The cameras of all browsers.

A slow page reports an old place of its camera long after it was sent a new one, and viser takes each report for the
truth: it sends no place at which it believes the camera to be. Therefore a camera that was placed is placed again
after each report of another place, until the page has reported this one.
"""

import math
import threading
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import viser
from numpy.typing import NDArray

from app.messages import Vector, vector_of
from app.render.handles.of_handles import OfHandles

NEAR, FAR = 0.01, 1000.0  # [m] from the camera, where the picture begins and ends: viser's own
FIT_MARGIN = 1.1  # room around what a camera shows
SAME_PLACE = 0.02  # [m] within which a camera, or its target, is where it was put
NOTICE_TIME = 30.0  # [s] after which a notice goes by itself
LIFTED = (
    "The view begins higher",
    "The camera of this set-up is below the floor or the water, so this view begins above it.",
)
Camera = viser.CameraHandle | viser.InitialCameraConfig


class ClientCamera(NamedTuple):
    """Place of the camera of one browser."""

    client: int
    position: Vector  # [m]
    target: Vector  # [m]


def all_cameras(server: viser.ViserServer) -> Iterator[Camera]:
    """The camera of each connected browser, and the one that a new browser starts with."""
    yield server.initial_camera
    for client in server.get_clients().values():
        yield client.camera


def lowest_camera(server: viser.ViserServer) -> float | None:
    """Height [m] of the lowest camera of a browser; None if there is no browser."""
    heights = [float(client.camera.position[2]) for client in server.get_clients().values()]
    return min((height for height in heights if math.isfinite(height)), default=None)


def set_clipping(server: viser.ViserServer, near: float = NEAR, far: float = FAR) -> None:
    """Draw from `near` to `far` [m] from every camera: viser keeps the distances of the scene before."""
    for camera in all_cameras(server):
        camera.near, camera.far = near, far


_wanted: OfHandles[NDArray[np.float64]] = OfHandles()  # (2, 3) [m] where a camera is to be
_watched: OfHandles[bool] = OfHandles()  # the reports of these cameras are looked at
_sunk: OfHandles[NDArray[np.float64]] = OfHandles()  # (2, 3) [m] of a camera below 0 that its page has just taken
# The notice in the browser of a camera that the page has lifted, and the place (2, 3) [m] to which it did so.
_lifted: OfHandles[tuple[viser.NotificationHandle, NDArray[np.float64]]] = OfHandles()
_placing = threading.Lock()  # viewer thread, callbacks and changes of the scene place cameras


def place_cameras(
    server: viser.ViserServer, position: Vector, target: Vector, field_of_view: float | None = None
) -> None:
    """Place every camera at `position` [m], looking at `target` [m]; field_of_view: vertical [rad], None to keep it."""
    set_camera(server.initial_camera, position, target, field_of_view)
    for client in server.get_clients().values():
        place_camera(client.camera, position, target, field_of_view)


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


def axes_of(direction: NDArray[np.float64]) -> NDArray[np.float64]:
    """Unit vectors (3, 3) to the right, up and ahead of a camera; its direction (3,) is not vertical."""
    ahead = direction / np.linalg.norm(direction)
    right = np.cross(ahead, (0.0, 0.0, 1.0)) / np.hypot(*ahead[:2])
    return np.array([right, np.cross(right, ahead), ahead])


def framing_view(
    points: NDArray[np.float64], bearing: float, pitch: float, field_of_view: float, frame: tuple[float, float, float]
) -> tuple[Vector, Vector]:
    """Position and target [m] of the nearest camera that shows all points (n, 3) [m] within a part of its picture.

    bearing: [rad] of the camera as seen from the points, from +x towards +y. pitch: [rad] by which it looks down.
    field_of_view: vertical [rad]. frame: half width, lower and upper edge of the part, in halves of the picture's
    height from its middle. The lowest point is always on the lower edge. The target is as far away as the points are.
    """
    level = math.cos(pitch)
    ahead = np.array([-level * math.cos(bearing), -level * math.sin(bearing), -math.sin(pitch)])
    right, up, ahead = axes_of(ahead)
    x, y, z = points @ right, points @ up, points @ ahead
    half_width, low, high = math.tan(0.5 * field_of_view) * np.array(frame)
    # Each point keeps the camera behind four planes, one for each edge.
    from_left, from_right = (half_width * z + x).min(), (half_width * z - x).min()
    from_below, from_above = (y - low * z).min(), (high * z - y).min()
    forward = min((from_left + from_right) / (2.0 * half_width), (from_below + from_above) / (high - low))
    position = 0.5 * (from_left - from_right) * right + (from_below + low * forward) * up + forward * ahead
    return vector_of(position), vector_of(position + (z.mean() - forward) * ahead)


def point_in_view(
    view: tuple[Vector, Vector], field_of_view: float, place: tuple[float, float], height: float
) -> Vector:
    """The point at a height [m] that a camera sees at a place of its picture.

    view: position and target [m], one not above the other. field_of_view: vertical [rad]. place: to the right and up,
    in halves of the picture's height from its middle.
    """
    position, target = np.array(view)
    right, up, ahead = axes_of(target - position)
    across, upwards = math.tan(0.5 * field_of_view) * np.array(place)
    ray = ahead + across * right + upwards * up
    return vector_of(position + (height - position[2]) / ray[2] * ray)


def set_camera(camera: Camera, position: Vector, target: Vector, field_of_view: float | None = None) -> None:
    """Set one camera; viser shifts the target along with the position, so that the target comes second."""
    camera.position, camera.look_at = position, target
    if field_of_view is not None:
        camera.fov = field_of_view


def place_camera(
    camera: viser.CameraHandle, position: Vector, target: Vector, field_of_view: float | None = None
) -> None:
    """Place the camera of one browser, and see to it that the page takes it (`on_report`)."""
    place = np.array([position, target], float)
    with _placing:
        if not _watched.get(camera):
            _watched.put(camera, True)
            camera.on_update(on_report)
        is_there = _wanted.get(camera) is None and bool((np.abs(place_of(camera) - place) <= SAME_PLACE).all())
        set_camera(camera, position, target, field_of_view)
        if not is_there:  # otherwise there would be nothing to report
            _wanted.put(camera, place)


def place_of(camera: viser.CameraHandle) -> NDArray[np.float64]:
    """(2, 3) [m] of a camera and its target, as last reported or set."""
    return np.array([camera.position, camera.look_at], float)


def is_waiting(camera: viser.CameraHandle) -> bool:
    """True if the page of a camera that was placed has not reported that it is there."""
    return _wanted.get(camera) is not None


def has_taken(wanted: NDArray[np.float64], reported: NDArray[np.float64]) -> bool:
    """True if a page that reports a place (2, 3) [m] has taken the wanted one; its user may be turning it already."""
    off = reported - wanted
    # The page lifts a camera that would be under the floor or the water (js/page/camera.js).
    if np.abs(off[:, :2]).max() <= SAME_PLACE and off[:, 2].min() >= -SAME_PLACE:
        return True
    change = np.linalg.norm(reported[0] - reported[1]) - np.linalg.norm(wanted[0] - wanted[1])
    return bool(np.abs(off[1]).max() <= SAME_PLACE and abs(change) <= SAME_PLACE)


def follow_lift(camera: viser.CameraHandle, reported: NDArray[np.float64]) -> None:
    """Say that a page has lifted a camera to this place (2, 3) [m], and remove the notice once it is elsewhere.

    A page may first report the place below, where it stays in a mooring. Waves change the height of a camera alone.
    """
    sunk, lifted = _sunk.get(camera), _lifted.get(camera)
    if lifted is not None:
        notice, place = lifted
        off = np.abs(reported - place)
        if max(off[:, :2].max(), off[1, 2]) > SAME_PLACE:
            notice.remove()
            _lifted.drop(camera)
    if sunk is None or np.abs(reported - sunk).max() <= SAME_PLACE:
        return
    _sunk.drop(camera)
    if reported[0, 2] > 0.0 and has_taken(sunk, reported) and _lifted.get(camera) is None:
        notice = camera.client.add_notification(*LIFTED, color="orange", auto_close_seconds=NOTICE_TIME)
        _lifted.put(camera, (notice, reported))


async def on_report(camera: viser.CameraHandle) -> None:
    """A page has reported its camera: place it again where it is not where it was placed."""
    reported = place_of(camera)
    with _placing:
        wanted = _wanted.get(camera)
        if wanted is not None and has_taken(wanted, reported):
            _wanted.drop(camera)
            if wanted[0, 2] < 0.0:
                _sunk.put(camera, wanted)
        elif wanted is not None:
            position, target = wanted
            set_camera(camera, position, target)
        follow_lift(camera, reported)


def client_cameras(server: viser.ViserServer) -> tuple[ClientCamera, ...]:
    """Cameras of all browsers, as last reported or set."""
    clients = server.get_clients().items()
    return tuple(
        ClientCamera(number, vector_of(client.camera.position), vector_of(client.camera.look_at))
        for number, client in clients
    )


def place_client_camera(server: viser.ViserServer, camera: ClientCamera | None) -> None:
    """Place the camera of one browser, if there is one to place and the browser is still there."""
    client = None if camera is None else server.get_clients().get(camera.client)
    if camera is not None and client is not None:
        place_camera(client.camera, camera.position, camera.target)
