"""`springtide bench`: the arguments of the command; the benchmarks are imported when they run."""

import argparse
from pathlib import Path

from benchmarks.names import places


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of the command."""
    names = f"the benchmarks to run (default: all): {', '.join(places())}"
    parser.add_argument("names", nargs="*", metavar="NAME", help=names)
    parser.add_argument("--quick", action="store_true", help="fewer and shorter runs: a minute each")
    peers = "compare with the other programs that are installed; with words of names: only with those"
    parser.add_argument("--peers", nargs="*", metavar="PEER", help=peers)
    parser.add_argument("--out", type=Path, metavar="DIR", help="write tables (CSV) and figures to this folder")
    parser.add_argument("--students", type=int, metavar="N", help="of the benchmark class: 1 to 100 (default: 8)")
    compared = "measure two commits of this repository in turns instead"
    parser.add_argument("--compare", nargs=2, metavar=("A", "B"), help=compared)


def run(arguments: argparse.Namespace) -> int:
    """Run benchmarks, or compare two commits; returns the exit status."""
    a = arguments
    if a.compare:
        from benchmarks.compare import compare

        return compare(a.names, tuple(a.compare), a.quick, a.out)
    from benchmarks import command

    return command.run(a.names, a.quick, a.peers, a.out, a.students)
