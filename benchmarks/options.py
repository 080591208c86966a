"""Names of the benchmarks and options of their command; imports none of them, as every command reads this."""

import argparse
import pkgutil
from pathlib import Path

CASES = Path(__file__).with_name("cases")


def places() -> dict[str, str]:
    """Name of each benchmark -> its module, in alphabetical order."""
    names = sorted(info.name for info in pkgutil.iter_modules([str(CASES)]))
    return {name.rstrip("_"): f"benchmarks.cases.{name}" for name in names}  # `class_` for the word `class`


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `springtide bench`."""
    names = f"the benchmarks to run (default: all): {', '.join(places())}"
    parser.add_argument("names", nargs="*", metavar="NAME", help=names)
    parser.add_argument("--quick", action="store_true", help="fewer and shorter runs: a minute each")
    peers = "compare with the other programs that are installed; with words of names: only with those"
    parser.add_argument("--peers", nargs="*", metavar="PEER", help=peers)
    parser.add_argument("--out", type=Path, metavar="DIR", help="write tables (CSV) and figures to this folder")
    parser.add_argument("--students", type=int, metavar="N", help="of the benchmark class: 1 to 100 (default: 8)")
    compared = "measure two commits of this repository in turns instead"
    parser.add_argument("--compare", nargs=2, metavar=("A", "B"), help=compared)
