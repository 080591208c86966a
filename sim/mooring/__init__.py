"""Mooring lines: ropes under water, between the bed, points and floating bodies.

system = read_moordyn("line.txt")     # or System(lines, points, Water(depth))
rest = system.at_rest()
run = simulate(system, motion={2: lambda t: (0.5 * math.sin(t), 0.0, 0.0)}, duration=60.0)

`State`, `advance`, `critical_step` and `simulate` are those of sim.springs.
"""

from sim.mooring.moordyn import changed_moordyn, read_moordyn, write_moordyn
from sim.mooring.moored import moored
from sim.mooring.motion import paths_to, point_forces
from sim.mooring.parts import Line, LineType, MooredBody, Point
from sim.mooring.rest.statics import Rest, at_rest
from sim.mooring.run import MooringRun
from sim.mooring.system import System
from sim.springs.simulate import simulate
from sim.springs.stability import critical_step
from sim.springs.state import State, advance

__all__ = [
    "Line",
    "LineType",
    "MooredBody",
    "MooringRun",
    "Point",
    "Rest",
    "State",
    "System",
    "advance",
    "at_rest",
    "changed_moordyn",
    "critical_step",
    "moored",
    "paths_to",
    "point_forces",
    "read_moordyn",
    "simulate",
    "write_moordyn",
]  # fmt: skip
