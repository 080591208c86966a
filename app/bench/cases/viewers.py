"""Cost of many viewers of one sea: processor time of the server, and the real-time factor of the sea."""

import os
import subprocess
import sys
import time
from typing import Any

NAMES = ("square_sea", "radial_sea")
SETTLING = 8.0  # [s] until all clients have the scene


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Each sea with 1 and 20 clients that read all and draw nothing, in a separate process.

    Quick: the square sea, with 1 and 4 clients, for a second.
    """
    if quick:
        return [serve("square_sea", clients, 1.0) for clients in (1, 4)]
    return [serve(name, clients, 15.0) for name in NAMES for clients in (1, 20)]


def serve(name: str, clients: int, seconds: float) -> dict[str, Any]:
    """Serve one scene to so many clients, and measure for `seconds` [s] once all have it.

    Raises RuntimeError where the clients do not connect.
    """
    from app.server.viewer import Viewer

    viewer = Viewer("127.0.0.1", 0)
    listener = subprocess.Popen([sys.executable, "-m", "app.bench.listener", str(viewer.port), str(clients)])
    try:
        viewer.open(name)
        end = time.monotonic() + 60.0
        while len(viewer.server.get_clients()) < clients or viewer.loop.latest.status.time == 0.0:
            if time.monotonic() > end:
                raise RuntimeError(f"viewers: {len(viewer.server.get_clients())} of {clients} clients connected")
            time.sleep(0.1)
        time.sleep(SETTLING)
        clock, used, simulated = time.monotonic(), os.times(), viewer.loop.latest.status.time
        shown = viewer.served.shown
        time.sleep(seconds)
        after, wall = os.times(), time.monotonic() - clock
        return {
            "scene": name,
            "clients": clients,
            "server [% of a core]": 100.0 * (after.user + after.system - used.user - used.system) / wall,
            "real-time factor": (viewer.loop.latest.status.time - simulated) / wall,
            "frames [1/s]": (viewer.served.shown - shown) / wall,
        }
    finally:
        listener.terminate()
        listener.wait()
        viewer.shut()
