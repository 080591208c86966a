"""The radial sea's sum of waves against the same loop in C."""

import ctypes
from typing import Any

import numpy as np

from benchmarks.native.build import build
from benchmarks.timing import median_times
from sim.ocean.radial.wave_sum import WAVE, Bands, VertexSums, add_waves

WAVES, RINGS, SPOKES = 64, 128, 128


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """One row: ns per wave and vertex, the same in C, and their ratio."""
    return [bare_row(31 if quick else 201)]


def bare_row(repeats: int) -> dict[str, Any]:
    """64 waves on 16,384 vertices with nothing skipped, median of repeats in turns, on one thread."""
    n, block = RINGS * SPOKES, SPOKES
    random = np.random.default_rng(0)
    x, y = random.uniform(-50.0, 50.0, (2, n)).astype(np.float32)
    wave = random.uniform(-0.1, 0.1, (WAVES, 11)).astype(np.float32)
    start = (np.arange(RINGS + 1) * block).astype(np.uint64)
    bands = Bands(x, y, start, np.full(RINGS, WAVES, np.uint64), np.ones((RINGS, WAVES), np.float32))
    ours, theirs = np.zeros((8, n), np.float32), np.zeros((8, n), np.float32)
    waves, sums = wave.view(WAVE).reshape(-1), VertexSums(*ours)
    library = build("radial")
    pointers = [a.ctypes.data_as(ctypes.c_void_p) for a in (x, y, wave, theirs)]

    def numba() -> None:
        add_waves(bands, waves, sums)

    def c() -> None:
        if library is not None:
            library.add_waves(n, block, WAVES, *pointers)

    our_time, c_time = median_times((numba, c), repeats)
    scale = 1e9 / (n * WAVES)
    found = {"name": "sum of 64 waves, 16384 vertices", "ns a pair": our_time * scale, "ms": our_time * 1e3}
    if library is not None:
        found |= {"C ns a pair": c_time * scale, "ratio": our_time / c_time}
    return found
