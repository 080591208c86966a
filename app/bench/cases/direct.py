"""The direct solve of an implicit rope step: its cost a point, which should not depend on the points.

At every size the same number of points is solved, each matrix and right-hand side in memory of its own, in one compiled
loop, as an implicit step calls the solver. Times are processor times. Up to some thousand points what the way down
wrote is still in the processor's second cache on the way back; beyond, it comes from the third, which costs more, the
more so where other programs use it too. Blocks would not mend it: the way back starts from the last point, so that
nothing can be finished while it is near, and working out a block anew costs more than reading it.
"""

import statistics
import time
from typing import Any

import numpy as np

from sim.jit import kernel
from sim.springs.integrators.implicit.block_tridiagonal import solve_block_tridiagonal

COUNTS = (100, 1_000, 10_000, 100_000)
WORK = 200_000  # points solved in a timed call


@kernel
def solve_each(diagonals, besides, us):
    """Many systems, one after another."""
    for i in range(diagonals.shape[0]):
        solve_block_tridiagonal(diagonals[i], besides[i], us[i])


def seconds(n: int, rng: np.random.Generator) -> float:
    """Processor time of a point [s]."""
    own = np.tile([4.0, 0.1, 0.2, 0.1, 4.0, 0.1, 0.2, 0.1, 4.0], (WORK // n, n, 1))
    beside = -0.3 * rng.random((WORK // n, n, 9))
    r = rng.standard_normal((WORK // n, n, 3))
    start = time.thread_time()
    solve_each(own, beside, r)
    return (time.thread_time() - start) / WORK


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """ns a point of one solve, at each number of points, taken in turns."""
    rng = np.random.default_rng(0)
    seconds(COUNTS[0], rng)  # compiles
    times: dict[int, list[float]] = {n: [] for n in COUNTS}
    for _ in range(5 if quick else 41):
        for n in COUNTS:
            times[n].append(seconds(n, rng))
    least = min(min(each) for each in times.values())
    return [
        {
            "points": n,
            "least [ns a point]": 1e9 * min(times[n]),
            "median [ns a point]": 1e9 * statistics.median(times[n]),
            "of the least": min(times[n]) / least,
            "a system [kB]": n * 21 * 8 / 1000,
        }
        for n in COUNTS
    ]
