"""Work spread over all cores, with a progress bar."""

import concurrent.futures
import multiprocessing
import os
from collections.abc import Callable, Sequence
from typing import Any

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn


def spread(work: Callable[..., Any], tasks: Sequence[tuple[Any, ...]], title: str, workers: int = 0) -> list[Any]:
    """[work(*task) for task in tasks], on `workers` processes (0: one a core; 1: here), with progress.

    Processes rather than threads, which between two calls of a kernel of some microseconds wait for each other.
    """
    workers = min(workers or os.cpu_count() or 1, len(tasks))
    columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn()
    with Progress(*columns, transient=True) as progress:
        bar = progress.add_task(title, total=len(tasks))
        if workers <= 1:
            found = []
            for task in tasks:
                found.append(work(*task))
                progress.advance(bar)
            return found
        # Spawned: numba's threads and viser's do not survive a fork.
        context = multiprocessing.get_context("spawn")
        with concurrent.futures.ProcessPoolExecutor(workers, mp_context=context) as pool:
            futures = [pool.submit(work, *task) for task in tasks]
            for future in futures:
                future.add_done_callback(lambda _: progress.advance(bar))
            return [future.result() for future in futures]
