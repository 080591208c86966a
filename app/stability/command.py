"""`springtide stability`: measure, show, and keep tables and figures."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from app.experiments import tables as report
from app.stability import drift, figures, linear, rope

PARTS: tuple[tuple[str, str, Any, Callable[[Any], Any], Callable[[Any], Any]], ...] = (
    ("linear", "Linear oscillator, h ω and ζ", linear, linear.boundary_rows, figures.linear_figure),
    ("rope", "Rope, step and stiffness", rope, rope.boundary_rows, figures.rope_figure),
    ("drift", "Energy of the undamped rope", drift, drift.course_rows, figures.drift_figure),
)


def run(quick: bool = False, out: Path | None = None, workers: int = 0) -> int:
    """Measure all maps on all cores and print their tables; with `out`, keep tables and figures there.

    Returns the exit status, 0. Raises ValueError for an `out` that is not a folder.
    """
    report.make_folder(out)
    print(report.machine())
    for name, title, part, details, figure in PARTS:
        found = part.measure(quick=quick, workers=workers)
        table = part.rows(found)
        report.show(title, table)
        if out is None:
            continue
        report.save_table(table, out / f"{name}.csv")
        report.save_table(details(found), out / f"{name}_curves.csv")
        try:
            report.save_figures({name: figure(found)}, out)
        except ModuleNotFoundError as missing:
            print(f"no figure of {name}: {missing.name} is not installed (pip install 'springtide[plot]')")
    if out is not None:
        (out / "machine.txt").write_text(report.machine() + "\n", encoding="utf-8")
        print(f"kept in {out}")
    return 0
