"""The student's cloth beside the program's: of the same points where those are few, else a coarser one."""

import dataclasses
import math

import numpy as np
from numpy.typing import NDArray

from app.lab.process.rope_march import ClothData, Segment
from app.lab.student.live_net import CLOTH, LiveNet, Marched
from app.scenes.cloth.parameters import ClothParams
from app.scenes.cloth.start import build, sphere_home
from app.scenes.springs.laws import SPRING
from app.scenes.springs.student_net import Differences, StudentNet, forces_of
from sim.springs import INTEGRATORS, Net
from sim.springs.resampling import resample
from sim.springs.stability import gershgorin
from sim.springs.state import State

MAX_SAME_POINTS = 64  # of a cloth that plain Python moves with all its points
COARSE_SIDES = (10, 6)  # rows and columns of a coarser one at most: for functions of arrays, and for loops
SLOWEST_PACE = 1.2  # simulated over real time, below which the coarser one of these is taken
STEP_SHARE = 0.7  # of the longest stable step that a coarser cloth takes


class StudentCloth(StudentNet):
    """Used by the cloth scene on the simulation thread."""

    def __init__(self, live: LiveNet) -> None:
        super().__init__(live)
        self.side = COARSE_SIDES[0]

    @property
    def is_comparable(self) -> bool:
        """True if it has the same points as the program's."""
        return self.params.rows * self.params.cols <= MAX_SAME_POINTS

    def set_up(self, params: ClothParams) -> bool:
        """Choose the points and their links. True if they have changed."""
        self.params, self.differences = params, Differences(unlike(params), left_out(params))
        rows, cols = params.rows, params.cols
        if not self.is_comparable:
            self.rows.clear()
            rows, cols = min(rows, self.side), min(cols, self.side)
            # Without pleats, which a coarse cloth does not resolve: as wide as the pleated one.
            width = params.width * (params.gather if params.start == "hanging" else 1.0)
            params = dataclasses.replace(params, rows=rows, cols=cols, width=width, gather=1.0, thickness=0.0)
        self.net = build(params, sphere_home(params), of_tasks=True)
        across, down, shear, _, bend, _ = self.net.families
        pins = tuple(i * cols + j for i, j in sorted(self.net.pinned))
        before = self.sheet
        self.sheet = ClothData(rows, cols, (across.rest, down.rest), shear.stiffness, bend.stiffness, pins)
        method = INTEGRATORS["symplectic_euler"]
        self.longest = STEP_SHARE * method.stable_step(*gershgorin(self.net, self.net.x0))
        return before is None or (before.rows, before.cols, before.pins) != (rows, cols, pins)

    def rows_of(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """(n, 3) of the student's points, from (3, r, c) of the program's."""
        assert self.sheet is not None
        return resample(values, self.sheet.rows, self.sheet.cols).reshape(3, -1).T.copy()

    def start(self, params: ClothParams, state: State) -> None:
        """A new run."""
        self.side = COARSE_SIDES[0]
        self.set_up(params)
        x = self.rows_of(state.x)
        self.restart(x if self.is_comparable else self.net.x0.reshape(3, -1).T.copy(), np.zeros_like(x))
        self.tell_grid()

    def change(self, params: ClothParams, old: ClothParams, state: State) -> None:
        """Other parameters: the motion continues, from the program's where the points are others."""
        if self.set_up(params) or params.integrator != old.integrator:
            self.begin(self.rows_of(state.x), self.rows_of(state.v), state.t)
        self.tell_grid()

    def tell_grid(self) -> None:
        """Tell the panel of a coarser cloth."""
        assert self.sheet is not None
        grid = (0, 0) if self.is_comparable else (self.sheet.rows, self.sheet.cols)
        self.live.report = self.live.report._replace(grid=grid)

    def follow_cloth(self, net: Net, before: State, after: State, h: float) -> None:
        """The program's cloth has taken steps of h [s], moved by `net`, from the state before to the one after."""
        assert self.sheet is not None
        duration = after.t - before.t
        steps = round(duration / h)
        if not self.is_comparable:
            steps = max(1, math.ceil(duration / self.longest))
        forces = forces_of(net, before.t)._replace(mass=self.net.mass, damping=self.net.families[0].damping)
        x, last = self.rows_of(after.x), self.rows_of(before.x)
        if not self.is_comparable:
            forces = forces._replace(grabbed=-1)
        pins = list(self.sheet.pins)
        path = np.zeros((len(pins), 4, 3))
        path[:, 0], path[:, 1] = last[pins], (x[pins] - last[pins]) / duration
        if self.is_comparable:
            for (i, j), exact in net.pin_paths:
                path[pins.index(i * self.sheet.cols + j)] = exact.coefficients
        segment = Segment(steps, duration / steps, forces, path)
        self.follow(segment, after.t, self.params.integrator, x, self.rows_of(after.v))

    def pictured(self, x: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float32]] | None:
        """The program's cloth (3, r, c) [m] as it is drawn beside the student's, and that, (rows, cols, 3) [m].

        None if there is no cloth of the student's. x: (3, r, c) [m] the program's now.
        """
        assert self.sheet is not None
        shape = (self.sheet.rows, self.sheet.cols, 3)
        both = self.drawn(self.rows_of(x))
        if both is None:
            return None
        own, program = both
        if self.is_comparable:
            x = np.ascontiguousarray(np.moveaxis(program.reshape(shape), -1, 0))
        return x, own.reshape(shape).astype(np.float32)

    def take(self, done: Marched, max_reach: float) -> None:
        """Take an answer of this run; a coarse cloth that is too slow continues as a coarser one."""
        step = self.sent[-1].h if self.sent else 0.0
        super().take(done, max_reach)
        seconds = 0.0 if done is None else done.value.step_time
        if not self.is_comparable and self.side != COARSE_SIDES[-1] and seconds * SLOWEST_PACE > step:
            self.side = COARSE_SIDES[-1]
            self.set_up(self.params)
            x = self.net.x0.reshape(3, -1).T.copy()
            self.begin(x, np.zeros_like(x), self.time)
            self.tell_grid()


def unlike(params: ClothParams) -> tuple[str, ...]:
    """The parameters that the functions of the tasks do not feel as the program's cloth does, a line each."""
    lines: list[str] = []
    if params.integrator not in CLOTH.exact:
        lines.append("Method: your cloth uses symplectic Euler, the program's the method that you chose.")
    if params.law != SPRING:
        lines.append("Link: the program's cloth has the law that you chose, yours has springs.")
    if params.thickness > 0.0:
        lines.append("Self-collision distance: the points of your cloth do not push each other.")
    return tuple(lines)


def left_out(params: ClothParams) -> tuple[str, ...]:
    """The effects that the program's cloth leaves out beside a student's, as the tasks do, a line each."""
    if not params.sphere:
        return ()
    return ("Sphere: only the points of both cloths touch it, as in the tasks. A small sphere passes between them.",)
