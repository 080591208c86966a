"""The last minutes of a scene: its frames, in bounded memory, and the one shown instead of the present."""

import bisect
import collections
import math
import threading
from collections.abc import Callable, Mapping
from typing import NamedTuple, cast

import numpy as np

from app.messages import BaseParams, Checkpoint, RunLine
from app.scenes.checkpoints import arrays_in
from app.scenes.contract import AnySnapshot, FramePacking

MAX_BYTES = 150e6  # of the arrays of all kept frames and states
MAX_DURATION = 180.0  # [s] of kept simulated time
MAX_RATE = 30.0  # [1/s] frames kept a second of wall time, and those that have a state; the page may show more
MIN_INTERVAL = 0.8 / MAX_RATE  # [s] of wall time between two: those of a scene at this rate do not come quite evenly
MAX_PAUSE = 0.25  # [s] between two frames as they are played: a pause of the lab is shorter there
RATES = (1.0, 0.5, 0.2, 0.1)  # of playing a recording, as fractions of the recorded rate
THINNED_SHARE = 0.9  # of MAX_BYTES left after thinning
SPACING_GROWTH = 1.1  # factor between two tried spacings
MIN_SPACING, MAX_SPACING = 1e-3, 0.25  # time between two frames over their age, where frames are taken out
STATE_INTERVAL = 0.1  # [s] in which the next frame with a state comes, if copies of states are cheap


class RecordedFrame(NamedTuple):
    """One frame of the recording."""

    time: float  # [s] simulated
    wall: float  # [s] of a clock on which a pause of the lab lasts MAX_PAUSE at most
    packed: object  # the scene's own record, or its packed form
    params: BaseParams
    arrays: Mapping[int, int]  # identity -> bytes of each array of frame and state; some are shared with other frames
    state: Checkpoint | None = None  # to resume from
    packing: FramePacking | None = None

    @property
    def frame(self) -> object:
        """The scene's own record; unpacked at each call if it is packed."""
        return self.packed if self.packing is None else self.packing.unpack(self.packed)


def arrays_of_frame(frame: object) -> dict[int, int]:
    """Identity -> bytes of the arrays in a frame and the tuples in it; other objects are the scene's own."""
    if isinstance(frame, np.ndarray):
        return arrays_in(cast(object, frame))
    sizes: dict[int, int] = {}
    if isinstance(frame, tuple):
        for part in cast(tuple[object, ...], frame):
            sizes.update(arrays_of_frame(part))
    return sizes


class FrameMemory:
    """The bytes of arrays, each counted once, however many frames share it."""

    def __init__(self) -> None:
        self.bytes = 0
        self.holders: dict[int, int] = {}  # identity of an array -> number of frames that hold it

    def add(self, arrays: Mapping[int, int]) -> None:
        """Count the memory of one more frame."""
        for owner, size in arrays.items():
            count = self.holders.get(owner, 0)
            self.holders[owner] = count + 1
            if count == 0:
                self.bytes += size

    def remove(self, arrays: Mapping[int, int]) -> None:
        """Subtract the memory of a frame that is dropped."""
        for owner, size in arrays.items():
            self.holders[owner] -= 1
            if self.holders[owner] == 0:
                del self.holders[owner]
                self.bytes -= size


class Recorder:
    """Records on the viewer's thread; the page's controls choose on viser's event loop. One lock for both.

    While a frame is chosen, the page shows it, and nothing is recorded. Another run begins a new recording; one that
    resumes from a moment of the recording continues it there.
    If memory is short, frames are thinned out: the time between those that stay grows in proportion to their age.
    Frames with a state are preferred.
    """

    def __init__(self, packing: FramePacking | None = None, wake: Callable[[], None] = lambda: None) -> None:
        """packing: of the scene. wake: makes the viewer's thread check the recording at once."""
        self.packing, self.wake = packing, wake
        self.lock = threading.Lock()
        self.frames: collections.deque[RecordedFrame] = collections.deque()
        self.memory = FrameMemory()
        self.spacing = 0.0  # time between frames over their age at the last thinning
        self.noted_at = 0.0  # [s] of the clock, of the last frame
        self.line = RunLine()  # the runs of the frames
        self.was_running = False  # at the last snapshot: after a choice of a frame the lab pauses a little later
        self.position: int | None = None  # of the frame that is shown; None: the present
        self.playing = False
        self.rate = 1.0
        self.loops = False
        self.advanced_at = 0.0  # [s] of the clock
        self.played = 0.0  # [s] of wall time since the frame at `position` was shown

    def follow(self, snapshot: AnySnapshot) -> None:
        """Follow the lab by a snapshot, which decides the shown frame: the lab continued, restarted or went back."""
        with self.lock:
            status = snapshot.status
            if status.running and not self.was_running:  # the lab continues: the present is shown
                self.position, self.playing = None, False
            self.was_running = status.running
            known = self.line.number
            # Within a run time goes back when its last moments are replayed.
            end = min(self.line.follow(status.run), status.time)
            while self.frames and self.frames[-1].time > end:
                self.forget(self.frames.pop())
                self.position, self.playing = None, False
            if self.line.number != known:
                self.position, self.playing, self.spacing = None, False, 0.0

    def note(self, snapshot: AnySnapshot, wall: float) -> None:
        """Record a snapshot of a running scene; best once it is drawn, as its packed form can be kept.

        wall: [s] of the clock.
        """
        self.follow(snapshot)
        with self.lock:
            status = snapshot.status
            if self.position is not None or (self.frames and status.time == self.frames[-1].time):
                return
            last, state = self.frames[-1] if self.frames else None, snapshot.state
            if last is not None and state is None and wall - self.noted_at < MIN_INTERVAL:
                return
            played = 0.0 if last is None else last.wall + min(wall - self.noted_at, MAX_PAUSE)
            self.noted_at = wall
            packed = snapshot.frame if self.packing is None else self.packing.pack(snapshot.frame)
            arrays = arrays_of_frame(packed) | ({} if state is None else dict(state.arrays))
            self.memory.add(arrays)
            self.frames.append(RecordedFrame(status.time, played, packed, snapshot.params, arrays, state, self.packing))
            while status.time - self.frames[0].time > MAX_DURATION:
                self.forget(self.frames.popleft())
            if self.memory.bytes > MAX_BYTES:
                self.make_room()

    def forget(self, frame: RecordedFrame) -> None:
        """Release a frame that is no longer among the others."""
        self.memory.remove(frame.arrays)

    def make_room(self) -> None:
        """Remove frames until there is memory for those of some seconds."""
        self.spacing = max(self.spacing / SPACING_GROWTH, MIN_SPACING)
        while self.memory.bytes > THINNED_SHARE * MAX_BYTES and len(self.frames) > 1:
            if self.spacing < MAX_SPACING:
                self.thin(self.spacing)
                self.spacing *= SPACING_GROWTH
            else:
                self.forget(self.frames.popleft())

    def thin(self, spacing: float) -> None:
        """Remove frames that follow another one sooner than `spacing` times their age."""
        newest, last, last_state = self.frames[-1].time, -math.inf, -math.inf
        frames: collections.deque[RecordedFrame] = collections.deque()
        for frame in self.frames:
            least = spacing * (newest - frame.time)
            wait = least if least * MAX_RATE <= 1.0 else least + STATE_INTERVAL  # for one with a state
            if frame.time - last >= wait or (frame.state is not None and frame.time - last_state >= least):
                frames.append(frame)
                last = frame.time
                last_state = last if frame.state is not None else last_state
            else:
                self.forget(frame)
        self.frames = frames

    def span(self) -> tuple[float, float]:
        """Simulated times [s] of the first and the last frame; (0, 0) without frames."""
        with self.lock:
            return (self.frames[0].time, self.frames[-1].time) if self.frames else (0.0, 0.0)

    def show_time(self, time: float) -> None:
        """Show the last frame at or before a simulated time [s]."""
        with self.lock:
            if self.frames:
                times = [frame.time for frame in self.frames]
                self.position = max(0, bisect.bisect_right(times, time + 1e-9) - 1)
                self.playing, self.played = False, 0.0

    def step(self, count: int) -> None:
        """Show a frame `count` further on, or back; from the present, the one before the last."""
        with self.lock:
            if self.frames:
                at = len(self.frames) - 1 if self.position is None else self.position
                self.position = min(max(at + count, 0), len(self.frames) - 1)
                self.playing, self.played = False, 0.0

    def play(self) -> None:
        """Play from the shown frame, or from the first if that is the last or the present; or stop."""
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
        """Go back to live."""
        with self.lock:
            self.position, self.playing = None, False

    def advance(self, wall: float) -> None:
        """Play up to `wall` [s] of the clock, at the recorded pace times `rate`."""
        with self.lock:
            spent, self.advanced_at = wall - self.advanced_at, wall
            if not self.playing or self.position is None:
                return
            self.played += min(spent, MAX_PAUSE) * self.rate
            while self.playing and self.position < len(self.frames) - 1:
                interval = self.frames[self.position + 1].wall - self.frames[self.position].wall
                if self.played < interval:
                    return
                self.played -= interval
                self.position += 1
            if self.loops:
                self.position = 0
            else:
                self.playing = False

    @property
    def shown_frame(self) -> RecordedFrame | None:
        """The frame to show instead of the present; None for the present."""
        with self.lock:
            return None if self.position is None else self.frames[self.position]

    def resumable(self) -> RecordedFrame | None:
        """The last frame up to the shown one from whose state a run can resume, or None."""
        with self.lock:
            if self.position is None:
                return None
            before = (self.frames[i] for i in range(self.position, -1, -1))
            return next((frame for frame in before if frame.state is not None), None)

    def all_frames(self) -> tuple[RecordedFrame, ...]:
        """All frames, the oldest first."""
        with self.lock:
            return tuple(self.frames)
