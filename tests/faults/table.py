"""What was found, by package."""

from collections import Counter

from tests.faults.running import read_results

RESULTS = ("found", "not found", "equivalent", "open")


def package_of(module: str) -> str:
    parts = module.split("/")
    return "/".join(parts[:2]) if parts[0] == "sim" and len(parts) > 2 else "sim" if parts[0] == "sim" else "app/scenes"


def print_table() -> None:
    """As a table in Markdown."""
    counts = Counter((package_of(row["module"]), row["result"]) for row in read_results().values())
    print("| in | found | not found | equivalent | open | found, at least |\n|---|---|---|---|---|---|")
    packages = sorted({package for package, _ in counts})
    for package in [*packages, "all"]:
        found, missed, same, left = (
            sum(n for (p, r), n in counts.items() if r == result and package in (p, "all")) for result in RESULTS
        )
        share = f"{100.0 * found / tried:.0f} %" if (tried := found + missed + left) else ""
        print(f"| {package} | {found} | {missed} | {same} | {left} | {share} |")
