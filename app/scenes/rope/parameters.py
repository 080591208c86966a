"""The rope's parameters, its presets and the net they describe; the race's parameters and presets among them."""

import dataclasses
from typing import Any

from app.messages import Vector
from sim.parameters import parameter
from sim.springs import INTEGRATORS, Contact, Net, lab_units, rope
from sim.springs.net import CONTACT_LAWS, DAMPING_MODELS

ROOT: Vector = (0.0, 0.0, 3.0)  # [m]
SPHERE: Vector = (-0.45, 0.12, 1.6)  # [m], a little behind the rope, which then slides off in view
THICKNESS = 0.035  # [m] radius of the drawn rope, and of its points for contact
MOST_ROPES = 6
STEP_RULES = ("same step", "same cost", "own steps")


@dataclasses.dataclass(frozen=True)
class Params:
    """The rope's parameters; the defaults are the lab's code defaults with a better integrator."""

    integrator: str = parameter("leapfrog", choices=tuple(INTEGRATORS), doc="Method of integration", group="Time")
    time_step: float = parameter(1 / 60, 1e-5, 0.1, "s", "Step h of the integrator", log_from=1e-5, group="Time")
    speed: float = parameter(1.0, 0.01, 8.0, "", "Simulated per real time", log_from=0.01, group="Time", affects="look")

    units: str = parameter(
        "lab",
        choices=("lab", "material"),
        doc="lab: numbers per point and link, so the rope changes with its points; material: per metre",
        group="Rope",
    )
    points: int = parameter(10, 2, 1000, "", "Points, the root included", log_from=2, group="Rope")
    length: float = parameter(2.0, 0.1, 10.0, "m", "Length at rest", group="Rope")
    stiffness: float = parameter(800.0, 1.0, 1e9, "N/m", "Stiffness k of a link", log_from=1.0, group="Rope")
    damping: float = parameter(7.0, 0.0, 1e5, "N s/m", "Damping b of a link", log_from=1e-3, group="Rope")
    mass: float = parameter(1.0, 1e-3, 1e3, "kg", "Mass of a point", log_from=1e-3, group="Rope")
    drag: float = parameter(1.0, 0.0, 1e3, "N s/m", "Air drag c on a point", log_from=1e-3, group="Rope")
    axial_stiffness: float = parameter(178.0, 1.0, 1e9, "N", "Stiffness EA", log_from=1.0, group="Rope")
    axial_viscosity: float = parameter(1.56, 0.0, 1e5, "N s", "Damping of a metre of rope", log_from=1e-3, group="Rope")
    mass_per_length: float = parameter(4.5, 1e-3, 1e3, "kg/m", "Mass of a metre of rope", log_from=1e-3, group="Rope")
    drag_per_length: float = parameter(4.5, 0.0, 1e3, "N s/m^2", "Air drag on a metre", log_from=1e-3, group="Rope")
    damping_model: str = parameter(
        "isotropic",
        choices=DAMPING_MODELS,
        doc="isotropic: b on the whole relative velocity, the lab's; axial: along the link only",
        group="Rope",
    )

    ropes: int = parameter(
        1,
        1,
        MOST_ROPES,
        "",
        "Ropes side by side, each with a method and a step of its own",
        group="Race",
        affects="start",
    )
    race_steps: str = parameter(
        "same step",
        choices=STEP_RULES,
        doc="same cost: as many force evaluations a second as rope 1; own steps: as set for each",
        group="Race",
        affects="start",
    )
    stiffness_ratio: float = parameter(
        1.0, 1.0, 10.0, "", "Stiffness of each rope over that of the one before", group="Race", affects="start"
    )
    ghost: bool = parameter(
        True, doc="Draw the reference beside each rope: dopri5 at a tolerance of 1e-10", group="Race", affects="look"
    )
    spacing: float = parameter(0.5, 0.0, 2.0, "m", "Distance between the ropes as drawn", group="Race", affects="look")
    integrator_2: str = parameter(
        "rk4", choices=tuple(INTEGRATORS), doc="Method of rope 2", group="Race", affects="start"
    )
    step_2: float = parameter(1 / 60, 1e-5, 0.1, "s", "Step of rope 2", log_from=1e-5, group="Race", affects="start")
    integrator_3: str = parameter(
        "symplectic_euler", choices=tuple(INTEGRATORS), doc="Method of rope 3", group="Race", affects="start"
    )
    step_3: float = parameter(1 / 60, 1e-5, 0.1, "s", "Step of rope 3", log_from=1e-5, group="Race", affects="start")
    integrator_4: str = parameter(
        "implicit_euler", choices=tuple(INTEGRATORS), doc="Method of rope 4", group="Race", affects="start"
    )
    step_4: float = parameter(1 / 60, 1e-5, 0.1, "s", "Step of rope 4", log_from=1e-5, group="Race", affects="start")
    integrator_5: str = parameter(
        "tr_bdf2", choices=tuple(INTEGRATORS), doc="Method of rope 5", group="Race", affects="start"
    )
    step_5: float = parameter(1 / 60, 1e-5, 0.1, "s", "Step of rope 5", log_from=1e-5, group="Race", affects="start")
    integrator_6: str = parameter(
        "implicit_midpoint", choices=tuple(INTEGRATORS), doc="Method of rope 6", group="Race", affects="start"
    )
    step_6: float = parameter(1 / 60, 1e-5, 0.1, "s", "Step of rope 6", log_from=1e-5, group="Race", affects="start")

    gravity: float = parameter(10.0, 0.0, 100.0, "m/s^2", "Gravity, downwards", group="Surroundings")
    floor: bool = parameter(True, doc="Floor at height 0", group="Surroundings")
    sphere: bool = parameter(False, doc="Sphere, on a gizmo of its own", group="Surroundings")
    sphere_radius: float = parameter(0.75, 0.05, 3.0, "m", "Radius of the sphere", group="Surroundings")
    friction: float = parameter(0.3, 0.0, 2.0, "", "Coulomb friction coefficient", group="Surroundings")
    contact_stiffness: float = parameter(
        800.0, 1.0, 1e7, "N/m", "Contact stiffness", log_from=1.0, group="Surroundings"
    )
    contact_damping: float = parameter(5.0, 0.0, 1e4, "N s/m", "Contact damping", log_from=1e-2, group="Surroundings")
    contact_law: str = parameter(
        "clipped",
        choices=CONTACT_LAWS,
        doc="clipped: never pulls, with friction; lab: the original's, sticky and viscous",
        group="Surroundings",
    )
    pull: float = parameter(300.0, 1.0, 1e5, "N", "Largest force of a drag", log_from=1.0, group="Surroundings")

    colour: str = parameter(
        "tension", choices=("tension", "plain"), doc="What the rope's colour shows", group="Look", affects="look"
    )
    show_points: bool = parameter(True, doc="Draw the points, to be grabbed", group="Look", affects="look")
    grid: bool = parameter(True, doc="Lines on the floor", group="Look", affects="look")
    plot_energy: bool = parameter(False, doc="Energy ledger over time", group="Plots", affects="look")
    plot_tip: bool = parameter(False, doc="Height of the tip over time", group="Plots", affects="look")
    plot_errors: bool = parameter(
        False, doc="Distance of each rope from the reference over time", group="Plots", affects="look"
    )
    plot_energies: bool = parameter(False, doc="Energy of each rope over time", group="Plots", affects="look")


SHOWN = {"plot_errors": True, "plot_energies": True}


def line_up(*integrators: str, **others: Any) -> dict[str, Any]:
    """A race's preset: its methods in order, and the parameters that are not the defaults."""
    first, *rest = integrators
    named = {f"integrator_{number}": name for number, name in enumerate(rest, 2)}
    return {"ropes": len(integrators), "integrator": first, **named, **SHOWN, **others}


# 160 to 15,625 N/m, across Euler's limit at 1/60 s (437) and RK4's (8600). Softer or longer, and one meets the floor.
RISING = {"points": 5, "stiffness": 160.0, "stiffness_ratio": 2.5}

PRESETS: dict[str, dict[str, Any]] = {
    "Lab code: 10 points": {},
    "Lab scene: 50 points": {"points": 50, "time_step": 1 / 120, "drag": 0.5, "contact_damping": 10.7, "speed": 1.0},
    "Euler explodes": {"integrator": "explicit_euler"},
    "Lab's Euler": {"integrator": "symplectic_euler"},
    "Stiff rope": {
        "units": "material", "points": 60, "axial_stiffness": 2e5, "axial_viscosity": 20.0, "mass_per_length": 0.5,
        "drag_per_length": 0.2, "time_step": 2.5e-5,
    },
    "Pendulum": {
        "points": 2, "length": 1.0, "stiffness": 1e6, "damping": 0.0, "drag": 0.0, "floor": False, "time_step": 1e-3,
    },
    "Over the sphere": {"units": "material", "points": 40, "length": 4.0, "time_step": 1 / 480, "sphere": True},
    "Euler at rising stiffness": line_up(*["explicit_euler"] * 6, **RISING),
    "RK4 at the same values": line_up(*["rk4"] * 6, **RISING),
    "Euler against RK4 against leapfrog": line_up(
        "explicit_euler", "rk4", "leapfrog", race_steps="same cost", time_step=1 / 240,
    ),
    "Leapfrog read literally": line_up(
        "leapfrog", "leapfrog", "leapfrog_lagged", "leapfrog_lagged", race_steps="own steps", time_step=1 / 60,
        step_2=1 / 120, step_3=1 / 60, step_4=1 / 120,
    ),
    "Undamped until chaos": line_up(
        "symplectic_euler", "leapfrog", "implicit_midpoint", "pefrl", "rk4", race_steps="same cost",
        time_step=1 / 960, damping=0.0, drag=0.0, floor=False,
    ),
    "Stiffness without fear": line_up("implicit_euler", "tr_bdf2", "implicit_midpoint", stiffness=1e9),
}  # fmt: skip

LAB_ONLY = {"stiffness", "damping", "mass", "drag"}
MATERIAL_ONLY = {"axial_stiffness", "axial_viscosity", "mass_per_length", "drag_per_length"}

RACE_ONLY = {
    "race_steps", "stiffness_ratio", "ghost", "spacing", "plot_errors", "plot_energies",
    *(f"{what}_{number}" for what in ("integrator", "step") for number in range(2, MOST_ROPES + 1)),
}  # fmt: skip
ALONE_ONLY = {"sphere", "sphere_radius", "colour", "plot_energy", "plot_tip"}


def hidden(params: Params) -> set[str]:
    """The parameters that mean nothing with the others as they are."""
    names = set(MATERIAL_ONLY if params.units == "lab" else LAB_ONLY)
    if params.ropes == 1:
        names |= RACE_ONLY
    else:
        names |= ALONE_ONLY
        for number in range(2, MOST_ROPES + 1):
            if number > params.ropes:
                names.add(f"integrator_{number}")
            if number > params.ropes or params.race_steps != "own steps":
                names.add(f"step_{number}")
    touched = params.floor or (params.sphere and params.ropes == 1)
    if not params.sphere:
        names.add("sphere_radius")
    if not touched:
        names |= {"friction", "contact_stiffness", "contact_damping", "contact_law"}
    if params.contact_law == "lab":
        names.add("friction")
    return names


def stiffness_parameter(params: Params) -> str:
    """Name of the stiffness in force, which the map of step and stiffness is about."""
    return "stiffness" if params.units == "lab" else "axial_stiffness"


def build(params: Params, root: Vector = ROOT, sphere: Vector = SPHERE) -> Net:
    """The net that the parameters describe."""
    lab = lab_units(
        params.points,
        params.length,
        params.axial_stiffness,
        params.mass_per_length,
        params.axial_viscosity,
        params.drag_per_length,
    )
    if params.units == "lab":
        lab = {name: getattr(params, name) for name in LAB_ONLY}
    contact = Contact(params.contact_stiffness, params.contact_damping, params.friction, params.contact_law)
    return rope(
        params.points,
        params.length,
        mass=lab["mass"],
        stiffness=lab["stiffness"],
        damping=lab["damping"],
        drag=lab["drag"],
        gravity=params.gravity,
        root=root,
        floor=0.0 if params.floor else None,
        sphere=(*sphere, params.sphere_radius) if params.sphere and params.ropes == 1 else None,
        damping_model=params.damping_model,
        contact=contact,
        radius=THICKNESS,
    )
