"""The radial sea by a student's functions: viscosity of the mixture, decay of waves, light on oil, draft of the box."""

import dataclasses
import functools
import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from app.lab.process.tabulate import Interval
from app.lab.student.live_tables import Call, LiveTables, Table, TableReport, TableUser
from app.scenes.radial_sea.bodies import FloatingBodies, box_of
from app.scenes.radial_sea.parameters import RadialSeaParams, column_of
from sim.ocean.fluids.fluid_column import FluidColumn
from sim.ocean.fluids.fluids import normal_reflectance

# The functions, as the tasks name them.
VISCOSITY, DECAY, REFLECTANCE, DRAFT = "mixture_viscosity", "wave_decay", "reflectance", "draft"
WHAT = {
    VISCOSITY: "viscosity of the mixture",
    DECAY: "decay of the waves",
    REFLECTANCE: "light that the oil mirrors",
    DRAFT: "depth at which the box is set down",
}
WAVENUMBERS = np.geomspace(1e-3, 1e3, 121)  # [rad/m] of the table of decays
SHOWN_WAVE = 2.0 * math.pi  # [rad/m] wavenumber of the wave of 1 m; the panel shows its decay
LOST = 0.5  # exponent of the share of a wave that is left after the time that a decay is asked for, by Lamb's law
LEAST = 1e-12  # fraction of a wave that is left at least: below, a rate cannot be determined


class StudentNumbers(NamedTuple):
    """Results of the student's functions; None without a result."""

    viscosity: float | None  # [Pa s] of the mixture
    decay: Callable[[np.ndarray], np.ndarray] | None  # rate (k) [1/s]
    oil_index: float | None  # refractive index
    draft: float | None  # [m] of the box


class StudentRadialSea(TableUser):
    """Used by the radial sea on the simulation thread."""

    def __init__(self, live: LiveTables) -> None:
        super().__init__(live)
        self.numbers = StudentNumbers(None, None, None, None)  # that they come to

    def want(self, p: RadialSeaParams, bodies: FloatingBodies) -> None:
        """Request the tables that the parameters need; tables that are no longer needed are not collected."""
        column, calls, idle = column_of(p), {}, {}
        oil, water = column.oil, column.water
        if column.kind == "mixed":
            calls[VISCOSITY] = call_of(oil.viscosity, water.viscosity, column.fraction, allowed=(1e-6, 1e6, "Pa·s"))
        else:
            idle[VISCOSITY] = "mix oil and water entirely"
        if column.kind == "water":
            idle[DECAY] = idle[REFLECTANCE] = idle[DRAFT] = "spill a layer of oil"
        else:
            nu = column.surface.kinematic_viscosity
            k, one = WAVENUMBERS, np.ones(WAVENUMBERS.size)
            calls[DECAY] = Call((one, k, nu * one, asked_time(nu)), Interval(LEAST, 1.0, "m"))
        if column.kind == "mixed":
            idle[REFLECTANCE] = idle[DRAFT] = "let the oil float as a layer"
        elif column.kind == "layer":
            calls[REFLECTANCE] = call_of(0.0, oil.refractive_index, allowed=(0.0, 0.9, ""))
            box = box_of(bodies)
            if box is None:
                idle[DRAFT] = "let a box float"
            else:
                prediction = bodies.prediction(box)
                arguments = bodies.densities[box], prediction.height, oil.density, column.thickness, water.density
                calls[DRAFT] = call_of(*arguments, allowed=(0.0, 3.0 * prediction.height, "m"))
        self.ask(calls, idle)

    def collect(self) -> set[str]:
        """Collect the finished tables. Returns the functions with another table than before."""
        changed = self.take()
        if changed:
            self.numbers = numbers_of(self.taken)
        return set(changed)

    def column(self, p: RadialSeaParams) -> FluidColumn:
        """The fluids of the sea."""
        column = column_of(p)
        viscosity = self.numbers.viscosity if column.kind == "mixed" else None
        decay = None if column.kind == "water" else self.numbers.decay
        return dataclasses.replace(column, mixture_viscosity=viscosity, decay=decay)

    def drawn(self, column: FluidColumn) -> FluidColumn:
        """The fluids as they are drawn."""
        index = self.numbers.oil_index
        if index is None or column.kind != "layer":
            return column
        return dataclasses.replace(column, oil=column.oil._replace(refractive_index=index))

    def report(self, p: RadialSeaParams, bodies: FloatingBodies) -> None:
        """Report to the panel the functions that run, and their differences from the program's."""
        viscosity, decay, index, draft = self.numbers
        program, wave = column_of(p), np.array([SHOWN_WAVE])
        differences: list[tuple[str, float, float, str]] = []
        if viscosity is not None:
            differences.append(
                (f"Viscosity, {program.law.replace('_', ' ')} in the program", 1e3 * viscosity,
                 1e3 * program.surface.viscosity, "mPa·s")
            )  # fmt: skip
        if decay is not None:
            own, exact = (float(c.roots(wave)[1][0]) for c in (self.column(p), program))
            differences.append(("A wave of 1 m falls to 37 % in", lifetime(own), lifetime(exact), "s"))
        if index is not None:
            light, reference = (100.0 * normal_reflectance(n) for n in (index, program.oil.refractive_index))
            differences.append(("Light that the oil mirrors straight up", light, reference, "%"))
        box = box_of(bodies)
        if draft is not None and box is not None:
            differences.append(("Draft of the box", draft, bodies.prediction(box).draft, "m"))
        running = {name: WHAT[name] for name in self.taken}
        self.live.report = TableReport(running, self.live.report.idle, tuple(differences))


def lifetime(rate: float) -> float:
    """Time [s] in which a wave that decays at a rate [1/s] falls to 1/e."""
    return 1.0 / rate if rate > 0.0 else math.inf


def numbers_of(tables: dict[str, Table]) -> StudentNumbers:
    """Results read from tables."""
    index = decay = None
    if REFLECTANCE in tables:
        root = math.sqrt(float(tables[REFLECTANCE].values[0]))
        index = (1.0 + root) / (1.0 - root)  # R = ((n - 1)/(n + 1))^2
    if DECAY in tables:
        table = tables[DECAY]
        rates = -np.log(table.values) / table.call.columns[3]
        decay = functools.partial(interpolated_decay, rates / WAVENUMBERS**2)
    first = {name: float(table.values[0]) for name, table in tables.items()}
    return StudentNumbers(first.get(VISCOSITY), decay, index, first.get(DRAFT))


def interpolated_decay(over_k2: np.ndarray, k: np.ndarray) -> np.ndarray:
    """Decay rates [1/s]; over_k2 (n,) [m2/s]: rate over k^2 at WAVENUMBERS, which changes slowly."""
    k = np.asarray(k, np.float64)
    return k**2 * np.interp(np.log(np.maximum(k, WAVENUMBERS[0])), np.log(WAVENUMBERS), over_k2)


def call_of(*arguments: float, allowed: tuple[float, float, str]) -> Call:
    """One call of a function."""
    return Call(tuple(np.array([argument]) for argument in arguments), Interval(*allowed))


def asked_time(viscosity: float) -> np.ndarray:
    """(n,) [s] after which a wave of each of WAVENUMBERS has fallen to e^-LOST, by Lamb's law."""
    return LOST / (2.0 * viscosity * WAVENUMBERS**2)
