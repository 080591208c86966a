"""Cost of many viewers of one sea: processor time of the server, and the real-time factor of the sea."""

import time
from typing import Any

from benchmarks.labs import listened_to, viewer_here

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
    """Serve one scene to so many clients, and measure for `seconds` [s] once all have it."""
    with viewer_here() as viewer, listened_to(viewer, clients):
        viewer.open(name)
        time.sleep(SETTLING)
        clock, used, simulated = time.monotonic(), time.process_time(), viewer.loop.latest.status.time
        shown = viewer.served.shown
        time.sleep(seconds)
        used, wall = time.process_time() - used, time.monotonic() - clock
        return {
            "scene": name,
            "clients": clients,
            "server [% of a core]": 100.0 * used / wall,
            "real-time factor": (viewer.loop.latest.status.time - simulated) / wall,
            "frames [1/s]": (viewer.served.shown - shown) / wall,
        }
