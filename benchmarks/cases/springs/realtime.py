"""The fraction of one core that a rope takes in real time: frames of 1/60 s, each with the steps that fill it."""

import statistics
import time
from typing import Any

from sim.springs import INTEGRATORS, rope
from sim.springs.stability import critical_step
from sim.springs.state import State, advance

FRAME_INTERVAL = 1 / 60  # [s]
STEP = 1 / 1200  # [s]


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """The solver alone, with the Python around the kernel: the median frame over 1/60 s, in per cent.

    Quick: ropes of 10 and 200 points.
    """
    table = []
    steps = round(FRAME_INTERVAL / STEP)
    for points in (10, 200) if quick else (10, 50, 200, 1000):
        net = rope(points, drag=0.5)
        for name, record in INTEGRATORS.items():
            if critical_step(net, name) < STEP:
                continue
            state = State.at_rest(net)
            advance(net, state, record, STEP, steps)
            times = []
            for _ in range(60 if quick else 600):
                start = time.perf_counter()
                advance(net, state, record, STEP, steps)
                times.append(time.perf_counter() - start)
            frame = statistics.median(times)
            table.append(
                {
                    "points": points,
                    "integrator": name,
                    "steps a frame": steps,
                    "frame [us]": 1e6 * frame,
                    "per cent of a core": 100.0 * frame / FRAME_INTERVAL,
                    "longest [us]": 1e6 * max(times),
                }
            )
    return table
