"""The parameters of the cloth, and its presets."""

import dataclasses
import math
from typing import Any

from sim.parameters import parameter
from sim.springs import INTEGRATORS
from sim.springs.cloth import PIN_CHOICES

STARTS = ("hanging", "level", "flag")
# Up to this number of particles the energy account is always kept. It costs 2 to 6 % of a leapfrog step of the presets,
# but 164 % of a step of the drape (64 x 64, symplectic Euler), which would then no longer run in real time.
MAX_ACCOUNTED_PARTICLES = 2500


@dataclasses.dataclass(frozen=True)
class Params:
    """The cloth's parameters."""

    integrator: str = parameter("leapfrog", choices=tuple(INTEGRATORS), doc="Method of integration", group="Time")
    time_step: float = parameter(1 / 2400, 1e-5, 0.05, "s", "Step h of the integrator", log_from=1e-5, group="Time")
    speed: float = parameter(
        1.0, 0.01, 4.0, "", "Simulated time over real time", log_from=0.01, group="Time", affects="look"
    )

    start: str = parameter(
        "hanging",
        choices=STARTS,
        doc="How it starts: below its first row, level, or from a pole",
        group="Cloth",
        affects="start",
    )
    pinned: str = parameter(
        "edge", choices=PIN_CHOICES, doc="What is pinned: corners, an edge, the rim, nothing", group="Cloth"
    )
    rows: int = parameter(32, 4, 128, "", "Particles down the cloth", group="Cloth")
    cols: int = parameter(32, 4, 128, "", "Particles across the cloth", group="Cloth")
    width: float = parameter(1.6, 0.2, 4.0, "m", "Width at rest", group="Cloth")
    length: float = parameter(1.6, 0.2, 4.0, "m", "Length at rest", group="Cloth")
    gather: float = parameter(
        0.62,
        0.4,
        1.0,
        "",
        "Width of a hanging cloth at the start, in pleats, over its width at rest",
        group="Cloth",
        affects="start",
    )
    density: float = parameter(0.3, 0.02, 5.0, "kg/m^2", "Mass per square metre", log_from=0.02, group="Cloth")
    stiffness: float = parameter(
        800.0, 1.0, 1e5, "N/m", "Structural springs, to the next particle", log_from=1.0, group="Cloth"
    )
    shear: float = parameter(200.0, 0.0, 1e5, "N/m", "Shear springs, across a cell", log_from=1.0, group="Cloth")
    bend: float = parameter(
        6.0, 0.0, 1e4, "N/m", "Bend springs, to the next particle but one", log_from=0.1, group="Cloth"
    )
    damping: float = parameter(0.02, 0.0, 1.0, "N s/m", "Damping of every spring", log_from=1e-4, group="Cloth")

    gravity: float = parameter(9.81, 0.0, 30.0, "m/s^2", "Gravity, downwards", group="Surroundings")
    wind: float = parameter(1.5, 0.0, 25.0, "m/s", "Speed of the wind", group="Surroundings")
    wind_direction: float = parameter(
        math.pi / 2, -math.pi, math.pi, "rad", "Where the wind goes to, from +x towards +y", group="Surroundings"
    )
    gust: float = parameter(0.5, 0.0, 1.0, "", "Strength of the gusts", group="Surroundings")
    air: float = parameter(1.2, 0.0, 5.0, "kg/m^3", "Density of the air; 0: no air", group="Surroundings")
    floor: bool = parameter(True, doc="Floor at height 0", group="Surroundings")
    sphere: bool = parameter(False, doc="Sphere, which arrows move", group="Surroundings")
    sphere_radius: float = parameter(0.4, 0.05, 1.5, "m", "Radius of the sphere", group="Surroundings")
    bob: float = parameter(0.0, 0.0, 1.0, "m", "Amplitude of the sphere's motion up and down", group="Surroundings")
    friction: float = parameter(0.4, 0.0, 2.0, "", "Coulomb friction coefficient", group="Surroundings")
    contact_stiffness: float = parameter(
        300.0, 1.0, 1e5, "N/m", "Contact stiffness", log_from=1.0, group="Surroundings"
    )
    contact_damping: float = parameter(0.2, 0.0, 100.0, "N s/m", "Contact damping", log_from=1e-3, group="Surroundings")
    thickness: float = parameter(
        0.0,
        0.0,
        0.1,
        "m",
        "Particles nearer than this push each other; 0: the cloth passes through itself",
        group="Surroundings",
    )
    pull: float = parameter(8.0, 0.1, 1e3, "N", "Largest force of a drag", log_from=0.1, group="Surroundings")

    colour: str = parameter(
        "strain", choices=("strain", "plain"), doc="What the cloth's colour shows", group="Look", affects="look"
    )
    full_strain: float = parameter(
        5.0, 0.1, 100.0, "%", "Strain at the end of the colour scale", log_from=0.1, group="Look", affects="look"
    )
    grid: bool = parameter(True, doc="Lines on the floor", group="Look", affects="look")
    plot_energy: bool = parameter(
        False,
        doc=f"Energy account over time; above {MAX_ACCOUNTED_PARTICLES} particles it begins when the plot is opened",
        group="Plots",
        affects="look",
    )
    plot_strain: bool = parameter(False, doc="Largest strain over time", group="Plots", affects="look")


PRESETS: dict[str, dict[str, Any]] = {
    "Curtain": {},
    "Flag in wind": {
        "start": "flag", "rows": 48, "cols": 32, "width": 1.0, "length": 1.6, "density": 0.15, "wind": 8.0,
        "wind_direction": 0.25, "bend": 1.0, "shear": 100.0, "damping": 0.005, "full_strain": 1.0, "gust": 0.6,
        "time_step": 1 / 4200,
    },
    "Drape over the sphere": {
        "start": "level", "pinned": "free", "rows": 64, "cols": 64, "sphere": True, "thickness": 0.02, "bend": 3.0,
        "integrator": "symplectic_euler", "time_step": 1 / 4800, "damping": 0.01, "wind": 0.0, "full_strain": 2.0,
    },
    "Trampoline": {
        "start": "level", "pinned": "rim", "rows": 48, "cols": 48, "sphere": True, "sphere_radius": 0.25, "bob": 0.45,
        "damping": 0.005, "full_strain": 20.0, "time_step": 1 / 3600, "friction": 0.0, "density": 0.4, "wind": 0.0,
    },
}  # fmt: skip


def hidden(params: Params) -> set[str]:
    """The parameters that mean nothing with the others as they are."""
    names: set[str] = set()
    if params.start != "hanging":
        names.add("gather")
    if params.wind == 0.0:
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
