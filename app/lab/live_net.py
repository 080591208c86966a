"""The rope or cloth that a student's functions move: a thread that has it computed, in a separate process.

A scene hands jobs over and takes answers; it never waits. Of the versions of the student's files the newest one runs
that works; which one fails, and why, is kept until the next one is saved.
"""

import itertools
import math
import queue
import time
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.lab.cloth_march import FILE as CLOTH_FILE
from app.lab.cloth_march import Sheet
from app.lab.process import ON_HUB
from app.lab.rope_march import FILE as ROPE_FILE
from app.lab.rope_march import Forces, Segment
from app.lab.runner import BUSY, RunError, Runner, unexpected
from app.lab.saved import Saved
from app.lab.service import Service

COMPILE_AFTER = 3.0  # [s] of processor time in plain Python: about what compiling takes
# On a hub: ratio of a rest after a march to the time for which other labs kept it from the processor, and the longest.
# Containers get equal parts of a busy processor, and a lab that always wants more than its part answers late.
REST_RATIO, MAX_REST = 16.0, 0.5  # [s]


class Job(NamedTuple):
    """Steps that a scene asks for."""

    run: int  # number of the run that they belong to, from `LiveNet.runs`
    method: str  # name in INTEGRATORS
    x: np.ndarray  # (n, 3) [m]
    v: np.ndarray  # (n, 3) [m/s]
    segments: Sequence[Segment]
    answers: "queue.SimpleQueue[Answer]"  # of the scene that asks
    sheet: Sheet | None = None  # what a cloth is made of; None for a rope


class Answer(NamedTuple):
    """Result of a job."""

    run: int
    x: np.ndarray  # (segments, n, 3) [m] at the end of each segment
    v: np.ndarray  # (n, 3) [m/s]
    seconds: float  # for each step
    left: bool  # the rope has left all bounds
    version: int  # of the files; 0: none works, and nothing was computed
    compiled: tuple[str, ...] = ()


class Loaded(NamedTuple):
    """A version with its process, in which its rope has been tried."""

    saved: Saved
    runner: Runner
    compiled: tuple[str, ...] = ()  # the functions that are compiled in this process


class Trial(NamedTuple):
    """State and forces in which a new version takes a few steps."""

    x: np.ndarray  # (n, 3) [m]
    v: np.ndarray  # (n, 3) [m/s]
    forces: Forces
    sheet: Sheet | None = None


class StudentReport(NamedTuple):
    """A scene's report on the student's rope or cloth, for the panel. It is replaced, never changed."""

    version: int = 0  # of the files; 0: no function of the student's moves it
    compiled: tuple[str, ...] = ()  # functions that run compiled
    method: str = ""
    sphere: bool = False
    seconds: float = 0.0  # for each step, lately
    step: float = 0.0  # h [s]
    behind: float = 0.0  # [s] of simulated time
    restarts: int = 0  # how often it was too late and started again from the program's rope
    left_at: float = math.nan  # [s] when it left its bounds
    difference: float = math.nan  # [m] largest distance between the same points of both; NaN where they have others
    unlike: tuple[str, ...] = ()  # why a right solution differs from the program's, beginning with the parameter
    grid: tuple[int, int] = (0, 0)  # rows and columns of the student's cloth, where it is coarser than the program's
    times: NDArray[np.float64] = np.zeros(0)  # (rows,) [s]
    differences: NDArray[np.float64] = np.zeros(0)  # (rows,) [m]


class Material(NamedTuple):
    """Differences between a rope and a cloth."""

    file: str  # of the student's functions
    exact: frozenset[str]  # methods by which a right solution moves as the program's, to rounding
    steps: Mapping[str, str]  # method of the scene -> the function that takes its steps
    other_step: str  # that of the other methods
    used: Callable[[Collection[str], str, bool], Sequence[str]]  # begun, step, sphere -> functions that move it
    trial: Callable[[bool], Trial]  # sphere -> what a new version is tried with

    def step_of(self, method: str) -> str:
        """The function that takes the steps of a method."""
        return self.steps.get(method, self.other_step)

    def in_use(self, begun: Collection[str], method: str, *, sphere: bool) -> dict[str, bool]:
        """The functions that move it by this method, and whether each is the student's own."""
        return {name: name in begun for name in self.used(begun, self.step_of(method), sphere)}

    def own_of(self, begun: Collection[str], method: str, *, sphere: bool) -> frozenset[str]:
        """The student's functions that move it by this method."""
        return frozenset(name for name, is_own in self.in_use(begun, method, sphere=sphere).items() if is_own)


def used_by_rope(begun: Collection[str], step: str, sphere: bool) -> Sequence[str]:
    """The functions that move a rope; `rope_acceleration` calls `spring_force` itself, if it does."""
    forces = "rope_acceleration" if "rope_acceleration" in begun else "spring_force"
    return (forces, *(["sphere_force"] if sphere else []), step)


def bent_rope(sphere: bool) -> Trial:
    """A bent rope in motion, at a sphere or not."""
    n = 6
    x = np.zeros((n, 3))
    x[:, 0], x[:, 2] = -0.2 * np.arange(n), 3.0 - 0.02 * np.arange(n) ** 2
    v = np.linspace(0.0, 1.0, n)[:, None] * np.array([0.3, 0.2, -0.5])
    radius = 0.4 if sphere else 0.0
    return Trial(
        x, v, Forces(1.0, 800.0, 7.0, 1.0, 0.2, 10.0, floor=0.0, radius=radius, centre=(-0.6, 0.0, 2.5), friction=0.3)
    )


def stretched_cloth(sphere: bool) -> Trial:
    """A level cloth that is stretched, in motion."""
    rows, cols, spacing = 4, 5, 0.1
    j, i = np.meshgrid(1.1 * spacing * np.arange(cols), 1.2 * spacing * np.arange(rows))
    x = np.stack([j, i, 2.0 + 0.1 * np.sin(3.0 * i + j)], axis=-1).reshape(-1, 3)
    sheet = Sheet(rows, cols, (spacing, spacing), 100.0, 3.0, (0, cols - 1))
    return Trial(x, 0.1 * x, Forces(0.05, 200.0, 0.1, 0.0, spacing, 9.81), sheet)


ROPE = Material(
    ROPE_FILE,
    frozenset({"explicit_euler", "rk4"}),
    {
        "explicit_euler": "step_euler",
        "rk4": "step_rk4",
        "leapfrog": "step_leapfrog",
        "leapfrog_lagged": "step_leapfrog",
    },
    "step_rk4",
    used_by_rope,
    bent_rope,
)
# A cloth's step is the program's: by the method of the scene where that is cheap enough for plain Python.
CLOTH = Material(
    CLOTH_FILE,
    frozenset({"explicit_euler", "rk4", "symplectic_euler"}),
    {"explicit_euler": "step_euler", "rk4": "step_rk4"},
    "step_symplectic",
    lambda begun, step, sphere: ("cloth_forces", "cloth_links"),
    stretched_cloth,
)


class LiveNet(Service[Job | Loaded]):
    """Runs jobs in a thread. `submit` is for the simulation thread; `attempt` and `adopt` for who loads versions."""

    def __init__(
        self,
        material: Material,
        tell: Callable[[Saved, RunError | None], None],
        compile_it: Callable[[Saved], None] = lambda saved: None,
    ) -> None:
        """tell: is told of a version that fails while it runs, or that runs after all; on this object's thread.

        compile_it: called once with a version that has taken `COMPILE_AFTER` in plain Python.
        """
        self.material = material
        self.runs = itertools.count(1)  # for all scenes
        self.connect(lambda: None, lambda: None)
        self.method, self.sphere = "rk4", False  # of the last job: what a new version is tried with
        self.tell, self.compile_it = tell, compile_it
        self.effort = 0.0  # [s] of processor time that the newest version has taken in plain Python
        self.is_busy = False  # the machine was too busy for the last job
        self.waited = 0.0  # [s] for which other labs of a hub kept the last march from the processor
        # The one that is preferred last: the last version before the newest, the newest, the newest compiled.
        self.versions: list[Loaded] = []
        self.taken = 0  # number of the version that was taken last
        self.failed: set[tuple[int, bool, frozenset[str]]] = set()  # version, whether compiled, functions in use
        super().__init__("student's rope", material.file)

    def connect(self, wake: Callable[[], None], begin_again: Callable[[], None]) -> None:
        """Serve another scene. wake: called when there is an answer. begin_again: when another version is taken."""
        self.wake, self.begin_again = wake, begin_again
        self.report = StudentReport()  # replaced by the simulation thread

    def submit(self, job: Job) -> None:
        """Have steps taken; the answer comes through its queue."""
        self.inbox.put(job)

    def attempt(self, loaded: Loaded) -> None:
        """Take a few steps as the last job did, if the student's functions take them. Raises RunError."""
        own = self.material.own_of(loaded.saved.begun, self.method, sphere=self.sphere)
        if own:
            x, v, forces, sheet = self.material.trial(self.sphere)
            segment = Segment(3, 1 / 480, forces, np.zeros((0, 4, 3)))
            loaded.runner.march(own, self.material.step_of(self.method), x, v, [segment], sheet)

    def adopt(self, loaded: Loaded) -> None:
        """Take a version that has been tried, in place of those before it."""
        self.inbox.put(loaded)

    def handle(self, item: Job | Loaded) -> None:
        """Take a version, or answer a job whatever happens: a scene waits for the answer."""
        if isinstance(item, Loaded):
            self.take(item)
            return
        answer, self.waited = unanswered(item), 0.0
        try:
            answer = self.advance(item)
        finally:
            item.answers.put(answer)
            self.wake()
        time.sleep(min(REST_RATIO * self.waited, MAX_REST))

    def fail(self, item: Job | Loaded, error: RunError) -> None:
        """Say it of the version that was to be taken, or of the newest."""
        for loaded in [item] if isinstance(item, Loaded) else self.versions[-1:]:
            self.tell(loaded.saved, error)

    def close(self) -> None:
        """End the thread without waiting for steps that are being taken."""
        for loaded in list(self.versions):
            loaded.runner.abort()
        super().close()

    def release(self) -> None:
        """End the process of each version."""
        for loaded in self.versions:
            loaded.runner.close()

    def take(self, loaded: Loaded) -> None:
        """Keep a new version and the last one that worked before it; or the newest in a process that compiled it."""
        if loaded.compiled and loaded.saved.number != self.taken:
            loaded.runner.close()
            return
        for old in self.versions:
            old.runner.close()  # it starts again where it is needed
        plain = [old for old in self.versions if not old.compiled]
        self.versions = [*plain[-2 if loaded.compiled else -1 :], loaded]
        if loaded.compiled:
            return
        self.begin_again()
        self.taken, self.effort = loaded.saved.number, 0.0

    def advance(self, job: Job) -> Answer:
        """The steps of a job by the newest version that works."""
        self.method = job.method
        self.sphere = any(segment.forces.radius > 0.0 for segment in job.segments)
        for saved, runner, compiled in reversed(self.versions):
            own = self.material.own_of(saved.begun, job.method, sphere=self.sphere)
            if not own:
                break  # the student has written nothing that moves this
            attempt = saved.number, bool(compiled), own
            if attempt in self.failed:
                continue
            try:
                step = self.material.step_of(job.method)
                done = runner.march(own, step, job.x, job.v, job.segments, job.sheet)
            except Exception as error:
                runner.close()
                if isinstance(error, RunError) and error.kind == BUSY:  # the next job tries the same
                    self.tell(saved, error)
                    self.is_busy, self.waited = True, MAX_REST
                    return unanswered(job)
                self.failed.add(attempt)
                if not isinstance(error, RunError):
                    self.tell(saved, unexpected(error, self.material.file))
                elif not compiled:  # plain Python is tried next, and says where it was
                    self.tell(saved, error)
                continue
            if self.is_busy:
                self.tell(saved, None)
                self.is_busy = False
            self.waited = max(0.0, done.seconds - done.effort) if ON_HUB else 0.0
            if saved.number == self.taken and not compiled:
                self.effort += done.effort
                if self.effort >= COMPILE_AFTER and self.waited <= done.effort:
                    self.effort = -math.inf  # not again
                    self.compile_it(saved)
            each = done.seconds / max(done.steps, 1)
            return Answer(job.run, done.x, done.v, each, done.left, saved.number, compiled)
        return unanswered(job)


def unanswered(job: Job) -> Answer:
    """The answer to a job that no version has done."""
    return Answer(job.run, job.x[None][:0], job.v, 0.0, False, 0)
