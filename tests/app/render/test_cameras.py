"""Cameras: a view that frames points; a page that reports an old place late is sent the new one again."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from app.render.cameras import framing_view, is_waiting, place_camera, point_in_view
from tests import coroutines

OLD, NEW = ((15.0, -68.0, 5.0), (0.0, 0.0, 1.5)), ((-3.0, -4.0, 2.0), (0.0, 0.0, 0.0))


class FakeCamera:
    """A camera as viser's handle has it: it sends nothing where it believes the camera to be there already."""

    def __init__(self) -> None:
        self.sent: dict[str, Any] = {}  # the last of each kind
        self.callbacks: list[Any] = []
        self.notices: list[str] = []
        self.client = self
        self.believed: dict[str, Any] = {"position": np.zeros(3), "look_at": np.zeros(3), "fov": 1.0}

    def __getattr__(self, name: str) -> Any:
        return self.__dict__["believed"][name]

    def __setattr__(self, name: str, value: Any) -> None:
        if name not in ("position", "look_at", "fov"):
            super().__setattr__(name, value)
        elif not np.allclose(self.believed[name], value):
            self.believed[name] = self.sent[name] = np.array(value, float)

    def add_notification(self, title: str, body: str, **how: Any) -> SimpleNamespace:
        """The camera is its own client."""
        words = f"{title}. {body}"
        self.notices.append(words)
        return SimpleNamespace(remove=lambda: self.notices.remove(words))

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


UNDER = (8.0, 3.0, -3.0), (0.0, 0.0, -1.0)
LIFTED = (8.1325, 3.0497, 0.25), (0.0, 0.0, -1.0)  # as far from the same target


SHIFTED = (8.0, 3.0, 0.25), (0.0, 0.0, 2.25)


@pytest.mark.parametrize("lifted", [LIFTED, SHIFTED], ids=["turned", "shifted"])
@pytest.mark.parametrize("first", [OLD, UNDER], ids=["late", "before the sea is there"])
def test_a_notice_says_that_a_camera_was_lifted_out_of_the_water_until_it_moves(first: Any, lifted: Any) -> None:
    camera = FakeCamera()
    put(camera, UNDER)
    camera.report(first)
    assert camera.notices == []
    camera.report(lifted)
    assert not waits(camera)
    assert len(camera.notices) == 1
    assert "below the floor or the water" in camera.notices[0]
    (x, y, z), target = lifted
    camera.report(((x, y, z + 2.0), target))  # over a crest
    assert len(camera.notices) == 1
    put(camera, UNDER)  # the same link again
    camera.report(lifted)
    assert len(camera.notices) == 1
    camera.report(((x + 0.5, y, z), target))
    assert camera.notices == []
    camera.report(lifted)
    assert camera.notices == []


@pytest.mark.parametrize(
    ("placed", "reported"),
    [(NEW, [(x, y, z + 1.0) for x, y, z in NEW]), (UNDER, UNDER), (UNDER, ((-8.0, -3.0, -3.0), UNDER[1]))],
    ids=["a crest", "under water, as in a mooring", "turned under water"],
)
def test_no_notice_comes_if_a_view_begins_where_it_was_placed(placed: Any, reported: Any) -> None:
    camera = FakeCamera()
    put(camera, placed)
    camera.report(reported)
    assert not waits(camera)
    assert camera.notices == []


def test_no_notice_comes_if_a_person_turns_a_camera_out_of_the_water() -> None:
    camera = FakeCamera()
    put(camera, UNDER)
    for height in (-3.0, -2.9, -1.0, 0.5):
        level = np.hypot(8.0, 3.0) ** 2 + 4.0 - (height + 1.0) ** 2
        camera.report(((np.sqrt(level - 9.0), 3.0, height), UNDER[1]))
        assert camera.notices == []


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


def in_picture(position: Any, target: Any, field_of_view: float, points: np.ndarray) -> np.ndarray:
    """Places (n, 2) of points (n, 3) in a picture, to the right and up, in halves of its height."""
    ahead = np.subtract(target, position) / np.linalg.norm(np.subtract(target, position))
    right = np.cross(ahead, (0.0, 0.0, 1.0)) / np.hypot(*ahead[:2])
    seen = points - position
    edge = np.tan(0.5 * field_of_view) * (seen @ ahead)
    return seen @ np.column_stack([right, np.cross(right, ahead)]) / edge[:, None]


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("stretch", [(9.0, 9.0, 1.0), (1.0, 1.0, 9.0)])
def test_a_framing_view_shows_all_points_and_is_as_near_as_it_can_be(seed: int, stretch: Any) -> None:
    random = np.random.default_rng(seed)
    points = random.normal(size=(8, 3)) * stretch + random.normal(size=3) * 20.0
    bearing, pitch, width, low, high = random.uniform((-3, 0.1, 0.6, -0.9, 0.2), (3, 0.6, 1.1, -0.4, 0.9))
    position, target = framing_view(points, bearing, pitch, 0.8, (width, low, high))
    x, y = in_picture(position, target, 0.8, points).T
    assert np.arctan2(*np.subtract(position, target)[1::-1]) == pytest.approx(bearing)
    assert abs(x).max() <= width + 1e-9
    assert low - 1e-9 <= y.min()
    assert y.max() <= high + 1e-9
    # Points at both sides, or above and below, touch the edges: a camera farther on would lose one of them.
    assert (x.min(), x.max()) == pytest.approx((-width, width)) or y.max() == pytest.approx(high)
    assert y.min() == pytest.approx(low)


def test_a_point_in_a_view_is_seen_at_its_place() -> None:
    view = (3.0, -9.0, 4.0), (1.0, 2.0, -1.0)
    point = point_in_view(view, 0.8, (-0.3, -0.6), -5.0)
    assert point[2] == pytest.approx(-5.0)
    assert in_picture(*view, 0.8, np.array([point]))[0] == pytest.approx((-0.3, -0.6))
