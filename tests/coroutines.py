"""How a test runs a coroutine."""

import asyncio
from collections.abc import Callable, Coroutine
from concurrent.futures import ThreadPoolExecutor
from typing import Any


def run(coroutine: Coroutine[Any, Any, Any], loop: Callable[[], asyncio.AbstractEventLoop] | None = None) -> Any:
    """The coroutine's result. It runs in a thread of its own: playwright leaves a running loop in the tests' thread.

    loop: makes the event loop, asyncio's by default.
    """

    def in_thread() -> Any:
        with asyncio.Runner(loop_factory=loop) as runner:
            return runner.run(coroutine)

    with ThreadPoolExecutor(1) as pool:
        return pool.submit(in_thread).result()
