"""The mooring's parameters and presets."""

import dataclasses
from typing import Any

from app.scenes.springs.methods import METHODS
from sim.parameters import parameter
from sim.springs import INTEGRATORS

EXPLICIT = {
    name: METHODS[name] for name in METHODS if not (INTEGRATORS[name].implicit or INTEGRATORS[name].undamped_only)
}
MAX_LINES = 4


@dataclasses.dataclass(frozen=True)
class Params:
    """The mooring's parameters; the defaults are a buoy on three chains."""

    lines: int = parameter(3, 1, MAX_LINES, "", "Number of lines, spread evenly; the first leads into the waves",
                           group="Main", affects="start")  # fmt: skip
    length: float = parameter(
        96.0, 2.0, 1000.0, "m", "Length of each line, unstretched", log_from=2.0, group="Main", affects="start"
    )
    reach: float = parameter(
        80.0, 0.5, 900.0, "m", "Level distance from the body's middle to each anchor", log_from=0.5, group="Main",
        affects="start", title="Distance of anchors",
    )  # fmt: skip
    depth: float = parameter(40.0, 2.0, 500.0, "m", "Depth of the water", log_from=2.0, group="Main", affects="start")
    wave_height: float = parameter(
        4.0, 0.0, 20.0, "m", "Significant height of the waves; the height of a regular wave", group="Main"
    )
    wave_period: float = parameter(8.0, 1.0, 25.0, "s", "Period of the highest waves", group="Main")
    integrator: str = parameter("leapfrog", choices=EXPLICIT, doc="Method of integration", group="Main", title="Method")
    time_step: float = parameter(1 / 480, 1e-5, 0.1, "s", "Step h of the integrator", log_from=1e-5, group="Main")

    diameter: float = parameter(
        0.09, 0.003, 0.5, "m", "Diameter of a rope with the volume of the line", log_from=0.003, group="Line"
    )
    line_mass: float = parameter(
        80.0,
        0.01,
        1000.0,
        "kg/m",
        "Mass per metre of line, in air",
        log_from=0.01,
        group="Line",
        title="Mass per metre",
    )
    axial_stiffness: float = parameter(
        5e7, 1e3, 1e10, "N", "Stiffness EA of a line", log_from=1e3, group="Line", title="Stiffness EA"
    )
    line_damping: float = parameter(
        0.8, 0.0, 2.0, "", "Damping of the stretch of a segment, of the critical one", group="Line",
        title="Internal damping",
    )  # fmt: skip
    drag_across: float = parameter(1.6, 0.0, 5.0, "", "Drag coefficient across the line", group="Line")
    drag_along: float = parameter(0.1, 0.0, 2.0, "", "Drag coefficient along the line", group="Line")
    added_mass: float = parameter(1.0, 0.0, 5.0, "", "Added mass coefficient across the line", group="Line")
    floats: bool = parameter(False, doc="Floats on a part of each line", group="Line", affects="start")
    lift: float = parameter(
        300.0, 0.0, 5000.0, "N/m", "Upward force of the part with floats, per metre", group="Line", affects="start",
        title="Lift of floats",
    )  # fmt: skip
    segments: int = parameter(40, 4, 100, "", "Segments of each line", log_from=4, group="Line", affects="start")

    body: str = parameter(
        "buoy", choices={"buoy": "Buoy", "box": "Box"}, doc="Shape of the floating body", group="Body", affects="start"
    )
    size: float = parameter(9.0, 0.5, 40.0, "m", "Width of the body", log_from=0.5, group="Body", affects="start")
    density: float = parameter(450.0, 100.0, 900.0, "kg/m³", "Density of the body", group="Body", affects="start")
    pull: float = parameter(
        1.0, 0.05, 5.0, "", "Largest force with which the mouse pulls the body, in weights of the body", group="Body",
        affects="look", title="Mouse force",
    )  # fmt: skip

    regular: bool = parameter(False, doc="One regular wave instead of many waves", group="Sea", title="Regular wave")
    direction: float = parameter(
        0.0, -180.0, 180.0, "°", "Where waves, current and steady force go to, from +x towards +y", group="Sea"
    )
    current: float = parameter(0.0, 0.0, 4.0, "m/s", "Speed of the water, the same at all depths", group="Sea")
    steady_force: float = parameter(0.0, 0.0, 5000.0, "kN", "Force of the wind on the body", group="Sea", log_from=0.1)
    friction: float = parameter(0.3, 0.0, 2.0, "", "Coefficient of friction of the bed", group="Sea")

    speed: float = parameter(
        1.0, 0.01, 8.0, "", "Simulated time over real time: 0.1 is slow motion", log_from=0.01, group="Time",
        affects="look",
    )  # fmt: skip

    surface: bool = parameter(True, doc="The water's surface", group="Look", affects="look")
    watch: bool = parameter(
        True, doc="Path of the body, and the circle that it has not left", group="Look", affects="look",
        title="Watch circle",
    )  # fmt: skip
    handles: bool = parameter(True, doc="Arrows that move anchors and fairleads", group="Look", affects="look")
    grid: bool = parameter(True, doc="Lines on the bed (key G)", group="Look", affects="look")
    plot_tension: bool = parameter(
        False, doc="Tension at the fairlead of each line over time, and the largest", group="Plots", affects="look",
        title="Tension",
    )  # fmt: skip
    plot_anchor: bool = parameter(
        False, doc="Tension at the anchor of each line over time", group="Plots", affects="look",
        title="Tension at anchors",
    )  # fmt: skip
    plot_offset: bool = parameter(
        False, doc="Level distance of the body from its place of rest, over time", group="Plots", affects="look",
        title="Offset",
    )  # fmt: skip
    plot_restoring: bool = parameter(
        False, doc="Static force of all lines over the offset, and the force now", group="Plots", affects="look",
        title="Restoring force",
    )  # fmt: skip


ROPE: dict[str, Any] = {
    "diameter": 0.12, "line_mass": 11.0, "axial_stiffness": 5e6, "line_damping": 0.1, "drag_across": 1.2,
    "drag_along": 0.05,
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
        "axial_stiffness": 2e7, "floats": True, "lift": 350.0, "steady_force": 8.0, "drag_across": 1.2,
    },
    "The lab's buoy": {
        "lines": 1, "size": 1.8, "depth": 8.0, "reach": 6.0, "length": 11.5, "diameter": 0.02, "line_mass": 4.0,
        "axial_stiffness": 1e6, "wave_height": 0.6, "wave_period": 3.0, "steady_force": 0.2, "time_step": 1 / 1000,
        "segments": 16,
    },
}  # fmt: skip

ABOUT = {  # preset -> what it shows and what to try
    "Chain catenary": "A buoy on three chains: see where each touches the bed wander with the waves.",
    "Taut ropes": "Light ropes under tension hold by their stretch: compare the offset with that of chains.",
    "Four-point spread": "A box on four chains in a current: drag one anchor away and watch the other tensions.",
    "Snap in a storm": "One rope goes slack in high waves and snaps taut: see the peaks of its tension.",
    "Lazy wave with floats": "Floats lift a part of the line, so that the bed end hardly feels the waves.",
    "The lab's buoy": "The small buoy of the radial sea on a chain: drag it and let go.",
}


def hidden(params: Params) -> set[str]:
    """The parameters that mean nothing with the others as they are."""
    names = set() if params.floats else {"lift"}
    if params.wave_height == 0.0:
        names |= {"wave_period", "regular"}
        if params.current == 0.0 and params.steady_force == 0.0:
            names.add("direction")
    return names
