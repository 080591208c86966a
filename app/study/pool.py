"""Work on all cores of this machine: the one pool of processes, for sweeps and for stability maps.

Processes and not threads, because threads wait for each other between two kernel calls of some microseconds. The
processes are spawned, because numba's threads and viser's do not survive a fork.

A task is lost with nothing but itself: if a process is killed (out of memory, for example), the tasks that it may have
worked on are run again one by one, which shows the task that kills, and all others are finished.
"""

import contextlib
import multiprocessing
import os
import signal
import sys
import threading
from collections import deque
from collections.abc import Callable, Generator, Hashable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from multiprocessing.connection import Connection
from typing import Any, NamedTuple, TypeVar

from rich import get_console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

K = TypeVar("K", bound=Hashable)
R = TypeVar("R")
MAX_WORKERS = 61 if sys.platform == "win32" else 1 << 30  # Windows waits for no more
Arguments = tuple[Any, ...]


class Killed(NamedTuple):
    """Stands for a result: the process that ran the task was killed, even when it ran nothing else."""

    reason: str = "the process that ran it was killed (out of memory?)"


def core_count() -> int:
    """The number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def progress_bar() -> Progress:
    """A progress bar that counts tasks and disappears at the end; nothing where the output is no terminal."""
    columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn()
    return Progress(*columns, transient=True, disable=not get_console().is_terminal)


def spread(work: Callable[..., R], tasks: Sequence[Arguments], title: str, workers: int = 0) -> list[R]:
    """[work(*task) for task in tasks] on `workers` processes, with a progress bar.

    workers: 0 for one on each core; 1 for this process. Raises what `work` raises, and OSError if a task kills its
    process.
    """
    with progress_bar() as progress:
        bar = progress.add_task(title, total=len(tasks))
        results: dict[int, R] = {}
        if workers == 1:
            pairs: Iterator[tuple[int, R | Killed]] = ((i, work(*task)) for i, task in enumerate(tasks))
        else:
            pairs = run_tasks(work, dict(enumerate(tasks)), workers)
        for index, result in pairs:
            if isinstance(result, Killed):
                raise OSError(f"{title}, part {index + 1} of {len(tasks)}: {result.reason}")
            results[index] = result
            progress.advance(bar)
    return [results[index] for index in range(len(tasks))]


def run_tasks(
    work: Callable[..., R], tasks: Mapping[K, Arguments], workers: int = 0
) -> Generator[tuple[K, R | Killed], None, None]:
    """(key, work(*task)) of every task as they are finished, on `workers` processes (0: one on each core).

    Raises what `work` raises; a task that kills its process gives `Killed`. Close the generator to stop the processes.
    """
    workers = workers or core_count()
    waiting = deque(tasks)
    suspects: deque[K] = deque()
    while waiting or suspects:
        if not suspects:
            suspects.extend((yield from run_in_pool(work, tasks, waiting, workers)))
            continue
        # One of the suspects killed a process. Each of them runs alone, which shows whether it was the one.
        suspect = suspects.popleft()
        if (yield from run_in_pool(work, tasks, deque([suspect]), 1)):
            yield suspect, Killed()


def run_in_pool(
    work: Callable[..., R], tasks: Mapping[K, Arguments], waiting: deque[K], workers: int
) -> Generator[tuple[K, R], None, list[K]]:
    """Results of the tasks in `waiting`, until that is empty or a process dies; returns the tasks then running."""
    context = multiprocessing.get_context("spawn")
    reader, writer = context.Pipe(duplex=False)
    pool = ProcessPoolExecutor(
        min(workers, len(waiting), MAX_WORKERS), mp_context=context, initializer=live_with_parent, initargs=(reader,)
    )
    running: dict[Future[R], K] = {}
    try:
        while waiting or running:
            while waiting and len(running) < 2 * workers:
                with sigint_blocked():
                    running[pool.submit(work, *tasks[waiting[0]])] = waiting[0]
                waiting.popleft()
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                result = future.result()
                yield running.pop(future), result
    except BrokenProcessPool:
        return list(running.values())
    finally:
        writer.close()
        pool.shutdown(wait=True, cancel_futures=True)
        reader.close()
    return []


@contextlib.contextmanager
def sigint_blocked() -> Iterator[None]:
    """Inside, this thread and the processes that it starts do not receive SIGINT (Ctrl-C).

    A terminal sends SIGINT to the worker processes too; one that is still importing would print a traceback. A process
    keeps the mask that it is started with. Windows has no masks: there a worker ignores SIGINT once it has started.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    from multiprocessing import resource_tracker

    resource_tracker.ensure_running()  # it unblocks SIGINT when it is started
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def live_with_parent(reader: Connection) -> None:
    """Make this worker process ignore Ctrl-C, and end when its parent ends or closes the other end of `reader`."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def watch() -> None:
        try:
            reader.recv()
        except (EOFError, OSError):
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
