"""Constants of both sides of the process that runs a student's functions."""

import signal

COMPILES = "compiles"  # argument of a process that compiles, too
FORKS = "forks"  # argument of a process that forks others (`template.py`)
NICENESS = 10  # of processes that may wait: those that compile, and those that check
TRACE_SIGNAL = getattr(signal, "SIGUSR1", None)  # asks a process where it is; None on Windows, which has no such signal
