"""`springtide bench NAMES --compare A B`: the tables of two commits, measured in turns.

Each commit is checked out into a worktree of git in a temporary folder, and each run is a process of its own there. So
both are measured by the benchmarks of their own commit; rows and columns that only one of them has are left out.
"""

import csv
import json
import math
import os
import re
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from app.files import make_out_folder
from app.formats import text_tables
from app.study import tables
from sim.files import replacing
from sim.validation import argument_error

ROOT = Path(__file__).resolve().parents[1]
REPEATS = 5  # runs of each commit
TIME = re.compile(r"\[(s|ms|µs|ns|% of a core)\b[^\]]*\]$|^ns per ")  # in the name of a column


def git(root: Path, *arguments: str) -> str:
    """Output of git; raises ValueError with its message if it fails."""
    try:
        done = subprocess.run(["git", "-C", str(root), *arguments], capture_output=True, encoding="utf-8", check=False)
    except FileNotFoundError:
        raise ValueError("--compare: git is not installed") from None
    if done.returncode:
        raise ValueError(f"--compare: {done.stderr.strip() or 'git failed'}")
    return done.stdout.strip()


def commit_of(root: Path, name: str) -> str:
    """The hash of a commit; raises ValueError for a name that git does not know."""
    try:
        return git(root, "rev-parse", "--verify", "--quiet", "--end-of-options", f"{name}^{{commit}}")
    except ValueError:
        raise argument_error("--compare", name, "a commit, branch or tag of this repository") from None


def check_clean(root: Path) -> None:
    """Raises ValueError if tracked files differ from the last commit, as they would not be measured."""
    changed = git(root, "status", "--porcelain", "--untracked-files=no").splitlines()
    if changed:
        raise ValueError(f"--compare: commit or stash changes first, they are not measured: {changed[0].strip()}")


@contextmanager
def worktrees(root: Path, commits: list[str]) -> Iterator[list[Path]]:
    """A folder for each commit with its files, gone afterwards."""
    with tempfile.TemporaryDirectory(prefix="springtide-") as folder:
        places = [Path(folder, f"{index}-{commit[:8]}") for index, commit in enumerate(commits)]
        try:
            for commit, place in zip(commits, places, strict=True):
                git(root, "worktree", "add", "--detach", str(place), commit)
            yield places
        finally:
            for place in places:
                if place.exists():
                    git(root, "worktree", "remove", "--force", str(place))


def measure(place: Path, names: list[str], quick: bool, out: Path) -> dict[str, list[dict[str, str]]]:
    """The tables of a run in a worktree, by name; raises ValueError if it fails."""
    command = [sys.executable, "-m", "app", "bench", *names, "--out", str(out), *(["--quick"] if quick else [])]
    paths = [str(place), *filter(None, [os.environ.get("PYTHONPATH")])]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(paths)}
    done = subprocess.run(command, cwd=place, env=environment, capture_output=True, encoding="locale", check=False)
    if done.returncode:
        lines = (done.stderr or done.stdout).strip().splitlines()
        raise ValueError(f"--compare: the benchmark failed at {place.name}: {lines[-1] if lines else 'no message'}")
    found = {}
    for path in sorted(out.glob("*.csv")):
        with path.open(newline="", encoding="utf-8") as file:
            found[path.stem] = list(csv.DictReader(file))
    return found


def times_of(found: dict[str, list[dict[str, str]]]) -> dict[tuple[str, str, str], float]:
    """Every time in tables: (table, row, column) -> value. A row is named by its words, and its numbers of points."""
    values = {}
    for table, rows in found.items():
        for row in rows:
            is_time = {column: bool(TIME.search(column)) for column in row}
            words = [text for column, text in row.items() if not is_time[column] and is_name(column, text)]
            for column, text in row.items():
                if is_time[column] and text:
                    values[table, " ".join(words), column] = float(text)
    return {key: value for key, value in values.items() if math.isfinite(value) and value > 0.0}


def is_name(column: str, text: str) -> bool:
    """True if a cell tells rows apart: words, or a number of points or links."""
    try:
        float(text)
    except ValueError:
        return bool(text)
    return column in ("points", "links", "size")


def ratios(runs: list[tuple[dict, dict]]) -> text_tables.Rows:
    """A row a time: both medians, their ratio B / A, and the least and largest ratio of a pair of runs."""
    common = [key for key in runs[0][0] if all(key in times for pair in runs for times in pair)]
    rows = []
    for key in common:
        a, b = ([pair[side][key] for pair in runs] for side in (0, 1))
        pairs = [after / before for before, after in zip(a, b, strict=True)]
        medians = statistics.median(a), statistics.median(b)
        rows.append(
            {
                "row": f"{key[0]}: {key[1]}",
                "time": key[2],
                "A": medians[0],
                "B": medians[1],
                "B / A": medians[1] / medians[0],
                "least": min(pairs),
                "largest": max(pairs),
            }
        )
    return rows


def shown(row: dict) -> dict:
    """The row with its spread as one cell, as a table on a narrow screen has room for it."""
    cells = {name: value for name, value in row.items() if name not in ("least", "largest")}
    return {**cells, "of pairs": f"{row['least']:.2f} to {row['largest']:.2f}"}


def compare(
    names: list[str], commits: tuple[str, str], quick: bool = False, out: Path | None = None, root: Path = ROOT
) -> int:
    """Measure two commits in turns, print the ratios and, with `out`, write them as compare.json to this folder.

    Returns the exit status, 0. Raises ValueError for an unknown commit, for changes that are not committed, for a run
    that fails, and where the tables of both have no time in common.
    """
    if not names:
        raise ValueError("--compare: name the benchmarks to run")
    hashes = [commit_of(root, name) for name in commits]
    check_clean(root)
    make_out_folder("--out", out)
    print(tables.machine())
    runs: list[tuple[dict, dict]] = []
    with worktrees(root, hashes) as places, tempfile.TemporaryDirectory(prefix="springtide-") as results:
        for turn in range(-1, REPEATS):  # the first turn compiles
            found = [times_of(measure(place, names, quick, Path(results, f"{turn}-{place.name}"))) for place in places]
            if turn >= 0:
                runs.append((found[0], found[1]))
    rows = ratios(runs)
    if not rows:
        raise ValueError(f"--compare: both commits have no time in common in {' '.join(names)}")
    text_tables.print_table(f"A {hashes[0][:8]}, B {hashes[1][:8]}", [shown(row) for row in rows])
    if out is not None:
        kept = {"machine": tables.machine(), "names": names, "commits": hashes, "repeats": REPEATS, "rows": rows}
        with replacing(out / "compare.json") as draft:
            draft.write_text(json.dumps(kept, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
        print(f"saved in {out}")
    return 0
