"""The parameters that the scenes of ropes share, and the net that they describe."""

import dataclasses
from typing import Any

import numpy as np

from app.messages import Vector
from app.scenes.groups import in_look, in_main, in_rope, in_surroundings, speed_parameter
from app.scenes.springs.laws import law_parameter
from app.scenes.springs.methods import METHODS_AND_AUTO
from sim.springs import Contact, Net, lab_units, rope
from sim.springs.net import CONTACT_LAWS, DAMPING_MODELS

ROOT: Vector = (0.0, 0.0, 3.0)  # [m]
SPHERE: Vector = (-0.45, 0.12, 1.6)  # [m], a little behind the rope, so that the rope slides off in view
ROPE_RADIUS = 0.035  # [m] of the drawn rope, and of its points and links for contact


@dataclasses.dataclass(frozen=True)
class SharedRopeParams:
    """Clock, material and surroundings of a rope; the defaults are the lab's code defaults with a better integrator."""

    integrator: str = in_main("leapfrog", choices=METHODS_AND_AUTO, doc="Method of integration", title="Method")
    time_step: float = in_main(1 / 60, 1e-5, 0.1, "s", "Step h of the integrator", log_from=1e-5)
    stiffness: float = in_main(800.0, 1.0, 1e9, "N/m", "Stiffness k of a link", log_from=1.0)
    damping: float = in_main(7.0, 0.0, 1e5, "N·s/m", "Damping b of a link", log_from=1e-3)
    axial_stiffness: float = in_main(178.0, 1.0, 1e9, "N", "Stiffness EA", log_from=1.0)
    axial_viscosity: float = in_main(1.56, 0.0, 1e5, "N·s", "Damping of one metre of rope", log_from=1e-3)
    points: int = in_main(10, 2, 1000, "", "Number of points, with the root", log_from=2)

    units: str = in_rope(
        "lab", choices={"lab": "Per point and link (lab)", "material": "Per metre of rope"},
        doc="Per point and link, the rope changes with its number of points; per metre, it stays the same rope",
        title="Values",
    )  # fmt: skip
    length: float = in_rope(2.0, 0.1, 10.0, "m", "Length at rest")
    mass: float = in_rope(1.0, 1e-3, 1e3, "kg", "Mass of a point", log_from=1e-3)
    drag: float = in_rope(1.0, 0.0, 1e3, "N·s/m", "Air drag c on a point", log_from=1e-3, title="Air drag")
    mass_per_length: float = in_rope(
        4.5, 1e-3, 1e3, "kg/m", "Mass per metre of rope", log_from=1e-3, title="Mass per metre"
    )
    drag_per_length: float = in_rope(
        4.5, 0.0, 1e3, "N·s/m²", "Air drag per metre of rope", log_from=1e-3, title="Drag per metre"
    )
    law: str = law_parameter("Rope")
    damping_model: str = in_rope(
        "isotropic", choices={DAMPING_MODELS[0]: "Isotropic (lab eq. 2)", DAMPING_MODELS[1]: "Along the link"},
        doc="Isotropic: b acts on the whole relative velocity, as in the lab. Or on its part along the link only",
    )  # fmt: skip

    gravity: float = in_surroundings(10.0, 0.0, 100.0, "m/s²", "Gravity, downwards")
    floor: bool = in_surroundings(True, doc="Floor at height 0")
    friction: float = in_surroundings(0.3, 0.0, 2.0, "", "Coefficient of Coulomb friction")
    contact_stiffness: float = in_surroundings(800.0, 1.0, 1e7, "N/m", "Stiffness of floor and sphere", log_from=1.0)
    contact_damping: float = in_surroundings(5.0, 0.0, 1e4, "N·s/m", "Damping of floor and sphere", log_from=1e-2)
    contact_law: str = in_surroundings(
        "clipped", choices={CONTACT_LAWS[0]: "Pushes only, with friction", CONTACT_LAWS[1]: "Lab's law (may stick)"},
        doc="The lab's own law may also pull, and its friction is viscous",
    )  # fmt: skip
    root_swing: float = in_main(0.0, 0.0, 1.0, "m", "Amplitude of the root's motion to and fro; 0 is off")
    swing_period: float = in_main(1.0, 0.2, 10.0, "s", "Period of the root's motion to and fro")
    pull: float = in_surroundings(
        300.0, 1.0, 1e5, "N", "Largest force with which the mouse pulls a point", log_from=1.0, title="Mouse force"
    )

    speed: float = speed_parameter(0.01, 8.0)

    show_points: bool = in_look(True, doc="Draw the points, which can be dragged")
    grid: bool = in_look(True, doc="Lines on the floor (key G)")
    handles: bool = in_look(True, doc="Arrows that move the root and the sphere")


LAB_ONLY = {"stiffness", "damping", "mass", "drag"}
MATERIAL_ONLY = {"axial_stiffness", "axial_viscosity", "mass_per_length", "drag_per_length"}


def hidden_of_rope(params: SharedRopeParams, *, sphere: bool, touches_itself: bool = False) -> set[str]:
    """The shared parameters that mean nothing with the others as they are. sphere: whether there is one."""
    names = set(MATERIAL_ONLY if params.units == "lab" else LAB_ONLY)
    if not (params.floor or sphere or touches_itself):
        names |= {"friction", "contact_stiffness", "contact_damping", "contact_law"}
    if params.root_swing == 0.0:
        names.add("swing_period")
    if params.contact_law == "lab":
        names.add("friction")
    return names


def stiffness_parameter(params: SharedRopeParams) -> str:
    """Name of the stiffness parameter in use, for the map of step and stiffness."""
    return "stiffness" if params.units == "lab" else "axial_stiffness"


def link_and_point(params: SharedRopeParams) -> dict[str, Any]:
    """Stiffness [N/m] and damping [N s/m] of a link, air drag [N s/m] of a point, and mass [kg] of one or of each."""
    if params.units == "lab":
        return {name: getattr(params, name) for name in LAB_ONLY}
    p = params
    return lab_units(p.points, p.length, p.axial_stiffness, p.mass_per_length, p.axial_viscosity, p.drag_per_length)


def build_rope(
    params: SharedRopeParams,
    root: Vector = ROOT,
    sphere: tuple[float, float, float, float] | None = None,
    *,
    self_contact: bool = False,
    of_tasks: bool = False,
) -> Net:
    """The net that the parameters describe, with its root at `root` [m]. sphere: (x, y, z, radius) [m], or None.

    self_contact: links touch each other. of_tasks: only what the tasks' functions have: points that touch, and equal
    masses.
    """
    lab = link_and_point(params)
    p = params
    contact = Contact(p.contact_stiffness, p.contact_damping, p.friction, p.contact_law, not of_tasks)
    return rope(
        params.points,
        params.length,
        mass=float(np.max(lab["mass"])) if of_tasks else lab["mass"],
        stiffness=lab["stiffness"],
        damping=lab["damping"],
        drag=lab["drag"],
        gravity=params.gravity,
        root=root,
        floor=0.0 if params.floor else None,
        sphere=sphere,
        damping_model=params.damping_model,
        law=params.law,
        contact=contact,
        radius=ROPE_RADIUS,
        self_contact=self_contact and not of_tasks,
    )
