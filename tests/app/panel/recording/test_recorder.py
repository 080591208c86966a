"""The recorder: what it keeps, in bounded memory, and which frame it shows."""

from typing import Any, NamedTuple

import numpy as np
import pytest

from app.messages import Checkpoint, RunIdentity, RunState, Snapshot, Status
from app.panel.recording import recorder as module
from app.panel.recording.recorder import Recorder, arrays_of_frame
from app.panel.recording.recording_files import arrays_of
from app.scenes import scene_named
from app.scenes.checkpoints import arrays_in

RUN = RunIdentity()
INTERVAL = 0.05  # [s] between two frames, of simulated and of wall time


class Frame(NamedTuple):
    number: int
    points: np.ndarray


def snapshot(number: int, run: RunIdentity = RUN, running: bool = True, points: Any = None) -> Any:
    state = RunState.RUNNING if running else RunState.PAUSED
    status = Status(state, number * INTERVAL, number, 1.0, 1.0, False, 20.0, "", run)
    points = np.full((10, 3), number, np.float32) if points is None else points
    return Snapshot(number, Frame(number, points), status, None, None)


@pytest.fixture
def filled() -> Recorder:
    recorder = Recorder()
    for number in range(100):
        recorder.note(snapshot(number), number * INTERVAL)
    return recorder


def number_of(recorder: Recorder) -> int | None:
    shown = recorder.shown_frame
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
    filled.note(snapshot(0, RunIdentity(2)), 200.0)
    assert filled.span() == (0.0, 0.0)
    assert number_of(filled) is None


def test_a_run_that_goes_back_while_the_past_is_shown_shows_the_present(filled: Recorder) -> None:
    filled.follow(snapshot(99, running=False))
    filled.show_time(40 * INTERVAL)
    filled.follow(snapshot(99, running=False))
    assert number_of(filled) == 40
    filled.follow(snapshot(0, RunIdentity(2), running=False))  # a parameter was changed that begins the scene again
    assert number_of(filled) is None
    assert filled.span() == (0.0, 0.0)


def test_a_pause_adds_no_frames(filled: Recorder) -> None:
    for later in range(50):
        filled.note(snapshot(99, running=False), 10.0 + later)
    assert len(filled.frames) == 100


def counted(recorder: Recorder) -> int:
    """Bytes of all arrays that are kept, by walking all that is kept."""
    arrays: dict[int, int] = {}
    for kept in recorder.frames:
        arrays |= arrays_in(list(kept.packed) if isinstance(kept.packed, tuple) else [])
        arrays |= {} if kept.state is None else arrays_in(kept.state.value)
    return sum(arrays.values())


def test_memory_is_bounded_and_what_is_older_is_sparser(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MAX_BYTES", 60_000)
    recorder, most, shared = Recorder(), 0, np.zeros(700)
    for number in range(2400):
        own = np.full(7, number)
        arrays = {id(shared): shared.nbytes, id(own): own.nbytes}
        state = Checkpoint([shared, own], arrays) if number % 3 == 0 else None
        recorder.note(snapshot(number)._replace(state=state), number * INTERVAL)
        most = max(most, recorder.memory.bytes)
        if number % 50 == 0:
            assert recorder.memory.bytes == counted(recorder)
    assert most <= 60_000
    assert recorder.memory.bytes == counted(recorder) > 45_000
    assert recorder.span() == (0.0, 2399 * INTERVAL)
    times = np.array([kept.time for kept in recorder.frames])
    ages, gaps = times[-1] - times[:-1], np.diff(times)
    assert (gaps[ages < 2.0] < 1.5 * INTERVAL).all()
    assert 4.0 * gaps[(ages > 25.0) & (ages < 35.0)].mean() == pytest.approx(gaps[ages > 110.0].mean(), rel=0.5)
    assert (gaps <= 2.0 * recorder.spacing * ages + 0.2).all()
    assert all(kept.state is not None for kept in list(recorder.frames)[:50])
    assert [kept.wall for kept in recorder.frames] == pytest.approx(times)


def test_frames_too_large_to_be_thinned_leave_from_the_oldest_on(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MAX_BYTES", 500)
    recorder = Recorder()
    for number in range(200):
        recorder.note(snapshot(number), number * INTERVAL)
        assert recorder.memory.bytes == 120 * len(recorder.frames) <= 500
    assert recorder.frames[-1].time == 199 * INTERVAL


def test_an_array_that_frames_share_counts_once() -> None:
    recorder, points = Recorder(), np.zeros((10, 3), np.float32)
    for number in range(5):
        recorder.note(snapshot(number, points=points), number * INTERVAL)
    assert recorder.memory.bytes == 120
    for _ in range(4):
        recorder.forget(recorder.frames.pop())
    assert recorder.memory.bytes == 120
    recorder.forget(recorder.frames.pop())
    assert recorder.memory.bytes == 0


def bytes_of(frame: object) -> int:
    return sum(arrays_of_frame(frame).values())


@pytest.mark.parametrize("name", ["square_sea", "radial_sea"])
def test_a_sea_is_kept_in_a_quarter_of_its_memory_and_looks_the_same(name: str) -> None:
    kind = scene_named(name)
    scene = kind.make(kind.params())
    scene.advance(20)
    frame = scene.frame()
    recorder = Recorder(kind.packing)
    recorder.note(snapshot(1)._replace(frame=frame), 0.0)
    kept = recorder.frames[0].frame
    assert 4.0 * recorder.memory.bytes < bytes_of(frame)
    assert type(kept) is type(frame)
    limits = {"m": 5.1e-4, "": 1.01 / 1024, "0 to 1": 1.01 / 510}  # half of what each is rounded to
    for (key, array), (_, kept_array) in zip(arrays_of(frame), arrays_of(kept), strict=True):
        if key in kind.frame_units:
            atol = limits.get(kind.frame_units[key], 0.0)
            np.testing.assert_allclose(
                np.asarray(kept_array, float), array.astype(float), rtol=2e-7, atol=atol, err_msg=key
            )


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
    size = filled.memory.bytes
    filled.show_time(1.0)
    filled.note(snapshot(99, running=False), 5.0)
    filled.note(snapshot(23, RunIdentity(2, 2, before=1, since=20 * INTERVAL)), 5.1)  # the first that is shown of it
    assert number_of(filled) is None
    assert [kept.time for kept in filled.frames] == [n * INTERVAL for n in (*range(21), 23)]
    assert filled.memory.bytes == size * 22 // 100
    filled.note(snapshot(12, RunIdentity(3, 3, before=1, since=10 * INTERVAL)), 5.2)  # of the first run again
    assert [kept.time for kept in filled.frames] == [n * INTERVAL for n in (*range(11), 12)]


def test_no_frame_of_the_run_before_stays_before_the_first_of_another(filled: Recorder) -> None:
    """Whatever its time is: one that comes late, at a high speed, or of a run that is not recorded here."""
    filled.note(snapshot(40, RunIdentity(2)), 200.0)
    assert [kept.time for kept in filled.frames] == [40 * INTERVAL]
    filled.note(snapshot(41, RunIdentity(4, before=3, since=40 * INTERVAL)), 200.1)
    assert [kept.time for kept in filled.frames] == [41 * INTERVAL]


def test_it_goes_on_from_the_last_state_up_to_the_frame_that_is_shown() -> None:
    recorder, shared, wall = Recorder(), np.zeros(1000), 0.0
    for number in range(40):
        own = np.zeros(10)
        arrays = {id(shared): shared.nbytes, id(own): own.nbytes}
        state = Checkpoint((number, own), arrays) if number % 10 == 5 else None
        recorder.note(snapshot(number)._replace(state=state), wall)
        wall += INTERVAL
    assert recorder.resumable() is None  # the present is shown
    recorder.show_time(31 * INTERVAL)
    kept = recorder.resumable()
    assert kept is not None
    assert kept.state is not None
    assert (kept.time, kept.state.value[0]) == (25 * INTERVAL, 25)  # type: ignore[index]
    recorder.show_time(4 * INTERVAL)
    assert recorder.resumable() is None
    assert recorder.memory.bytes == 40 * 120 + 4 * 80 + shared.nbytes  # what states share is counted once
