"""The time line's actions, as pages send them, without a browser."""

import asyncio
from types import SimpleNamespace
from typing import Any

import pytest

from app.messages import BaseParams, Checkpoint, Pause, Play
from app.panel.recording.recorder import RATES, Recorder
from app.panel.recording.timeline import Timeline
from tests.app.panel.recording.test_recorder import INTERVAL, snapshot

STATE = Checkpoint("a state", {})


class Gui:
    """The GUI of a server, as far as the time line uses it."""

    def add_text(self, *given: object, **how: object) -> Any:
        return SimpleNamespace(value="", on_update=lambda callback: callback)

    def add_html(self, content: str) -> Any:
        return SimpleNamespace(content=content)


class Lab:
    """10 s of a recording and its time line, with a state in each frame from 2 s on; notes what is posted."""

    def __init__(self) -> None:
        self.recorder = Recorder()
        self.posted: list[object] = []
        self.resumed: list[Checkpoint] = []
        self.post = self.posted.append
        self.line = Timeline(Gui(), self.recorder, self)  # type: ignore[arg-type]
        for number in range(201):
            time = number * INTERVAL
            self.recorder.note(snapshot(number)._replace(state=None if time < 2.0 else STATE), time)
        self.line.update(running=True)

    def resume(self, params: BaseParams, state: Checkpoint) -> None:
        self.resumed.append(state)

    def take(self, text: str, run: int = 1) -> None:
        self.line.inbox.value = f"{text} {run}"
        asyncio.run(self.line.on_inbox(None))

    @property
    def time(self) -> float | None:
        shown = self.recorder.shown
        return None if shown is None else shown.time


@pytest.fixture
def lab() -> Lab:
    return Lab()


def test_a_moment_is_shown_while_the_lab_pauses_and_live_runs_on(lab: Lab) -> None:
    lab.take("a1 show 6.4")
    assert (lab.time, lab.posted) == (pytest.approx(6.4), [Pause()])
    lab.take("a2 step -2")
    assert lab.time == pytest.approx(6.3)
    lab.line.update(running=False)
    lab.take("a3 live 0")
    assert (lab.time, lab.posted[-1]) == (None, Play())


def test_a_lab_that_stood_still_goes_on_standing(lab: Lab) -> None:
    lab.line.update(running=False)
    lab.take("a1 show 6")
    lab.take("a2 live 0")
    assert lab.posted == [Pause()]


def test_the_run_goes_on_from_the_moment_that_the_message_names(lab: Lab) -> None:
    lab.take("a1 continue 1.5")
    assert lab.resumed == []  # no state was kept that early
    lab.take("a2 continue 7")
    assert (lab.time, lab.resumed) == (pytest.approx(7.0), [STATE])


def test_a_moment_of_another_run_is_ignored(lab: Lab) -> None:
    lab.take("a1 show 6.4", run=2)
    lab.take("a2 continue 7", run=0)
    assert (lab.time, lab.posted, lab.resumed) == (None, [], [])


def test_speed_and_loop_are_set_to_what_is_offered(lab: Lab) -> None:
    lab.take(f"a1 rate {RATES[-1]}")
    lab.take("a2 loop 1")
    assert (lab.recorder.rate, lab.recorder.loops) == (RATES[-1], True)
    lab.take("a3 rate 1000")
    lab.take("a4 play 0")
    assert (lab.recorder.rate, lab.recorder.playing) == (RATES[-1], True)


@pytest.mark.parametrize("text", ["", "show", "a1 show", "a1 show nan", "a1 show inf", "a1 __init__ 1", "a1 show x"])
def test_what_is_no_action_is_ignored(lab: Lab, text: str) -> None:
    lab.take(text)
    assert (lab.time, lab.posted) == (None, [])


def test_pages_learn_of_a_moment_at_once_and_of_the_span_twice_a_second(lab: Lab) -> None:
    before = lab.line.state.content
    lab.line.update(running=True)
    assert lab.line.state.content == before
    for text, words in (
        ("a1 show 6.4", "&quot;shown&quot;: 6.4,"), ("a2 play 0", "&quot;playing&quot;: true"),
        ("a3 play 0", "&quot;playing&quot;: false"), ("a4 live 0", "&quot;shown&quot;: null"),
    ):  # fmt: skip
        lab.take(text)
        lab.line.update(running=False)
        assert words in lab.line.state.content.replace("&#34;", "&quot;"), text


def test_a_time_without_a_state_is_looked_back_at_while_the_lab_pauses(lab: Lab) -> None:
    lab.take("a1 continue 1.0")  # before the first state
    assert (lab.time, lab.posted, lab.resumed) == (pytest.approx(1.0), [Pause()], [])


def test_each_shown_frame_is_sent_to_the_pages(lab: Lab) -> None:
    """Frames are told apart by their times: an object that is freed may give its id to the next one."""
    states = set()
    for number in range(50):
        lab.take(f"b{number} show {0.2 * number}")
        lab.line.update(running=False)
        states.add(lab.line.state.content)
    assert len(states) == 50
