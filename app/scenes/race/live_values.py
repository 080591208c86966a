"""Values of a race for the tasks of the lab: error and energy of each rope, and its step relative to its limit."""

from typing import TYPE_CHECKING

from app.messages import Snapshot
from app.scenes.contract import Measure

if TYPE_CHECKING:
    from app.scenes.race.entrants import RaceReadings


def live_values(snapshot: Snapshot) -> dict[str, Measure]:
    """The numbers of a snapshot."""
    readings: RaceReadings = snapshot.readings
    found: dict[str, Measure] = {}
    for r in readings.results:
        n = r.number
        found |= {
            f"error_{n}": Measure(r.error, "m", f"Error of rope {n}", r.error_floor),
            f"energy_error_{n}": Measure(-r.numerical_dissipation, "J", f"Energy that the method of rope {n} added"),
            f"h_omega_{n}": Measure(r.gauge.h_omega, "1", f"hω (step times highest frequency) of rope {n}"),
            f"limit_{n}": Measure(r.gauge.limit, "1", f"Limit of hω (step times highest frequency) of rope {n}"),
            f"stiffness_{n}": Measure(r.stiffness, "N/m", f"Stiffness of rope {n}"),
            f"own_step_{n}": Measure(r.step, "s", f"Time step of rope {n}"),
            f"evaluations_{n}": Measure(r.evals, "1", f"Evaluations of the forces in a step of rope {n}"),
        }
    stopped = [r for r in readings.results if r.failure]
    stable = [r for r in readings.results if r.gauge.share <= 1.0]
    return found | {
        "ropes_stopped": Measure(len(stopped), "1", "Ropes that left their bounds"),
        "ropes_stable": Measure(len(stable), "1", "Ropes within the limit of their method"),
    }
