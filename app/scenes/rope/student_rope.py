"""The student's rope beside the program's."""

import numpy as np
from numpy.typing import NDArray

from app.lab.process.rope_march import Segment
from app.lab.student.live_net import ROPE
from app.scenes.rope.parameters import RopeParams
from app.scenes.springs.laws import SPRING
from app.scenes.springs.student_net import Differences, StudentNet, forces_of
from sim.springs import Net


class StudentRope(StudentNet):
    """Used by the rope scene on the simulation thread."""

    def follow_rope(
        self, net: Net, start: float, steps: int, params: RopeParams, x: NDArray[np.float64], v: NDArray[np.float64]
    ) -> None:
        """The program's rope has taken steps from time `start` [s], and is at x with velocities v, shape (n, 3)."""
        self.differences = Differences(unlike(params), left_out(params))
        path = np.array([path.coefficients for _, path in net.pin_paths]).reshape(-1, 4, 3)
        segment = Segment(steps, params.time_step, forces_of(net, start), path)
        self.follow(segment, start + steps * params.time_step, params.integrator, x, v)


def unlike(params: RopeParams) -> tuple[str, ...]:
    """The parameters that the functions of the tasks do not feel as the program's rope does, a line each."""
    lines: list[str] = []
    method = params.integrator
    if method == "leapfrog":
        lines.append(
            "Method: the program's takes damping exactly; a right step_leapfrog differs by a centimetre or so."
        )
    elif method not in ROPE.exact:
        lines.append(f"Method: your rope uses {ROPE.step_of(method)}, the program's the method that you chose.")
    if params.law != SPRING:
        lines.append("Link: the program's rope has the law that you chose, spring_force is a spring.")
    if params.damping_model == "axial":
        lines.append("Damping model: the program's acts along the link, spring_force in all directions.")
    if params.sphere and params.contact_law == "lab":
        lines.append("Contact law: the program's sphere may pull, as in the lab's code; sphere_force only pushes.")
    return tuple(lines)


def left_out(params: RopeParams) -> tuple[str, ...]:
    """The effects that the program's rope leaves out beside a student's, as the tasks do, a line each."""
    lines: list[str] = []
    if params.sphere and params.contact_law != "lab":
        lines.append(
            "Sphere: only the points of both ropes touch it, as in sphere_force. A link passes a small sphere."
        )
    if params.self_contact:
        lines.append("Touches itself: both ropes pass through themselves, as the tasks have no such force.")
    if params.end_held:
        lines.append("End held: the last point of both ropes is free, as in the tasks.")
    if params.tip_mass > 0.0:
        lines.append("Weight at the tip: all points of both ropes have one mass, as in the tasks.")
    if params.units == "material":
        lines.append("Mass per metre: the last point of both ropes has a whole link's mass, as in the tasks.")
    return tuple(lines)
