"""A student's functions at the numbers that a scene has just now, beside the number that the program has for it.

For the functions of the seas and the cloth, which do not move anything: what a scene offers as live values goes in.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from app.lab.live_values import LiveNumber, LiveValues
from app.lab.program_check import conform
from app.lab.runner import RunError, Runner
from app.lab.saved import Saved
from app.lab.service import Service
from app.lab.task import Task
from sim.ocean.spectra import phillips

EARTH_GRAVITY = 9.81  # [m/s2] of the radial sea
WAVE = 2.0 * math.pi  # [rad/m] wavenumber of the wave of 1 m that the radial sea tells the lifetime of
DECAY_TIME = 10.0  # [s]
LIGHT, HEAVY = 0.01, 100.0  # [Earth masses]

Argument = float | tuple[float, ...]  # a number or a vector
Number = Callable[[str], float]  # the live value of this name; raises LookupError where the scene has none


class SceneValue(NamedTuple):
    """A function at live values."""

    what: str
    unit: str
    arguments: Callable[[Number], tuple[Argument, ...]]
    program: Callable[[Number], float]  # the program's own number
    size: bool = False  # of the result, the number of entries counts
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
        lambda n: (n("thickness"), n("oil_density"), n("water_density")), lambda n: n("added_draft"),
        needs=("spill", "layer"),
    ),
    ("radial_sea", "draft"): SceneValue(
        "the box in these fluids", "m",
        lambda n: (n("box_density"), n("box_height"), n("oil_density"), n("thickness"), n("water_density")),
        lambda n: n("box_draft"), needs=("spill", "layer"),
    ),
    ("radial_sea", "mixture_viscosity"): SceneValue(
        "this mixture", "Pa·s",
        lambda n: (1e-3 * n("oil_viscosity"), 1e-3 * n("water_viscosity"), n("fraction")),
        lambda n: 1e-3 * n("solution_viscosity"), needs=("spill", "mixed"),
    ),
    ("radial_sea", "wave_decay"): SceneValue(
        f"1 m high, 1 m long, after {DECAY_TIME:g} s (the program takes the exact root)", "m",
        lambda n: (1.0, WAVE, 1e-3 * n("surface_viscosity") / n("surface_density"), DECAY_TIME),
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
        lambda n: n("structural_links") + n("shear_links") + n("bend_links"), size=True,
    ),
}  # fmt: skip
WHOLE = {"cloth_links"}  # functions that take whole numbers
COSTLY = ("endless", "ended", "memory")  # kinds of errors that may end the process


class Compared(NamedTuple):
    """A student's function at a scene's numbers. student: None where it has no result; error says why."""

    value: SceneValue
    student: float | None
    program: float
    error: str = ""


class Wanted(NamedTuple):
    """A request."""

    saved: Saved
    arguments: Mapping[str, tuple[Argument, ...]]  # task -> arguments
    program: Mapping[str, float]
    values: Mapping[str, SceneValue]


def wanted(scene: str, tasks: Mapping[str, Task], saved: Saved, live: LiveValues) -> Wanted:
    """The student's begun functions that can be compared in the present scene."""

    def number(name: str) -> float:
        found = live[name]
        if not isinstance(found, LiveNumber) or not math.isfinite(found.value):
            raise LookupError(name)
        return found.value

    arguments: dict[str, tuple[Argument, ...]] = {}
    program: dict[str, float] = {}
    values: dict[str, SceneValue] = {}
    for (of_scene, task), value in VALUES.items():
        if of_scene != scene or task not in tasks or task not in saved.begun:
            continue
        choice, needed = value.needs
        if choice and live.get(choice) != needed:
            continue
        try:
            given, number_there = value.arguments(number), value.program(number)
        except (LookupError, ZeroDivisionError, ValueError):  # the scene has no such thing just now
            continue
        arguments[task] = tuple(int(a) for a in given if not isinstance(a, tuple)) if task in WHOLE else given
        program[task], values[task] = number_there, value
    return Wanted(saved, arguments, program, values)


class SceneValues(Service[Wanted]):
    """Computes the requested values in a thread. `found` is replaced, never changed."""

    def __init__(self, tasks: Mapping[str, Task], time_limit: float) -> None:
        self.tasks, self.time_limit = tasks, time_limit
        self.found: Mapping[str, Compared] = {}
        self.last: Wanted | None = None
        self.errors: dict[str, str] = {}  # functions of the version that runs that are not called again, and why
        self.runner: Runner | None = None  # of the version that runs
        super().__init__("student's values")

    def ask(self, scene: str, saved: Saved | None, live: LiveValues) -> None:
        """Compute the values of a scene where they have changed. Called by the viewer's thread."""
        if saved is None:
            return
        now = wanted(scene, self.tasks, saved, live)
        last = self.last
        if last is None or (now.saved.number, now.arguments) != (last.saved.number, last.arguments):
            self.last = now
            self.inbox.put(now)

    def handle(self, item: Wanted) -> None:
        """Compute the latest request."""
        if not self.inbox.empty():
            return
        if self.runner is None or self.runner.folder != item.saved.folder.resolve():
            self.release()
            self.runner = Runner(item.saved.folder, self.time_limit)
            self.errors = {}
        found: dict[str, Compared] = {}
        for task, given in item.arguments.items():
            found[task] = self.compare(self.runner, self.tasks[task], item.values[task], given, item.program[task])
        self.found = found

    def fail(self, item: Wanted, error: RunError) -> None:
        """No function has a result; the next version, or the next numbers, are computed."""
        self.found = {
            task: Compared(value, None, item.program[task], str(error)) for task, value in item.values.items()
        }

    def release(self) -> None:
        """End the process."""
        if self.runner is not None:
            self.runner.close()

    def compare(
        self, runner: Runner, task: Task, value: SceneValue, given: tuple[Argument, ...], program: float
    ) -> Compared:
        """One function. After an error that costs a process it is not called again: a scene's numbers never rest."""
        if task.name in self.errors:
            return Compared(value, None, program, self.errors[task.name])
        try:
            vectors = (np.array(a) if isinstance(a, tuple) else a for a in given)
            result: Any = runner.call(task.file, task.name, *vectors)
            if value.size:
                result = float(len(np.asarray(result)))
            return Compared(value, float(conform(result, 0.0)), program)
        except RunError as error:
            if error.kind in COSTLY:
                self.errors[task.name] = str(error)
            return Compared(value, None, program, str(error))
        except Exception as error:  # a result of another type or shape, which the check names
            return Compared(value, None, program, str(error))
