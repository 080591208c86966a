"""The parameters of a race of ropes, and its presets."""

import dataclasses
from typing import Any

from app.scenes.groups import in_look, in_main, in_plots, in_rope
from app.scenes.springs.methods import METHODS
from app.scenes.springs.rope_parameters import SharedRopeParams, hidden_of_rope
from sim.parameters import redeclare

MAX_ROPES = 6
NUMBERS = range(2, MAX_ROPES + 1)  # of the ropes that have an integrator and a step parameter of their own
STEP_RULES = {"same step": "Same step", "same cost": "Same cost", "own steps": "Own steps"}


def method_of_rope(number: int, default: str) -> Any:
    """The parameter of one rope's method."""
    doc = f"Method of integration of rope {number}"
    return in_main(default, choices=METHODS, doc=doc, affects="start", title=f"{number}: method")


def step_of_rope(number: int) -> Any:
    """The parameter of one rope's time step."""
    title = f"{number}: time step"
    return in_main(1 / 60, 1e-5, 0.1, "s", f"Step of rope {number}", log_from=1e-5, affects="start", title=title)


@dataclasses.dataclass(frozen=True)
class RaceRules:
    """Number of ropes, and their differences."""

    ropes: int = in_main(3, 1, MAX_ROPES, "", "Number of ropes, each with its own method and step", affects="start")
    race_steps: str = in_main(
        "same cost", choices=STEP_RULES,
        doc="Same cost: as many force evaluations a second as rope 1; own steps: as set for each rope", affects="start",
        title="Steps",
    )  # fmt: skip
    stiffness_ratio: float = in_rope(
        1.0, 1.0, 10.0, "", "Stiffness of each rope over that of the rope before it", affects="start",
        title="Stiffness ratio",
    )  # fmt: skip


@dataclasses.dataclass(frozen=True)
class RaceMethods:
    """The methods of all ropes but the first, and how the ropes are shown."""

    integrator_2: str = method_of_rope(2, "rk4")
    step_2: float = step_of_rope(2)
    integrator_3: str = method_of_rope(3, "leapfrog")
    step_3: float = step_of_rope(3)
    integrator_4: str = method_of_rope(4, "implicit_euler")
    step_4: float = step_of_rope(4)
    integrator_5: str = method_of_rope(5, "tr_bdf2")
    step_5: float = step_of_rope(5)
    integrator_6: str = method_of_rope(6, "implicit_midpoint")
    step_6: float = step_of_rope(6)
    show_reference: bool = in_look(
        True, doc="Draw the reference run in grey: Dormand-Prince 5 with a tolerance of 1e-10"
    )
    spacing: float = in_look(0.75, 0.0, 2.0, "m", "Distance between the drawn ropes")


@dataclasses.dataclass(frozen=True)
class RaceParams(RaceMethods, SharedRopeParams, RaceRules):
    """The race's parameters. A change of the compared problem restarts it; other changes do not."""

    integrator: str = redeclare(
        SharedRopeParams, "integrator", default="explicit_euler", choices=tuple(METHODS),
        choice_titles=tuple(METHODS.values()), doc="Method of integration of rope 1", affects="start",
        title="1: method",
    )  # fmt: skip
    time_step: float = redeclare(
        SharedRopeParams, "time_step", default=1 / 240, doc="Step of rope 1", affects="start", title="1: time step"
    )
    units: str = redeclare(SharedRopeParams, "units", affects="start")
    points: int = redeclare(SharedRopeParams, "points", affects="start")
    length: float = redeclare(SharedRopeParams, "length", affects="start")

    plot_errors: bool = in_plots(
        True, doc="Distance of each rope from the reference run over time", title="Distance from reference"
    )
    plot_energies: bool = in_plots(
        True, doc="Numerical error of the energy of each rope over time", title="Energy errors"
    )


def line_up(*integrators: str, **others: Any) -> dict[str, Any]:
    """A preset: the methods of the ropes in order, and the other parameters that are not the defaults."""
    first, *rest = integrators
    named = {f"integrator_{number}": name for number, name in enumerate(rest, 2)}
    return {"ropes": len(integrators), "integrator": first, **named, "race_steps": "same step", **others}


# 160 to 15,625 N/m, across Euler's limit at 1/60 s (437) and RK4's (8600). A softer or longer rope meets the floor.
RISING = {"points": 5, "stiffness": 160.0, "stiffness_ratio": 2.5, "time_step": 1 / 60}

PRESETS: dict[str, dict[str, Any]] = {
    "Euler against RK4 against leapfrog": {},
    "Euler at rising stiffness": line_up(*["explicit_euler"] * 6, **RISING),
    "RK4 at the same values": line_up(*["rk4"] * 6, **RISING),
    "Leapfrog read literally": line_up(
        "leapfrog", "leapfrog", "leapfrog_lagged", "leapfrog_lagged", race_steps="own steps", time_step=1 / 60,
        step_2=1 / 120, step_3=1 / 60, step_4=1 / 120,
    ),
    "Undamped until chaos": line_up(
        "symplectic_euler", "leapfrog", "implicit_midpoint", "pefrl", "rk4", race_steps="same cost",
        time_step=1 / 960, damping=0.0, drag=0.0, floor=False,
    ),
    "Implicit methods on a very stiff rope": line_up(
        "implicit_euler", "tr_bdf2", "implicit_midpoint", stiffness=1e9, time_step=1 / 60,
    ),
    "Shaken at the root": {"drag": 0.4, "root_swing": 0.2, "swing_period": 0.9},
}  # fmt: skip

ABOUT = {  # preset -> what it shows and what to try
    "Euler against RK4 against leapfrog": "One rope, three methods: see how far each is from the exact motion.",
    "Euler at rising stiffness": "Explicit Euler at one step and six stiffnesses: see which ropes stay stable.",
    "RK4 at the same values": "The same six stiffnesses by Runge-Kutta 4: compare which ropes stay stable.",
    "Leapfrog read literally": "Leapfrog beside the lab's formulas word for word: compare the errors.",
    "Undamped until chaos": "Five methods at the same cost, until chaos magnifies the smallest difference.",
    "Implicit methods on a very stiff rope": "Three methods for stiff ropes: compare the energy that each dissipates.",
    "Shaken at the root": "All ropes are shaken alike, and never come to rest: compare the errors.",
}


def method_of(params: RaceParams, number: int) -> str:
    """Name of the method of rope `number`, from 1."""
    return params.integrator if number == 1 else getattr(params, f"integrator_{number}")


def hidden(params: RaceParams) -> set[str]:
    """The parameters that mean nothing with the others as they are."""
    names = hidden_of_rope(params, sphere=False)
    if params.ropes == 1:
        names |= {"race_steps", "stiffness_ratio", "spacing"}
    for number in NUMBERS:
        if number > params.ropes:
            names.add(f"integrator_{number}")
        if number > params.ropes or params.race_steps != "own steps":
            names.add(f"step_{number}")
    return names
