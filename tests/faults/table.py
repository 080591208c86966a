"""Results of the planted faults, by package."""

from collections import Counter

from tests.faults.drawing import LINES_PER_FAULT, SEED, read_list
from tests.faults.running import key_of_fault, read_results

RESULTS = ("found", "long", "not found", "open", "untried")
# Deeper than packages, and counted in them too.
PARTS = ("app/scenes/mooring",)


def rows_of(module: str) -> list[str]:
    """The rows of the table that a module counts in."""
    folders = module.split("/")[:-1]
    return ["all", "/".join(folders[:2]), *(part for part in PARTS if module.startswith(f"{part}/"))]


def counts() -> Counter[tuple[str, str]]:
    """Number of faults by package and result; the whole list counts, whether tried or not."""
    results = read_results()
    found: Counter[tuple[str, str]] = Counter()
    for listed in read_list():
        row = results.get(key_of_fault(listed))
        result = "equivalent" if listed.equivalent else row["result"] if row else "untried"
        for package in rows_of(listed.fault.module):
            found[package, result if result in (*RESULTS, "equivalent") else "untried"] += 1
    return found


def print_table() -> None:
    """As a table in Markdown. Found is what a test of README's command has noticed, long what only a longer one has."""
    found = counts()
    print(f"Seed {SEED}, a fault for {LINES_PER_FAULT} lines.\n")
    print(f"| in | {' | '.join(RESULTS)} | equivalent | found |\n|---|{'---|' * (len(RESULTS) + 2)}")
    for package in [*sorted({package for package, _ in found} - {"all"}), "all"]:
        numbers = [found[package, result] for result in RESULTS]
        ratio = f"{100.0 * numbers[0] / total:.0f} %" if (total := sum(numbers)) else ""
        print(f"| {package} | {' | '.join(map(str, numbers))} | {found[package, 'equivalent']} | {ratio} |")
