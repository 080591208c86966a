"""A student's functions at the present numbers of a scene, beside the program's results.

For the functions of the seas and the cloth, which do not move anything: what a scene offers as live values goes in.
`LiveTables` calls them, with a table of one row for each.
"""

import math
from collections.abc import Callable, Collection, Mapping
from typing import NamedTuple

import numpy as np

from app.lab.course.live_values import LiveNumber, LiveValues
from app.lab.process.tabulate import Interval
from app.lab.student.live_tables import Call
from sim.ocean.spectra import phillips
from sim.water import EARTH_GRAVITY

WAVE = 2.0 * math.pi  # [rad/m] wavenumber of the wave of 1 m that the radial sea tells the lifetime of
DECAY_TIME = 10.0  # [s]
ANY = Interval(-math.inf, math.inf, "")
HEAVY = 100.0  # [Earth masses]

Argument = float | tuple[float, ...]  # a number or a vector
Number = Callable[[str], float]  # the live value of this name; raises LookupError if the scene has none


class SceneValue(NamedTuple):
    """A function at live values."""

    what: str
    unit: str
    arguments: Callable[[Number], tuple[Argument, ...]]
    program: Callable[[Number], float]  # the program's own number
    counts: bool = False  # the function takes whole numbers, and the number of entries of its result counts
    needs: tuple[str, str] = ("", "")  # a choice of the scene that this is for, and its value


def dispersion_here(n: Number) -> float:
    """The frequency [rad/s] that the square sea gives its dominant waves with the dispersion of the lab."""
    base = 2.0 * math.pi / n("loop_period")
    k = 2.0 * math.pi / n("wave_length")
    return n("dispersion_scale") * math.floor(math.sqrt(n("gravity_here") * k) / base) * base


def longest_wave(n: Number) -> tuple[Argument, ...]:
    """Arguments of `spectrum`: the wave of k = g/U^2 along the wind."""
    speed, g = n("wind_speed"), n("gravity_here")
    return (g / speed**2, 0.0), (speed, 0.0), n("phillips_constant"), g


def phillips_here(n: Number) -> float:
    """The power [m4] that the square sea gives this wave."""
    constant, g, speed = n("phillips_constant"), n("gravity_here"), n("wind_speed")
    c = phillips.PhillipsConditions(phillips_constant=constant, gravity=g, wind_speed=speed)
    return float(phillips.density(np.array([g / speed**2]), np.zeros(1), c)[0])


VALUES: Mapping[tuple[str, str], SceneValue] = {  # scene and task -> the value
    ("radial_sea", "net_buoyancy"): SceneValue(
        "1 m³ of this oil in the water", "N",
        lambda n: (1.0, n("oil_density"), n("water_density"), EARTH_GRAVITY), lambda n: n("net_force"),
    ),
    ("radial_sea", "extra_draft"): SceneValue(
        "this layer", "m",
        lambda n: (n("layer_thickness"), n("oil_density"), n("water_density")), lambda n: n("added_draft"),
        needs=("spill", "layer"),
    ),
    ("radial_sea", "draft"): SceneValue(
        "the box in these fluids", "m",
        lambda n: (n("box_density"), n("box_height"), n("oil_density"), n("layer_thickness"), n("water_density")),
        lambda n: n("box_draft_at_rest"), needs=("spill", "layer"),
    ),
    ("radial_sea", "mixture_viscosity"): SceneValue(
        "this mixture", "Pa·s",
        lambda n: (n("oil_viscosity"), n("water_viscosity"), n("fraction")),
        lambda n: n("solution_viscosity"), needs=("spill", "mixed"),
    ),
    ("radial_sea", "wave_decay"): SceneValue(
        f"1 m high, 1 m long, after {DECAY_TIME:g} s (the program takes the exact root)", "m",
        lambda n: (1.0, WAVE, n("surface_viscosity") / n("surface_density"), DECAY_TIME),
        lambda n: math.exp(-DECAY_TIME / n("short_wave_lifetime")),
    ),
    ("radial_sea", "reflectance"): SceneValue(
        "light straight onto this oil", "",
        lambda n: (0.0, n("oil_index")), lambda n: n("oil_reflectance"),
    ),
    ("square_sea", "gravity"): SceneValue(
        "a planet of 100 Earth masses", "m/s²", lambda n: (HEAVY,), lambda n: n("gravity_heavy"),
    ),
    ("square_sea", "spectrum"): SceneValue(
        "waves of k = g/U² along this wind", "m⁴", longest_wave, phillips_here, needs=("spectrum", "phillips"),
    ),
    ("square_sea", "damping_length"): SceneValue(
        "a minute of this viscosity", "m", lambda n: (n("viscosity"), 60.0), lambda n: n("minute_length"),
    ),
    ("square_sea", "dispersion"): SceneValue(
        "the dominant waves", "rad/s",
        lambda n: (2.0 * math.pi / n("wave_length"), n("dispersion_scale"), n("loop_period"), n("gravity_here")),
        dispersion_here,
    ),
    ("cloth", "cloth_links"): SceneValue(
        "links of this cloth", "",
        lambda n: (n("rows"), n("cols")),
        lambda n: n("structural_links") + n("shear_links") + n("bend_links"), counts=True,
    ),
}  # fmt: skip


def calls_here(scene: str, begun: Collection[str], live: LiveValues) -> dict[str, Call]:
    """The calls of the student's begun functions that can be compared in the present scene, by function."""

    def number(name: str) -> float:
        live_value = live[name]
        if not isinstance(live_value, LiveNumber) or not math.isfinite(live_value.value):
            raise LookupError(name)
        return live_value.value

    calls: dict[str, Call] = {}
    for (of_scene, task), value in VALUES.items():
        choice, needed = value.needs
        if of_scene != scene or task not in begun or (choice and live.get(choice) != needed):
            continue
        try:
            arguments, program = value.arguments(number), value.program(number)
        except (LookupError, ZeroDivisionError, ValueError):  # the scene has no such thing at present
            continue
        columns = tuple(np.array([argument], int if value.counts else float) for argument in arguments)
        calls[task] = Call(columns, ANY, None if value.counts else (), program)
    return calls
