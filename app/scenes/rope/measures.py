"""Numbers of the rope: its energies, their balance, its tip, its tightest link, how near to its limit the step is.

Of a race: how far each rope is from the reference.
"""

import math
from typing import TYPE_CHECKING

import numpy as np

from app.scenes.contract import Measure
from app.scenes.race.race import Race
from sim.springs.state import energy, velocities

if TYPE_CHECKING:
    from app.scenes.rope.scene import Scene


def measures(scene: "Scene") -> dict[str, Measure]:
    """Of the rope as it is; what damping took is known with the parameter plot_energy on, or an implicit method."""
    if scene.race:
        return race_measures(scene.race)
    e, state, gauge = energy(scene.net, scene.state), scene.state, scene.stability.stability
    error = e.total + state.dissipated - state.work - scene.initial.total
    known = scene.with_account
    return {
        "tip_height": Measure(float(state.x[2, 0, -1]), "m", "Height of the tip"),
        "tip_speed": Measure(float(np.linalg.norm(velocities(scene.net, state)[:, 0, -1])), "m/s", "Speed of the tip"),
        "largest_tension": Measure(float(scene.tension().max()), "N", "Largest force of a link"),
        "kinetic_energy": Measure(e.kinetic, "J", "Kinetic energy"),
        "elastic_energy": Measure(e.elastic, "J", "Elastic energy of the links"),
        "gravity_energy": Measure(e.gravity - scene.initial.gravity, "J", "Potential energy gained since the start"),
        "contact_energy": Measure(e.contact, "J", "Elastic energy of the contacts"),
        "dissipated_energy": Measure(state.dissipated if known else math.nan, "J", "What damping took"),
        "energy_error": Measure(error if known else math.nan, "J", "Energy beyond what there should be"),
        "h_omega": Measure(gauge.h_omega, "1", "Step times the frequency nearest to its limit"),
        "h_omega_limit": Measure(gauge.limit, "1", "Largest stable h omega of the integrator at that damping"),
        "critical_step": Measure(gauge.critical_step, "s", "Largest stable step"),
    }


def race_measures(race: Race) -> dict[str, Measure]:
    """Of each rope of a race; NaN where it diverged or there is no reference."""
    found = {}
    for s in race.standings().standings:
        found[f"error_{s.number}"] = Measure(s.error, "m", f"Distance of rope {s.number} from the reference")
        found[f"taken_{s.number}"] = Measure(s.taken, "J", f"Energy that the method of rope {s.number} took")
        found[f"h_omega_{s.number}"] = Measure(s.gauge.h_omega, "1", f"Step times frequency of rope {s.number}")
    return found
