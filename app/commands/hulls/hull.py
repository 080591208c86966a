"""`springtide hull`: size, volume, draft and stability of a mesh, or where it is open."""

import argparse
import warnings
from pathlib import Path

import numpy as np

from app.commands.added_files import naming_extra
from app.commands.hulls.mesh_facts import size_text, size_warning
from app.commands.options import add_mesh_reading, mesh_reading, quantity
from app.formats import text_tables
from sim.floating import Body, Hull, metacentric_height, righting_arm
from sim.floating.hulls.closed_mesh import open_edges
from sim.floating.hulls.hull import MeshReading, open_mesh_from_file
from sim.floating.hulls.mesh_repair import place_of_gaps, remedy
from sim.validation import check_number
from sim.water import SEA_DENSITY

HEELS = (5, 10, 15, 20, 30, 40, 50, 60)  # [degrees]
OPEN = 1  # exit status for a mesh that is not closed


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of the command."""
    parser.add_argument("hull", type=Path, metavar="FILE", help="a mesh file, as for --hull")
    density = "density of the whole hull: mass over volume (default: 500)"
    parser.add_argument("--density", type=quantity("kg/m3"), default=500.0, metavar="KG/M3", help=density)
    gravity = "height of the centre of gravity over the keel (default: centre of volume)"
    parser.add_argument("--kg", type=quantity("m"), metavar="METRES", help=gravity)
    add_mesh_reading(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print the facts of a mesh; returns the exit status."""
    with naming_extra("meshes", arguments.hull):
        return print_facts(arguments.hull, mesh_reading(arguments), arguments.density, arguments.kg)


def print_facts(path: Path, reading: MeshReading, density: float, keel_to_gravity: float | None) -> int:
    """Print size, volume, draft, GM and GZ of the hull in a file, or where it is open; returns the exit status.

    density [kg/m3] of the whole hull; keel_to_gravity [m]: height of the centre of gravity over the lowest point, None:
    that of the volume. Raises ValueError for a file that cannot be read, or a value that is not allowed.
    """
    check_number("--density", density, "kg/m3, the density of sea water", 0.0, SEA_DENSITY, above=True)
    vertices, faces = open_mesh_from_file(path, reading)
    if len(faces) and np.isfinite(vertices).all() and open_edges(faces):
        size = np.ptp(vertices[np.unique(faces)], axis=0)
        lines = [
            f"size: {size_text(size)}",
            f"open: {place_of_gaps(vertices, faces)}",
            f"closed by: {remedy(vertices, faces) or 'none of --weld, --mirror and --cap'}",
            size_warning(path.name, size, reading),
        ]
        status = OPEN
    else:
        hull = Hull.load(path, False, *reading)
        lines, status = [*facts(hull, density, keel_to_gravity), size_warning(path.name, hull.size, reading)], 0
    for line in filter(None, lines):
        text_tables.say(line)
    return status


def facts(hull: Hull, density: float, keel_to_gravity: float | None) -> list[str]:
    """Size, volume, draft and stability of a hull, one line each; arguments as for `show`."""
    body = Body(hull, density=density)
    if keel_to_gravity is not None:
        height = check_number("--kg", keel_to_gravity, "m, the height of the hull", 0.0, float(hull.size[2]))
        x, y, z = (float(one) for one in hull.centre)
        place = (x, y, z + float(hull.extents[2, 0]) + height)
        body = Body(hull, mass=density * hull.volume, center_of_gravity=place)
    with warnings.catch_warnings():  # the line of GM says it
        warnings.simplefilter("ignore", UserWarning)
        stability = metacentric_height(body)
        arms = righting_arm(body, np.radians(HEELS))
    above = float(-hull.extents[2, 0]) if keel_to_gravity is None else keel_to_gravity
    return [
        f"size: {size_text(hull.size)}",
        f"volume: {hull.volume:.6g} m3 of {len(hull.faces)} triangles, closed",
        f"draft: {body.draft():.4g} m in sea water at {density:g} kg/m3, a mass of {density * hull.volume:.4g} kg",
        f"GM: {stability:.4g} m with the centre of gravity {above:.4g} m over the keel"
        + (": not stable upright" if stability < 0.0 else ""),
        "GZ: " + ", ".join(f"{arm:.3g} m at {heel} deg" for heel, arm in zip(HEELS, arms.tolist(), strict=True)),
    ]
