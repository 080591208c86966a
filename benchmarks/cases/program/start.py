"""Time from a command to its page, with compiled kernels in the cache and without."""

import asyncio
import os
import statistics
import subprocess
import sys
import tempfile
import time
import urllib.request
from typing import Any

from app.scenes import NAMES
from benchmarks.labs import connected, served

STEPS = {
    "numpy and numba alone": "import numpy, numba",
    "sim.springs": "import sim.springs",
    "first frame, leapfrog": "from sim.springs import rope, simulate; simulate(rope(), 1/60, 2, 1/1200, 'leapfrog')",
    "first frame, rk4": "from sim.springs import rope, simulate; simulate(rope(), 1/60, 2, 1/1200, 'rk4')",
    "first critical step": (
        "from sim.springs import rope; from sim.springs.stability import critical_step; critical_step(rope(), 'rk4')"
    ),
}
TIMED = "import time; start = time.perf_counter(); {}; print(time.perf_counter() - start)"
MOVING = 8  # messages within a second: progress alone is four, and a busy machine has ten frames
MAX_WAIT = 180.0  # [s]


def environment(cache: str | None) -> dict[str, str]:
    """Variables of a command beside those of this process. cache: a folder for kernels instead of the user's."""
    return {} if cache is None else {"SPRINGTIDE_CACHE": cache}


def measured(code: str, cache: str | None = None) -> float:
    """Time of `code` in a new interpreter [s]."""
    command, surroundings = [sys.executable, "-c", TIMED.format(code)], {**os.environ, **environment(cache)}
    done = subprocess.run(command, env=surroundings, capture_output=True, encoding="locale", check=True)
    return float(done.stdout.split()[-1])


def viser_alone(cache: str | None) -> float:
    """Time of a command that only imports viser [s], which the first words are compared with; nothing is compiled."""
    start = time.perf_counter()
    subprocess.run([sys.executable, "-c", "import viser"], env={**os.environ, **environment(cache)}, check=True)
    return time.perf_counter() - start


async def until_moving(port: int) -> None:
    """Wait until the lab sends pictures to a client, faster than it tells of progress."""
    times: list[float] = []
    async with connected(port) as client:
        async for _ in client:
            now = time.perf_counter()
            times = [t for t in times if t > now - 1.0] + [now]
            if len(times) >= MOVING and now - times[0] > 0.5:
                return


def start_times(scene: str, cache: str | None) -> tuple[float, float]:
    """Seconds from the command to the first words in the page, and until the scene moves."""
    start = time.perf_counter()
    with served("--scene", scene, environment=environment(cache)) as (_, port):
        urllib.request.urlopen(f"http://127.0.0.1:{port}/", timeout=30).read()
        first = time.perf_counter() - start
        asyncio.run(asyncio.wait_for(until_moving(port), MAX_WAIT))
        return first, time.perf_counter() - start


def both(name: str, timed: Any, quick: bool, repeats: int) -> dict[str, Any]:
    """A row: start with a warm cache and with an empty one. Quick: one start with the present cache."""
    first = timed(None)
    if quick:
        return {"what": name, "warm [s]": first}
    with tempfile.TemporaryDirectory(prefix="springtide-", ignore_cleanup_errors=True) as folder:
        cold = timed(folder)
    return {"what": name, "warm [s]": statistics.median(timed(None) for _ in range(repeats)), "cold [s]": cold}


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Imports and first frames of the library, and the lab from the command to each scene as it moves."""
    table = [both(name, lambda cache, code=code: measured(code, cache), quick, 7) for name, code in STEPS.items()]
    table.append(both("a command that imports viser", viser_alone, quick, 3))
    table.append(both("first words in the page", lambda cache: start_times("rope", cache)[0], quick, 3))
    for scene in NAMES:
        table.append(both(f"{scene} moving", lambda cache, scene=scene: start_times(scene, cache)[1], quick, 3))
    return table
