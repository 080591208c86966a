"""Presets served to one client that draws nothing, as a browser with shaders is served."""

import time
from typing import Any

from benchmarks.labs import listened_to, viewer_here

PRESETS = {
    "square_sea": ("Earth breeze", "Storm arriving", "Rain shower"),
    "radial_sea": ("Clear water", "Burning rig", "Light crude spill 0.2 m"),
    "cloth": ("Curtain", "Flag in wind"),
}
SETTLING = 3.0  # [s] after a preset is loaded


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Processor time of the server over simulated time, and frames in a second of it. Quick: one preset a scene."""
    table = []
    with viewer_here(shaders=True) as viewer, listened_to(viewer):
        for scene, presets in PRESETS.items():
            viewer.open(scene)
            for preset in presets[:1] if quick else presets:
                viewer.settings.load(preset)
                table.append({"preset": f"{scene}: {preset}", **measured(viewer, 3.0 if quick else 15.0)})
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
