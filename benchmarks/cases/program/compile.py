"""Processor time to compile each piece of each scene with nothing compiled before, one after the other on one core.

What a piece shares with one before it is not compiled again, so the order counts: a scene's gauge and first integrator
pay for the forces. The wall time of `springtide warmup` on a free core is the sum, and the start of Python.
"""

import os
import subprocess
import sys
import tempfile
from typing import Any

from app.scenes import NAMES

# In a separate process for each scene, with a cache of its own.
PROGRAM = """
import sys, time
from app.scenes.ahead.compiling import all_jobs, compile_job
for job in all_jobs(sys.argv[1]):
    start = time.process_time()
    compile_job(job)
    print(job.piece, time.process_time() - start, sep="\\t", flush=True)
"""


def scene_rows(name: str) -> list[dict[str, Any]]:
    """One scene, alone in an empty cache."""
    with tempfile.TemporaryDirectory(prefix="springtide-", ignore_cleanup_errors=True) as folder:
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM, name],
            env={**os.environ, "SPRINGTIDE_CACHE": folder},
            capture_output=True,
            encoding="locale",
            check=True,
        )
    pieces = [line.split("\t") for line in done.stdout.splitlines()]
    table = [{"scene": name, "piece": piece, "cold [s]": float(seconds)} for piece, seconds in pieces]
    return [*table, {"scene": name, "piece": "all", "cold [s]": sum(row["cold [s]"] for row in table)}]


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Every scene. Quick: the rope alone."""
    return [row for name in (("rope",) if quick else NAMES) for row in scene_rows(name)]
