"""`springtide`: serve the lab until interrupted."""

import signal
import sys
import threading
import webbrowser
from typing import Any

from app.server.guard import is_loopback
from app.server.viewer import Viewer


def serve_lab(name: str, params: Any, host: str, port: int, *, browser: bool, paused: bool, plain: bool) -> int:
    """Open the scene, print the address that is bound, and wait. Returns the exit status."""
    try:
        viewer = Viewer(host, port, plain=plain)
    except OSError as error:
        print(f"springtide: cannot serve on {host}:{port}: {error.strerror or error}; try --port 0", file=sys.stderr)
        return 1
    viewer.open(name, params, paused=paused)
    shown = "localhost" if is_loopback(host) or host == "0.0.0.0" else f"[{host}]" if ":" in host else host
    address = f"http://{shown}:{viewer.port}"
    print(f"Springtide is on {address}  (Ctrl-C ends it)", flush=True)
    if not is_loopback(host):
        print(f"Warning: anyone who can reach {host} on port {viewer.port} can drive this lab.", flush=True)
    if browser:
        webbrowser.open(address)
    done = threading.Event()
    signal.signal(signal.SIGTERM, lambda *_: done.set())
    try:
        done.wait()
    except KeyboardInterrupt:
        pass
    finally:
        viewer.shut()
    return 0
