"""The presets of the cloth scene, with their frames: the share of one core that real time takes."""

import statistics
from typing import Any

from app.scenes.cloth.parameters import PRESETS, ClothParams
from app.scenes.cloth.scene import ClothScene
from app.scenes.timer import effort_clock
from sim.parameters import check_record

FRAME_INTERVAL = 1 / 60  # [s]


def row(preset: str, frames: int) -> dict[str, Any]:
    """Frames of 1/60 s on one thread, in processor time, which other programs on the machine do not lengthen."""
    scene = ClothScene(check_record(ClothParams, PRESETS[preset]))
    scene.tuner.count = 1
    steps = round(FRAME_INTERVAL / scene.step)
    times = []
    for _ in range(frames):
        start = effort_clock()
        scene.advance(steps)
        scene.frame()
        times.append(effort_clock() - start)
    # The last two thirds: the cloth lies on the sphere and on itself, which costs most.
    later = times[frames // 3 :]
    median = statistics.median(later)
    return {
        "preset": preset,
        "particles": f"{scene.params.rows} x {scene.params.cols}",
        "integrator": scene.params.integrator,
        "steps a frame": steps,
        "self-contact": "yes" if scene.params.thickness > 0.0 else "no",
        "frame [ms]": 1e3 * median,
        "longest [ms]": 1e3 * max(later),
        "per cent of a core": 100.0 * median / FRAME_INTERVAL,
        "x real time": FRAME_INTERVAL / median,
    }


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Every preset."""
    return [row(preset, 90 if quick else 300) for preset in PRESETS]
