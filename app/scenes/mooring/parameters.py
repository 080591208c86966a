"""The mooring's parameters and presets."""

import dataclasses
import functools
from typing import Any

from app.scenes.groups import in_look, in_main, in_plots, speed_parameter
from app.scenes.springs.methods import METHODS
from sim.parameters import parameter, parameters_of
from sim.springs import INTEGRATORS

EXPLICIT = {
    name: METHODS[name] for name in METHODS if not (INTEGRATORS[name].implicit or INTEGRATORS[name].undamped_only)
}
MAX_LINES = 4
in_body = functools.partial(parameter, group="Body")
in_line = functools.partial(parameter, group="Line")
in_sea = functools.partial(parameter, group="Sea")


@dataclasses.dataclass(frozen=True)
class MooringParams:
    """The mooring's parameters; the defaults are a buoy on three chains."""

    lines: int = in_main(
        3, 1, MAX_LINES, "", "Number of lines, spread evenly; the first points into the waves", affects="start"
    )
    length: float = in_main(96.0, 2.0, 1000.0, "m", "Length of each line, unstretched", log_from=2.0, affects="start")
    reach: float = in_main(
        80.0, 0.5, 900.0, "m", "Horizontal distance from the body to each anchor", log_from=0.5, affects="start",
        title="Distance of anchors",
    )  # fmt: skip
    depth: float = in_main(40.0, 2.0, 500.0, "m", "Depth of the water", log_from=2.0, affects="start")
    wave_height: float = in_main(4.0, 0.0, 20.0, "m", "Significant height of the waves; the height of a regular wave")
    wave_period: float = in_main(8.0, 1.0, 25.0, "s", "Period of the highest waves")
    integrator: str = in_main("leapfrog", choices=EXPLICIT, doc="Method of integration", title="Method")
    time_step: float = in_main(1 / 480, 1e-5, 0.1, "s", "Step h of the integrator", log_from=1e-5)

    diameter: float = in_line(0.09, 0.003, 0.5, "m", "Diameter of a rope with the volume of the line", log_from=0.003)
    line_mass: float = in_line(
        80.0, 0.01, 1000.0, "kg/m", "Mass per metre of line, in air", log_from=0.01, title="Mass per metre"
    )
    axial_stiffness: float = in_line(5e7, 1e3, 1e10, "N", "Stiffness EA of a line", log_from=1e3, title="Stiffness EA")
    breaking_load: float = in_line(
        3450.0, 0.0, 1e5, "kN", "Breaking load; tensions are also shown as a percentage of it. 0: unknown",
        log_from=1.0, affects="look",
    )  # fmt: skip
    line_damping: float = in_line(
        0.8, 0.0, 2.0, "", "Axial damping of a segment, as a fraction of critical", title="Internal damping"
    )
    drag_across: float = in_line(1.6, 0.0, 5.0, "", "Drag coefficient across the line")
    drag_along: float = in_line(0.1, 0.0, 2.0, "", "Drag coefficient along the line")
    added_mass: float = in_line(1.0, 0.0, 5.0, "", "Added mass coefficient across the line")
    floats: bool = in_line(False, doc="Floats on a part of each line", affects="start")
    lift: float = in_line(
        300.0, 0.0, 5000.0, "N/m", "Upward force of the part with floats, per metre", affects="start",
        title="Lift of floats",
    )  # fmt: skip
    segments: int = in_line(40, 4, 100, "", "Segments of each line", log_from=4, affects="start")

    body: str = in_body(
        "buoy", choices={"buoy": "Buoy", "box": "Box"}, doc="Shape of the floating body", affects="start"
    )
    size: float = in_body(9.0, 0.5, 40.0, "m", "Width of the body", log_from=0.5, affects="start")
    density: float = in_body(450.0, 100.0, 900.0, "kg/m³", "Density of the body", affects="start")
    pull: float = in_body(
        1.0, 0.05, 5.0, "", "Largest force with which the mouse pulls the body, over its weight", affects="look",
        title="Mouse force",
    )  # fmt: skip

    regular: bool = in_sea(False, doc="One regular wave instead of many waves", title="Regular wave")
    direction: float = in_sea(
        0.0, -180.0, 180.0, "°", "Direction of waves, current and steady force, from +x towards +y"
    )
    current: float = in_sea(0.0, 0.0, 4.0, "m/s", "Speed of the water, the same at all depths")
    steady_force: float = in_sea(0.0, 0.0, 5000.0, "kN", "Force of the wind on the body", log_from=0.1)
    follow: float = in_sea(
        1.0, 0.0, 1.0, "", "Motion of the vessel over that of the water at its place; 0 holds it",
        title="Vessel follows waves",
    )  # fmt: skip
    friction: float = in_sea(0.3, 0.0, 2.0, "", "Coefficient of friction of the bed")

    speed: float = speed_parameter(0.01, 8.0)

    surface: bool = in_look(True, doc="The water's surface")
    watch: bool = in_look(
        True, doc="Path of the body, and the smallest circle that holds it (drags excluded)", title="Watch circle"
    )
    handles: bool = in_look(True, doc="Arrows that move anchors and fairleads")
    grid: bool = in_look(True, doc="Lines on the bed (key G)")
    plot_tension: bool = in_plots(
        False, doc="Tension at the fairlead of each line over time, and the largest", title="Tension"
    )
    plot_anchor: bool = in_plots(False, doc="Tension at the anchor of each line over time", title="Tension at anchors")
    plot_offset: bool = in_plots(
        False, doc="Horizontal distance of the body from its rest position, over time", title="Offset"
    )
    plot_restoring: bool = in_plots(
        False, doc="Static force of all lines over the offset, and the force now", title="Restoring force"
    )
    moordyn_file: str = ""  # a MoorDyn file; it is named on the command line only, never by a browser
    file_changes: tuple[tuple[str, str, float], ...] = ()  # of that file: "length" or "diameter", of what, and [m]


# Breaking loads: studless chain of grade R3, 0.0223 d² (44 - 0.08 d) kN with d in mm (DNV-OS-E302) and 19.9 d² t/m;
# polyester rope, 170466 d² kN with d in m and 0.7978 d² t/m (OrcaFlex, line type wizard).
ROPE: dict[str, Any] = {
    "diameter": 0.12, "line_mass": 11.0, "axial_stiffness": 5e6, "breaking_load": 2350.0, "line_damping": 0.1,
    "drag_across": 1.2, "drag_along": 0.05,
}  # fmt: skip

PRESETS: dict[str, dict[str, Any]] = {
    "Chain catenary": {},
    "Taut ropes": {**ROPE, "length": 71.8, "reach": 60.0, "depth": 50.0, "wave_height": 2.0, "segments": 24},
    "Four-point spread": {
        "lines": 4, "body": "box", "size": 12.0, "direction": 45.0, "length": 122.0, "reach": 105.0,
        "current": 0.5, "steady_force": 40.0,
    },
    "Snap in a storm": {
        **ROPE, "lines": 1, "length": 47.0, "reach": 25.0, "wave_height": 9.0, "wave_period": 11.0,
        "steady_force": 20.0, "size": 6.0, "plot_tension": True, "segments": 16,
    },
    "Lazy wave with floats": {
        "lines": 1, "length": 150.0, "reach": 90.0, "depth": 60.0, "diameter": 0.15, "line_mass": 35.0,
        "axial_stiffness": 2e7, "breaking_load": 0.0, "floats": True, "lift": 350.0, "steady_force": 8.0,
        "drag_across": 1.2,
    },
    "The lab's buoy": {
        "lines": 1, "size": 1.8, "depth": 8.0, "reach": 6.0, "length": 11.5, "diameter": 0.02, "line_mass": 4.0,
        "axial_stiffness": 1e6, "breaking_load": 190.0, "wave_height": 0.6, "wave_period": 3.0, "steady_force": 0.2,
        "time_step": 1 / 1000, "segments": 16,
    },
}  # fmt: skip

ABOUT = {  # preset -> what it shows and what to try
    "Chain catenary": "A buoy on three chains: watch the touchdown points on the bed move with the waves.",
    "Taut ropes": "Light ropes under tension hold the body by their stretch: compare the offset with that of chains.",
    "Four-point spread": "A box on four chains in a current: drag one anchor away and watch the other tensions.",
    "Snap in a storm": "One rope goes slack in high waves and snaps taut: see the peaks of its tension.",
    "Lazy wave with floats": "Floats lift a part of the line, so that the bed end hardly feels the waves.",
    "The lab's buoy": "The small buoy of the radial sea on a chain: drag it and let go.",
}


# Given by a MoorDyn file itself, or not part of a vessel without a hull.
OF_NO_FILE = {
    "lines", "length", "reach", "depth", "friction", "steady_force", "handles",
    *(name for name, one in parameters_of(MooringParams).items() if one.group in ("Line", "Body")),
} - {"breaking_load"}  # fmt: skip


def hidden(params: MooringParams) -> set[str]:
    """The parameters that mean nothing with the others as they are."""
    names = set() if params.floats else {"lift"}
    names |= OF_NO_FILE if params.moordyn_file else {"follow"}
    if params.wave_height == 0.0:
        names.add("regular")  # the period is that of the body's added mass and damping
        if params.moordyn_file:
            names |= {"follow"} | ({"direction"} if params.current == 0.0 else set())
    return names
