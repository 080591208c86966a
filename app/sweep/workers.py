"""Who runs the cases: processes on all cores of this machine, or the workers of a Dask cluster.

Either way a case whose worker dies is run again, and one that kills its workers ends as failed: nothing is lost, and
nothing holds up the rest.
"""

import logging
import multiprocessing
import os
import signal
import socket
import threading
from collections import deque
from collections.abc import Generator, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from multiprocessing.connection import Connection
from typing import Any

from app.sweep.case import Outcome, failed, program, run_case
from sim.validation import argument_error

Job = tuple[str, dict[str, Any], tuple[float, ...]]  # what run_case takes
PATIENCE = 20.0  # [s] for a scheduler to answer, and for its first worker


def cores() -> int:
    """How many this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def on_cores(jobs: dict[int, Job]) -> Iterator[tuple[int, Outcome]]:
    """Outcomes as they come, from as many processes as there are cores."""
    waiting = deque(jobs)
    suspects: deque[int] = deque()
    while waiting or suspects:
        if not suspects:
            suspects.extend((yield from from_pool(jobs, waiting, cores())))
            continue
        # One of them killed a worker: alone, it will show which.
        suspect = suspects.popleft()
        if (yield from from_pool(jobs, deque([suspect]), 1)):
            yield suspect, failed("the process that ran it was killed (out of memory?)")


def from_pool(jobs: dict[int, Job], queue: deque[int], width: int) -> Generator[tuple[int, Outcome], None, list[int]]:
    """Outcomes of the jobs in `queue`; returns the numbers of those that were running when a process died."""
    context = multiprocessing.get_context("spawn")
    reader, writer = context.Pipe(duplex=False)
    pool = ProcessPoolExecutor(
        min(width, len(queue)), mp_context=context, initializer=live_with_parent, initargs=(reader,)
    )
    running: dict[Future[Outcome], int] = {}
    try:
        while queue or running:
            while queue and len(running) < 2 * width:
                running[pool.submit(run_case, *jobs[queue[0]])] = queue[0]
                queue.popleft()
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                outcome = future.result()
                yield running.pop(future), outcome
    except BrokenProcessPool:
        return list(running.values())
    finally:
        writer.close()
        pool.shutdown(wait=True, cancel_futures=True)
        reader.close()
    return []


def live_with_parent(reader: Connection) -> None:
    """Make this worker process end when its parent does, or lets go of the other end, and leave Ctrl-C to it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def watch() -> None:
        try:
            reader.recv()
        except (EOFError, OSError):
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def on_cluster(address: str, jobs: dict[int, Job]) -> Iterator[tuple[int, Outcome]]:
    """Outcomes as they come, from the workers of the Dask scheduler at `address`.

    Raises ValueError where no scheduler or worker answers, or the workers run another program; OSError where the
    scheduler goes away.
    """
    from distributed import CancelledError, Client, as_completed

    check_address(address)
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    try:
        client = Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise argument_error(
            "--scheduler", address, f"the address of a running Dask scheduler ({one_line(error)})"
        ) from None
    with client:
        check_workers(client, address)
        numbers = {}
        for number, job in jobs.items():
            numbers[client.submit(run_case, *job, key=f"springtide-{os.getpid()}-{number}", pure=False)] = number
        arriving = as_completed(list(numbers), loop=client.loop)
        for future in arriving:
            if not future.done():
                arriving.add(future)  # its worker died holding the outcome: it is computed again
                continue
            number = numbers.pop(future)
            if future.status == "error":
                yield number, failed(f"on the cluster: {one_line(future.exception())}")
                continue
            try:
                outcome = future.result()
            except (OSError, CancelledError):
                raise OSError(f"the scheduler at {address} has gone") from None
            yield number, outcome


def check_address(address: str) -> None:
    """Raises ValueError where nothing listens at `address`: a client that fails leaves threads behind."""
    host, _, port = address.rpartition("://")[2].rpartition(":")
    if not (host and port.isdecimal() and int(port) < 65536):
        raise argument_error("--scheduler", address, "an address such as tcp://host:8786")
    try:
        socket.create_connection((host.strip("[]"), int(port)), PATIENCE).close()
    except (OSError, UnicodeError) as error:
        raise argument_error("--scheduler", address, f"where a Dask scheduler listens ({error})") from None


def check_workers(client: Any, address: str) -> None:
    """Raises ValueError where there is no worker, or one that runs another program."""
    try:
        client.wait_for_workers(1, timeout=PATIENCE)
        programs = client.run(program)
    except TimeoutError:
        raise argument_error("--scheduler", address, "a scheduler with at least one worker") from None
    except Exception as error:
        raise argument_error("--scheduler", address, f"workers with springtide installed ({one_line(error)})") from None
    for worker, found in programs.items():
        if found != program():
            raise argument_error("--scheduler", address, f"workers that run {program()}; {worker} runs {found}")


def one_line(error: Any) -> str:
    return " ".join(f"{type(error).__name__}: {error}".split())[:300]
