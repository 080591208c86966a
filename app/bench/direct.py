"""The direct solve of an implicit rope step: its cost a point, which should not depend on the points."""

import statistics
import time
from typing import Any

import numpy as np

from sim.springs.block_tridiagonal import solve_block_tridiagonal

COUNTS = (100, 1_000, 10_000, 100_000)


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """ns a point of one solve, at each number of points, taken in turns."""
    rng = np.random.default_rng(0)
    times: dict[int, list[float]] = {n: [] for n in COUNTS}
    for _ in range(5 if quick else 21):
        for n in COUNTS:
            own = np.tile([4.0, 0.1, 0.2, 0.1, 4.0, 0.1, 0.2, 0.1, 4.0], (n, 1))
            beside = -0.3 * rng.random((n, 9))
            r = rng.standard_normal((n, 3))
            repeats = max(1, 100_000 // n)
            copies = [(own.copy(), r.copy()) for _ in range(repeats)]
            start = time.perf_counter()
            for factors, u in copies:
                solve_block_tridiagonal(factors, beside, u)
            times[n].append((time.perf_counter() - start) / (repeats * n))
    least = min(statistics.median(each) for each in times.values())
    return [
        {
            "points": n,
            "ns per point": 1e9 * statistics.median(times[n]),
            "of the least": statistics.median(times[n]) / least,
        }
        for n in COUNTS
    ]
