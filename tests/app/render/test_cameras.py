"""Cameras that were placed: a page that reports an old place late is sent the new one again, a user is obeyed."""

from typing import Any

import numpy as np

from app.render.cameras import is_waiting, place_camera
from tests import coroutines

OLD, NEW = ((15.0, -68.0, 5.0), (0.0, 0.0, 1.5)), ((-3.0, -4.0, 2.0), (0.0, 0.0, 0.0))


class FakeCamera:
    """A camera as viser's handle has it: it sends nothing where it believes the camera to be there already."""

    def __init__(self) -> None:
        self.sent: dict[str, Any] = {}  # the last of each kind
        self.callbacks: list[Any] = []
        self.believed: dict[str, Any] = {"position": np.zeros(3), "look_at": np.zeros(3), "fov": 1.0}

    def __getattr__(self, name: str) -> Any:
        return self.__dict__["believed"][name]

    def __setattr__(self, name: str, value: Any) -> None:
        if name not in ("position", "look_at", "fov"):
            super().__setattr__(name, value)
        elif not np.allclose(self.believed[name], value):
            self.believed[name] = self.sent[name] = np.array(value, float)

    def on_update(self, callback: Any) -> None:
        self.callbacks.append(callback)

    def report(self, place: Any) -> None:
        """The page says that camera and target are there."""
        self.believed |= {"position": np.array(place[0], float), "look_at": np.array(place[1], float)}
        for callback in self.callbacks:
            coroutines.run(callback(self))


def put(camera: FakeCamera, place: Any) -> None:
    place_camera(camera, *place)  # pyright: ignore[reportArgumentType]


def waits(camera: FakeCamera) -> bool:
    return is_waiting(camera)  # pyright: ignore[reportArgumentType]


def test_a_page_that_reports_an_old_place_is_sent_the_new_one_again() -> None:
    camera = FakeCamera()
    put(camera, OLD)
    camera.report(OLD)
    assert not waits(camera)
    put(camera, NEW)
    for late in (OLD, (OLD[0], NEW[1]), OLD):  # viser reports an old camera with a new target where its angle is set
        camera.sent.clear()
        camera.report(late)
        assert waits(camera)
        np.testing.assert_array_equal(camera.sent["position"], NEW[0])
        np.testing.assert_array_equal(camera.believed["look_at"], NEW[1])
    camera.report(NEW)
    assert not waits(camera)


def test_a_place_that_was_not_sent_for_an_old_report_is_sent_after_the_next() -> None:
    camera = FakeCamera()
    put(camera, OLD)
    camera.report(OLD)
    assert not waits(camera)
    put(camera, NEW)
    camera.report(OLD)
    put(camera, OLD)  # another scene, before the page has taken the view of this one
    camera.report(NEW)
    assert waits(camera)
    camera.report(OLD)
    assert not waits(camera)


def test_a_user_is_obeyed_once_the_page_has_taken_its_place() -> None:
    camera = FakeCamera()
    for _ in range(2):  # the second time there is nothing to report
        put(camera, NEW)
        camera.report(NEW)
        assert not waits(camera)
    put(camera, NEW)
    camera.sent.clear()
    camera.report(OLD)
    assert not waits(camera)
    assert camera.sent == {}


def test_a_page_that_lifts_its_camera_out_of_the_water_has_taken_it() -> None:
    camera = FakeCamera()
    put(camera, NEW)
    camera.report([(x, y, z + 1.0) for x, y, z in NEW])
    assert not waits(camera)


def test_a_page_that_lowers_its_camera_has_not_taken_it() -> None:
    camera = FakeCamera()
    put(camera, NEW)
    camera.report([(x, y, z - 1.0) for x, y, z in NEW])
    assert waits(camera)


def test_a_page_whose_user_turns_the_camera_at_once_has_taken_it() -> None:
    camera = FakeCamera()
    put(camera, NEW)
    camera.sent.clear()
    camera.report(((-4.0, -3.0, 2.0), NEW[1]))  # as far from the same target
    assert not waits(camera)
    assert camera.sent == {}
