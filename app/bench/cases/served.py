"""Presets served to one client that draws nothing, as a browser with shaders is served."""

import subprocess
import sys
import time
from typing import Any

PRESETS = {
    "square_sea": ("Earth breeze", "Storm arriving", "Rain shower"),
    "radial_sea": ("Clear water", "Burning rig", "Light crude spill 0.2 m"),
    "cloth": ("Curtain", "Flag in wind"),
}
SETTLING = 3.0  # [s] after a preset is loaded
MAX_WAIT = 60.0  # [s] for the client to connect


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Processor time of the server over simulated time, and frames in a second of it. Quick: one preset a scene.

    The client is a separate process. Raises RuntimeError if it does not connect.
    """
    from app.render.injection import record_shaders
    from app.server.viewer import Viewer

    viewer = Viewer("127.0.0.1", 0)
    record_shaders(viewer.server)
    listener = subprocess.Popen([sys.executable, "-m", "app.bench.listener", str(viewer.port)])
    table = []
    try:
        for scene, presets in PRESETS.items():
            viewer.open(scene)
            end = time.monotonic() + MAX_WAIT
            while not viewer.server.get_clients():
                if listener.poll() is not None or time.monotonic() > end:
                    raise RuntimeError("served: the client did not connect")
                time.sleep(0.05)
            for preset in presets[:1] if quick else presets:
                viewer.panel.load(preset)
                table.append({"preset": f"{scene}: {preset}", **measured(viewer, 3.0 if quick else 15.0)})
    finally:
        listener.terminate()
        listener.wait()
        viewer.shut()
    return table


def measured(viewer: Any, seconds: float) -> dict[str, float]:
    """The figures of the open scene over this time [s]."""
    time.sleep(SETTLING)
    spent, simulated, shown = time.process_time(), viewer.loop.latest.status.time, viewer.served.shown
    time.sleep(seconds)
    simulated = viewer.loop.latest.status.time - simulated
    return {
        "real time [% of a core]": 100.0 * (time.process_time() - spent) / simulated,
        "frames a second": (viewer.served.shown - shown) / simulated,
    }
