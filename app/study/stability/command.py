"""`springtide stability`: measure, print tables, and write tables and figures."""

import argparse
import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any

from app.files import make_out_folder
from app.formats import text_tables
from app.study import tables
from app.study.stability import damping, drift, figures, linear, rope

PARTS: tuple[tuple[str, str, Any, Callable[[Any], Any], Callable[[Any], Any]], ...] = (
    ("linear", "Linear oscillator, h ω and ζ", linear, linear.boundary_rows, figures.linear_figure),
    ("rope", "Rope, step and stiffness", rope, rope.boundary_rows, figures.rope_figure),
    ("damping", "Networks, step and damping", damping, damping.curve_rows, figures.damping_figure),
    ("drift", "Energy of the undamped rope", drift, drift.course_rows, figures.drift_figure),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of the command."""
    parser.add_argument("--quick", action="store_true", help="coarse maps: within a minute")
    parser.add_argument("--out", type=Path, metavar="DIR", help="write tables (CSV) and figures to this folder")


def run(arguments: argparse.Namespace) -> int:
    """Measure the maps; returns the exit status."""
    return measure_maps(quick=arguments.quick, out=arguments.out)


def measure_maps(*, quick: bool, out: Path | None, workers: int = 0) -> int:
    """Measure all maps and print their tables; with `out`, write tables and figures there.

    workers: processes, 0 for one on each core.

    Returns the exit status, 0. Raises ValueError for an `out` that is not a folder.
    """
    make_out_folder("--out", out)
    print(tables.machine())
    for name, title, part, details, figure in PARTS:
        maps = part.measure(quick=quick, workers=workers)
        table = part.rows(maps)
        text_tables.print_table(title, table)
        if out is None:
            continue
        rows_by_name = {name: table, f"{name}_curves": details(maps)}
        tables.write_results(rows_by_name, functools.partial(named_figure, name, figure, maps), out)
    if out is not None:
        tables.keep_machine(out)
    return 0


def named_figure(name: str, figure: Callable[[Any], Any], maps: Any) -> dict[str, Any]:
    """The figure of a map, by its name."""
    return {name: figure(maps)}
