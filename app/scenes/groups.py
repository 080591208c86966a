"""Groups of parameters in the panel: each of these declares a parameter as `parameter` does, in its group."""

import functools
from typing import Any

from sim.parameters import parameter

in_main = functools.partial(parameter, group="Main")
in_rope = functools.partial(parameter, group="Rope")
in_surroundings = functools.partial(parameter, group="Surroundings")
in_waves = functools.partial(parameter, group="Waves")
in_grid = functools.partial(parameter, group="Grid")
in_look = functools.partial(parameter, group="Look", affects="look")
in_plots = functools.partial(parameter, group="Plots", affects="look")


def speed_parameter(slowest: float, fastest: float) -> Any:
    """The parameter of the clock's speed."""
    doc = "Simulated time over real time: 0.1 is slow motion"
    return parameter(1.0, slowest, fastest, "", doc, log_from=slowest, group="Time", affects="look")
