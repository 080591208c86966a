"""`springtide bench`: every module in cases/ is a benchmark, found by being there.

A benchmark has `rows(quick)`, its table. It may have `findings(rows)`, a second table drawn from the first;
`peer_rows(quick)`, run when peers are asked for, and `peer_findings` and `peer_figures` of those rows; and
`figures(rows)`, figures by file name.
"""

import importlib
import pkgutil
from pathlib import Path
from types import ModuleType

import app.bench.cases
from app.experiments import tables
from sim.files import replacing
from sim.validation import check_choice


def benchmarks() -> dict[str, ModuleType]:
    """Name -> module, in alphabetical order."""
    names = [info.name for info in pkgutil.iter_modules(app.bench.cases.__path__)]
    return {name: importlib.import_module(f"app.bench.cases.{name}") for name in names}


def run(names: list[str], quick: bool = False, peers: bool = False, out: Path | None = None) -> int:
    """Run the named benchmarks, or all; print their tables and, with `out`, write tables and figures there.

    Returns the exit status, 0. Raises ValueError for an unknown name or an `out` that is not a folder.
    """
    known = benchmarks()
    for name in names:
        check_choice("bench", name, known)
    tables.make_folder(out)
    print(tables.machine())
    for name in names or known:
        module = known[name]
        found = {name: module.rows(quick)}
        if hasattr(module, "findings"):
            found[f"{name}_findings"] = module.findings(found[name])
        if peers and hasattr(module, "peer_rows"):
            found[f"{name}_peers"] = module.peer_rows(quick)
            if hasattr(module, "peer_findings"):
                found[f"{name}_peers_summary"] = module.peer_findings(found[f"{name}_peers"])
        for title, rows in found.items():
            tables.show(title, rows)
            if out is not None:
                tables.save_table(rows, out / f"{title}.csv")
        if out is not None and hasattr(module, "figures"):
            try:
                tables.save_figures(module.figures(found[name]), out)
                if f"{name}_peers" in found and hasattr(module, "peer_figures"):
                    tables.save_figures(module.peer_figures(found[f"{name}_peers"]), out)
            except ModuleNotFoundError as missing:
                print(f"no figures of {name}: {missing.name} is not installed (pip install '.[plot]')")
    if out is not None:
        with replacing(out / "machine.txt") as draft:
            draft.write_text(tables.machine() + "\n", encoding="utf-8")
        print(f"kept in {out}")
    return 0
