"""The rope's parameters and presets."""

import dataclasses
from typing import Any

from app.scenes.groups import in_look, in_main, in_plots, in_rope, in_surroundings
from app.scenes.springs.rope_parameters import SharedRopeParams, hidden_of_rope
from sim.parameters import parameter


@dataclasses.dataclass(frozen=True)
class RopeParams(SharedRopeParams):
    """The rope's parameters."""

    sphere: bool = in_main(False, doc="A sphere; drag its arrows to move it")
    sphere_radius: float = in_surroundings(0.75, 0.05, 3.0, "m", "Radius of the sphere")

    self_contact: bool = in_main(
        False, doc="Links push each other apart and rub: no strand passes another", title="Touches itself"
    )
    start: str = parameter(
        "level",
        choices={
            "level": "Level from the root", "hanging": "Hanging", "over": "Over the sphere", "knot": "In a loose knot"
        },
        doc="Shape in which the rope begins", group="Rope", affects="start",
    )  # fmt: skip
    end_held: bool = parameter(False, doc="The last point stays where it begins", group="Rope", affects="start")
    tip_mass: float = in_rope(0.0, 0.0, 1e3, "kg", "Weight at the last point", log_from=1e-2, title="Weight at the tip")

    colour: str = in_look(
        "tension",
        choices={"tension": "Tension", "plain": "One colour"},
        doc="Quantity shown by the colour of the rope",
    )
    plot_energy: bool = in_plots(False, doc="Energies over time", title="Energy")
    plot_losses: bool = in_plots(
        False,
        doc="Energy dissipated by damping since the start, and the numerical error",
        title="Dissipated energy",
    )
    plot_tip: bool = in_plots(False, doc="Height of the last point over time", title="Height of the tip")
    plot_along: bool = in_plots(
        False,
        doc="Tension from the root to the tip, and the most that friction on the sphere lets the root hold",
        title="Tension along the rope",
    )


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
    "Shaken at the root": {
        "points": 30, "stiffness": 8000.0, "mass": 0.3, "damping": 1.0, "drag": 0.1, "time_step": 1 / 480,
        "root_swing": 0.2, "swing_period": 1.05,
    },
    "Capstan": {
        "units": "material", "points": 50, "length": 2.6, "axial_stiffness": 1500.0, "axial_viscosity": 3.0,
        "mass_per_length": 0.3, "drag_per_length": 0.3, "contact_stiffness": 1e4, "contact_damping": 5.0,
        "time_step": 1 / 2400, "sphere": True, "sphere_radius": 0.4, "start": "over", "tip_mass": 5.0,
        "plot_along": True,
    },
    "Knot": {
        "units": "material", "points": 80, "length": 4.0, "axial_stiffness": 500.0, "axial_viscosity": 2.0,
        "mass_per_length": 2.0, "drag_per_length": 1.0, "contact_stiffness": 1e4, "contact_damping": 10.0,
        "time_step": 1 / 960, "self_contact": True, "start": "knot", "end_held": True,
    },
    "Coil": {
        "units": "material", "points": 80, "length": 2.9, "axial_stiffness": 500.0, "axial_viscosity": 2.0,
        "mass_per_length": 2.0, "drag_per_length": 1.0, "contact_stiffness": 1e4, "contact_damping": 10.0,
        "time_step": 1 / 1440, "self_contact": True, "start": "hanging",
    },
}  # fmt: skip

ABOUT = {  # preset -> what it shows and what to try
    "Lab code: 10 points": "The rope of the course lab: raise the stiffness until it trembles.",
    "Lab scene: 50 points": "Fifty points, as in the pictures of the course lab, in real time.",
    "Euler explodes": "Explicit Euler adds energy in each step: see how long the rope lasts.",
    "Lab's Euler": "Symplectic Euler, the method of the lab code, stays stable at the same step.",
    "Stiff rope": "Sixty points on stiff springs hardly stretch, and need 40 000 steps a second.",
    "Pendulum": "One point on a stiff spring: compare its period with that of a pendulum of 1 m.",
    "Over the sphere": "The rope falls over a sphere: move the sphere by its arrows.",
    "Shaken at the root": "The root swings to and fro: find the period at which the rope swings most.",
    "Capstan": "Friction on the sphere carries part of the weight: raise the root until the rope slips.",
    "Knot": "A loose knot, its ends held: pull one of them away from the other, and the knot tightens.",
    "Coil": "Lower the root by its arrow: the rope lies down on the floor, strand on strand.",
}


def hidden(params: RopeParams) -> set[str]:
    """The parameters that mean nothing with the others as they are."""
    names = hidden_of_rope(params, sphere=params.sphere, touches_itself=params.self_contact)
    if not params.sphere:
        names |= {"sphere_radius", "plot_along"}
    return names
