"""The scene of moorings: a body on lines that the parameters describe, or the mooring of a MoorDyn file."""

import dataclasses
from typing import Any

from app.scenes.charts import CurveAxes, PlotAxes
from app.scenes.contract import Advice, FileFacts, Layout, Pieces
from app.scenes.mooring.body_scene import MooringScene
from app.scenes.mooring.files.file_scene import FileScene
from app.scenes.mooring.files.from_file import opened
from app.scenes.mooring.frame import MooringReadings
from app.scenes.mooring.line_scene import ANCHOR_SERIES, LINE_SERIES, LineScene
from app.scenes.mooring.parameters import EXPLICIT, OF_NO_FILE, MooringParams
from app.scenes.mooring.start_check import raised_points
from app.scenes.springs.divergence import holding_step
from app.scenes.springs.speed_advice import step_warnings
from sim.springs import INTEGRATORS

PLOTS = {
    "plot_tension": PlotAxes("Tension", "kN", (*LINE_SERIES, "largest so far"), least=1.0, dashed=True),
    "plot_anchor": PlotAxes("Tension at anchors", "kN", ANCHOR_SERIES, least=1.0, dashed=True),
    "plot_offset": PlotAxes("Offset", "m", ("offset",), least=0.5),
}
CURVES = {"plot_restoring": CurveAxes("Restoring force", "kN", "Offset along the waves [m]", ("static", "now"))}


def scene_of(params: MooringParams) -> LineScene:
    """The scene of the parameters, or of the file that they name."""
    return FileScene(params) if params.moordyn_file else MooringScene(params)


def compile_with(method: str) -> None:
    """Run the kernels of a method, and all that a scene calls."""
    scene = MooringScene(MooringParams(integrator=method, lines=1, segments=4, time_step=1e-4))
    scene.advance(2)
    scene.frame()
    scene.readings()


def warm_up() -> Pieces:
    """Pieces to compile ahead: the first method."""
    return {"leapfrog": lambda: compile_with("leapfrog")}


def on_use() -> Pieces:
    """The other methods."""
    return {name: (lambda name=name: compile_with(name)) for name in EXPLICIT if name != "leapfrog"}


def needs(params: MooringParams) -> tuple[str, ...]:
    """Compiled pieces that a scene with these parameters runs."""
    return ("leapfrog",) if params.integrator == "leapfrog" else ("leapfrog", params.integrator)


def remedy(snapshot: Any) -> Advice | None:
    """A value with which a diverged run would have stayed stable; a shorter step only if the start is not at fault."""
    now: MooringReadings = snapshot.readings
    if now.fault is not None and now.fault.is_grave:
        return now.fault.advice
    return holding_step(snapshot.params.time_step, now.stability)


def is_stable(snapshot: Any) -> bool:
    """True if a run with these parameters would be stable."""
    now: MooringReadings = snapshot.readings
    return (now.fault is None or not now.fault.is_grave) and now.stability.share <= 1.0


def advice(snapshot: Any) -> Advice | None:
    """A value that corrects the state at the start."""
    now: MooringReadings = snapshot.readings
    return None if now.fault is None else now.fault.advice


def warnings(scene: LineScene) -> list[str]:
    """Sentences on the state at the start."""
    said = [] if scene.start.fault is None else [scene.start.fault.said]
    said += step_warnings(INTEGRATORS[scene.params.integrator], scene.stability)
    return [*said, *(raised_points(opened(scene.params)) if scene.params.moordyn_file else ())]


def notes(params: MooringParams) -> tuple[str, ...]:
    """Lines on the file of the mooring, none without one."""
    return opened(params).notes if params.moordyn_file else ()


def file_facts(params: MooringParams) -> FileFacts | None:
    """Facts of the MoorDyn file, and the parameters that it replaces."""
    if not params.moordyn_file:
        return None
    system = opened(params).system
    facts = {
        **dataclasses.asdict(system.water),
        "bed_stiffness": system.bed_stiffness, "bed_damping": system.bed_damping, "friction": system.friction,
        "types": [kind._asdict() for kind in {line.type.name: line.type for line in system.lines}.values()],
        "points": [point._asdict() for point in system.points],
        "lines": [{**line._asdict(), "type": line.type.name} for line in system.lines],
    }  # fmt: skip
    return FileFacts("mooring", facts, frozenset(OF_NO_FILE))


def layout(scene: LineScene) -> Layout:
    """Dimensions of the arrays; lines are numbered as in the picture, those of a file's arrays have its numbers."""
    lines = len(scene.points)
    axes = {
        "x": ("line", "node", "axis"), "tension": ("line", "segment"), "end_tension": ("line", "end"),
        "body": ("axis",), "rotation": ("axis",), "vessel": ("axis",),
        **{f"x_{line.id}": (f"node_{line.id}", "axis") for line in scene.system.lines},
        **{f"tension_{line.id}": (f"segment_{line.id}",) for line in scene.system.lines},
    }  # fmt: skip
    labels = {"line": range(1, lines + 1), "axis": ("x", "y", "z"), "end": ("anchor", "fairlead")}
    return Layout(axes, labels, frozenset(LINE_SERIES[lines:] + ANCHOR_SERIES[lines:]))
