"""The time line of the recording, which the page draws along the foot of the scene (`app/render/js/panel/timeline.js`).

Actions of pages come on viser's event loop; `update` runs on the viewer's thread.
"""

import json
import math
import time
from collections.abc import Callable

import viser

from app.messages import Pause, Play
from app.panel.recording.recorder import RATES, Recorder
from app.panel.settings import SceneSettings
from app.render.handles.viser_inside import uuid_of
from app.render.handles.viser_types import GuiHandle, ViserEvent
from app.render.markup.html import fill

SPAN_INTERVAL = 0.5  # [s] between two updates of the time line's ends


class Timeline:
    """State of the recording for the pages, and the hidden field through which they send actions."""

    def __init__(self, gui: viser.GuiApi, recorder: Recorder, settings: SceneSettings) -> None:
        self.recorder, self.settings = recorder, settings
        self.span_at = 0.0
        self.told: tuple[object, ...] = ()  # known to the pages: time of the shown frame, whether it plays, and the run
        self.is_running = False  # the lab, at the last update
        self.ran_before = False  # the lab was running when a page chose a frame
        self.actions: dict[str, Callable[[float], None]] = {
            "show": self.show, "step": self.step, "play": self.play, "live": self.go_live,
            "continue": self.resume, "rate": self.set_rate, "loop": self.set_loop,
        }  # fmt: skip
        self.inbox: GuiHandle = gui.add_text("Time line", "", multiline=True, visible=False)
        self.inbox.on_update(self.on_inbox)
        self.state = gui.add_html("")

    async def on_inbox(self, _: ViserEvent) -> None:
        """Take a page's message: its own word, which is new each time, an action, its number, and the run's number.

        A time of another run than the recorded one is ignored.
        """
        words = self.inbox.value.split()
        try:
            action, number, run = self.actions[words[1]], float(words[2]), int(words[3])
        except (LookupError, ValueError):
            return
        if math.isfinite(number) and run == self.recorder.line.number:
            action(number)
            self.recorder.wake()

    def hold(self) -> None:
        """Pause the lab for a look back."""
        if self.recorder.shown is None:
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
        if self.recorder.shown is not None and self.ran_before:
            self.settings.post(Play())
        self.recorder.show_present()

    def resume(self, moment: float) -> None:
        """Continue from a time [s] of the recording, or from the last state before it; without one, look back at it."""
        self.hold()
        self.recorder.show_time(moment)
        kept = self.recorder.resumable()
        if kept is not None and kept.state is not None:
            self.settings.resume(kept.params, kept.state)

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
        recorder, shown = self.recorder, self.recorder.shown
        present = None if shown is None else shown.time, recorder.playing, recorder.line.number
        if present == self.told and now - self.span_at < SPAN_INTERVAL:
            return
        self.span_at, self.told = now, present
        low, high = recorder.span()
        state = {
            "inbox": uuid_of(self.inbox),
            "run": recorder.line.number,
            "low": round(low, 3),
            "high": round(high, 3),
            "shown": None if shown is None else round(shown.time, 3),
            "playing": recorder.playing,
            "resumable": shown is not None and recorder.resumable() is not None,
            "rate": recorder.rate,
            "rates": RATES,
            "loops": recorder.loops,
            "size": size_words(recorder.memory.bytes),
        }
        self.state.content = str(fill('<span data-springtide-time="{}"></span>', json.dumps(state)))


def size_words(size: float) -> str:
    """A number of bytes in words."""
    return "less than 1 MB" if size < 1e6 else f"{size / 1e6:.0f} MB"
