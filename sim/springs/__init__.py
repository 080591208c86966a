"""Spring-mass systems: ropes and nets, their integrators, energies, stability and statics.

k is a stiffness here, h a time step. `INTEGRATORS` and `LAWS` (of the links) are dicts by name.
"""

from sim.springs.analysis.energy_history import EnergyHistory
from sim.springs.cloth import cloth, vertical_cloth
from sim.springs.integrators import Integrator, discover
from sim.springs.laws import LAWS
from sim.springs.laws.stiffening import Stiffening
from sim.springs.net import Air, Contact, Family, Grab, Net, PinPath
from sim.springs.rope import lab_units, rope
from sim.springs.run import Run
from sim.springs.simulate import simulate
from sim.springs.stability import (
    Gauge,
    Mode,
    accurate_methods,
    accurate_step,
    critical_step,
    critical_stiffness,
    gauge,
    step_limit,
    top_modes,
)
from sim.springs.state import State, advance
from sim.springs.statics import Equilibrium, catenary, equilibrium, hanging_chain

INTEGRATORS: dict[str, Integrator] = discover()

__all__ = [
    "INTEGRATORS", "LAWS", "Air", "Contact", "EnergyHistory", "Equilibrium", "Family", "Gauge", "Grab", "Integrator",
    "Mode", "Net", "PinPath", "Run", "State", "Stiffening", "accurate_methods", "accurate_step", "advance", "catenary",
    "cloth", "critical_step", "critical_stiffness", "equilibrium", "gauge", "hanging_chain", "lab_units", "rope",
    "simulate", "step_limit", "top_modes", "vertical_cloth",
]  # fmt: skip
