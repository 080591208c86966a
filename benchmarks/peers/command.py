"""`springtide bench --peers`: the ladders of other programs in the tasks of rope, knot, cloths, sea and mooring."""

import functools
from collections.abc import Sequence
from pathlib import Path

from app.formats import text_tables
from app.study import tables
from benchmarks.peers import ladder
from benchmarks.tasks import cloth, knot, mooring, rope, sea, stiff
from sim.validation import argument_error

TASKS = {"cloth": cloth, "knot": knot, "mooring": mooring, "rope": rope, "sea": sea, "stiff": stiff}


def measure_peers(names: Sequence[str], quick: bool, words: Sequence[str], out: Path | None) -> None:
    """Measure the ladders of the named tasks, or of all; print their tables and, with `out`, write them there.

    words: if there are any, only ladders with one of them in the names of task and peer. In `out`, rows of other
    ladders stay as an earlier run left them. Raises ValueError for words that no ladder has.
    """
    measured = False
    for name, task in TASKS.items():
        rows = task.peer_rows(quick, words) if name in names or not names else []
        if not rows:
            continue
        measured = True
        if out is not None:
            rows = ladder.merged(out / f"{name}_peers.csv", rows)
        summary = ladder.summary(rows)
        text_tables.print_table(f"{name}_peers", ladder.shown(rows))
        text_tables.print_table(f"{name}_peers_summary", summary)
        if out is not None:
            found = {f"{name}_peers": rows, f"{name}_peers_summary": summary}
            tables.write_results(found, functools.partial(ladder.figures, f"{name}_peers", rows), out)
    if words and not measured:
        raise argument_error("--peers", " ".join(words), "words of a task or peer, as 'R(16)' or 'scipy'")
