"""The tab "Share": links, set-ups and files.

Callbacks run on viser's event loop; `update` runs on the viewer's thread.
"""

import threading
import time

import numpy as np
import viser

from app.lab.student.workbook import Workbook
from app.messages import BaseParams, Vector
from app.panel.plots import Plots
from app.panel.recording.files import Files, MakeReplay, file_name
from app.panel.recording.recorder import Recorder
from app.panel.settings import SceneSettings
from app.panel.sharing.compare import ComparisonCalls
from app.panel.sharing.scene_switches import SceneSwitch, SceneSwitches, SwitchNotice
from app.panel.workbook.task_setups import read_link
from app.render.cameras import place_camera
from app.render.handles.channel import Message, channel_of
from app.render.handles.viser_inside import uuid_of
from app.render.handles.viser_types import GuiHandle, ViserEvent
from app.render.markup.html import Html, faint, fill, join, lines, note
from app.scenes.comparisons import comparison_named
from app.scenes.own_setups import keep_own, remove_own
from app.scenes.setups import (
    CHANGES,
    MAX_NAME,
    MAX_NOTE,
    Camera,
    Setup,
    added_files,
    missing_files,
    read_file,
    without_effect,
    write_file,
    write_query,
)

CONFIRMED_TIME = 2.0  # [s] for which a button confirms its action
# js/panel/buttons.js sends their presses.
SET_UP_BUTTONS = (
    '<div class="springtide-switches springtide-above">'
    '<button type="button" data-springtide-act="link">Copy link</button>'
    '<button type="button" data-springtide-act="save">Save set-up</button></div>'
)
LOAD_BUTTON = (
    '<div class="springtide-switches"><label class="springtide-load">Load set-up …'
    '<input type="file" accept=".json,.html,.npz"></label></div>'
)
KEEP_CURVES, DROP_CURVES = "Keep curves", "Drop curves"
KEEP, REMOVE = "Keep as preset", "Remove preset"
COMPARE = "?compare="  # begins the address of a ready-made comparison


class Share:
    """The tab. It opens queries of addresses, and files, for pages."""

    def __init__(
        self,
        server: viser.ViserServer,
        settings: SceneSettings,
        recorder: Recorder,
        plots: Plots,
        make_replay: MakeReplay,
        *,
        head: viser.GuiFolderHandle,
        changes: SceneSwitches,
        workbook: Workbook | None,
        beside: ComparisonCalls | None,
    ) -> None:
        """make_replay: makes the page of a replay. head: holds the notice of a change. changes: those of this server.

        workbook: has the tasks that a link may open. beside: None in a lab beside another, which opens no comparison.
        """
        self.server, self.settings, self.plots = server, settings, plots
        self.changes, self.workbook, self.beside = changes, workbook, beside
        gui = server.gui
        self.files = Files(server, settings, recorder, plots, make_replay)
        self.lines: dict[str, viser.GuiHtmlHandle] = {}  # of each group
        # Identity of buttons -> the buttons, their names, and the time [s] until which they confirm.
        self.confirmed: dict[str, tuple[GuiHandle, tuple[str, ...], float]] = {}
        self.confirming = threading.Lock()  # the event loop begins a confirmation, the viewer's thread ends it
        with head:
            self.notice = SwitchNotice(gui, settings.kind.name, changes, self.restore, self.is_undone)
        self.channel = channel_of(server)
        self.channel.listen("open", str, self.open)
        self.channel.listen("link", str, self.make_link)
        self.channel.listen("save", str, self.save)

    def add(self) -> None:
        """Add the controls, in the open container."""
        gui = self.server.gui
        with gui.add_folder("This run"):
            self.curves: GuiHandle = gui.add_button_group("", (KEEP_CURVES,))
            self.curves.on_click(self.on_curves)
            self.files.add_run()
            self.add_line("This run")
        with gui.add_folder("This set-up"):
            self.name = gui.add_text(
                "Name", "", hint=f"Name of the set-up to save, keep or remove; at most {MAX_NAME} characters"
            )
            self.note = gui.add_text(
                "Note in the file", "", hint=f"Saved with the set-up; at most {MAX_NOTE} characters"
            )
            gui.add_html(SET_UP_BUTTONS)
            gui.add_button_group("", (KEEP,)).on_click(self.on_own)
            gui.add_html(LOAD_BUTTON)
            self.remove: GuiHandle = gui.add_button_group("", (REMOVE,), visible=bool(self.settings.own))
            self.remove.on_click(self.on_own)
            self.add_line("This set-up")
        with gui.add_folder("Files"):
            self.files.add()

    def add_line(self, group: str) -> None:
        """Add the line of a group, below its buttons."""
        self.lines[group] = self.server.gui.add_html("")

    def say(self, group: str, text: object) -> None:
        """Show a sentence below the buttons of a group."""
        self.lines[group].content = note(text) if text else ""

    def confirm(self, buttons: GuiHandle, name: str, done: str) -> None:
        """Have a button confirm its action for a moment."""
        with self.confirming:
            _, options, _ = self.confirmed.get(uuid_of(buttons), (buttons, buttons.options, 0.0))
            self.confirmed[uuid_of(buttons)] = buttons, options, time.monotonic() + CONFIRMED_TIME
            buttons.options = tuple(done if option == name else option for option in options)

    def end_confirmations(self) -> None:
        """Give the buttons their names back."""
        now = time.monotonic()
        with self.confirming:
            for identity, (buttons, options, end) in list(self.confirmed.items()):
                if now > end:
                    buttons.options = options
                    del self.confirmed[identity]

    def open(self, message: Message[str]) -> None:
        """Open the query of an address ("?scene=...") or the text of a file ("{...}") for a page.

        A closed panel takes nothing: the page asks the next one.
        """
        client = message.client
        if not self.settings.is_open:
            return
        self.channel.answer(message, "taken")
        try:
            subject = self.read(message.value)
            is_shown = isinstance(subject, Setup) and self.settings.shows(subject)
        except ValueError as reason:  # also of a file that cannot have the set-up's changes
            self.refuse(client, str(reason))
            return
        if isinstance(subject, Setup):
            missing = missing_files(subject, self.settings.params_with_files(subject.scene))
            if missing:
                client.add_notification("A file is missing", missing, color="orange", auto_close_seconds=30.0)
            unused = "; ".join(without_effect(subject))
            if unused:
                client.add_notification("Without effect", unused, color="orange", auto_close_seconds=30.0)
        if isinstance(subject, Setup) and is_shown:
            self.turn(subject)
            self.place(subject, client)
        elif isinstance(subject, str) and self.beside is None:
            return  # a lab beside another opens no comparison
        else:
            change = self.change(subject, message.page)
            try:
                self.show(subject, client.client_id)
            except ValueError as reason:  # of a file of the same name
                self.refuse(client, str(reason))
                return
            if len(self.server.get_clients()) > 1:
                self.changes.latest = change

    def change(self, subject: Setup | str, page: str) -> SceneSwitch:
        """The change made by a page that opens something."""
        settings = self.settings
        scene = comparison_named(subject)[0].scene if isinstance(subject, str) else subject.scene
        return SceneSwitch(page, scene, subject, Setup(settings.kind.name, settings.params, {}, settings.loaded))

    def restore(self, change: SceneSwitch) -> None:
        """Undo a change."""
        if isinstance(change.subject, str) and self.beside is not None:
            self.beside.end()
        self.settings.show_setup(change.before, None)

    def is_undone(self, change: SceneSwitch) -> bool:
        """True if the former set-up is shown again."""
        return isinstance(change.subject, Setup) and self.settings.shows(change.before)

    def read(self, text: str) -> Setup | str:
        """Content of a page's message: a set-up, or the name of a comparison. Raises ValueError if it is refused."""
        if not text.startswith(COMPARE):
            if not text.startswith("?"):
                return read_file(text)
            return read_link(text, self.workbook)
        name = text.removeprefix(COMPARE)
        comparison_named(name)
        return name

    def show(self, subject: Setup | str, client: int) -> None:
        """Show a set-up, with its camera for one browser, or a comparison."""
        if isinstance(subject, Setup):
            self.turn(subject)
            self.settings.show_setup(subject, client)
        elif self.beside is not None:
            self.beside.compare(comparison_named(subject), True)

    def turn(self, setup: Setup) -> None:
        """Turn the workbook to the task that a link opens, if it names one."""
        book = self.workbook
        if setup.task and book is not None:
            book.go(book.tasks.index(book.named(setup.task)))

    def refuse(self, client: viser.ClientHandle | None, reason: str) -> None:
        """Tell one browser why a set-up was refused."""
        if client is not None:
            client.add_notification("Couldn't open this set-up", reason, color="red", auto_close_seconds=30.0)

    def place(self, setup: Setup, client: viser.ClientHandle | None) -> None:
        """Give one browser the camera of the set-up already shown."""
        if client is not None and setup.camera is not None:
            place_camera(client.camera, *setup.camera)

    def make_link(self, message: Message[str]) -> None:
        """Show the link to the view of a browser, which copies it from the answer (js/sharing/copy.js)."""
        settings = self.settings
        query = write_query(settings.kind, settings.params, settings.loaded, camera_of(message.client))
        link = fill('<a class="springtide-link" data-query="{}" href="{}">{}</a>', query, query, query)
        self.say("This set-up", join((link, not_in_link(settings.params))))
        self.channel.answer(message, query)

    def save(self, message: Message[str]) -> None:
        """Save the set-up, with the camera of the asking browser."""
        settings, client = self.settings, message.client
        try:
            name, words = self.name.value.strip(), self.note.value.strip()
            text = write_file(settings.kind, settings.params, settings.loaded, camera_of(client), name=name, note=words)
        except ValueError as reason:
            self.say("This set-up", str(reason))
            return
        file = file_name(settings, ".json", name)
        client.send_file_download(file, text.encode(), save_immediately=True)
        self.say("This set-up", f"{file} was sent to the browser.")

    async def on_curves(self, event: ViserEvent) -> None:
        """Keep the curves of the plots over time beside those of the next run, or drop them."""
        on = event.target.value == KEEP_CURVES
        end = self.plots.keep(on)
        self.curves.options = (KEEP_CURVES,) if end is None else (DROP_CURVES,)
        if end is None:
            self.say("This run", "There are no curves over time to keep." if on else "")
        else:
            self.say("This run", fill("Kept the curves up to t = {:.2f} s; they are dashed.", end))

    async def on_own(self, event: ViserEvent) -> None:
        """Keep the present set-up in the list of presets under its name, or remove the one of that name."""
        settings, name = self.settings, self.name.value.strip()
        if event.client is None:
            return
        try:
            if event.target.value == KEEP:
                words = self.note.value.strip()
                text = write_file(settings.kind, settings.params, settings.loaded, name=name, note=words)
                keep_own(settings.kind, name, text)
                settings.read_own(name)
                self.confirm(event.target, KEEP, "Kept in the list")
            elif event.target.value == REMOVE:
                remove_own(settings.kind, name)
                settings.read_own()
                self.confirm(event.target, REMOVE, "Removed")
            self.remove.visible = bool(settings.own)
            self.say("This set-up", "")
        except (ValueError, OSError) as reason:
            self.say("This set-up", str(reason))

    def update(self) -> None:
        """Keep notice and buttons up to date."""
        self.notice.draw()
        self.end_confirmations()


def not_in_link(params: BaseParams) -> Html:
    """The files of these parameters that a link does not name; nothing without any."""
    files = added_files(params).values()
    what = " and its changes" if getattr(params, CHANGES, ()) else ""
    sentences = [faint(f"A link does not name {file}{what}; a saved set-up does.") for file in files]
    return lines(sentences) if sentences else Html()


def camera_of(client: viser.ClientHandle) -> Camera:
    """Position and target of a browser's camera [m]."""

    def vector(values: np.ndarray) -> Vector:
        return float(values[0]), float(values[1]), float(values[2])

    return vector(client.camera.position), vector(client.camera.look_at)
