"""Spring-mass systems: ropes and nets, their integrators, energies, stability and statics.

k is a stiffness here, h a time step. `INTEGRATORS` and `LAWS` (of the links) are dicts by name.
"""

from sim.springs.analysis.energy_history import EnergyHistory
from sim.springs.cloth import cloth, vertical_cloth
from sim.springs.integrators import Integrator, discover
from sim.springs.laws import LAWS
from sim.springs.net import Air, Contact, Family, Grab, Net, PinPath
from sim.springs.rope import lab_units, rope
from sim.springs.run import Run
from sim.springs.simulate import simulate
from sim.springs.stability import critical_step
from sim.springs.state import State, advance

INTEGRATORS: dict[str, Integrator] = discover()

__all__ = [
    "INTEGRATORS", "LAWS", "Air", "Contact", "EnergyHistory", "Family", "Grab", "Integrator", "Net", "PinPath", "Run",
    "State", "advance", "cloth", "critical_step", "lab_units", "rope", "simulate", "vertical_cloth",
]  # fmt: skip
