"""Shared by the lab and the processes that it starts for a student's functions."""

import os
import signal

COMPILES = "compiles"  # argument of a process that compiles, too
FORKS = "forks"  # argument of a process that forks others (`template.py`)
NICENESS = 10  # of processes that move a rope or check: the controls of all labs on a machine go first
COMPILER_NICENESS = 19  # of processes that compile: everything else goes first
TRACE_SIGNAL = getattr(signal, "SIGUSR1", None)  # asks a process where it is; None on Windows, which has no such signal


def lower_priority(niceness: int) -> None:
    """Lower the priority of this process, if the system can."""
    if hasattr(os, "nice"):
        os.nice(niceness)
