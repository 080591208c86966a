"""The lab in a browser: owns the server, and opens and closes scenes one after the other."""

# pyright: reportPrivateUsage=false

import contextlib
import queue
import threading
import time
import traceback
from collections.abc import Callable
from typing import TYPE_CHECKING

import viser

from app.lab.student.workbook import Workbook
from app.messages import BaseParams, Command, Release, Reset, StudentAnswer
from app.panel.display import set_theme
from app.panel.head import add_scene_chooser
from app.panel.history import EarlierSettings, History, SceneRequest
from app.panel.panel import Panel
from app.panel.settings import SceneSettings, with_fields_of
from app.panel.sharing.compare import ComparisonCalls, PaneWords
from app.panel.sharing.scene_switches import SceneSwitches
from app.render.cameras import place_client_camera
from app.render.handles.viser_inside import send_at_once
from app.render.injection import disable_shaders, reset_page
from app.render.markup.html import fill, note
from app.scenes import NAMES, scene_named
from app.scenes.ahead.compiling import Compiling
from app.scenes.contract import AnyKind, AnyScene, AnyView, PostCommand
from app.scenes.setups import make_setup
from app.server.beside import ComparedLabs, Comparisons
from app.server.loop.sim_loop import SimLoop
from app.server.preparation import Preparation, cover
from app.server.requests import SceneRequests
from app.server.served_scene import MAX_JOIN_TIME, ServedScene
from app.server.web.access import OWN_PAGES_ONLY, Access
from app.server.web.guard import Opened, open_pane, open_server, quiet
from app.server.web.panes import Panes
from app.server.web.transport import Transport

if TYPE_CHECKING:
    from app.lab.student.session import Session

MIN_SCENE_TIME = 0.3  # [s] for which a scene is shown before another is opened: long enough for its status line


class Viewer:
    """The lab in a browser."""

    def __init__(
        self,
        host: str,
        port: int,
        *,
        plain: bool = False,
        compile_ahead: bool = False,
        workbook: Workbook | None = None,
        session: "Session | None" = None,
        say: Callable[[str], None] = lambda text: None,
        access: Access = OWN_PAGES_ONLY,
        beside: "tuple[Viewer, int] | None" = None,
        opened: Opened | None = None,
    ) -> None:
        """plain: draw by viser's public API alone.

        compile_ahead: while a scene runs, compile what it and the other scenes may call later. workbook: the tasks of
        the lab, which the panel of each scene shows. session: of a student's folder, with functions that the scenes
        run. say: prints a line. access: who may connect beside a browser of this machine. beside: the lab that this
        one is a pane of, and its number from 2: it is reached through the other's port. opened: the server, if it
        listens already. With either of them `host`, `port` and `access` say nothing.

        Raises OSError if the port cannot be bound.
        """
        self.compiling = Compiling() if beside is None else beside[0].compiling
        self.workbook, self.session = workbook, session
        if beside is not None:
            opened = open_pane(beside[0].panes, beside[1])
        opened = opened or open_server(host, port, access)
        self.server, self.message_filter = opened.server, opened.message_filter
        self.panes: Panes = opened.panes
        self.plain, self.pane_of = plain, beside
        self.comparison: ComparedLabs | None = None
        self.comparing = Comparisons(self, self.make_pane)
        if plain:
            disable_shaders(self.server)
        send_at_once(self.server)
        self.transport = Transport(self.server)
        self.preparation = Preparation(self.server, self.compiling, say, ahead=compile_ahead)
        self.port = self.server.get_port()
        self.changes = SceneSwitches()
        self.ended = False
        self.came = threading.Event()  # set when a browser connects, or the lab ends
        self.current: ServedScene | None = None  # the last scene opened; it may be closed
        self.first_params: dict[str, BaseParams] = {}  # scene -> its first parameters, with the files as last changed
        self.changing = threading.Lock()
        self.requests = SceneRequests()
        threading.Thread(target=self.open_wanted, name="scene changes", daemon=True).start()
        set_theme(self.server.gui, dark=False)
        self.server.gui.set_panel_label("Springtide")
        # A browser may be there already. It holds nothing: the command wakes a lab that was alone.
        self.server.on_client_connect(self.release)
        self.server.on_client_disconnect(self.release)

    def open(
        self,
        name: str,
        params: BaseParams | None = None,
        *,
        paused: bool = False,
        first_look: bool = False,
        earlier: EarlierSettings | None = None,
        given_up: Callable[[], bool] = lambda: False,
    ) -> bool:
        """Show a scene in place of the open one. Returns False if the request was cancelled before the scene was ready.

        params: None for those that the scene was first given. Without any: with `first_look` those of a preset
        that keeps moving, otherwise the defaults. first_look: a browser asked for it; parameters of a task of the lab
        are not kept. earlier: settings of the history, which an undo or a redo restores. given_up: whether nobody waits
        for it any more. Whatever fails leaves a page that says why and offers the scenes; the exception is raised.
        """
        with self.changing:
            if self.ended:
                return False
            request = self.requests.number
            try:
                kind = scene_named(name)
                self.keep_files()
                if params is None:
                    params = self.first_params.get(name) or (make_setup(kind).params if first_look else kind.params())
                elif not first_look:
                    self.first_params.setdefault(name, params)
                ready = self.preparation.compile(
                    kind, params, covers=not self.is_open, given_up=lambda: given_up() or self.is_given_up(request)
                )
                if not ready or self.ended:
                    return False
                self.close()
                self.make(kind, params, paused, earlier)
                return True
            except BaseException as error:
                self.show_failure(name, error)
                raise

    def keep_files(self) -> None:
        """Keep the open scene's files as they are, for the next time that it is opened."""
        if self.current is not None and (first := self.first_params.get(name := self.current.settings.kind.name)):
            self.first_params[name] = with_fields_of(self.current.settings.params, first)

    def is_given_up(self, number: int) -> bool:
        """True if the lab has ended, or another scene was requested after request `number`, while one is open."""
        return self.ended or (self.is_open and self.requests.is_newer(number))

    def make(self, kind: AnyKind, params: BaseParams, paused: bool, earlier: EarlierSettings | None = None) -> None:
        """Make the scene and serve it, with a line on the page meanwhile."""
        cover(self.server, f"Opening {kind.title} …")
        commands: queue.SimpleQueue[Command] = queue.SimpleQueue()
        # Before the old panel is removed: viser's page takes the updates of a frame after its removals, and says in the
        # browser's console that there is nothing to update. Meanwhile it has taken the last updates.
        scene = self.make_scene(kind, params, commands.put)
        history = history_after(self.current, kind.name, earlier)
        reset_page(self.server)
        opening = cover(self.server, f"Opening {kind.title} …")
        self.current = current = ServedScene(
            self, kind, params, scene, commands, paused=paused, history=history, earlier=earlier
        )
        opening.remove()
        comparison = self.comparison
        if comparison is not None:
            comparison.seat(self)
        current.start()
        self.preparation.go_on(kind)

    def make_scene(self, kind: AnyKind, params: BaseParams, post: PostCommand) -> AnyScene:
        """The simulation; with the parameters of its first view if it cannot begin with these.

        Raises the error of the scene if it cannot begin with those either.
        """
        try:
            return self.begun_scene(kind, params, post)
        except ValueError:
            first = make_setup(kind).params
            if params == first:
                raise
            return self.begun_scene(kind, first, post)

    def begun_scene(self, kind: AnyKind, params: BaseParams, post: PostCommand) -> AnyScene:
        """The simulation, with a student's functions beside it if it uses any of them."""
        if self.session is None:
            return kind.make(params)
        live = self.session.live
        if kind.make_with_student is None:
            live.connect(kind.name, lambda: None, lambda: None)
            return kind.make(params)
        live.connect(kind.name, lambda: post(StudentAnswer()), lambda: post(Reset()))
        return kind.make_with_student(params, live)

    def show_failure(self, name: str, error: BaseException) -> None:
        """Show a page with the reason why a scene could not be opened, and the list of scenes."""
        comparison = self.comparison
        if comparison is not None:
            comparison.leave(self)
        self.close()
        reset_page(self.server)
        add_scene_chooser(self.server.gui, (f"{name} (failed)", *NAMES), f"{name} (failed)", self.want)
        reason = f"{type(error).__name__}: {error}"
        self.server.gui.add_html(
            note(fill('<b class="springtide-panel">{} could not be opened.</b><br>{}', name, reason))
        )

    def want(self, name: str, params: BaseParams | None = None) -> None:
        """Request a scene; it is opened on a separate thread."""
        self.requests.put(SceneRequest(name, params))

    def open_wanted(self) -> None:
        """Open the scenes that browsers request; of several waiting only the last."""
        while not self.ended:
            name, params, cameras, earlier = self.requests.pop()
            try:
                if name in NAMES and (earlier is None or self.settings.history.leads_to(earlier)):
                    self.open(name, params, first_look=True, earlier=earlier)
                    for camera in cameras:
                        place_client_camera(self.server, camera)
            except Exception:
                traceback.print_exc()
            time.sleep(MIN_SCENE_TIME)

    @property
    def is_open(self) -> bool:
        """True if a scene is open."""
        return self.current is not None and self.current.is_open

    @property
    def served(self) -> ServedScene:
        """The last scene opened. Raises RuntimeError without one."""
        if self.current is None:
            raise RuntimeError("no scene has been opened")
        return self.current

    @property
    def scene(self) -> AnyScene:
        """Simulation of the open scene."""
        return self.served.scene

    @property
    def view(self) -> AnyView:
        """Drawing of the open scene."""
        return self.served.view

    @property
    def settings(self) -> SceneSettings:
        """Settings of the open scene."""
        return self.served.settings

    @property
    def panel(self) -> Panel:
        """Panel of the open scene."""
        return self.served.panel

    @property
    def loop(self) -> SimLoop:
        """Loop of the open scene."""
        return self.served.loop

    @property
    def commands(self) -> "queue.SimpleQueue[Command]":
        """The queue of commands for its simulation."""
        return self.served.commands

    def visitors(self) -> list[int]:
        """Identifiers of the connected browsers."""
        return list(self.server.get_clients())

    def newest_visitor(self, timeout: float) -> viser.ClientHandle | None:
        """The browser that connected last; waits at most `timeout` [s] for one, unless the lab has ended."""
        self.came.wait(timeout)
        clients = self.server.get_clients()
        return clients[max(clients)] if clients else None

    def audience(self) -> int:
        """Number of watching browsers, of all labs if several are side by side."""
        comparison = self.comparison
        return len(self.visitors()) if comparison is None else comparison.audience()

    def make_pane(self, number: int) -> "Viewer":
        """A lab beside this one, with nothing open. number: of its pane, from 2."""
        return Viewer("", 0, plain=self.plain, say=self.preparation.say, beside=(self, number))

    @property
    def beside(self) -> ComparisonCalls | None:
        """Shows other set-ups beside this lab; None if this one is beside another."""
        return None if self.pane_of else ComparisonCalls(self.comparing.want, self.comparing.end, self.pane_words)

    def pane_words(self) -> tuple[PaneWords, ...]:
        """Titles of the labs that are side by side."""
        comparison = self.comparison
        return () if comparison is None else comparison.words()

    def share_parameters(self, params: BaseParams) -> None:
        """Share the common parameters with the labs beside this one."""
        comparison = self.comparison
        if comparison is not None:
            comparison.shared.take(self, params)

    def call(self, action: Callable[[], None]) -> None:
        """Call a function on viser's event loop, soon; a lab that has been shut is not called."""
        with contextlib.suppress(RuntimeError):  # the event loop is closed
            self.server.get_event_loop().call_soon_threadsafe(action)

    async def release(self, client: viser.ClientHandle) -> None:
        """Release the objects that a browser drags, as it comes or goes."""
        (self.came.set if self.visitors() else self.came.clear)()
        if self.current is not None:
            self.current.settings.drag(Release(client.client_id))
            self.current.settings.history.release(client.client_id)

    def close(self, picture_time: float | None = None) -> None:
        """Close the open scene. picture_time: [s] to wait for its last picture; None: no limit."""
        if self.current is not None:
            self.current.close(picture_time)

    def stop_opening(self) -> None:
        """Give up a scene that is waiting to be compiled, as the lab ends; `shut` does the rest."""
        self.ended = True
        self.comparing.stop_opening()

    def shut(self) -> None:
        """End the lab: stop the threads and the server, without waiting for a scene that is being opened."""
        self.ended = True
        self.came.set()
        if self.current is not None:
            self.current.stop.set()
        if self.pane_of is not None:
            first, number = self.pane_of
            first.panes.remove(number)
        else:
            self.comparing.stop_opening()
            self.comparing.end_now(MAX_JOIN_TIME)
            self.compiling.close()
        if self.changing.acquire(timeout=MAX_JOIN_TIME):
            try:
                self.close(MAX_JOIN_TIME)
            finally:
                self.changing.release()
        self.want("")
        with quiet():
            self.server.stop()


def history_after(last: ServedScene | None, scene: str, earlier: EarlierSettings | None) -> History:
    """The history of a scene that replaces the last one, if there was one. earlier: see `SceneRequest`."""
    return History() if last is None else last.settings.history_of_next(scene, earlier)
