"""The list of faults: drawn with a fixed seed, evenly over the modules of `sim` and the numbers that scenes report."""

import csv
import random
from pathlib import Path
from typing import NamedTuple

from tests.faults.sites import Fault, faults_in

ROOT = Path(__file__).parent.parent.parent
LIST = Path(__file__).parent / "faults.csv"
SEED = 20261122
LINES_PER_FAULT, FEWEST, MOST = 45, 2, 7  # of a module
COMPILER = {"sim/jit.py", "sim/compiler.py", "sim/files.py"}  # they hold no physics
REPORTED = ("report.py", "html.py", "measures.py", "statistics.py", "charts.py", "scene.py")
DRAWN = ("radiated_waves.py", "tile_mesh.py", "tracking.py")  # of scenes: the numbers that are drawn or dragged


class Listed(NamedTuple):
    """A fault of the list, and why no test can notice it, or ""."""

    fault: Fault
    equivalent: str


def modules() -> list[str]:
    """The modules that faults are planted into."""
    sim = list((ROOT / "sim").rglob("*.py"))
    sim += (ROOT / "app" / "formats").rglob("*.py")
    reported = [path for path in (ROOT / "app" / "scenes").rglob("*.py") if path.name in (*REPORTED, *DRAWN)]
    names = sorted(path.relative_to(ROOT).as_posix() for path in [*sim, *reported])
    return [name for name in names if name not in COMPILER]


def read_list() -> list[Listed]:
    """The committed list."""
    if not LIST.exists():
        return []
    with LIST.open(newline="") as file:
        rows = list(csv.DictReader(file))
    return [
        Listed(
            Fault(row["module"], row["kind"], row["before"], int(row["occurrence"]), row["after"]), row["equivalent"]
        )
        for row in rows
    ]


def write_list(faults: list[Listed]) -> None:
    with LIST.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([*Fault._fields, "equivalent"])
        writer.writerows([*listed.fault, listed.equivalent] for listed in faults)


def drawn(module: str, source: str, kept: list[Listed]) -> list[Listed]:
    """The faults of a module: those that it already has, and so many more that it has its share."""
    faults = faults_in(module, source)
    share = min(MOST, max(FEWEST, round(source.count("\n") / LINES_PER_FAULT)))
    chosen = [listed for listed in kept if listed.fault in faults]
    taken = {(listed.fault.before, listed.fault.occurrence) for listed in chosen}
    random_numbers = random.Random(f"{SEED} {module}")
    # Kinds come evenly, as constants and operators would be nearly all of a list drawn from all places.
    while len(chosen) < share:
        kinds: dict[str, list[Fault]] = {}
        for fault in faults:
            if (fault.before, fault.occurrence) not in taken:
                kinds.setdefault(fault.kind, []).append(fault)
        if not kinds:
            break
        fault = random_numbers.choice(kinds[random_numbers.choice(sorted(kinds))])
        taken.add((fault.before, fault.occurrence))
        chosen.append(Listed(fault, ""))
    return chosen


def draw() -> list[Listed]:
    """The list, drawn anew where the sources no longer have a line of it."""
    kept = read_list()
    return [
        listed
        for module in modules()
        for listed in drawn(module, (ROOT / module).read_text(), [k for k in kept if k.fault.module == module])
    ]
