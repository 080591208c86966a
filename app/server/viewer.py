"""Owns the server: opens scenes, runs the open scene's loop in a thread, and shows its latest snapshot in another."""

# pyright: reportPrivateUsage=false

import queue
import threading
import time
import traceback
from collections.abc import Callable
from typing import TYPE_CHECKING

import viser

from app.lab.workbook import Workbook
from app.messages import BaseParams, Halt, Release, Reset, StudentAnswer, WorkCount
from app.panel.compare import Beside, PaneWords
from app.panel.display import set_theme
from app.panel.panel import Panel, add_scene_chooser
from app.panel.questions import Questions
from app.panel.recorder import Kept
from app.render.cameras import ClientCamera, fit_cameras, place_cameras, place_client_camera
from app.render.html import fill, note
from app.render.injection import disable_shaders, reset_scene
from app.render.viser_types import ViserConnection
from app.scenes import NAMES, scene_named, view_named
from app.scenes.compiling import Compiling, describe
from app.scenes.contract import AnyKind, AnyScene, PostCommand
from app.server.access import OWN_PAGES_ONLY, Access
from app.server.beside import Comparing, Comparison
from app.server.command_queue import CommandQueue
from app.server.compile_gate import CompileGate
from app.server.counters import Unwatched, gather, modules
from app.server.guard import open_pane, open_server, quiet
from app.server.loop import PATIENCE, SimLoop
from app.server.panes import Panes
from app.server.replay_file import replay_html
from app.server.shared_clock import Seat
from app.server.transport import TransportCounters
from sim.interruption import STOP

if TYPE_CHECKING:
    from app.lab.session import Session

PLAYED_INTERVAL = 1 / 30  # [s] between two frames of a recording that is played
HEARTBEAT = 0.1  # [s] between two updates of the panel where no snapshot comes
SEND_WINDOW = 0.0  # [s] for which viser holds back what it sends, by default 17 ms: flushing each frame costs more
MIN_SCENE_TIME = 0.3  # [s] for which a scene is shown before another is opened: long enough for its status line
PROGRESS_INTERVAL = 0.25  # [s] between two updates of what is being compiled
MAX_JOIN_TIME = 1.0  # [s] for which leaving a scene waits for each of its threads


class Viewer:
    """The lab in a browser. Everything drawn is assigned on the viewer thread, everything simulated on the loop's."""

    def __init__(
        self,
        host: str,
        port: int,
        *,
        plain: bool = False,
        developer: bool = False,
        compile_ahead: bool = False,
        workbook: Workbook | None = None,
        session: "Session | None" = None,
        say: Callable[[str], None] = lambda text: None,
        access: Access = OWN_PAGES_ONLY,
        beside: "tuple[Viewer, int] | None" = None,
    ) -> None:
        """plain: draw by viser's public API alone. developer: show the work counts in the panel.

        compile_ahead: while a scene runs, compile what it and the other scenes may call later. workbook: the tasks of
        the lab, which the panel of each scene shows. session: of a student's folder, with functions that the scenes
        run. say: prints a line. access: who may connect beside a browser of this machine. beside: the lab that this
        one is a pane of, and its number from 2: it is reached through the other's port, and `host` to `access` say
        nothing.

        Raises OSError where the port cannot be bound.
        """
        self.compiling = Compiling() if beside is None else beside[0].compiling
        self.compile_ahead, self.workbook, self.session, self.say = compile_ahead, workbook, session, say
        self.notice = ""  # what is compiled before something else can be shown
        self.developer = developer
        self.panes = Panes()
        if beside is None:
            self.server, self.screen = open_server(host, port, access, self.panes)
        else:
            self.server, self.screen = open_pane(beside[0].panes, beside[1])
        self.plain, self.pane_of = plain, beside
        self.seat: Seat | None = None  # at the clock of a comparison
        self.comparison: Comparison | None = None
        self.comparing = Comparing(self, self.make_pane)
        if plain:
            disable_shaders(self.server)
        connection: ViserConnection = self.server._websock_server
        connection.get_message_buffer().window_duration_sec = SEND_WINDOW
        self.transport = TransportCounters(self.server)
        self.port = self.server.get_port()
        self.commands = CommandQueue()
        self.server.on_client_disconnect(self.on_disconnect)
        self.questions = Questions(self.server)
        self.stop = threading.Event()
        self.ended = False
        self.threads: list[threading.Thread] = []
        self.recorded: Kept | None = None  # the frame of the recording that is shown
        self.shown = self.drawn = 0  # serial of the snapshot that is shown; how many were
        self.starts = 0  # how often the shown run was begun again
        self.unwatched = Unwatched()
        self.is_open = False  # whether scene, view, panel and loop are those of an open scene
        self.first_params: dict[str, BaseParams] = {}  # scene -> the parameters that it was first given
        self.changing = threading.Lock()
        # Scenes that browsers ask for, with parameters where a task or a link has them, and a link's camera.
        self.wanted: queue.SimpleQueue[tuple[str, BaseParams | None, ClientCamera | None]] = queue.SimpleQueue()
        threading.Thread(target=self.open_wanted, name="scene changes", daemon=True).start()
        gui = self.server.gui
        set_theme(gui, dark=False)
        gui.set_panel_label("Springtide")

    def open(
        self, name: str, params: BaseParams | None = None, *, paused: bool = False, first_look: bool = False
    ) -> None:
        """Show a scene, in place of the one that is open.

        params: None for those that the scene was first given. Where there are none: with `first_look` those of a preset
        that keeps moving, otherwise the defaults. first_look: a browser asked for it; parameters of a task of the lab
        are not kept. Whatever fails leaves a page that says why and offers the scenes; the exception is raised.
        """
        with self.changing:
            if self.ended:
                return
            try:
                kind = scene_named(name)
                if params is None:
                    params = self.first_params.get(name) or (kind.opening_params() if first_look else kind.params())
                elif not first_look:
                    self.first_params.setdefault(name, params)
                if not self.compile(kind, params) or self.ended:
                    return
                self.close()
                self.make(kind, params, paused)
            except BaseException as error:
                self.show_failure(name, error)
                raise

    def make(self, kind: AnyKind, params: BaseParams, paused: bool) -> None:
        """Make scene, view, panel and threads."""
        name = kind.name
        make_view = view_named(name)
        self.clear()
        commands = CommandQueue()
        self.commands = commands
        self.scene = self.make_scene(kind, params, commands.put)
        self.compile_line, self.compile_text = self.server.gui.add_html(""), ""
        self.view = make_view(self.server, commands.put)
        place_cameras(self.server, *self.view.first_view(params), self.view.FIELD_OF_VIEW)
        self.gate = CompileGate(self.compiling, kind, commands.put, (params, 0))
        self.panel = Panel(
            self.server, kind, self.view, params, self.gate.post, work=self.work, scenes=NAMES,
            open_scene=self.want, workbook=self.workbook, developer=self.developer, session=self.session,
            wake=lambda: self.loop.fresh.set(), make_replay=replay_html, changed=self.share_parameters,
            questions=self.questions,
            beside=None if self.pane_of else Beside(self.comparing.want, self.comparing.end, self.pane_words),
        )  # fmt: skip
        gate, read = self.gate, self.panel.read
        self.loop = SimLoop(self.scene, commands, lambda: gate.read(read()), self.audience, paused=paused)
        self.is_open = True
        if self.comparison is not None:
            self.comparison.seat(self)
        self.stop = threading.Event()
        self.threads = [
            threading.Thread(target=self.loop.run, args=(self.stop,), name="simulation", daemon=True),
            threading.Thread(target=self.show_snapshots, args=(self.loop, self.stop), name="viewer", daemon=True),
        ]
        for thread in self.threads:
            thread.start()
        if self.compile_ahead:
            ahead = threading.Thread(target=self.compiling.go_on_with, args=(name,), name="compile ahead", daemon=True)
            ahead.start()

    def make_scene(self, kind: AnyKind, params: BaseParams, post: PostCommand) -> AnyScene:
        """The simulation, with a student's functions beside it where there are any that it has a use for."""
        if self.session is None:
            return kind.make(params)
        live = self.session.live
        if kind.make_with_student is None:
            live.connect(kind.name, lambda: None, lambda: None)
            return kind.make(params)
        live.connect(kind.name, lambda: post(StudentAnswer()), lambda: post(Reset()))
        return kind.make_with_student(params, live)

    def compile(self, kind: AnyKind, params: BaseParams) -> bool:
        """Have compiled what a scene needs, with progress in the page and in lines on the terminal.

        An open scene goes on meanwhile. False where the lab ended before that, or another scene was asked for.
        """
        jobs = self.compiling.missing(kind.name, params)
        if not jobs:
            return not self.ended
        start = time.monotonic()
        self.say(f"{kind.title}: compiling {', '.join(job.piece for job in jobs)}. This is done once.")
        cover = None
        if not self.is_open:
            self.clear()
            cover = self.server.gui.add_html("")
        self.compiling.want(jobs)
        try:
            done = False
            while not done:
                left = [job.piece for job in jobs if job not in self.compiling.settled]
                spent = time.monotonic() - start
                self.notice = f"{kind.title}: compiling {', '.join(left)}, {spent:.0f} s. This is done once."
                if cover is not None:
                    cover.content = note(fill('<span class="springtide-progress">{}</span>', self.notice))
                done = self.compiling.wait(jobs, PROGRESS_INTERVAL)
                if self.ended or (self.is_open and not self.wanted.empty()):
                    return False
        finally:
            self.notice = ""
        self.say(f"{kind.title}: compiled in {time.monotonic() - start:.1f} s")
        return True

    def show_compiling(self) -> None:
        """What is compiled while the scene runs: for what was chosen, or ahead."""
        text = self.notice or self.gate.notice or describe(*self.compiling.progress())
        if text != self.compile_text:
            self.compile_text = text
            self.compile_line.content = note(text) if text else ""

    def clear(self) -> None:
        """An empty panel and an empty scene."""
        self.server.gui.reset()
        reset_scene(self.server)
        self.shown = self.drawn = self.starts = 0
        self.transport.begin()
        self.unwatched = Unwatched()

    def show_failure(self, name: str, error: BaseException) -> None:
        """A page that says why a scene could not be opened, and offers the scenes."""
        if self.comparison is not None:
            self.comparison.leave(self)
        self.close()
        self.clear()
        add_scene_chooser(self.server.gui, (f"{name} (failed)", *NAMES), f"{name} (failed)", self.want)
        reason = f"{type(error).__name__}: {error}"
        self.server.gui.add_html(
            note(fill('<b class="springtide-panel">{} could not be opened.</b><br>{}', name, reason))
        )

    def want(self, name: str, params: BaseParams | None = None, camera: ClientCamera | None = None) -> None:
        """Ask for a scene; it is opened on a thread of its own."""
        self.wanted.put((name, params, camera))

    def open_wanted(self) -> None:
        """Open the scenes that browsers ask for; of several waiting only the last."""
        while not self.ended:
            name, params, camera = self.wanted.get()
            while not self.wanted.empty():
                name, params, camera = self.wanted.get()
            try:
                if name in NAMES:
                    self.open(name, params, first_look=True)
                    place_client_camera(self.server, camera)
            except Exception:
                traceback.print_exc()
            time.sleep(MIN_SCENE_TIME)

    def visitors(self) -> int:
        """How many browsers are connected."""
        return len(self.server._connected_clients)

    def audience(self) -> int:
        """How many browsers look; at all labs, where several are side by side."""
        comparison = self.comparison
        return self.visitors() if comparison is None else comparison.audience()

    def make_pane(self, number: int) -> "Viewer":
        """A lab beside this one, with nothing open. number: of its pane, from 2."""
        return Viewer("", 0, plain=self.plain, developer=self.developer, say=self.say, beside=(self, number))

    def pane_words(self) -> tuple[PaneWords, ...]:
        """What stands above each lab, where several are side by side."""
        comparison = self.comparison
        return () if comparison is None else comparison.words()

    def share_parameters(self, params: BaseParams) -> None:
        """Set in the labs beside this one what is the same in all."""
        comparison = self.comparison
        if comparison is not None:
            comparison.share(self, params)

    async def on_disconnect(self, client: viser.ClientHandle) -> None:
        """A browser that is gone lets go of what it drags."""
        self.commands.put(Release(client.client_id))

    def show_snapshots(self, loop: SimLoop, stop: threading.Event) -> None:
        """Show each new snapshot once, as soon as it is there, and keep the panel's status up to date."""
        recorder, shown_at = self.panel.recorder, loop.clock()
        while not stop.is_set():
            woken = loop.fresh.wait(min(PATIENCE, PLAYED_INTERVAL))
            loop.ask_for_turn()
            if not woken and loop.clock() - shown_at < (PLAYED_INTERVAL if recorder.playing else HEARTBEAT):
                continue
            loop.fresh.clear()
            shown_at = loop.clock()
            self.unwatched.note(self.audience())
            if not stop.is_set():
                self.show_latest()

    def show_latest(self) -> None:
        """Hand the latest snapshot over; without a new one only the panel."""
        loop, snapshot = self.loop, self.loop.latest
        rows = [loop.plot_rows.popleft() for _ in range(len(loop.plot_rows))]
        since = loop.busy_since
        busy = 0.0 if since is None else loop.clock() - since
        # All of it in one message: each wakes a thread of viser's, which costs as much as drawing the rope.
        recorder = self.panel.recorder
        now = time.monotonic()
        recorder.follow(snapshot)
        recorder.advance(now)
        recorded = recorder.shown
        with self.transport.counted():
            if recorded is not None:
                if recorded is not self.recorded:
                    self.drawn += 1
                    self.attempt("picture", lambda: self.view.show(recorded.frame))
                self.shown = 0  # the present is drawn anew after it
            elif snapshot.serial != self.shown:
                self.shown = snapshot.serial
                self.drawn += 1
                self.attempt("picture", lambda: self.view.show(snapshot.frame))
                replayed = snapshot.status.replayed
                if replayed is not None and not snapshot.status.halted:
                    view = self.view.first_view(snapshot.params)
                    fit_cameras(self.server, view, self.view.FIELD_OF_VIEW, replayed)
                if snapshot.status.starts != self.starts:  # after the picture: another scene size moves cameras too
                    self.starts = snapshot.status.starts
                    place_cameras(self.server, *self.view.first_view(snapshot.params), self.view.FIELD_OF_VIEW)
                    place_client_camera(self.server, self.panel.camera)
                    self.panel.camera = None
            self.recorded = recorded
            self.attempt("compiling", self.show_compiling)
            self.attempt("panel", lambda: self.panel.update(snapshot, rows, busy))
        recorder.note(snapshot, now)
        self.panel.share.sent = recorded

    def attempt(self, what: str, action: Callable[[], None]) -> None:
        """Show something; what goes wrong halts the run once, and this thread lives to say so."""
        try:
            action()
        except Exception as error:
            if not self.loop.halted:
                traceback.print_exc()
                self.loop.commands.put(Halt(f"The {what} could not be drawn, {type(error).__name__}: {error}"))

    def work(self) -> dict[str, WorkCount]:
        """The work counts of the open scene."""
        latest = self.loop.latest
        return gather(
            self.loop.work(),
            {"pictures handed over": WorkCount(self.drawn, max(self.shown - self.drawn, 0))},
            self.transport.work(),
            self.panel.plots.work(),
            latest.work,
            self.unwatched.work(),
            modules(),
        )

    def stop_threads(self) -> None:
        """Stop the threads of the open scene; a solve that runs is ended early."""
        self.stop.set()
        if self.is_open:
            self.loop.request[STOP] = 1
        for thread in self.threads:
            thread.join(MAX_JOIN_TIME)
        self.threads = []

    def close(self) -> None:
        """Stop the threads of the open scene and give back what it holds."""
        self.stop_threads()
        if self.is_open:
            self.is_open = False
            self.panel.close()
            self.view.close()

    def stop_opening(self) -> None:
        """Give up a scene that is waiting to be compiled, as the lab ends; `shut` does the rest."""
        self.ended = True
        self.comparing.stop_opening()

    def shut(self) -> None:
        """End: stop the threads and the server. A scene that is being opened is not waited for."""
        self.ended = True
        self.stop.set()
        if self.pane_of is not None:
            first, number = self.pane_of
            first.panes.remove(number)
        else:
            self.comparing.stop_opening()
            self.comparing.end_now(MAX_JOIN_TIME)
            self.compiling.close()
        if self.changing.acquire(timeout=MAX_JOIN_TIME):
            try:
                self.close()
            finally:
                self.changing.release()
        self.want("")
        with quiet():
            self.server.stop()
