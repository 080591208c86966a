"""The mooring: a floating body on one to four lines in waves, between the bed and the water's surface."""

import dataclasses
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.formats.formatting import metres, percent
from app.messages import Grab, Place, PlotRow, Release, SceneCommand, Vector, vector_of
from app.scenes.charts import Chart, CurveAxes, PlotAxes
from app.scenes.contract import Pieces, SceneKind
from app.scenes.moments import copied, restore
from app.scenes.mooring.arrangement import (
    Places,
    body_of,
    build,
    first_places,
    hull_of,
    line_types,
    nodes_and_links,
    sea_of,
    sections,
    surface_heights,
    surface_side,
)
from app.scenes.mooring.frame import MooringFrame, MooringReadings
from app.scenes.mooring.live_values import live_values
from app.scenes.mooring.measures import measures
from app.scenes.mooring.parameters import ABOUT, EXPLICIT, MAX_LINES, PRESETS, Params, hidden
from app.scenes.mooring.restoring import RestoringCurve
from app.scenes.mooring.tensions import Tensions
from app.scenes.plot_rows import PlotRows
from app.scenes.springs.divergence import LastMoments, divergence_text, holding_step, leapfrog_alternative
from app.scenes.springs.speed_advice import faster_steps
from app.scenes.springs.tracking import CriticallyDampedTracker
from sim.mooring import System, at_rest
from sim.mooring.gauge import modes
from sim.mooring.simulate import LineState
from sim.mooring.statics import Rest, rest_of, straight
from sim.springs import INTEGRATORS
from sim.springs.lines.energy import set_tensions
from sim.springs.stability import Gauge, Mode, gauge_of
from sim.validation import ConvergenceError, DivergenceError

FRAME_INTERVAL = 1 / 30  # [s] between frames
SAMPLE = 1 / 240  # [s] between two looks at the tensions: a snap is short
FADE = 10.0  # [s] over which waves and current begin, as the mooring starts at rest
MAX_PATH = 1200  # places of the body's path that are kept
PATH_INTERVAL = 0.25  # [s]
# Largest speeds of what is dragged, so that no line snaps by it: in distances of anchors and sizes of the body [1/s].
ANCHOR_SPEED, FAIRLEAD_SPEED = 0.02, 0.1
DRAG_RATE = 1.0  # [rad/s] natural frequency of the mouse's pull on the body
# At rest, over a line's length: beyond it the line is too short for its anchor, which no shorter step mends.
MAX_STRETCH = 0.2
MAX_TENSION_SCALE = 2.0  # end of the colour scale, in largest static tensions
FARTHEST = 5.0  # in lengths of a line and distances of anchors, beyond which a run has diverged
LINE_SERIES = tuple(f"line {i + 1}" for i in range(MAX_LINES))
ANCHOR_SERIES = tuple(f"anchor {i + 1}" for i in range(MAX_LINES))
SERIES = (*LINE_SERIES, "largest so far", *ANCHOR_SERIES, "offset")
PLOTS = {
    "plot_tension": PlotAxes("Tension", "kN", (*LINE_SERIES, "largest so far"), least=1.0),
    "plot_anchor": PlotAxes("Tension at anchors", "kN", ANCHOR_SERIES, least=1.0),
    "plot_offset": PlotAxes("Offset", "m", ("offset",), least=0.5),
}
CURVES = {"plot_restoring": CurveAxes("Restoring force", "kN", "Offset along the waves [m]", ("static", "now"))}
CHANGING = (
    "state", "system", "places", "tensions", "path", "path_count", "most_offset", "rest_place", "anchors",
    "fairleads", "rest_scale", "rest_stretch", "failure", "body", "sea", "nodes", "links", "step_modes",
)  # fmt: skip


class MooringScene:
    """The mooring on the simulation thread; see `app.scenes.contract.Scene`."""

    frame_interval = FRAME_INTERVAL
    note = ""

    def __init__(self, params: Params) -> None:
        self.params = params
        self.plot_rows = PlotRows(len(SERIES))
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
        """At rest in level water, with anchors and fairleads in their first places."""
        p = self.params
        self.places = first_places(p)
        anchors, fairleads = self.places
        self.anchors = tuple(CriticallyDampedTracker(place, ANCHOR_SPEED * p.reach) for place in anchors)
        self.fairleads = tuple(CriticallyDampedTracker(place, FAIRLEAD_SPEED * p.size) for place in fairleads)
        self.sea = sea_of(p)
        self.body = body_of(p, self.sea)
        self.system = build(p, self.places, self.body, self.sea)
        rest, self.failure = rest_or_start(self.system)
        self.state = LineState(self.system, rest)
        self.nodes, self.links = nodes_and_links(self.system, p)
        self.rest_place = self.body_place()
        self.rest_scale = max(float(max(tension.max() for tension in rest.tension.values())), 1.0)
        self.rest_stretch = np.linalg.norm(np.diff(self.points_of_lines(), axis=1), axis=2).sum(axis=1) / p.length - 1.0
        self.hold: tuple[int, Vector] | None = None
        self.path, self.path_count = np.empty((0, 2), np.float32), 0
        self.most_offset = 0.0
        self.assess_stability()
        self.tensions = Tensions(p.lines)
        self.measure()
        self.plot_rows.restart()
        self.last_moments.clear()

    def change_forces(self, params: Params) -> None:
        """Take parameters; the motion goes on."""
        old, self.params = self.params, params
        self.sea = sea_of(params)
        self.body = body_of(params, self.sea)
        self.take_system()
        materials = (line_types(params), params.friction, params.wave_period)
        if materials != (line_types(old), old.friction, old.wave_period):
            self.assess_stability()
        else:
            self.take_step()

    def take_system(self) -> None:
        """Go on with the mooring as it is arranged now."""
        self.system = build(self.params, self.places, self.body, self.sea)
        self.state.system = self.system

    def assess_stability(self) -> None:
        """Find the modes about the state, and with them the longest stable step."""
        rest = Rest({}, {}, {}, self.state.x)
        self.step_modes: list[Mode] = modes(self.system, rest)
        self.take_step()

    def take_step(self) -> None:
        """Compare the time step with the modes that were found last."""
        self.stability: Gauge = gauge_of(self.step_modes, INTEGRATORS[self.params.integrator], self.step)

    def handle(self, command: SceneCommand) -> None:
        """Move an anchor or a fairlead, pull the body, or let go of it."""
        match command:
            case Place(thing, (x, y, z)):
                kind, _, number = thing.partition(" ")
                if not number.isdecimal() or not 1 <= int(number) <= self.params.lines:
                    return
                if kind == "anchor":
                    self.move_anchor(int(number) - 1, (x, y))
                elif kind == "fairlead":
                    self.move_fairlead(int(number) - 1, (x, y, z))
            case Grab(0, target, client) if self.hold is None or self.hold[0] == client:
                self.hold = client, target
            case Release(client) if self.hold is not None and self.hold[0] == client:
                self.hold = None
            case _:
                pass

    def move_anchor(self, line: int, place: tuple[float, float]) -> None:
        """Move an anchor along the bed, no farther than its line reaches from the body's place of rest."""
        longest = math.hypot(self.params.length, self.params.depth)
        away = np.array(place) - self.rest_place[:2]
        away *= min(1.0, longest / max(float(np.linalg.norm(away)), 1e-9))
        x, y = (self.rest_place[:2] + away).tolist()
        self.anchors[line].target = (x, y, -self.params.depth)

    def move_fairlead(self, line: int, place: Vector) -> None:
        """Move a fairlead on the body, within the box about its hull."""
        arm = np.clip(np.subtract(place, self.body_place()), *hull_of(self.params).extents.T)
        self.fairleads[line].target = vector_of(arm)

    def body_place(self) -> NDArray[np.float64]:
        """(3,) [m] of the body's centre."""
        return np.add(self.body.place, self.state.x[:, self.system.node_count])

    def paths(self, duration: float) -> NDArray[np.float64]:
        """(lines, 5, 3) of the anchors for `duration` [s], as `LineArrays` has them; fairleads are moved at once."""
        t = self.state.t
        moving = not all(one.at_rest for one in (*self.anchors, *self.fairleads))
        for fairlead in self.fairleads:
            fairlead.advance(t, duration)
        paths = np.zeros((len(self.anchors), 5, 3))
        for q, anchor in enumerate(self.anchors):
            path = anchor.advance(t, duration)
            paths[q, 0], paths[q, 4] = anchor.position, t
            if path is not None:
                paths[q, :4] = path[1]
        if moving:
            self.places = Places(
                tuple(one.position for one in self.anchors), tuple(one.position for one in self.fairleads)
            )
            self.take_system()
        return paths

    def driven(self) -> dict[str, NDArray[np.float64]]:
        """Fields of the kernels' view that change with time: waves and current that begin, the mouse's pull."""
        p, found = self.system.kernel_view(self.step), {}
        if self.time < FADE:
            waves = p.waves.copy()
            waves[[6, 8]] *= self.fade
            found |= {"waves": waves, "current": self.fade * p.current}
        if self.hold is not None:
            found["steady"] = p.steady + self.mouse_pull()
        return found

    @property
    def fade(self) -> float:
        """Factor on waves and current, which begin smoothly."""
        share = min(self.state.t / FADE, 1.0)
        return share * share * (3.0 - 2.0 * share)

    def mouse_pull(self) -> NDArray[np.float64]:
        """(1, 6) [N, N m] critically damped, on the body."""
        assert self.hold is not None
        mass = float(self.body.mass[0, 0])
        v = self.state.v[:, self.system.node_count]
        force = mass * (DRAG_RATE**2 * (np.array(self.hold[1]) - self.body_place()) - 2.0 * DRAG_RATE * v)
        limit = self.params.pull * self.params.density * hull_of(self.params).volume * self.system.gravity
        force *= min(1.0, limit / max(float(np.linalg.norm(force)), 1e-9))
        return np.concatenate((force, np.zeros(3)))[None]

    def advance(self, steps: int) -> None:
        """Take steps. Raises DivergenceError where the state leaves its bounds, and keeps the last good one."""
        if self.failure:
            raise DivergenceError(self.failure)
        self.add_due_row()  # of the start
        method, h = INTEGRATORS[self.params.integrator], self.step
        piece = max(1, round(SAMPLE / h))
        for first in range(0, steps, piece):
            count = min(piece, steps - first)
            good = copied({"state": self.state}, self.system)["state"]
            self.state.advance(method, h, count, self.paths(h * count), driven=self.driven())
            if not self.is_bounded():
                self.state = good
                raise DivergenceError(self.diagnosis(), tuple(self.last_moments))
            self.measure()
        self.add_due_row()

    def add_due_row(self) -> None:
        """Add the plot row of now, if one is due."""
        if self.plot_rows.is_due(self.time):
            self.add_plot_row()

    def is_bounded(self) -> bool:
        """False once anything is not finite or is farther away than lines reach."""
        p = self.params
        far = FARTHEST * (p.length + p.reach + p.depth)
        return bool(np.abs(self.state.x).max() < far)  # false of a NaN as well

    def diagnosis(self) -> str:
        """Cause of the divergence, and settings that would hold."""
        p = self.params
        if self.rest_stretch.max() > MAX_STRETCH:
            return too_short_text(int(self.rest_stretch.argmax()), float(self.rest_stretch.max()), p)
        method = INTEGRATORS[p.integrator]
        return divergence_text(
            self.time, method, self.step, self.stability, leapfrog_alternative(method, self.stability)
        )

    def measure(self) -> None:
        """Take tensions, offset and path of the state."""
        p, state = self.system.kernel_view(self.step), self.state
        tension = np.empty(len(p.ends))
        v = state.velocities(p, 0.0)
        set_tensions(state.x.reshape(-1), v, p, tension)
        self.tension, self.points = tension[self.links], self.points_of_lines()
        self.tensions.measure(state.t, self.tension, self.points)
        place = self.body_place()
        self.offset = float(np.linalg.norm((place - self.rest_place)[:2]))
        self.most_offset = max(self.most_offset, self.offset)
        if state.t >= PATH_INTERVAL * self.path_count:
            self.path = np.concatenate((self.path[1 - MAX_PATH :], place[None, :2].astype(np.float32)))
            self.path_count += 1

    def points_of_lines(self) -> NDArray[np.float64]:
        """(lines, segments + 1, 3) [m] of the nodes of each line, from its anchor."""
        return np.moveaxis(self.state.x[:, self.nodes], 0, -1)

    def add_plot_row(self) -> None:
        """Add tensions and offset at the scene's time."""
        missing = (math.nan,) * (MAX_LINES - self.params.lines)
        now = self.tensions
        self.plot_rows.add(
            self.time, *(1e-3 * now.fairlead).tolist(), *missing, 1e-3 * float(now.most_fairlead.max()),
            *(1e-3 * now.anchor).tolist(), *missing, self.offset,
        )  # fmt: skip

    def lying(self) -> NDArray[np.float64]:
        """(lines,) [m] of unstretched length on the bed."""
        spacing = np.array([length / count for _, length, count in sections(self.params) for _ in range(count)])
        down = self.points[:, :, 2] <= -self.params.depth
        return np.where(down[:, :-1] & down[:, 1:], spacing, 0.0).sum(axis=1)

    def readings(self) -> MooringReadings:
        """Numbers for the panel."""
        now = self.tensions
        stretch = float(self.rest_stretch.max())
        lines = now.readings(self.lying())
        return MooringReadings(lines, self.offset, self.most_offset, now.most_at, self.stability, stretch)

    def frame(self) -> MooringFrame:
        """Frame to draw; kept for a while, to be shown again if the run diverges."""
        p = self.params
        x, y, z = (float(value) for value in self.state.x[:, self.system.node_count + 1])
        half = 0.5 * math.hypot(x, y, z)
        share = math.sin(half) / (2.0 * half) if half > 0.0 else 0.5
        frame = MooringFrame(
            params=p,
            time=self.time,
            body=self.body_place().astype(np.float32),
            rotation=np.array([math.cos(half), share * x, share * y, share * z], np.float32),
            points=self.points.astype(np.float32),
            tension=self.tension.astype(np.float32),
            full_scale=MAX_TENSION_SCALE * self.rest_scale,
            surface=surface_heights(p, self.sea, self.time, self.fade),
            side=surface_side(p),
            path=self.path,
            rest=vector_of(self.rest_place),
            offset=self.most_offset,
            uplift=self.tensions.uplift > 0.0,
            pull=None if self.hold is None else self.hold[1],
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
        return {"plot_restoring": self.restoring.chart(self)}

    def arrays(self) -> dict[str, tuple[NDArray[Any], str]]:
        """The state for a file: name -> (array, unit)."""
        place = self.state.x[:, self.system.node_count :]
        return {
            "x": (self.points.copy(), "m"),
            "tension": (self.tension.copy(), "N"),
            "body": (self.body_place(), "m"),
            "rotation": (place[:, 1].copy(), "rad"),
        }

    def keep(self) -> dict[str, object]:
        """Checkpoint: everything that changes."""
        return copied({name: getattr(self, name) for name in CHANGING}, self.system, self.body, self.sea)

    def resume(self, kept: object) -> None:
        """Go on from a checkpoint of `keep`."""
        restore(self, kept)
        self.hold = None
        self.state.system = self.system
        self.take_step()
        self.measure()
        self.plot_rows.resume()
        self.last_moments.clear()


def too_short_text(line: int, stretch: float, p: Params) -> str:
    """Cause of a divergence that no shorter step mends. line: from 0; stretch: at rest, over its length."""
    return (
        f"Line {line + 1} is stretched by {percent(stretch)} at rest: {metres(p.length)} are too short for an anchor "
        f"{metres(p.reach)} away in {metres(p.depth)} of water. Give it more length, or bring its anchor nearer."
    )


def rest_or_start(system: System) -> tuple[Rest, str]:
    """The state of rest in still water: a current would carry away what lies, which only friction holds.

    If none is found, the shape that the search begins with, and the reason: the panel stays, and nothing moves.
    """
    still = dataclasses.replace(system, current=(0.0, 0.0, 0.0))
    try:
        return at_rest(still), ""
    except ConvergenceError as error:
        reason = f"The lines find no state of rest ({error}). Change their length, their anchors or EA."
        return rest_of(still, straight(still), still.kernel_view(1.0)), reason


def compile_with(method: str) -> None:
    """Run the kernels of a method, and all that a scene calls."""
    scene = MooringScene(Params(integrator=method, lines=1, segments=4, time_step=1e-4))
    scene.advance(2)
    scene.frame()
    scene.readings()


def warm_up() -> Pieces:
    """Pieces to compile ahead: the first method."""
    return {"leapfrog": lambda: compile_with("leapfrog")}


def on_use() -> Pieces:
    """The other methods."""
    return {name: (lambda name=name: compile_with(name)) for name in EXPLICIT if name != "leapfrog"}


def needs(params: Params) -> tuple[str, ...]:
    """Compiled pieces that a scene with these parameters runs."""
    return ("leapfrog",) if params.integrator == "leapfrog" else ("leapfrog", params.integrator)


def remedy(snapshot: Any) -> float:
    """A time step [s] at which a run that diverged would have held; 0 if the step is not at fault."""
    now: MooringReadings = snapshot.readings
    return 0.0 if now.rest_stretch > MAX_STRETCH else holding_step(snapshot.params.time_step, now.stability)


SCENE = SceneKind(
    name="mooring",
    title="Mooring",
    help="<b>Drag the body</b>, or the arrows of anchors and fairleads.",
    params=Params,
    presets=PRESETS,
    about=ABOUT,
    make=MooringScene,
    hidden=hidden,
    warm_up=warm_up,
    needs=needs,
    warm_up_on_use=on_use,
    series=SERIES,
    plots=PLOTS,
    curves=CURVES,
    frame_units={
        "points": "m", "body": "m", "rotation": "1", "tension": "N", "surface": "m", "path": "m", "uplift": "1",
    },
    measures=measures,
    remedy=remedy,
    live_values=live_values,
)  # fmt: skip
