"""The parameters of the cloth, and its presets."""

import dataclasses
import functools
from typing import Any

from app.scenes.groups import in_look, in_main, in_plots, in_surroundings, speed_parameter
from app.scenes.springs.laws import law_parameter
from app.scenes.springs.methods import METHODS_AND_AUTO
from sim.parameters import parameter
from sim.springs.cloth import PIN_CHOICES

# Up to this number of particles the energy account is always kept. It costs 2 to 6 % of a leapfrog step of the presets,
# but 164 % of a step of the drape (64 x 64, symplectic Euler), which would then no longer run in real time.
MAX_ACCOUNTED_PARTICLES = 2500
in_cloth = functools.partial(parameter, group="Cloth")


@dataclasses.dataclass(frozen=True)
class ClothParams:
    """The cloth's parameters."""

    integrator: str = in_main("leapfrog", choices=METHODS_AND_AUTO, doc="Method of integration", title="Method")
    time_step: float = in_main(1 / 1800, 1e-5, 0.05, "s", "Step h of the integrator", log_from=1e-5)
    stiffness: float = in_main(
        800.0, 1.0, 1e5, "N/m", "Stiffness of the structural springs, to the next particle", log_from=1.0
    )
    damping: float = in_main(0.02, 0.0, 1.0, "N·s/m", "Damping of every spring", log_from=1e-4)
    wind: float = in_main(1.5, 0.0, 25.0, "m/s", "Wind speed")
    sphere: bool = in_main(False, doc="A sphere; drag its arrows to move it")

    start: str = in_cloth(
        "hanging", choices={"hanging": "Hanging", "level": "Level", "flag": "Flag on a pole"},
        doc="Shape of the cloth at the start", affects="start",
    )  # fmt: skip
    pinned: str = in_cloth("edge", choices=PIN_CHOICES, doc="Pinned particles")
    rows: int = in_cloth(32, 4, 128, "", "Particles down the cloth")
    cols: int = in_cloth(32, 4, 128, "", "Particles across the cloth", title="Columns")
    width: float = in_cloth(1.6, 0.2, 4.0, "m", "Width at rest")
    length: float = in_cloth(1.6, 0.2, 4.0, "m", "Length at rest")
    gather: float = in_cloth(
        0.62, 0.4, 1.0, "",
        "Width of the hanging cloth at the start over its width at rest: below 1 it hangs in pleats", affects="start",
        title="Pleats",
    )  # fmt: skip
    density: float = in_cloth(0.3, 0.02, 5.0, "kg/m²", "Mass per square metre", log_from=0.02, title="Mass")
    shear: float = in_main(
        200.0, 0.0, 1e5, "N/m", "Stiffness of the shear springs, across a cell", log_from=1.0, title="Shear stiffness"
    )
    bend: float = in_main(
        6.0, 0.0, 1e4, "N/m", "Stiffness of the bend springs, to the next particle but one", log_from=0.1,
        title="Bend stiffness",
    )  # fmt: skip
    law: str = law_parameter("Cloth")
    thickness: float = in_cloth(
        0.0, 0.0, 0.1, "m",
        "Particles of the cloth closer than this are pushed apart; 0 is off",
        title="Self-collision distance",
    )  # fmt: skip

    gravity: float = in_surroundings(9.81, 0.0, 30.0, "m/s²", "Gravity, downwards")
    wind_direction: float = in_surroundings(
        90.0, -180.0, 180.0, "°", "Direction that the wind blows to, from +x towards +y"
    )
    gust: float = in_surroundings(0.5, 0.0, 1.0, "", "Strength of the gusts; 0 is a steady wind", title="Gusts")
    air: float = in_surroundings(1.2, 0.0, 5.0, "kg/m³", "Density of the air; 0 is no air", title="Air density")
    floor: bool = in_surroundings(True, doc="Floor at height 0")
    sphere_radius: float = in_surroundings(0.4, 0.05, 1.5, "m", "Radius of the sphere")
    bob: float = in_surroundings(
        0.0, 0.0, 1.0, "m", "Amplitude of the sphere's motion up and down", title="Sphere stroke"
    )
    friction: float = in_surroundings(0.4, 0.0, 2.0, "", "Coefficient of Coulomb friction")
    contact_stiffness: float = in_surroundings(
        300.0, 1.0, 1e5, "N/m", "Stiffness of floor, sphere and self-collision", log_from=1.0
    )
    contact_damping: float = in_surroundings(
        0.2, 0.0, 100.0, "N·s/m", "Damping of floor, sphere and self-collision", log_from=1e-3
    )
    pull: float = in_surroundings(
        8.0,
        0.1,
        1e3,
        "N",
        "Largest force with which the mouse pulls the cloth; at least twice its weight",
        log_from=0.1,
        title="Mouse force",
    )

    speed: float = speed_parameter(0.01, 4.0)

    colour: str = in_look(
        "fabric", choices={"fabric": "Fabric", "strain": "Strain"}, doc="Quantity shown by the colour of the cloth"
    )
    full_strain: float = in_look(
        5.0, 0.1, 100.0, "%", "Strain at the end of the colour scale", log_from=0.1, title="Strain scale"
    )
    grid: bool = in_look(True, doc="Lines on the floor (key G)")
    handles: bool = in_look(True, doc="Arrows that move the pins and the sphere")
    plot_energy: bool = in_plots(
        False,
        doc="Energies over time",
        title="Energy",
    )
    plot_losses: bool = in_plots(
        False,
        doc=f"Energy dissipated by damping; above {MAX_ACCOUNTED_PARTICLES} particles since the plot was opened",
        title="Dissipated energy",
    )  # fmt: skip
    plot_strain: bool = in_plots(False, doc="Largest strain over time", title="Largest strain")


PRESETS: dict[str, dict[str, Any]] = {
    "Curtain": {},
    "Flag in wind": {
        "start": "flag", "rows": 48, "cols": 32, "width": 1.0, "length": 1.6, "density": 0.15, "wind": 8.0,
        "wind_direction": 14.0, "bend": 1.0, "shear": 100.0, "damping": 0.005, "full_strain": 1.0, "gust": 0.6,
        "time_step": 1 / 4200,
    },
    "Drape over the sphere": {
        "start": "level", "pinned": "free", "rows": 64, "cols": 64, "sphere": True, "thickness": 0.02, "bend": 3.0,
        "integrator": "symplectic_euler", "time_step": 1 / 4800, "damping": 0.01, "wind": 0.0, "full_strain": 2.0,
        "contact_stiffness": 60.0, "contact_damping": 0.08,  # a corner has a quarter of a particle's mass
    },
    "Trampoline": {
        "start": "level", "pinned": "rim", "rows": 48, "cols": 48, "sphere": True, "sphere_radius": 0.25, "bob": 0.45,
        "damping": 0.005, "full_strain": 20.0, "time_step": 1 / 3600, "friction": 0.0, "density": 0.4, "wind": 0.0,
    },
    "Tablecloth": {
        "start": "level", "pinned": "free", "rows": 32, "cols": 32, "sphere": True, "sphere_radius": 0.5,
        "thickness": 0.04, "bend": 3.0, "integrator": "symplectic_euler", "time_step": 1 / 1920, "damping": 0.01,
        "wind": 0.0, "full_strain": 2.0, "contact_stiffness": 60.0, "contact_damping": 0.08, "friction": 0.3,
    },
}  # fmt: skip

ABOUT = {  # preset -> what it shows and what to try
    "Curtain": "A curtain hangs from its upper edge: pull it, or turn the wind up.",
    "Flag in wind": "A flag in gusty wind: turn the wind down until it hangs.",
    "Drape over the sphere": "A loose cloth falls over a sphere: move the sphere by its arrows.",
    "Trampoline": "A sphere moves up and down in a cloth held at its rim: see where it stretches most.",
    "Tablecloth": "Friction holds the cloth on the sphere: pull a corner until it slides off.",
}


def hidden(params: ClothParams) -> set[str]:
    """The parameters that mean nothing with the others as they are."""
    names: set[str] = set()
    if params.start != "hanging":
        names.add("gather")
    if params.wind == 0.0 or params.air == 0.0:
        names |= {"wind_direction", "gust"}
    if not params.sphere:
        names |= {"sphere_radius", "bob"}
    if not (params.sphere or params.floor):
        names.add("friction")
        if params.thickness == 0.0:
            names |= {"contact_stiffness", "contact_damping"}
    if params.colour != "strain":
        names.add("full_strain")
    return names
