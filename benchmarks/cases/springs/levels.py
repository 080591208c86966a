"""The kernels of the rope, compiled for a level of processors, over those compiled for this processor.

A process for each level, in turns. A time is the least of repeats in a process, a ratio the median of those of pairs.
"""

import json
import os
import statistics
import subprocess
import sys
from typing import Any

from sim.cache import host_levels, level_environment

TURNS, QUICK_TURNS = 7, 2
HERE = "this processor"
PROGRAM = """
import json
from benchmarks.cases.springs.kernels import cases, run_ours
times = {}
for net, name, h, steps in cases(400_000):
    least = min(run_ours(net, name, h, steps)[0] for _ in range(7))
    times[f"{name}, {net.x0.shape[2]} points"] = least
print(json.dumps(times))
"""


def times(level: str) -> dict[str, float]:
    """Processor time [s] of each kernel, compiled for a level."""
    processor = {} if level == HERE else level_environment(level)
    command = [sys.executable, "-c", PROGRAM]
    done = subprocess.run(command, env={**os.environ, **processor}, capture_output=True, encoding="locale", check=True)
    return json.loads(done.stdout)


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Ratios of each kernel, and their geometric means; a column for each level that this processor has."""
    levels = host_levels()
    runs = [{level: times(level) for level in (HERE, *levels)} for _ in range(QUICK_TURNS if quick else TURNS)]
    table = {
        kernel: {level: statistics.median(run[level][kernel] / run[HERE][kernel] for run in runs) for level in levels}
        for kernel in runs[0][HERE]
    }
    means = {level: statistics.geometric_mean(row[level] for row in table.values()) for level in levels}
    return [{"kernel": kernel, **row} for kernel, row in {**table, "geometric mean": means}.items()]
