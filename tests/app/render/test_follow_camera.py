"""The camera that follows a body: it moves along, obeys its user, and is not misled by pages that answer late."""

from collections import deque

import numpy as np

from app.render.follow_camera import HAND_TIME, FollowCamera
from tests.app.render.test_cameras import FakeCamera, waits

OFFSET = ((-3.0, -4.0, 2.0), (0.0, 0.0, 0.0))
EARLIER = ((40.0, -9.0, 7.0), (0.0, 0.0, 1.0))  # where another scene had the camera


def started(*cameras: FakeCamera) -> tuple[FollowCamera, dict[int, FakeCamera]]:
    """Cameras beside a body at the origin; their pages have taken them."""
    following, all_of = FollowCamera(), dict(enumerate(cameras))
    following.start(np.zeros(3), OFFSET)
    following.follow(np.zeros(3), all_of, 0.0)
    for camera in cameras:
        camera.report(OFFSET)
        assert not waits(camera)
    return following, all_of


def test_a_camera_is_put_beside_the_body_and_goes_along() -> None:
    one = FakeCamera()
    following, cameras = started(one)
    for i in range(1, 40):
        following.follow(np.array([0.1 * i, 0.0, 0.0]), cameras, i / 30)
    np.testing.assert_allclose(one.position, [3.9 - 3.0, -4.0, 2.0], atol=1e-12)
    np.testing.assert_allclose(one.look_at, [3.9, 0.0, 0.0], atol=1e-12)


def test_a_page_that_answers_late_does_not_mislead_it() -> None:
    one = FakeCamera()
    following, cameras = started(one)
    answers = deque([(one.position, one.look_at)], maxlen=400)  # 13 s late
    for i in range(1, 1500):
        here = np.array([np.sin(i / 20), 0.5 * np.cos(i / 15), 0.0])
        one.report(answers[0])  # what the page last said
        following.follow(here, cameras, i / 30)
        answers.append((one.position, one.look_at))
    np.testing.assert_allclose(one.position - following.body, OFFSET[0], atol=1e-9)


def test_a_user_who_turns_the_camera_is_obeyed_and_not_disturbed() -> None:
    one, other = FakeCamera(), FakeCamera()
    following, cameras = started(one, other)
    one.report(([5.0, 1.0, 3.0], OFFSET[1]))
    following.follow(np.array([1.0, 0.0, 0.0]), cameras, 0.1)
    np.testing.assert_array_equal(one.position, [5.0, 1.0, 3.0])
    following.follow(np.array([2.0, 0.0, 0.0]), cameras, 0.1 + 0.5 * HAND_TIME)
    np.testing.assert_array_equal(one.position, [5.0, 1.0, 3.0])
    following.follow(np.array([3.0, 0.0, 0.0]), cameras, 0.1 + 1.1 * HAND_TIME)
    np.testing.assert_allclose(one.position, [3.0 + 4.0, 1.0, 3.0])
    np.testing.assert_allclose(other.position, [3.0 - 3.0, -4.0, 2.0])


def test_a_place_reported_from_an_earlier_scene_is_no_user_however_late() -> None:
    following, one = FollowCamera(), FakeCamera()
    one.report(EARLIER)
    following.start(np.zeros(3), OFFSET)
    cameras = {0: one}
    for now in (0.0, 3.0, 60.0):
        following.follow(np.array([0.1 * now, 0.0, 0.0]), cameras, now)
        one.report((EARLIER[0], OFFSET[1]))
        assert waits(one)
    one.report(OFFSET)
    assert not waits(one)
    following.follow(np.array([7.0, 0.0, 0.0]), cameras, 61.0)
    np.testing.assert_allclose(one.position, [7.0 - 3.0, -4.0, 2.0])


def test_a_browser_that_leaves_takes_its_record_along() -> None:
    following, cameras = started(FakeCamera(), FakeCamera())
    del cameras[0]
    following.follow(np.zeros(3), cameras, 1.0)
    assert list(following.views) == [1]
