"""The cost of particles: fire and an oil jet, as a fraction of one core at 30 Hz."""

import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from sim.particles.fire import Fire
from sim.particles.jet import Jet

COUNT = 20_000  # particles
RATE = 30.0  # [Hz] frames


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Rows of name, particles, ms a step, fraction of one core at 30 Hz."""
    repeats = 60 if quick else 400
    flat = np.zeros((24, 24))
    fire = Fire((0.0, 0.0, 0.0), count=COUNT)
    jet = Jet((0.0, 0.0, 20.0), (6.0, 0.0, 12.0), count=COUNT, flight=4.0)
    for _ in range(300):
        fire.step(1 / RATE)
        jet.step(1 / RATE, flat, (-50.0, -50.0), 5.0)
    tasks: tuple[tuple[str, Callable[[], Any]], ...] = (
        ("fire and smoke", lambda: fire.step(1 / RATE)),
        ("oil jet on a surface", lambda: jet.step(1 / RATE, flat, (-50.0, -50.0), 5.0)),
    )
    table = []
    for name, task in tasks:
        taken = []
        for _ in range(repeats):
            start = time.perf_counter()
            task()
            taken.append(time.perf_counter() - start)
        seconds = statistics.median(taken)
        table.append(
            {"name": name, "particles": COUNT, "ms": seconds * 1e3, "share of a core at 30 Hz": seconds * RATE}
        )
    return table
