"""Cost of recording: processor time and memory of the frames and states that are kept."""

from typing import Any

from app.panel.recording.recorder import Recorder
from app.scenes import NAMES, scene_named
from app.scenes.checkpoints import arrays_in
from app.scenes.setups import make_setup
from app.scenes.timer import effort_clock
from app.server.loop.sim_loop import SimLoop
from app.server.loop.snapshots import KEEP_INTERVAL, KEEP_SHARE

DURATION, QUICK_DURATION = 130.0, 1.0  # [s] of wall time that are recorded


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Each scene as it is shown first: per cent of a core at real time, and the megabytes of a second."""
    return [record(name, QUICK_DURATION if quick else DURATION) for name in NAMES]


def record(name: str, duration: float) -> dict[str, Any]:
    """Record one scene for so long [s], on a clock of its own."""
    kind = scene_named(name)
    scene = kind.make(make_setup(kind).params)
    loop, recorder = SimLoop(scene), Recorder(kind.packing)
    wall = noting = keeping = 0.0
    kept = 0
    while wall < duration:
        loop.tick(scene.frame_interval)
        wall += scene.frame_interval
        start = effort_clock()
        recorder.note(loop.latest, wall)
        noting += effort_clock() - start
        if kept < wall / KEEP_INTERVAL:  # as often as the loop does
            start = effort_clock()
            arrays_in(scene.keep())
            keeping += effort_clock() - start
            kept += 1
    low, high = recorder.span()
    return {
        "scene": name,
        "frames [% of a core]": 100.0 * noting / wall,
        "states [% of a core]": 100.0 * min(keeping / wall, KEEP_SHARE),
        "a state [ms]": 1e3 * keeping / max(kept, 1),
        "memory [MB]": recorder.memory.bytes / 1e6,
        "recorded [s]": high - low,
    }
