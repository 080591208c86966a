"""The command line: `springtide` and `python -m app`."""

import argparse
import contextlib
import importlib
import io
import os
import signal
import sys
import threading
from collections.abc import Iterator
from typing import Any, NoReturn

from app.commands import open_lab
from app.commands.checkout import ELSEWHERE, in_checkout
from app.commands.error_stream import print_error
from app.commands.lab import with_live
from sim.validation import ConvergenceError

CLOSED_OUTPUT = 141  # exit status of a program that SIGPIPE ends, by convention of shells
# Command -> what its help says, and its module, which has add_arguments(parser) and run(arguments).
COMMANDS = {
    "beside": ("open two or three set-ups side by side, on one clock", "app.commands.beside"),
    "run": ("run a scene without a browser and write it to a file", "app.commands.run"),
    "export": ("write a sea or a cloth as a sequence of files for artists", "app.study.export.command"),
    "bench": ("measure run time against error, frames and start-up", "benchmarks.options"),
    "stability": ("measure stability maps and energy drift beside theory", "app.study.stability.command"),
    "sweep": ("run a scene over ranges of its parameters and write one NetCDF file", "app.study.sweep.command"),
    "hydrodynamics": (
        "compute added mass, damping and wave forces of your own hull (needs the extra `bem`)",
        "app.commands.hulls.hydrodynamics",
    ),
    "hull": ("print the size, volume, draft, stability and gaps of a mesh", "app.commands.hulls.hull"),
    "lab": ("the course lab: make a folder of exercises, check it", "app.commands.lab"),
    "warmup": ("compile all kernels and plan all transforms, once", "app.commands.warmup"),
}


def main(argv: list[str] | None = None) -> int:
    """Run one command; returns the exit status: 0, 1 for an error on the way, 2 for a bad argument."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        # A file name that the terminal cannot show is printed with replacements.
        sys.stdout.reconfigure(errors="backslashreplace")
    words = sys.argv[1:] if argv is None else argv
    if words[:1] == ["lab"]:
        words = ["lab", *with_live(words[1:])]
    if words[:1] == ["bench"] and not in_checkout():
        return print_error(f"bench: {ELSEWHERE}", 2)
    arguments = make_parser().parse_args(words)
    try:
        with cleaning_up_at_sigterm():
            status: int = arguments.command(arguments)
        if sys.stdout is not None:
            sys.stdout.flush()
        return status
    except BrokenPipeError as error:
        return CLOSED_OUTPUT if drop_closed_output() else print_error(str(error), 1)
    except ValueError as error:
        return print_error(str(error), 2)
    except (OSError, ConvergenceError) as error:
        return print_error(str(error), 1)
    except MemoryError as error:
        return print_error(f"not enough memory ({error})", 1)
    except KeyboardInterrupt:
        return 128 + signal.SIGINT


def drop_closed_output() -> bool:
    """Write no more if the reader of the output has closed it, as `head` does; returns True if it has."""
    try:
        print(flush=True)  # another pipe may have failed before
    except BrokenPipeError:
        # Unwritten text stays in the buffer, and would fail again when Python ends.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return True
    return False


@contextlib.contextmanager
def cleaning_up_at_sigterm() -> Iterator[None]:
    """Inside, SIGTERM ends the program as an exception does: half-written files are removed, workers are stopped."""

    def end(number: int, _: object) -> NoReturn:
        signal.signal(number, signal.SIG_IGN)
        raise SystemExit(128 + number)

    if threading.current_thread() is not threading.main_thread():  # where Python allows no signal handlers
        yield
        return
    before = signal.signal(signal.SIGTERM, end)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


class Parser(argparse.ArgumentParser):
    """Ends at a bad argument with one line; imports the module of a command when the command is named."""

    module = ""  # with the arguments that are still to be added

    def add_arguments(self) -> None:
        """Add the arguments of the command, once."""
        if self.module:
            module, self.module = importlib.import_module(self.module), ""
            module.add_arguments(self)
            self.set_defaults(command=module.run)

    def parse_known_args(self, *args: Any, **options: Any) -> Any:
        """Called for a command by the parser of the program."""
        self.add_arguments()
        return super().parse_known_args(*args, **options)

    def error(self, message: str) -> NoReturn:
        """Called for a bad argument."""
        sys.exit(print_error(message, 2))


class Version(argparse.Action):
    """Prints the machine and the versions, and ends the program."""

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        """Called for the option."""
        from app.study.tables import machine

        print(machine())
        parser.exit()


def make_parser() -> Parser:
    """The parser of all commands; its result has `command`, the function that runs the named one."""
    parser = Parser(
        prog="springtide",
        description="An interactive 3-D lab for spring-mass systems and ocean waves, in a browser tab.",
    )
    parser.add_argument("--version", nargs=0, action=Version, help="print the details that a bug report needs")
    open_lab.add_arguments(parser)
    parser.set_defaults(command=open_lab.run)
    commands = parser.add_subparsers(metavar="COMMAND")
    for name, (words, module) in COMMANDS.items():
        if name != "bench" or in_checkout():
            commands.add_parser(name, help=words).module = module
    return parser


if __name__ == "__main__":
    sys.exit(main())
