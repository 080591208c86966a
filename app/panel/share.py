"""The folder "Record and share": the timeline of the recording, links, set-ups, and files of what was recorded.

Callbacks run on viser's event loop; `update` runs on the viewer's thread. What takes long runs in a thread of its own.
"""

# pyright: reportPrivateUsage=false

import io
import threading
import time
import traceback
import zipfile
from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np
import viser

from app.messages import BaseParams, KeptState, Pause, Vector
from app.panel.compare import Beside
from app.panel.picture import take_picture
from app.panel.questions import Asker, Ballot, Questions, Subject
from app.panel.recorder import RATES, Kept, Recorder
from app.panel.recording_files import Plotted, plots_csv, plots_svg, recording_npz
from app.render.cameras import place_camera
from app.render.html import fill, note
from app.render.viser_inside import uuid_of
from app.render.viser_types import GuiHandle, ViserEvent
from app.scenes.comparisons import comparison_named
from app.scenes.contract import AnyKind, AnySnapshot, PostCommand
from app.scenes.own_setups import keep_own, remove_own
from app.scenes.setups import (
    MAX_NAME,
    MAX_NOTE,
    Camera,
    Setup,
    missing_hull,
    read_file,
    read_query,
    write_file,
    write_query,
)

SPAN_INTERVAL = 0.5  # [s] between two updates of the timeline's ends
SLIDER_STEP = 0.01  # [s] of the timeline
HAND_TIME = 1.0  # [s] after a hand has moved the timeline in which it is left to the hand
PICTURE_SIZES = {  # [pixels]
    "As in the page": (0, 0),
    "1280 x 720": (1280, 720),
    "1920 x 1080": (1920, 1080),
    "3840 x 2160": (3840, 2160),
}
BACK, FORWARD, PRESENT = "◀ Back", "Forward ▶", "Now"
CONTINUE = "Continue from here"
COPY, SAVE, PLOTS, PICTURE, REPLAY = "Copy link", "Save set-up", "Plots as CSV", "Picture", "Replay"
KEEP_CURVES, DROP_CURVES = "Keep curves", "Drop curves"
KEEP, REMOVE = "Keep as preset", "Remove preset"
CHARTS, ARRAYS, FILM = "Plots as SVG", "Arrays", "Film pictures"
MAX_PICTURES = 900  # of a film: half a minute of a recording
MAX_FILM = 400e6  # [bytes] of all pictures of a film
BARRIER_SIZE = (16, 16)  # [pixels] of a picture that is asked for only to know that what was sent before it has come
DRAWN_TIMEOUT = 5.0  # [s] for the viewer's thread to send a frame of the recording
# Buttons that the page itself answers (app/render/js/share.js).
PAGE_BUTTONS = (
    '<div class="springtide-switches"><button type="button" data-springtide-clip>Record clip</button>'
    '<button type="button" data-springtide-charts>Plots as PNG</button></div>'
)
COMPARE = "?compare="  # begins the address of a comparison that is ready

# What `app/render/js/charts.js` reads the time of the line in the charts from.
MOMENT = '<b data-springtide-moment="{}">Shown: t = {:.2f} s of the recording.</b>'

MakeReplay = Callable[[AnyKind, Sequence[Kept], Plotted], str]


class Settings(Protocol):
    """What the folder needs of the panel."""

    kind: AnyKind
    loaded: str
    beside: Beside | None

    @property
    def params(self) -> BaseParams:
        """The parameters as set now."""
        ...

    def show_setup(self, setup: Setup, client: int | None) -> None:
        """Show a set-up, of this scene or another; the camera is that of one browser."""
        ...

    def resume(self, params: BaseParams, state: KeptState) -> None:
        """Have the scene go on from a state, with the parameters that it had then."""
        ...

    def show_own(self, chosen: str = "") -> None:
        """Read the user's own set-ups again. chosen: the one that the parameters are those of, if any."""
        ...

    def keep_curves(self, on: bool) -> float | None:
        """Keep the curves of the plots beside those of the runs that follow, or drop them; the last time kept [s]."""
        ...

    def plotted(self) -> Plotted:
        """The rows of the plots that are kept, and the whole charts of now."""
        ...


class Share:
    """The folder, and the hidden field through which a page sends its address or a file."""

    def __init__(
        self,
        server: viser.ViserServer,
        lab: viser.GuiFolderHandle,
        panel: Settings,
        recorder: Recorder,
        post: PostCommand,
        wake: Callable[[], None],
        make_replay: MakeReplay,
        questions: Questions,
    ) -> None:
        """lab: the folder that stays in sight. wake: has the viewer's thread look at the recorder.

        make_replay: makes the page of a replay. questions: those of this server.
        """
        self.server, self.panel, self.recorder, self.post = server, panel, recorder, post
        self.wake, self.make_replay = wake, make_replay
        self.gui = gui = server.gui
        self.span_at = self.moved_at = 0.0
        self.span: tuple[float, float] = (0.0, 0.0)
        self.sent: Kept | None = None  # the frame of the recording that the viewer sent last
        self.busy = threading.Lock()  # one file at a time
        self.questions = questions
        self.ballot = Ballot(server, lab, questions, self.show, self.refuse)
        with lab:
            self.moment = gui.add_html("", visible=False)
        self.inbox: GuiHandle = gui.add_text("From the page", "", multiline=True, visible=False)
        self.inbox.on_update(self.on_inbox)
        holder = fill('<span data-springtide-inbox="{}"></span>', uuid_of(self.inbox))
        gui.add_html(str(holder))
        with gui.add_folder("Record and share", expand_by_default=False):
            self.time = gui.add_slider("Recorded [s]", 0.0, 1.0, SLIDER_STEP, 0.0, disabled=True)
            self.time.on_update(self.on_time)
            self.steps = gui.add_button_group("", (BACK, "Play", FORWARD, PRESENT))
            self.steps.on_click(self.on_step)
            self.resume = gui.add_button(
                CONTINUE,
                disabled=True,
                hint="From the moment that is shown; what came later is forgotten",
            )
            self.resume.on_click(self.on_resume)
            self.rate = gui.add_dropdown("Rate", tuple(f"×{rate:g}" for rate in RATES), hint="Of playing the recording")
            self.rate.on_update(self.on_rate)
            self.loop = gui.add_checkbox("Repeat", initial_value=False, hint="Play the recording again and again")
            self.loop.on_update(self.on_loop)
            self.curves = gui.add_button_group("", (KEEP_CURVES, DROP_CURVES))
            self.curves.on_click(self.on_curves)
            self.state = gui.add_html("")
            self.name = gui.add_text(
                "Name", "", hint=f"Of the set-up that is saved, kept or removed, at most {MAX_NAME} characters"
            )
            self.note = gui.add_text("Note", "", hint=f"Kept with the set-up, at most {MAX_NOTE} characters")
            self.links = gui.add_button_group("", (COPY, SAVE))
            self.links.on_click(self.on_link)
            self.own = gui.add_button_group("", (KEEP, REMOVE))
            self.own.on_click(self.on_own)
            gui.add_html(
                '<div class="springtide-switches"><label class="springtide-load">Load set-up …'
                '<input type="file" accept=".json,.html,.npz" data-springtide-load></label></div>'
            )
            self.size = gui.add_dropdown("Picture size", tuple(PICTURE_SIZES))
            self.transparent = gui.add_checkbox("Transparent background", initial_value=False)
            self.files = gui.add_button_group("", (PLOTS, PICTURE, REPLAY))
            self.more_files = gui.add_button_group("", (CHARTS, ARRAYS, FILM))
            for group in (self.files, self.more_files):
                group.on_click(self.on_file)
            gui.add_html(PAGE_BUTTONS)
            self.line = gui.add_html("")

    def say(self, text: object) -> None:
        """A line at the end of the folder."""
        self.line.content = note(text) if text else ""

    async def on_inbox(self, event: ViserEvent) -> None:
        """A page has sent its address ("?scene=...") or a file ("{...}"), below a line with the page's own word."""
        (page, _, text), client = self.inbox.value.partition("\n"), event.client
        if not text or client is None:
            return
        self.inbox.value = ""  # so that the same text can come again
        try:
            subject = self.read(text)
        except ValueError as reason:
            self.refuse(client, str(reason))
            return
        missing = missing_hull(subject, getattr(self.panel.params, "hull", "")) if isinstance(subject, Setup) else ""
        if missing:
            client.add_notification("A hull is missing", missing, color="orange", auto_close_seconds=30.0)
        if isinstance(subject, Setup) and (subject.scene, subject.params) == (self.panel.kind.name, self.panel.params):
            self.place(subject, client)
        elif isinstance(subject, str) and self.panel.beside is None:
            return  # a lab beside another opens no comparison
        elif len(self.server.get_clients()) > 1:
            self.questions.ask(subject, Asker(client.client_id, page))
        else:
            self.show(subject, client.client_id)

    def read(self, text: str) -> Subject:
        """What a page has sent. Raises ValueError for what is not allowed."""
        if not text.startswith(COMPARE):
            return read_query(text) if text.startswith("?") else read_file(text)
        name = text.removeprefix(COMPARE)
        comparison_named(name)
        return name

    def show(self, subject: Subject, client: int) -> None:
        """Show a set-up, with its camera for one browser, or a comparison."""
        if isinstance(subject, Setup):
            self.panel.show_setup(subject, client)
        elif self.panel.beside is not None:
            self.panel.beside.compare(comparison_named(subject), True)

    def refuse(self, client: viser.ClientHandle | None, reason: str) -> None:
        """Tell one browser why a set-up was not taken."""
        if client is not None:
            client.add_notification("This set-up was not opened", reason, color="red", auto_close_seconds=30.0)

    def place(self, setup: Setup, client: viser.ClientHandle | None) -> None:
        """Give one browser the camera of a set-up that is shown already."""
        if client is not None and setup.camera is not None:
            place_camera(client.camera, *setup.camera)

    async def on_time(self, event: ViserEvent) -> None:
        """A browser has moved along the timeline: the lab pauses, and shows what was."""
        if event.client_id is not None:
            self.moved_at = time.monotonic()
            self.post(Pause())
            self.recorder.show_time(float(event.target.value))
            self.wake()

    async def on_step(self, event: ViserEvent) -> None:
        """Back, play or stop, forward, now."""
        match event.target.value:
            case name if name == PRESENT:
                self.recorder.show_present()
            case name if name == BACK:
                self.post(Pause())
                self.recorder.step(-1)
            case name if name == FORWARD:
                self.post(Pause())
                self.recorder.step(1)
            case _:
                self.post(Pause())
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
        """Whether playing begins again at its end."""
        self.recorder.loops = bool(event.target.value)

    async def on_link(self, event: ViserEvent) -> None:
        """Show the link, or save the set-up, with the camera of the browser that asks."""
        client = event.client
        if client is None:
            return
        panel = self.panel
        camera = camera_of(client)
        if event.target.value == COPY:
            query = write_query(panel.kind, panel.params, panel.loaded, camera)
            self.say(fill('<a class="springtide-link" data-springtide-link="{}" href="{}">{}</a>', query, query, query))
            return
        try:
            name, words = self.name.value.strip(), self.note.value.strip()
            text = write_file(panel.kind, panel.params, panel.loaded, camera, name=name, note=words)
        except ValueError as reason:
            self.say(str(reason))
            return
        client.send_file_download(f"springtide-{panel.kind.name}.json", text.encode(), save_immediately=True)
        self.say("The set-up was sent to the browser as a file.")

    async def on_curves(self, event: ViserEvent) -> None:
        """Keep the curves of the plots over time beside those of the next run, or drop them."""
        on = event.target.value == KEEP_CURVES
        end = self.panel.keep_curves(on)
        if end is None:
            self.say("There are no curves over time to keep." if on else "")
        else:
            self.say(fill("Kept: the curves up to t = {:.2f} s. They are dashed.", end))

    async def on_own(self, event: ViserEvent) -> None:
        """Keep what is set in the list of presets under its name, or remove what has that name."""
        client, panel, name = event.client, self.panel, self.name.value.strip()
        if client is None:
            return
        try:
            if event.target.value == KEEP:
                text = write_file(panel.kind, panel.params, panel.loaded, name=name, note=self.note.value.strip())
                keep_own(panel.kind, name, text)
                panel.show_own(name)
                self.say(fill("{} is now in the list of presets.", name))
            else:
                remove_own(panel.kind, name)
                panel.show_own()
                self.say(fill("{} was removed from the list of presets.", name))
        except (ValueError, OSError) as reason:
            self.say(str(reason))

    async def on_file(self, event: ViserEvent) -> None:
        """Make a file in a thread of its own, and send it to the browser that asks."""
        client = event.client
        if client is None:
            return
        make = {
            PLOTS: self.plots_file,
            CHARTS: self.charts_file,
            PICTURE: self.picture_file,
            REPLAY: self.replay_file,
            ARRAYS: self.arrays_file,
            FILM: self.film_file,
        }[event.target.value]
        if not self.busy.acquire(blocking=False):
            self.say("Another file is still being made.")
            return
        self.say(f"{event.target.value}: being made …")
        threading.Thread(target=self.send, args=(make, client), name="file for the page", daemon=True).start()

    def send(self, make: Callable[[viser.ClientHandle], tuple[str, bytes]], client: viser.ClientHandle) -> None:
        """Make a file and send it; whatever goes wrong is said in the folder."""
        try:
            name, content = make(client)
            client.send_file_download(name, content, save_immediately=True)
            self.say(f"{name}, {len(content) / 1e6:.2f} MB, was sent to the browser.")
        except (ValueError, TimeoutError, RuntimeError) as reason:
            self.say(f"No file was made: {reason}")
        except Exception as error:
            traceback.print_exc()
            self.say(f"No file was made: {type(error).__name__}: {error}")
        finally:
            self.busy.release()

    def plots_file(self, client: viser.ClientHandle) -> tuple[str, bytes]:
        """All plots as CSV with names and units. Raises ValueError where there are none."""
        kind = self.panel.kind
        return f"springtide-{kind.name}.csv", plots_csv(kind, self.panel.plotted()).encode()

    def picture_file(self, client: viser.ClientHandle) -> tuple[str, bytes]:
        """What one browser shows, drawn again at the chosen size."""
        picture = take_picture(client, PICTURE_SIZES[self.size.value], transparent=self.transparent.value)
        return f"springtide-{self.panel.kind.name}.png", picture

    def charts_file(self, client: viser.ClientHandle) -> tuple[str, bytes]:
        """All plots as SVG. Raises ValueError where there are none."""
        kind = self.panel.kind
        return f"springtide-{kind.name}.svg", plots_svg(kind, self.panel.plotted()).encode()

    def arrays_file(self, client: viser.ClientHandle) -> tuple[str, bytes]:
        """The arrays of the recording. Raises ValueError where nothing was recorded."""
        kind = self.panel.kind
        return f"springtide-{kind.name}.npz", recording_npz(kind, self.recorder.kept())

    def film_file(self, client: viser.ClientHandle) -> tuple[str, bytes]:
        """A PNG of every frame of the recording from the one that is shown on, drawn by one browser, in a ZIP file.

        Raises ValueError where nothing was recorded, or where a hand chose another moment meanwhile.
        """
        frames = self.recorder.kept()
        if not frames:
            raise ValueError("nothing has been recorded yet: let the scene run first")
        shown = self.recorder.shown
        start = 0 if shown is None else next((i for i, kept in enumerate(frames) if kept is shown), 0)
        chosen = frames[start : start + MAX_PICTURES]
        self.post(Pause())
        size, transparent = PICTURE_SIZES[self.size.value], self.transparent.value
        content, times = io.BytesIO(), ["picture,t [s]"]
        with zipfile.ZipFile(content, "w", zipfile.ZIP_STORED) as film:
            for number, kept in enumerate(chosen, 1):
                if number > 1 and self.recorder.shown is not chosen[number - 2]:
                    raise ValueError("another moment was chosen before all pictures were taken")
                self.recorder.show_frame(kept)
                self.wait_until_sent(kept)
                take_picture(client, BARRIER_SIZE)
                film.writestr(f"{number:04d}.png", take_picture(client, size, transparent=transparent))
                times.append(f"{number:04d}.png,{kept.time!r}")
                self.say(f"{FILM}: {number} of {len(chosen)}. Choose another moment to end it.")
                if content.tell() > MAX_FILM:
                    break
            film.writestr("times.csv", "\n".join(times) + "\n")
        return f"springtide-{self.panel.kind.name}-film.zip", content.getvalue()

    def wait_until_sent(self, kept: Kept) -> None:
        """Wait until the viewer's thread has sent a frame of the recording. Raises TimeoutError."""
        end = time.monotonic() + DRAWN_TIMEOUT
        while self.sent is not kept:
            if time.monotonic() > end:
                raise TimeoutError("the recording could not be shown")
            self.wake()
            time.sleep(0.01)
        self.server.flush()

    def replay_file(self, client: viser.ClientHandle) -> tuple[str, bytes]:
        """The recording up to the moment that is shown as one page. Raises ValueError where nothing was recorded."""
        shown = self.recorder.shown
        frames = [kept for kept in self.recorder.kept() if shown is None or kept.time <= shown.time]
        page = self.make_replay(self.panel.kind, frames, self.panel.plotted())
        return f"springtide-{self.panel.kind.name}.html", page.encode()

    def update(self, snapshot: AnySnapshot) -> None:
        """Keep questions and timeline up to date."""
        self.ballot.draw()
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
        words = note(fill("Recorded: {:.1f} s, {:.0f} MB", high - low, self.recorder.memory.bytes / 1e6))
        if self.state.content != words:
            self.state.content = words
        words = "" if shown is None else note(fill(MOMENT, shown.time, shown.time))
        if self.moment.content != words:
            self.moment.content, self.moment.visible = words, bool(words)
            self.resume.disabled = not words


def camera_of(client: viser.ClientHandle) -> Camera:
    """Position and target of a browser's camera [m]."""

    def vector(values: np.ndarray) -> Vector:
        return float(values[0]), float(values[1]), float(values[2])

    return vector(client.camera.position), vector(client.camera.look_at)
