"""`springtide`: serve the lab until it is interrupted.

The server listens, and the page has its first words, before numba is imported and tried: nothing that this module
imports at its top needs it. `Opening` imports the rest on a thread.
"""

import contextlib
import errno
import os
import signal
import socket
import sys
import threading
import webbrowser
from collections.abc import Callable, Generator, Sequence
from typing import TYPE_CHECKING, Any, LiteralString

from app.render.markup.html import fill, note
from app.server.web.access import KEY_VARIABLE, Access, read_base_path, read_key, read_origin
from app.server.web.guard import Opened, is_loopback, open_server, quiet
from sim.validation import argument_error

if TYPE_CHECKING:
    from app.lab.student.session import Session
    from app.lab.student.workbook import Workbook
    from app.scenes.setups import Setup
    from app.server.viewer import Viewer

LOOPBACK = "127.0.0.1"
REASON_TIME = 3.0  # [s] for which the page still answers after a failed start: a browser may be about to connect
WAIT_INTERVAL = 0.5  # [s] between two checks for Ctrl-C, which on Windows does not interrupt a wait


def check_address(host: str, port: int) -> None:
    """Raises ValueError if it is not an address to serve on."""
    if not 0 <= port <= 65535:
        raise argument_error("--port", port, "0 to 65535")
    allowed = "an address of this machine, such as 127.0.0.1, or 0.0.0.0 for all of them"
    if not host:  # an empty host would mean all addresses
        raise argument_error("--host", host, allowed)
    try:
        socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
    except (OSError, ValueError, TypeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "not a host name"
        raise argument_error("--host", host, f"{allowed} ({reason})") from None


@contextlib.contextmanager
def reached_host(host: str, port: int) -> Generator[str]:
    """The host to print and to open for a server that is bound to `host` and `port`, as it stands in an address.

    It is localhost for 127.0.0.1. Browsers try ::1 first for that name, so the same port of ::1 is taken meanwhile, and
    localhost leads to no other program. If another program already has it, or for other hosts, it is the bound
    address.
    """
    if host not in (LOOPBACK, "0.0.0.0"):
        yield f"[{host}]" if ":" in host else host
        return
    with contextlib.ExitStack() as stack:
        try:
            taken = stack.enter_context(socket.socket(socket.AF_INET6, socket.SOCK_STREAM))
            # Not with SO_REUSEADDR, by which another program could take the port too.
            taken.bind(("::1", port))
        except OSError as error:
            if error.errno in (errno.EADDRINUSE, errno.EACCES):
                say(f"Another program also answers on localhost:{port}; use the address below.")
                yield LOOPBACK
                return
            # Without IPv6, localhost is 127.0.0.1.
        yield "localhost"


def serve_lab(
    name: str,
    params: Callable[[], Any] | None,
    host: str,
    port: int,
    *,
    browser: bool,
    paused: bool,
    plain: bool,
    base_path: str = "",
    origins: Sequence[str] = (),
    workbook: "Workbook | None" = None,
    session: "Session | None" = None,
    others: "Sequence[Setup]" = (),
    resumes: bool = False,
) -> int:
    """Print the address that is bound, open the scene, and wait. Returns the exit status. session: a student's folder.

    params: makes the parameters, on another thread; None for the scene's first view. others: set-ups to show beside it.
    resumes: keep the set-up for the next start with this option.

    The page appears before the scene, and shows the compilation. workbook: None for the guide of the course lab.
    base_path, origins: of a proxy; see `app/server/web/access.py`. The key is taken from the environment.

    Raises ValueError for an invalid address, path or origin.
    """
    check_address(host, port)
    host = LOOPBACK if host == "localhost" else host  # the address of localhost that every system has
    key = read_key(os.environ.pop(KEY_VARIABLE, ""))
    access = Access(read_base_path(base_path), tuple(read_origin(origin) for origin in origins), key)
    try:
        opened = open_server(host, port, access)
    except OSError as error:
        remedy = "--port 0" if port else "--host 127.0.0.1"
        print(f"springtide: cannot serve on {host}:{port}: {error.strerror or error}; try {remedy}", file=sys.stderr)
        return 1

    def make() -> "Viewer":
        from app.lab.course.task import load_tasks
        from app.lab.student.workbook import Workbook
        from app.server.viewer import Viewer

        tasks = workbook or Workbook(load_tasks(with_checks=False))
        return Viewer(
            host, port, plain=plain, compile_ahead=True, say=say, session=session, workbook=tasks, opened=opened
        )

    def show(viewer: "Viewer") -> None:
        viewer.open(name, params and params(), paused=paused, first_look=params is None)
        if others:
            viewer.comparing.begin(others, False)

    return show_until_ended(Opening(opened, make, show), host, access, browser=browser, resumes=resumes)


def show_until_ended(opening: "Opening", host: str, access: Access, *, browser: bool, resumes: bool) -> int:
    """See `serve_lab`; once the server listens."""
    port = opening.opened.server.get_port()
    before = signal.getsignal(signal.SIGINT)

    def end(*_: object) -> None:
        """End the lab without raising, as the signal may arrive during an import. A second Ctrl-C raises."""
        opening.stop()
        signal.signal(signal.SIGINT, before)

    signal.signal(signal.SIGTERM, end)
    if before is signal.default_int_handler:  # not in a background job of a shell, which ignores it
        signal.signal(signal.SIGINT, end)
    saver = SetupSaver(opening)
    try:
        with reached_host(host, port) as reached:
            address = f"http://{reached}:{port}{access.base_path}"
            say(f"Springtide is on {address}  (Ctrl-C ends it)")
            if not is_loopback(host):
                say(f"Warning: anyone who can reach {host} on port {port} can drive this lab.")
            opening.start()
            if browser:
                webbrowser.open(address)
            wait_until(opening.done, saver.store if resumes else lambda: None)
            opening.check()
    except KeyboardInterrupt:
        pass
    finally:
        signal.signal(signal.SIGINT, before)
        if resumes:
            saver.store()
        opening.shut()
    return 0


class Opening:
    """Makes a lab behind a listening server, and opens its scene, on a thread: importing numba takes seconds."""

    def __init__(self, opened: Opened, make: "Callable[[], Viewer]", show: "Callable[[Viewer], None]") -> None:
        """make: the lab. show: opens its scene."""
        self.opened, self.make, self.show = opened, make, show
        self.viewer: Viewer | None = None
        self.error: BaseException | None = None  # reason why it failed
        self.done = threading.Event()  # the lab should end, or could not be opened
        self.ended = threading.Event()  # the lab should end
        self.thread = threading.Thread(target=self.run, name="opening", daemon=True)
        self.cover('<span class="springtide-progress">Loading the simulations …</span>')

    def cover(self, words: LiteralString, *values: object) -> None:
        """Line of the page."""
        self.opened.server.gui.add_html(note(fill(words, *values)))

    def start(self) -> None:
        """Begin."""
        self.thread.start()

    def run(self) -> None:
        """Make the lab and open its scene. The page shows the reason for a failure."""
        try:
            viewer = self.make()
            self.viewer = viewer
            if self.ended.is_set():
                viewer.stop_opening()
            self.show(viewer)
        except BaseException as error:
            self.error = error
            if self.viewer is None:  # otherwise its page shows the reason
                self.opened.server.gui.reset()
                reason = f"{type(error).__name__}: {error}"
                self.cover('<b class="springtide-panel">Springtide could not be started.</b><br>{}', reason)
            self.done.set()

    def check(self) -> None:
        """Raise the exception of a failed start, once browsers could read it."""
        if self.error is not None:
            self.ended.wait(REASON_TIME)
            raise self.error

    def stop(self) -> None:
        """Stop opening, as the lab ends; `shut` does the rest."""
        self.ended.set()
        self.done.set()
        if self.viewer is not None:
            self.viewer.stop_opening()

    def shut(self) -> None:
        """End the lab and its server."""
        self.stop()
        if self.viewer is not None:
            self.viewer.shut()
        else:
            with quiet():
                self.opened.server.stop()


def say(text: str) -> None:
    """Print a line at once. If printing fails (a full disk, a closed pipe), it is not tried again."""
    try:
        print(text, flush=True)
    except OSError:
        # Unwritten text stays in the buffer, and would fail again when Python ends.
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)


def wait_until(done: threading.Event, meanwhile: Callable[[], None] = lambda: None) -> None:
    """Wait for an event, so that Ctrl-C interrupts it on every system. meanwhile: called again and again."""
    while not done.wait(WAIT_INTERVAL):
        meanwhile()


class SetupSaver:
    """Keeps the set-up of a lab as it changes: a lab that is killed loses half a second."""

    def __init__(self, opening: Opening) -> None:
        self.opening = opening
        self.last_setup: object = None

    def store(self) -> None:
        """Store the set-up, if it has changed and can be written."""
        viewer = self.opening.viewer
        if viewer is None or viewer.current is None:
            return
        from app.scenes.last_setup import keep_last
        from app.scenes.setups import write_query

        settings = viewer.current.settings
        setup = settings.kind, settings.params, settings.loaded
        if setup != self.last_setup:
            with contextlib.suppress(OSError):
                keep_last(write_query(*setup))
            self.last_setup = setup
