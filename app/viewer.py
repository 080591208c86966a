"""Owns the server: runs one scene's loop in a thread and pumps its latest snapshot into the handles."""

import queue
import threading
import time
import traceback
from collections.abc import Callable
from typing import Any

import viser

from app.guard import open_server
from app.ledger import Unwatched, Work, gather, modules
from app.loop import SimLoop
from app.messages import Command, Halt, Release
from app.panel import Panel
from app.patch import decline, reset
from app.pictures import picture_named
from app.scenes import NAMES, scene_named
from app.traffic import Traffic

FOV = 1.3  # [rad] vertical field of view, unless a picture has its own
PATIENCE = 0.1  # [s] between looks where no snapshot comes
GATHER = 0.0  # [s] for which viser holds back what it has to send, of itself 17 ms: flushing each picture costs more


class Viewer:
    """The lab in a browser. Everything drawn is assigned on the pump thread, everything simulated on the loop's."""

    def __init__(self, host: str, port: int, *, plain: bool = False) -> None:
        """plain: draw by viser's public API alone. Raises OSError where the port cannot be bound."""
        self.server, self.screen = open_server(host, port)
        if plain:
            decline(self.server)
        self.server._websock_server.get_message_buffer().window_duration_sec = GATHER
        self.traffic = Traffic(self.server)
        self.port = self.server.get_port()
        self.commands: queue.SimpleQueue[Command] = queue.SimpleQueue()
        self.server.on_client_disconnect(self.let_go)
        self.stop = threading.Event()
        self.threads: list[threading.Thread] = []
        self.shown = self.drawn = 0  # serial of the snapshot that is shown; how many were
        self.unwatched = Unwatched()
        self.sent = 0.0  # [s] that the last frame took to hand over
        self.changing = threading.Lock()
        gui = self.server.gui
        gui.configure_theme(
            show_logo=False, show_share_button=False, control_width="medium", brand_color=(28, 106, 168)
        )
        gui.set_panel_label("Springtide")

    def open(self, name: str, params: Any = None, *, paused: bool = False) -> None:
        """Show a scene, in place of the one that is open."""
        with self.changing:
            self.close()
            scene, picture = scene_named(name), picture_named(name)
            self.server.gui.reset()
            reset(self.server)
            self.scene = scene.Scene(params or scene.Params())
            self.shown = self.drawn = 0
            self.traffic.begin()
            self.unwatched = Unwatched()
            commands = self.commands = queue.SimpleQueue()
            self.picture = picture.Picture(self.server, commands.put)
            position, target = self.picture.CAMERA
            fov = getattr(self.picture, "FOV", FOV)
            for camera in (self.server.initial_camera, *(c.camera for c in self.server.get_clients().values())):
                camera.position, camera.look_at, camera.fov = position, target, fov
            self.panel = Panel(
                self.server,
                scene,
                picture,
                self.scene.params,
                commands.put,
                work=self.work,
                scenes=NAMES,
                open_scene=self.open,
            )
            self.loop = SimLoop(self.scene, commands, self.panel.read, self.audience, paused=paused)
            self.stop = threading.Event()
            self.threads = [
                threading.Thread(target=self.loop.run, args=(self.stop,), name="simulation", daemon=True),
                threading.Thread(target=self.pump, args=(self.stop,), name="viewer", daemon=True),
            ]
            for thread in self.threads:
                thread.start()

    def audience(self) -> int:
        """How many browsers look."""
        return len(self.server._connected_clients)

    async def let_go(self, client: viser.ClientHandle) -> None:
        """A browser that dies in mid-drag never says that it let go; whoever else drags grabs again with each move."""
        self.commands.put(Release())

    def pump(self, stop: threading.Event) -> None:
        """Show each new snapshot once, as soon as it is there: a clock of its own would miss some of them."""
        while not stop.is_set():
            self.loop.fresh.wait(PATIENCE)
            self.loop.fresh.clear()
            self.unwatched.note(self.audience())
            self.show_latest()

    def show_latest(self) -> None:
        snapshot = self.loop.latest
        if snapshot.serial == self.shown:
            return
        self.shown = snapshot.serial
        self.drawn += 1
        start = time.perf_counter()
        # All of it in one message: each wakes a thread of viser's, which costs as much as drawing the rope.
        with self.traffic.counted(), self.server.atomic():
            self.attempt("picture", self.picture.show, snapshot.picture)
            self.sent = time.perf_counter() - start
            self.attempt("panel", self.panel.update, snapshot, self.sent)

    def attempt(self, what: str, action: Callable[..., None], *arguments: Any) -> None:
        """Show something; what goes wrong halts the run once, and this thread lives to say so."""
        try:
            action(*arguments)
        except Exception as error:
            if not self.loop.halted:
                traceback.print_exc()
                self.loop.commands.put(Halt(f"The {what} could not be drawn, {type(error).__name__}: {error}"))

    def work(self) -> dict[str, Work]:
        """The ledger of the open scene."""
        latest = self.loop.latest
        return gather(
            self.loop.work(),
            {"pictures handed over": Work(self.drawn, self.shown - self.drawn)},
            self.traffic.work(),
            self.panel.plots.work(),
            latest.work,
            self.unwatched.work(),
            modules(),
        )

    def close(self) -> None:
        """Stop the threads of the open scene."""
        self.stop.set()
        for thread in self.threads:
            thread.join()
        self.threads = []

    def shut(self) -> None:
        self.close()
        self.server.stop()
