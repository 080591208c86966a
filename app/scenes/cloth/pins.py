"""Pins of a cloth, which a user moves by two handles."""

import numpy as np

from app.messages import Vector
from app.scenes.springs.tracking import CriticallyDampedTracker
from sim.springs import Net
from sim.springs.net import PinPath
from sim.springs.state import State


class Pins:
    """Pinned particles where a state has them, and a handle at each end of the first row."""

    def __init__(self, net: Net, state: State) -> None:
        x = state.x
        self.shape = net.shape
        self.ends = [x[:, 0, 0].copy(), x[:, 0, -1].copy()]
        self.handles = [CriticallyDampedTracker(tuple(float(c) for c in end)) for end in self.ends]  # type: ignore[arg-type]
        self.anchors = {pin: x[:, pin[0], pin[1]].copy() for pin in net.pinned}

    @property
    def targets(self) -> tuple[Vector, Vector]:
        """Targets of the two handles [m]."""
        first, last = self.handles
        return first.target, last.target

    def paths(self, t: float, duration: float) -> tuple[tuple[tuple[int, int], PinPath], ...]:
        """The motion of each pinned particle over the next `duration` [s] from time t [s]: that of the two handles, by
        its place along the first row, and less the farther down it is. Moves the handles on."""
        starts = [handle.position for handle in self.handles]
        moves = [handle.advance(t, duration) for handle in self.handles]
        if moves == [None, None]:
            return ()
        still = ((0.0, 0.0, 0.0),) * 3
        cubics = [
            np.array(move.coefficients if move else (start, *still)) for move, start in zip(moves, starts, strict=True)
        ]
        for cubic, end in zip(cubics, self.ends, strict=True):
            cubic[0] -= end
        rows, cols = self.shape
        pin_paths = []
        for (i, j), anchor in self.anchors.items():
            along, down = j / (cols - 1), 1.0 - i / (rows - 1)
            c = down * ((1.0 - along) * cubics[0] + along * cubics[1])
            c[0] += anchor
            pin_paths.append(((i, j), PinPath(t, tuple(tuple(row) for row in c.tolist()))))  # type: ignore[arg-type]
        return tuple(pin_paths)
