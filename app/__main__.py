"""The command line: `springtide` and `python -m app`."""

import argparse
import dataclasses
import sys
from pathlib import Path
from typing import Any, NoReturn

from app.scenes import NAMES, scene_named

MAX_HULL_FACES = 20_000  # of a hull from a file: pressure is summed over all of them at each step


def main(argv: list[str] | None = None) -> int:
    """Run one command; returns the exit status: 0, 1 for what went wrong on the way, 2 for a bad argument."""
    parser = make_parser()
    arguments = parser.parse_args(argv)
    try:
        return arguments.command(arguments)
    except (ValueError, OSError) as error:
        print(f"springtide: {error}", file=sys.stderr)
        return 2 if isinstance(error, ValueError) else 1
    except KeyboardInterrupt:
        return 130


class Parser(argparse.ArgumentParser):
    """Ends at a bad argument with one line, as every refusal does."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"springtide: {message}\n")


def make_parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="springtide",
        description="An interactive 3-D lab for spring-mass systems and ocean waves, in a browser tab.",
    )
    parser.set_defaults(command=serve)
    add_serving(parser)
    commands = parser.add_subparsers(metavar="COMMAND")

    run = commands.add_parser("run", help="the same scene without a browser, into a file")
    run.add_argument("scene", choices=NAMES, metavar="SCENE", help=", ".join(NAMES))
    run.add_argument("--seconds", type=float, required=True, metavar="S", help="simulated time")
    run.add_argument("--out", type=Path, required=True, metavar="FILE.npz")
    run.add_argument("--rate", type=float, default=30.0, metavar="HZ", help="frames kept per simulated second (30)")
    add_parameters(run)
    run.set_defaults(command=run_headless)

    bench = commands.add_parser("bench", help="run time against error, kernels, start-up")
    bench.add_argument("names", nargs="*", metavar="NAME", help="which benchmarks; all by default")
    bench.add_argument("--quick", action="store_true", help="within a minute")
    bench.add_argument("--peers", action="store_true", help="also the peers that are installed")
    bench.add_argument("--out", type=Path, metavar="DIR", help="write CSV and figures here")
    bench.set_defaults(command=run_bench)

    stability = commands.add_parser("stability", help="stability maps and energy drift, measured beside theory")
    stability.add_argument("--quick", action="store_true", help="coarse, within a minute")
    stability.add_argument("--out", type=Path, metavar="DIR", help="write CSV and figures here")
    stability.set_defaults(command=run_stability)

    sweep = commands.add_parser("sweep", help="a scene over ranges of its parameters, into one NetCDF file")
    sweep.add_argument("spec", type=Path, metavar="SPEC.toml", help="what to sweep; see assets/sweeps")
    sweep.add_argument("--out", type=Path, required=True, metavar="FILE.nc")
    sweep.add_argument("--scheduler", metavar="ADDRESS", help="run on this Dask cluster, not on this machine's cores")
    sweep.add_argument("--fresh", action="store_true", help="start over, replacing what is there")
    sweep.set_defaults(command=run_sweep)

    warmup = commands.add_parser("warmup", help="compile every kernel and plan every transform, once")
    warmup.set_defaults(command=run_warmup)
    return parser


def add_serving(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--scene", choices=NAMES, default="rope", metavar="SCENE", help=", ".join(NAMES))
    parser.add_argument("--host", default="127.0.0.1", help="address to serve on; 0.0.0.0 shows the lab to the network")
    parser.add_argument("--port", type=int, default=8080, help="0 for any free one")
    parser.add_argument("--no-open", action="store_true", help="do not open the browser")
    parser.add_argument("--paused", action="store_true", help="start still")
    parser.add_argument("--plain-water", action="store_true", help="draw by viser's public interface alone")
    add_parameters(parser)


def add_parameters(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--preset", type=Path, metavar="FILE.json", help="parameters of a scene, as JSON")
    parser.add_argument("--set", nargs="+", default=[], metavar="NAME=VALUE", help="set parameters of the scene")
    parser.add_argument("--hull", type=Path, metavar="FILE", help="a closed mesh that floats in the radial sea besides")


def read_params(scene: Any, arguments: argparse.Namespace) -> Any:
    """The scene's parameters from --preset and --set; raises ValueError for what is not allowed."""
    from app.scenes.preset_files import read_preset
    from sim.parameters import check_record, parse_assignments

    values = read_preset(arguments.preset, scene) if arguments.preset else {}
    params = check_record(scene.params, {**values, **parse_assignments(scene.params, arguments.set)})
    return params if arguments.hull is None else with_hull(params, arguments.hull)


def with_hull(params: Any, path: Path) -> Any:
    """The parameters with one more hull; raises ValueError where the scene floats nothing, or the mesh is no hull."""
    from sim.floating import Hull
    from sim.validation import argument_error

    if not hasattr(params, "hull"):
        raise argument_error("--hull", str(path), "a hull with --scene radial only")
    faces = len(Hull.load(path).faces)
    if faces > MAX_HULL_FACES:
        raise argument_error("--hull", f"{path} of {faces} triangles", f"at most {MAX_HULL_FACES}")
    return dataclasses.replace(params, hull=str(path))


def serve(arguments: argparse.Namespace) -> int:
    if not 0 <= arguments.port <= 65535:
        raise ValueError(f"--port: {arguments.port} is not allowed; allowed: 0 to 65535")
    scene = scene_named(arguments.scene)
    params = read_params(scene, arguments)
    from app.commands.serve import serve_lab

    return serve_lab(
        arguments.scene,
        params,
        arguments.host,
        arguments.port,
        browser=not arguments.no_open,
        paused=arguments.paused,
        plain=arguments.plain_water,
    )


def run_headless(arguments: argparse.Namespace) -> int:
    scene = scene_named(arguments.scene)
    params = read_params(scene, arguments)
    from app.commands.run import run_to_file

    return run_to_file(arguments.scene, scene, params, arguments.seconds, arguments.rate, arguments.out)


def run_bench(arguments: argparse.Namespace) -> int:
    from app.bench.command import run

    return run(arguments.names, arguments.quick, arguments.peers, arguments.out)


def run_stability(arguments: argparse.Namespace) -> int:
    from app.stability.command import run

    return run(arguments.quick, arguments.out)


def run_sweep(arguments: argparse.Namespace) -> int:
    from app.sweep.command import sweep

    return sweep(arguments.spec, arguments.out, arguments.scheduler, fresh=arguments.fresh)


def run_warmup(arguments: argparse.Namespace) -> int:
    from app.commands.warmup import warm_up

    return warm_up()


if __name__ == "__main__":
    sys.exit(main())
