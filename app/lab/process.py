"""Shared by the lab and the processes that it starts for a student's functions."""

import os
import signal

COMPILES = "compiles"  # argument of a process that compiles, too
FORKS = "forks"  # argument of a process that forks others (`template.py`)
NICENESS = (
    10  # of processes that yield to the controls of all labs on a machine: those that move a rope, and that check
)
COMPILER_NICENESS = 19  # of those that compile: on a busy machine only if nothing else is to be done
TRACE_SIGNAL = getattr(signal, "SIGUSR1", None)  # asks a process where it is; None on Windows, which has no such signal


def lower_priority(niceness: int) -> None:
    """Lower the priority of this process, if the system can."""
    if hasattr(os, "nice"):
        os.nice(niceness)
