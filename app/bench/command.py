"""`springtide bench`: every module of this package that has `rows(quick)` is a benchmark, found by being here.

A module may also have `findings(rows)`, a second table that the first one says; `peer_rows(quick)`, run when peers are
asked for; and `figures(rows)`, figures by file name.
"""

import importlib
import pkgutil
from pathlib import Path
from types import ModuleType

import app.bench.cases
from app.experiments import tables as report
from sim.files import replacing
from sim.validation import argument_error


def benchmarks() -> dict[str, ModuleType]:
    """Name -> module, in alphabetical order."""
    names = [info.name for info in pkgutil.iter_modules(app.bench.cases.__path__)]
    modules = {name: importlib.import_module(f"app.bench.cases.{name}") for name in names}
    return {name: module for name, module in modules.items() if hasattr(module, "rows")}


def run(names: list[str], quick: bool = False, peers: bool = False, out: Path | None = None) -> int:
    """Run the benchmarks named, or all; print their tables and, with `out`, keep tables and figures there.

    Returns the exit status, 0. Raises ValueError for an unknown name or an `out` that is not a folder.
    """
    known = benchmarks()
    for name in names:
        if name not in known:
            raise argument_error("bench", name, "one of " + ", ".join(known))
    report.make_folder(out)
    print(report.machine())
    for name in names or known:
        module = known[name]
        tables = {name: module.rows(quick)}
        if hasattr(module, "findings"):
            tables[f"{name}_findings"] = module.findings(tables[name])
        if peers and hasattr(module, "peer_rows"):
            tables[f"{name}_peers"] = module.peer_rows(quick)
        for title, rows in tables.items():
            report.show(title, rows)
            if out is not None:
                report.save_table(rows, out / f"{title}.csv")
        if out is not None and hasattr(module, "figures"):
            try:
                report.save_figures(module.figures(tables[name]), out)
            except ModuleNotFoundError as missing:
                print(f"no figures of {name}: {missing.name} is not installed (pip install 'springtide[plot]')")
    if out is not None:
        with replacing(out / "machine.txt") as draft:
            draft.write_text(report.machine() + "\n", encoding="utf-8")
        print(f"kept in {out}")
    return 0
