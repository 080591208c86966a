"""The figures: a small map for each integrator, and energy errors over time. Matplotlib is imported on use."""

import math
from typing import Any

import numpy as np

from app.render.colormap import OUTCOME_COLOURS
from app.scenes.charts import PALETTE
from app.study.stability.damping import DampingRow
from app.study.stability.drift import Drift
from app.study.stability.linear import LinearMap, extra_damping
from app.study.stability.rope import RopeMap
from app.study.tables import MARKERS, draw_map
from sim.springs import INTEGRATORS
from sim.springs.stability import TOLERANCE

COLUMNS = 4  # of maps in a figure
GROWTH_COLOUR = "#D55E00"  # Okabe and Ito's vermilion


def panels(count: int, title: str) -> tuple[Any, list[Any], list[Any]]:
    """A figure of `count` panels with common axes; the panels at its lower edge; all panels."""
    from matplotlib.figure import Figure

    down = math.ceil(count / COLUMNS)
    across = min(count, COLUMNS)
    figure = Figure(figsize=(2.9 * across + 0.9, 2.6 * down + 0.9), layout="constrained")
    figure.suptitle(title)
    grid = figure.subplots(down, across, sharex=True, sharey=True, squeeze=False).ravel().tolist()
    for axes in grid[count:]:
        axes.set_visible(False)
    # A panel without another below it shows the labels of its column.
    for index in range(count):
        if index + across >= count:
            grid[index].tick_params(labelbottom=True)
    return figure, [grid[i] for i in range(count) if i + across >= count], grid[:count]


def linear_figure(maps: list[LinearMap]) -> Any:
    """Damping that the method adds in colours, growth in one, limits as lines and marks, and a line of 1 % error."""
    from matplotlib.colors import ListedColormap
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    figure, lowest, grid = panels(len(maps), "x'' + 2 ζ ω x' + ω² x = 0, one step of h after the other")
    shades = None
    for axes, linear_map in zip(grid, maps, strict=True):
        extra = np.ma.masked_invalid(np.where(linear_map.rates > 0.0, np.nan, extra_damping(linear_map)))
        plane = linear_map.steps, linear_map.zetas
        shades = draw_map(axes, *plane, extra, log=(False, False), cmap="PRGn", vmin=-0.5, vmax=0.5)
        grows = np.ma.masked_where(~(linear_map.rates > 0.0), np.ones_like(linear_map.rates))
        draw_map(axes, *plane, grows, log=(False, False), cmap=ListedColormap([GROWTH_COLOUR]))
        fine = np.linspace(0.0, linear_map.zetas[-1], 400)
        if not np.isnan(linear_map.measured[1:]).all():
            limits = [INTEGRATORS[linear_map.name].limit(float(z)) for z in fine]
            axes.plot(limits, fine, color="black", linewidth=1.4)
        wrong = np.where(linear_map.rates > 0.0, np.nan, linear_map.errors)
        if np.isfinite(wrong[1:]).any():
            axes.contour(*plane, wrong, levels=[TOLERANCE], colors="black", linestyles="dashed", linewidths=1.2)
        every = max(1, len(linear_map.zetas) // 20)
        marks = np.where(np.isfinite(linear_map.measured), linear_map.measured, np.nan)[::every]
        axes.plot(marks, linear_map.zetas[::every], "o", color="white", markeredgecolor="black", markersize=3.5)
        axes.set_title(linear_map.name.replace("_", " "), fontsize=10)
        if not np.isfinite(linear_map.rates[1:]).any():
            axes.text(2.0, 1.0, "takes no damping", ha="center", color="0.4")
    for axes in lowest:
        axes.set_xlabel("h ω")
    for axes in grid[::COLUMNS]:
        axes.set_ylabel("damping ratio ζ")
    assert shades is not None
    figure.colorbar(shades, ax=grid, label="damping ratio that the method adds", extend="both", shrink=0.7)
    figure.legend(
        handles=[
            Patch(color=GROWTH_COLOUR, label="grows"),
            Line2D([], [], color="black", label="limit of theory"),
            Line2D([], [], color="black", linestyle="dashed", label="right to 1 %"),
            Line2D([], [], color="white", marker="o", markeredgecolor="black", label="measured limit"),
        ],
        loc="outside lower center", ncols=4, frameon=False,
    )  # fmt: skip
    return figure


def rope_figure(maps: list[RopeMap]) -> Any:
    """Outcomes in three colours, and `critical_step` and `accurate_step` as lines."""
    from matplotlib.colors import ListedColormap
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    figure, lowest, grid = panels(len(maps), "The lab's rope of ten points at rest, with a small disturbance")
    colours = ListedColormap(list(OUTCOME_COLOURS.values()))
    for axes, rope_map in zip(grid, maps, strict=True):
        plane = rope_map.steps, rope_map.stiffnesses
        draw_map(axes, *plane, rope_map.outcomes, log=(True, True), cmap=colours, vmin=0, vmax=2)
        axes.plot(rope_map.theory, rope_map.stiffnesses, color="black", linewidth=1.4)
        axes.plot(rope_map.accurate, rope_map.stiffnesses, color="black", linewidth=1.2, linestyle="dashed")
        axes.set_title(rope_map.name.replace("_", " "), fontsize=10)
    for axes in lowest:
        axes.set_xlabel("step h [s]")
    for axes in grid[::COLUMNS]:
        axes.set_ylabel("stiffness k [N/m]")
    handles: list[Any] = [Patch(color=colour, label=name) for name, colour in OUTCOME_COLOURS.items()]
    handles.append(Line2D([], [], color="black", label="critical_step"))
    handles.append(Line2D([], [], color="black", linestyle="dashed", label="accurate_step"))
    figure.legend(handles=handles, loc="outside lower center", ncols=5, frameon=False)
    return figure


def damping_figure(damping_rows: list[DampingRow]) -> Any:
    """Measured limits as marks and `critical_step` as lines, for each network; methods without a limit are left out."""
    names = list(dict.fromkeys(row.net for row in damping_rows))
    figure, lowest, grid = panels(len(names), "The largest stable step over damping: marks measured, lines by theory")
    for axes, name in zip(grid, names, strict=True):
        limited = [row for row in damping_rows if row.net == name and np.isfinite(row.theory[1:]).any()]
        for index, row in enumerate(limited):
            colour, marker = PALETTE[index % 8], MARKERS[index % 8]
            axes.loglog(row.dampings, row.theory, color=colour, linewidth=1.2)
            axes.loglog(row.dampings, row.measured, marker, color=colour, label=row.name.replace("_", " "))
        axes.set_title(name, fontsize=10)
    for axes in lowest:
        axes.set_xlabel("damping [N s/m]")
    grid[0].set_ylabel("step h [s]")
    figure.legend(*grid[0].get_legend_handles_labels(), loc="outside lower center", ncols=4, frameon=False)
    return figure


def drift_figure(drifts: list[Drift]) -> Any:
    """Energy errors over time: symplectic methods on the left, the others on the right."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.0, 4.2), layout="constrained")
    figure.suptitle("Energy of the undamped rope of ten points, swinging from 5°")
    for axes, symplectic in zip(figure.subplots(1, 2, sharey=True), (True, False), strict=True):
        for index, drift in enumerate(drift for drift in drifts if drift.symplectic == symplectic):
            size = np.maximum.accumulate(np.abs(drift.error[1:]))
            style = {"color": PALETTE[index % 8], "marker": MARKERS[index % 8], "markevery": 0.1}
            diverged = drift.t[np.isnan(drift.error)]
            label = drift.name.replace("_", " ") + (f" (diverged at {diverged[0]:.0f} s)" if len(diverged) else "")
            axes.loglog(drift.t[1:], size, label=label, linewidth=1.2, markersize=5, **style)
        axes.set_ylim(1e-15, 1e2)
        axes.set_title("symplectic" if symplectic else "not symplectic", fontsize=10)
        axes.set_xlabel("time [s]")
        axes.grid(visible=True, which="major", color="0.9")
        axes.spines[["top", "right"]].set_visible(False)
        axes.legend(frameon=False, fontsize=9, loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=3)
        if symplectic:
            axes.set_ylabel("largest energy error so far / energy of the swing")
    return figure
