"""Shared by the lab and the processes that it starts for a student's functions."""

import os
import signal
import time
from pathlib import Path

COMPILES = "compiles"  # argument of a process that compiles, too
FORKS = "forks"  # argument of a process that forks others (`template.py`)
ON_HUB = "JUPYTERHUB_USER" in os.environ  # other labs run on this machine, and their controls have priority
ROPE_NICENESS = 19 if ON_HUB else 0  # of a process that moves a student's rope, once it has been tried
BACKGROUND_NICENESS = 19 if ON_HUB else 10  # of processes that check or compile
GROUP_TRIES, GROUP_INTERVAL = 20, 0.1  # [s]: Linux allows one such change in 0.1 s to all users together
TRACE_SIGNAL = getattr(signal, "SIGUSR1", None)  # asks a process for its place; None on Windows, which lacks it


def lower_priority(niceness: int) -> None:
    """Add to the niceness of this process, if the system can.

    Linux can schedule sessions as groups ("autogroup") and compare niceness only within a session. The leader of a
    session therefore sets the niceness of the session, too.
    """
    if not hasattr(os, "nice"):
        return
    total = os.nice(niceness)
    if total == 0 or os.getsid(0) != os.getpid():
        return
    for _ in range(GROUP_TRIES):
        try:
            Path("/proc/self/autogroup").write_text(str(total), "utf-8")
        except BlockingIOError:
            time.sleep(GROUP_INTERVAL)
        except OSError:  # no Linux, or sessions do not count
            return
        else:
            return
