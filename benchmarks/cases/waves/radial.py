"""The radial sea: the pairs of wave and vertex that the rings skip, and radial against square."""

from typing import Any

from benchmarks.timing import median_times
from sim.ocean import Sea
from sim.ocean.radial.gerstner import draw_waves
from sim.ocean.radial.radial import RadialSea
from sim.ocean.radial.radial_grid import RadialGrid
from sim.ocean.spectra import SPECTRA

WAVES, RINGS, SPOKES = 64, 128, 128


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Rows of name, ms, ns per wave and vertex drawn, and the share of pairs drawn."""
    repeats = 31 if quick else 201
    return [frame_row(repeats), *against_square(repeats)]


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
