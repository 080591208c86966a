"""The student's rope beside the program's."""

import numpy as np
from numpy.typing import NDArray

from app.lab.rope_march import Segment
from app.scenes.springs.student_net import StudentNet, forces_of
from sim.springs import Net


class StudentRope(StudentNet):
    """Used by the rope scene on the simulation thread."""

    def follow_rope(
        self, net: Net, start: float, steps: int, h: float, method: str, x: NDArray[np.float64], v: NDArray[np.float64]
    ) -> None:
        """The program's rope has taken steps from time `start` [s], and is at x with velocities v, shape (n, 3)."""
        segment = Segment(steps, h, forces_of(net, start), root_path(net, start, steps, h))
        self.follow(segment, start + steps * h, method, x, v)


def root_path(net: Net, start: float, steps: int, h: float) -> NDArray[np.float64]:
    """(steps, 6) position [m] and velocity [m/s] of a moving root after each step; (0, 6) of one that rests."""
    if not net.pin_paths:
        return np.zeros((0, 6))
    path = net.pin_paths[0][1]
    s = (start - path.start + h * np.arange(1, steps + 1))[:, None]
    c0, c1, c2, c3 = (np.array(c) for c in path.coefficients)
    return np.hstack([c0 + s * (c1 + s * (c2 + s * c3)), c1 + s * (2.0 * c2 + s * 3.0 * c3)])
