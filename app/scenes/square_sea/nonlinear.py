"""The nonlinear sea of the square sea: its start, its highest wave, and its heights beside theory."""

import dataclasses
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.scenes.square_sea.parameters import LONG_CRESTED_STARTS, SquareSeaParams, solved_points
from app.scenes.square_sea.tile_mesh import Fields, Highest
from sim.ocean import Sea
from sim.ocean.nonlinear import NonlinearSea, breather, modulated_waves
from sim.ocean.statistics.crest_heights import HighCrests, high_crests, moments_of
from sim.ocean.statistics.statistics import expected

TOLERANCE = 1e-4  # of a step, over the waves' amplitude
FADE_PERIODS, ROGUE_FADE_PERIODS = 5.0, 2.0  # peak periods over which the nonlinear terms are faded in
BREATHER_DELAY = 1.12  # of that time, by which the highest crest is later than without fading in
ROGUE_PERIODS = 4.0  # peak periods to the rogue wave
SHOWN_PERIOD = 10.0  # [s] of real time that a wave takes in slow motion, if it did not stand at its crest
SLOWEST = 0.1  # of that pace, at the crest
HIGH_AMPLITUDE, HIGH_WATER = (0.95, 1.05), (0.1, 0.4)  # over Hs: between these, slow motion sets in
ROGUE_CREST = 1.245  # of its linear sum, over Hs: at order 3 it is 1.55 in the preset, as of the Draupner wave


class Heights(NamedTuple):
    """The heights of a drawn sea, and theory of its tile."""

    crest: float  # [m]
    skewness: float
    kurtosis: float
    theory: HighCrests
    lost: float  # fraction of the initial energy lost by breaking


def nonlinear_sea(p: SquareSeaParams, linear: Sea, t: float, place: tuple[float, float]) -> NonlinearSea:
    """The sea at time t [s]. linear: the waves of the conditions; place [m]: of the wave that is to grow."""
    c, n = linear.conditions, solved_points(p)
    hs, period = linear.significant_height_at(t), expected(linear, t).peak_period
    period = period if period > 0.0 else 1.0
    waves, fade = linear.waves_at(t), FADE_PERIODS * period
    if p.start == "rogue" and hs > 0.0:
        crest = min(ROGUE_CREST * hs, 0.9 * float(waves.amplitude.sum()))
        waves, fade = waves.with_crest(crest, place, t + ROGUE_PERIODS * period), ROGUE_FADE_PERIODS * period
    elif p.start in LONG_CRESTED_STARTS:
        carrier = waves.largest(1)
        count = max(round(float(carrier.k.sum()) * p.length / (2.0 * math.pi)), 1)
        amplitude, deep = hs / (2.0 * math.sqrt(2.0)), dataclasses.replace(c.water, depth=math.inf)
        if p.start == "breather":
            k = 2.0 * math.pi * count / p.length
            late = BREATHER_DELAY * fade * 0.5 * math.sqrt(c.gravity / k)  # [m], at the group speed
            waves, _ = breather(amplitude, count, p.length, place[0] - late, deep)
        else:
            waves = modulated_waves(amplitude, count, p.length, deep)
        # Its phases are those of its start; water that is not deep has a dispersion of its own.
        omega = c.omega(waves.kx)
        waves = dataclasses.replace(waves, water=c.water, omega=omega, phase=waves.phase + omega * t)
    size = (n, 1) if p.start in LONG_CRESTED_STARTS else n
    return NonlinearSea(size, p.length, p.order, start=waves, fade=fade, rtol=TOLERANCE, time=t)


def crest_pace(height: float, rise: float, significant_height: float, period: float, speed: float) -> float:
    """Factor on the speed while a high crest passes: time slows as it rises, and nearly stands at its top.

    height [m] at one place, and its rise [m/s]. A wave of the peak period [s] with both has the amplitude
    A = sqrt(height^2 + (rise/omega)^2), which shows how high the crest will be while it still rises. In slow motion
    such a wave takes SHOWN_PERIOD seconds of real time, and longer where it rises slowly.
    """
    if not (significant_height > 0.0 and period > 0.0):
        return 1.0
    omega = 2.0 * math.pi / period
    amplitude = math.hypot(height, rise / omega)
    share = grown(amplitude / significant_height, *HIGH_AMPLITUDE) * grown(height / significant_height, *HIGH_WATER)
    if share == 0.0:
        return 1.0
    slow = period / SHOWN_PERIOD * max(abs(rise) / (omega * amplitude), SLOWEST)
    return min(slow / speed, 1.0) ** share


def grown(value: float, low: float, high: float) -> float:
    """From 0 at `low` to 1 at `high`."""
    return min(max((value - low) / (high - low), 0.0), 1.0)


def on_tile(field: NDArray[np.floating]) -> NDArray[np.float32]:
    """A field (n, m) on the square (n, n): that of waves along x alone, (n, 1), is the same across."""
    n, m = field.shape
    return np.repeat(field.astype(np.float32), n // m, axis=1)


class Marching:
    """The nonlinear sea of a scene."""

    def __init__(self, p: SquareSeaParams, linear: Sea, t: float, place: tuple[float, float]) -> None:
        """The arguments are those of `nonlinear_sea`."""
        self.significant_height = linear.significant_height_at(t)  # [m]
        self.period = expected(linear, t).peak_period  # [s]
        self.sea = nonlinear_sea(p, linear, t, place)
        self.highest: Highest | None = None
        self.scale = p.amplitude  # factor on the heights that `highest` is of

    def advance(self, t: float) -> None:
        """Move on to time t [s]. Raises DivergenceError."""
        self.sea.advance(max(t, self.sea.time))

    def resize(self, p: SquareSeaParams) -> None:
        """Continue on the grid of the parameters."""
        n = solved_points(p)
        self.sea = self.sea.resized((n, 1 if self.sea.size[1] == 1 else n))

    def fields(self, p: SquareSeaParams) -> Fields:
        """The fields as they are now, the Jacobian where foam is drawn. The highest crest is noted."""
        if p.amplitude != self.scale:
            self.highest, self.scale = None, p.amplitude
        surface = self.sea.surface(self.sea.time)
        height = on_tile(surface.height)
        at = int(height.argmax())
        crest, cell = p.amplitude * float(height.flat[at]), p.length / len(height)
        if crest > (0.0 if self.highest is None else self.highest.place[2]):
            i, j = divmod(at, len(height))
            j = j if self.sea.size[1] > 1 else len(height) // 2
            hs = p.amplitude * 4.0 * float(height.std())
            self.highest = Highest((i * cell, j * cell, crest), self.sea.time, crest / max(hs, 1e-9))
        return Fields(height, None, on_tile(surface.jacobian) if p.foam else None, self.highest)

    def pace(self, trace: Sequence[tuple[float, float]], p: SquareSeaParams) -> float:
        """Factor on the speed, by the last two heights at the wave gauge, (time [s], height [m]) each."""
        if len(trace) < 2:
            return 1.0
        (before, earlier), (now, height) = trace[-2], trace[-1]
        hs = p.amplitude * self.significant_height
        return crest_pace(height, (height - earlier) / (now - before), hs, self.period, p.speed)

    def heights(self, linear: Sea, height: NDArray[np.floating]) -> Heights:
        """Crest, skewness and kurtosis of heights (n, n) [m] of now, beside theory of the linear sea."""
        energy = self.sea.energy
        whole = energy.kinetic + energy.potential + energy.breaking
        lost = energy.breaking / whole if whole > 0.0 else 0.0
        return Heights(float(height.max()), *moments_of(height), high_crests(linear, self.sea.time), lost)
