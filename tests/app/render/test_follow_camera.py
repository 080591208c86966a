"""The camera that follows a body: it moves along, obeys its user, and is not misled by pages that answer late."""

from collections import deque
from types import SimpleNamespace

import numpy as np

from app.render.follow_camera import HAND_TIME, START_TIME, FollowCamera

OFFSET = ((-3.0, -4.0, 2.0), (0.0, 0.0, 0.0))


def camera() -> SimpleNamespace:
    return SimpleNamespace(position=np.zeros(3), look_at=np.zeros(3))


def started(*cameras: SimpleNamespace) -> tuple[FollowCamera, dict[int, SimpleNamespace]]:
    following, all_of = FollowCamera(), dict(enumerate(cameras))
    following.start(np.zeros(3), OFFSET)
    following.follow(np.zeros(3), all_of, 0.0)
    return following, all_of


def test_a_camera_is_put_beside_the_body_and_goes_along() -> None:
    one = camera()
    following, cameras = started(one)
    for i in range(1, 40):
        following.follow(np.array([0.1 * i, 0.0, 0.0]), cameras, i / 30)
    np.testing.assert_allclose(one.position, [3.9 - 3.0, -4.0, 2.0], atol=1e-12)
    np.testing.assert_allclose(one.look_at, [3.9, 0.0, 0.0], atol=1e-12)


def test_a_page_that_answers_late_does_not_mislead_it() -> None:
    one = camera()
    following, cameras = started(one)
    answers = deque([(one.position, one.look_at)], maxlen=400)  # 13 s late
    for i in range(1, 1500):
        here = np.array([np.sin(i / 20), 0.5 * np.cos(i / 15), 0.0])
        one.position, one.look_at = answers[0]  # what the page last said
        following.follow(here, cameras, i / 30)
        answers.append((one.position, one.look_at))
    np.testing.assert_allclose(one.position - following.body, OFFSET[0], atol=1e-9)


def test_a_user_who_turns_the_camera_is_obeyed_and_not_disturbed() -> None:
    one, other = camera(), camera()
    following, cameras = started(one, other)
    one.position = np.array([5.0, 1.0, 3.0])
    start = 1.1 * START_TIME
    following.follow(np.array([1.0, 0.0, 0.0]), cameras, start)
    np.testing.assert_array_equal(one.position, [5.0, 1.0, 3.0])
    following.follow(np.array([2.0, 0.0, 0.0]), cameras, start + 0.5 * HAND_TIME)
    np.testing.assert_array_equal(one.position, [5.0, 1.0, 3.0])
    following.follow(np.array([3.0, 0.0, 0.0]), cameras, start + 1.1 * HAND_TIME)
    np.testing.assert_allclose(one.position, [3.0 + 4.0, 1.0, 3.0])
    np.testing.assert_allclose(other.position, [3.0 - 3.0, -4.0, 2.0])


def test_a_page_that_takes_the_first_place_late_is_no_user() -> None:
    following, one = FollowCamera(), camera()
    following.start(np.zeros(3), OFFSET)
    following.follow(np.array([1.0, 0.0, 0.0]), {0: one}, 0.0)  # it comes when the body has moved on
    one.position, one.look_at = (np.array(each) for each in OFFSET)
    following.follow(np.array([1.5, 0.0, 0.0]), {0: one}, 0.1)
    np.testing.assert_allclose(one.position, [1.5 - 3.0, -4.0, 2.0])


def test_a_place_reported_from_an_earlier_scene_is_no_user() -> None:
    one = camera()
    following, cameras = started(one)
    one.position = np.array([40.0, -9.0, 7.0])  # where another scene had it
    following.follow(np.zeros(3), cameras, 0.5 * START_TIME)
    np.testing.assert_allclose(one.position, OFFSET[0])
    following.follow(np.array([1.0, 0.0, 0.0]), cameras, 2.0 * START_TIME)
    np.testing.assert_allclose(one.position - np.array([1.0, 0.0, 0.0]), OFFSET[0])


def test_a_browser_that_leaves_takes_its_record_along() -> None:
    following, cameras = started(camera(), camera())
    del cameras[0]
    following.follow(np.zeros(3), cameras, 1.0)
    assert list(following.views) == [1]
