"""A chart recorder on the sea: the height above one place, its trace, and the spectrum of the trace beside theory."""

import collections
import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sim.ocean import Sea
from sim.ocean.records.wave_record import ZeroCrossings, zero_crossings

if TYPE_CHECKING:
    from sim.ocean.nonlinear import NonlinearSea

SAMPLE_RATE = 10.0  # [Hz] to which the trace is resampled before its spectrum is computed
MAX_TRACE_DURATION = 600.0  # [s] older samples of the trace are dropped
MIN_SPECTRUM_DURATION = 10.0  # [s] no spectrum is computed of a shorter trace
MAX_SEGMENT_DURATION = 50.0  # [s] length of the segments of Welch's method, or half the trace where that is shorter
ENERGY_SHOWN = 0.99  # fraction of the energy of theory up to which the spectrum is returned
RAY_SAMPLES = 200  # positions along a ray at which it is compared with the water
MIN_DOWNWARD_COMPONENT = 1e-4  # of a ray's unit vector: a flatter ray meets the water too far away

Vector = tuple[float, float, float]


class WaveGauge:
    """One place on the water. The height is that of the displaced surface above it."""

    def __init__(self) -> None:
        self.at = (0.0, 0.0)  # [m]
        self.height = 0.0  # [m]
        self.trace: collections.deque[tuple[float, float]] = collections.deque()

    def put(self, at: tuple[float, float]) -> None:
        """Move it, and begin a new trace."""
        self.at = at
        self.trace.clear()

    def read(self, sea: "Sea | NonlinearSea", t: float, scale: float) -> None:
        """Take the height at time t [s]; scale: factor on the height as drawn."""
        height, _ = sea.height_at([self.at], t)
        self.height = scale * float(height[0])
        if self.trace and t <= self.trace[-1][0]:
            return
        self.trace.append((t, self.height))
        while self.trace[-1][0] - self.trace[0][0] > MAX_TRACE_DURATION:
            self.trace.popleft()

    def waves(self) -> ZeroCrossings:
        """The waves of the trace, with their H1/3 and Tz."""
        times, heights = np.array(self.trace).reshape(-1, 2).T
        return zero_crossings(times, heights)

    def spectrum(self, sea: Sea, t: float, scale: float) -> tuple[NDArray[np.floating], ...]:
        """(frequency [Hz], measured, theory [m2/Hz]) by Welch's method (1967, IEEE Trans. Audio 15:70); empty if short.

        Theory is the energy of the tile's waves, in the same bins.
        """
        none = np.zeros(0)
        if not self.trace or self.trace[-1][0] - self.trace[0][0] < MIN_SPECTRUM_DURATION:
            return none, none, none
        times, heights = np.array(self.trace).T
        even = np.arange(times[0], times[-1], 1.0 / SAMPLE_RATE)
        heights = np.interp(even, times, heights)
        n = min(len(even) // 2, int(MAX_SEGMENT_DURATION * SAMPLE_RATE))
        window = np.hanning(n)
        pieces = [heights[i : i + n] for i in range(0, len(heights) - n + 1, n // 2)]
        power = np.mean([np.abs(np.fft.rfft(window * (piece - piece.mean()))) ** 2 for piece in pieces], axis=0)
        measured = 2.0 * power / (SAMPLE_RATE * (window**2).sum())
        f = np.fft.rfftfreq(n, 1.0 / SAMPLE_RATE)
        edges = np.append(f - 0.5 * f[1], f[-1] + 0.5 * f[1])
        energy, _ = np.histogram(sea.frequencies / (2.0 * math.pi), edges, weights=scale**2 * sea.energy_at(t))
        theory = energy / f[1]
        # Up to where 99 % of the energy is: the rest is an empty chart.
        count = max(8, int(np.searchsorted(np.cumsum(energy), ENERGY_SHOWN * energy.sum())) + 2)
        return f[1:count], measured[1:count], theory[1:count]


def where_hit(
    sea: "Sea | NonlinearSea", t: float, origin: Vector, direction: Vector, scale: float
) -> tuple[float, float] | None:
    """(x, y) [m] of the first hit of a ray on the water at time t [s]; None if it misses."""
    start, way = np.array(origin), np.array(direction)
    length = float(np.linalg.norm(way))
    if not length > 0.0:
        return None
    way /= length
    highest = scale * float(sea.surface(t).height.max())
    if way[2] > -MIN_DOWNWARD_COMPONENT or start[2] <= -highest:
        return None
    # From where it dips under the highest crest to where it is as far below: waves are about as deep as high.
    near = max(0.0, (highest - start[2]) / way[2])
    far = (-highest - start[2]) / way[2]
    places = start + np.linspace(near, far, RAY_SAMPLES)[:, None] * way
    heights, _ = sea.height_at(places[:, :2], t)
    under = np.nonzero(places[:, 2] <= scale * heights)[0]
    hit = places[under[0]] if under.size else places[-1]
    return float(hit[0]), float(hit[1])
