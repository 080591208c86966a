"""Options that several commands share, and their meaning: an address, a scene's parameters, the reading of a mesh."""

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

from app.commands.added_files import with_hull, with_mooring, with_spectrum
from app.commands.error_stream import say_on_error_stream
from sim.quantities import read_number


def quantity(unit: str) -> Callable[[str], float]:
    """Return the reader of an option's number, which may have this unit: 2.5, 5ms, 1/3."""

    def read(text: str) -> float:
        try:
            return float(text)  # "nan" and "inf" are refused later, with the allowed range
        except ValueError:
            pass
        try:
            return read_number(text, unit)
        except ValueError as reason:
            raise argparse.ArgumentTypeError(f"{text!r}: {reason}; write a number, with or without {unit}") from None

    return read


def add_address(parser: argparse.ArgumentParser) -> None:
    """The options that say where and how the lab is served, whatever it shows."""
    parser.add_argument("--host", default="127.0.0.1", help="address to serve on; 0.0.0.0 shows the lab to the network")
    parser.add_argument("--port", type=int, default=8080, help="default: 8080; 0 for any free port")
    path = "the path at which a proxy shows the lab, if the proxy passes it on"
    parser.add_argument("--base-path", default="", metavar="PATH", help=path)
    origin = "the address, as in a browser, of a proxy that serves the page; may be given more than once"
    parser.add_argument("--allowed-origin", action="append", default=[], metavar="ORIGIN", help=origin)
    parser.add_argument("--no-open", action="store_true", help="do not open the browser")
    parser.add_argument("--paused", action="store_true", help="start paused")
    parser.add_argument("--plain-water", action="store_true", help="draw with viser's public interface only")


def serving(arguments: argparse.Namespace) -> dict[str, Any]:
    """The arguments of `serve_lab` that say where and how the lab is served."""
    return {
        "host": arguments.host,
        "port": arguments.port,
        "browser": not arguments.no_open,
        "paused": arguments.paused,
        "plain": arguments.plain_water,
        "base_path": arguments.base_path,
        "origins": arguments.allowed_origin,
    }


def add_parameters(parser: argparse.ArgumentParser) -> None:
    """The options that set a scene's parameters."""
    parser.add_argument(
        "--preset", metavar="NAME or FILE", help="a preset of the scene, or a set-up file, replay or recording"
    )
    names = "set parameters of the scene; `springtide run SCENE --list` lists presets and parameters"
    parser.add_argument("--set", nargs="+", default=[], metavar="NAME=VALUE", help=names)
    hull = "add a closed mesh to the radial sea: STL, OBJ, PLY, GDF and others with z up, glTF or GLB with y up"
    parser.add_argument("--hull", type=Path, metavar="FILE", help=hull)
    add_mesh_reading(parser)
    parser.add_argument("--mooring", type=Path, metavar="FILE", help="open a MoorDyn file in the scene mooring")
    spectrum = "waves of a measured spectrum, in either sea: CSV, NDBC, WAVEWATCH III or SWAN; see docs/files.md"
    parser.add_argument("--spectrum", type=Path, metavar="FILE", help=spectrum)
    when = "time of the record to use (default: the last one)"
    parser.add_argument("--spectrum-time", metavar="TIME", default="", help=when)
    missing = (
        'numbers that stand for a missing value in the file, such as 99,999, or "none" (default: the format\'s rule)'
    )
    parser.add_argument("--spectrum-missing", metavar="NUMBERS", default="", help=missing)


def add_mesh_reading(parser: argparse.ArgumentParser) -> None:
    """The options that say how a mesh file is read; none is given as the default, which depends on the format."""
    unit = "unit of length in the mesh file (default: m, or that of the format)"
    parser.add_argument("--hull-unit", choices=("m", "cm", "mm", "ft"), default="", help=unit)
    weld = "merge corners nearer than this, to close gaps of a mesh"
    parser.add_argument("--weld", type=quantity("m"), default=0.0, metavar="METRES", help=weld)
    mirror = "add the other half of a mesh, across x = 0 or y = 0"
    parser.add_argument("--mirror", choices=("x", "y"), default="", help=mirror)
    parser.add_argument("--cap", choices=("deck",), default="", help="close a mesh that is open at the top")


def mesh_reading(arguments: argparse.Namespace) -> Any:
    """Reading of a mesh file, by the options."""
    from sim.floating.hulls.hull import MeshReading

    return MeshReading(arguments.hull_unit, arguments.weld, arguments.mirror, arguments.cap)


def read_params(scene: Any, arguments: argparse.Namespace, preset: str | None = "") -> Any:
    """The scene's parameters from --preset and --set; raises ValueError if one is not allowed.

    preset: without --preset, as `make_setup` takes it.
    """
    from app.scenes.setups import make_setup, preset_setup, with_values
    from sim.parameters import parse_assignments

    check_files_named(arguments)
    values = parse_assignments(scene.params, arguments.set)
    if arguments.preset is None:
        setup = make_setup(scene, preset, values)
    else:
        setup = with_values(preset_setup("--preset", arguments.preset, scene), values)
        say_missing_files(setup, arguments)
    params = setup.params
    if arguments.hull is not None:
        params = with_hull(params, arguments.hull, mesh_reading(arguments))
    if arguments.mooring is not None:
        params = with_mooring(params, arguments.mooring, setup)
    if arguments.spectrum is not None:
        time, missing = arguments.spectrum_time, arguments.spectrum_missing
        params = with_spectrum(params, arguments.spectrum, time, missing, "length" in setup.values)
    say_without_effect(setup._replace(params=params))
    file = arguments.mooring or arguments.spectrum
    if file is not None:
        for note in scene.notes(params):
            say_on_error_stream(f"{file.name}: {note}")
    return params


def check_files_named(arguments: argparse.Namespace) -> None:
    """Raises ValueError for an option about a file that no other option names."""
    for option, needed in (("hull_unit", "hull"), ("weld", "hull"), ("mirror", "hull"), ("cap", "hull"),
                           ("spectrum_time", "spectrum"), ("spectrum_missing", "spectrum")):  # fmt: skip
        if getattr(arguments, option) and getattr(arguments, needed) is None:
            raise ValueError(f"--{option.replace('_', '-')}: it needs --{needed} FILE")


def say_without_effect(setup: Any) -> None:
    """Say on the error stream which parameters of a set-up have no effect with the others."""
    from app.scenes.setups import without_effect

    for line in without_effect(setup):
        say_on_error_stream(line)


def say_missing_files(setup: Any, arguments: argparse.Namespace | None = None) -> None:
    """Say on the error stream which files of a set-up no option gives, and which given file lacks its changes."""
    from app.scenes.setups import missing_files

    for option, name in setup.files.items() if setup.changes else ():
        path = getattr(arguments, option, None)
        if path is not None and path.name != name:
            say_on_error_stream(f"{path.name}: without the changes of the set-up, which are those of {name}")
    others = {option: file for option, file in setup.files.items() if getattr(arguments, option, None) is None}
    text = missing_files(setup._replace(files=others))
    if text:
        say_on_error_stream(text)
