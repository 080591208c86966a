"""The contract of a scene with the simulation loop, the viewer, the panel, sweeps and headless runs.

To add a scene, add one folder here, named as the scene is on the command line:

1. `parameters.py`: a frozen dataclass of parameters (`sim/parameters.py`), such as `RopeParams`, with at least `speed`
   and `grid`, each declaring what its change affects, and `PRESETS`, name -> the values that differ from the defaults;
   the first preset is the defaults. `ABOUT` holds a sentence on each: its subject and something to try.
2. `scene.py`: the simulation, a class that satisfies `Scene`. It imports no viewer.
3. `view.py`: the drawing, a class derived from `SceneView`, and `VIEW`, that class. Only it and `*_view.py` beside it
   import viser.
4. `__init__.py`: `SCENE = SceneKind(...)`, the table of all these. It imports no viewer either.

The folder is discovered here: command line, panel, sweeps, benchmarks and tests then have the scene.
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


Pieces: TypeAlias = Mapping[str, Callable[[], object]]  # name of a piece -> compiles it, by running it


class Advice(NamedTuple):
    """A value of a parameter that removes a fault."""

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
        """Time [s] between two frames that the scene requests at present."""
        ...

    @property
    def pace(self) -> float:
        """Factor on the speed of the parameters that the scene requests at present, up to 1: less is slow motion."""
        ...

    @property
    def note(self) -> str:
        """Reason why the scene departs from the parameters, or ""."""
        ...

    @property
    def faster(self) -> str:
        """Advice on speed, for a sentence of the panel: "fewer points or a larger step"."""
        ...

    def change_forces(self, params: P) -> None:
        """Take parameters. At least one that affects the forces has changed; the motion continues.

        A change of the look only is assigned to `params`; a change of the start is assigned, and then `reset` is
        called.
        """
        ...

    def reset(self) -> None:
        """Restart with `params`; objects that a browser has moved return to their initial places."""
        ...

    def handle(self, command: SceneCommand) -> None:
        """Carry out a command of a browser; a command without meaning for the scene is ignored."""
        ...

    def advance(self, steps: int) -> None:
        """Take steps. Raises DivergenceError if the state leaves its bounds, and then keeps the last good one.

        A long solve may yield to others on this thread (`sim/interruption.py`). The scene then shows the last whole
        step, and changes take effect at the next call.
        """
        ...

    def frame(self) -> F_co:
        """Frame to draw: immutable, arrays float32."""
        ...

    def readings(self) -> R_co:
        """Numbers for the panel: immutable."""
        ...

    def take_plot_rows(self) -> tuple[PlotRow, ...]:
        """The plot rows since the last call; if nobody takes them, a scene keeps only the newest."""
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

    def resume(self, checkpoint: object) -> None:
        """Resume from a checkpoint of `keep`, with the `params` of that time; `checkpoint` can be used again.

        Objects that were held then are released.
        """
        ...


class SceneView(Protocol[P, F, R]):
    """The drawing of a scene, used on the viewer's thread only.

    FIELD_OF_VIEW: vertical, of a new camera [rad]. CAMERA: position and target [m] of a camera that nobody has moved.
    WARM_UP: everything to compile that the drawing may call. BUTTONS: heading of a note -> label and command of each
    button below its text.
    """

    WARM_UP: ClassVar[Pieces] = {}
    BUTTONS: ClassVar[Mapping[str, Mapping[str, SceneCommand]]] = {}
    FIELD_OF_VIEW: float
    CAMERA: tuple[Vector, Vector]

    def __init__(self, server: "ViserServer", post: "PostCommand") -> None:
        """Make the permanent nodes. post: takes commands."""

    def first_view(self, params: P) -> tuple[Vector, Vector]:
        """Position and target [m] of a camera that nobody has moved, with these parameters."""
        return self.CAMERA

    def show(self, frame: F) -> None:
        """Assign a frame to the handles; called where all updates of a picture are sent together."""
        ...

    def figures(self, snapshot: Snapshot[P, F, R]) -> str:
        """HTML under the panel's status line: the one or two figures that matter, in one line of text."""
        ...

    def readout(self, snapshot: Snapshot[P, F, R]) -> str:
        """HTML under the first controls: short, such as a colour key."""
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
    """An event up to which a button of the panel runs."""

    label: str  # of the button
    hint: str
    offered: Callable[..., bool]  # params -> true if it can happen
    reached: Callable[..., bool]  # snapshot -> true while it happens


class FramePacking(NamedTuple):
    """Packing of a scene's frames for a recording. The packed form is a tuple."""

    pack: Callable[..., tuple[object, ...]]  # frame -> its packed form
    unpack: Callable[..., object]  # packed form -> a frame that looks the same


class FileFacts(NamedTuple):
    """Facts of a file behind a scene."""

    name: str  # of the event
    facts: Mapping[str, object]  # as JSON holds them, in SI units
    unused: frozenset[str]  # names of the parameters without effect beside it


class FileEditing(NamedTuple):
    """Numbers of a file behind a scene, which the panel can change."""

    title: str  # of their folder
    thing: str  # label of the list of its things, such as "Line"
    # params -> thing -> number with its unit -> its value; empty without a file.
    numbers: Callable[..., Mapping[str, Mapping[str, float]]]
    changed: Callable[..., BaseParams]  # (params, thing, numbers) -> params; raises ValueError
    content: Callable[..., tuple[str, bytes]]  # params -> name and content of the file with its changes


class Layout(NamedTuple):
    """Names of the dimensions of a scene's arrays, in the dataset of a notebook."""

    axes: Mapping[str, tuple[str, ...]]  # array of `Scene.arrays` -> its dimensions; others have numbered ones
    labels: Mapping[str, Sequence[str] | Sequence[int]]  # dimension -> coordinates along it
    unused: frozenset[str]  # columns of the plot rows for things that the scene does not have


@dataclass(frozen=True)
class SceneKind(Generic[P, F, R]):
    """All facts of a scene that are known without making it."""

    name: str  # of its folder
    title: str
    help: str  # one line on the use of the mouse, as HTML
    params: type[P]
    presets: Mapping[str, Mapping[str, Value]]  # name -> the values that differ from the defaults
    make: Callable[[P], Scene[P, F, R]]
    series: tuple[str, ...]  # names of the columns of a plot row after its time
    plots: Mapping[str, PlotAxes]  # parameter that opens the plot -> its axes
    # The parameters without effect beside the present others.
    hidden: Callable[[P], set[str]] = lambda params: set()
    warm_up: Callable[[], Pieces] = dict[str, Callable[[], object]]  # everything to compile that the scene may call
    curves: Mapping[str, CurveAxes] = field(
        default_factory=dict[str, CurveAxes]
    )  # parameter that opens the chart -> its axes
    # The numbers that sweeps, tasks, notebooks and `run --list` read; without a table a sweep records the plot rows.
    quantities: Quantities = field(default_factory=dict[str, Quantity])
    instant: Callable[..., object] = SceneInstant  # of a scene, source of the recorded quantities
    # Unit of each array of a frame that goes into a file of the recording; arrays of a record in it: "record_array".
    # The first one in metres moves.
    frame_units: Mapping[str, str] = field(default_factory=dict[str, str])
    packing: FramePacking | None = None  # None: a recording keeps frames as they are
    stability_map: StabilityMap | None = None
    # Names of the pieces to run with these parameters, of `warm_up` and `warm_up_on_use`; None: all of `warm_up`.
    needs: Callable[[P], tuple[str, ...]] | None = None
    warm_up_on_use: Callable[[], Pieces] = dict[str, Callable[[], object]]  # pieces compiled only when they are needed
    # Makes the simulation with a student's functions beside it; None: the scene does not use them.
    make_with_student: Callable[[P, "LiveCode"], Scene[P, F, R]] | None = None
    # Place [m] that views of different parameters have in common; None: the origin.
    middle: Callable[[P], tuple[float, float]] | None = None
    about: Mapping[str, str] = field(
        default_factory=dict[str, str]
    )  # preset -> a sentence: its subject and something to try
    # Of a snapshot of a run that diverged: a stable value, or None; None: runs do not diverge.
    remedy: Callable[..., Advice | None] | None = None
    # Of a snapshot: true if a run with its parameters would be stable; None: runs do not diverge.
    is_stable: Callable[..., bool] | None = None
    # Of a snapshot: a value that repairs the initial state, offered under its control.
    advice: Callable[..., Advice | None] | None = None
    # Of parameters: lines on the files that they name, on data read and left out. The command line prints them, the
    # page shows them under "Files", and files of runs and recordings keep them.
    notes: Callable[[P], Sequence[str]] = lambda params: ()
    # Content of a file that replaces parameters, or None.
    file_facts: Callable[[P], FileFacts | None] = lambda params: None
    file_editing: FileEditing | None = None  # of such a file; None: the panel cannot change it
    warnings: Callable[..., Sequence[str]] | None = None  # of a new scene: sentences on its start
    layout: Callable[..., Layout] | None = None  # of a scene
    awaited: Awaited | None = None  # event up to which the panel offers to run
    opening: str = ""  # preset shown first by default: one that moves; "" for the defaults


PostCommand: TypeAlias = Callable[[Command], None]  # takes a command for the simulation
# A scene of any parameters, frames and readings, for the server and the panel.
AnyScene: TypeAlias = Scene[BaseParams, object, object]
AnyView: TypeAlias = SceneView[BaseParams, object, object]
AnyKind: TypeAlias = SceneKind[BaseParams, object, object]
AnySnapshot: TypeAlias = Snapshot[BaseParams, object, object]
