"""The time line of the recording, which the page draws along the foot of the scene (`app/render/js/panel/timeline.js`).

Actions of pages come on viser's event loop; `update` runs on the viewer's thread.
"""

import time
from collections.abc import Callable

from app.messages import Pause, Play
from app.panel.recording.recorder import RATES, Recorder
from app.panel.settings import SceneSettings
from app.render.handles.channel import Channel, Message, finite

SPAN_INTERVAL = 0.5  # [s] between two updates of the time line's ends


class Timeline:
    """State of the recording for the pages, and their actions."""

    def __init__(self, channel: Channel, recorder: Recorder, settings: SceneSettings) -> None:
        self.channel, self.recorder, self.settings = channel, recorder, settings
        self.span_at = 0.0
        self.told: tuple[object, ...] = ()  # known to the pages: time of the shown frame, whether it plays, and the run
        self.is_running = False  # the lab, at the last update
        self.ran_before = False  # the lab was running when a page chose a frame
        self.actions: dict[str, Callable[[float], None]] = {
            "show": self.show, "step": self.step, "play": self.play, "live": self.go_live,
            "continue": self.resume, "rate": self.set_rate, "loop": self.set_loop,
        }  # fmt: skip
        channel.listen("time", list, self.act)

    def act(self, message: Message[list[object]]) -> None:
        """Carry out a page's action: its name, a number, and the number of the run.

        A time of another run than the recorded one is ignored.
        """
        action, numbers = self.actions.get(str(next(iter(message.value), ""))), finite(message.value[1:], 2)
        if action is not None and numbers is not None and numbers[1] == self.recorder.line.number:
            action(numbers[0])
            self.recorder.wake()

    def hold(self) -> None:
        """Pause the lab for a look back."""
        if self.recorder.shown_frame is None:
            self.ran_before = self.is_running
        self.settings.post(Pause())

    def show(self, moment: float) -> None:
        """Show a time [s] of the recording."""
        self.hold()
        self.recorder.show_time(moment)

    def step(self, count: float) -> None:
        """Show a frame `count` further on, or back."""
        self.hold()
        self.recorder.step(round(count))

    def play(self, _: float) -> None:
        """Play the recording from the shown frame, or stop."""
        self.hold()
        self.recorder.play()

    def go_live(self, _: float) -> None:
        """Show the present; the lab runs again if it ran before the look back."""
        if self.recorder.shown_frame is not None and self.ran_before:
            self.settings.post(Play())
        self.recorder.show_present()

    def resume(self, moment: float) -> None:
        """Continue from a time [s] of the recording, or from the last state before it; without one, look back at it."""
        self.hold()
        self.recorder.show_time(moment)
        frame = self.recorder.resumable()
        if frame is not None and frame.state is not None:
            self.settings.resume(frame.params, frame.state)

    def set_rate(self, rate: float) -> None:
        """Set the speed of playing the recording."""
        if rate in RATES:
            self.recorder.rate = rate

    def set_loop(self, on: float) -> None:
        """Play the recording in a loop, or once."""
        self.recorder.loops = on > 0.0

    def update(self, *, running: bool) -> None:
        """Update the pages. running: the lab runs."""
        self.is_running = running
        now = time.monotonic()
        recorder, frame = self.recorder, self.recorder.shown_frame
        present = None if frame is None else frame.time, recorder.playing, recorder.line.number
        if present == self.told and now - self.span_at < SPAN_INTERVAL:
            return
        self.span_at, self.told = now, present
        low, high = recorder.span()
        state = {
            "run": recorder.line.number,
            "low": round(low, 3),
            "high": round(high, 3),
            "shown": None if frame is None else round(frame.time, 3),
            "playing": recorder.playing,
            "resumable": frame is not None and recorder.resumable() is not None,
            "rate": recorder.rate,
            "rates": RATES,
            "loops": recorder.loops,
            "size": size_words(recorder.memory.bytes),
        }
        self.channel.tell("time", state)


def size_words(size: float) -> str:
    """A number of bytes in words."""
    return "less than 1 MB" if size < 1e6 else f"{size / 1e6:.0f} MB"
