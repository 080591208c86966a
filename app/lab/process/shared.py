"""Shared by the lab and the processes that it starts for a student's functions."""

import os
import signal
import time
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

COMPILES = "compiles"  # argument of a process that compiles, too
FORKS = "forks"  # argument of a process that forks others (`template.py`)
ON_HUB = "JUPYTERHUB_USER" in os.environ  # other labs run on this machine, and their controls have priority
ROPE_NICENESS = 19 if ON_HUB else 0  # of a process that moves a student's rope, once it has been tried
BACKGROUND_NICENESS = 19 if ON_HUB else 10  # of processes that check or compile
GROUP_TRIES, GROUP_INTERVAL = 20, 0.1  # [s]: Linux allows one such change in 0.1 s to all users together
TRACE_SIGNAL = getattr(signal, "SIGUSR1", None)  # asks a process for its place; None on Windows, which lacks it

# Work of a process in files of these, between a student's line and the innermost call.
WORK = (("numba", "compiling (numba)"), ("llvmlite", "compiling (numba)"), ("importlib", "importing"))


class CodePlace(NamedTuple):
    """A place in a student's code. work: "importing" or the like, if a library works there, else ""."""

    file: str
    line: int | None
    function: str
    work: str = ""


def place_in(folder: Path, frames: Iterable[tuple[str, int | str, str]]) -> CodePlace | None:
    """The innermost place of a call in a folder; None if it is outside. frames: file, line, function, from there."""
    work = ""
    for file, line, function in frames:
        if Path(file).parent == folder:
            return CodePlace(Path(file).name, int(line), function, work)
        words = Path(file).parts if os.sep in file else file.replace("<", "").split()
        work = work or next((what for word, what in WORK if any(word in part.split(".") for part in words)), "")
    return None


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
