"""The command line: `springtide` and `python -m app`."""

import argparse
import contextlib
import dataclasses
import io
import os
import signal
import sys
import threading
from collections.abc import Callable, Container, Iterator
from pathlib import Path
from typing import Any, NoReturn

from app.commands.checkout import ELSEWHERE, in_checkout, of_checkout
from app.messages import BaseParams
from app.scenes import NAMES, check_name, scene_named
from sim.quantities import read_number
from sim.validation import ConvergenceError

CLOSED_OUTPUT = 141  # exit status of a program that SIGPIPE ends, by convention of shells
DEFAULT_SCENE = "rope"
SCENE_OF_FILE = {"mooring": "mooring", "hull": "radial_sea", "spectrum": "square_sea"}  # option -> scene it opens
LIVE = "live"  # the command of the lab that need not be named
STEP_SAFETY = 0.5  # of the longest stable step at rest, for a mooring from a file
MAX_MOORING_NODES = 2000  # of a mooring from a file: all its modes are computed for the longest step
MAX_HULL_FACES = 20_000  # of a hull from a file: pressure is summed over all of them at each step


def main(argv: list[str] | None = None) -> int:
    """Run one command; returns the exit status: 0, 1 for an error on the way, 2 for a bad argument."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        # A file name that the terminal cannot show is printed with replacements.
        sys.stdout.reconfigure(errors="backslashreplace")
    words = complete(sys.argv[1:] if argv is None else argv)
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


def complete(words: list[str]) -> list[str]:
    """The words of the command line with those that `springtide lab DIR` and `springtide run --list` leave out."""
    if words == ["run", "--list"]:
        return ["run", "", "--list"]
    if words[:1] == ["lab"] and not {*words[1:2]} <= {"new", "check", LIVE, "-h", "--help"}:
        return ["lab", LIVE, *words[1:]]
    return words


def drop_closed_output() -> bool:
    """Write no more if the reader of the output has closed it, as `head` does; returns True if it has."""
    try:
        print(flush=True)  # what failed before may have been another pipe
    except BrokenPipeError:
        # What could not be written stays in the buffer, and would fail again when Python ends.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return True
    return False


def print_error(text: str, status: int) -> int:
    """Print an error on one line of printable characters; returns the exit status."""
    print(f"springtide: {one_line(text)}", file=sys.stderr)
    return status


def one_line(text: str) -> str:
    """`text` with its control characters written out: names from a file must not steer the terminal."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


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
    """Ends at a bad argument with one line, as every command does."""

    def error(self, message: str) -> NoReturn:
        sys.exit(print_error(message, 2))


class Version(argparse.Action):
    """Prints the machine and the versions, and ends the program."""

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        """Called for the option."""
        from app.experiments.tables import machine

        print(machine())
        parser.exit()


def make_parser() -> argparse.ArgumentParser:
    """The parser of all commands; each sets `command`, the function that runs it."""
    parser = Parser(
        prog="springtide",
        description="An interactive 3-D lab for spring-mass systems and ocean waves, in a browser tab.",
    )
    parser.add_argument("--version", nargs=0, action=Version, help="print what a report of a fault needs")
    parser.set_defaults(command=serve)
    add_serving(parser)
    commands = parser.add_subparsers(metavar="COMMAND")

    beside = commands.add_parser("beside", help="two or three set-ups side by side, on one clock")
    words = "SCENE, SCENE:PRESET, a link, a set-up file; or alone the name of a comparison that is ready"
    beside.add_argument("setups", nargs="+", metavar="SET-UP", help=words)
    add_address(beside)
    beside.set_defaults(command=serve_beside)

    add_recording(commands)

    if in_checkout():
        bench = commands.add_parser("bench", help="measure run time against error, frames and start-up")
        of_checkout("bench", "options").add_options(bench)
        bench.set_defaults(command=run_bench)

    stability = commands.add_parser("stability", help="measure stability maps and energy drift beside theory")
    stability.add_argument("--quick", action="store_true", help="coarse maps: within a minute")
    stability.add_argument("--out", type=Path, metavar="DIR", help="write tables (CSV) and figures to this folder")
    stability.set_defaults(command=run_stability)

    sweep = commands.add_parser("sweep", help="run a scene over ranges of its parameters, into one NetCDF file")
    sweep.add_argument("spec", type=Path, metavar="SPEC.toml", help="what to sweep; for examples see assets/sweeps")
    sweep.add_argument("--out", type=Path, required=True, metavar="FILE.nc")
    sweep.add_argument("--scheduler", metavar="ADDRESS", help="run on a Dask cluster instead of this machine's cores")
    sweep.add_argument("--fresh", action="store_true", help="start over, and replace earlier results")
    sweep.set_defaults(command=run_sweep)

    coefficients = commands.add_parser(
        "hydrodynamics", help="added mass, damping and wave forces of a hull of your own (needs the extra `bem`)"
    )
    coefficients.add_argument("hull", type=Path, nargs="?", metavar="HULL", help="a closed mesh, as of --hull")
    default = "where to write the table (default: HULL.hydrodynamics.npz, where --hull finds it)"
    coefficients.add_argument("--out", type=Path, metavar="FILE.npz", help=default)
    coefficients.add_argument(
        "--compare", action="store_true", help="in a checkout: set the shipped shapes beside Capytaine, live"
    )
    add_mesh_reading(coefficients)
    coefficients.set_defaults(command=run_hydrodynamics)

    hull = commands.add_parser("hull", help="size, volume, draft and stability of a mesh, and where it is open")
    hull.add_argument("hull", type=Path, metavar="FILE", help="a mesh, as of --hull")
    density = "of the whole hull, mass over volume (default: 500)"
    hull.add_argument("--density", type=quantity("kg/m3"), default=500.0, metavar="KG/M3", help=density)
    gravity = "height of the centre of gravity over the keel (default: that of the volume)"
    hull.add_argument("--kg", type=quantity("m"), metavar="METRES", help=gravity)
    add_mesh_reading(hull)
    hull.set_defaults(command=show_hull)

    add_lab(commands.add_parser("lab", help="the course lab: make a folder of exercises, check it"))

    warmup = commands.add_parser("warmup", help="compile all kernels and plan all transforms, once")
    into = "for all users, into a folder that SPRINGTIDE_KERNELS names; without a name into that of the installation"
    warmup.add_argument("--into", nargs="?", const="", metavar="FOLDER", help=into)
    level = "with --into: for all processors of a level (x86-64-v3, x86-64-v4, arm64), or all: each that this one has"
    warmup.add_argument("--processor", default="", metavar="LEVEL", help=level)
    warmup.set_defaults(command=run_warmup)
    return parser


def add_recording(commands: Any) -> None:
    """The commands that write a scene's frames to files."""
    seconds, hertz, rate = quantity("s"), quantity("Hz"), "frames a simulated second (default: 30)"
    run = commands.add_parser("run", help="run a scene without a browser, and write it to a file")
    run.add_argument("scene", metavar="SCENE", help=", ".join(NAMES))
    run.add_argument(
        "--list",
        action="store_true",
        help="list the scene's parameters, presets and measures instead; without SCENE, the scenes",
    )
    run.add_argument("--seconds", type=seconds, metavar="S", help="simulated time [s]")
    run.add_argument("--out", type=Path, metavar="FILE.npz")
    run.add_argument("--rate", type=hertz, default=30.0, metavar="HZ", help=rate)
    add_parameters(run)
    run.set_defaults(command=run_headless)

    export = commands.add_parser("export", help="write a sea or a cloth as a sequence of files for artists")
    export.add_argument("scene", metavar="SCENE", help="square_sea (EXR or PNG pictures that tile) or cloth (OBJ)")
    export.add_argument("--seconds", type=seconds, required=True, metavar="S", help="simulated time [s]")
    export.add_argument("--out", type=Path, required=True, metavar="DIR", help="a new or empty folder")
    export.add_argument("--rate", type=hertz, default=30.0, metavar="HZ", help=rate)
    export.add_argument("--start", type=seconds, default=0.0, metavar="S", help="time of the first frame (default: 0)")
    forms = "exr (32-bit, the sea's default if OpenEXR is installed, else png), exr16, png, or obj (the cloth's)"
    export.add_argument("--format", metavar="FORMAT", help=forms)
    add_parameters(export)
    export.set_defaults(command=run_export)


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


def add_lab(lab: argparse.ArgumentParser) -> None:
    """The commands of `springtide lab`."""
    commands = lab.add_subparsers(metavar="DIR, new or check", required=True)
    lab.epilog = (
        "`springtide lab DIR` opens the scenes with the functions in that folder, live; "
        "`springtide lab class/*` shows the teacher of a class who is at which task."
    )
    live = commands.add_parser(LIVE, prog=lab.prog)
    made = "a folder that `springtide lab new` has made; several: those of a class"
    live.add_argument("folders", type=Path, nargs="+", metavar="DIR", help=made)
    add_serving(live)
    live.set_defaults(command=serve_folder)
    # The options of `springtide lab DIR` stand in the help of `springtide lab`: nobody asks for that of DIR.
    lab.format_help = lambda: f"{argparse.ArgumentParser.format_help(lab)}\n{live.format_help()}"
    new = commands.add_parser("new", help="write a folder with the exercises")
    new.add_argument("folder", type=Path, metavar="DIR", help="a new or empty folder")
    new.add_argument("--solutions", action="store_true", help="for teachers: with the reference solutions")
    new.set_defaults(command=make_lab)
    check = commands.add_parser("check", help="check the exercises; status 0 where all that is mandatory is right")
    check.add_argument("folders", type=Path, nargs="+", metavar="DIR", help="one folder, or those of a class")
    json = "write the results as JSON; without a file, print them"
    check.add_argument("--json", type=Path, nargs="?", const=Path("-"), metavar="FILE", help=json)
    check.add_argument("--csv", type=Path, metavar="FILE.csv", help="write a table, one row a folder")
    check.add_argument("--all", action="store_true", help="list the tasks that are not begun, too")
    check.add_argument("--report", type=Path, metavar="FILE.html", help="write the page to hand in")
    check.set_defaults(command=check_lab)
    for command in (live, new, check):
        more = "a folder with tasks of your own, beside those of the course; see docs/lab.md"
        command.add_argument("--tasks", type=Path, action="append", default=[], metavar="FOLDER", help=more)


def add_serving(parser: argparse.ArgumentParser) -> None:
    """The options of `springtide` without a command."""
    scenes = ", ".join(NAMES) + " (default: rope, or that of the first file)"
    parser.add_argument("--scene", default="", metavar="SCENE", help=scenes)
    resume = "begin with the set-up that the last lab with this option was left with, if there was one"
    parser.add_argument("--resume", action="store_true", help=resume)
    add_address(parser)
    add_parameters(parser)
    parser.set_defaults(first_params=None)


def add_address(parser: argparse.ArgumentParser) -> None:
    """The options that say where and how the lab is served, whatever it shows."""
    parser.add_argument("--host", default="127.0.0.1", help="address to serve on; 0.0.0.0 shows the lab to the network")
    parser.add_argument("--port", type=int, default=8080, help="default: 8080; 0 for any free port")
    path = "the path at which a proxy shows the lab, where it passes it on"
    parser.add_argument("--base-path", default="", metavar="PATH", help=path)
    origin = "the address, as in a browser, of a proxy that pages may come through; may be given more than once"
    parser.add_argument("--allowed-origin", action="append", default=[], metavar="ORIGIN", help=origin)
    parser.add_argument("--no-open", action="store_true", help="do not open the browser")
    parser.add_argument("--paused", action="store_true", help="start paused")
    parser.add_argument("--plain-water", action="store_true", help="draw with viser's public interface only")


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
    parser.add_argument("--spectrum-time", metavar="TIME", help="of one of its records (default: the last one)")


def add_mesh_reading(parser: argparse.ArgumentParser) -> None:
    """The options that say how a mesh file is read; none is given as the default, which depends on the format."""
    unit = "unit of length in the mesh file (default: m, or that of the format)"
    parser.add_argument("--hull-unit", choices=("m", "cm", "mm", "ft"), default="", help=unit)
    weld = "make corners nearer than this one, where a mesh has gaps"
    parser.add_argument("--weld", type=quantity("m"), default=0.0, metavar="METRES", help=weld)
    mirror = "add the other half of a mesh, across x = 0 or y = 0"
    parser.add_argument("--mirror", choices=("x", "y"), default="", help=mirror)
    parser.add_argument("--cap", choices=("deck",), default="", help="close a mesh that is open at the top")


def mesh_reading(arguments: argparse.Namespace) -> Any:
    """How the options say that a mesh file is read."""
    from sim.floating.hull import MeshReading

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
        params = with_mooring(params, arguments.mooring, setup.values)
    if arguments.spectrum is not None:
        params = with_spectrum(params, arguments.spectrum, arguments.spectrum_time, "length" in setup.values)
    file: Path | None = arguments.mooring or arguments.spectrum
    if file is not None:
        for note in scene.notes(params):
            say_on_error_stream(f"{file.name}: {note}")
    return params


def check_files_named(arguments: argparse.Namespace) -> None:
    """Raises ValueError for an option about a file that no other option names."""
    for option, needed in (("hull_unit", "hull"), ("weld", "hull"), ("mirror", "hull"), ("cap", "hull"),
                           ("spectrum_time", "spectrum")):  # fmt: skip
        if getattr(arguments, option) and getattr(arguments, needed) is None:
            raise ValueError(f"--{option.replace('_', '-')}: it needs --{needed} FILE")


def say_missing_files(setup: Any, arguments: argparse.Namespace | None = None) -> None:
    """Say on the error stream which files a set-up had, except for those that options give."""
    from app.scenes.setups import missing_files

    others = {option: file for option, file in setup.files.items() if getattr(arguments, option, None) is None}
    text = missing_files(setup._replace(files=others))
    if text:
        say_on_error_stream(text)


def say_on_error_stream(text: str) -> None:
    """Print a line on the error stream."""
    print(f"springtide: {one_line(text)}", file=sys.stderr)


def with_hull(params: Any, path: Path, reading: Any) -> Any:
    """The parameters with one more hull. Its size, volume and draft are printed.

    Raises ValueError for a scene without bodies, or a mesh that is no hull.
    """
    import numpy as np

    from app.commands.hull import hull_line, size_warning
    from sim.floating import Hull
    from sim.validation import argument_error

    if not hasattr(params, "hull"):
        raise argument_error("--hull", str(path), "a hull with the scene radial_sea only")
    # of huge coordinates numpy would warn before they are refused
    with np.errstate(all="ignore"), naming_extra("meshes", path):
        hull = Hull.load(path, True, *reading)
    if len(hull.faces) > MAX_HULL_FACES:
        raise argument_error("--hull", f"{path} of {len(hull.faces)} triangles", f"at most {MAX_HULL_FACES}")
    print(one_line(hull_line(path.name, hull, params.density)), flush=True)
    warning = size_warning(path.name, hull.size, reading)
    if warning:
        say_on_error_stream(warning)
    how = {f"hull_{name}": value for name, value in reading._asdict().items()}
    return dataclasses.replace(params, hull=str(path), **how)


@contextlib.contextmanager
def naming_extra(extra: str, path: Path) -> Iterator[None]:
    """Inside, a library that a file needs and that is not installed becomes an OSError that says how to install it."""
    try:
        yield
    except ModuleNotFoundError as error:
        raise OSError(f"{path}: {error.name} is not installed; install it by: pip install '.[{extra}]'") from None


def with_spectrum(params: Any, path: Path, time: str | None, has_length: bool) -> Any:
    """The parameters with the waves of a measured spectrum, and a tile that holds them unless a length was given.

    Raises ValueError for a scene without a sea, or a file that holds no spectrum.
    """
    from sim.validation import argument_error

    if not hasattr(params, "spectrum_file"):
        raise argument_error("--spectrum", str(path), "a spectrum with the scenes square_sea and radial_sea only")
    from app.scenes.sea_parameters import spectrum_in_file, tile_length

    with naming_extra("spectra", path):
        spectrum = spectrum_in_file(str(path), time or "")
    params = dataclasses.replace(params, spectrum_file=str(path), spectrum_time=time or "")
    if has_length or not hasattr(params, "length"):
        return params
    return dataclasses.replace(params, length=tile_length(spectrum, params))


def with_mooring(params: Any, path: Path, given: Container[str]) -> Any:
    """The parameters with the mooring of a MoorDyn file, a stable time step, and no breaking load, which no file has.

    given: names of parameters that keep their values.
    Raises ValueError for another scene or a file that cannot be read, ConvergenceError for one without a state of rest.
    """
    from sim.mooring import critical_step
    from sim.parameters import clamp_value, parameters_of
    from sim.validation import argument_error

    if not hasattr(params, "moordyn_file"):
        raise argument_error("--mooring", str(path), "a MoorDyn file with the scene mooring only")
    from app.scenes.mooring.from_file import mooring_of

    system = mooring_of(str(path)).system
    if system.node_count > MAX_MOORING_NODES:
        raise argument_error("--mooring", f"{path} of {system.node_count} nodes", f"at most {MAX_MOORING_NODES}")
    params = dataclasses.replace(params, moordyn_file=str(path))
    if "breaking_load" not in given:
        params = dataclasses.replace(params, breaking_load=0.0)
    if "time_step" in given:
        return params
    step = float(f"{STEP_SAFETY * critical_step(system, params.integrator):.1e}")
    return dataclasses.replace(params, time_step=clamp_value(parameters_of(params)["time_step"], step))


def serve(arguments: argparse.Namespace, session: Any = None, workbook: Any = None) -> int:
    """`springtide`: the lab in a browser. session, workbook: of a student's folder."""
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


def serve_beside(arguments: argparse.Namespace) -> int:
    """`springtide beside`."""
    from app.commands.serve import serve_lab
    from app.scenes.comparisons import read_comparison

    first, *others = read_comparison(arguments.setups)
    for setup in (first, *others):
        say_missing_files(setup)
    return serve_lab(first.scene, lambda: first.params, **serving(arguments), others=others)


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


def run_headless(arguments: argparse.Namespace) -> int:
    """`springtide run`."""
    if arguments.list:
        from app.commands.list_scene import list_scene, list_scenes

        return list_scene(scene_named(arguments.scene)) if arguments.scene else list_scenes()
    scene = scene_named(arguments.scene)
    for option in ("seconds", "out"):
        if getattr(arguments, option) is None:
            raise ValueError(f"--{option}: missing; or give --list for the scene's parameters, presets and measures")
    params = read_params(scene, arguments)
    from app.commands.run import run_to_file

    return run_to_file(arguments.scene, scene, params, arguments.seconds, arguments.rate, arguments.out)


def run_export(arguments: argparse.Namespace) -> int:
    """`springtide export`."""
    scene = scene_named(arguments.scene)
    params = read_params(scene, arguments)
    from app.export.command import export

    a = arguments
    return export(a.scene, params, a.seconds, a.rate, a.start, a.format, a.out)


def run_bench(arguments: argparse.Namespace) -> int:
    """`springtide bench`."""
    a = arguments
    if a.compare:
        return of_checkout("bench", "compare").compare(a.names, tuple(a.compare), a.quick, a.out)
    return of_checkout("bench", "command").run(a.names, a.quick, a.peers, a.out, a.students)


def run_stability(arguments: argparse.Namespace) -> int:
    """`springtide stability`."""
    from app.stability.command import run

    return run(quick=arguments.quick, out=arguments.out)


def run_sweep(arguments: argparse.Namespace) -> int:
    """`springtide sweep`."""
    from app.sweep.command import sweep

    return sweep(arguments.spec, arguments.out, arguments.scheduler, fresh=arguments.fresh)


def serve_folder(arguments: argparse.Namespace) -> int:
    """`springtide lab DIR`."""
    if len(arguments.folders) > 1:
        return serve_class(arguments)
    from app.lab.session import Session
    from app.lab.task import load_tasks
    from app.lab.workbook import Workbook

    session = Session(arguments.folders[0], load_tasks(*arguments.tasks), arguments.tasks)
    try:
        verdicts = session.versions
        states = lambda: {name: verdict.state for name, verdict in verdicts.verdicts.items()}  # noqa: E731
        workbook = Workbook(session.tasks, session.folder, states)
        choose_scene(arguments, workbook.set_up_of(workbook.task).scene)
        return serve(arguments, session, workbook)
    finally:
        session.close()


def choose_scene(arguments: argparse.Namespace, of_task: str) -> None:
    """Have a student's lab begin where the work is, if nothing else is asked for. of_task: scene of the next task."""
    is_asked = arguments.scene or arguments.resume or arguments.preset is not None or arguments.set
    if not is_asked and all(getattr(arguments, option) is None for option in SCENE_OF_FILE):
        arguments.scene = of_task
    if scene_name(arguments) == DEFAULT_SCENE and arguments.preset is None and not arguments.set:
        arguments.first_params = first_rope_of_student


def first_rope_of_student() -> BaseParams:
    """The rope that a student's lab opens: with RK4 a right solution equals the program's to rounding."""
    from app.scenes.setups import make_setup

    return make_setup(scene_named(DEFAULT_SCENE), "", {"integrator": "rk4"}).params


def serve_class(arguments: argparse.Namespace) -> int:
    """`springtide lab class/*`."""
    from app.commands.lab_class import serve_class as serve_page

    plain = make_parser().parse_args(["lab", LIVE, "."])
    for name, value in vars(arguments).items():
        if name not in ("folders", "port", "no_open", "tasks") and value != getattr(plain, name):
            option = f"--{name.replace('_', '-')}"
            raise ValueError(f"{option}: the page of a class takes --port, --no-open and --tasks only")
    return serve_page(arguments.folders, arguments.tasks, arguments.port, browser=not arguments.no_open)


def make_lab(arguments: argparse.Namespace) -> int:
    """`springtide lab new`."""
    from app.commands.lab import new

    return new(arguments.folder, arguments.tasks, solutions=arguments.solutions)


def check_lab(arguments: argparse.Namespace) -> int:
    """`springtide lab check`."""
    from app.commands.lab import check

    out = {"json": arguments.json, "csv": arguments.csv, "report": arguments.report}
    return check(arguments.folders, arguments.tasks, out, everything=arguments.all)


def run_hydrodynamics(arguments: argparse.Namespace) -> int:
    """`springtide hydrodynamics`."""
    if arguments.compare == (arguments.hull is not None):
        raise ValueError("HULL: give a mesh file, or --compare without one")
    if arguments.compare:
        return of_checkout("--compare", "hydrodynamics").compare()
    from app.commands.hydrodynamics import make

    return make(arguments.hull, arguments.out, mesh_reading(arguments))


def show_hull(arguments: argparse.Namespace) -> int:
    """`springtide hull`."""
    from app.commands.hull import print_facts

    with naming_extra("meshes", arguments.hull):
        return print_facts(arguments.hull, mesh_reading(arguments), arguments.density, arguments.kg)


def run_warmup(arguments: argparse.Namespace) -> int:
    """`springtide warmup`."""
    from app.commands.warmup import warm_up, warm_up_into
    from sim.cache import INSTALLED
    from sim.validation import argument_error

    if arguments.into is not None:
        return warm_up_into(Path(arguments.into) if arguments.into else INSTALLED, arguments.processor)
    if arguments.processor:
        raise argument_error("--processor", arguments.processor, "a level together with --into")
    return warm_up()


if __name__ == "__main__":
    sys.exit(main())
