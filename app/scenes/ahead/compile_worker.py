"""A process that compiles pieces: `python -m app.scenes.ahead.compile_worker`, with `--ahead` at low priority.

It reads lines of scene, piece and whether it is of the drawing ("1" or "0"), separated by tabs. It answers each with an
empty line, or with what went wrong. It ends with its input, so also with the process that started it.
"""

import contextlib
import os
import signal
import sys
import traceback

from app.lab.process.shared import BACKGROUND_NICENESS, lower_priority
from app.scenes.ahead.compiling import Job, compile_job


def main() -> None:
    """Compile the requested pieces."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the lab, which then closes our input
    if "--ahead" in sys.argv:
        lower_priority(BACKGROUND_NICENESS)
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # whatever a library prints is no answer
    for line in sys.stdin:
        name, piece, drawn = line.rstrip("\n").split("\t")
        try:
            compile_job(Job(name, piece, drawn == "1"))
            problem = ""
        except Exception as error:
            traceback.print_exc()
            problem = f"{type(error).__name__}: {error}".replace("\n", " ")
        answers.write(problem + "\n")
        with contextlib.suppress(BrokenPipeError):
            answers.flush()


if __name__ == "__main__":
    main()
