"""The time line's actions, as pages send them, without a browser."""

import math

import pytest

from app.messages import BaseParams, Checkpoint, Pause, Play
from app.panel.recording.recorder import RATES, Recorder
from app.panel.recording.timeline import Timeline
from tests.app.channels import FakeChannel
from tests.app.panel.recording.test_recorder import INTERVAL, snapshot

STATE = Checkpoint("a state", {})


class Lab:
    """10 s of a recording and its time line, with a state in each frame from 2 s on; notes what is posted."""

    def __init__(self) -> None:
        self.recorder = Recorder()
        self.posted: list[object] = []
        self.resumed: list[Checkpoint] = []
        self.post = self.posted.append
        self.channel = FakeChannel()
        self.line = Timeline(self.channel, self.recorder, self)  # type: ignore[arg-type]
        for number in range(201):
            time = number * INTERVAL
            self.recorder.note(snapshot(number)._replace(state=None if time < 2.0 else STATE), time)
        self.line.update(running=True)

    def resume(self, params: BaseParams, state: Checkpoint) -> None:
        self.resumed.append(state)

    def take(self, action: str, number: object, run: object = 1) -> None:
        self.channel.say("time", [action, number, run])

    @property
    def time(self) -> float | None:
        shown = self.recorder.shown_frame
        return None if shown is None else shown.time


@pytest.fixture
def lab() -> Lab:
    return Lab()


def test_a_moment_is_shown_while_the_lab_pauses_and_live_runs_on(lab: Lab) -> None:
    lab.take("show", 6.4)
    assert (lab.time, lab.posted) == (pytest.approx(6.4), [Pause()])
    lab.take("step", -2)
    assert lab.time == pytest.approx(6.3)
    lab.line.update(running=False)
    lab.take("live", 0)
    assert (lab.time, lab.posted[-1]) == (None, Play())


def test_a_lab_that_stood_still_goes_on_standing(lab: Lab) -> None:
    lab.line.update(running=False)
    lab.take("show", 6)
    lab.take("live", 0)
    assert lab.posted == [Pause()]


def test_the_run_goes_on_from_the_moment_that_the_message_names(lab: Lab) -> None:
    lab.take("continue", 1.5)
    assert lab.resumed == []  # no state was kept that early
    lab.take("continue", 7)
    assert (lab.time, lab.resumed) == (pytest.approx(7.0), [STATE])


def test_a_moment_of_another_run_is_ignored(lab: Lab) -> None:
    lab.take("show", 6.4, run=2)
    lab.take("continue", 7, run=0)
    assert (lab.time, lab.posted, lab.resumed) == (None, [], [])


def test_speed_and_loop_are_set_to_what_is_offered(lab: Lab) -> None:
    lab.take("rate", RATES[-1])
    lab.take("loop", 1)
    assert (lab.recorder.rate, lab.recorder.loops) == (RATES[-1], True)
    lab.take("rate", 1000)
    lab.take("play", 0)
    assert (lab.recorder.rate, lab.recorder.playing) == (RATES[-1], True)


@pytest.mark.parametrize(
    "value",
    [[], ["show"], ["show", 6.4], ["show", math.nan, 1], ["show", math.inf, 1], ["__init__", 1, 1], ["show", "x", 1],
     ["show", True, 1], [["show"], 6.4, 1], ["show", 6.4, 1, 1]],
)  # fmt: skip
def test_what_is_no_action_is_ignored(lab: Lab, value: list[object]) -> None:
    lab.channel.say("time", value)
    assert (lab.time, lab.posted) == (None, [])


def test_pages_learn_of_a_moment_at_once_and_of_the_span_twice_a_second(lab: Lab) -> None:
    before = lab.channel.told["time"]
    lab.line.update(running=True)
    assert lab.channel.told["time"] is before
    for action, number, name, state in (
        ("show", 6.4, "shown", 6.4), ("play", 0, "playing", True), ("play", 0, "playing", False),
        ("live", 0, "shown", None),
    ):  # fmt: skip
        lab.take(action, number)
        lab.line.update(running=False)
        assert lab.channel.told["time"][name] == state


def test_a_time_without_a_state_is_looked_back_at_while_the_lab_pauses(lab: Lab) -> None:
    lab.take("continue", 1.0)  # before the first state
    assert (lab.time, lab.posted, lab.resumed) == (pytest.approx(1.0), [Pause()], [])


def test_each_shown_frame_is_sent_to_the_pages(lab: Lab) -> None:
    """Frames are told apart by their times: an object that is freed may give its id to the next one."""
    states = set()
    for number in range(50):
        lab.take("show", 0.2 * number)
        lab.line.update(running=False)
        states.add(lab.channel.told["time"]["shown"])
    assert len(states) == 50
