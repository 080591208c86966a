"""The direct solve of an implicit rope step: its cost per point, which should not depend on the number of points.

At every size the same number of points is solved, each matrix and right-hand side in memory of its own, in one compiled
loop, as an implicit step calls the solver. Times are processor times. Up to some thousand points, what the elimination
wrote is still in the level-2 cache during the back substitution. For more points it comes from the level-3 cache, which
is slower, and slower again while other programs use it. Working in blocks would not help: the back substitution starts
at the last point, so nothing is finished while it is in the cache, and computing a block again costs more than reading
it.
"""

import statistics
from typing import Any

import numpy as np

from app.scenes.timer import effort_clock
from sim.jit import kernel
from sim.springs.integrators.implicit.block_tridiagonal import solve_block_tridiagonal

COUNTS = (100, 1_000, 10_000, 100_000)
POINTS_PER_CALL = 200_000  # solved in a timed call


@kernel
def solve_each(diagonals, couplings, us):
    """Solve many systems, one after another. diagonals, couplings: (systems, points, 9); us: (systems, points, 3)."""
    for i in range(diagonals.shape[0]):
        solve_block_tridiagonal(diagonals[i], couplings[i], us[i])


def seconds(n: int, rng: np.random.Generator) -> float:
    """Processor time per point [s]."""
    diagonals = np.tile([4.0, 0.1, 0.2, 0.1, 4.0, 0.1, 0.2, 0.1, 4.0], (POINTS_PER_CALL // n, n, 1))
    couplings = -0.3 * rng.random((POINTS_PER_CALL // n, n, 9))
    r = rng.standard_normal((POINTS_PER_CALL // n, n, 3))
    start = effort_clock()
    solve_each(diagonals, couplings, r)
    return (effort_clock() - start) / POINTS_PER_CALL


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Nanoseconds per point of one solve, at each number of points, in turns."""
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
