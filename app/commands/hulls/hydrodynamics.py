"""`springtide hydrodynamics`: linear coefficients of a hull of one's own."""

import argparse
import importlib.util
from pathlib import Path

from rich import get_console
from rich.progress import Progress

from app.commands.checkout import of_checkout
from app.commands.options import add_mesh_reading, mesh_reading
from app.formats import text_tables
from sim.floating import Hull
from sim.floating.hulls.hull import AS_IT_IS, MeshReading
from sim.floating.linear.boundary_elements import FREQUENCIES, make_table
from sim.floating.linear.linear_table import place_of_table, write_table
from sim.validation import argument_error

DRAFT_SHARES = (0.15, 0.3, 0.5, 0.7, 0.85)  # of the height of a hull, at which its coefficients are computed


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of the command."""
    parser.add_argument("hull", type=Path, nargs="?", metavar="HULL", help="a closed mesh, as for --hull")
    out = "where to write the table (default: HULL.hydrodynamics.npz, where --hull finds it)"
    parser.add_argument("--out", type=Path, metavar="FILE.npz", help=out)
    compare = "in a checkout: compare the shipped shapes with Capytaine"
    parser.add_argument("--compare", action="store_true", help=compare)
    add_mesh_reading(parser)


def run(arguments: argparse.Namespace) -> int:
    """Compute the table of a hull, or compare the shipped ones; returns the exit status."""
    if arguments.compare == (arguments.hull is not None):
        raise ValueError("HULL: give a mesh file, or --compare without one")
    if arguments.compare:
        return of_checkout("--compare", "hydrodynamics").compare()
    return make(arguments.hull, arguments.out, mesh_reading(arguments))


def require_capytaine() -> None:
    """Raises OSError if Capytaine is not installed."""
    if importlib.util.find_spec("capytaine") is None:
        raise OSError("Capytaine is not installed; install it with: pip install '.[bem]'")


def make(hull_file: Path, out: Path | None, reading: MeshReading = AS_IT_IS) -> int:
    """Write the table of the hull in a file to `out`, or where `--hull` finds it; returns the exit status.

    Raises ValueError for a mesh that is no hull or has too many triangles, OSError without Capytaine.
    """
    place = place_of_table(hull_file)
    out = place if out is None else out
    if not out.parent.is_dir():
        raise argument_error("--out", str(out), "a file in a folder that exists")
    hull = Hull.load(hull_file, False, *reading)
    require_capytaine()
    drafts = [share * float(hull.size[2]) for share in DRAFT_SHARES]
    console = get_console()
    with Progress(console=console, disable=not console.is_terminal) as progress:
        task = progress.add_task("Boundary elements", total=len(drafts) * len(FREQUENCIES))
        table = make_table(hull, drafts, progress=lambda: progress.advance(task))
    write_table(out, table, hull)
    text_tables.say(f"{len(drafts)} drafts from {drafts[0]:.3g} to {drafts[-1]:.3g} m", out)
    if out != place:
        text_tables.say("where --hull looks for the table", place)
    return 0
