"""Files of the run and of a browser's view, in the tab "Share".

Callbacks run on viser's event loop. Each file is made in a separate thread.
"""

import re
import threading
from collections.abc import Callable, Sequence

import viser

from app.panel.plots import Plots
from app.panel.recording.long_work import LongWork
from app.panel.recording.picture import take_picture
from app.panel.recording.recorder import RecordedFrame, Recorder
from app.panel.recording.recording_files import Plotted, plots_csv, plots_svg, recording_npz
from app.panel.settings import SceneSettings
from app.render.handles.channel import Message, channel_of
from app.render.handles.viser_types import ViserEvent
from app.scenes.contract import AnyKind

PICTURE_SIZES = {  # [pixels]
    "As in the page": (0, 0),
    "1280 x 720": (1280, 720),
    "1920 x 1080": (1920, 1080),
    "3840 x 2160": (3840, 2160),
}
REPLAY_DURATION = 20.0  # [s] playing time of a replay
REPLAY, ARRAYS, PICTURE = f"Replay (last {REPLAY_DURATION:g} s)", "Data (.npz)", "Picture"
PLOTS, CHARTS = "Plots as CSV", "Plots as SVG"
# The page makes clips and PNG files of plots, and has the other plots made (js/sharing/share.js).
PAGE_BUTTONS = (
    '<div class="springtide-switches"><label>Plots <select data-springtide-choice="plots">'
    "<option>CSV</option><option>SVG</option><option>PNG</option></select></label>"
    '<button type="button" data-springtide-act="plots">Save plots</button>'
    '<button type="button" data-springtide-act="clip">Record clip</button></div>'
)

Make = Callable[[viser.ClientHandle], tuple[str, bytes]]  # name and content of a file
MakeReplay = Callable[[AnyKind, Sequence[RecordedFrame], Plotted], str]


class Files:
    """The buttons that make a file; `add_run` and `add` put them into the open folder."""

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
        channel_of(server).listen("plots", str, self.make_plots)

    def add_run(self) -> None:
        """Add the files of the run."""
        self.server.gui.add_button_group("", (REPLAY, ARRAYS)).on_click(self.on_file)

    def add(self) -> None:
        """Add the other files."""
        gui = self.server.gui
        gui.add_html(PAGE_BUTTONS)
        self.size = gui.add_dropdown("Picture size", tuple(PICTURE_SIZES))
        self.transparent = gui.add_checkbox("Transparent background", initial_value=False)
        gui.add_button_group("", (PICTURE,)).on_click(self.on_file)

    async def on_file(self, event: ViserEvent) -> None:
        """Make the file of a button."""
        if event.client is not None:
            self.make(event.target.value, event.client)

    def make_plots(self, message: Message[str]) -> None:
        """Make the plots in the form that a page asks for."""
        if message.value in (PLOTS, CHARTS):
            self.make(message.value, message.client)

    def make(self, name: str, client: viser.ClientHandle) -> None:
        """Make a file in a separate thread, and send it to the requesting browser."""
        settings, plots, kind = self.settings, self.plots, self.settings.kind
        makers: dict[str, Make] = {
            PLOTS: lambda _: (file_name(settings, ".csv"), plots_csv(kind, plots.plotted()).encode("utf-8-sig")),
            CHARTS: lambda _: (file_name(settings, ".svg"), plots_svg(kind, plots.plotted()).encode()),
            PICTURE: self.picture_file,
            REPLAY: lambda _: self.replay_file(),
            ARRAYS: lambda _: (file_name(settings, ".npz"), recording_npz(kind, self.recorder.all_frames())),
        }
        if not self.busy.acquire(blocking=False):
            client.add_notification(name, "Another file is still being created.", auto_close_seconds=10.0)
            return
        make, work = makers[name], LongWork(client, name, "Couldn't create the file")
        work.start(lambda: self.send(make, client), self.busy.release)

    def send(self, make: Make, client: viser.ClientHandle) -> str:
        """Make a file and send it; returns the words on its end."""
        name, content = make(client)
        client.send_file_download(name, content, save_immediately=True)
        return f"{name}, {len(content) / 1e6:.2f} MB, was sent to the browser."

    def picture_file(self, client: viser.ClientHandle) -> tuple[str, bytes]:
        """One browser's view, drawn again at the chosen size. Raises ValueError if it now shows another scene."""
        picture = take_picture(client, PICTURE_SIZES[self.size.value], transparent=self.transparent.value)
        if not self.settings.is_open:
            raise ValueError("another scene was opened before it was ready")
        return file_name(self.settings, ".png"), picture

    def replay_file(self) -> tuple[str, bytes]:
        """The recording up to the shown moment as one page. Raises ValueError if nothing was recorded."""
        last = self.recorder.shown_frame
        frames = [frame for frame in self.recorder.all_frames() if last is None or frame.time <= last.time]
        page = self.make_replay(self.settings.kind, frames, self.plots.plotted())
        return file_name(self.settings, ".html"), page.encode()


def file_name(settings: SceneSettings, end: str, name: str = "") -> str:
    """Name of a file of the set-up. end: its extension and the word before it. name: of the set-up, if any."""
    words = name or f"{settings.kind.name} {settings.other_name or settings.loaded}"
    return "springtide-" + "-".join(re.findall(r"[\w.]+", words.removeprefix("Mine: "))).lower() + end
