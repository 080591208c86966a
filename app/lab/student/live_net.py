"""The rope or cloth of a student's functions: a thread that has it computed in a separate process.

A scene requests steps and takes their result; it never waits. `Versions` decides which version of the functions runs.
"""

import functools
import math
import queue
import time
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from app.lab.process.cloth_march import FILE as CLOTH_FILE
from app.lab.process.rope_march import FILE as ROPE_FILE
from app.lab.process.rope_march import ClothData, Forces, MarchResult, Segment
from app.lab.process.runner import RunError, Runner
from app.lab.process.shared import ON_HUB
from app.lab.student.saved import Saved
from app.lab.student.service import Service
from app.lab.student.versions import Done, Use, Versions

COMPILE_AFTER = 3.0  # [s] of processor time in plain Python, about as long as compiling
# On a hub: ratio of a rest after a march to the time for which other labs kept it from the processor, and the longest.
# Containers get equal parts of a busy processor, and a lab that always wants more than its part answers late.
REST_RATIO, MAX_REST = 16.0, 0.5  # [s]
TRIAL_STEPS = 3, 1 / 480  # for the trial of a new version, and their length [s]
Marched: TypeAlias = Done[MarchResult] | None  # None: without a working version


class StudentReport(NamedTuple):
    """A scene's report on the student's rope or cloth, for the panel. It is replaced, never changed."""

    version: int = 0  # of the files; 0: no function of the student's moves it
    own: frozenset[str] = frozenset()  # functions of the student's that move it
    compiled: tuple[str, ...] = ()  # functions that run compiled
    method: str = ""
    sphere: bool = False
    seconds: float = 0.0  # recent time of a step
    step: float = 0.0  # h [s]
    behind: float = 0.0  # [s] of simulated time
    restarts: int = 0  # number of restarts from the program's rope, after it was too late
    left_at: float = math.nan  # [s] when it left its bounds
    difference: float = math.nan  # [m] largest distance between the same points of both; NaN if the points differ
    unlike: tuple[str, ...] = ()  # reasons why a right solution differs from the program's, with the parameter first
    left_out: tuple[str, ...] = ()  # effects that the program's leaves out for it, as the tasks do
    grid: tuple[int, int] = (0, 0)  # rows and columns of the student's cloth, if coarser than the program's
    times: NDArray[np.float64] = np.zeros(0)  # (rows,) [s]
    differences: NDArray[np.float64] = np.zeros(0)  # (rows,) [m]


class NetKind(NamedTuple):
    """Differences between a rope and a cloth."""

    use: Use
    exact: frozenset[str]  # methods by which a right solution moves as the program's, to rounding
    steps: Mapping[str, str]  # method of the scene -> the function that takes its steps
    other_step: str  # that of the other methods
    used: Callable[[Collection[str], str, bool], Sequence[str]]  # begun, step, sphere -> functions that move it
    trial: Callable[[bool], tuple[np.ndarray, np.ndarray, Segment]]  # sphere -> x, v, (n, 3), and steps to try

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


def bent_rope(sphere: bool) -> tuple[np.ndarray, np.ndarray, Segment]:
    """A bent rope in motion, at a sphere or not, and some steps: x and v, shape (n, 3) [m], [m/s]."""
    n = 6
    x = np.zeros((n, 3))
    x[:, 0], x[:, 2] = -0.2 * np.arange(n), 3.0 - 0.02 * np.arange(n) ** 2
    v = np.linspace(0.0, 1.0, n)[:, None] * np.array([0.3, 0.2, -0.5])
    radius = 0.4 if sphere else 0.0
    forces = Forces(1.0, 800.0, 7.0, 1.0, 0.2, 10.0, floor=0.0, sr=radius, sx=-0.6, sz=2.5, friction=0.3)
    return x, v, Segment(*TRIAL_STEPS, forces, np.zeros((0, 4, 3)))


def stretched_cloth(sphere: bool) -> tuple[np.ndarray, np.ndarray, Segment]:
    """A level cloth that is stretched, in motion, and some steps: x and v, shape (n, 3) [m], [m/s]."""
    rows, cols, spacing = 4, 5, 0.1
    j, i = np.meshgrid(1.1 * spacing * np.arange(cols), 1.2 * spacing * np.arange(rows))
    x = np.stack([j, i, 2.0 + 0.1 * np.sin(3.0 * i + j)], axis=-1).reshape(-1, 3)
    sheet = ClothData(rows, cols, (spacing, spacing), 100.0, 3.0, (0, cols - 1))
    forces = Forces(0.05, 200.0, 0.1, 0.0, spacing, 9.81)
    return x, 0.1 * x, Segment(*TRIAL_STEPS, forces, np.zeros((0, 4, 3)), sheet=sheet)


ROPE = NetKind(
    Use("rope", "rope", ROPE_FILE, goes_on=True),
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
CLOTH = NetKind(
    Use("cloth", "cloth", CLOTH_FILE, goes_on=True),
    frozenset({"explicit_euler", "rk4", "symplectic_euler"}),
    {"explicit_euler": "step_euler", "rk4": "step_rk4"},
    "step_symplectic",
    lambda begun, step, sphere: ("cloth_forces", "cloth_links"),
    stretched_cloth,
)


class LiveNet(Service):
    """Runs steps on a worker thread. `march` is for the simulation thread, `attempt` for that which looks at files."""

    def __init__(self, material: NetKind, versions: Versions, compile_it: Callable[[], None] = lambda: None) -> None:
        """compile_it: called once the newest version has taken `COMPILE_AFTER` in plain Python."""
        self.material, self.versions, self.compile_it = material, versions, compile_it
        self.connect(lambda: None, lambda: None)
        self.method, self.sphere = "rk4", False  # of the last steps, for the trial of a new version
        self.moved_by: Saved | None = None  # the newest version, once it has taken steps in plain Python
        self.effort = 0.0  # [s] of processor time that it has taken
        super().__init__(f"student's {material.use.name}")

    def connect(self, wake: Callable[[], None], begin_again: Callable[[], None]) -> None:
        """Serve another scene. wake: called when there is an answer. begin_again: when another version takes over."""
        self.wake, self.begin_again = wake, begin_again
        self.report = StudentReport()  # replaced by the simulation thread

    def march(
        self, method: str, x: np.ndarray, v: np.ndarray, segments: Sequence[Segment],
        answers: "queue.SimpleQueue[Marched]",
    ) -> None:  # fmt: skip
        """Have steps taken from x and v, shape (n, 3) [m], [m/s]; the result is put into a queue.

        method: name in INTEGRATORS.
        """
        self.do(functools.partial(self.answer, method, x, v, segments, answers))

    def attempt(self) -> None:
        """Try the newest version in a few steps like the last ones; if it works, the scene restarts with it."""
        method, sphere = self.method, self.sphere

        def job(runner: Runner, own: frozenset[str]) -> MarchResult:
            x, v, segment = self.material.trial(sphere)
            return runner.march(own, self.material.step_of(method), x, v, [segment])

        own = functools.partial(self.material.own_of, method=method, sphere=sphere)
        if self.versions.attempt(self.material.use, own, job):
            self.begin_again()

    def answer(
        self, method: str, x: np.ndarray, v: np.ndarray, segments: Sequence[Segment],
        answers: "queue.SimpleQueue[Marched]",
    ) -> None:  # fmt: skip
        """Take steps, and answer in any case: a scene waits for it."""
        self.method, self.sphere = method, any(segment.forces.sr > 0.0 for segment in segments)
        own = functools.partial(self.material.own_of, method=method, sphere=self.sphere)

        def job(runner: Runner, own: frozenset[str]) -> MarchResult:
            return runner.march(own, self.material.step_of(method), x, v, segments)

        done, waited = None, MAX_REST
        try:
            done = self.versions.run(self.material.use, own, job)
            waited = max(0.0, done.value.seconds - done.value.effort) if ON_HUB and done is not None else 0.0
        except RunError:  # the machine is too busy; the scene repeats the request
            pass
        finally:
            answers.put(done)
            self.wake()
        if done is not None:
            self.count(done, waited)
        time.sleep(min(REST_RATIO * waited, MAX_REST))

    def count(self, done: Done[MarchResult], waited: float) -> None:
        """Count the effort of the newest version. waited: [s] for which other labs kept it from the processor."""
        if done.compiled or done.saved is not self.versions.of(self.material.use.file):
            return
        if done.saved is not self.moved_by:
            self.moved_by, self.effort = done.saved, 0.0
        self.effort += done.value.effort
        if self.effort >= COMPILE_AFTER and waited <= done.value.effort:
            self.effort = -math.inf  # not again
            self.compile_it()
