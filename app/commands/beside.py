"""`springtide beside`: two or three set-ups side by side, on one clock."""

import argparse

from app.commands.options import add_address, say_missing_files, say_without_effect, serving
from app.scenes.comparisons import COMPARISONS


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of the command."""
    ready = ", ".join(COMPARISONS)
    words = f"SCENE, SCENE:PRESET, a link or a set-up file; or a ready-made comparison on its own: {ready}"
    parser.add_argument("setups", nargs="+", metavar="SET-UP", help=words)
    add_address(parser)


def run(arguments: argparse.Namespace) -> int:
    """Serve the set-ups; returns the exit status."""
    from app.commands.serve import serve_lab
    from app.scenes.comparisons import read_comparison

    first, *others = read_comparison(arguments.setups)
    for setup in (first, *others):
        say_missing_files(setup)
        say_without_effect(setup)
    return serve_lab(first.scene, lambda: first.params, **serving(arguments), others=others)
