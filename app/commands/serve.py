"""`springtide`: serve the lab until it is interrupted."""

import contextlib
import errno
import os
import signal
import socket
import sys
import threading
import webbrowser
from collections.abc import Callable, Generator, Sequence
from typing import TYPE_CHECKING, Any

from app.lab.task import load_tasks
from app.lab.workbook import Workbook
from app.scenes.last_setup import keep_last
from app.scenes.setups import Setup, write_query
from app.server.access import KEY_VARIABLE, Access, read_base_path, read_key, read_origin
from app.server.guard import is_loopback
from app.server.viewer import Viewer
from sim.validation import argument_error

if TYPE_CHECKING:
    from app.lab.session import Session

LOOPBACK = "127.0.0.1"
WAIT_INTERVAL = 0.5  # [s] between two looks for Ctrl-C, which on Windows does not interrupt a wait


def check_address(host: str, port: int) -> None:
    """Raises ValueError if it is not an address to serve on."""
    if not 0 <= port <= 65535:
        raise argument_error("--port", port, "0 to 65535")
    allowed = "an address of this machine, such as 127.0.0.1, or 0.0.0.0 for all of them"
    if not host:  # which would mean all of them
        raise argument_error("--host", host, allowed)
    try:
        socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
    except (OSError, ValueError, TypeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "not a host name"
        raise argument_error("--host", host, f"{allowed} ({reason})") from None


@contextlib.contextmanager
def reached_host(host: str, port: int) -> Generator[str]:
    """The host to print and to open for a server that is bound to `host` and `port`, as it stands in an address.

    It is localhost for 127.0.0.1, which browsers look up as ::1 first. Inside, that port of ::1 is taken, so that
    localhost leads here and to no other program. If another program has it already, or for other hosts, it is the
    address that is bound.
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
                say(f"localhost:{port} may lead to another program.")
                yield LOOPBACK
                return
            # Without IPv6, localhost is 127.0.0.1.
        yield "localhost"


def serve_lab(
    name: str,
    params: Any,
    host: str,
    port: int,
    *,
    browser: bool,
    paused: bool,
    plain: bool,
    base_path: str = "",
    origins: Sequence[str] = (),
    workbook: Workbook | None = None,
    session: "Session | None" = None,
    others: Sequence[Setup] = (),
    resumes: bool = False,
) -> int:
    """Print the address that is bound, open the scene, and wait. Returns the exit status. session: a student's folder.

    others: set-ups to show beside it. resumes: keep the set-up for the next start that does.

    The page is there before the scene is, and shows what is compiled. workbook: None for the guide of the course lab.
    base_path, origins: of a proxy; see `app/server/access.py`. The key is taken from the environment.

    Raises ValueError for what is no address, path or origin.
    """
    check_address(host, port)
    host = LOOPBACK if host == "localhost" else host  # the one of its addresses that every system has
    key = read_key(os.environ.pop(KEY_VARIABLE, ""))
    access = Access(read_base_path(base_path), tuple(read_origin(origin) for origin in origins), key)
    try:
        viewer = Viewer(
            host, port, plain=plain, compile_ahead=True, say=say, session=session, access=access,
            workbook=workbook or Workbook(load_tasks(with_checks=False)),
        )  # fmt: skip
    except OSError as error:
        remedy = "--port 0" if port else "--host 127.0.0.1"
        print(f"springtide: cannot serve on {host}:{port}: {error.strerror or error}; try {remedy}", file=sys.stderr)
        return 1
    done, keeper = threading.Event(), Keeper(viewer)
    before = signal.getsignal(signal.SIGINT)

    def end(*_: object) -> None:
        """Raises nothing, as it may come in the middle of an import. A second Ctrl-C does."""
        done.set()
        viewer.stop_opening()
        signal.signal(signal.SIGINT, before)

    signal.signal(signal.SIGTERM, end)
    if before is signal.default_int_handler:  # not in a background job of a shell, which ignores it
        signal.signal(signal.SIGINT, end)
    try:
        with reached_host(host, viewer.port) as reached:
            address = f"http://{reached}:{viewer.port}{access.base_path}"
            say(f"Springtide is on {address}  (Ctrl-C ends it)")
            if not is_loopback(host):
                say(f"Warning: anyone who can reach {host} on port {viewer.port} can drive this lab.")
            if browser:
                webbrowser.open(address)
            viewer.open(name, params, paused=paused)
            if others:
                viewer.comparing.begin(others, False)
            wait_until(done, keeper.store if resumes else lambda: None)
    except KeyboardInterrupt:
        pass
    finally:
        signal.signal(signal.SIGINT, before)
        if resumes:
            keeper.store()
        viewer.shut()
    return 0


def say(text: str) -> None:
    """Print a line at once. Where nothing can be printed (a full disk, a closed pipe), nothing more is tried."""
    try:
        print(text, flush=True)
    except OSError:
        # What could not be written stays in the buffer, and would fail again when Python ends.
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)


def wait_until(done: threading.Event, meanwhile: Callable[[], None] = lambda: None) -> None:
    """Wait for an event, so that Ctrl-C interrupts it on every system. meanwhile: called again and again."""
    while not done.wait(WAIT_INTERVAL):
        meanwhile()


class Keeper:
    """Keeps the set-up of a lab as it changes: a lab that is killed loses half a second."""

    def __init__(self, viewer: Viewer) -> None:
        self.viewer = viewer
        self.kept: object = None

    def store(self) -> None:
        """Keep the set-up, if it is another than before and can be written."""
        served = self.viewer.current
        if served is None:
            return
        panel = served.panel
        setup = panel.kind, panel.params, panel.loaded
        if setup != self.kept:
            with contextlib.suppress(OSError):
                keep_last(write_query(*setup))
            self.kept = setup
