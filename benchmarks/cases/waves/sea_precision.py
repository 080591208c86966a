"""Error against time of the square sea, over its size, in both precisions, against a plain sum of waves; and of a
height query in three ways.

The reference is the same sea (its amplitudes belong to wavenumbers) at twice the largest size, in double precision.
Errors are rms over the rms height, so that seas can be compared. The error of the wind sea is the waves that a grid
leaves out. The second sea is smoothed by the lab's low-pass, so that its error is the rounding of the transforms.
"""

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from app.scenes.charts import PALETTE
from app.study.tables import MARKERS
from sim.ocean import Sea
from sim.ocean.radial.wave_sum import Bands, VertexSums, add_waves, wave_rows
from sim.ocean.tile.query import sample

LENGTH = 500.0  # [m] of the tile
T = 5.0  # [s]
COMPARED_SIDE = 64  # points a side at which the methods are compared
SEAS = {"wind sea": 0.0, "sea without waves below 25 m": 4.0}  # low-pass l [m]
ALL_FIELDS = ("height", "displacement", "slope", "strain")  # eight numbers a point, as many as the sum of waves gives
QUERY_POINTS = 256


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Rows with task, method, size (of the grid, or number of waves), ms (least of repeats), error, residual [m]."""
    repeats = 5 if quick else 25
    sizes = (64, 128, 256) if quick else (64, 128, 256, 512)
    found = []
    for name, low_pass in SEAS.items():
        finest = sea_of(2 * sizes[-1], "double", low_pass)
        truth = np.array(finest.surface(T).height[:: finest.size // COMPARED_SIDE, :: finest.size // COMPARED_SIDE])
        cases = [(f"transforms, {p}", n, *by_transforms(n, p, low_pass)) for p in ("single", "double") for n in sizes]
        counts = (16, 64, 256, 1024) if quick else (16, 64, 256, 1024, 4096, 16384)
        cases += [("sum of the highest waves", n, by_sum(finest, n), nothing) for n in counts]
        found += [
            {"task": f"eight fields, {name}", "method": method, "size": size} | scored(run, truth, repeats, before)
            for method, size, run, before in cases
        ]
    return found + query_rows(sizes, repeats)


def sea_of(size: int, precision: str, low_pass: float) -> Sea:
    """The sea at one size [points a side] and precision. low_pass: [m]."""
    return Sea(size=size, length=LENGTH, low_pass=low_pass, precision=precision)


def nothing() -> None:
    """The preparation of a run that needs none."""


def scored(
    run: Callable[[], np.ndarray], truth: np.ndarray, repeats: int, before: Callable[[], Any] = nothing
) -> dict[str, float]:
    """The least time of a run [ms], without its preparation `before`, and the rms error over the rms height."""
    error = float(np.sqrt(((run() - truth) ** 2).mean() / (truth**2).mean()))
    least = np.inf
    for _ in range(repeats):
        before()
        start = time.perf_counter()
        run()
        least = min(least, time.perf_counter() - start)
    return {"ms": 1e3 * least, "error": error}


def by_transforms(size: int, precision: str, low_pass: float) -> tuple[Callable[[], np.ndarray], Callable[[], Any]]:
    """(run, preparation). The run computes all fields on the whole grid and returns heights at the compared points; the
    preparation asks for another time, so that T is a new time again.
    """
    sea = sea_of(size, precision, low_pass)

    def run() -> np.ndarray:
        surface = sea.surface(T)
        for field in ALL_FIELDS:
            getattr(surface, field)
        return surface.height[:: size // COMPARED_SIDE, :: size // COMPARED_SIDE]

    return run, lambda: sea.surface(0.0).height


def by_sum(sea: Sea, count: int) -> Callable[[], np.ndarray]:
    """The `count` highest waves of the sea, added at COMPARED_SIDE x COMPARED_SIDE points in single precision."""
    h0 = sea.amplitudes_at(0.0)
    order = np.argsort(-np.abs(h0), axis=None)[:count]
    i, j = np.unravel_index(order, h0.shape)
    kx, ky, h = sea.k[i], sea.k[j], h0[i, j]
    turns = (np.angle(h) - sea.frequencies[i, j] * T) / (2.0 * np.pi)
    waves = wave_rows(kx, ky, turns, 2.0 * np.abs(h), 1.0, count)
    x = np.arange(COMPARED_SIDE) * LENGTH / COMPARED_SIDE
    X, Y = (grid.astype(np.float32).ravel() for grid in np.meshgrid(x, x, indexing="ij"))
    start, active = np.array([0, X.size], np.uint64), np.array([count], np.uint64)
    bands = Bands(X, Y, start, active, np.ones((1, count), np.float32))
    sums = np.zeros((8, X.size), np.float32)

    def run() -> np.ndarray:
        sums[...] = 0.0
        add_waves(bands, waves, VertexSums(*sums))
        return sums[0].reshape(COMPARED_SIDE, COMPARED_SIDE)

    return run


def query_rows(sizes: tuple[int, ...], repeats: int) -> list[dict[str, Any]]:
    """The height above some points of a sea without short waves, with the fields computed already."""
    points = np.random.default_rng(0).uniform(0.0, LENGTH, (QUERY_POINTS, 2))
    low_pass = SEAS["sea without waves below 25 m"]
    truth = sea_of(sizes[-1], "double", low_pass).height_at(points, T, exact=True)[0]
    found = []
    for size in (32, *sizes):
        sea = sea_of(size, "single", low_pass)
        surface, cell, above = sea.surface(T), LENGTH / size, np.empty(QUERY_POINTS)

        def straight(surface=surface, cell=cell, above=above) -> np.ndarray:
            sample(points, surface.height, cell, above)
            return above

        ways: dict[str, Callable[[], np.ndarray]] = {
            "grid point below, as if it had not moved": straight,
            "label searched, bicubic": lambda sea=sea: sea.height_at(points, T)[0],
        }
        if size <= 128:
            ways["label searched, all waves summed"] = lambda sea=sea: sea.height_at(points, T, exact=True)[0]
        for method, way in ways.items():
            residual = {} if way is straight else {"residual [m]": residual_of(sea, points, "summed" in method)}
            found.append(
                {"task": f"height above {QUERY_POINTS} points", "method": method, "size": size}
                | scored(way, truth, 1 if "summed" in method else repeats)
                | residual
            )
    return found


def residual_of(sea: Sea, points: np.ndarray, exact: bool) -> float:
    """The largest residual [m] of a height query."""
    return float(sea.height_at(points, T, exact=exact)[1].max())


def figures(table: list[dict[str, Any]]) -> dict[str, Any]:
    """Error over time: a panel for each task, a curve for each method; each point is labelled with its size."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(14.0, 4.6), layout="constrained")
    figure.suptitle("The square sea: error against time")
    tasks = list(dict.fromkeys(row["task"] for row in table))
    for axes, task in zip(figure.subplots(1, len(tasks)), tasks, strict=True):
        own = [row for row in table if row["task"] == task]
        for index, method in enumerate(dict.fromkeys(row["method"] for row in own)):
            curve = [row for row in own if row["method"] == method]
            x, y = [row["ms"] for row in curve], [row["error"] for row in curve]
            axes.loglog(x, y, label=method, color=PALETTE[index], marker=MARKERS[index], markersize=5)
            for row in curve:
                axes.annotate(
                    str(row["size"]), (row["ms"], row["error"]), (4, 3), textcoords="offset points", fontsize=7
                )
        axes.set_title(task, fontsize=10)
        axes.set_xlabel("least time [ms]")
        axes.grid(visible=True, which="major", color="0.9")
        axes.spines[["top", "right"]].set_visible(False)
        axes.legend(frameon=False, fontsize=8)
    figure.axes[0].set_ylabel("rms error / rms height")
    return {"sea_precision": figure}
