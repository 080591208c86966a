"""The parameters of the cloth, and its presets."""

import dataclasses
from typing import Any

from app.scenes.springs.laws import law_parameter
from app.scenes.springs.methods import METHODS_AND_AUTO
from sim.parameters import parameter
from sim.springs.cloth import PIN_CHOICES

# Up to this number of particles the energy account is always kept. It costs 2 to 6 % of a leapfrog step of the presets,
# but 164 % of a step of the drape (64 x 64, symplectic Euler), which would then no longer run in real time.
MAX_ACCOUNTED_PARTICLES = 2500


@dataclasses.dataclass(frozen=True)
class Params:
    """The cloth's parameters."""

    integrator: str = parameter(
        "leapfrog", choices=METHODS_AND_AUTO, doc="Method of integration", group="Main", title="Method"
    )
    time_step: float = parameter(1 / 1800, 1e-5, 0.05, "s", "Step h of the integrator", log_from=1e-5, group="Main")
    stiffness: float = parameter(
        800.0, 1.0, 1e5, "N/m", "Stiffness of the structural springs, to the next particle", log_from=1.0, group="Main"
    )
    damping: float = parameter(0.02, 0.0, 1.0, "N·s/m", "Damping of every spring", log_from=1e-4, group="Main")
    wind: float = parameter(1.5, 0.0, 25.0, "m/s", "Wind speed", group="Main")
    sphere: bool = parameter(False, doc="A sphere; drag its arrows to move it", group="Main")

    start: str = parameter(
        "hanging",
        choices={"hanging": "Hanging", "level": "Level", "flag": "Flag on a pole"},
        doc="How the cloth starts",
        group="Cloth",
        affects="start",
    )
    pinned: str = parameter("edge", choices=PIN_CHOICES, doc="Which particles are pinned", group="Cloth")
    rows: int = parameter(32, 4, 128, "", "Particles down the cloth", group="Cloth")
    cols: int = parameter(32, 4, 128, "", "Particles across the cloth", group="Cloth", title="Columns")
    width: float = parameter(1.6, 0.2, 4.0, "m", "Width at rest", group="Cloth")
    length: float = parameter(1.6, 0.2, 4.0, "m", "Length at rest", group="Cloth")
    gather: float = parameter(
        0.62,
        0.4,
        1.0,
        "",
        "Width of the hanging cloth at the start over its width at rest: below 1 it hangs in pleats",
        group="Cloth",
        affects="start",
        title="Pleats",
    )
    density: float = parameter(
        0.3, 0.02, 5.0, "kg/m²", "Mass per square metre", log_from=0.02, group="Cloth", title="Mass"
    )
    shear: float = parameter(
        200.0,
        0.0,
        1e5,
        "N/m",
        "Stiffness of the shear springs, across a cell",
        log_from=1.0,
        group="Main",
        title="Shear stiffness",
    )
    bend: float = parameter(
        6.0,
        0.0,
        1e4,
        "N/m",
        "Stiffness of the bend springs, to the next particle but one",
        log_from=0.1,
        group="Main",
        title="Bend stiffness",
    )
    law: str = law_parameter("Cloth")
    thickness: float = parameter(
        0.0,
        0.0,
        0.1,
        "m",
        "Particles of the cloth that come nearer to each other than this are pushed apart; 0 is off",
        group="Cloth",
        title="Self-collision distance",
    )

    gravity: float = parameter(9.81, 0.0, 30.0, "m/s²", "Gravity, downwards", group="Surroundings")
    wind_direction: float = parameter(
        90.0, -180.0, 180.0, "°", "Where the wind goes to, from +x towards +y", group="Surroundings"
    )
    gust: float = parameter(
        0.5, 0.0, 1.0, "", "Strength of the gusts; 0 is a steady wind", group="Surroundings", title="Gusts"
    )
    air: float = parameter(
        1.2, 0.0, 5.0, "kg/m³", "Density of the air; 0 is no air", group="Surroundings", title="Air density"
    )
    floor: bool = parameter(True, doc="Floor at height 0", group="Surroundings")
    sphere_radius: float = parameter(0.4, 0.05, 1.5, "m", "Radius of the sphere", group="Surroundings")
    bob: float = parameter(
        0.0, 0.0, 1.0, "m", "Amplitude of the sphere's motion up and down", group="Surroundings", title="Sphere stroke"
    )
    friction: float = parameter(0.4, 0.0, 2.0, "", "Coefficient of Coulomb friction", group="Surroundings")
    contact_stiffness: float = parameter(
        300.0, 1.0, 1e5, "N/m", "Stiffness of floor, sphere and self-collision", log_from=1.0, group="Surroundings"
    )
    contact_damping: float = parameter(
        0.2, 0.0, 100.0, "N·s/m", "Damping of floor, sphere and self-collision", log_from=1e-3, group="Surroundings"
    )
    pull: float = parameter(
        8.0,
        0.1,
        1e3,
        "N",
        "Largest force with which the mouse pulls the cloth",
        log_from=0.1,
        group="Surroundings",
        title="Mouse force",
    )

    speed: float = parameter(
        1.0, 0.01, 4.0, "", "Simulated time over real time: 0.1 is slow motion", log_from=0.01, group="Time",
        affects="look",
    )  # fmt: skip

    colour: str = parameter(
        "fabric",
        choices={"fabric": "Fabric", "strain": "Strain"},
        doc="What the colour of the cloth shows",
        group="Look",
        affects="look",
    )
    full_strain: float = parameter(
        5.0,
        0.1,
        100.0,
        "%",
        "Strain at the end of the colour scale",
        log_from=0.1,
        group="Look",
        affects="look",
        title="Strain scale",
    )
    grid: bool = parameter(True, doc="Lines on the floor (key G)", group="Look", affects="look")
    handles: bool = parameter(True, doc="Arrows that move the pins and the sphere", group="Look", affects="look")
    plot_energy: bool = parameter(
        False,
        doc=f"Energies over time; above {MAX_ACCOUNTED_PARTICLES} particles they are recorded once the plot is open",
        group="Plots",
        affects="look",
        title="Energy",
    )
    plot_strain: bool = parameter(
        False, doc="Largest strain over time", group="Plots", affects="look", title="Largest strain"
    )


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
}  # fmt: skip

ABOUT = {  # preset -> what it shows and what to try
    "Curtain": "A curtain hangs from its upper edge: pull it, or turn the wind up.",
    "Flag in wind": "A flag in gusty wind: turn the wind down until it hangs.",
    "Drape over the sphere": "A loose cloth falls over a sphere: move the sphere by its arrows.",
    "Trampoline": "A sphere moves up and down in a cloth held at its rim: see where it stretches most.",
}


def hidden(params: Params) -> set[str]:
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
