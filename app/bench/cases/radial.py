"""The radial sea: its sum of waves against the same loop in C, what the rings skip, and radial against square."""

import ctypes
from typing import Any

import numpy as np

from app.bench.native.build import build
from app.bench.timing import median_times
from sim.ocean import Sea
from sim.ocean.gerstner import draw_waves
from sim.ocean.radial import RadialSea
from sim.ocean.radial_grid import RadialGrid
from sim.ocean.spectra import SPECTRA
from sim.ocean.wave_sum import add_waves

WAVES, RINGS, SPOKES = 64, 128, 128


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Rows of name, ms, ns per wave and vertex drawn, the same in C, their ratio, and the share of pairs drawn."""
    repeats = 31 if quick else 201
    return [bare_row(repeats), frame_row(repeats), *against_square(repeats)]


def bare_row(repeats: int) -> dict[str, Any]:
    """64 waves on 16,384 vertices with nothing skipped, median of repeats in turns, on one thread."""
    n, block = RINGS * SPOKES, SPOKES
    random = np.random.default_rng(0)
    x, y = random.uniform(-50.0, 50.0, (2, n)).astype(np.float32)
    wave = random.uniform(-0.1, 0.1, (WAVES, 11)).astype(np.float32)
    start = (np.arange(RINGS + 1) * block).astype(np.uint64)
    active, weight = np.full(RINGS, WAVES, np.uint64), np.ones(RINGS * WAVES, np.float32)
    ours, theirs = np.zeros((8, n), np.float32), np.zeros((8, n), np.float32)
    sums = [ours[i] for i in range(8)]
    library = build("radial")
    pointers = [a.ctypes.data_as(ctypes.c_void_p) for a in (x, y, wave, theirs)]

    def numba() -> None:
        add_waves(x, y, start, active, weight, np.uint64(WAVES), wave.reshape(-1), *sums)

    def c() -> None:
        if library is not None:
            library.add_waves(n, block, WAVES, *pointers)

    our_time, c_time = median_times((numba, c), repeats)
    scale = 1e9 / (n * WAVES)
    found = {"name": "sum of 64 waves, 16384 vertices", "ns a pair": our_time * scale, "ms": our_time * 1e3}
    if library is not None:
        found |= {"C ns a pair": c_time * scale, "ratio": our_time / c_time}
    return found


def frame_row(repeats: int) -> dict[str, Any]:
    """A whole frame of the sea on a radial grid: the share of pairs drawn, and the cost of each of them."""
    sea, grid = default_sea(), RadialGrid(RINGS, SPOKES)
    times = iter(range(1, 10**9))
    (seconds,) = median_times((lambda: sea.on(grid, next(times) / 30.0),), repeats)
    pairs = len(grid) * WAVES
    share = sea.evaluated / (sea.evaluated + sea.skipped)
    return {
        "name": "frame on the radial grid",
        "ms": seconds * 1e3,
        "pairs drawn": share,
        "ns a pair": seconds * 1e9 / (share * pairs),
    }


def against_square(repeats: int) -> list[dict[str, Any]]:
    """The lab's question 1.2-6: the same number of vertices as rings and as a square tile."""
    sea, grid = default_sea(), RadialGrid(RINGS, SPOKES)
    square = Sea(size=128, length=128 * 2.0, spectrum="jonswap", wind_speed=8.0)
    times = iter(range(1, 10**9))

    def tile() -> None:
        surface = square.surface(next(times) / 30.0)
        for field in ("height", "displacement", "slope"):
            getattr(surface, field)

    radial, fft = median_times((lambda: sea.on(grid, next(times) / 30.0), tile), repeats)
    reach, near = 2e-3 * float(grid.radii[-1]), 2 * float(grid.spacing[0])
    side, cells = square.length, square.length / square.size
    return [
        {"name": f"rings: {WAVES} waves to {near:.1f} m, {reach:.0f} km wide", "ms": radial * 1e3},
        {"name": f"square: {128 * 64} waves to {2 * cells:.1f} m, {side:.0f} m wide, repeating", "ms": fft * 1e3},
    ]


def default_sea() -> RadialSea:
    """64 waves of the JONSWAP spectrum at 8 m/s."""
    return RadialSea(draw_waves(SPECTRA["jonswap"], SPECTRA["jonswap"].conditions(wind_speed=8.0), WAVES))
