"""Names of the benchmarks, read from the files that hold them."""

from pathlib import Path

CASES = Path(__file__).with_name("cases")


def places() -> dict[str, str]:
    """Name of each benchmark -> its module, in alphabetical order."""
    files = {path.stem: f"benchmarks.cases.{path.parent.name}.{path.stem}" for path in CASES.glob("*/[!_]*.py")}
    return {name.rstrip("_"): files[name] for name in sorted(files)}  # `class_` for the word `class`
