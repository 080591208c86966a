"""The camera that follows: goes along, obeys a hand, and is not led astray by a page that answers late."""

from collections import deque
from types import SimpleNamespace

import numpy as np

from app.render.follow_camera import HANDS_ON, SETTLING, FollowCamera

OFFSET = ((-3.0, -4.0, 2.0), (0.0, 0.0, 0.0))


def camera() -> SimpleNamespace:
    return SimpleNamespace(position=np.zeros(3), look_at=np.zeros(3))


def begun(*cameras: SimpleNamespace) -> tuple[FollowCamera, dict[int, SimpleNamespace]]:
    chase, all_of = FollowCamera(), dict(enumerate(cameras))
    chase.start(np.zeros(3), OFFSET)
    chase.go(np.zeros(3), all_of, 0.0)
    return chase, all_of


def test_a_camera_is_put_beside_the_body_and_goes_along() -> None:
    one = camera()
    chase, cameras = begun(one)
    for i in range(1, 40):
        chase.go(np.array([0.1 * i, 0.0, 0.0]), cameras, i / 30)
    np.testing.assert_allclose(one.position, [3.9 - 3.0, -4.0, 2.0], atol=1e-12)
    np.testing.assert_allclose(one.look_at, [3.9, 0.0, 0.0], atol=1e-12)


def test_a_page_that_answers_late_does_not_lead_it_astray() -> None:
    one = camera()
    chase, cameras = begun(one)
    answers = deque([(one.position, one.look_at)], maxlen=400)  # 13 s late
    for i in range(1, 1500):
        here = np.array([np.sin(i / 20), 0.5 * np.cos(i / 15), 0.0])
        one.position, one.look_at = answers[0]  # what the page last said
        chase.go(here, cameras, i / 30)
        answers.append((one.position, one.look_at))
    np.testing.assert_allclose(one.position - chase.here, OFFSET[0], atol=1e-9)


def test_a_hand_that_turns_the_camera_is_obeyed_and_not_disturbed() -> None:
    one, other = camera(), camera()
    chase, cameras = begun(one, other)
    one.position = np.array([5.0, 1.0, 3.0])
    start = 1.1 * SETTLING
    chase.go(np.array([1.0, 0.0, 0.0]), cameras, start)
    np.testing.assert_array_equal(one.position, [5.0, 1.0, 3.0])
    chase.go(np.array([2.0, 0.0, 0.0]), cameras, start + 0.5 * HANDS_ON)
    np.testing.assert_array_equal(one.position, [5.0, 1.0, 3.0])
    chase.go(np.array([3.0, 0.0, 0.0]), cameras, start + 1.1 * HANDS_ON)
    np.testing.assert_allclose(one.position, [3.0 + 4.0, 1.0, 3.0])
    np.testing.assert_allclose(other.position, [3.0 - 3.0, -4.0, 2.0])


def test_a_page_that_takes_up_the_first_placing_late_is_no_hand() -> None:
    chase, one = FollowCamera(), camera()
    chase.start(np.zeros(3), OFFSET)
    chase.go(np.array([1.0, 0.0, 0.0]), {0: one}, 0.0)  # it comes when the body has moved on
    one.position, one.look_at = (np.array(each) for each in OFFSET)
    chase.go(np.array([1.5, 0.0, 0.0]), {0: one}, 0.1)
    np.testing.assert_allclose(one.position, [1.5 - 3.0, -4.0, 2.0])


def test_what_a_page_says_of_before_is_no_hand() -> None:
    one = camera()
    chase, cameras = begun(one)
    one.position = np.array([40.0, -9.0, 7.0])  # where another scene had it
    chase.go(np.zeros(3), cameras, 0.5 * SETTLING)
    np.testing.assert_allclose(one.position, OFFSET[0])
    chase.go(np.array([1.0, 0.0, 0.0]), cameras, 2.0 * SETTLING)
    np.testing.assert_allclose(one.position - np.array([1.0, 0.0, 0.0]), OFFSET[0])
