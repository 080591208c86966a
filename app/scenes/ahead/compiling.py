"""Compiles ahead: the pieces of each scene, a marker file for each compiled piece, and processes that compile them.

Compiling in the process of the lab would stop its threads. What is waited for is shared among some workers. Another
one, of low priority, continues with the rest of the open scene, and then with the other scenes. The workers fill the
cache on disk, from which this process loads. If one of them is killed, what it was at is compiled later by the process
that needs it.
"""

import collections
import functools
import os
import subprocess
import sys
import threading
from collections.abc import Iterable
from typing import NamedTuple

from app.lab.process.child_processes import end_with_this_program
from app.messages import BaseParams
from app.scenes import NAMES, scene_named, view_named
from sim.jit import CACHE, ROOT, is_kept, keep, reachable_hash

MAX_WORKERS = 4  # processes at once for what is waited for, each of 0.3 GB
AHEAD = -1  # number of the worker that compiles what nobody waits for
EVERYTHING = "everything"  # stands for all pieces of a scene, so that a later start need not ask it for them


class Job(NamedTuple):
    """A piece to compile."""

    scene: str
    piece: str
    drawn: bool = False  # of the drawing


@functools.cache
def hash_of(name: str, drawn: bool) -> str:
    """Hash of all sources that a scene's kernels, and its drawing's, can reach."""
    folder = ROOT / "app" / "scenes" / name
    return reachable_hash(folder / "scene.py", *([folder / "view.py"] if drawn else []))


def mark_of(job: Job) -> str:
    """Name of the file that stands for a compiled piece."""
    kind = "drawn" if job.drawn else "headless"
    return f"{job.scene}-{kind}-{job.piece.replace(' ', '_')}-{hash_of(job.scene, job.drawn)}.warm"


def is_marked(job: Job) -> bool:
    """True if this version of a piece has been compiled before, here or into a folder that is only read."""
    return is_kept(mark_of(job))


def all_jobs(name: str, *, drawn: bool = True) -> tuple[Job, ...]:
    """The pieces of a scene, and then, with `drawn`, those of its drawing.

    None of these takes long: where two processes share the pieces, both come to their end at about the same time.
    """
    drawing = (Job(name, piece, True) for piece in view_named(name).WARM_UP) if drawn else ()
    return *(Job(name, piece) for piece in scene_named(name).warm_up()), *drawing


def uncompiled(name: str, params: BaseParams | None = None) -> list[Job]:
    """Jobs of `all_jobs` still to be compiled. params: only those that run with these parameters; None: all.

    A scene that is compiled as a whole is not imported for that.
    """
    everything = is_marked(Job(name, EVERYTHING, True))
    if params is None and everything:
        return []
    needs = scene_named(name).needs
    needed = None if params is None or needs is None else needs(params)
    ahead = () if everything else all_jobs(name)
    wanted = [job for job in ahead if job.drawn or needed is None or job.piece in needed]
    if needed is not None:
        wanted = [Job(name, piece) for piece in scene_named(name).warm_up_on_use() if piece in needed] + wanted
    return [job for job in wanted if not is_marked(job)]


def compile_job(job: Job) -> None:
    """Compile one piece, and remember it."""
    name, piece, drawn = job
    kind = scene_named(name)
    pieces = view_named(name).WARM_UP if drawn else {**kind.warm_up_on_use(), **kind.warm_up()}
    pieces[piece]()
    keep(mark_of(job))
    # The drawing, and with it viser, is asked only where all else is compiled.
    if all(map(is_marked, all_jobs(name, drawn=False))) and all(map(is_marked, all_jobs(name))):
        keep(mark_of(Job(name, EVERYTHING, True)))


def compile_here(name: str, jobs: Iterable[Job]) -> None:
    """Compile pieces of a scene in this process, with progress on a terminal."""
    from rich import get_console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = SpinnerColumn(), TextColumn("compiling {task.description} (once)"), TimeElapsedColumn()
    with Progress(*columns, transient=True, disable=not get_console().is_terminal) as progress:
        task = progress.add_task(name, total=None)
        for job in jobs:
            progress.update(task, description=f"{name}: {job.piece}")
            compile_job(job)


def prepare(name: str, *, drawn: bool = True) -> None:
    """Compile the kernels of a scene that are not compiled yet. drawn: those of its drawing, too."""
    todo = [job for job in all_jobs(name, drawn=drawn) if not is_marked(job)]
    if todo:
        compile_here(name, todo)


class Compiling:
    """Queue of pieces to compile, and the workers that take from it."""

    def __init__(self, workers: int | None = None) -> None:
        """workers: how many processes; by default one for each core, at most MAX_WORKERS."""
        self.count = workers or max(1, min(MAX_WORKERS, os.cpu_count() or 1))
        self.changed = threading.Condition()
        self.urgent: collections.deque[Job] = collections.deque()
        self.rest: collections.deque[Job] = collections.deque()
        self.running: dict[int, Job] = {}  # by worker
        self.settled: set[Job] = set()  # compiled, or given up
        self.processes: dict[int, subprocess.Popen[str]] = {}
        self.ended = False
        self.threads: dict[int, threading.Thread] = {}

    def missing(self, name: str, params: BaseParams | None) -> list[Job]:
        """Pieces to compile before a scene runs with these parameters; None: all that it may ever call.

        Empty where nothing can be kept: then each process compiles for itself, when it calls. Empty, too, for
        parameters with which the scene cannot be built: it says why.
        """
        if CACHE is None:
            return []
        try:
            jobs = uncompiled(name, params)
        except ValueError:
            return []
        return [job for job in jobs if job not in self.settled]

    def want(self, jobs: Iterable[Job]) -> None:
        """Compile these next."""
        with self.changed:
            new = [job for job in jobs if job not in self.settled and job not in self.running.values()]
            self.urgent = collections.deque(dict.fromkeys([*new, *self.urgent]))
            self.rest = collections.deque(job for job in self.rest if job not in self.urgent)
            self.start(*range(self.count))
            self.changed.notify_all()

    def go_on_with(self, name: str) -> None:
        """Compile all that the scene `name` may call, and then all of the others, with low priority."""
        order = [name, *(other for other in NAMES if other != name)]
        jobs = [job for scene in order for job in self.missing(scene, None)]
        with self.changed:
            self.rest = collections.deque(job for job in jobs if job not in self.urgent)
            if self.rest:
                self.start(AHEAD)
            self.changed.notify_all()

    def wait(self, jobs: Iterable[Job], timeout: float) -> bool:
        """Wait until these have been compiled or given up, at most `timeout` [s]. Whether they have."""
        wanted = set(jobs)
        with self.changed:
            return self.changed.wait_for(lambda: self.ended or wanted <= self.settled, timeout)

    def progress(self) -> tuple[list[Job], int]:
        """The piece that is being compiled, and the number of waiting ones."""
        with self.changed:
            return list(self.running.values()), len(self.urgent) + len(self.rest)

    def close(self) -> None:
        """End the workers; only their running compilations are lost."""
        with self.changed:
            self.ended = True
            self.changed.notify_all()
            processes = list(self.processes.values())
        for process in processes:
            process.kill()
            process.wait()
        for thread in list(self.threads.values()):
            thread.join(1.0)

    def start(self, *numbers: int) -> None:
        """Start the threads of these workers, once."""
        for number in numbers:
            if number not in self.threads and not self.ended:
                thread = threading.Thread(target=self.work, args=(number,), name=f"compiling {number}", daemon=True)
                self.threads[number] = thread
                thread.start()

    def pop(self, number: int) -> Job | None:
        """The next job of a worker; None at the end."""
        with self.changed:
            self.changed.wait_for(lambda: self.ended or (self.rest if number == AHEAD else self.urgent))
            if self.ended:
                return None
            job = self.rest.popleft() if number == AHEAD else self.urgent.popleft()
            self.running[number] = job
            return job

    def work(self, number: int) -> None:
        """Hand job after job to a process."""
        while (job := self.pop(number)) is not None:
            problem = self.ask(number, job)
            with self.changed:
                del self.running[number]
                self.settled.add(job)
                is_idle = not (self.rest if number == AHEAD else self.urgent)
                self.changed.notify_all()
            process = self.processes.pop(number, None) if is_idle else None
            if process is not None:  # gives its memory back
                process.kill()
                process.wait()
            if problem and not self.ended:
                print(f"springtide: {job.scene}: {job.piece} could not be compiled ahead: {problem}", file=sys.stderr)

    def ask(self, number: int, job: Job) -> str:
        """Let the worker's process compile a job; returns the error, or ""."""
        try:
            process = self.processes.get(number)
            if process is None or process.poll() is not None:
                process = start_process(ahead=number == AHEAD)
                with self.changed:
                    self.processes[number] = process
                    if self.ended:  # `close` may have looked before the process was there
                        process.kill()
        except OSError as error:
            return str(error)
        assert process.stdin is not None
        assert process.stdout is not None
        problem = "the process ended"
        try:
            process.stdin.write(f"{job.scene}\t{job.piece}\t{int(job.drawn)}\n")
            process.stdin.flush()
            answer = process.stdout.readline()
        except OSError as error:
            answer, problem = "", str(error)
        if answer:
            return answer.strip()
        # A process that is about to end may still look alive: the next job must not be given to it.
        self.processes.pop(number, None)
        process.kill()
        process.wait()
        return problem


def start_process(*, ahead: bool) -> "subprocess.Popen[str]":
    """A process that compiles the pieces that it reads. ahead: at low priority."""
    path = os.pathsep.join(part for part in (str(ROOT), os.environ.get("PYTHONPATH", "")) if part)
    process = subprocess.Popen(
        [sys.executable, "-m", "app.scenes.ahead.compile_worker", *(["--ahead"] if ahead else [])],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env={**os.environ, "PYTHONPATH": path},
        text=True,
        encoding="utf-8",
    )
    end_with_this_program(process, background=ahead)
    return process


def describe(jobs: Iterable[Job], waiting: int) -> str:
    """Description of the running compilation."""
    names = ", ".join(f"{job.scene.replace('_', ' ')}: {job.piece}" for job in jobs)
    more = f", and {waiting} more" if waiting else ""
    return f"Compiling {names}{more}. This is done once." if names else ""
