"""The list of faults: drawn at random over all of `sim` and `app`, of each module in proportion to its lines."""

import csv
import random
from pathlib import Path
from typing import NamedTuple

from tests.faults.sites import Fault, faults_in

ROOT = Path(__file__).parent.parent.parent
LIST = Path(__file__).parent / "faults.csv"
SEED = 20261126
LINES_PER_FAULT = 78


class Listed(NamedTuple):
    """A fault of the list, and why no test can notice it, or ""."""

    fault: Fault
    equivalent: str


def modules() -> list[str]:
    """The modules that faults are planted into."""
    return sorted(path.relative_to(ROOT).as_posix() for top in ("app", "sim") for path in (ROOT / top).rglob("*.py"))


def read_list() -> list[Listed]:
    """The committed list."""
    if not LIST.exists():
        return []
    with LIST.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return [
        Listed(
            Fault(row["module"], row["kind"], row["before"], int(row["occurrence"]), row["after"]), row["equivalent"]
        )
        for row in rows
    ]


def write_list(faults: list[Listed]) -> None:
    with LIST.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([*Fault._fields, "equivalent"])
        writer.writerows([*listed.fault, listed.equivalent] for listed in faults)


def drawn(module: str, source: str, kept: list[Listed]) -> list[Listed]:
    """The faults of a module: of those that it already has, and others, so many that it has its share.

    A module has one fault for so many lines, and one more with the probability that the rest asks for. Modules do not
    depend on each other, so that an edit of one leaves the faults of the others as they are.
    """
    faults = faults_in(module, source)
    random_numbers = random.Random(f"{SEED} {module}")
    share = int(source.count("\n") / LINES_PER_FAULT + random_numbers.random())
    chosen = [listed for listed in kept if listed.fault in faults][:share]
    taken = {(listed.fault.before, listed.fault.occurrence) for listed in chosen}
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
        for listed in drawn(module, (ROOT / module).read_text("utf-8"), [k for k in kept if k.fault.module == module])
    ]
