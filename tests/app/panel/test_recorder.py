"""The recorder: what it keeps, in bounded memory, and which frame it shows."""

from typing import Any, NamedTuple

import numpy as np
import pytest

from app.messages import KeptState, Snapshot, Status
from app.panel import recorder as module
from app.panel.recorder import Recorder, size_of

INTERVAL = 0.05  # [s] between two frames, of simulated and of wall time


class Frame(NamedTuple):
    number: int
    points: np.ndarray


def snapshot(number: int, starts: int = 0, running: bool = True, points: Any = None) -> Any:
    status = Status(running, number * INTERVAL, number, 1.0, 1.0, False, 20.0, "", starts)
    points = np.full((10, 3), number, np.float32) if points is None else points
    return Snapshot(number, Frame(number, points), status, None, {}, None)


@pytest.fixture
def filled() -> Recorder:
    recorder = Recorder()
    for number in range(100):
        recorder.note(snapshot(number), number * INTERVAL)
    return recorder


def number_of(recorder: Recorder) -> int | None:
    shown = recorder.shown
    return None if shown is None else shown.frame.number  # type: ignore[attr-defined]


def test_every_frame_is_kept_and_found_by_its_time(filled: Recorder) -> None:
    assert filled.span() == (0.0, 99 * INTERVAL)
    assert number_of(filled) is None
    for number in (0, 37, 99):
        filled.show_time(number * INTERVAL)
        assert number_of(filled) == number
    filled.show_time(37.4 * INTERVAL)
    assert number_of(filled) == 37
    filled.show_time(1e9)
    assert number_of(filled) == 99
    filled.show_time(-5.0)
    assert number_of(filled) == 0


def test_steps_stop_at_the_ends(filled: Recorder) -> None:
    filled.step(-1)
    assert number_of(filled) == 98
    filled.step(1)
    filled.step(1)
    assert number_of(filled) == 99
    filled.show_time(0.0)
    filled.step(-1)
    assert number_of(filled) == 0


def test_nothing_is_recorded_while_the_past_is_shown_and_running_shows_the_present(filled: Recorder) -> None:
    filled.show_time(1.0)
    filled.note(snapshot(100), 100 * INTERVAL)  # the lab has not paused yet
    assert number_of(filled) == 20
    filled.note(snapshot(100, running=False), 100 * INTERVAL)
    assert len(filled.frames) == 100
    filled.note(snapshot(101), 101 * INTERVAL)
    assert number_of(filled) is None
    assert len(filled.frames) == 101


@pytest.mark.parametrize("rate", [1.0, 0.5, 0.1])
def test_it_plays_at_the_pace_of_the_recording_times_the_rate(filled: Recorder, rate: float) -> None:
    filled.rate = rate
    filled.show_time(10 * INTERVAL)
    filled.play()
    wall = 1000.0
    filled.advance(wall)
    start = filled.position
    for _ in range(100):
        wall += 0.02
        filled.advance(wall)
    assert start is not None
    assert filled.position == pytest.approx(start + 2.0 * rate / INTERVAL, abs=1)


def test_playing_ends_at_the_last_frame_or_begins_again(filled: Recorder) -> None:
    filled.play()
    assert filled.position == 0
    for second in range(1000):
        filled.advance(float(second) * 0.2)
    assert (filled.position, filled.playing) == (99, False)
    filled.loops = True
    filled.play()
    for second in range(1000, 1600):
        filled.advance(float(second) * 0.2)
    assert filled.playing


def test_a_run_that_begins_again_begins_a_new_recording(filled: Recorder) -> None:
    filled.show_time(1.0)
    filled.note(snapshot(0, starts=1), 200.0)
    assert filled.span() == (0.0, 0.0)
    assert number_of(filled) is None


def test_a_pause_adds_no_frames(filled: Recorder) -> None:
    for later in range(50):
        filled.note(snapshot(99, running=False), 10.0 + later)
    assert len(filled.frames) == 100


def test_memory_is_bounded_and_shared_arrays_count_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MAX_BYTES", 5000)
    recorder = Recorder()
    for number in range(200):
        recorder.note(snapshot(number), number * INTERVAL)
    assert recorder.bytes <= 5000
    assert recorder.bytes == sum(kept.size for kept in recorder.frames) == 120 * len(recorder.frames)
    assert recorder.frames[-1].time == 199 * INTERVAL
    points = np.zeros((10, 3), np.float32)
    assert size_of(Frame(1, points), Frame(0, points)) == 0
    assert size_of(Frame(1, points), Frame(0, points.copy())) == 120


def test_the_duration_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MAX_DURATION", 1.0)
    recorder = Recorder()
    for number in range(200):
        recorder.note(snapshot(number), number * INTERVAL)
    low, high = recorder.span()
    assert high - low <= 1.0


def test_frames_that_come_faster_than_the_rate_are_left_out() -> None:
    recorder = Recorder()
    for number in range(120):
        recorder.note(snapshot(number), number / 120)
    assert 25 <= len(recorder.frames) <= 31


def test_a_run_that_goes_on_from_earlier_replaces_what_came_later(filled: Recorder) -> None:
    size = filled.bytes
    filled.show_time(1.0)
    filled.note(snapshot(99, running=False), 5.0)
    filled.note(snapshot(21), 5.1)
    assert number_of(filled) is None
    assert [kept.time for kept in filled.frames] == [n * INTERVAL for n in range(22)]
    assert filled.bytes == size * 22 // 100


def test_it_goes_on_from_the_last_state_up_to_the_frame_that_is_shown() -> None:
    recorder, shared, wall = Recorder(), np.zeros(1000), 0.0
    for number in range(40):
        own = np.zeros(10)
        state = KeptState(number, {id(shared): shared.nbytes, id(own): own.nbytes}) if number % 10 == 5 else None
        recorder.note(snapshot(number)._replace(state=state), wall)
        wall += INTERVAL
    assert recorder.resumable() is None  # the present is shown
    recorder.show_time(31 * INTERVAL)
    kept = recorder.resumable()
    assert kept is not None
    assert kept.state is not None
    assert (kept.time, kept.state.value) == (25 * INTERVAL, 25)
    recorder.show_time(4 * INTERVAL)
    assert recorder.resumable() is None
    assert recorder.bytes == 40 * 120 + 4 * 80 + shared.nbytes  # what states share is counted once
