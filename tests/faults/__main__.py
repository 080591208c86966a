"""`python -m tests.faults draw|run|table`."""

import argparse
import os
import tempfile
from pathlib import Path


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.faults", description="Do the tests notice small errors?")
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("draw", help="draw the list of faults, keeping those with lines that are still there")
    run = commands.add_parser("run", help="try each fault that has no result yet")
    run.add_argument("--modules", default="", help="paths that begin so, for example sim/ocean")
    results = ("found", "long", "not found", "open")
    run.add_argument("--again", choices=results, default="", help="only those with this result, again")
    run.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="processes")
    run.add_argument("--limit", type=float, default=120.0, help="time of a fault [s]; what takes longer stays open")
    run.add_argument("--most", type=int, default=10**9, help="so many faults, drawn at random")
    run.add_argument("--work", type=Path, default=Path(tempfile.gettempdir()) / "springtide-faults")
    commands.add_parser("table", help="print what was found, by package")
    arguments = parser.parse_args()
    if arguments.command == "draw":
        from tests.faults.drawing import SEED, draw, write_list

        print(f"seed {SEED}")
        write_list(draw())
    elif arguments.command == "run":
        from tests.faults.running import run_faults

        run_faults(
            arguments.work, arguments.modules, arguments.again, workers=arguments.workers, limit=arguments.limit,
            most=arguments.most,
        )  # fmt: skip
    else:
        from tests.faults.table import print_table

        print_table()


if __name__ == "__main__":
    main()
