"""`springtide bench`: every module in cases/ is a benchmark, found by being there.

A benchmark has `rows(quick)`, its table. It may have `findings(rows)`, a second table drawn from the first, and
`figures(rows)`, figures by file name.
"""

import functools
import importlib
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

from app.files import make_out_folder
from app.formats import text_tables
from app.study import tables
from benchmarks.names import places
from benchmarks.peers.command import measure_peers
from sim.parameters import choice_error
from sim.validation import argument_error


def benchmarks() -> dict[str, ModuleType]:
    """Name -> module, in alphabetical order."""
    return {name: importlib.import_module(place) for name, place in places().items()}


def run(
    names: list[str],
    quick: bool = False,
    peers: Sequence[str] | None = None,
    out: Path | None = None,
    students: int | None = None,
) -> int:
    """Run the named benchmarks, or all; print their tables and, with `out`, write tables and figures there.

    peers: None, or words; then the ladders of other programs are measured too; with words only those that have one of
    them in the names of task and peer, and nothing else. students: of the benchmark "class". Returns the exit status,
    0. Raises ValueError for an unknown benchmark, students without "class", words that no ladder has, and an `out`
    that is not a folder.
    """
    known = benchmarks()
    for name in names:
        if name not in known:
            raise choice_error("bench", name, known)
    if students is not None and "class" not in names:
        raise argument_error("--students", students, "a number together with the benchmark class")
    make_out_folder("--out", out)
    print(tables.machine())
    for name in (names or known) if not peers else ():
        case = known[name]
        found = {name: case.rows(quick, students) if name == "class" else case.rows(quick)}
        if hasattr(case, "findings"):
            found[f"{name}_findings"] = case.findings(found[name])
        for title, rows in found.items():
            text_tables.print_table(title, rows)
        if out is not None:
            tables.write_results(
                found, functools.partial(case.figures, found[name]) if hasattr(case, "figures") else dict, out
            )
    if peers is not None:
        measure_peers(names, quick, peers, out)
    if out is not None:
        tables.keep_machine(out)
    return 0
