"""`springtide bench`: every module in cases/ is a benchmark, found by being there.

A benchmark has `rows(quick)`, its table. It may have `findings(rows)`, a second table drawn from the first;
`figures(rows)`, figures by file name; and `peer_rows(quick, words)`, the ladders of other programs.
"""

import functools
import importlib
import pkgutil
from collections.abc import Callable, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import app.bench.cases
from app.bench.peers import ladder
from app.experiments import tables
from sim.files import replacing
from sim.validation import argument_error, check_choice


def benchmarks() -> dict[str, ModuleType]:
    """Name -> module, in alphabetical order."""
    names = [info.name for info in pkgutil.iter_modules(app.bench.cases.__path__)]
    return {name: importlib.import_module(f"app.bench.cases.{name}") for name in names}


def run(names: list[str], quick: bool = False, peers: Sequence[str] | None = None, out: Path | None = None) -> int:
    """Run the named benchmarks, or all; print their tables and, with `out`, write tables and figures there.

    peers: None, or words; then the ladders of other programs are measured too; with words only those that have one of
    them in the names of task and peer, and nothing else. In `out` rows of other ladders stay as an earlier run left
    them. Returns the exit status, 0. Raises ValueError for an unknown benchmark, words that no ladder has, or an `out`
    that is not a folder.
    """
    known = benchmarks()
    for name in names:
        check_choice("bench", name, known)
    tables.make_folder(out)
    print(tables.machine())
    measured = not peers
    for name in names or known:
        case = known[name]
        if not peers:
            found = {name: case.rows(quick)}
            if hasattr(case, "findings"):
                found[f"{name}_findings"] = case.findings(found[name])
            keep(found, functools.partial(case.figures, found[name]) if hasattr(case, "figures") else dict, out)
        if peers is not None and hasattr(case, "peer_rows") and (rows := case.peer_rows(quick, peers)):
            measured = True
            if out is not None:
                rows = ladder.merged(out / f"{name}_peers.csv", rows)
            found = {f"{name}_peers": rows, f"{name}_peers_summary": ladder.summary(rows)}
            keep(found, functools.partial(ladder.figures, f"{name}_peers", rows), out)
    if not measured:
        raise argument_error("--peers", " ".join(peers or ()), "words of a task or peer, as 'R(16)' or 'scipy'")
    if out is not None:
        with replacing(out / "machine.txt") as draft:
            draft.write_text(tables.machine() + "\n", encoding="utf-8")
        print(f"kept in {out}")
    return 0


def keep(found: dict[str, tables.Rows], figures: Callable[[], dict[str, Any]], out: Path | None) -> None:
    """Print tables and, with `out`, write them and their figures there; figures only where matplotlib is installed."""
    for title, rows in found.items():
        tables.show(title, ladder.shown(rows) if title.endswith("_peers") else rows)
        if out is not None:
            tables.save_table(rows, out / f"{title}.csv")
    if out is None:
        return
    try:
        tables.save_figures(figures(), out)
    except ModuleNotFoundError as missing:
        print(f"no figures of {', '.join(found)}: {missing.name} is not installed (pip install '.[plot]')")
