"""Measures of a race: error, cost and step relative to the limit of each rope."""

from typing import TYPE_CHECKING

from app.scenes.contract import Measure

if TYPE_CHECKING:
    from app.scenes.race.scene import RaceScene


def measures(scene: "RaceScene") -> dict[str, Measure]:
    """The measures of each rope; NaN where it diverged or there is no reference run."""
    found = {}
    for r in scene.race.readings().results:
        n = r.number
        found[f"error_{n}"] = Measure(r.error, "m", f"Distance of rope {n} from the reference run")
        found[f"numerical_dissipation_{n}"] = Measure(
            r.numerical_dissipation, "J", f"Energy that the method of rope {n} took"
        )
        found[f"h_omega_{n}"] = Measure(r.gauge.h_omega, "1", f"Time step times angular frequency of rope {n}")
    return found
