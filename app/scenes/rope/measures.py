"""Measures of the rope: its energies, their balance, its tip, its largest tension, and the stability of the step."""

from typing import TYPE_CHECKING

import numpy as np

from app.scenes.contract import Measure
from sim.springs.state import energy, velocities

if TYPE_CHECKING:
    from app.scenes.rope.scene import RopeScene


def measures(scene: "RopeScene") -> dict[str, Measure]:
    """The measures at the scene's time."""
    e, state, account = energy(scene.net, scene.state), scene.state, scene.account
    scene.assess_stability()  # its own assessment is up to half a second old
    now = scene.stability.stability
    gained = e.gravity - account.initial.gravity
    return {
        "tip_height": Measure(float(state.x[2, 0, -1]), "m", "Height of the tip"),
        "tip_speed": Measure(float(np.linalg.norm(velocities(scene.net, state)[:, 0, -1])), "m/s", "Speed of the tip"),
        "largest_tension": Measure(float(scene.tension().max()), "N", "Largest force of a link"),
        "kinetic_energy": Measure(e.kinetic, "J", "Kinetic energy"),
        "elastic_energy": Measure(e.elastic, "J", "Elastic energy of the links"),
        "gravity_energy": Measure(gained, "J", "Potential energy gained since the start"),
        "contact_energy": Measure(e.contact, "J", "Elastic energy of the contacts"),
        "dissipated_energy": Measure(state.dissipated, "J", "Energy that damping took since the start"),
        "energy_error": Measure(account.error(scene.net, state), "J", "Numerical error of the energy since the start"),
        "h_omega": Measure(now.h_omega, "1", "Time step times the angular frequency nearest to its limit"),
        "h_omega_limit": Measure(now.limit, "1", "Largest stable h omega of the integrator at that damping"),
        "critical_step": Measure(now.critical_step, "s", "Largest stable time step"),
    }
