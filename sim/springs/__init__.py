"""Spring-mass systems: ropes and nets, their integrators, energies, stability and statics.

k is a stiffness here, h a time step.
"""

from sim.springs.cloth import cloth
from sim.springs.integrators import Integrator, discover
from sim.springs.laws import LAWS
from sim.springs.net import Air, Contact, Grab, Net, PinPath
from sim.springs.rope import lab_units, rope
from sim.springs.simulate import Run, simulate
from sim.springs.stability import critical_step
from sim.springs.state import State, advance

INTEGRATORS: dict[str, Integrator] = discover()

__all__ = [
    "INTEGRATORS", "LAWS", "Air", "Contact", "Grab", "Integrator", "Net", "PinPath", "Run", "State", "advance", "cloth",
    "critical_step", "lab_units", "rope", "simulate",
]  # fmt: skip
