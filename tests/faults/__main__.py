"""`python -m tests.faults draw|run|table`."""

import argparse
import tempfile
from pathlib import Path


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.faults", description="Do the tests notice small errors?")
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("draw", help="draw the list of faults, keeping those with lines that are still there")
    run = commands.add_parser("run", help="try each fault that has no result yet")
    run.add_argument("--modules", default="", help="paths that begin so, for example sim/ocean")
    run.add_argument("--again", action="store_true", help="only those that were not found, again")
    run.add_argument("--plain", action="store_true", help="kernels as plain Python only; what that misses stays open")
    run.add_argument("--seconds", type=float, default=1e9, help="begin no other fault after this time")
    run.add_argument("--work", type=Path, default=Path(tempfile.gettempdir()) / "springtide-faults")
    commands.add_parser("table", help="print what was found, by package")
    arguments = parser.parse_args()
    if arguments.command == "draw":
        from tests.faults.drawing import draw, write_list

        write_list(draw())
    elif arguments.command == "run":
        from tests.faults.running import run_faults

        only = "not found" if arguments.again else ""
        run_faults(arguments.work, arguments.modules, only, arguments.seconds, plain_only=arguments.plain)
    else:
        from tests.faults.table import print_table

        print_table()


if __name__ == "__main__":
    main()
