"""Spring-mass systems: ropes and nets, their integrators, energies, stability and statics.

k is a stiffness here, h a time step.
"""

from sim.springs.cloth import cloth
from sim.springs.integrators import Integrator, discover
from sim.springs.net import Air, Contact, Grab, Net, PinPath
from sim.springs.rope import lab_units, rope

INTEGRATORS: dict[str, Integrator] = discover()

from sim.springs.simulate import Run, simulate  # noqa: E402  (it looks integrators up)

__all__ = [
    "INTEGRATORS", "Air", "Contact", "Grab", "Integrator", "Net", "PinPath", "Run", "cloth", "lab_units", "rope",
    "simulate",
]  # fmt: skip
