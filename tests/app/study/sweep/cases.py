"""Stand-ins for `run_case` that worker processes can import, and jobs for the real one."""

import math
import os
import signal
from typing import Any

from app.study.sweep.case import FINISHED, Outcome

FATAL = 3  # the number of the case that kills whoever runs it


def counted(scene: str, values: dict[str, Any], times: tuple[float, ...]) -> Outcome:
    """Gives its number back, or kills its process."""
    if values["number"] == FATAL:
        os.kill(os.getpid(), getattr(signal, "SIGKILL", signal.SIGTERM))  # Windows ends it by either
    return Outcome(FINISHED, "", math.nan, 0.0, {"number": [values["number"]]}, {"number": ("1", "Its number")})


def rope_jobs(count: int, points: int = 60, seconds: float = 10.0) -> dict[int, tuple[str, dict[str, Any], Any]]:
    """Cases of some tenths of a second each."""
    values = [{"points": points, "stiffness": 800.0 + i, "time_step": 2e-4} for i in range(count)]
    return {i: ("rope", value, (seconds,)) for i, value in enumerate(values)}
