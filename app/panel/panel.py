"""The control panel, generated from a scene's parameters. Callbacks only touch the panel, and post commands.

Every callback is a coroutine, so that all of them run on viser's event loop, one after the other: two changes at once
cannot lose each other.
"""

import time
from collections.abc import Callable
from typing import TYPE_CHECKING

import viser

from app.lab.student.workbook import Workbook
from app.messages import RunRow
from app.panel.controls.controls import Controls
from app.panel.controls.controls_tab import VIEW_GROUPS, ControlsTab
from app.panel.controls.scene_pictures import add_scene_pictures
from app.panel.display import add_switches, follow_theme
from app.panel.head import Head
from app.panel.keys import add_keys
from app.panel.plots import Plots
from app.panel.recording.files import MakeReplay
from app.panel.recording.recorder import Recorder
from app.panel.recording.timeline import Timeline
from app.panel.settings import SceneSettings
from app.panel.sharing.compare import CompareFolder, ComparisonCalls
from app.panel.sharing.scene_switches import SceneSwitches
from app.panel.sharing.share import Share
from app.panel.workbook.guide import GuideTab
from app.render.cameras import place_camera
from app.render.handles.channel import Message, channel_of
from app.scenes.contract import AnySnapshot, AnyView

if TYPE_CHECKING:
    from app.lab.student.session import Session
    from app.panel.workbook.code_panel import CodePanel

STATUS_INTERVAL = 0.25  # [s]
MARKS_INTERVAL = 0.5  # [s]
CONTROLS, LAB, SHARE, VIEW = "Controls", "Lab", "Share", "View"  # the tabs


class Panel:
    """The panel of one scene: its parts, and when each is updated."""

    def __init__(
        self,
        server: viser.ViserServer,
        view: AnyView,
        settings: SceneSettings,
        *,
        scenes: tuple[str, ...] = (),
        workbook: Workbook | None = None,
        wake: Callable[[], None],
        make_replay: MakeReplay,
        session: "Session | None" = None,
        beside: ComparisonCalls | None = None,
        changes: SceneSwitches,
    ) -> None:
        """settings: shown and changed by the panel. scenes: to choose from. workbook: the tasks of the lab.

        session: of a student's folder. wake: has the recording checked again. make_replay: makes the page of a
        replay. beside: shows other set-ups beside this one; None if this one is beside another. changes: of the
        server.
        """
        kind, gui, channel = settings.kind, server.gui, channel_of(server)
        self.server, self.kind, self.view, self.settings, self.workbook = server, kind, view, settings, workbook
        self.status_at = self.marks_at = 0.0
        self.plots = Plots(server, kind)
        follow_theme(channel, view)
        channel.listen("held", bool, self.note_held)  # js/panel/fields.js
        self.head = Head(gui, channel, view, settings, scenes, self.place_first_view)
        self.controls = Controls(gui, settings)
        self.recorder = Recorder(kind.packing, wake)
        self.timeline = Timeline(channel, self.recorder, settings)
        self.share = Share(
            server, settings, self.recorder, self.plots, make_replay,
            head=self.head.folder, changes=changes, workbook=workbook, beside=beside,
        )  # fmt: skip
        self.guide: GuideTab | None = None
        self.code: CodePanel | None = None
        self.compare = None if beside is None else CompareFolder(gui, channel, settings, beside)
        self.fill_tabs(session)
        settings.watchers.append(self.show_settings)
        self.show_settings()
        add_keys(gui, settings, self.place_first_view)

    def note_held(self, message: Message[bool]) -> None:
        """Note that a browser holds a slider, or releases it: all changes meanwhile are one act."""
        note = self.settings.history.press if message.value else self.settings.history.release
        note(message.client.client_id)

    def fill_tabs(self, session: "Session | None") -> None:
        """Make the tabs: the exercises first for a student's folder, otherwise the controls."""
        gui, workbook = self.server.gui, self.workbook
        has_folder = workbook is not None and workbook.folder is not None
        names = (LAB, CONTROLS, SHARE, VIEW) if has_folder else (CONTROLS, LAB, SHARE, VIEW)
        group = gui.add_tab_group()
        tabs = {name: group.add_tab(name) for name in names if name != LAB or workbook is not None}
        with tabs[CONTROLS]:
            if self.head.chooser is not None:
                add_scene_pictures(gui, self.head.scenes)
            self.controls_tab = ControlsTab(
                gui, channel_of(self.server), self.view, self.settings, self.controls, tabs[CONTROLS]
            )
        if workbook is not None:
            self.guide = GuideTab(gui, self.kind, workbook, self.settings.set_up, tabs[LAB], self.controls)
            if session is not None:
                from app.panel.workbook import code_panel

                with tabs[LAB]:
                    self.code = code_panel.CodePanel(gui, session, self.kind.name)
        with tabs[SHARE]:
            self.share.add()
            if self.compare is not None:
                self.compare.add()
        with tabs[VIEW]:
            add_switches(gui)
            for name in VIEW_GROUPS:
                self.controls.add_group(name, is_open=True)

    def show_settings(self) -> None:
        """Show the settings, and whether an effective parameter differs from the preset."""
        self.controls.show(self.kind.hidden(self.settings.params))
        self.controls_tab.show_settings()
        self.head.show_preset()

    def place_first_view(self, client: viser.ClientHandle) -> None:
        """Put the camera of a browser where a new one would be."""
        place_camera(client.camera, *self.view.first_view(self.settings.params), self.view.FIELD_OF_VIEW)

    def update(self, snapshot: AnySnapshot, rows: list[RunRow], busy: float = 0.0) -> None:
        """Show the state of the loop at a few hertz, and at once if it starts, stops or halts.

        rows: new plot rows. busy: [s] that the present tick has taken.
        """
        now = time.monotonic()
        frame = self.recorder.shown_frame
        self.plots.update(snapshot, rows, None if frame is None else frame.time)
        visitors = len(self.server.get_clients())
        hidden = frozenset[str]() if self.workbook is None else self.workbook.hidden()
        stale = self.head.is_stale(snapshot, visitors) or (self.code is not None and self.code.is_stale)
        refresh = stale or now - self.status_at >= STATUS_INTERVAL
        if refresh:
            self.status_at = now
            self.head.show(snapshot, busy, visitors)
            self.controls_tab.show_readings(snapshot, hidden)
            if self.code is not None:
                self.head.show_code(self.code.update({} if self.guide is None else self.guide.values))
        if now - self.marks_at >= MARKS_INTERVAL:
            self.marks_at = now
            self.controls_tab.show_marks(snapshot, hidden)
        if self.guide is not None:
            self.guide.update(snapshot, refresh)
        self.share.update()
        self.timeline.update(running=snapshot.status.running)
        if self.compare is not None:
            self.compare.update()

    def close(self) -> None:
        """Stop the threads of this panel, and keep unfinished input."""
        self.settings.is_open = False
        if self.guide is not None:
            self.guide.close()
        self.controls_tab.close()
