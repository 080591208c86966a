"""The student's rope or cloth beside the program's, as a scene sees it: its jobs and its progress.

The program's net never waits for the student's. Each piece of its motion is recorded and sent on; the picture shows
both at the moment that the student's has reached, so that what differs is the nets and not the time.
"""

import collections
import math
import queue
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.lab.process.rope_march import ClothData, Forces, Segment
from app.lab.student.live_net import LiveNet, Marched, StudentReport
from sim.springs import Net
from sim.springs.forces import OWN

MAX_BEHIND = 1.0  # [s] of simulated time that the student's rope may be late; then it starts again from the program's
MAX_MATCHED = 0.1  # [s] up to which the program's rope is drawn as late as the student's
JOB_TIME = 0.05  # [s] that a job should take
MAX_ROWS = 600  # kept of the course of the difference
MAX_PART = 16  # steps of a job at least: a slow function must not seem endless where a slow machine catches up


class Differences(NamedTuple):
    """Lines of `StudentReport`, with the parameters as they are."""

    unlike: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()


class StudentNet:
    """Used by a scene on the simulation thread."""

    sheet: ClothData | None = None  # data of a cloth; None for a rope
    differences = Differences()

    def __init__(self, live: LiveNet) -> None:
        self.live = live
        self.answers: queue.SimpleQueue[Marched] = queue.SimpleQueue()  # of one run: an earlier one had another
        self.rows: collections.deque[tuple[float, float]] = collections.deque(maxlen=MAX_ROWS)  # (t, m)
        self.since = 0.0  # [s] of the last restart from the program's net: what was before it is not compared
        self.waiting: collections.deque[Segment] = collections.deque()
        self.sent: list[Segment] = []  # that are being taken
        self.points: NDArray[np.float64] | None = None  # (n, 3) [m]; None without a net of the student's
        self.matched: NDArray[np.float64] | None = None  # (n, 3) [m] the program's at the same moment

    @property
    def max_speed(self) -> float:
        """Speed [m/s] of the fastest point, along an axis."""
        return 0.0 if self.points is None or self.left else float(np.abs(self.v).max())

    @property
    def is_comparable(self) -> bool:
        """True if it has the same points as the program's."""
        return True

    def begin(self, x: NDArray[np.float64], v: NDArray[np.float64], time: float) -> None:
        """Start at the program's net, x and v of shape (n, 3), at a time [s]."""
        self.answers = queue.SimpleQueue()
        self.waiting.clear()
        self.sent = []
        self.x, self.v, self.time = x, v, time
        self.points = self.matched = x if self.points is not None else None
        self.cost = 0.0  # [s] of a step; 0: not known
        self.left = False
        self.live.report = self.live.report._replace(left_at=math.nan, behind=0.0)

    def restart(self, x: NDArray[np.float64], v: NDArray[np.float64]) -> None:
        """A new run."""
        self.rows.clear()
        self.since = 0.0
        self.begin(x, v, 0.0)
        self.live.report = StudentReport(version=self.live.report.version)

    def follow(self, segment: Segment, end: float, method: str, x: NDArray[np.float64], v: NDArray[np.float64]) -> None:
        """Take a segment up to the time `end` [s], at which the program's net is at x with velocities v, (n, 3)."""
        self.method = method
        self.waiting += divided(segment._replace(sheet=self.sheet, end=end, x=x))
        if end - self.time > MAX_BEHIND and not self.left:
            restarts = self.live.report.restarts + 1
            self.begin(x, v, end)
            self.since = end
            self.live.report = self.live.report._replace(restarts=restarts, difference=math.nan)
        self.send()

    def send(self) -> None:
        """Hand over the waiting steps unless a job is running: as many as are done in `JOB_TIME`."""
        if self.sent or not self.waiting or self.left:
            return
        most = JOB_TIME / self.cost if self.cost else 1.0
        self.sent = [self.waiting.popleft()]
        sheet, steps = self.sent[0].sheet, self.sent[0].steps
        while self.waiting and self.waiting[0].sheet == sheet and steps + self.waiting[0].steps <= most:
            self.sent.append(self.waiting.popleft())
            steps += self.sent[-1].steps
        self.live.march(self.method, self.x, self.v, self.sent, self.answers)

    def collect(self, max_reach: float) -> None:
        """Take the answers that have come. max_reach: [m] from the first point at which a net has left its bounds."""
        while not self.answers.empty():
            self.take(self.answers.get_nowait(), max_reach)
        self.send()

    def take(self, done: Marched, max_reach: float) -> None:
        """Take an answer of this run."""
        segments, self.sent = self.sent, []
        if done is None:
            self.live.report = self.live.report._replace(version=0)
            self.points = self.matched = None
            for segment in (*segments, *self.waiting):
                if segment.x is not None:
                    self.x, self.v, self.time = segment.x, np.zeros_like(segment.x), segment.end
            self.waiting.clear()
            return
        march = done.value
        self.cost = march.step_time
        left = march.left
        for segment, x in zip(segments, march.x, strict=False):
            if np.linalg.norm(x - x[0], axis=1).max() > max_reach:
                left = True
                break
            self.x, self.time = x, segment.end
            if segment.x is None:
                continue
            self.points, self.matched = x, segment.x
            if self.is_comparable and segment.end - self.since >= (MAX_BEHIND if self.since else 0.0):
                self.rows.append((segment.end, float(np.linalg.norm(x - segment.x, axis=1).max())))
        self.v, self.left = march.v, left
        table = np.array(self.rows).reshape(-1, 2)
        self.live.report = self.live.report._replace(
            version=done.saved.number, own=done.own, compiled=done.compiled, method=self.method,
            **self.differences._asdict(), sphere=any(segment.forces.sr > 0.0 for segment in segments),
            seconds=march.step_time, step=segments[-1].h,
            behind=sum(segment.steps * segment.h for segment in self.waiting),
            left_at=self.time if left else math.nan,
            difference=self.rows[-1][1] if self.rows and self.rows[-1][0] >= self.since else math.nan,
            times=table[:, 0], differences=table[:, 1],
        )  # fmt: skip
        if left:
            self.waiting.clear()

    def drawn(self, x: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
        """The student's net and the program's beside it, (n, 3) [m]; None without the first. x: the program's now."""
        if self.points is None or self.matched is None or len(self.points) != len(x):
            return None
        return self.points, self.matched if self.live.report.behind <= MAX_MATCHED and not self.left else x


def divided(segment: Segment) -> list[Segment]:
    """The same steps in parts of MAX_PART at most."""
    parts = []
    for first in range(0, segment.steps, MAX_PART):
        last = min(first + MAX_PART, segment.steps)
        end = segment.end - (segment.steps - last) * segment.h
        x = segment.x if last == segment.steps else None
        parts.append(segment._replace(steps=last - first, since=first * segment.h, end=end, x=x))
    return parts


def forces_of(net: Net, start: float) -> Forces:
    """Material and surroundings of a net at a time [s]."""
    p, link = net.kernel_view(1.0), net.families[0]
    fields = {name: getattr(p, name) for name in p._fields if name in Forces._fields}
    fields |= {"mass": float(net.mass)}  # of each point: a student's net has equal masses
    fields |= {"stiffness": link.stiffness, "damping": link.damping, "rest_length": link.rest, "gravity": -p.gz}
    if not p.has_floor:
        fields["floor"] = -math.inf
    if not p.has_sphere:
        fields["sr"] = 0.0
    if not getattr(p, "has_air", False):  # a rope has none
        fields |= {"air_drag": 0.0, "air_lift": 0.0}
    declared = tuple((OWN[type(one)].name, tuple(map(float, one))) for one in net.forces)
    return Forces(**fields)._replace(epoch=p.epoch - start, declared=declared, began=start)
