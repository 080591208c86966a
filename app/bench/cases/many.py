"""Ropes together in the lanes of the vector registers, against one after the other: a sweep's work, on one thread."""

from typing import Any

import numpy as np

from app.bench.timing import median_times
from app.sweep.case import run_case, run_together
from sim.springs import INTEGRATORS, Net, State, advance, rope
from sim.springs.many import METHODS, advance_many

POINTS = 10
STEP, SECONDS = 1 / 120, 5.0  # [s]
LEAST_STIFFNESS, MOST_STIFFNESS = 200.0, 2000.0  # [N/m]
CASES = 64  # of a scene, as many as a sweep takes in one group


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Rows of what is run, how many, ns a rope and step together and alone, their ratio, largest difference [m].

    Both with the energy account, which a sweep records. The last row is whole cases of a sweep, with what they measure.
    """
    count, repeats = (1000, 3) if quick else (10_000, 7)
    steps = round(SECONDS / STEP)
    nets = [rope(POINTS, stiffness=k) for k in np.linspace(LEAST_STIFFNESS, MOST_STIFFNESS, count)]
    samples = np.full((count, 1), steps)
    table = []
    for method in METHODS:
        # Explicit Euler is unstable at the others' step.
        h = STEP / 4 if method == "explicit_euler" else STEP

        def together(method: str = method, h: float = h) -> np.ndarray:
            return advance_many(nets, method, np.full(count, h), samples).x[:, 0]

        def alone(method: str = method, h: float = h) -> np.ndarray:
            return np.array([advanced(net, method, h, steps) for net in nets])

        table.append(
            row(method, count, steps, median_times((together, alone), repeats), np.abs(together() - alone()).max())
        )
    values = [
        {"stiffness": k, "floor": False, "time_step": STEP, "plot_energy": True, "plot_tip": True}
        for k in np.linspace(LEAST_STIFFNESS, MOST_STIFFNESS, CASES).tolist()
    ]

    def tips_together() -> list[float]:
        return [outcome.measures["tip_height"][0] for outcome in run_together("rope", values, (SECONDS,)) if outcome]

    def tips_alone() -> list[float]:
        return [run_case("rope", case, (SECONDS,)).measures["tip_height"][0] for case in values]

    error = np.abs(np.subtract(tips_together(), tips_alone())).max()
    table.append(
        row("cases of a sweep, leapfrog", CASES, steps, median_times((tips_together, tips_alone), repeats), error)
    )
    return table


def advanced(net: Net, method: str, h: float, steps: int) -> np.ndarray:
    """Positions of one rope after its steps, taken alone."""
    state = State.at_rest(net)
    advance(net, state, INTEGRATORS[method], h, steps, with_account=True)
    return state.x


def row(name: str, count: int, steps: int, seconds: list[float], difference: float) -> dict[str, Any]:
    """One row of the table. seconds: together, alone."""
    together, alone = (1e9 * taken / (count * steps) for taken in seconds)
    return {
        "name": name,
        "ropes": count,
        "steps": steps,
        "together_ns": together,
        "alone_ns": alone,
        "ratio": alone / together,
        "difference_m": float(difference),
    }
