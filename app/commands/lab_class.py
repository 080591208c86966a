"""`springtide lab DIR DIR ...`: the teacher's page of a class, on this machine only."""

import hmac
import os
import secrets
import sys
import threading
import webbrowser
from collections.abc import Sequence
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

from app.commands.serve import LOOPBACK, reached_host, say, wait_until
from app.lab.course.task import load_tasks
from app.lab.report.class_page import page, policy, rows
from app.lab.report.classroom import Classroom
from app.server.web.access import make_key

END_INTERVAL = 0.1  # [s] between two looks of the server whether to end
PATIENCE = 20.0  # [s] for which a request for what is new waits


def serve_class(folders: Sequence[Path], tasks: Sequence[Path], port: int, *, browser: bool) -> int:
    """Show the page until it is interrupted; returns the exit status.

    Only who has the address can read it: its path is a secret. Raises ValueError for what is no folder or task.
    """
    with Classroom(folders, load_tasks(*tasks)) as classroom:
        key = make_key()
        try:
            server = make_server(classroom, key, port)
        except OSError as error:
            print(f"springtide: cannot serve on {LOOPBACK}:{port}: {error.strerror or error}", file=sys.stderr)
            return 1
        threading.Thread(target=server.serve_forever, args=(END_INTERVAL,), name="class page", daemon=True).start()
        bound = int(server.server_address[1])
        try:
            with reached_host(LOOPBACK, bound) as reached:
                address = f"http://{reached}:{bound}/{key}/"
                say(f"The class page is on {address}  (Ctrl-C ends it)")
                if browser:
                    webbrowser.open(address)
                wait_until(threading.Event())
        except KeyboardInterrupt:
            pass
        finally:
            server.shutdown()
            server.server_close()
    return 0


class Server(ThreadingHTTPServer):
    """Prints nothing about a browser that left before its answer."""

    daemon_threads = True
    allow_reuse_address = os.name == "posix"  # elsewhere it would take the port of another server

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Called where an exception leaves a handler."""
        if not isinstance(sys.exception(), ConnectionError):
            super().handle_error(request, client_address)


def make_server(classroom: Classroom, key: str, port: int) -> ThreadingHTTPServer:
    """A server of the page at /KEY/ and of its rows at /KEY/rows. Raises OSError if the port cannot be bound."""

    class Handler(BaseHTTPRequestHandler):
        """Answers GET only."""

        def do_GET(self) -> None:
            """The page, or the rows once they are newer than the revision in `after`."""
            asked = urlsplit(self.path)
            own, _, name = asked.path.removeprefix("/").partition("/")
            hosts = {f"{host}:{self.server.server_port}" for host in ("localhost", LOOPBACK)}  # type: ignore[attr-defined]
            # Another name is that of a page elsewhere whose name was made to lead here.
            if self.headers.get("Host") not in hosts or not hmac.compare_digest(own.encode(), key.encode()):
                self.send_error(404)
            elif name == "":
                nonce, revision = secrets.token_urlsafe(16), classroom.revision
                students = tuple(classroom.students.values())
                self.answer(page(students, revision, nonce), {"Content-Security-Policy": policy(nonce)})
            elif name == "rows":
                after = parse_qs(asked.query).get("after", [""])[0]
                before = int(after) if after.isdecimal() and len(after) < 10 else -1
                revision = classroom.wait(before, PATIENCE)
                text = "" if revision == before else rows(tuple(classroom.students.values()))
                self.answer(text, {"X-Revision": str(revision)})
            else:
                self.send_error(404)

        def answer(self, text: str, headers: dict[str, str]) -> None:
            """Send a page of HTML."""
            body = text.encode()
            common = {
                "Content-Type": "text/html; charset=utf-8", "Content-Length": str(len(body)),
                "Cache-Control": "no-store", "Referrer-Policy": "no-referrer", "X-Content-Type-Options": "nosniff",
                "Cross-Origin-Resource-Policy": "same-origin",
            }  # fmt: skip
            self.send_response(200)
            for name, value in {**common, **headers}.items():
                self.send_header(name, value)
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, format: str, *args: object) -> None:
            """Print nothing: the path is a secret."""

    return Server((LOOPBACK, port), Handler)
