"""Quantities of a race: error and energy of each rope, its step relative to its limit, its cost."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from app.scenes.quantities import Quantities, Quantity, for_tasks
from app.scenes.race.parameters import MAX_ROPES

if TYPE_CHECKING:
    from app.scenes.race.entrants import Result


def of_rope(number: int, value: "Callable[[Result], float]") -> Callable[[Any], float | None]:
    """A number of one rope's result; None if the race has no such rope."""
    return lambda now: next((value(r) for r in now.readings.results if r.number == number), None)


def quantities_of(n: int) -> Quantities:
    """The quantities of rope `n`."""
    return {
        f"error_{n}": Quantity(
            "m",
            f"Error of rope {n}",
            of_rope(n, lambda r: r.error),
            floor=of_rope(n, lambda r: r.error_floor),
        ),
        f"numerical_dissipation_{n}": Quantity(
            "J", f"Energy dissipated by the method of rope {n}", of_rope(n, lambda r: r.numerical_dissipation)
        ),
        f"h_omega_{n}": Quantity(
            "1", f"hω (step times highest frequency) of rope {n}", of_rope(n, lambda r: r.gauge.h_omega)
        ),
        f"energy_error_{n}": for_tasks(
            "J", f"Energy added by the method of rope {n}", of_rope(n, lambda r: -r.numerical_dissipation)
        ),
        f"limit_{n}": for_tasks(
            "1", f"Limit of hω (step times highest frequency) of rope {n}", of_rope(n, lambda r: r.gauge.limit)
        ),
        f"stiffness_{n}": for_tasks("N/m", f"Stiffness of rope {n}", of_rope(n, lambda r: r.stiffness)),
        f"own_step_{n}": for_tasks("s", f"Time step of rope {n}", of_rope(n, lambda r: r.step)),
        f"evaluations_{n}": for_tasks(
            "1", f"Evaluations of the forces in a step of rope {n}", of_rope(n, lambda r: r.evals)
        ),
    }


QUANTITIES: Quantities = {
    name: quantity for n in range(1, MAX_ROPES + 1) for name, quantity in quantities_of(n).items()
} | {
    "ropes_stopped": for_tasks(
        "1", "Ropes that left their bounds", lambda now: sum(bool(r.failure) for r in now.readings.results)
    ),
    "ropes_stable": for_tasks(
        "1",
        "Ropes within the limit of their method",
        lambda now: sum(r.gauge.share <= 1.0 for r in now.readings.results),
    ),
}
