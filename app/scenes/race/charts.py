"""The race over time: the error of each rope on a logarithmic chart, and the energy error of each."""

import math

import numpy as np
from numpy.typing import NDArray

from app.messages import ChartLine
from app.scenes.charts import DASHES, PALETTE, Chart, CurveAxes
from app.scenes.plot_rows import ROW_INTERVAL, row_number
from app.scenes.race.entrants import Race
from app.scenes.race.names import rope_name
from app.scenes.springs.net_motion import rope_lengths

MAX_ROWS = 600  # a longer race keeps every second row, then every fourth, and so on
ERROR_TICKS = (  # [m] from end to end of the error's scale
    (1e-10, "≤ 0.1 nm"), (1e-8, "10 nm"), (1e-6, "1 µm"), (1e-4, "0.1 mm"), (1e-2, "1 cm"), (1.0, "1 m"), (10.0, ""),
)  # fmt: skip
CURVES = {
    "plot_errors": CurveAxes("Distance from the reference", "m", "t [s]", ("rope 1",), ERROR_TICKS),
    "plot_energies": CurveAxes("Energy error", "J", "t [s]", ("rope 1",)),
}
FLOOR_LINE = ChartLine(
    "below the accuracy of the reference", "rgba(120,120,120,0.6)", 1.0, fill="rgba(120,120,120,0.3)"
)
MAX_ENERGY_RATIO = 0.7  # energy error over the potential energy of the rope's whole fall that a rope can have at most
MIN_GROWTH = 1.1  # from row to row, of the energy error of a rope that diverges
FLOOR_WITHOUT_REFERENCE = 1e3  # [m], above the scale


def round_up(t: float) -> float:
    """The next time [s] of 2, 5, 10, 20, 50 and so on."""
    decade = 10.0 ** math.floor(math.log10(max(t, 2.0)))
    return next(m * decade for m in (1.0, 2.0, 5.0, 10.0) if m * decade >= max(t, 2.0) * (1 - 1e-9))


class RaceCharts:
    """The rows of a race, thinned out as it continues."""

    def __init__(self, race: Race) -> None:
        self.race = race
        self.rows = np.zeros((MAX_ROWS, 2 + 2 * len(race.entrants)))
        self.count = 0
        self.row_interval = ROW_INTERVAL  # [s]
        self.number = -1  # of the last row; the first is that of the start
        self.drawn: dict[str, Chart] = {}
        net = race.entrants[0].net
        n, weight = net.shape[1] - 1, net.mass * abs(net.gravity[2])
        self.max_energy = MAX_ENERGY_RATIO * n * max(weight, net.mass) * sum(rope_lengths(net))  # [J]

    def update(self) -> None:
        """Add a row if one is due."""
        race = self.race
        if row_number(race.t, self.row_interval) <= self.number:
            return
        if self.count == MAX_ROWS:
            self.rows[: MAX_ROWS // 2] = self.rows[::2].copy()
            self.count, self.row_interval = MAX_ROWS // 2, 2.0 * self.row_interval
        self.number = row_number(race.t, self.row_interval)
        row = self.rows[self.count]
        row[0] = race.t
        row[1] = self.error_floor()
        for i, entrant in enumerate(race.entrants):
            row[2 + 2 * i] = race.error(entrant)
            row[3 + 2 * i] = math.nan if entrant.failure else entrant.energy_error()
        self.count += 1
        self.drawn = {}

    def error_floor(self) -> float:
        """Smallest error [m] that all reference runs can tell; NaN if one is lost."""
        return float(np.max([self.race.error_floor(entrant) for entrant in self.race.entrants]))

    def charts(self) -> dict[str, Chart]:
        """The charts by parameter; the same objects until there is a new row."""
        if not self.drawn:
            race, table = self.race, self.rows[: self.count].T.copy()
            stiffness_differs = race.ratio != 1.0
            lines = tuple(
                ChartLine(rope_name(entrant, stiffness_differs), PALETTE[i], 2.0, DASHES[i])
                for i, entrant in enumerate(race.entrants)
            )
            floor = np.where(np.isnan(table[1]), FLOOR_WITHOUT_REFERENCE, table[1])
            drawn = np.maximum(table[2::2], ERROR_TICKS[0][0])  # NaN stays; the lowest tick says so
            drawn[:, table[0] == 0.0] = math.nan  # the start has no error, and so no place on this scale
            drawn[drawn > ERROR_TICKS[-1][0]] = math.nan
            energies = self.without_divergence(table[3::2])
            end = round_up(race.t)
            self.drawn = {
                name: Chart(
                    "t [s]", (*below, *lines, *marks), (table[0], *areas, *columns, *places), end,
                    (*areas_numbers, *numbers, *(None for _ in marks)),  # no numbers of marks
                )
                for name, below, areas, areas_numbers, columns, numbers in (
                    ("plot_errors", (FLOOR_LINE,), (floor,), (table[1],), drawn, table[2::2]),
                    ("plot_energies", (), (), (), energies, table[3::2]),
                )
                for marks, places in [self.ends(table, columns)]
            }  # fmt: skip
        return self.drawn

    def without_divergence(self, energies: NDArray[np.float64]) -> NDArray[np.float64]:
        """Energy errors [J] of each rope without the last ones of those that have diverged, which grow without end."""
        errors = energies.copy()
        for i, entrant in enumerate(self.race.entrants):
            last = np.flatnonzero(np.isfinite(errors[i]))
            row = last[-1] if entrant.failure and len(last) else 0
            while row > 0 and abs(errors[i, row]) > max(self.max_energy, MIN_GROWTH * abs(errors[i, row - 1])):
                errors[i, row] = math.nan
                row -= 1
        return errors

    def ends(
        self, table: NDArray[np.float64], drawn: NDArray[np.float64]
    ) -> tuple[list[ChartLine], list[NDArray[np.float64]]]:
        """A cross where the line of each rope ends or leaves a chart, and its column: NaN but at that row.

        drawn: (ropes, rows) of the chart.
        """
        marks: list[ChartLine] = []
        places: list[NDArray[np.float64]] = []
        for i, entrant in enumerate(self.race.entrants):
            without = np.flatnonzero(np.isnan(drawn[i]) & (table[0] > 0.0))
            if len(without) and (row := without[0]) > 0:  # it has run before
                why = entrant.failure.partition(":")[0] if entrant.failure else f"beyond {ERROR_TICKS[-1][0]:g} m"
                marks.append(ChartLine(f"{entrant.number}: {why}", PALETTE[i], cross=True))
                places.append(np.where(np.arange(len(table[0])) == row, ERROR_TICKS[0][0], math.nan))
        return marks, places
