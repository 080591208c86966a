"""The race: up to six ropes side by side, each with its own method, step or stiffness, against a reference run."""

import functools
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.messages import PlotRow, SceneCommand, Vector
from app.scenes.charts import Chart
from app.scenes.checkpoints import copied, restore
from app.scenes.contract import FRAME_INTERVAL, Pieces
from app.scenes.race.charts import RaceCharts
from app.scenes.race.entrants import Race, RaceReadings, race_bound
from app.scenes.race.names import rope_labels
from app.scenes.race.parameters import RaceParams, method_of
from app.scenes.springs.grab import GrabFrame
from app.scenes.springs.laws import SPRING, pieces_of_law
from app.scenes.springs.net_motion import NetMotion
from app.scenes.springs.rope_handles import RopeHandles, grab_spring, offset_of
from app.scenes.springs.rope_parameters import build_rope
from app.scenes.springs.warmup import GAUGE, integrator_pieces, pieces_of_methods
from sim.springs import INTEGRATORS, Net, rope
from sim.springs.analysis.reference_run import ReferenceRun

ASSESSMENT_INTERVAL = 0.5  # [s] of simulated time between two assessments of the stability
CHANGING = ("net", "race", "charts", "handles", "assessed_at")  # as the ropes move
REFERENCE = "reference run"  # name of the piece to compile


class RaceFrame(NamedTuple):
    """Drawn state of a race."""

    params: RaceParams
    ropes: NDArray[np.float32]  # (ropes, points, 3) [m], C-contiguous, side by side
    references: NDArray[np.float32] | None  # the same of the reference runs, or None if none is shown
    labels: tuple[str, ...]
    failed: tuple[bool, ...]
    root: Vector  # [m] to which the roots are moving
    grab: GrabFrame | None


def warm_up(law: str = SPRING) -> Pieces:
    """Everything to compile that the scene may call with links of a law."""
    net = rope(4, floor=-1.0, law=law)
    methods = integrator_pieces(net, rope(4, damping=0.0, drag=0.0, law=law))
    of_net = {GAUGE: compile_gauge, REFERENCE: compile_reference}
    return {**methods, **{piece: functools.partial(function, net) for piece, function in of_net.items()}}


def compile_gauge(net: Net) -> None:
    """The gauge of a rope, and the energies."""
    NetMotion(net, INTEGRATORS["leapfrog"], 1e-3, race_bound).gauge()


def compile_reference(net: Net) -> None:
    """The reference run."""
    ReferenceRun(net, 2.0, 1).advance(net, 0.0, 1e-3)


def needs(params: RaceParams) -> tuple[str, ...]:
    """Compiled pieces that a race with these parameters runs."""
    methods = {method_of(params, number) for number in range(1, params.ropes + 1)}
    return pieces_of_law((*pieces_of_methods(sorted(methods)), GAUGE, REFERENCE), params.law)


class RaceScene:
    """The race on the simulation thread."""

    frame_interval = FRAME_INTERVAL
    pace = 1.0
    faster = "fewer ropes, fewer points or longer steps"
    note = ""  # a rope with a method that cannot run stops and says so; no other method runs instead

    def __init__(self, params: RaceParams) -> None:
        self.params = params
        self.handles = RopeHandles()
        self.moving_nets: tuple[Net, list[Net]] | None = None  # of `nets_with`, with the net that they were made of
        self.reset()

    @property
    def step(self) -> float:
        """Time between two common instants of all ropes [s], the unit of `advance`."""
        return self.race.tick

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.race.t

    def reset(self) -> None:
        """Restart all ropes at rest, level from their roots at their initial places."""
        self.handles.restart()
        self.net = build_rope(self.params, self.handles.root.position)  # of rope 1
        self.race = Race(self.net, self.params)
        self.charts = RaceCharts(self.race)
        self.charts.update()  # of the start
        self.assessed_at = 0.0  # [s]

    def keep(self) -> dict[str, object]:
        """Checkpoint: all ropes and their references, the charts and moved objects."""
        return copied({name: getattr(self, name) for name in CHANGING}, self.charts.drawn)

    def resume(self, checkpoint: object) -> None:
        """Resume from a checkpoint of `keep`."""
        restore(self, checkpoint)
        self.handles.grab.clear()

    def change_forces(self, params: RaceParams) -> None:
        """Take new parameters; the motion continues."""
        self.params = params
        self.net = build_rope(params, self.handles.root.position)
        self.race.change_net(self.net)
        self.assessed_at = self.race.t

    def handle(self, command: SceneCommand) -> None:
        """Move the roots, pull the same point of all ropes, or release it."""
        self.handles.handle(command, [entrant.state for entrant in self.race.entrants], self.params.spacing)

    def advance(self, steps: int) -> None:
        """Take `steps` ticks of the race, whatever happens to its ropes."""
        race = self.race
        self.net = self.handles.net_during(self.net, race.t, steps * race.tick, race.tick, self.params)
        if self.moving_nets is None or self.moving_nets[0] is not self.net:  # nothing moves in most frames
            self.moving_nets = self.net, race.nets_with(self.net)
        race.advance(self.moving_nets[1], steps)
        if self.handles.root.at_rest:
            race.move_root(self.handles.root.position)
        if race.t - self.assessed_at >= ASSESSMENT_INTERVAL:
            race.assess_stability()
            self.assessed_at = race.t
        self.charts.update()

    def frame(self) -> RaceFrame:
        """Frame to draw."""
        params, race, handles = self.params, self.race, self.handles
        count, xs = params.ropes, [entrant.state.x for entrant in race.entrants]
        offsets = np.array([(0.0, offset_of(i, count, params.spacing), 0.0) for i in range(count)])[:, None]
        references = race.reference_points() if params.show_reference else None
        return RaceFrame(
            params=params,
            ropes=(race.points() + offsets).astype(np.float32),
            references=None if references is None else (references + offsets).astype(np.float32),
            labels=rope_labels(race.entrants),
            failed=tuple(bool(entrant.failure) for entrant in race.entrants),
            root=handles.home,
            grab=handles.grab_frame(xs, grab_spring(self.net, self.step, params.pull), params.spacing),
        )

    def readings(self) -> RaceReadings:
        """The results so far."""
        return self.race.readings()

    def curves(self) -> dict[str, Chart]:
        """The charts of `CURVES`."""
        return self.charts.charts()

    def take_plot_rows(self) -> tuple[PlotRow, ...]:
        """No plot rows: the charts of this scene thin out their data over time."""
        return ()

    def arrays(self) -> dict[str, tuple[NDArray[np.float64], str]]:
        """The state for a file: name -> (array, unit)."""
        race = self.race
        references = np.stack([reference.x.T for reference in race.references])
        separations = np.array([reference.separation for reference in race.references])
        taken = np.array([entrant.numerical_dissipation() for entrant in race.entrants])
        return {
            "x": (race.points(), "m"),
            "reference": (references, "m: one, or one for each rope where their stiffnesses differ"),
            "separation": (separations, "m, of each reference run from a second one that started 0.1 nm away"),
            "error": (np.array([race.error(e) for e in race.entrants]), "m, NaN where a rope or the reference failed"),
            "energy": (np.array([entrant.stored_energy() for entrant in race.entrants]), "J, stored"),
            "numerical_dissipation": (taken, "J, dissipated by the method"),
        }
