"""A scene that is open, with the two threads that serve it: one simulates, the other shows the latest snapshot."""

import queue
import threading
import time
import traceback
from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

import viser

from app.lab.student.workbook import Workbook
from app.messages import BaseParams, Command, Halt
from app.panel.history import EarlierSettings, History
from app.panel.panel import Panel
from app.panel.recording.recorder import RecordedFrame
from app.panel.settings import SceneSettings
from app.panel.sharing.compare import ComparisonCalls
from app.panel.sharing.scene_switches import SceneSwitches
from app.render.injection import injector_of
from app.render.markup.html import note
from app.scenes import NAMES, view_named
from app.scenes.ahead.compiling import Compiling, describe
from app.scenes.contract import AnyKind, AnyScene
from app.server.first_picture import FirstPicture
from app.server.loop.clock import PATIENCE
from app.server.loop.commands import CompileGate
from app.server.loop.sim_loop import ALONE_INTERVAL, SimLoop
from app.server.placing import CameraPlacing
from app.server.preparation import Preparation
from app.server.replay_file import replay_html
from app.server.requests import SceneRequests
from app.server.web.guard import MessageFilter
from app.server.web.transport import Transport

if TYPE_CHECKING:
    from app.lab.student.session import Session

PLAYED_INTERVAL = 1 / 30  # [s] between two frames of a played recording
HEARTBEAT = 0.1  # [s] between two updates of the panel without a new snapshot
ALONE_HEARTBEAT = 1.0  # [s] the same while nobody looks
MAX_JOIN_TIME = 1.0  # [s] to wait for the last solve of a scene that is left, and for a picture when the lab ends


class SceneHost(Protocol):
    """The parts of a `Viewer` that are common to all its scenes."""

    server: viser.ViserServer
    message_filter: MessageFilter
    transport: Transport
    compiling: Compiling
    preparation: Preparation
    changes: SceneSwitches
    workbook: Workbook | None
    session: "Session | None"
    first_params: dict[str, BaseParams]
    requests: SceneRequests

    @property
    def beside(self) -> ComparisonCalls | None:
        """Shows other set-ups beside this lab; None if this one is beside another."""
        ...

    def visitors(self) -> list[int]:
        """Identifiers of the connected browsers."""
        ...

    def audience(self) -> int:
        """The number of watching browsers, of all labs if several are side by side."""
        ...

    def share_parameters(self, params: BaseParams) -> None:
        """Share the common parameters with the labs beside this one."""
        ...


class ServedScene:
    """Simulation, drawing, panel and threads of one open scene.

    The threads know only this object, so nothing of a scene that was closed reaches the next one, however long its last
    solve takes. Everything drawn is assigned on the viewer thread, everything simulated on the loop's.
    """

    def __init__(
        self,
        viewer: SceneHost,
        kind: AnyKind,
        wanted: BaseParams,
        scene: AnyScene,
        commands: queue.SimpleQueue[Command],
        *,
        paused: bool,
        history: History,
        earlier: EarlierSettings | None,
    ) -> None:
        """viewer: the server and the parts common to all scenes. `start` runs the threads.

        scene: has the wanted parameters, or others if it cannot begin with those. commands: for it. history: see
        `SceneSettings`. earlier: see `SceneRequest`.
        """
        self.viewer, self.server, self.transport = viewer, viewer.server, viewer.transport
        self.recorded: RecordedFrame | None = None  # the shown frame of the recording
        self.shown_serial = self.drawn = 0  # serial of the shown snapshot; number of shown snapshots
        self.stop = threading.Event()
        self.is_open = True
        self.threads: list[threading.Thread] = []
        self.commands, self.scene, params = commands, scene, scene.params
        self.compile_line, self.compile_text = self.server.gui.add_html(""), ""
        self.view = view_named(kind.name)(self.server, lambda command: self.settings.drag(command))
        self.cameras = CameraPlacing(self.server, self.view, params)
        self.settings = SceneSettings(
            self.server,
            kind,
            params,
            self.commands.put,
            viewer.requests.put,
            viewer.first_params,
            history,
            "" if earlier is None else earlier.preset,
        )
        self.panel = Panel(
            self.server, self.view, self.settings, scenes=NAMES, workbook=viewer.workbook, session=viewer.session,
            wake=lambda: self.loop.run.snapshots.fresh.set(), make_replay=replay_html, changes=viewer.changes,
            beside=viewer.beside,
        )  # fmt: skip
        self.settings.watchers.append(lambda: viewer.share_parameters(self.settings.params))
        self.first_picture = FirstPicture(injector_of(self.server), viewer.message_filter.pages)
        self.loop = SimLoop(self.scene, self.commands, self.audience, paused=paused, act=history.act)
        self.gate = CompileGate(viewer.compiling, kind, self.loop.record, self.loop.runs.keep_dropped)
        self.loop.admit = self.gate.admit
        if params != wanted:  # the loop fails again and gives the reason; the panel has the controls to correct it
            self.settings.load_params(wanted, self.settings.nearest_preset(wanted))

    def audience(self) -> int:
        """The number of watching browsers, 0 until the first of them has a whole picture."""
        return self.first_picture.audience(self.viewer.visitors(), self.viewer.audience())

    def start(self) -> None:
        """Run the threads."""
        self.threads = [
            threading.Thread(target=self.loop.tick_until, args=(self.stop,), name="simulation", daemon=True),
            threading.Thread(target=self.show_snapshots, name="viewer", daemon=True),
        ]
        for thread in self.threads:
            thread.start()

    def show_snapshots(self) -> None:
        """Show each new snapshot once, as soon as it arrives, and keep the panel's status up to date."""
        fresh, clock, recorder = self.loop.run.snapshots.fresh, self.loop.clock, self.panel.recorder
        shown_at = clock.now()
        while not self.stop.is_set():
            alone = not self.viewer.audience()
            beat = PLAYED_INTERVAL if recorder.playing else ALONE_HEARTBEAT if alone else HEARTBEAT
            woken = fresh.wait(min(beat, PATIENCE if clock.takes_long and not alone else ALONE_INTERVAL))
            self.loop.ask_for_turn()
            if not woken and clock.now() - shown_at < beat:
                continue
            fresh.clear()
            shown_at = clock.now()
            if not self.stop.is_set():
                self.attempt("page could not be updated", self.show_latest)

    def show_latest(self) -> None:
        """Hand the latest snapshot over; without a new one only the panel."""
        snapshot, busy = self.loop.latest, self.loop.clock.busy_time
        rows = self.loop.run.snapshots.pop_rows()
        # One message for all: each message wakes a thread of viser's, which costs as much as drawing the rope.
        recorder = self.panel.recorder
        now = time.monotonic()
        self.attempt("recording could not go on", lambda: recorder.follow(snapshot))
        self.attempt("recording could not go on", lambda: recorder.advance(now))
        recorded = recorder.shown_frame
        with self.transport.counted():
            if recorded is not None:
                if recorded is not self.recorded:
                    self.drawn += 1
                    self.attempt("picture could not be drawn", lambda: self.view.show(recorded.frame))
                self.shown_serial = 0  # the present is redrawn after it
            elif snapshot.serial != self.shown_serial:
                self.shown_serial = snapshot.serial
                self.drawn += 1
                self.attempt("picture could not be drawn", lambda: self.view.show(snapshot.frame))
                self.cameras.update(snapshot, self.settings.placing)  # another scene size moves cameras
            self.recorded = recorded
            self.attempt("panel could not be updated", self.show_compiling)
            self.attempt("panel could not be updated", lambda: self.panel.update(snapshot, rows, busy))
        self.attempt("recording could not go on", lambda: recorder.note(snapshot, now))

    def attempt(self, what: str, action: Callable[[], None]) -> None:
        """Do a part of the viewer's work; an exception halts the run once, and this thread continues."""
        try:
            action()
        except Exception as error:
            if not self.loop.run.halted:
                traceback.print_exc()
                self.commands.put(Halt(f"The {what}, {type(error).__name__}: {error}"))

    def show_compiling(self) -> None:
        """Show the running compilation: for a chosen preset, or ahead."""
        text = self.viewer.preparation.notice or self.gate.notice or describe(*self.viewer.compiling.progress())
        if text != self.compile_text:
            self.compile_text = text
            self.compile_line.content = note(text) if text else ""

    def stop_threads(self, picture_time: float | None = None) -> None:
        """Stop the threads; a running solve is cancelled, and not waited for if it takes long.

        picture_time: [s] to wait for a picture that is being drawn. None: as long as it takes, because a view makes
        nodes while it draws, and those of the next scene may have the same names.
        """
        self.stop.set()
        self.loop.run.cancel()
        for thread, longest in zip(self.threads, (MAX_JOIN_TIME, picture_time), strict=False):
            thread.join(longest)
        self.threads = []
        self.transport.wait()

    def close(self, picture_time: float | None = None) -> None:
        """Stop the threads and release the resources of the scene, once."""
        self.stop_threads(picture_time)
        if self.is_open:
            self.is_open = False
            self.panel.close()
            self.view.close()
