"""Messages between threads: commands to the simulation, snapshots and plot rows from it. All are immutable."""

import math
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import Future
from dataclasses import Field
from enum import Enum
from typing import ClassVar, Generic, NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from sim.parameters import Effect

Vector = tuple[float, float, float]

MAX_DISTANCE = 100.0  # [m] from the origin: nothing from a browser is placed farther out


class BaseParams(Protocol):
    """Parameters of any scene: a frozen dataclass of parameters (`sim/parameters.py`)."""

    __dataclass_fields__: ClassVar[dict[str, Field[object]]]

    @property
    def speed(self) -> float:
        """Target real-time factor."""
        ...

    @property
    def grid(self) -> bool:
        """True if the grid is drawn (key G)."""
        ...


P = TypeVar("P", bound=BaseParams)
F = TypeVar("F")
R = TypeVar("R")


def vector_of(x: NDArray[np.floating]) -> Vector:
    """(3,) [m] as a tuple."""
    return float(x[0]), float(x[1]), float(x[2])


def finite_vector(values: Iterable[object], max_distance: float = MAX_DISTANCE) -> Vector | None:
    """Three finite numbers, each bounded to `max_distance`; None if it is not three finite numbers."""
    try:
        x, y, z = (float(c) for c in values)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return None
    if not all(math.isfinite(c) for c in (x, y, z)):
        return None
    d = max_distance
    return min(max(x, -d), d), min(max(y, -d), d), min(max(z, -d), d)


def where_not_finite(frame: object, name: str = "") -> str:
    """The part of a frame (records, tuples, float arrays) that holds a NaN or an infinity; "" if none does."""
    if isinstance(frame, np.ndarray):
        return "" if frame.dtype.kind != "f" or np.isfinite(frame).all() else name or "an array"
    if isinstance(frame, float):
        return "" if math.isfinite(frame) else name or "a number"
    if isinstance(frame, tuple):
        names = getattr(frame, "_fields", (name,) * len(frame))
        for label, part in zip(names, frame, strict=True):
            where = where_not_finite(part, label)
            if where:
                return where
    return ""


class Play(NamedTuple):
    """Run."""


class Pause(NamedTuple):
    """Stop the clock."""


class TogglePlay(NamedTuple):
    """Run if paused, pause if running."""


class StepOnce(NamedTuple):
    """Pause, and advance by `steps` time steps."""

    steps: int = 1


class RunOn(NamedTuple):
    """Run, and pause as soon as an event begins."""

    reached: "Callable[[Snapshot[BaseParams, object, object]], bool]"  # True while it happens


class Halt(NamedTuple):
    """Pause because of an error, and show its text."""

    reason: str


class Reset(NamedTuple):
    """Back to the start of the scene; parameters and camera stay."""

    act: int = 0  # number of the person's act behind it (`History`); 0: none


class Checkpoint(NamedTuple):
    """A state from which a scene can continue."""

    value: object  # from `Scene.keep`
    arrays: Mapping[int, int]  # identity -> bytes of each array in it; some are shared with the states before
    run: int = 0  # number of its run


class Change(NamedTuple):
    """Take other parameters. The run continues, unless they affect the start: then another one begins."""

    params: BaseParams  # the scene's whole record
    effect: Effect  # of the change from the parameters posted before; "start" also if the act begins a run in any case
    act: int = 0  # number of the act that begins the run of these parameters; 0: that of the present run


class Begin(NamedTuple):
    """Restart the scene with these parameters and run, whatever has changed, as a preset does."""

    params: BaseParams
    act: int = 0


class Resume(NamedTuple):
    """Resume from a checkpoint of a scene with these parameters, and run."""

    params: BaseParams
    state: Checkpoint
    act: int = 0


class GoBack(NamedTuple):
    """Go back to the last run of an act as it was left, with these parameters; restart it if it is not kept."""

    params: BaseParams
    act: int
    runs: bool = False  # a restarted one runs, as after a preset; otherwise it plays if the present one does


class Place(NamedTuple):
    """Put a named thing of the scene (its root, its sphere) at a position [m]."""

    thing: str
    position: Vector


class GrabTo(NamedTuple):
    """Grab a particle or body, by flat index, and pull it towards a target [m]."""

    particle: int
    target: Vector
    client: int = 0  # the browser that drags


class Pull(NamedTuple):
    """A pull of a body, as drawn."""

    place: Vector  # [m] of the body
    target: Vector  # [m]
    load: float  # the force over the largest one, or the way over the longest one, 0 to 1
    limit: str  # words for what limits it


class Release(NamedTuple):
    """Release everything that a browser has grabbed."""

    client: int = 0


class PointAlong(NamedTuple):
    """Point along a ray: from `origin` [m] along `direction`."""

    origin: Vector
    direction: Vector


class RestartStatistics(NamedTuple):
    """Restart the statistics of the run."""


class StudentAnswer(NamedTuple):
    """A result of the process that runs a student's functions, for the scene to take."""


class GoOn(NamedTuple):
    """Continue the run under another act of a person, such as a drag; an undo of it restores the moment before."""

    act: int


class Ask(NamedTuple):
    """Call `read` between two steps, and answer with its result or exception."""

    read: Callable[[], object]
    answer: Future[object]


class Advance(NamedTuple):
    """Run for a simulated time, to a whole step, then continue or stand still as before; answer with the time then [s].

    If nobody watches it runs as fast as it can. The answer is a DivergenceError if the run halts before, and a
    RuntimeError if it restarts.
    """

    seconds: float
    answer: Future[float]


RecordCommand = Change | Begin | Resume | GoBack  # with a whole record of parameters
SceneCommand = (
    Place | GrabTo | Release | PointAlong | RestartStatistics | StudentAnswer
)  # for a scene; the rest is for the loop
Transport = Play | Pause | TogglePlay | StepOnce | RunOn | Halt
Command = Transport | Reset | RecordCommand | GoOn | Ask | Advance | SceneCommand


class RunIdentity(NamedTuple):
    """Identity of a run: the loop alone gives each new run its number."""

    number: int = 1  # in the order in which the runs of a scene begin
    act: int = 1  # number of the person's act that began it (`History`)
    before: int = 0  # number of the run that it resumed; 0: it began at the start of the scene
    since: float = 0.0  # [s] of simulated time at that moment
    placed: int = 1  # number of the act for which cameras are placed: of the run that others, by drags, continue


class RunLine:
    """The runs to which a record over time belongs: the present one, and those that it continues from."""

    def __init__(self) -> None:
        self.runs: list[RunIdentity] = []

    @property
    def number(self) -> int:
        """Number of the present run; 0 before the first."""
        return self.runs[-1].number if self.runs else 0

    def follow(self, run: RunIdentity) -> float:
        """Make a run the present one, unless it is older.

        Returns the time [s] up to which the record belongs to it: infinity for the same run, minus infinity for one
        that has nothing in common with it.
        """
        if run.number <= self.number:
            return math.inf
        while self.runs and self.runs[-1].number != run.before:
            self.runs.pop()
        end = run.since if self.runs else -math.inf
        self.runs.append(run)
        return end


PlotRow = tuple[float, ...]  # (t [s], one value for each name in the scene's SERIES)
RunRow = tuple[RunIdentity, PlotRow]  # a plot row with its run


class RunState(Enum):
    """State of a run; `app/server/loop/states.py` has the table of its changes."""

    MAKING = "making"  # the scene begins, or did and was cancelled, so that the next tick repeats it; then it runs
    MAKING_PAUSED = "making, paused"
    UNMADE = "unmade"  # the scene could not begin, and waits for other values
    RUNNING = "running"
    PAUSED = "paused"
    REPLAYING = "replaying"  # the last moments of a run that has just diverged
    REPLAY_PAUSED = "replay paused"
    HALTED = "halted"  # by an error; the last good state remains

    @property
    def plays(self) -> bool:
        """True if it goes on by itself, so that the button says "Pause"."""
        return self in (RunState.MAKING, RunState.RUNNING, RunState.REPLAYING)

    @property
    def is_making(self) -> bool:
        """True until the scene has begun."""
        return self in (RunState.MAKING, RunState.MAKING_PAUSED)

    @property
    def replays(self) -> bool:
        """True while the last moments of a divergence are shown."""
        return self in (RunState.REPLAYING, RunState.REPLAY_PAUSED)

    @property
    def has_stopped(self) -> bool:
        """True if an error has stopped the run, for a reason that the page shows."""
        return self in (RunState.UNMADE, RunState.HALTED)

    @property
    def has_failed(self) -> bool:
        """True after an error, also while its last moments are still shown."""
        return self.has_stopped or self.replays


class Status(NamedTuple):
    """State of the simulation loop."""

    state: RunState
    time: float  # [s] simulated
    steps: int
    speed: float  # target real-time factor
    actual_speed: float | None  # real-time factor over the last second of this run; None while it is not known
    capped: bool  # time that could not be made up is being dropped
    frame_rate: float  # frames per second published
    halted: str  # reason why the run has stopped by itself; "" in any other state
    run: RunIdentity = RunIdentity()
    # During the replay of a divergence, and at its end: corners [m] of the box that its moments fill.
    replayed: tuple[Vector, Vector] | None = None
    pace: float = 1.0  # factor on `speed` requested by the scene: below 1 is slow motion
    restarted: bool = False  # a recent undo had to restart the run, which was not kept
    outdated: bool = False  # the run stopped with other parameters than the present ones
    faster: str = ""  # advice that makes a capped run faster, or ""

    @property
    def running(self) -> bool:
        """True if the run goes on by itself."""
        return self.state.plays


class ChartLine(NamedTuple):
    """Style of one column of a chart."""

    label: str
    colour: str  # CSS
    width: float = 2.0
    dash: tuple[float, ...] = ()
    fill: str = ""  # CSS colour of the area below
    dots: bool = False  # a dot at each value instead of a line, in files
    cross: bool = False  # a cross with the label at the top edge, at each finite value, instead of a line


class Snapshot(NamedTuple, Generic[P, F, R]):
    """One moment for the viewer: the scene's frame (float32), its readings, and the state of the loop."""

    serial: int
    frame: F  # the scene's own record
    status: Status
    readings: R  # the scene's own record
    params: P  # the parameters of this moment
    curves: Mapping[str, object] | None = None  # parameter -> columns of its chart
    state: Checkpoint | None = None  # of this moment, to resume from later; in some snapshots only


class LastFrame(NamedTuple):
    """A frame of a run that diverged."""

    time: float  # [s] simulated
    frame: object  # the scene's own record
    low: Vector  # [m] corners of the box around the moving parts
    high: Vector  # [m]
