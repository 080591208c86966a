"""Workers of a sweep: processes on all cores of this machine, or those of a Dask cluster.

Either way a case is run again when its worker dies, and a case that kills its workers ends as failed: nothing is lost,
and the other cases continue.
"""

import contextlib
import logging
import os
import socket
from collections.abc import Generator, Iterator
from typing import Any

from app.study.pool import Killed, run_tasks
from app.study.sweep.case import Outcome, failed, program, run_case
from sim.validation import argument_error

Job = tuple[str, dict[str, Any], tuple[float, ...]]  # arguments of run_case
MAX_ANSWER_TIME = 20.0  # [s] for a scheduler to answer, and for its first worker


def on_cores(jobs: dict[int, Job]) -> Generator[tuple[int, Outcome], None, None]:
    """Numbers and outcomes of the jobs as they are finished, from as many processes as there are cores."""
    with contextlib.closing(run_tasks(run_case, jobs)) as results:
        for number, outcome in results:
            yield number, failed(outcome.reason) if isinstance(outcome, Killed) else outcome


@contextlib.contextmanager
def connected(address: str) -> Iterator[Any]:
    """A client of the Dask scheduler at `address`, for as long as the block lasts.

    Raises ValueError if no scheduler or worker answers, or the workers run another program.
    """
    from distributed import Client

    check_address(address)
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    try:
        client = Client(address, timeout=MAX_ANSWER_TIME, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise argument_error(
            "--scheduler", address, f"the address of a running Dask scheduler ({one_line(error)})"
        ) from None
    with client:
        check_workers(client, address)
        yield client


def on_cluster(client: Any, jobs: dict[int, Job]) -> Generator[tuple[int, Outcome], None, None]:
    """Numbers and outcomes of the jobs as they are finished, from the workers of a Dask cluster.

    Raises OSError if the scheduler goes away.
    """
    from distributed import CancelledError, as_completed

    numbers = {}
    for number, job in jobs.items():
        numbers[client.submit(run_case, *job, key=f"springtide-{os.getpid()}-{number}", pure=False)] = number
    arriving = as_completed(list(numbers), loop=client.loop)
    for future in arriving:
        if not future.done():
            arriving.add(future)  # its worker died and took the outcome with it: it is computed again
            continue
        number = numbers.pop(future)
        if future.status == "error":
            yield number, failed(f"on the cluster: {one_line(future.exception())}")
            continue
        try:
            outcome = future.result()
        except (OSError, CancelledError):
            raise OSError(f"the scheduler at {client.scheduler.address} has gone") from None
        yield number, outcome


def check_address(address: str) -> None:
    """Raises ValueError if nothing listens at `address`. (A client that fails to connect leaves threads behind.)"""
    host, _, port = address.rpartition("://")[2].rpartition(":")
    if not (host and port.isdecimal() and int(port) < 65536):
        raise argument_error("--scheduler", address, "an address such as tcp://host:8786")
    try:
        socket.create_connection((host.strip("[]"), int(port)), MAX_ANSWER_TIME).close()
    except (OSError, UnicodeError) as error:
        raise argument_error("--scheduler", address, f"where a Dask scheduler listens ({error})") from None


def check_workers(client: Any, address: str) -> None:
    """Raises ValueError if there is no worker, or one that runs another program."""
    try:
        client.wait_for_workers(1, timeout=MAX_ANSWER_TIME)
        programs = client.run(program)
    except TimeoutError:
        raise argument_error("--scheduler", address, "a scheduler with at least one worker") from None
    except Exception as error:
        raise argument_error("--scheduler", address, f"workers with springtide installed ({one_line(error)})") from None
    for worker, worker_program in programs.items():
        if worker_program != program():
            raise argument_error(
                "--scheduler", address, f"workers that run {program()}; {worker} runs {worker_program}"
            )


def one_line(error: Any) -> str:
    """An exception's type and text, on one line of at most 300 characters."""
    return " ".join(f"{type(error).__name__}: {error}".split())[:300]
