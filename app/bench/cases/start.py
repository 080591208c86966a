"""Time from a new interpreter to a moving rope, with compiled kernels in the cache and without."""

import os
import statistics
import subprocess
import sys
import tempfile
from typing import Any

STEPS = {
    "numpy and numba alone": "import numpy, numba",
    "sim.springs": "import sim.springs",
    "first frame, leapfrog": "from sim.springs import rope, simulate; simulate(rope(), 'leapfrog', 1/1200, 1/60, 2)",
    "first frame, rk4": "from sim.springs import rope, simulate; simulate(rope(), 'rk4', 1/1200, 1/60, 2)",
    "first critical step": (
        "from sim.springs import rope; from sim.springs.stability import critical_step; critical_step(rope(), 'rk4')"
    ),
}
TIMED = "import time; start = time.perf_counter(); {}; print(time.perf_counter() - start)"


def measured(code: str, cache: str | None = None) -> float:
    """Time of `code` in a new interpreter [s]. cache: a folder for kernels instead of the user's."""
    environment = dict(os.environ) if cache is None else {**os.environ, "SPRINGTIDE_CACHE": cache}
    done = subprocess.run(
        [sys.executable, "-c", TIMED.format(code)], env=environment, capture_output=True, text=True, check=True
    )
    return float(done.stdout.split()[-1])


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Times with a warm cache (the median of repeats, after one that fills it) and with an empty cache.

    Quick: one run with the cache as it is.
    """
    table = []
    for name, code in STEPS.items():
        first = measured(code)
        row: dict[str, Any] = {"what": name, "warm [s]": first}
        if not quick:
            row["warm [s]"] = statistics.median(measured(code) for _ in range(7))
            with tempfile.TemporaryDirectory(prefix="springtide-") as folder:
                row["cold [s]"] = measured(code, folder)
        table.append(row)
    return table
