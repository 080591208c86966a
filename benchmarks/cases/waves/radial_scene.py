"""The radial sea scene: many bodies on its waves, and a frame of each preset."""

import math
import statistics
from collections.abc import Callable
from typing import Any

from app.scenes.radial_sea.bodies import place_of
from app.scenes.radial_sea.parameters import PRESETS, RadialSeaParams
from app.scenes.radial_sea.scene import RadialSeaScene
from benchmarks.cases.waves.radial import default_sea
from benchmarks.timing import processor_time
from sim.floating import Body, Hull, make_fleet, make_water, step
from sim.parameters import check_record

BODIES = 200


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Rows of name, ms of processor time, fraction of a core in real time."""
    repeats = 31 if quick else 201
    return [bodies_row(repeats), *scene_rows(repeats)]


def median_processor_time(work: Callable[[], Any], repeats: int) -> float:
    """Median processor time of a call [s], after one call that is not timed."""
    work()
    return statistics.median(processor_time(work) for _ in range(repeats))


def bodies_row(repeats: int) -> dict[str, Any]:
    """200 bodies of 500 triangles on 64 waves, one step of 1/60 s: query, pressure, motion, collisions."""
    sea, hull = default_sea(), Hull.sphere(0.5, 5)
    places = [place_of(i, 1.0) for i in range(BODIES)]
    fleet = make_fleet([Body(hull, 500.0, (x, y, 0.0)) for x, y in places])
    times = iter(range(1, 10**9))

    def frame() -> None:
        at = sea.at(fleet.position[:, :2], next(times) / 60.0, 1.0)
        water = make_water(fleet, [(1025.0, math.inf)], at.height, slope=at.slope, velocity=at.velocity,
                           acceleration=at.acceleration)  # fmt: skip
        step(fleet, water, 1 / 60)

    seconds = median_processor_time(frame, repeats)
    name = f"{BODIES} bodies of {len(hull.faces)} triangles, 1/60 s"
    return {"name": name, "ms": seconds * 1e3, "share of a core": seconds * 60.0}


def scene_rows(repeats: int) -> list[dict[str, Any]]:
    """The scene without the server, by preset: two steps and a frame every 1/30 s."""
    found = []
    for preset, changes in PRESETS.items():
        scene = RadialSeaScene(check_record(RadialSeaParams, changes))

        def frame(scene: RadialSeaScene = scene) -> None:
            scene.advance(2)
            scene.frame()
            scene.readings()

        seconds = median_processor_time(frame, repeats)
        found.append(
            {"name": f"scene: {preset}", "ms": seconds * 1e3, "share of a core": seconds / scene.frame_interval}
        )
    return found
