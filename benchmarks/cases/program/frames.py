"""The time of a frame of each scene: solving, making the snapshot, handing it to viser; and the bytes that are sent."""

import statistics
from typing import Any

from app.scenes import NAMES
from app.scenes.timer import effort_clock
from benchmarks.labs import viewer_here

FRAME_INTERVAL = 1 / 30  # [s] of simulated time in a frame, for every scene


def run_scene(name: str, frames: int) -> tuple[list[tuple[float, float, float]], float]:
    """(solve, snapshot, hand over) [s] of processor time of each frame of a scene, and the mean bytes sent.

    Without threads and without a browser: viser takes the messages all the same.
    """
    with viewer_here(shaders=True) as viewer:
        viewer.open(name)
        viewer.served.stop_threads()
        loop, scene, sent = viewer.loop, viewer.scene, viewer.transport.sent
        before = sent["bytes"]
        steps = max(1, round(FRAME_INTERVAL / scene.step))
        times = []
        for _ in range(frames):
            start = effort_clock()
            loop.run.advance(steps)
            solved = effort_clock()
            loop.run.snapshots.publish()
            taken = effort_clock()
            with viewer.transport.counted():
                viewer.served.show_latest()
            times.append((solved - start, taken - solved, effort_clock() - taken))
        return times, (sent["bytes"] - before) / frames


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Medians [ms], their sum as a fraction of one core at 30 Hz, and the data of a frame to each browser [kB]."""
    table = []
    for name in NAMES:
        times, size = run_scene(name, 40 if quick else 300)
        solve, snapshot, hand = (1e3 * statistics.median(part) for part in zip(*times, strict=True))
        table.append(
            {
                "scene": name,
                "solve [ms]": solve,
                "snapshot [ms]": snapshot,
                "hand over [ms]": hand,
                "of a core at 30 Hz [%]": 0.1 * (solve + snapshot + hand) / FRAME_INTERVAL,
                "sent a frame [kB]": 1e-3 * size,
            }
        )
    return table
