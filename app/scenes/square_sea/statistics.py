"""The statistics of the sea as drawn, beside those that theory gives for its tile."""

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from app.scenes.square_sea.parameters import SquareSeaParams, acting
from sim.ocean import Sea
from sim.ocean.statistics.statistics import Statistics, expected, height_scatter, measured, open_sea_height

if TYPE_CHECKING:
    from app.scenes.square_sea.nonlinear import Heights, Marching

INTERVAL = 0.5  # [s] of simulated time between two reports, and between two spectra at the wave gauge
PEAK_WIDTH = 0.08  # of the peak frequency: waves no farther from the peak are called dominant


class Theory(NamedTuple):
    """Theory of the spectrum."""

    statistics: Statistics  # as the tile resolves it
    scatter: float  # relative standard deviation of one sea's Hs
    whole: float  # Hs [m] on an endless sea
    wave: tuple[float, float]  # length [m] and speed [m/s] of the dominant wave


class Report(NamedTuple):
    """The sea as drawn, and as theory has it."""

    measured: Statistics
    theory: Theory
    interval: float = 0.0  # [s] between the two frames that tell the direction
    heights: "Heights | None" = None  # of a sea that is solved step by step


def scaled(s: Statistics, factor: float) -> Statistics:
    """The statistics of heights `factor` times as high."""
    return s._replace(
        significant_height=factor * s.significant_height, mean_square_slope=factor**2 * s.mean_square_slope
    )


def theory(sea: Sea, t: float, params: SquareSeaParams) -> Theory:
    """Theory of the sea at time t [s] as drawn."""
    statistics = expected(sea, t)
    whole = open_sea_height(sea.spectrum, sea.conditions)
    wave = dominant(sea, t, statistics.peak_period)
    return Theory(scaled(statistics, params.amplitude), height_scatter(sea, t), params.amplitude * whole, wave)


def measure(
    sea: Sea, height: np.ndarray, earlier: np.ndarray | None, params: SquareSeaParams, interval: float = 0.0
) -> Statistics:
    """Statistics of heights (n, n) [m]; earlier: those of the frame before, `interval` [s] ago."""
    scale = acting(params).dispersion_scale
    statistics = measured(height, sea.length, sea.conditions, earlier, interval * scale)
    # A scale on the dispersion makes every period shorter by as much.
    period = statistics.peak_period / scale if scale > 0.0 else math.nan
    return scaled(statistics, params.amplitude)._replace(peak_period=period)


def dominant(sea: Sea, t: float, period: float) -> tuple[float, float]:
    """Length [m] and phase speed [m/s] of the waves about the peak period [s]; nan without waves."""
    if not period > 0.0:
        return math.nan, math.nan
    peak = 2.0 * math.pi / period
    energy = sea.energy_at(t)
    away = np.where(energy > 0.0, np.abs(sea.frequencies / peak - 1.0), math.inf)
    # A tile of few waves may have none so near: then the nearest.
    energy = np.where(away <= max(PEAK_WIDTH, float(away.min())), energy, 0.0)
    total = float(energy.sum())
    if not total > 0.0:
        return math.nan, math.nan
    k = float((energy * np.hypot(sea.k[:, None], sea.k[None, :])).sum()) / total
    return 2.0 * math.pi / k, peak / k


class LiveStatistics:
    """The newest report of a sea that runs."""

    def __init__(self) -> None:
        self.report: Report | None = None
        self.theory: Theory | None = None  # None: it is another since the last report
        self.measured_at = -math.inf  # [s] of simulated time
        self.earlier_height: np.ndarray | None = None  # (n, n) [m] of the frame before, while reports are shown

    def is_due(self, params: SquareSeaParams, t: float) -> bool:
        """True if reports are shown and the last one is out of date."""
        return params.statistics and abs(t - self.measured_at) >= INTERVAL

    def update(
        self,
        sea: Sea,
        params: SquareSeaParams,
        t: float,
        height: np.ndarray,
        dt: float,
        *,
        changing: bool,
        marching: "Marching | None" = None,
    ) -> bool:
        """Compare the drawn sea with theory if that is due; True if it was.

        height: (n, n) [m] at time t [s]; dt: [s] since the frame before. changing: the sea adapts to other conditions.
        marching: the nonlinear sea, if it is one.
        """
        due = self.is_due(params, t)
        if due:
            if self.theory is None or changing:
                self.theory = theory(sea, t, params)
            heights = None if marching is None else marching.heights(sea, height)
            self.report = Report(measure(sea, height, self.earlier_height, params, dt), self.theory, dt, heights)
            self.measured_at = t
        self.earlier_height = height if params.statistics else None
        return due
