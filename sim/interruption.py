"""Cancelling long solves, and yielding in the middle of them.

Kernels that may take long read the numbers of `stop_request` now and then. The first cancels the solve. If the second
is set, they also check for Python's signals, which only the main thread gets. If the third is set, they call a Python
function and then continue: a solve of seconds yields to its thread in between.
"""

import contextlib
import contextvars
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

# Indices into a request.
STOP = 0  # not 0: cancel the solve
SIGNALS = 1  # not 0: check for a Ctrl-C
TURN = 2  # not 0: yield: call FUNCTION once
FUNCTION = 3  # address of a function without arguments, or 0
ABANDON = 2  # at STOP: cancel at once, even inside `kept_whole`

REQUEST: contextvars.ContextVar[NDArray[np.int64] | None] = contextvars.ContextVar("stop request", default=None)
WHOLE: contextvars.ContextVar[bool] = contextvars.ContextVar("whole", default=False)
GIVE_TURN: contextvars.ContextVar[Callable[[], None] | None] = contextvars.ContextVar("give turn", default=None)
TURN_IS_DUE: contextvars.ContextVar[Callable[[], bool] | None] = contextvars.ContextVar("turn is due", default=None)


class InterruptionError(Exception):
    """A solve was cancelled by another thread; the state is that of the last complete call of a kernel."""


def stop_request() -> NDArray[np.int64]:
    """The request, (4,), of the kernels that are called from this thread."""
    request = REQUEST.get()
    if request is None:
        request = np.array([0, 1, 0, 0], np.int64)
        REQUEST.set(request)
    return request


def use_request(
    request: NDArray[np.int64],
    give_turn: Callable[[], None] | None = None,
    turn_is_due: Callable[[], bool] | None = None,
) -> None:
    """Let solves of this thread read `request` (4,). Any thread may set its STOP and TURN.

    give_turn: called on this thread when TURN is set, in the middle of a solve; it raises nothing. turn_is_due: called
    by `raise_if_stopped`, because TURN may be set late.
    """
    request[FUNCTION] = id(give_turn) if give_turn else 0
    REQUEST.set(request)
    GIVE_TURN.set(give_turn)  # which keeps it alive
    TURN_IS_DUE.set(turn_is_due)


def raise_if_stopped() -> None:
    """Raises KeyboardInterrupt after a Ctrl-C that a kernel noticed, InterruptionError if another thread cancels.

    The latter request stays set, so that no further part of the same call begins; the thread that set it clears it.
    Yields first if a turn was requested or is due. Inside `kept_whole` only ABANDON cancels.
    """
    request, give_turn, is_due = stop_request(), GIVE_TURN.get(), TURN_IS_DUE.get()
    if give_turn and (request[TURN] or (is_due is not None and is_due())):
        request[TURN] = 0
        give_turn()
    if request[STOP] == ABANDON or (request[STOP] and not WHOLE.get()):
        if request[SIGNALS]:
            request[STOP] = 0
            raise KeyboardInterrupt
        raise InterruptionError


@contextlib.contextmanager
def kept_whole() -> Iterator[None]:
    """Inside, only ABANDON makes `raise_if_stopped` raise: for several changes that must be made together."""
    before = WHOLE.set(True)
    try:
        yield
    finally:
        WHOLE.reset(before)


def is_kept_whole() -> bool:
    """True if this thread is inside `kept_whole`."""
    return WHOLE.get()


def pieces(count: int, size: int) -> Iterator[slice]:
    """Slices of at most `size` that cover range(count). Yields before each (`raise_if_stopped`, which may raise)."""
    for start in range(0, count, size):
        raise_if_stopped()
        yield slice(start, min(start + size, count))
