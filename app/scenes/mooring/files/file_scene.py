"""The mooring of a MoorDyn file: all coupled points are one vessel, which the user drags and the waves move."""

import dataclasses
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.messages import Pull, SceneCommand, Vector, vector_of
from app.scenes.mooring.arrangement import at_most, extent, sea_of
from app.scenes.mooring.files.from_file import opened, slack_of
from app.scenes.mooring.frame import MooringFrame
from app.scenes.mooring.line_scene import LineScene, fade_at
from app.scenes.mooring.parameters import MooringParams
from app.scenes.mooring.readings.restoring import CurveInputs
from app.scenes.mooring.start_check import Fault, fault_of_file
from app.scenes.springs.tracking import CriticallyDampedTracker
from sim.mooring import System
from sim.mooring.motion import cubic
from sim.waves import Waves

VESSEL_SPEED = 0.005  # largest speed of a dragged vessel, in `extent`s [1/s]
REACH = "The lines hold: no farther"
CHANGING = (
    "state", "system", "tensions", "excursion", "start", "vessel", "sea", "step_modes", "moved_by",
)  # fmt: skip


class FileScene(LineScene):
    """A mooring that a file describes, on the simulation thread."""

    changing = CHANGING

    def arrange(self) -> None:
        """Make the file's system, with the vessel where the file has it."""
        p = self.params
        self.file = opened(p)
        self.vessel = CriticallyDampedTracker((0.0, 0.0, 0.0), VESSEL_SPEED * extent(p))
        self.moved_by = np.zeros(3)
        self.sea = sea_of(p)
        self.system = self.arranged()
        self.rows = self.file.rows

    @property
    def middle(self) -> Vector:
        """[m] of the vessel at the surface, where it begins."""
        return self.file.middle

    def fault_of(self, stretch: NDArray[np.float64], failure: str) -> Fault | None:
        """The fault of a state to start with, or None; see `LineScene`."""
        return fault_of_file(self.file, stretch)

    def arranged(self) -> System:
        """The file's system in the waves and the current of the parameters."""
        p = self.params
        x, y = (p.current * self.wave_direction).tolist()
        return dataclasses.replace(self.file.system, waves=self.sea, current=(x, y, 0.0))

    def change_forces(self, params: MooringParams) -> None:
        """Take parameters; the motion continues."""
        self.params = params
        self.sea = sea_of(params)
        self.take_system()
        self.take_step()
        self.tensions.take_now(*self.find_tensions())

    def take_system(self) -> None:
        """Continue with the water as it is now."""
        self.system = self.arranged()

    @property
    def is_dragged(self) -> bool:
        """True while a user moves the vessel."""
        return self.grabbed is not None or not self.vessel.at_rest

    def handle(self, command: SceneCommand) -> None:
        """Carry out a command of the mouse, or begin the statistics again: a vessel follows as far as lines reach."""
        super().handle(command)
        if self.grabbed is not None:
            away = at_most(self.file.farthest, np.subtract(self.grabbed[1], self.middle)[:2])
            self.vessel.target = vector_of(np.append(away, 0.0))

    def body_place(self) -> NDArray[np.float64]:
        """(3,) [m] of the vessel's middle at the surface."""
        return np.add(self.middle, self.moved_by)

    def pull_of_body(self, target: Vector) -> Pull:
        """The pull of the vessel towards a target [m]."""
        way = float(np.hypot(*np.subtract(target, self.middle)[:2]))
        return Pull(vector_of(self.body_place()), target, min(1.0, way / self.file.farthest), REACH)

    def rotation(self) -> NDArray[np.float64]:
        """No rotation (3,) [rad]."""
        return np.zeros(3)

    def paths(self, duration: float) -> NDArray[np.float64]:
        """(coupled points, 5, 3) for `duration` [s], as `LineArrays` has them: all points move as one."""
        t = self.state.t
        follow = self.params.follow
        x0, v0 = np.array(self.vessel.position), np.array(self.vessel.velocity)
        self.vessel.advance(t, duration)
        x1, v1 = np.array(self.vessel.position), np.array(self.vessel.velocity)
        for x, v, at in ((x0, v0, t), (x1, v1, t + duration)):
            wave, speed = water_motion(self.sea, self.middle, at)
            fade = fade_at(at)
            x += follow * fade * wave
            v += follow * fade * speed
        paths = np.repeat(cubic(x0, v0, x1, v1, t, duration)[None], len(self.file.vessel), axis=0)
        paths[:, 0] += self.places
        self.moved_by = x1 if self.file.vessel else np.zeros(3)
        return paths

    @property
    def places(self) -> NDArray[np.float64]:
        """(coupled points, 3) [m] at the start."""
        points = self.file.system.points
        return np.array([points[node].position for node in self.file.vessel]).reshape(-1, 3)

    def frame(self) -> MooringFrame:
        """Frame to draw."""
        frame, x = super().frame(), self.state.x.T.astype(np.float32)
        anchors = list(self.file.anchors)
        # Of the lines that end at an anchor, any may pull it upwards.
        lifted = np.zeros(len(x), bool)
        np.logical_or.at(lifted, self.rows.before[:, 0], self.tensions.uplift > 0.0)
        movable = [*self.file.vessel, *self.file.others]
        return frame._replace(anchors=x[anchors], uplift=lifted[anchors], fairleads=x[movable])

    def curve_inputs(self, far: float = 0.0) -> CurveInputs:
        """Everything that the restoring curve depends on."""
        slack, _ = slack_of(self.file.system) or (0.0, 0.0)
        x, y = self.wave_direction.tolist()
        return CurveInputs(self.file.system, (x, y), slack, self.file.extent, far)

    def arrays(self) -> dict[str, tuple[NDArray[Any], str]]:
        """The state for a file: name -> (array, unit)."""
        tension = np.zeros(sum(line.segments for line in self.system.lines))
        tension[self.rows.links.reshape(-1)] = self.tension.reshape(-1)
        arrays: dict[str, tuple[NDArray[Any], str]] = {"vessel": (self.body_place(), "m")}
        for line in self.system.lines:
            arrays[f"x_{line.id}"] = (self.state.x[:, self.system.nodes_of[line.id]].T.copy(), "m")
            arrays[f"tension_{line.id}"] = (tension[self.system.links_of[line.id]], "N")
        arrays["end_tension"] = (self.end_tension(), "N")
        return arrays


def water_motion(sea: Waves | None, place: Any, t: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Displacement [m] and velocity [m/s] (3,) of the water at the surface above a place, by linear theory."""
    if sea is None:
        return np.zeros(3), np.zeros(3)
    level = 1j / (sea.k * np.tanh(np.minimum(sea.k * sea.water.depth, 300.0)))
    moved = np.column_stack((level * sea.kx, level * sea.ky, np.ones_like(level)))
    X = np.column_stack((moved, -1j * sea.omega[:, None] * moved))
    ((dx, dy, dz, u, v, w),) = sea.response([place[:2]], t, X)
    return np.array((dx, dy, dz)), np.array((u, v, w))
