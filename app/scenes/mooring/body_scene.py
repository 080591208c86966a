"""The mooring of the parameters: a floating body on one to four lines in waves."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.formats.formatting import largest_force
from app.messages import Place, Pull, SceneCommand, Vector, vector_of
from app.scenes.mooring.arrangement import at_most, body_of, build, held, hull_of, line_types, rows_of, sea_of
from app.scenes.mooring.attachments import Attachments
from app.scenes.mooring.line_scene import LineScene
from app.scenes.mooring.parameters import MooringParams
from app.scenes.mooring.readings.restoring import CurveInputs
from app.scenes.mooring.start import rest_or_start
from app.scenes.mooring.start_check import Fault, fault_of, overload_of

GRAB_RATE = 1.0  # [rad/s] natural frequency of the grab of the body
CHANGING = (
    "state", "system", "attached", "tensions", "excursion", "start", "body", "sea", "rows", "step_modes",
)  # fmt: skip


class MooringScene(LineScene):
    """A body on equal lines."""

    changing = CHANGING

    def arrange(self) -> None:
        """Make the body with anchors and fairleads in their first places, and its lines."""
        self.attached = Attachments(self.params)
        self.sea = sea_of(self.params)
        self.body = body_of(self.params, self.sea)
        self.take_system()
        self.rows = rows_of(self.system, self.params)

    @property
    def middle(self) -> Vector:
        """[m] of the body, where it rests without lines."""
        return self.body.place

    def fault_of(self, stretch: NDArray[np.float64], failure: str) -> Fault | None:
        """The fault of a state to start with, or None; see `LineScene`."""
        fault = fault_of(self.params, self.attached.places, self.body.place, stretch)
        return fault or (overload_of(self.params) if failure else None)

    def change_forces(self, params: MooringParams) -> None:
        """Take parameters; the motion continues."""
        old, self.params = self.params, params
        self.sea = sea_of(params)
        self.body = body_of(params, self.sea)
        self.take_system()
        if (line_types(params), params.steady_force) != (line_types(old), old.steady_force) and not self.start.failure:
            rest, failure = rest_or_start(self.system)
            if not failure:
                stretch = self.rows.stretch(rest.nodes)
                self.start = self.start._replace(stretch=stretch, fault=self.fault_of(stretch, ""))
        materials = (line_types(params), params.friction, params.wave_period)
        if materials != (line_types(old), old.friction, old.wave_period):
            self.assess_stability()
        else:
            self.take_step()
        self.tensions.take_now(*self.find_tensions())

    def take_system(self) -> None:
        """Continue with the present arrangement of the mooring."""
        self.system = build(self.params, self.attached.places, self.body, self.sea)

    @property
    def is_dragged(self) -> bool:
        """True while a user moves an anchor, a fairlead or the body."""
        return self.grabbed is not None or not self.attached.at_rest

    def handle(self, command: SceneCommand) -> None:
        """Carry out a command of the mouse, or begin the statistics again."""
        match command:
            case Place(thing, place) if thing.startswith("anchor"):
                self.attached.drag(thing, self.on_the_bed(place))
            case Place(thing, place):
                self.attached.drag(thing, self.on_the_hull(place))
            case _:
                super().handle(command)

    def on_the_bed(self, place: Vector) -> Vector:
        """The place [m] of an anchor, no farther than its line reaches from the body's rest position."""
        longest = math.hypot(self.params.length, self.params.depth)
        x, y = (self.excursion.rest[:2] + at_most(longest, place[:2] - self.excursion.rest[:2])).tolist()
        return x, y, -self.params.depth

    def on_the_hull(self, place: Vector) -> Vector:
        """The place [m] of a fairlead from the body's centre, within the box about its hull."""
        return vector_of(np.clip(np.subtract(place, self.body_place()), *hull_of(self.params).extents.T))

    def body_place(self) -> NDArray[np.float64]:
        """(3,) [m] of the body's centre."""
        return np.add(self.body.place, self.state.x[:, self.system.node_count])

    def rotation(self) -> NDArray[np.float64]:
        """(3,) [rad] of the body."""
        return self.state.x[:, self.system.node_count + 1]

    def paths(self, duration: float) -> NDArray[np.float64]:
        """(lines, 5, 3) of the anchors for `duration` [s], as `LineArrays` has them."""
        is_moving = not self.attached.at_rest
        paths = self.attached.advance(self.state.t, duration)
        if is_moving:
            self.take_system()
        return paths

    def driven(self) -> dict[str, NDArray[np.float64]]:
        """Loads of waves and current, and the mouse's pull."""
        loads = super().driven()
        if self.grabbed is not None:
            force = np.concatenate((at_most(self.largest_pull, self.wanted_pull(self.grabbed[1])), np.zeros(3)))
            loads["steady"] = self.system.kernel_view(self.step).steady + force
        return loads

    def wanted_pull(self, target: Vector) -> NDArray[np.float64]:
        """(3,) [N] critically damped, on the body, without a limit. target: [m]."""
        mass = float(self.body.mass[0, 0])
        v = self.state.v[:, self.system.node_count]
        return mass * (GRAB_RATE**2 * (np.array(target) - self.body_place()) - 2.0 * GRAB_RATE * v)

    @property
    def largest_pull(self) -> float:
        """Largest force [N] of the mouse."""
        return self.params.pull * self.params.density * hull_of(self.params).volume * self.system.water.gravity

    def pull_of_body(self, target: Vector) -> Pull:
        """The pull of the body towards a target [m]."""
        load = float(np.linalg.norm(self.wanted_pull(target))) / self.largest_pull
        return Pull(vector_of(self.body_place()), target, min(1.0, load), largest_force(self.largest_pull))

    def arrays(self) -> dict[str, tuple[NDArray[Any], str]]:
        """The state for a file: name -> (array, unit)."""
        return {
            "x": (self.points.copy(), "m"),
            "tension": (self.tension.copy(), "N"),
            "end_tension": (self.end_tension(), "N"),
            "body": (self.body_place(), "m"),
            "rotation": (self.rotation().copy(), "rad"),
        }

    def curve_inputs(self, far: float = 0.0) -> CurveInputs:
        """Everything that the restoring curve depends on. far: [m] offset to which it goes at least."""
        rest, p, (x, y) = self.excursion.rest, self.params, self.wave_direction.tolist()
        system = held(self.system.lines, self.system.points, vector_of(np.subtract(rest, self.body.place)), p.depth)
        return CurveInputs(system, (x, y), self.attached.places.slack(rest, p.length), p.reach, far)
