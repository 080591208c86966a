"""The mooring of a MoorDyn file: all coupled points are one vessel, which the user drags and the waves move."""

import dataclasses
import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.messages import GrabTo, Release, SceneCommand, Vector, vector_of
from app.scenes.mooring.arrangement import extent, sea_of
from app.scenes.mooring.frame import MooringFrame
from app.scenes.mooring.from_file import FileMooring, mooring_of, slack_of
from app.scenes.mooring.line_scene import LineScene, fade_at
from app.scenes.mooring.parameters import MooringParams
from app.scenes.mooring.restoring import LEAST_SHARE, SHARE
from app.scenes.mooring.start_check import Fault, fault_of_file
from app.scenes.springs.tracking import CriticallyDampedTracker
from sim.interruption import raise_if_stopped
from sim.mooring import System, at_rest
from sim.mooring.motion import cubic
from sim.validation import ConvergenceError
from sim.waves import Waves

VESSEL_SPEED = 0.005  # largest speed of a dragged vessel, in `extent`s [1/s]
FARTHEST = 10.0  # in `extent`s, beyond which a run has diverged
CURVE_POINTS = 17  # offsets at which the statics of all lines are solved
CHANGING = (
    "state", "system", "tensions", "path", "path_count", "most_offset", "farthest", "vessel", "rest_scale",
    "rest_stretch", "fault", "failure", "sea", "step_modes", "moved_by",
)  # fmt: skip


class FileInputs(NamedTuple):
    """Everything that the restoring curve depends on."""

    path: str
    wave: tuple[float, float]  # unit vector along the waves
    far: float  # [m] offset to which the curve goes at least

    def curve(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Offsets [m] of the vessel along the waves, and the force [N] of all lines against each; NaN without rest."""
        file = mooring_of(self.path)
        slack = slack_of(file.system)
        end = max(SHARE * slack[0] if slack else 0.0, LEAST_SHARE * file.extent, self.far)
        offset = np.linspace(-end, end, CURVE_POINTS)
        force = np.full(len(offset), math.nan)
        for i, one in enumerate(offset):
            raise_if_stopped()
            away = np.array([one * self.wave[0], one * self.wave[1], 0.0])
            placed = {p.id: np.add(p.position, away) for p in file.system.points if p.kind == "coupled"}
            try:
                rest = at_rest(file.system, placed)
            except ConvergenceError:
                continue
            tension = np.concatenate([rest.tension[line.id] for line in file.system.lines])
            force[i] = -float(level_force(file, rest.nodes, tension) @ self.wave)
        return offset, force


def level_force(file: FileMooring, x: NDArray[np.float64], tension: NDArray[np.float64]) -> NDArray[np.float64]:
    """Level force (2,) [N] of all lines on the vessel, with nodes at x (3, n) and these tensions (links,)."""
    points, tension = file.shown.points(x), tension[file.shown.links]
    found = np.zeros(2)
    for line, end in file.ends:
        way = points[line, 1 if end == 0 else -2] - points[line, end]
        found += tension[line, end] * way[:2] / max(float(np.linalg.norm(way)), 1e-12)
    return found


class FileScene(LineScene):
    """A mooring that a file describes, on the simulation thread."""

    changing = CHANGING

    def arrange(self) -> None:
        """Make the file's system, with the vessel where the file has it."""
        p = self.params
        self.file = mooring_of(p.moordyn_file)
        self.vessel = CriticallyDampedTracker((0.0, 0.0, 0.0), VESSEL_SPEED * extent(p))
        self.moved_by = np.zeros(3)
        self.sea = sea_of(p)
        self.system = self.arranged()
        self.links = self.file.shown.links

    @property
    def middle(self) -> Vector:
        """[m] of the vessel at the surface, where it begins."""
        return self.file.middle

    def find_fault(self) -> Fault | None:
        """The fault of the state that the mooring starts with, by `rest_stretch`; None if there is none."""
        return fault_of_file(self.file, self.rest_stretch)

    def lengths(self) -> NDArray[np.float64]:
        """(lines,) [m], unstretched."""
        return self.file.shown.lengths

    def arranged(self) -> System:
        """The file's system in the waves and the current of the parameters."""
        p = self.params
        bearing = math.radians(p.direction)
        current = (p.current * math.cos(bearing), p.current * math.sin(bearing), 0.0)
        return dataclasses.replace(self.file.system, waves=self.sea, current=current)

    def change_forces(self, params: MooringParams) -> None:
        """Take parameters; the motion goes on."""
        self.params = params
        self.sea = sea_of(params)
        self.take_system()
        self.take_step()

    def take_system(self) -> None:
        """Go on with the water as it is now."""
        self.system = self.arranged()

    @property
    def is_dragged(self) -> bool:
        """True while a user moves the vessel."""
        return self.grabbed is not None or not self.vessel.at_rest

    def drag(self, command: SceneCommand) -> None:
        """Drag the vessel, or leave it where it is."""
        match command:
            case GrabTo(0, target, client) if self.grabbed is None or self.grabbed[0] == client:
                self.grabbed = client, target
                away = np.subtract(target, self.middle)[:2]
                away *= min(1.0, self.file.farthest / max(float(np.linalg.norm(away)), 1e-9))
                self.vessel.target = vector_of(np.append(away, 0.0))
            case Release(client) if self.grabbed is not None and self.grabbed[0] == client:
                self.grabbed = None
            case _:
                pass

    def body_place(self) -> NDArray[np.float64]:
        """(3,) [m] of the vessel's middle at the surface."""
        return np.add(self.middle, self.moved_by)

    def rotation(self) -> NDArray[np.float64]:
        """No rotation (3,) [rad]."""
        return np.zeros(3)

    def paths(self, duration: float) -> NDArray[np.float64]:
        """(coupled points, 5, 3) for `duration` [s], as `LineArrays` has them: all points move as one."""
        t = self.state.t
        share = self.params.follow
        x0, v0 = np.array(self.vessel.position), np.array(self.vessel.velocity)
        self.vessel.advance(t, duration)
        x1, v1 = np.array(self.vessel.position), np.array(self.vessel.velocity)
        for x, v, at in ((x0, v0, t), (x1, v1, t + duration)):
            wave, speed = water_motion(self.sea, self.middle, at)
            fade = fade_at(at)
            x += share * fade * wave
            v += share * fade * speed
        paths = np.repeat(cubic(x0, v0, x1, v1, t, duration)[None], len(self.file.vessel), axis=0)
        paths[:, 0] += self.places
        self.moved_by = x1 if self.file.vessel else np.zeros(3)
        return paths

    @property
    def places(self) -> NDArray[np.float64]:
        """(coupled points, 3) [m] at the start."""
        points = self.file.system.points
        return np.array([points[node].position for node in self.file.vessel]).reshape(-1, 3)

    def is_bounded(self) -> bool:
        """False once anything is not finite or is farther away than lines reach."""
        return bool(np.abs(self.state.x).max() < FARTHEST * extent(self.params) + self.longest)

    @property
    def longest(self) -> float:
        """Length [m] of all lines."""
        return float(self.file.shown.lengths.sum())

    def points_at(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """(lines, n, 3) [m] of points of each line, from its anchor."""
        return self.file.shown.points(x)

    def lying(self) -> NDArray[np.float64]:
        """(lines,) [m] of unstretched length on the bed."""
        down = self.points[:, :, 2] <= -self.system.depth
        pieces = self.points.shape[1] - 1
        return (down[:, :-1] & down[:, 1:]).sum(axis=1) * self.file.shown.lengths / pieces

    def frame(self) -> MooringFrame:
        """Frame to draw."""
        found, x = super().frame(), self.state.x.T.astype(np.float32)
        anchors = list(self.file.anchors)
        # Of the lines that end at an anchor, any may pull it upwards.
        lifted = np.zeros(len(x), bool)
        np.logical_or.at(lifted, self.file.shown.before[:, 0], self.tensions.uplift > 0.0)
        movable = [*self.file.vessel, *self.file.others]
        return found._replace(anchors=x[anchors], uplift=lifted[anchors], fairleads=x[movable])

    def static_inputs(self, far: float = 0.0) -> FileInputs:
        """Everything that the restoring curve depends on."""
        bearing = math.radians(self.params.direction)
        return FileInputs(self.params.moordyn_file, (math.cos(bearing), math.sin(bearing)), far)

    def force_of_lines(self) -> NDArray[np.float64]:
        """Level force (2,) [N] of the lines on the vessel now."""
        tension = np.zeros(sum(line.segments for line in self.system.lines))
        tension[self.links.reshape(-1)] = self.tension.reshape(-1)
        return level_force(self.file, self.state.x, tension)

    def arrays(self) -> dict[str, tuple[NDArray[Any], str]]:
        """The state for a file: name -> (array, unit)."""
        tension = np.zeros(sum(line.segments for line in self.system.lines))
        tension[self.links.reshape(-1)] = self.tension.reshape(-1)
        found: dict[str, tuple[NDArray[Any], str]] = {"vessel": (self.body_place(), "m")}
        for line in self.system.lines:
            found[f"x_{line.id}"] = (self.state.x[:, self.system.nodes_of[line.id]].T.copy(), "m")
            found[f"tension_{line.id}"] = (tension[self.system.links_of[line.id]], "N")
        return found


def water_motion(sea: Waves | None, place: Any, t: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Displacement [m] and velocity [m/s] (3,) of the water at the surface above a place, by linear theory."""
    if sea is None:
        return np.zeros(3), np.zeros(3)
    level = 1j / (sea.k * np.tanh(np.minimum(sea.k * sea.water.depth, 300.0)))
    moved = np.column_stack((level * sea.kx, level * sea.ky, np.ones_like(level)))
    X = np.column_stack((moved, -1j * sea.omega[:, None] * moved))
    ((dx, dy, dz, u, v, w),) = sea.response([place[:2]], t, X)
    return np.array((dx, dy, dz)), np.array((u, v, w))
