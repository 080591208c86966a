"""Lines on the simulation thread, described by the parameters or by a file."""

import abc
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.messages import GrabTo, PlotRow, Pull, Release, RestartStatistics, SceneCommand, Vector, vector_of
from app.scenes.charts import Chart
from app.scenes.checkpoints import copied, restore
from app.scenes.mooring.arrangement import surface_heights, surface_side
from app.scenes.mooring.frame import MooringFrame, MooringReadings
from app.scenes.mooring.parameters import MAX_LINES, MooringParams
from app.scenes.mooring.readings.excursion import Excursion
from app.scenes.mooring.readings.restoring import CurveInputs, RestoringCurve
from app.scenes.mooring.readings.tensions import Tensions
from app.scenes.mooring.rows import LineRows
from app.scenes.mooring.start import MooringStart, rest_or_start
from app.scenes.mooring.start_check import Fault
from app.scenes.plot_rows import PlotRows
from app.scenes.springs.divergence import LastMoments, divergence_text, leapfrog_alternative
from app.scenes.springs.speed_advice import faster_steps
from sim.floating.motion.rotation import quaternion_by_vector
from sim.mooring import System
from sim.springs import INTEGRATORS
from sim.springs.forces.under_water.bending import set_line_tensions
from sim.springs.stability import Gauge, Mode, gauge_of, moved_modes, top_modes
from sim.springs.state import State, advance, velocities
from sim.validation import DivergenceError
from sim.waves import AMPLITUDE, Waves

FRAME_INTERVAL = 1 / 30  # [s] between frames
SAMPLE = 1 / 240  # [s] between two samples of the tensions: a snap is short
FADE = 10.0  # [s] over which waves and current begin, as the mooring starts at rest
MAX_TENSION_SCALE = 2.0  # end of the colour scale, in largest static tensions
LINE_SERIES = tuple(f"line {i + 1}" for i in range(MAX_LINES))
ANCHOR_SERIES = tuple(f"anchor {i + 1}" for i in range(MAX_LINES))
SERIES = (*LINE_SERIES, "largest so far", *ANCHOR_SERIES, "offset")


class LineScene(abc.ABC):
    """Lines on the simulation thread, whatever holds them; see `app.scenes.contract.Scene`."""

    frame_interval = FRAME_INTERVAL
    pace = 1.0
    note = ""
    changing: tuple[str, ...]  # attributes that a checkpoint holds
    system: System
    sea: Waves | None
    rows: LineRows

    @property
    @abc.abstractmethod
    def middle(self) -> Vector:
        """[m] of the body or vessel, where it rests without lines or begins."""

    def __init__(self, params: MooringParams) -> None:
        self.params = params
        self.plot_rows = PlotRows()
        self.last_moments = LastMoments()
        self.restoring = RestoringCurve()
        self.reset()

    @property
    def step(self) -> float:
        """Time step [s]."""
        return self.params.time_step

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.state.t

    @property
    def faster(self) -> str:
        """Advice on a faster step."""
        return faster_steps(INTEGRATORS[self.params.integrator], self.stability, "segments")

    def reset(self) -> None:
        """Begin at rest in level water, with all objects at their initial places."""
        self.grabbed: tuple[int, Vector] | None = None
        self.arrange()
        rest, failure = rest_or_start(self.system)
        self.state = State.still(rest.nodes)
        self.excursion = Excursion(self.body_place())
        fault = self.fault_of(self.rows.stretch(rest.nodes), failure)
        self.start = MooringStart.of(rest, self.rows, fault, failure)
        self.assess_stability()
        self.tensions = Tensions(len(self.rows.lengths))
        self.measure()
        self.plot_rows.restart()
        self.last_moments.clear()

    @abc.abstractmethod
    def fault_of(self, stretch: NDArray[np.float64], failure: str) -> Fault | None:
        """The fault of a state to start with, or None.

        stretch: (lines,) over the length. failure: of the search for rest, or "".
        """

    @abc.abstractmethod
    def arrange(self) -> None:
        """Make the system and all trackers from the parameters."""

    @abc.abstractmethod
    def take_system(self) -> None:
        """Continue with the mooring as arranged now."""

    @abc.abstractmethod
    def change_forces(self, params: MooringParams) -> None:
        """Take parameters; the motion continues."""

    @property
    @abc.abstractmethod
    def is_dragged(self) -> bool:
        """True while a user moves a part of the mooring."""

    def handle(self, command: SceneCommand) -> None:
        """Carry out a command of the mouse, or restart the statistics."""
        match command:
            case RestartStatistics():
                self.tensions.restart()
                self.excursion.restart()
                self.measure()
            case GrabTo(0, target, client) if self.grabbed is None or self.grabbed[0] == client:
                self.grabbed = client, target
            case Release(client) if self.grabbed is not None and self.grabbed[0] == client:
                self.grabbed = None
            case _:
                pass

    @abc.abstractmethod
    def body_place(self) -> NDArray[np.float64]:
        """(3,) [m] of the middle of the body or vessel."""

    @abc.abstractmethod
    def pull_of_body(self, target: Vector) -> Pull:
        """The pull of the body or vessel towards a target [m]."""

    @abc.abstractmethod
    def rotation(self) -> NDArray[np.float64]:
        """(3,) [rad] of it."""

    @abc.abstractmethod
    def paths(self, duration: float) -> NDArray[np.float64]:
        """(moved points, 5, 3) for `duration` [s], as `LineArrays` has them."""

    def diagnosis(self) -> str:
        """Cause of the divergence, and settings that would be stable."""
        fault = self.start.fault
        if fault is not None and fault.is_grave:
            return fault.said
        method = INTEGRATORS[self.params.integrator]
        other = leapfrog_alternative(method, self.stability)
        return divergence_text(self.time, method, self.step, self.stability, other)

    @abc.abstractmethod
    def arrays(self) -> dict[str, tuple[NDArray[Any], str]]:
        """The state for a file: name -> (array, unit)."""

    @abc.abstractmethod
    def curve_inputs(self, far: float = 0.0) -> CurveInputs:
        """Everything that the restoring curve depends on. far: [m] offset to which it goes at least."""

    def lying(self) -> NDArray[np.float64]:
        """(lines,) [m] of unstretched length on the bed."""
        return self.rows.lying(self.points, -self.system.water.depth)

    def force_of_lines(self) -> NDArray[np.float64]:
        """Level force (2,) [N] of the lines on the body or vessel now."""
        return self.rows.level_force(self.points, self.tension)

    def end_tension(self) -> NDArray[np.float64]:
        """(lines, 2) [N] at the anchor and the fairlead of each line now."""
        return np.column_stack((self.tensions.anchor, self.tensions.fairlead))

    def assess_stability(self) -> None:
        """Find the modes about the state, and with them the longest stable step."""
        self.step_modes: list[Mode] = top_modes(self.system, self.state.x)
        self.step_motion = moved_modes(self.system, self.state.x)
        self.take_step()

    def take_step(self) -> None:
        """Compare the time step with the last modes found."""
        self.stability: Gauge = gauge_of(
            self.step_modes, INTEGRATORS[self.params.integrator], self.step, self.step_motion
        )

    def driven(self) -> dict[str, NDArray[np.float64]]:
        """Fields of the kernels' view that change with time: waves and current, which begin smoothly."""
        if self.time >= FADE:
            return {}
        p = self.system.kernel_view(self.step)
        waves = p.waves.copy()
        waves[AMPLITUDE] *= self.fade
        return {"waves": waves, "current": self.fade * p.current}

    @property
    def fade(self) -> float:
        """Factor on waves and current, which begin smoothly."""
        return fade_at(self.state.t)

    def advance(self, steps: int) -> None:
        """Take steps. Raises DivergenceError if the state leaves its bounds, and keeps the last good one."""
        if self.start.failure:
            raise DivergenceError(self.start.failure if self.start.fault is None else self.start.fault.said)
        self.add_due_row()  # of the start
        method, h = INTEGRATORS[self.params.integrator], self.step
        piece = max(1, round(SAMPLE / h))
        for first in range(0, steps, piece):
            count = min(piece, steps - first)
            good = self.state.copy()
            paths = self.paths(h * count)
            advance(self.system, self.state, method, h, count, driven={"paths": paths, **self.driven()})
            if not self.start.is_bounded(self.state.x, self.rows):
                self.state = good
                raise DivergenceError(self.diagnosis(), tuple(self.last_moments))
            self.measure()
        self.add_due_row()

    def add_due_row(self) -> None:
        """Add the plot row of now, if one is due."""
        if self.plot_rows.is_due(self.time):
            self.add_plot_row()

    def find_tensions(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Find the tensions in the state; returns the forces (lines, 3) [N] at anchors and fairleads."""
        p, state = self.system.kernel_view(self.step)._replace(**self.driven()), self.state
        tension = np.empty(len(p.ends))
        v = velocities(self.system, state)
        set_line_tensions(state.x.reshape(-1), v.reshape(-1), p, tension)
        self.tension, self.points = tension[self.rows.links], self.rows.points(state.x)
        return self.rows.end_forces(state.x, v, state.t, p)

    def measure(self) -> None:
        """Measure tensions, offset and path of the state, and add them to the statistics."""
        if self.is_dragged:
            self.tensions.leave_out(self.time, self.params.wave_period)
        at_anchor, at_fairlead = self.find_tensions()
        self.tensions.measure(self.time, self.tension, at_anchor, at_fairlead)
        self.excursion.measure(self.time, self.body_place(), counts=self.tensions.counts)

    def add_plot_row(self) -> None:
        """Add tensions and offset at the scene's time."""
        now = self.tensions
        fairleads, anchors = (1e-3 * one[:MAX_LINES] for one in (now.fairlead, now.anchor))
        missing = (math.nan,) * (MAX_LINES - len(fairleads))
        self.plot_rows.add(
            self.time, *fairleads.tolist(), *missing, 1e-3 * float(now.at_fairlead.largest.max()), *anchors.tolist(),
            *missing, self.excursion.offset,
        )  # fmt: skip

    def readings(self) -> MooringReadings:
        """Numbers for the panel."""
        now, lines = self.tensions, self.tensions.readings(self.lying())
        return MooringReadings(
            lines, self.excursion.offset, self.excursion.largest, now.most_at, self.stability, self.start.fault,
            now.since, now.at_fairlead.duration, now.counts, now.dragged,
        )  # fmt: skip

    def frame(self) -> MooringFrame:
        """Frame to draw; kept for a while, to be shown again if the run diverges."""
        p = self.params
        frame = MooringFrame(
            params=p,
            time=self.time,
            body=self.body_place().astype(np.float32),
            rotation=np.array(quaternion_by_vector(self.rotation()), np.float32),
            points=self.points.astype(np.float32),
            tension=self.tension.astype(np.float32),
            full_scale=MAX_TENSION_SCALE * self.start.scale,
            surface=surface_heights(p, self.sea, self.time, self.fade),
            side=surface_side(p),
            path=self.excursion.path,
            rest=vector_of(self.excursion.rest),
            offset=self.excursion.largest,
            anchors=self.points[:, 0].astype(np.float32),
            fairleads=self.points[:, -1].astype(np.float32),
            uplift=self.tensions.uplift > 0.0,
            grab=None if self.grabbed is None else self.pull_of_body(self.grabbed[1]),
        )
        self.last_moments.add(self.time, frame, frame.points)
        return frame

    def take_plot_rows(self) -> tuple[PlotRow, ...]:
        """The plot rows since the last call."""
        return self.plot_rows.take()

    def curves(self) -> dict[str, Chart] | None:
        """The static restoring curve, with the force of the lines now."""
        if not self.params.plot_restoring:
            return None
        wave, excursion = self.wave_direction, self.excursion
        now = float((self.body_place() - excursion.rest)[:2] @ wave)
        pull = -float(self.force_of_lines() @ wave)
        return {"plot_restoring": self.restoring.chart(self.curve_inputs, self.rows, excursion.farthest, now, pull)}

    @property
    def wave_direction(self) -> NDArray[np.float64]:
        """Unit vector (2,) along the waves."""
        bearing = math.radians(self.params.direction)
        return np.array([math.cos(bearing), math.sin(bearing)])

    def keep(self) -> dict[str, object]:
        """Checkpoint: everything that changes."""
        return copied({name: getattr(self, name) for name in self.changing}, self.system, self.sea)

    def resume(self, checkpoint: object) -> None:
        """Resume from a checkpoint of `keep`."""
        restore(self, checkpoint)
        self.grabbed = None
        self.take_step()
        self.tensions.take_now(*self.find_tensions())
        self.plot_rows.resume()
        self.last_moments.clear()


def fade_at(t: float) -> float:
    """Factor on loads that begin smoothly, at time t [s]."""
    fraction = min(t / FADE, 1.0)
    return fraction * fraction * (3.0 - 2.0 * fraction)
