"""A pendulum: theta'' = -(g/L) sin(theta), by symplectic Euler."""

import math
from typing import NamedTuple

import numpy as np

from app.messages import PlotRow, SceneCommand
from app.scenes.checkpoints import copied, restore
from app.scenes.contract import FRAME_INTERVAL
from app.scenes.pendulum.parameters import PendulumParams
from app.scenes.plot_rows import PlotRows
from app.scenes.quantities import Quantity, for_sweeps

STEP = 1 / 480  # [s]


class PendulumFrame(NamedTuple):
    """A frame for the view."""

    bob: np.ndarray  # (3,) [m] from the pivot
    grid: bool


class PendulumReadings(NamedTuple):
    """Numbers for the panel."""

    period: float  # [s] of small swings


class PendulumScene:
    """The simulation; see `app.scenes.contract.Scene`."""

    step = STEP
    frame_interval = FRAME_INTERVAL
    pace = 1.0
    note = ""
    faster = "nothing else: a pendulum is cheap"

    def __init__(self, params: PendulumParams) -> None:
        self.params, self.rows = params, PlotRows()
        self.reset()

    def reset(self) -> None:
        self.time, self.steps = 0.0, 0
        self.theta, self.rate = math.radians(self.params.angle), 0.0  # [rad], [rad/s]
        self.rows.restart()

    def change_forces(self, params: PendulumParams) -> None:
        self.params = params

    def handle(self, command: SceneCommand) -> None:
        pass

    def advance(self, steps: int) -> None:
        pull = self.params.gravity / self.params.length
        self.rows.add_due(self.time, self.theta)
        for _ in range(steps):
            self.rate -= STEP * pull * math.sin(self.theta)
            self.theta += STEP * self.rate
            self.steps += 1
            self.time = self.steps * STEP
            self.rows.add_due(self.time, self.theta)

    def frame(self) -> PendulumFrame:
        bob = self.params.length * np.array([math.sin(self.theta), 0.0, -math.cos(self.theta)], np.float32)
        return PendulumFrame(bob, self.params.grid)

    def readings(self) -> PendulumReadings:
        return PendulumReadings(2.0 * math.pi * math.sqrt(self.params.length / self.params.gravity))

    def take_plot_rows(self) -> tuple[PlotRow, ...]:
        return self.rows.take()

    def curves(self) -> None:
        pass

    def arrays(self) -> dict[str, tuple[np.ndarray, str]]:
        return {"theta": (np.array(self.theta), "rad"), "rate": (np.array(self.rate), "rad/s")}

    def keep(self) -> dict[str, object]:
        return copied({name: getattr(self, name) for name in ("time", "steps", "theta", "rate")})

    def resume(self, kept: object) -> None:
        restore(self, kept)


# The numbers that sweeps, notebooks and tasks read. A longer table goes to a separate file, `quantities.py`.
QUANTITIES = {
    "small_swing_period": Quantity("s", "Period of small swings", lambda now: now.readings.period),
    "swing": for_sweeps("rad", "Angle from the vertical", lambda now: now.scene.theta),
}
