"""`springtide warmup`: compile every kernel and plan every transform, with progress."""

import argparse
import os
import subprocess
import sys
from pathlib import Path

from rich import get_console

from app.files import make_out_folder
from app.scenes import NAMES
from app.scenes.ahead.compiling import all_jobs, compile_here
from sim.cache import INSTALLED, SHARED_VARIABLE, host_levels, level_environment
from sim.jit import CACHE
from sim.validation import argument_error


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of the command."""
    into = "compile for all users, into FOLDER, which SPRINGTIDE_KERNELS must name (default: the installation's)"
    parser.add_argument("--into", nargs="?", const="", metavar="FOLDER", help=into)
    level = "with --into: for all processors of a level (x86-64-v3, x86-64-v4, arm64); all: each that this one has"
    parser.add_argument("--processor", default="", metavar="LEVEL", help=level)


def run(arguments: argparse.Namespace) -> int:
    """Compile all kernels; returns the exit status."""
    if arguments.into is not None:
        return warm_up_into(Path(arguments.into) if arguments.into else INSTALLED, arguments.processor)
    if arguments.processor:
        raise argument_error("--processor", arguments.processor, "a level together with --into")
    return warm_up()


def warm_up() -> int:
    """Compile every scene's kernels and plan its transforms; returns the exit status."""
    is_terminal = get_console().is_terminal
    for name in NAMES:
        if not is_terminal:
            print(f"Compiling {name}", flush=True)
        compile_here(name, all_jobs(name))
    print(f"Saved in {CACHE}" if CACHE else "Nothing was saved: no cache directory is writable")
    return 0


def warm_up_into(folder: Path, level: str) -> int:
    """`warm_up` into a folder that others only read; returns the exit status.

    level: of processors; "all" for each that this processor has, "" for this processor. Runs in separate processes, as
    numba reads folder and level at import.

    Raises ValueError if this processor does not have the level, or the folder cannot be made.
    """
    levels = (host_levels() if level == "all" else ()) or (level,)
    processors = [level_environment(each) if each else {} for each in levels]
    make_out_folder("--into", folder)
    for processor in processors:
        # Nothing is taken from other folders: this one is to have all.
        environment = {**os.environ, **processor, "SPRINGTIDE_CACHE": str(folder.resolve()), SHARED_VARIABLE: ""}
        if status := subprocess.run([sys.executable, "-m", "app", "warmup"], env=environment, check=False).returncode:
            return status
    return 0
