"""Files of the run and of a browser's view, in the tab "Share".

Callbacks run on viser's event loop. Each file is made in a separate thread.
"""

import io
import re
import threading
import zipfile
from collections.abc import Callable, Sequence

import viser

from app.messages import Pause
from app.panel.plots import Plots
from app.panel.recording.long_work import LongWork
from app.panel.recording.picture import take_picture
from app.panel.recording.recorder import RecordedFrame, Recorder
from app.panel.recording.recording_files import Plotted, plots_csv, plots_svg, recording_npz
from app.panel.settings import SceneSettings
from app.render.handles.viser_inside import uuid_of
from app.render.handles.viser_types import GuiHandle, ViserEvent
from app.render.markup.html import fill
from app.scenes.contract import AnyKind

PICTURE_SIZES = {  # [pixels]
    "As in the page": (0, 0),
    "1280 x 720": (1280, 720),
    "1920 x 1080": (1920, 1080),
    "3840 x 2160": (3840, 2160),
}
REPLAY_DURATION = 20.0  # [s] of a replay as it plays
REPLAY, ARRAYS, PICTURE = f"Replay (last {REPLAY_DURATION:g} s)", "Data (.npz)", "Picture"
PLOTS, CHARTS, FILM = "Plots as CSV", "Plots as SVG", "Film pictures"
MAX_PICTURES = 900  # of a film: half a minute of a recording
MAX_FILM = 400e6  # [bytes] of all pictures of a film
BARRIER_SIZE = (16, 16)  # [pixels] of a picture that is asked for only to know that what was sent before it has come
# Buttons with a choice. The page makes clips and PNG files of plots, and has the others made (js/panel/share.js).
PAGE_BUTTONS = (
    '<div class="springtide-switches" data-springtide-makers="{}"><label>Plots <select data-springtide-plots>'
    "<option>CSV</option><option>SVG</option><option>PNG</option></select></label>"
    '<button type="button" data-springtide-charts>Save plots</button></div><div class="springtide-switches">'
    '<label>Film <select data-springtide-film><option value="">as a clip</option><option value="{}">as pictures'
    '</option></select></label><button type="button" data-springtide-clip>Record</button></div>'
)

Make = Callable[[viser.ClientHandle, LongWork], tuple[str, bytes]]  # name and content of a file
MakeReplay = Callable[[AnyKind, Sequence[RecordedFrame], Plotted], str]


class Files:
    """The buttons that make a file; `add_run` and `add` put them into the folder that is open."""

    def __init__(
        self,
        server: viser.ViserServer,
        settings: SceneSettings,
        recorder: Recorder,
        plots: Plots,
        make_replay: MakeReplay,
    ) -> None:
        """make_replay: makes the page of a replay."""
        self.server, self.settings, self.recorder, self.plots = server, settings, recorder, plots
        self.make_replay = make_replay
        self.busy = threading.Lock()  # one file at a time

    def add_run(self) -> None:
        """The files that hold the run."""
        self.server.gui.add_button_group("", (REPLAY, ARRAYS)).on_click(self.on_file)

    def add(self) -> None:
        """The other files."""
        gui = self.server.gui
        makers: GuiHandle = gui.add_button_group("", (PLOTS, CHARTS, FILM), visible=False)
        makers.on_click(self.on_file)
        makers.visible = not uuid_of(makers)  # the page presses them
        gui.add_html(str(fill(PAGE_BUTTONS, uuid_of(makers), FILM)))
        self.size = gui.add_dropdown("Picture size", tuple(PICTURE_SIZES))
        self.transparent = gui.add_checkbox("Transparent background", initial_value=False)
        gui.add_button_group("", (PICTURE,)).on_click(self.on_file)

    async def on_file(self, event: ViserEvent) -> None:
        """Make a file in a separate thread, and send it to the browser that asks."""
        client = event.client
        if client is None:
            return
        settings, plots, kind = self.settings, self.plots, self.settings.kind
        makers: dict[str, Make] = {
            PLOTS: lambda _, __: (file_name(settings, ".csv"), plots_csv(kind, plots.plotted()).encode()),
            CHARTS: lambda _, __: (file_name(settings, ".svg"), plots_svg(kind, plots.plotted()).encode()),
            PICTURE: self.picture_file,
            REPLAY: lambda _, __: self.replay_file(),
            ARRAYS: lambda _, __: (file_name(settings, ".npz"), recording_npz(kind, self.recorder.kept())),
            FILM: self.film_file,
        }
        if not self.busy.acquire(blocking=False):
            client.add_notification(event.target.value, "Another file is still being created.", auto_close_seconds=10.0)
            return
        make, work = makers[event.target.value], LongWork(client, event.target.value, "Couldn't create the file")
        work.start(lambda: self.send(make, client, work), self.busy.release)

    def send(self, make: Make, client: viser.ClientHandle, work: LongWork) -> str:
        """Make a file and send it; returns the words on its end."""
        name, content = make(client, work)
        client.send_file_download(name, content, save_immediately=True)
        return f"{name}, {len(content) / 1e6:.2f} MB, was sent to the browser."

    def picture_file(self, client: viser.ClientHandle, _: LongWork) -> tuple[str, bytes]:
        """One browser's view, drawn again at the chosen size. Raises ValueError where it is of another scene by now."""
        picture = take_picture(client, PICTURE_SIZES[self.size.value], transparent=self.transparent.value)
        self.check_open()
        return file_name(self.settings, ".png"), picture

    def check_open(self) -> None:
        """Raise ValueError where another scene is shown."""
        if not self.settings.is_open:
            raise ValueError("another scene was opened before it was ready")

    def film_file(self, client: viser.ClientHandle, work: LongWork) -> tuple[str, bytes]:
        """A PNG of every frame of the recording from the one that is shown on, drawn by one browser, in a ZIP file.

        Raises ValueError where nothing was recorded, or where a hand chose another moment meanwhile.
        """
        frames = self.recorder.kept()
        if not frames:
            raise ValueError("nothing has been recorded yet: let the scene run first")
        shown = self.recorder.shown
        start = 0 if shown is None else next((i for i, kept in enumerate(frames) if kept is shown), 0)
        chosen = frames[start : start + MAX_PICTURES]
        self.settings.post(Pause())
        size, transparent = PICTURE_SIZES[self.size.value], self.transparent.value
        content, times = io.BytesIO(), ["picture,t [s]"]
        with zipfile.ZipFile(content, "w", zipfile.ZIP_STORED) as film:
            for number, kept in enumerate(chosen, 1):
                if number > 1 and self.recorder.shown is not chosen[number - 2]:
                    raise ValueError("another moment was chosen before all pictures were taken")
                self.recorder.send_frame(kept)
                self.server.flush()
                take_picture(client, BARRIER_SIZE)
                film.writestr(f"{number:04d}.png", take_picture(client, size, transparent=transparent))
                self.check_open()
                times.append(f"{number:04d}.png,{kept.time!r}")
                work.say(f"{number} of {len(chosen)}. Click any other moment to stop.")
                if content.tell() > MAX_FILM:
                    break
            film.writestr("times.csv", "\n".join(times) + "\n")
        return file_name(self.settings, "-film.zip"), content.getvalue()

    def replay_file(self) -> tuple[str, bytes]:
        """The recording up to the moment that is shown as one page. Raises ValueError where nothing was recorded."""
        shown = self.recorder.shown
        frames = [kept for kept in self.recorder.kept() if shown is None or kept.time <= shown.time]
        page = self.make_replay(self.settings.kind, frames, self.plots.plotted())
        return file_name(self.settings, ".html"), page.encode()


def file_name(settings: SceneSettings, end: str, name: str = "") -> str:
    """Name of a file of the set-up. end: its extension and the word before it. name: of the set-up, if any."""
    said = name or f"{settings.kind.name} {settings.other_name or settings.loaded}"
    return "springtide-" + "-".join(re.findall(r"[\w.]+", said.removeprefix("Mine: "))).lower() + end
