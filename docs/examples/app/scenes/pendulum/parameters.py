"""The pendulum's parameters and presets."""

import dataclasses

from sim.parameters import parameter


@dataclasses.dataclass(frozen=True)
class PendulumParams:
    """The pendulum's parameters."""

    length: float = parameter(1.0, 0.1, 10.0, "m", "Length of the rod", group="Main")
    gravity: float = parameter(9.81, 0.1, 100.0, "m/s²", "Gravity", group="Main")
    angle: float = parameter(45.0, -170.0, 170.0, "°", "Angle at the start", group="Main", affects="start")
    speed: float = parameter(1.0, 0.01, 8.0, "", "Simulated time over real time", group="Time", affects="look")
    grid: bool = parameter(True, doc="Lines on the floor", group="Look", affects="look")
    plot_swing: bool = parameter(False, doc="Angle over time", group="Plots", affects="look")


PRESETS = {"Earth": {}, "Moon": {"gravity": 1.62}}
