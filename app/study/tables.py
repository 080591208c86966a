"""Tables on screen and as CSV, and work-precision figures as SVG and PNG, for bench, stability and sweep."""

import csv
import os
import platform
from collections.abc import Callable, Iterable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np

from app.formats.text_tables import Rows, columns
from app.scenes.charts import PALETTE
from sim.files import replacing

# Curves that share a colour differ in shape.
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*", "<", ">", "h", "p", "d")


def machine() -> str:
    """The machine and the versions that results were measured with, in one line."""
    name = platform.processor() or platform.machine()
    try:
        models = [
            line for line in Path("/proc/cpuinfo").read_text("utf-8").splitlines() if line.startswith("model name")
        ]
        name = models[0].partition(":")[2].strip() if models else name
    except OSError:
        pass
    versions = [f"Python {platform.python_version()}"]
    for package in ("springtide", "numpy", "numba", "viser"):
        try:
            versions.append(f"{package} {version(package)}")
        except PackageNotFoundError:
            versions.append(f"{package} from its sources")
    return f"{name}, {os.cpu_count()} cores; {platform.system()}; {', '.join(versions)}"


def save_table(rows: Rows, path: Path) -> None:
    """Write one CSV file, with units in the names of the columns."""
    with replacing(path) as draft, draft.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns(rows))
        writer.writeheader()
        writer.writerows(rows)


def save_figures(figures: dict[str, Any], folder: Path) -> list[Path]:
    """Write each figure by its name, as SVG and as PNG; returns the paths."""
    paths = []
    for name, figure in figures.items():
        for suffix in ("svg", "png"):
            paths.append(folder / f"{name}.{suffix}")
            with replacing(paths[-1]) as draft:
                figure.savefig(draft, dpi=150, bbox_inches="tight")
    return paths


def write_results(rows_by_name: dict[str, Rows], figures: Callable[[], dict[str, Any]], out: Path) -> None:
    """Write tables and their figures to a folder; figures only if matplotlib is installed."""
    for title, rows in rows_by_name.items():
        save_table(rows, out / f"{title}.csv")
    try:
        save_figures(figures(), out)
    except ModuleNotFoundError as missing:
        print(f"no figures of {', '.join(rows_by_name)}: {missing.name} is not installed (pip install '.[plot]')")


def keep_machine(out: Path) -> None:
    """Write the machine that the tables of a folder were measured on, and print where they are."""
    with replacing(out / "machine.txt") as draft:
        draft.write_text(machine() + "\n", encoding="utf-8")
    print(f"saved in {out}")


def front(rows: Rows) -> list[str]:
    """Methods with a run that no other run beats in both time and error."""
    points = [(row["error [m]"], row["least [ms]"], row["method"]) for row in rows]
    ahead = [
        name for error, time, name in points if not any(other < error and took < time for other, took, _ in points)
    ]
    return list(dict.fromkeys(ahead))


def edges(values: np.ndarray, *, logarithmic: bool = False) -> np.ndarray:
    """Edges (n + 1,) of the cells of `values` (n,), halfway between them or between their logarithms."""
    v = np.log(values) if logarithmic else np.asarray(values, float)
    middle = 0.5 * (v[1:] + v[:-1])
    boundaries = np.concatenate([[2 * v[0] - middle[0]], middle, [2 * v[-1] - middle[-1]]])
    return np.exp(boundaries) if logarithmic else boundaries


def draw_map(axes: Any, x: np.ndarray, y: np.ndarray, values: Any, *, log: tuple[bool, bool], **colours: Any) -> Any:
    """Draw values (rows, cols) as cells about x (cols,) and y (rows,); returns the image.

    log: whether x and y are even in their logarithms. colours: of matplotlib's pcolormesh.
    """
    edges_x, edges_y = edges(x, logarithmic=log[0]), edges(y, logarithmic=log[1])
    image = axes.pcolormesh(edges_x, edges_y, values, rasterized=True, **colours)
    axes.set_xscale("log" if log[0] else "linear")
    axes.set_yscale("log" if log[1] else "linear")
    axes.set_xlim(edges_x[0], edges_x[-1])
    axes.set_ylim(edges_y[0], edges_y[-1])
    return image


def slope_mark(axes: Any, x: float, y: float, order: int) -> None:
    """A small triangle with the slope of a method of `order`, its upper left corner at (x, y)."""
    right, low = 2.0 * x, y / 2.0**order
    axes.plot([x, x, right, x], [y, low, low, y], color="0.45", linewidth=0.9)
    axes.annotate(str(order), (x, (y * low) ** 0.5), (-4, 0), textcoords="offset points", ha="right", va="center",
                  fontsize=8, color="0.3")  # fmt: skip


def mark_slopes(axes: Any, curves: Iterable[tuple[list[float], list[float]]]) -> None:
    """Mark each whole order that a curve clearly has, below the middle of the first such curve."""
    marked = set()
    for x, y in curves:
        good = [(a, b) for a, b in zip(x, y, strict=True) if b > 0.0 and np.isfinite(b)]
        if len(good) < 3:
            continue
        logs = np.log(np.array(good))
        slope = -float(np.polyfit(logs[:, 0], logs[:, 1], 1)[0])
        middle = good[len(good) // 2]
        order = round(slope)
        if abs(slope - order) < 0.3 and order > 0 and order not in marked:
            slope_mark(axes, middle[0], middle[1] / 4.0, order)
            marked.add(order)


def work_precision(rows: Rows, title: str) -> Any:
    """Errors over run time and over force evaluations, one curve for each method, in logarithmic axes."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.0, 5.2), layout="constrained")
    figure.suptitle(title)
    panels = figure.subplots(1, 2, sharey=True)
    methods = list(dict.fromkeys(row["method"] for row in rows))
    for axes, column, label in zip(
        panels,
        ("least [ms]", "force evaluations"),
        ("run time, the least of repeats [ms]", "force evaluations"),
        strict=True,
    ):
        curves = []
        for index, method in enumerate(methods):
            own = sorted((row for row in rows if row["method"] == method), key=lambda row: row["force evaluations"])
            x, y = [row[column] for row in own], [row["error [m]"] for row in own]
            dash = "-" if index < len(PALETTE) else "--"
            style = {"color": PALETTE[index % 8], "marker": MARKERS[index % 13], "markersize": 5, "linestyle": dash}
            axes.loglog(x, y, label=method.replace("_", " "), **style)
            curves.append((x, y))
        if column == "force evaluations":
            mark_slopes(axes, curves)
        axes.set_xlabel(label)
        axes.grid(visible=True, which="major", color="0.9")
        axes.spines[["top", "right"]].set_visible(False)
    floor = max(row["reference good to [m]"] for row in rows)
    panels[0].set_ylabel("error [m]")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=6, frameon=False, fontsize=8)
    for axes in panels:
        axes.axhline(floor, color="0.6", linestyle=":", linewidth=1.0)
    panels[1].annotate("reference good to here", (0.02, floor), (0, 3), xycoords=("axes fraction", "data"),
                       textcoords="offset points", ha="left", fontsize=8, color="0.4")  # fmt: skip
    return figure
