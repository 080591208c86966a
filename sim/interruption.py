"""Ends a long solve early: at Ctrl-C, or where another thread asks for it.

Kernels that may take long look at the two numbers of `stop_request` now and then. The first is set by whoever wants
the solve to end. Where the second is set, they also ask Python for signals, which only the main thread gets.
"""

import contextvars

import numpy as np
from numpy.typing import NDArray

REQUEST: contextvars.ContextVar[NDArray[np.int64] | None] = contextvars.ContextVar("stop request", default=None)


class InterruptionError(Exception):
    """A solve was ended by another thread; the state is that of the last whole call of a kernel."""


def stop_request() -> NDArray[np.int64]:
    """The two numbers (2,) that kernels called from this thread look at."""
    request = REQUEST.get()
    if request is None:
        request = np.array([0, 1])
        REQUEST.set(request)
    return request


def use_request(request: NDArray[np.int64]) -> None:
    """Let solves of this thread end where `request[0]` is set, by any thread, to another number than 0."""
    REQUEST.set(request)


def raise_if_stopped() -> None:
    """Raises KeyboardInterrupt after a Ctrl-C that a kernel noticed, InterruptionError where another thread asked.

    The request stays set in the latter case, so that nothing else of the same call begins; who set it takes it back.
    """
    request = stop_request()
    if request[0]:
        if request[1]:
            request[0] = 0
            raise KeyboardInterrupt
        raise InterruptionError
