"""`springtide`: the lab with one scene, in a browser."""

import argparse
from collections.abc import Callable
from typing import Any

from app.commands.added_files import SCENE_OF_FILE
from app.commands.options import add_address, add_parameters, check_files_named, read_params, serving
from app.scenes import NAMES, check_name, scene_named

DEFAULT_SCENE = "rope"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `springtide` without a command."""
    scenes = ", ".join(NAMES) + " (default: rope, or that of the first file)"
    parser.add_argument("--scene", default="", metavar="SCENE", help=scenes)
    resume = "continue with the last set-up of the previous lab with this option, if any"
    parser.add_argument("--resume", action="store_true", help=resume)
    add_address(parser)
    add_parameters(parser)
    parser.set_defaults(first_params=None)


def run(arguments: argparse.Namespace, session: Any = None, workbook: Any = None) -> int:
    """Serve the lab; returns the exit status. session, workbook: of a student's folder."""
    name, params = opening_setup(arguments)
    from app.commands.serve import serve_lab

    common = serving(arguments)
    return serve_lab(name, params, **common, workbook=workbook, session=session, resumes=arguments.resume)


def opening_setup(arguments: argparse.Namespace) -> tuple[str, Callable[[], Any] | None]:
    """Name of the scene that the lab begins with, and a function that makes its parameters.

    None for those that the scene opens with. Values that a user gives are checked here. Without any the scene is not
    imported: numba, which it needs, takes longer than the page.
    """
    if arguments.resume:
        from app.scenes.last_setup import read_last

        last = read_last()
        if last is not None:
            return last.scene, lambda: last.params
    name = check_name(scene_name(arguments))
    check_files_named(arguments)
    files = any(getattr(arguments, option) is not None for option in SCENE_OF_FILE)
    if files or arguments.set or arguments.preset is not None:
        params = read_params(scene_named(name), arguments, "" if files else None)
        return name, lambda: params
    return name, arguments.first_params


def scene_name(arguments: argparse.Namespace) -> str:
    """Name of the scene to open: as given, or that of the first file that is added."""
    added = (scene for option, scene in SCENE_OF_FILE.items() if getattr(arguments, option) is not None)
    return arguments.scene or next(added, DEFAULT_SCENE)
