"""The time of a call."""

import time
from collections.abc import Callable
from typing import Any


def processor_time(call: Callable[[], Any]) -> float:
    """Processor time of this thread in a call [s], which other programs on the machine do not lengthen."""
    start = time.thread_time()
    call()
    return time.thread_time() - start
