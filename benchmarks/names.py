"""Names of the benchmarks, read from the files that hold them."""

import pkgutil
from pathlib import Path

CASES = Path(__file__).with_name("cases")


def places() -> dict[str, str]:
    """Name of each benchmark -> its module, in alphabetical order."""
    names = sorted(info.name for info in pkgutil.iter_modules([str(CASES)]))
    return {name.rstrip("_"): f"benchmarks.cases.{name}" for name in names}  # `class_` for the word `class`
