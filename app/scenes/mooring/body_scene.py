"""The mooring of the parameters: a floating body on one to four lines in waves."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.messages import GrabTo, Place, Release, SceneCommand, Vector, vector_of
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
)
from app.scenes.mooring.line_scene import LineScene, rest_or_start
from app.scenes.mooring.parameters import MooringParams
from app.scenes.mooring.restoring import StaticInputs, force_of_lines
from app.scenes.mooring.start_check import Fault, fault_of
from app.scenes.springs.tracking import CriticallyDampedTracker

# Largest speeds of what is dragged, so that no line snaps by it: in distances of anchors and sizes of the body [1/s].
ANCHOR_SPEED, FAIRLEAD_SPEED = 0.02, 0.1
GRAB_RATE = 1.0  # [rad/s] natural frequency of the grab of the body
FARTHEST = 5.0  # in lengths of a line and distances of anchors, beyond which a run has diverged
CHANGING = (
    "state", "system", "places", "tensions", "path", "path_count", "most_offset", "farthest", "rest_place",
    "anchors", "fairleads", "rest_scale", "rest_stretch", "fault", "failure", "body", "sea", "nodes", "links",
    "step_modes",
)  # fmt: skip


class MooringScene(LineScene):
    """A body on equal lines."""

    changing = CHANGING

    def arrange(self) -> None:
        """Make the body with anchors and fairleads in their first places, and its lines."""
        p = self.params
        self.places = first_places(p)
        anchors, fairleads = self.places
        self.anchors = tuple(CriticallyDampedTracker(place, ANCHOR_SPEED * p.reach) for place in anchors)
        self.fairleads = tuple(CriticallyDampedTracker(place, FAIRLEAD_SPEED * p.size) for place in fairleads)
        self.sea = sea_of(p)
        self.body = body_of(p, self.sea)
        self.system = build(p, self.places, self.body, self.sea)
        self.nodes, self.links = nodes_and_links(self.system, p)

    @property
    def middle(self) -> Vector:
        """[m] of the body, where it rests without lines."""
        return self.body.place

    def find_fault(self) -> Fault | None:
        """The fault of the state that the mooring starts with, by `rest_stretch`; None if there is none."""
        return fault_of(self.params, self.places, self.body.place, self.rest_stretch)

    def lengths(self) -> NDArray[np.float64]:
        """(lines,) [m], unstretched."""
        return np.full(self.params.lines, self.params.length)

    def change_forces(self, params: MooringParams) -> None:
        """Take parameters; the motion goes on."""
        old, self.params = self.params, params
        self.sea = sea_of(params)
        self.body = body_of(params, self.sea)
        self.take_system()
        if (line_types(params), params.steady_force) != (line_types(old), old.steady_force) and not self.failure:
            rest, failure = rest_or_start(self.system)
            if not failure:
                self.check_start(rest)
        materials = (line_types(params), params.friction, params.wave_period)
        if materials != (line_types(old), old.friction, old.wave_period):
            self.assess_stability()
        else:
            self.take_step()

    def take_system(self) -> None:
        """Go on with the mooring as it is arranged now."""
        self.system = build(self.params, self.places, self.body, self.sea)

    @property
    def is_dragged(self) -> bool:
        """True while a user moves an anchor, a fairlead or the body."""
        return self.grabbed is not None or not all(one.at_rest for one in (*self.anchors, *self.fairleads))

    def drag(self, command: SceneCommand) -> None:
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
            case GrabTo(0, target, client) if self.grabbed is None or self.grabbed[0] == client:
                self.grabbed = client, target
            case Release(client) if self.grabbed is not None and self.grabbed[0] == client:
                self.grabbed = None
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

    def rotation(self) -> NDArray[np.float64]:
        """(3,) [rad] of the body."""
        return self.state.x[:, self.system.node_count + 1]

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
        """Those of waves and current, and the mouse's pull."""
        found = super().driven()
        if self.grabbed is not None:
            found["steady"] = self.system.kernel_view(self.step).steady + self.grab_force()
        return found

    def grab_force(self) -> NDArray[np.float64]:
        """(1, 6) [N, N m] critically damped, on the body."""
        assert self.grabbed is not None
        mass = float(self.body.mass[0, 0])
        v = self.state.v[:, self.system.node_count]
        force = mass * (GRAB_RATE**2 * (np.array(self.grabbed[1]) - self.body_place()) - 2.0 * GRAB_RATE * v)
        limit = self.params.pull * self.params.density * hull_of(self.params).volume * self.system.gravity
        force *= min(1.0, limit / max(float(np.linalg.norm(force)), 1e-9))
        return np.concatenate((force, np.zeros(3)))[None]

    def is_bounded(self) -> bool:
        """False once anything is not finite or is farther away than lines reach."""
        p = self.params
        far = FARTHEST * (p.length + p.reach + p.depth)
        return bool(np.abs(self.state.x).max() < far)  # false of a NaN as well

    def points_at(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """(lines, segments + 1, 3) [m] of the nodes of each line, from its anchor."""
        return np.moveaxis(x[:, self.nodes], 0, -1)

    def lying(self) -> NDArray[np.float64]:
        """(lines,) [m] of unstretched length on the bed."""
        spacing = np.array([length / count for _, length, count in sections(self.params) for _ in range(count)])
        down = self.points[:, :, 2] <= -self.params.depth
        return np.where(down[:, :-1] & down[:, 1:], spacing, 0.0).sum(axis=1)

    def arrays(self) -> dict[str, tuple[NDArray[Any], str]]:
        """The state for a file: name -> (array, unit)."""
        place = self.state.x[:, self.system.node_count :]
        return {
            "x": (self.points.copy(), "m"),
            "tension": (self.tension.copy(), "N"),
            "body": (self.body_place(), "m"),
            "rotation": (place[:, 1].copy(), "rad"),
        }

    def static_inputs(self, far: float = 0.0) -> StaticInputs:
        """Everything that the restoring curve depends on. far: [m] offset to which it goes at least."""
        return StaticInputs.of(self, far)

    def force_of_lines(self) -> NDArray[np.float64]:
        """Level force (2,) [N] of the lines on the body now."""
        return force_of_lines(self)
