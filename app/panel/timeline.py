"""The timeline of the recording, in the tab "Share".

Callbacks run on viser's event loop; `update` runs on the viewer's thread.
"""

import time
from collections.abc import Callable
from typing import TYPE_CHECKING

import viser

from app.messages import Pause
from app.panel.recorder import RATES
from app.render.html import fill, note
from app.render.viser_types import ViserEvent

if TYPE_CHECKING:
    from app.panel.panel import Panel

SPAN_INTERVAL = 0.5  # [s] between two updates of the timeline's ends
SLIDER_STEP = 0.01  # [s] of the timeline
HAND_TIME = 1.0  # [s] after a hand has moved the timeline in which it is left to the hand
BACK, FORWARD, PRESENT = "◀ Back", "Forward ▶", "Back to live"
CONTINUE = "Continue from here"
# `app/render/js/charts.js` reads the time of the line in the charts from it.
MOMENT = '<b data-springtide-moment="{}">Shown: t = {:.2f} s of the recording.</b>'


class Timeline:
    """The controls of the recording, in the folder that is open here."""

    def __init__(
        self, panel: "Panel", moment: viser.GuiHtmlHandle, wake: Callable[[], None], say: Callable[[object], None]
    ) -> None:
        """moment: the line with the shown time. wake: makes the viewer's thread look at the recorder.

        say: shows a line.
        """
        self.panel, self.recorder, self.moment, self.wake, self.say = panel, panel.recorder, moment, wake, say
        gui = panel.gui
        self.span_at = self.moved_at = 0.0
        self.span: tuple[float, float] = (0.0, 0.0)
        self.time = gui.add_slider("Recorded [s]", 0.0, 1.0, SLIDER_STEP, 0.0, disabled=True)
        self.time.on_update(self.on_time)
        self.steps = gui.add_button_group("", (BACK, "Play", FORWARD, PRESENT))
        self.steps.on_click(self.on_step)
        self.resume = gui.add_button(
            CONTINUE, disabled=True, hint="From the moment that is shown; what came later is forgotten"
        )
        self.resume.on_click(self.on_resume)
        self.rate = gui.add_dropdown(
            "Playback speed", tuple(f"×{rate:g}" for rate in RATES), hint="Of playing the recording"
        )
        self.rate.on_update(self.on_rate)
        self.loop = gui.add_checkbox("Loop", initial_value=False, hint="Play the recording again and again")
        self.loop.on_update(self.on_loop)
        self.state = gui.add_html("")

    async def on_time(self, event: ViserEvent) -> None:
        """A browser has moved along the timeline: the lab pauses and shows that moment."""
        if event.client_id is not None:
            self.moved_at = time.monotonic()
            self.panel.post(Pause())
            self.recorder.show_time(float(event.target.value))
            self.wake()

    async def on_step(self, event: ViserEvent) -> None:
        """Back, play or stop, forward, now."""
        match event.target.value:
            case name if name == PRESENT:
                self.recorder.show_present()
            case name if name == BACK:
                self.panel.post(Pause())
                self.recorder.step(-1)
            case name if name == FORWARD:
                self.panel.post(Pause())
                self.recorder.step(1)
            case _:
                self.panel.post(Pause())
                self.recorder.play()
        self.wake()

    async def on_resume(self, event: ViserEvent) -> None:
        """Go on from the moment that is shown, or from the last state before it."""
        kept = self.recorder.resumable()
        if kept is None or kept.state is None:
            self.say("No state was kept that early. Choose a later moment.")
            return
        self.say(fill("The run goes on from t = {:.2f} s.", kept.time))
        self.panel.resume(kept.params, kept.state)

    async def on_rate(self, event: ViserEvent) -> None:
        """The pace of playing."""
        self.recorder.rate = float(str(event.target.value).removeprefix("×"))

    async def on_loop(self, event: ViserEvent) -> None:
        """True if playing begins again at its end."""
        self.recorder.loops = bool(event.target.value)

    def update(self) -> None:
        """Keep the timeline up to date."""
        now = time.monotonic()
        shown = self.recorder.shown
        if shown is None and now - self.span_at < SPAN_INTERVAL:
            return
        self.span_at = now
        low, high = self.recorder.span()
        if (low, high) != self.span:
            self.span = low, high
            self.time.disabled = high <= low
            if high > low:
                self.time.min, self.time.max = round(low, 2), round(high, 2)
        at = high if shown is None else shown.time
        held = now - self.moved_at < HAND_TIME and not self.recorder.playing  # what comes late would pull it back
        if not held and self.span[1] > self.span[0] and abs(self.time.value - at) > 0.5 * SLIDER_STEP:
            self.time.value = round(min(max(at, self.time.min), self.time.max), 2)
        recorded = fill("Recorded: {:.1f} s, {}", high - low, size_words(self.recorder.memory.bytes))
        self.state.content = note(recorded)
        self.moment.content = "" if shown is None else note(fill(MOMENT, shown.time, shown.time))
        self.moment.visible, self.resume.disabled = shown is not None, shown is None


def size_words(size: float) -> str:
    """A number of bytes in words."""
    return "less than 1 MB" if size < 1e6 else f"{size / 1e6:.0f} MB"
