"""The race over time: the error of each rope on a logarithmic chart, and the energy of each."""

import math

import numpy as np
from numpy.typing import NDArray

from app.render.colormap import PALETTE
from app.scenes.charts import Chart, CurveAxes, Line
from app.scenes.race.race import Race
from app.scenes.race.report import name

EVERY = 1 / 30  # [s] of simulated time between two rows
KEPT = 600  # rows; a longer race keeps every other one, then every fourth
TICKS = (  # [m] of the error's scale
    (1e-10, "0.1 nm"), (1e-8, "10 nm"), (1e-6, "1 µm"), (1e-4, "0.1 mm"), (1e-2, "1 cm"), (1.0, "1 m"), (10.0, ""),
)  # fmt: skip
CURVES = {
    "plot_errors": CurveAxes("Distance from the reference", "t [s]", ("rope 1",), TICKS),
    "plot_energies": CurveAxes("Energy above the start [J]", "t [s]", ("rope 1",)),
}
ZONE = Line("reference unsure", "rgba(120,120,120,0.6)", 1.0, fill="rgba(120,120,120,0.3)")
ONLY_GHOST = Line("reference", "#000000", 1.5, (4.0, 4.0))
DASHES = ((), (10.0, 4.0), (3.0, 3.0), (12.0, 3.0, 3.0, 3.0), (6.0, 6.0), (1.0, 4.0))  # told apart in grey as well
TALL = 0.7  # energies are drawn up to so many times what the rope falls through
ABOVE, BELOW = 1e3, 1e-12  # [m] off the error's scale: of a rope that diverged, and where there is no reference


def round_up(t: float) -> float:
    """The next time [s] of 2, 5, 10, 20, 50 and so on."""
    decade = 10.0 ** math.floor(math.log10(max(t, 2.0)))
    return next(m * decade for m in (1.0, 2.0, 5.0, 10.0) if m * decade >= max(t, 2.0) * (1 - 1e-9))


class RaceCharts:
    """Rows of a race, thinned out as it lengthens."""

    def __init__(self, race: Race) -> None:
        self.race = race
        self.rows = np.zeros((KEPT, 3 + 2 * len(race.lanes)))
        self.count = 0
        self.every = EVERY
        self.due = 0.0
        self.drawn: dict[str, Chart] = {}
        lane = race.lanes[0]
        self.start = [lane.initial for lane in race.lanes]  # [J]
        n = lane.net.shape[1] - 1
        sag = lane.net.mass * abs(lane.net.gravity[2]) / lane.net.families[0].stiffness
        fall = n * lane.net.families[0].rest + 0.5 * sag * n * (n + 1)
        self.tall = TALL * n * lane.net.mass * max(abs(lane.net.gravity[2]), 1.0) * fall  # [J]

    def sample(self) -> None:
        """Take a row if one is due."""
        race = self.race
        if race.t < max(self.due, race.tick) - 1e-9:
            return
        if self.count == KEPT:
            self.rows[: KEPT // 2] = self.rows[::2].copy()
            self.count, self.every = KEPT // 2, 2.0 * self.every
        self.due = race.t + self.every
        row = self.rows[self.count]
        row[0] = race.t
        row[1] = self.zone()
        last = self.rows[max(self.count - 1, 0)]
        row[2] = self.held(race.ghosts[0].energy(race.lanes[0].net, race.t) - self.start[0], last[2])
        for i, lane in enumerate(race.lanes):
            # A logarithmic chart has no gaps: what has no error goes off its scale.
            error = race.error(lane)
            row[3 + 2 * i] = ABOVE if lane.out else max(error, TICKS[0][0]) if error == error else BELOW
            row[4 + 2 * i] = self.held(math.nan if lane.out else lane.total() - self.start[i], last[4 + 2 * i])
        self.count += 1
        self.drawn = {}

    def held(self, energy: float, last: float) -> float:
        """The energy to draw [J]: bounded, and the last one of a rope that has stopped, as a browser takes no NaN."""
        return min(max(energy, -self.tall), self.tall) if energy == energy else last

    def zone(self) -> float:
        """What an error must exceed [m] to be read; the top of the chart once a reference is lost."""
        least = [self.race.certain(lane) for lane in self.race.lanes]
        return ABOVE if any(value != value for value in least) else max(least)

    def charts(self) -> dict[str, Chart]:
        """By parameter; the same objects until there is a new row. Nothing before there is a line to draw."""
        if not self.drawn and self.count > 1:
            race, table = self.race, self.rows[: self.count].T.copy()
            risen = race.ratio != 1.0
            lines = tuple(Line(name(lane, risen), PALETTE[i], 2.0, DASHES[i]) for i, lane in enumerate(race.lanes))
            ghosts: tuple[NDArray[np.float64], ...] = () if risen else (table[2],)
            errors = (table[0], table[1], *table[3::2])
            energies = (table[0], *table[4::2], *ghosts)
            reference = (ONLY_GHOST,) * len(ghosts)
            self.drawn = {
                "plot_errors": Chart("t [s]", (ZONE, *lines), errors, round_up(race.t)),
                "plot_energies": Chart("t [s]", (*lines, *reference), energies, round_up(race.t)),
            }
        return self.drawn
