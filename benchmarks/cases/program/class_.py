"""A class on one machine: a lab for each student, with a client that plays a lesson on the rope.

The clients share a separate process, and the table gives their processor time apart: those of a real class run on the
students' machines. Kernels are compiled before the first student arrives; the others follow one by one.
"""

import asyncio
import itertools
import math
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import AbstractContextManager, ExitStack
from multiprocessing import get_context
from pathlib import Path
from typing import Any, NamedTuple

from app.lab.course.folder import make_folder
from app.lab.course.task import load_tasks
from benchmarks.labs import served
from benchmarks.pupil import Pupil
from benchmarks.timing import load
from sim.validation import argument_error

STUDENTS, QUICK_STUDENTS, MAX_STUDENTS = 8, 2, 100
LESSON, QUICK_LESSON = 60.0, 15.0  # [s] that a student acts
BETWEEN = 2.0  # [s] from one student's start to the next one's
LIMIT = 0.2  # [s] for an answer, beyond which the table counts it as late
ACTIONS = ("button", "value", "task", "saved function")
Quantiles = tuple[float, float, float]


class Result(NamedTuple):
    """Answers and rates that a student's client measured."""

    answers: list[tuple[str, float]]
    rate: float  # frames a second
    pace: float  # simulated time over real time while the rope ran


class Usage(NamedTuple):
    """Memory and processor time of one lab and its child processes."""

    private: float  # memory that no other process has [MB]
    proportional: float  # that, and its fraction of what several have [MB]
    seconds: float  # processor time so far [s]
    at: float  # time of the reading [s]: on a busy machine the readings of a class take seconds


def rows(quick: bool = False, students: int | None = None) -> list[dict[str, Any]]:
    """Starts, answers, pictures, memory and processor time of a class. Works on Linux only.

    Raises ValueError for a number of students that is not allowed, or another system.
    """
    if not sys.platform.startswith("linux"):
        raise argument_error("class", sys.platform, "Linux, which says how much memory processes share")
    count = (QUICK_STUDENTS if quick else STUDENTS) if students is None else students
    if not 1 <= count <= MAX_STUDENTS:
        raise argument_error("--students", count, f"1 to {MAX_STUDENTS}")
    compile_kernels()
    lesson = QUICK_LESSON if quick else LESSON
    with tempfile.TemporaryDirectory(prefix="springtide-") as place, ExitStack() as stack:
        folders = [Path(place, f"student-{number}") for number in range(count)]
        tasks = load_tasks()
        for folder in folders:
            make_folder(folder, tasks)
        clients = stack.enter_context(ProcessPoolExecutor(1, get_context("spawn")))
        starts, labs = [], []
        for folder in folders:
            began = time.monotonic()
            labs.append(stack.enter_context(lab(folder)))
            starts.append(time.monotonic() - began)
            time.sleep(max(0.0, BETWEEN - starts[-1]))
        ports = [port for _, port in labs]
        playing = clients.submit(play, ports, folders, lesson)
        time.sleep(0.25 * lesson)
        before = [usage(pid) for pid, _ in labs]
        time.sleep(0.5 * lesson)
        after = [usage(pid) for pid, _ in labs]
        results, of_clients = playing.result()
    return [
        {"what": f"{count} students: command to address [s]", **spread(starts)},
        *(answer_row(action, results) for action in ACTIONS),
        {"what": "answers later than 0.2 s [%]", "median": late(results)},
        {"what": "pictures [1/s]", **spread([r.rate for r in results], least=True)},
        {"what": "simulated over real time", **spread([r.pace for r in results], least=True)},
        {"what": "processor of a lab [% of a core]", **spread(
            [100.0 * (b.seconds - a.seconds) / (b.at - a.at) for a, b in zip(before, after, strict=True)]
        )},
        {"what": "processor of a client [% of a core]", "median": 100.0 * of_clients / count},
        {"what": "private memory of a lab [MB]", **spread([u.private for u in after])},
        {"what": "memory of all labs [MB]", "median": sum(u.proportional for u in after)},
        {"what": "processes waiting (load)", "median": load()},
    ]  # fmt: skip


def compile_kernels() -> None:
    """Compile what is not compiled yet."""
    subprocess.run([sys.executable, "-m", "app", "warmup"], stdout=subprocess.DEVNULL, check=True)


def lab(folder: Path) -> AbstractContextManager[tuple[int, int]]:
    """A lab on a folder, as a JupyterHub starts it: its process, and its port."""
    environment = {"SPRINGTIDE_DATA": str(folder.with_name(f"{folder.name}-data")), "JUPYTERHUB_USER": folder.name}
    return served("lab", str(folder), "--resume", environment=environment, session=True)


def play(ports: Sequence[int], folders: Sequence[Path], lesson: float) -> tuple[list[Result], float]:
    """Play a lesson with one client for each lab; runs in a separate process.

    Returns the results, and the fraction of a core that all clients took.
    """
    start, spent = time.monotonic(), time.process_time()

    async def all_of_them() -> list[Result]:
        pupils = [Pupil(port, folder, seed) for seed, (port, folder) in enumerate(zip(ports, folders, strict=True))]
        await asyncio.gather(*(pupil.attend(lesson) for pupil in pupils))
        return [result_of(pupil) for pupil in pupils]

    results = asyncio.run(all_of_them())
    return results, (time.process_time() - spent) / (time.monotonic() - start)


def result_of(pupil: Pupil) -> Result:
    """Answers and rates of a client."""
    frames = pupil.frames
    # Steps between two status lines of a running rope, without those in which the student did something.
    steps = [(b[0] - a[0], b[1] - a[1]) for a, b in itertools.pairwise(pupil.clock) if b[1] > a[1]]
    wall = sum(step[0] for step in steps)
    gaps = [b - a for a, b in itertools.pairwise(frames)]
    rate = 1.0 / statistics.median(gaps) if gaps else 0.0
    return Result(pupil.answers, rate, sum(step[1] for step in steps) / wall if wall else math.nan)


def answer_row(action: str, results: Sequence[Result]) -> dict[str, Any]:
    """Answer times of one kind of action."""
    times = [time if math.isfinite(time) else math.inf for r in results for name, time in r.answers if name == action]
    return {"what": f"answer: {action} [s]", **spread(times)}


def late(results: Sequence[Result]) -> float:
    """Fraction of answers beyond the limit [%], without those to a saved file, which is tried first."""
    times = [time for r in results for action, time in r.answers if action != "saved function"]
    return 100.0 * sum(not time <= LIMIT for time in times) / max(1, len(times))


def spread(values: Sequence[float], *, least: bool = False) -> dict[str, float]:
    """Median, the value that 95 % do not exceed, and the largest; with `least`, from the other end."""
    if not values:
        return {"median": math.nan, "95 %": math.nan, "worst": math.nan}
    ordered = sorted(values, reverse=least)
    return {
        "median": statistics.median(values),
        "95 %": ordered[math.ceil(0.95 * len(ordered)) - 1],
        "worst": ordered[-1],
    }


def usage(pid: int) -> Usage:
    """Memory and processor time of a process and those that it has started."""
    private = proportional = ticks = 0.0
    for one in family(pid):
        try:
            lines = Path(f"/proc/{one}/smaps_rollup").read_text("utf-8").splitlines()[1:]
            fields = Path(f"/proc/{one}/stat").read_text("utf-8").rpartition(")")[2].split()
        except OSError:  # it has ended
            continue
        size = {line.partition(":")[0]: float(line.split()[1]) for line in lines}  # [kB]
        private += size["Private_Clean"] + size["Private_Dirty"]
        proportional += size["Pss"]
        ticks += sum(map(int, fields[11:15]))  # its own and that of ended children
    return Usage(private / 1e3, proportional / 1e3, ticks / os.sysconf("SC_CLK_TCK"), time.monotonic())


def family(pid: int) -> list[int]:
    """A process and all that descend from it."""
    found = [pid]
    for one in found:
        for path in Path(f"/proc/{one}/task").glob("*/children"):
            try:
                found += map(int, path.read_text("utf-8").split())
            except OSError:  # the thread has ended
                continue
    return found
