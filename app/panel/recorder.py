"""The last minutes of a scene: its frames, in bounded memory, and which of them is shown instead of the present."""

import bisect
import collections
import threading
from typing import NamedTuple, cast

import numpy as np

from app.messages import BaseParams, KeptState
from app.scenes.contract import AnySnapshot

MAX_BYTES = 150e6  # of all frames and states that are kept
MAX_DURATION = 180.0  # [s] of simulated time that is kept
MAX_RATE = 30.0  # [1/s] frames kept a second of wall time, and those that have a state; the page may show more
MAX_PAUSE = 0.25  # [s] between two frames as they are played: a pause of the lab is shorter there
RATES = (1.0, 0.5, 0.2, 0.1)  # at which a recording is played, as parts of the rate that it was recorded at


class Kept(NamedTuple):
    """One frame of the recording."""

    time: float  # [s] simulated
    wall: float  # [s] of the clock when it was recorded
    frame: object  # the scene's own record
    params: BaseParams
    size: int  # [bytes] that it holds alone
    state: KeptState | None = None  # to go on from


def size_of(frame: object, last: object = None) -> int:
    """Bytes of the arrays in a frame that are not the same objects as in the frame before."""
    if isinstance(frame, np.ndarray):
        return 0 if frame is last else frame.nbytes
    if isinstance(frame, tuple):
        parts, before = cast(tuple[object, ...], frame), cast(tuple[object, ...], last)
        if not isinstance(last, tuple) or len(before) != len(parts):
            before = (None,) * len(parts)
        return sum(size_of(part, other) for part, other in zip(parts, before, strict=True))
    return 0


def size_of_state(state: KeptState | None, last: KeptState | None) -> int:
    """Bytes of the arrays of a state that are not in the state before."""
    if state is None:
        return 0
    return sum(size for owner, size in state.arrays.items() if last is None or owner not in last.arrays)


class Recorder:
    """Records on the viewer's thread; the page's controls choose on viser's event loop. One lock for both.

    While a frame is chosen, the page shows it, and nothing is recorded. A run that begins again begins a new recording.
    """

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.frames: collections.deque[Kept] = collections.deque()
        self.bytes = 0
        self.last_state: KeptState | None = None
        self.starts = -1
        self.was_running = False  # at the last snapshot: where a frame is chosen the lab pauses a little later
        self.position: int | None = None  # of the frame that is shown; None: the present
        self.playing = False
        self.rate = 1.0
        self.loops = False
        self.advanced_at = 0.0  # [s] of the clock
        self.played = 0.0  # [s] of wall time since the frame at `position` was shown

    def note(self, snapshot: AnySnapshot, wall: float) -> None:
        """Record a snapshot of a running scene. wall: [s] of the clock."""
        with self.lock:
            status = snapshot.status
            if status.running and not self.was_running:  # the lab goes on: the present is shown
                self.position, self.playing = None, False
            self.was_running = status.running
            if status.starts != self.starts:
                self.starts = status.starts
                self.clear()
            while self.position is None and self.frames and self.frames[-1].time > status.time:
                self.bytes -= self.frames.pop().size  # the run has gone on from an earlier moment
            if self.position is not None or (self.frames and status.time == self.frames[-1].time):
                return
            last = self.frames[-1] if self.frames else None
            state = snapshot.state
            if last is not None and state is None and wall - last.wall < 1.0 / MAX_RATE:
                return
            size = size_of(snapshot.frame, None if last is None else last.frame)
            if state is not None:
                size += size_of_state(state, self.last_state)
                self.last_state = state
            self.frames.append(Kept(status.time, wall, snapshot.frame, snapshot.params, size, state))
            self.bytes += size
            while len(self.frames) > 1 and (
                self.bytes > MAX_BYTES or self.frames[-1].time - self.frames[0].time > MAX_DURATION
            ):
                self.bytes -= self.frames.popleft().size

    def clear(self) -> None:
        """Forget all frames, and show the present."""
        self.frames.clear()
        self.bytes, self.last_state = 0, None
        self.position, self.playing = None, False

    def span(self) -> tuple[float, float]:
        """Simulated times [s] of the first and the last frame; (0, 0) where there is none."""
        with self.lock:
            return (self.frames[0].time, self.frames[-1].time) if self.frames else (0.0, 0.0)

    def show_time(self, time: float) -> None:
        """Show the last frame at or before a simulated time [s]."""
        with self.lock:
            if self.frames:
                times = [kept.time for kept in self.frames]
                self.position = max(0, bisect.bisect_right(times, time + 1e-9) - 1)
                self.playing, self.played = False, 0.0

    def show_frame(self, kept: Kept) -> None:
        """Show one frame, unless it is no longer kept."""
        with self.lock:
            self.position = next((i for i, one in enumerate(self.frames) if one is kept), self.position)
            self.playing, self.played = False, 0.0

    def step(self, count: int) -> None:
        """Show a frame `count` further on, or back; from the present, the one before the last."""
        with self.lock:
            if self.frames:
                at = len(self.frames) - 1 if self.position is None else self.position
                self.position = min(max(at + count, 0), len(self.frames) - 1)
                self.playing, self.played = False, 0.0

    def play(self) -> None:
        """Play from the frame that is shown, from the first where that is the last or the present; or stop."""
        with self.lock:
            if not self.frames:
                return
            if self.playing:
                self.playing = False
                return
            if self.position is None or self.position >= len(self.frames) - 1:
                self.position = 0
            self.playing, self.played = True, 0.0

    def show_present(self) -> None:
        """Show what the scene does now."""
        with self.lock:
            self.position, self.playing = None, False

    def advance(self, wall: float) -> None:
        """Play on to `wall` [s] of the clock, at the pace at which the frames came, times `rate`."""
        with self.lock:
            spent, self.advanced_at = wall - self.advanced_at, wall
            if not self.playing or self.position is None:
                return
            self.played += min(spent, MAX_PAUSE) * self.rate
            while self.playing and self.position < len(self.frames) - 1:
                interval = min(self.frames[self.position + 1].wall - self.frames[self.position].wall, MAX_PAUSE)
                if self.played < interval:
                    return
                self.played -= interval
                self.position += 1
            if self.loops:
                self.position = 0
            else:
                self.playing = False

    @property
    def shown(self) -> Kept | None:
        """The frame to show instead of the present; None for the present."""
        with self.lock:
            return None if self.position is None else self.frames[self.position]

    def resumable(self) -> Kept | None:
        """The last frame up to the one that is shown that has a state to go on from; None where there is none."""
        with self.lock:
            if self.position is None:
                return None
            before = (self.frames[i] for i in range(self.position, -1, -1))
            return next((kept for kept in before if kept.state is not None), None)

    def kept(self) -> tuple[Kept, ...]:
        """All frames, the oldest first."""
        with self.lock:
            return tuple(self.frames)
