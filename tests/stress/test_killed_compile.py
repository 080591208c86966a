"""A compiler that is killed at any moment leaves a cache that the next one works with."""

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).parents[2]
KILLS = 50
LONGEST = 3.0  # [s] that a compiler is let run: it has started after one
CHECK = """
from sim.springs import rope, simulate
run = simulate(rope(5), 0.1, 3, 1e-3, "leapfrog", with_account=True)
print(repr(float(run.x.sum())))
"""


def test_a_compiler_killed_at_random_moments_leaves_nothing_broken(tmp_path: Path) -> None:
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "SPRINGTIDE_CACHE": str(tmp_path / "killed")}
    whole = {**environment, "SPRINGTIDE_CACHE": str(tmp_path / "whole")}

    def result(of: dict[str, str]) -> str:
        done = subprocess.run(
            [sys.executable, "-c", CHECK], env=of, capture_output=True, encoding="locale", timeout=300
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    expected = result(whole)
    moments = random.Random(0)
    for _ in range(KILLS):
        worker = subprocess.Popen(
            [sys.executable, "-m", "app.scenes.ahead.compile_worker"],
            stdin=subprocess.PIPE,
            env=environment,
            encoding="locale",
        )
        assert worker.stdin is not None
        worker.stdin.write("rope\tleapfrog\t0\nrope\tstability gauge\t0\nrope\trk4\t0\n")
        worker.stdin.flush()
        time.sleep(moments.uniform(0.5, LONGEST))
        os.kill(worker.pid, signal.SIGKILL)
        worker.wait()
    assert result(environment) == expected
    assert result(environment) == expected  # kept by now
