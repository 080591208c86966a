"""Ends a long solve early, or lets something else have a turn in the middle of it.

Kernels that may take long look at the numbers of `stop_request` now and then. The first is set by whoever wants the
solve to end. Where the second is set, they also ask Python for signals, which only the main thread gets. Where the
third is set, they call a function of Python's and then go on: so a solve of seconds lets its thread answer in between.
"""

import contextlib
import contextvars
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

# Indices into a request.
STOP = 0  # not 0: the solve is to end
SIGNALS = 1  # not 0: Python is to be asked for a Ctrl-C
TURN = 2  # not 0: FUNCTION is to be called, once
FUNCTION = 3  # address of a function without arguments, or 0
ABANDON = 2  # at STOP: nothing of the solve is needed any more, so that what is kept whole ends too

REQUEST: contextvars.ContextVar[NDArray[np.int64] | None] = contextvars.ContextVar("stop request", default=None)
WHOLE: contextvars.ContextVar[bool] = contextvars.ContextVar("whole", default=False)
GIVE_TURN: contextvars.ContextVar[Callable[[], None] | None] = contextvars.ContextVar("give turn", default=None)
TURN_IS_DUE: contextvars.ContextVar[Callable[[], bool] | None] = contextvars.ContextVar("turn is due", default=None)


class InterruptionError(Exception):
    """A solve was ended by another thread; the state is that of the last whole call of a kernel."""


def stop_request() -> NDArray[np.int64]:
    """The numbers that kernels called from this thread look at."""
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
    """Let solves of this thread look at `request` (4,). Any thread may set its STOP and TURN.

    give_turn: called where TURN is set, on this thread, in the middle of a solve; it raises nothing. turn_is_due: asked
    by `raise_if_stopped`, as who sets TURN may be late.
    """
    request[FUNCTION] = id(give_turn) if give_turn else 0
    REQUEST.set(request)
    GIVE_TURN.set(give_turn)  # which keeps it alive
    TURN_IS_DUE.set(turn_is_due)


def raise_if_stopped() -> None:
    """Raises KeyboardInterrupt after a Ctrl-C that a kernel noticed, InterruptionError where another thread asked.

    The request stays set in the latter case, so that nothing else of the same call begins; who set it takes it back.
    A turn that was asked for, or is due, is given first. Inside `kept_whole` only ABANDON ends something.
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
    """Inside, `raise_if_stopped` raises nothing but where all is abandoned: for a change of several things that must
    all be made, or none."""
    before = WHOLE.set(True)
    try:
        yield
    finally:
        WHOLE.reset(before)


def is_kept_whole() -> bool:
    """Whether this thread is inside `kept_whole`."""
    return WHOLE.get()


def pieces(count: int, size: int) -> Iterator[slice]:
    """Slices of at most `size` that cover range(count). Before each, others may have a turn; raises as
    `raise_if_stopped`."""
    for start in range(0, count, size):
        raise_if_stopped()
        yield slice(start, min(start + size, count))
