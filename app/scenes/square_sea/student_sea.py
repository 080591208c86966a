"""The square sea by a student's functions: gravity, spectrum and dispersion as tables, in place of the program's."""

import math
from typing import Any

import numpy as np

from app.lab.process.tabulate import Interval
from app.lab.student.live_tables import Call, LiveTables, Table, TableReport, TableUser
from app.scenes.sea_parameters import spectrum_values
from app.scenes.square_sea.parameters import SquareSeaParams, acting, conditions, gravity, marches
from sim.ocean import Sea
from sim.ocean.spectra import SPECTRA, Spectrum
from sim.ocean.spectra.record import MIN_WIND_SPEED
from sim.ocean.statistics.statistics import expected
from sim.parameters import parameters_of

GRAVITY, SPECTRUM, DISPERSION = "gravity", "spectrum", "dispersion"  # the functions, as the tasks name them
PHILLIPS = SPECTRA["phillips"]
WAVENUMBERS, DIRECTIONS = 96, 64  # of the table of a spectrum
MIN_WAVES_ACROSS, MAX_WAVES_ACROSS = 0.5, 256.0  # times 2 pi/length: the wavenumbers of that table
ENDLESS = 1e5  # [s] repeat time that a dispersion is asked for where the sea does not repeat: 6e-5 rad/s at most
COMPARED_SIZE = 64  # grid points a side of the seas that are compared
WHAT = {GRAVITY: "gravity", SPECTRUM: "heights of the waves", DISPERSION: "speeds of the waves"}


class StudentSea(TableUser):
    """Used by the square sea on the simulation thread."""

    def __init__(self, live: LiveTables) -> None:
        super().__init__(live)
        self.spectrum: Spectrum[Any] | None = None  # of the taken table

    def want(self, p: SquareSeaParams) -> None:
        """Ask for the tables that the parameters need; tables that are no longer needed are not taken."""
        calls, idle = {}, {}
        if marches(p):
            self.ask({}, dict.fromkeys(WHAT, "choose order 1, and a start that is as set, calm or storm"))
            return
        if p.planet == "by mass" and p.radius_rule == "same_density":
            declared = parameters_of(SquareSeaParams)["gravity"]
            calls[GRAVITY] = Call((np.array([p.planet_mass]),), Interval(declared.low, declared.high, declared.unit))
        else:
            idle[GRAVITY] = "choose a planet by its mass, as dense as the Earth"
        if p.spectrum_file or p.spectrum != PHILLIPS.name:
            idle[SPECTRUM] = f"choose the spectrum {PHILLIPS.title}"
        elif p.wind_speed < MIN_WIND_SPEED:
            idle[SPECTRUM] = "set a wind speed"
        else:
            calls[SPECTRUM] = spectrum_call(p, self.gravity(p))
        calls[DISPERSION] = dispersion_call(p, self.gravity(p))
        self.ask(calls, idle)

    def gravity(self, p: SquareSeaParams) -> float:
        """Gravity [m/s2] of the planet, the student's where it is taken."""
        table = self.taken.get(GRAVITY)
        return gravity(p) if table is None else float(table.values[0])

    def collect(self, p: SquareSeaParams) -> float | None:
        """Take the tables that there are. In how long [s] the sea is to adapt to them; None if nothing changed."""
        changed = self.take()
        if not changed:
            return None
        same_code = all(old and new and old.version == new.version for old, new in changed.values())
        if SPECTRUM in changed:
            self.spectrum = spectrum_by(self.taken[SPECTRUM]) if SPECTRUM in self.taken else None
        return acting(p).transition if same_code else 0.0

    def conditions(self, p: SquareSeaParams) -> dict[str, Any]:
        """The arguments of `Sea.change`, with the student's in place of the program's."""
        arguments: dict[str, Any] = {**conditions(p), "frequency": None, "gravity": self.gravity(p)}
        if SPECTRUM in self.taken:
            arguments["spectrum"] = self.spectrum
        if DISPERSION in self.taken:
            table = self.taken[DISPERSION]
            k, values = table.call.columns[0], table.values
            arguments |= {
                "frequency": lambda asked: np.interp(asked, k, values, left=0.0),
                "dispersion_scale": 1.0,
                "loop_period": None,
            }
        return arguments

    def report(self, p: SquareSeaParams) -> None:
        """Report to the panel the functions that run, and the difference of the sea from the program's."""
        differences = ()
        if self.taken:
            own, program = (
                expected(Sea(COMPARED_SIZE, p.length, seed=p.seed, **c)) for c in (self.conditions(p), conditions(p))
            )
            differences = (
                ("Significant height", p.amplitude * own.significant_height, p.amplitude * program.significant_height,
                 "m"),
                ("Peak period", own.peak_period, program.peak_period, "s"),
            )  # fmt: skip
            if GRAVITY in self.taken:
                differences = (("Gravity", self.gravity(p), gravity(p), "m/s²"), *differences)
        running = {name: WHAT[name] for name in self.taken}
        self.live.report = TableReport(running, self.live.report.idle, differences)


def spectrum_call(p: SquareSeaParams, g: float) -> Call:
    """The spectrum at wave vectors of all directions, from waves longer than the tile to those of the finest grid."""
    k, theta = polar_grid(p.length)
    x, y = (k[:, None] * np.cos(theta)).ravel(), (k[:, None] * np.sin(theta)).ravel()
    bearing = math.radians(p.wind_direction)
    wind = PHILLIPS.wind_speed(p.wind_speed) * np.array([math.cos(bearing), math.sin(bearing)])
    n, constant = x.size, spectrum_values(p)["phillips_constant"]
    columns = np.column_stack([x, y]), np.tile(wind, (n, 1)), np.full(n, constant), np.full(n, g)
    return Call(columns, Interval(0.0, math.inf, "m⁴"))


def polar_grid(length: float) -> tuple[np.ndarray, np.ndarray]:
    """Wavenumbers [rad/m] and directions [rad] of the table of a spectrum, on a tile of this length [m]."""
    base = 2.0 * math.pi / length
    k = np.geomspace(MIN_WAVES_ACROSS * base, math.sqrt(2.0) * MAX_WAVES_ACROSS * base, WAVENUMBERS)
    return k, np.arange(DIRECTIONS) * (2.0 * math.pi / DIRECTIONS)


def spectrum_by(table: Table) -> Spectrum[Any]:
    """The spectrum of a table: S k^4, which changes slowly, is interpolated in direction and log k.

    Waves that are longer than those of the table have no power.
    """
    vectors = table.call.columns[0].reshape(WAVENUMBERS, DIRECTIONS, 2)
    k = np.hypot(vectors[:, 0, 0], vectors[:, 0, 1])
    first, step = math.log(k[0]), math.log(k[-1] / k[0]) / (WAVENUMBERS - 1)
    saturation = table.values.reshape(WAVENUMBERS, DIRECTIONS) * k[:, None] ** 4

    def density(kx: np.ndarray, ky: np.ndarray, _: object) -> np.ndarray:
        size = np.hypot(kx, ky)
        row = (np.log(size) - first) / step
        i = np.clip(row.astype(int), 0, WAVENUMBERS - 2)
        a = np.minimum(row - i, 1.0)
        column = np.mod(np.arctan2(ky, kx) * (DIRECTIONS / (2.0 * math.pi)), DIRECTIONS)
        j = column.astype(int) % DIRECTIONS
        b = column - np.floor(column)
        left = (1.0 - a) * saturation[i, j] + a * saturation[i + 1, j]
        right = (1.0 - a) * saturation[i, (j + 1) % DIRECTIONS] + a * saturation[i + 1, (j + 1) % DIRECTIONS]
        return np.where(row < 0.0, 0.0, ((1.0 - b) * left + b * right) / size**4)

    return Spectrum("student", "The student's own", density, None, PHILLIPS.peak, PHILLIPS.conditions)


def dispersion_call(p: SquareSeaParams, g: float) -> Call:
    """The dispersion at every wavenumber that the grid has."""
    n = np.arange(int(p.size) // 2) ** 2
    k = np.sqrt(np.unique(n[:, None] + n)[1:]) * (2.0 * math.pi / p.length)
    columns = k, *(np.full(k.size, value) for value in (p.dispersion_scale, p.loop_period or ENDLESS, g))
    return Call(columns, Interval(0.0, math.inf, "rad/s"))
