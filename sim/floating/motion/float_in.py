"""Bodies in a sea: water, wave forces and `step`, from outside step by step, or for a time with frames.

>>> from sim.floating import Body, Hull
>>> from sim.ocean import Sea
>>> sea = Sea(64, 128.0, "regular", wave_height=0.5, wave_period=6.0, wind_speed=0.0)
>>> buoy = Body(Hull.cylinder(0.5, 1.0), mass=390.0, center_of_gravity=(0.0, 0.0, -0.25))
>>> run = float_in(sea, [buoy.afloat()], duration=10.0, frames=101)
>>> run.x.shape, run.lift.shape
((101, 1, 3), (101, 1, 4))
"""

import math
import warnings
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from sim.floating.linear.hydrodynamics import check_bed, check_box, check_water_depth
from sim.floating.motion.body import Body, make_fleet
from sim.floating.motion.motion import STANDARD, MotionCoefficients
from sim.floating.motion.sea_steps import SeaSteps
from sim.floating.statics.equilibrium import Layers, check_layers, equilibrium_draft
from sim.floating.statics.stability import Loaded, is_stable, near_upright
from sim.frames import Progress, equal_steps, frame_times, run_frames
from sim.interruption import raise_if_stopped
from sim.ocean.any_sea import AnySea
from sim.records import equal_to_itself
from sim.validation import argument_error, check_kind, check_number, is_whole_number

LONGEST_STEP = 1 / 60  # [s]


@equal_to_itself
class FloatRun(NamedTuple):
    """n bodies at frames of equal spacing."""

    t: np.ndarray  # (frames,) [s] of the sea
    x: np.ndarray  # (frames, n, 3) [m] of the centres of gravity
    rotation: np.ndarray  # (frames, n, 4) quaternions (w, x, y, z) from body to world
    velocity: np.ndarray  # (frames, n, 3) [m/s]
    spin: np.ndarray  # (frames, n, 3) [rad/s] in world axes
    # (frames, n, 4) [N] upward: buoyancy, waves, drag, and the reaction to the motion, mean over the last step
    lift: np.ndarray
    surface: np.ndarray  # (frames, n) [m] height of the water at the bodies, in the middle of the last step


class FloatState:
    """Bodies in a sea at its time t [s]: `advance` steps them, with the pulls in `fleet.mooring` (n, 6) [N, N m].

    The gravity is that of the sea at each step. The coefficients of linear theory are those of the sea's fluids at the
    start.

    >>> from sim.floating import Body, FloatState, Hull
    >>> from sim.ocean import Sea
    >>> sea = Sea(64, 128.0, "regular", wave_height=0.5, wave_period=6.0, wind_speed=0.0)
    >>> state = FloatState(sea, [Body(Hull.box(4.0, 2.0, 1.0), density=500.0).afloat()])
    >>> for _ in range(6):
    ...     state.fleet.mooring[0, 0] = -200.0 * state.fleet.velocity[0, 0]  # [N] of a damper
    ...     state.advance(1 / 60, steps=1)
    >>> round(state.t, 6), state.fleet.position.shape
    (0.1, (1, 3))
    """

    def __init__(
        self,
        sea: AnySea,
        bodies: Sequence[Body],
        coefficients: MotionCoefficients = STANDARD,
        begin: float | None = None,
    ) -> None:
        """The bodies where they are at time `begin` [s], by default the sea's own. Raises ValueError as `float_in`."""
        check_kind("sea", sea, AnySea, "a Sea, a NonlinearSea or a RadialSea")
        check_kind("coefficients", coefficients, MotionCoefficients, "MotionCoefficients")
        self.sea, self.layers, self.coefficients = sea, sea.layers, coefficients
        self.fleet = make_fleet(bodies, self.layers)
        for i, body in enumerate(bodies):
            check_water_depth(f"bodies[{i}]", body.hull, sea.water.depth)
            hull, density = body.loaded()
            draft = min(equilibrium_draft(hull, density, self.layers), float(hull.size[2]))
            check_bed(f"bodies[{i}]", hull, draft, sea.water.depth)
            check_box(f"bodies[{i}]", hull, draft)
        widths = np.array([math.sqrt(float(body.hull.size[0] * body.hull.size[1])) for body in bodies])
        self.steps = SeaSteps(bodies, widths, self.layers)
        self.t = sea.time if begin is None else check_number("begin", begin, "s")
        # (n,) [m] height of the water at the bodies, in the middle of the last step
        self.surface = sea.at(self.fleet.position[:, :2], self.t, widths).height if len(bodies) else np.zeros(0)

    def advance(self, h: float, steps: int) -> None:
        """Continue by `steps` steps of h [s], of 1/60 s at most. Raises FloatingPointError as `step`."""
        check_number("h", h, "s", 0, LONGEST_STEP * (1.0 + 1e-9), above=True)
        if not is_whole_number(steps) or steps < 0:
            raise argument_error("steps", steps, "a whole number of at least 0")
        for _ in range(steps):
            raise_if_stopped()
            if len(self.fleet.mass):
                self.take_step(self.t + 0.5 * h, h)
            self.t += h  # step by step, so that it does not depend on how steps are shared out among the calls

    @property
    def gravity(self) -> float:
        """[m/s2] of the sea."""
        return self.sea.water.gravity

    def take_step(self, middle: float, h: float) -> None:
        """A step of h [s] with the water of its middle [s]."""
        at = self.sea.at(self.fleet.position[:, :2], middle, self.steps.widths)
        thickness = None if len(self.layers) == 1 else self.layers[0][1]
        coefficients = self.coefficients._replace(gravity=self.gravity)
        self.steps.step(self.sea, self.fleet, at, middle, h, coefficients, self.layers, thickness)
        self.surface = at.height


class FloatFrames:
    """Bodies on their way from frame to frame, with the results of each."""

    def __init__(self, state: FloatState, t: np.ndarray, h: float, steps: int) -> None:
        fleet = state.fleet
        self.state, self.h, self.steps = state, h, steps
        self.arrays = (fleet.position, fleet.rotation, fleet.velocity, fleet.spin, fleet.lift)
        self.results = [np.empty((len(t), *array.shape)) for array in self.arrays]
        self.surface = np.empty((len(t), len(fleet.mass)))

    def advance(self, frame: int) -> None:
        """Continue to a frame from the one before."""
        self.state.advance(self.h, self.steps)

    @property
    def is_bounded(self) -> bool:
        """True: `step` raises an error for a state that is not finite."""
        return True

    def sample(self, frame: int) -> None:
        """Keep the state as that of a frame."""
        for result, array in zip(self.results, self.arrays, strict=True):
            result[frame] = array
        self.surface[frame] = self.state.surface


def float_in(
    sea: AnySea,
    bodies: Sequence[Body],
    duration: float,
    frames: int = 61,
    step: float = LONGEST_STEP,
    *,
    coefficients: MotionCoefficients = STANDARD,
    begin: float | None = None,
    progress: Progress = None,
) -> FloatRun:
    """Let bodies float in a sea for a duration [s]; `Body.afloat` lets them begin at rest.

    begin: time [s] of the start, by default the sea's own, `sea.time`, which is then that of the end. A run continues
    where the last one of its sea ended; begin=0.0 repeats it in a sea that can go back.

    On a sum of waves they feel linear wave forces; on the tiles those of waves long beside the hull (motion.py). The
    gravity is the sea's.
    step: [s], 1/60 s at most, shortened equally so that it divides a frame interval.
    progress: called with (frames done, frames).
    A UserWarning gives the GM of a body that is not stable upright. Raises ValueError for a value that is not allowed,
    for a hull with a dataset of another depth or heading than the sea's, and as `make_fleet` and `RadialSea.at`.
    """
    t = frame_times(duration, frames, step, progress)
    check_number("step", step, "s", 0, LONGEST_STEP, above=True)
    state = FloatState(sea, bodies, coefficients, begin)
    start = state.t
    for words in unstable(bodies, state.layers):
        warnings.warn(words, UserWarning, stacklevel=2)
    steps, h = equal_steps(float(t[1]), step)
    history = FloatFrames(state, t, h, steps)
    run_frames(history, len(t), progress)
    sea.at(np.empty((0, 2)), state.t)  # the last step has asked for its middle
    x, rotation, velocity, spin, lift = history.results
    return FloatRun(start + t, x, rotation, velocity, spin, lift, history.surface)


def unstable(bodies: Sequence[Body], layers: Layers) -> list[str]:
    """A sentence with the GM of each load of a hull that floats, but is not stable upright."""
    fluids, sentences = check_layers(layers), {}
    for i, body in enumerate(bodies):
        load = body.loaded()
        if load in sentences or load[1] > fluids[-1][0]:
            continue
        sentences[load], rest = "", near_upright(Loaded(*load, fluids))
        if rest is not None and not is_stable(load[0], rest):
            sentences[load] = f"bodies[{i}]: GM = {rest.least_height:.3g} m: it is not stable upright"
    return [words for words in sentences.values() if words]
