"""The contract of a scene with the simulation loop, the viewer, the panel, sweeps and headless runs.

To add a scene, add one folder here, named as the scene is on the command line:

1. `parameters.py`: a frozen dataclass of parameters (`sim/parameters.py`), such as `RopeParams`, with at least `speed`
   and `grid`, each declaring what its change affects, and `PRESETS`, name -> the values that differ from the defaults;
   the first preset is the defaults. `ABOUT` holds a sentence on each: what it shows and what to try.
2. `scene.py`: the simulation, a class that satisfies `Scene`. It imports no viewer.
3. `view.py`: the drawing, a class derived from `SceneView`, and `VIEW`, that class. Only it and `*_view.py` beside it
   import viser.
4. `__init__.py`: `SCENE = SceneKind(...)`, the table of all these. It imports no viewer either.

The folder is found by being here: command line, panel, sweeps, benchmarks and tests take it up from there.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar, Generic, NamedTuple, Protocol, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from app.messages import BaseParams, Command, F, P, PlotRow, R, SceneCommand, Snapshot, Vector
from app.scenes.charts import Chart, Columns, CurveAxes, PlotAxes
from app.scenes.quantities import Quantities, Quantity, SceneInstant
from sim.parameters import Value

if TYPE_CHECKING:
    from viser import ClientHandle, ViserServer

    from app.lab.student.live_code import LiveCode
    from sim.springs.net import Net

FRAME_INTERVAL = 1 / 60  # [s] between ticks of the loop, and between two frames of a scene that asks for nothing else


F_co = TypeVar("F_co", covariant=True)
R_co = TypeVar("R_co", covariant=True)


Pieces: TypeAlias = Mapping[str, Callable[[], object]]  # name of what is compiled -> compiles it, by running it


class Advice(NamedTuple):
    """A value of a parameter that mends a fault."""

    name: str  # of the parameter
    value: float
    words: str  # the value with its unit


class Scene(Protocol[P, F_co, R_co]):
    """A simulation, used on the simulation thread only. P: its parameters, F: its frames, R: its readings."""

    params: P

    @property
    def step(self) -> float:
        """Time step [s], the unit of `advance`."""
        ...

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        ...

    @property
    def frame_interval(self) -> float:
        """Time [s] between two frames that the scene asks for just now."""
        ...

    @property
    def pace(self) -> float:
        """Factor on the speed of the parameters that the scene asks for just now, up to 1: below it is slow motion."""
        ...

    @property
    def note(self) -> str:
        """Reason why something else runs than the parameters ask for, or ""."""
        ...

    @property
    def faster(self) -> str:
        """Advice on speed, for a sentence of the panel: "fewer points or a larger step"."""
        ...

    def change_forces(self, params: P) -> None:
        """Take parameters. At least one that affects the forces has changed; the motion goes on.

        A change that affects only the look is assigned to `params`; one that affects the start is assigned, and then
        `reset` is called.
        """
        ...

    def reset(self) -> None:
        """Begin again with `params`; objects that a browser has moved go back to their initial places."""
        ...

    def handle(self, command: SceneCommand) -> None:
        """Carry out a command of a browser; a command without meaning for the scene is ignored."""
        ...

    def advance(self, steps: int) -> None:
        """Take steps. Raises DivergenceError where the state leaves its bounds, and then keeps the last good one.

        A long solve may give others a turn on this thread (`sim/interruption.py`). What the scene shows in it is then
        that of a whole step, and what is done to it counts from the next call on.
        """
        ...

    def frame(self) -> F_co:
        """Frame to draw: immutable, arrays float32."""
        ...

    def readings(self) -> R_co:
        """Numbers for the panel: immutable."""
        ...

    def take_plot_rows(self) -> tuple[PlotRow, ...]:
        """The plot rows since the last call; of those that nobody takes a scene keeps the newest only."""
        ...

    def curves(self) -> Mapping[str, Chart | Columns] | None:
        """Parameter -> columns of its chart, for the charts that are no time series; None without a chart."""
        ...

    def arrays(self) -> Mapping[str, tuple[NDArray[np.generic], str]]:
        """The state for a file: name -> (array, unit)."""
        ...

    def keep(self) -> object:
        """Checkpoint: independent copies of everything that changes as the scene runs (`app/scenes/checkpoints.py`)."""
        ...

    def resume(self, kept: object) -> None:
        """Go on from a checkpoint of `keep`, with the `params` of that time; `kept` can be used again.

        Nobody holds what was held then.
        """
        ...


class SceneView(Protocol[P, F, R]):
    """The drawing of a scene, used on the viewer's thread only.

    FIELD_OF_VIEW: of a new camera, vertical [rad]. CAMERA: position and target [m] of a camera that has not been moved.
    WARM_UP: everything to compile that the drawing may call. BUTTONS: heading of a note -> label and command of each
    button below its text.
    """

    WARM_UP: ClassVar[Pieces] = {}
    BUTTONS: ClassVar[Mapping[str, Mapping[str, SceneCommand]]] = {}
    FIELD_OF_VIEW: float
    CAMERA: tuple[Vector, Vector]

    def __init__(self, server: "ViserServer", post: "PostCommand") -> None:
        """Make the nodes that are always there. post: takes commands."""

    def first_view(self, params: P) -> tuple[Vector, Vector]:
        """Position and target [m] of a camera that has not been moved, with these parameters."""
        return self.CAMERA

    def show(self, frame: F) -> None:
        """Assign a frame to the handles; called where a picture is handed over as one."""
        ...

    def figures(self, snapshot: Snapshot[P, F, R]) -> str:
        """HTML under the panel's status line: the one or two figures that matter, in one line of text."""
        ...

    def readout(self, snapshot: Snapshot[P, F, R]) -> str:
        """HTML under the first controls: short, as the key of the colours."""
        return ""

    def marks(self, snapshot: Snapshot[P, F, R]) -> dict[str, str]:
        """Parameter -> the line under its control."""
        return {}

    def notes(self, snapshot: Snapshot[P, F, R]) -> dict[str, str]:
        """Heading -> HTML of the folders below the controls."""
        return {}

    def set_dark(self, client: "ClientHandle", dark: bool) -> None:
        """Draw the surroundings of the scene dark, or light again, for one browser; a sea's light is a parameter."""

    def close(self) -> None:
        """Release callbacks and threads, which outlive the scene's nodes."""


class MethodParams(BaseParams, Protocol):
    """Additional parameters of a scene with one spring network."""

    @property
    def integrator(self) -> str:
        """Name in INTEGRATORS."""
        ...

    @property
    def time_step(self) -> float:
        """Step h [s]."""
        ...


class SpringParams(MethodParams, Protocol):
    """Additional parameters of a scene with a stability map."""

    @property
    def points(self) -> int:
        """Number of points."""
        ...


class StabilityMap(NamedTuple):
    """Additional contract for the panel's map of step and stiffness; the parameters are `SpringParams`."""

    stiffness: Callable[..., str]  # params -> name of the stiffness parameter in force
    build: Callable[..., "Net"]  # params -> the net that they describe


class Awaited(NamedTuple):
    """An event that a button of the panel runs on to."""

    label: str  # of the button
    hint: str
    offered: Callable[..., bool]  # params -> whether it can happen
    reached: Callable[..., bool]  # snapshot -> whether it happens just now


class FramePacking(NamedTuple):
    """Packing of a scene's frames for a recording. The packed form is a tuple."""

    pack: Callable[..., tuple[object, ...]]  # frame -> its packed form
    unpack: Callable[..., object]  # packed form -> a frame that looks the same


class FileFacts(NamedTuple):
    """Facts of a file that a scene runs."""

    name: str  # of the event
    facts: Mapping[str, object]  # as JSON holds them, in SI units
    unused: frozenset[str]  # names of the parameters that mean nothing with it


class FileEditing(NamedTuple):
    """Numbers of a file that a scene runs, which the panel changes."""

    title: str  # of their folder
    thing: str  # label of the list of its things, such as "Line"
    # params -> thing -> number with its unit -> its value; empty without a file.
    numbers: Callable[..., Mapping[str, Mapping[str, float]]]
    changed: Callable[..., BaseParams]  # (params, thing, numbers) -> params; raises ValueError
    content: Callable[..., tuple[str, bytes]]  # params -> name and content of the file with its changes


@dataclass(frozen=True)
class SceneKind(Generic[P, F, R]):
    """All there is to know of a scene without making one."""

    name: str  # of its folder
    title: str
    help: str  # one line on what the mouse does, as HTML
    params: type[P]
    presets: Mapping[str, Mapping[str, Value]]  # name -> the values that differ from the defaults
    make: Callable[[P], Scene[P, F, R]]
    series: tuple[str, ...]  # names of the columns of a plot row after its time
    plots: Mapping[str, PlotAxes]  # parameter that opens the plot -> what it shows
    # The parameters that mean nothing with the others as they are.
    hidden: Callable[[P], set[str]] = lambda params: set()
    warm_up: Callable[[], Pieces] = dict[str, Callable[[], object]]  # everything to compile that the scene may call
    curves: Mapping[str, CurveAxes] = field(
        default_factory=dict[str, CurveAxes]
    )  # parameter that opens the chart -> its axes
    # The numbers that sweeps, tasks, notebooks and `run --list` read; without a table a sweep records the plot rows.
    quantities: Quantities = field(default_factory=dict[str, Quantity])
    instant: Callable[..., object] = SceneInstant  # of a scene, what the recorded quantities are read from
    # Unit of each array of a frame that goes into a file of the recording; arrays of a record in it: "record_array".
    # The first one in metres is what moves.
    frame_units: Mapping[str, str] = field(default_factory=dict[str, str])
    packing: FramePacking | None = None  # None: a recording keeps frames as they are
    stability_map: StabilityMap | None = None
    # Names of the pieces to run with these parameters, of `warm_up` and `warm_up_on_use`; None: all of `warm_up`.
    needs: Callable[[P], tuple[str, ...]] | None = None
    warm_up_on_use: Callable[[], Pieces] = dict[str, Callable[[], object]]  # pieces compiled only when they are needed
    # Makes the simulation with a student's functions running beside it; None: this scene has no use for them.
    make_with_student: Callable[[P, "LiveCode"], Scene[P, F, R]] | None = None
    # Where [m] a view of these parameters and one of others have the same in sight; None: at the origin.
    middle: Callable[[P], tuple[float, float]] | None = None
    about: Mapping[str, str] = field(
        default_factory=dict[str, str]
    )  # preset -> a sentence: what it shows and what to try
    # Of a snapshot of a run that diverged: a value that would hold, None for none; None: a run does not diverge.
    remedy: Callable[..., Advice | None] | None = None
    # Of a snapshot: a value that mends the state that the scene starts with, offered under its control.
    advice: Callable[..., Advice | None] | None = None
    # Of parameters: lines on the files that they name, on what was read and what was left out. The command line prints
    # them, the page shows them under "Files", and files of runs and recordings keep them.
    notes: Callable[[P], Sequence[str]] = lambda params: ()
    # Content of a file that takes the place of parameters, or None.
    file_facts: Callable[[P], FileFacts | None] = lambda params: None
    file_editing: FileEditing | None = None  # of such a file; None: the panel changes none
    warnings: Callable[..., Sequence[str]] | None = None  # of a scene that begins: sentences on its start
    awaited: Awaited | None = None  # event that the panel offers to run on to
    opening: str = ""  # preset that is shown first where none is asked for: what moves; "" for the defaults


PostCommand: TypeAlias = Callable[[Command], None]  # takes a command for the simulation
# A scene of any parameters, frames and readings, for the server and the panel.
AnyScene: TypeAlias = Scene[BaseParams, object, object]
AnyView: TypeAlias = SceneView[BaseParams, object, object]
AnyKind: TypeAlias = SceneKind[BaseParams, object, object]
AnySnapshot: TypeAlias = Snapshot[BaseParams, object, object]
