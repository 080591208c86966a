"""The forces on lines under water, one file each."""

from sim.jit import modules_of
from sim.springs.forces.record import Force

FORCES: tuple[Force, ...] = tuple(module.FORCE for module in modules_of(__name__))
