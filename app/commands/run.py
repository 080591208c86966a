"""`springtide run`: a scene without a browser, sampled into one .npz file with units and all parameters."""

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np
from rich import get_console
from rich.progress import Progress

from app.commands.list_scene import list_scene, list_scenes
from app.commands.options import add_parameters, quantity, read_params
from app.files import check_out_file
from app.formats.text_tables import say
from app.scenes import NAMES, scene_named
from app.scenes.contract import Scene, SceneKind
from app.scenes.setups import described
from app.scenes.stepping import steps_to
from sim.files import replacing
from sim.validation import DivergenceError, argument_error, check_number

MAX_DURATION = 1e6  # [s] of simulated time
MAX_RATE = 1e5  # [Hz]
MAX_BYTES = 4e9  # of a run's arrays, in memory and in the file before it is compressed


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of the command."""
    parser.add_argument("scene", nargs="?", default="", metavar="SCENE", help=", ".join(NAMES))
    parser.add_argument(
        "--list",
        action="store_true",
        help="list the scene's parameters, presets and measures instead; without SCENE, the scenes",
    )
    parser.add_argument("--seconds", type=quantity("s"), metavar="S", help="simulated time [s]")
    parser.add_argument("--out", type=Path, metavar="FILE.npz")
    rate = "frames a simulated second (default: 30)"
    parser.add_argument("--rate", type=quantity("Hz"), default=30.0, metavar="HZ", help=rate)
    add_parameters(parser)


def run(arguments: argparse.Namespace) -> int:
    """Run a scene into a file, or list its contents; returns the exit status."""
    if arguments.list:
        return list_scene(scene_named(arguments.scene)) if arguments.scene else list_scenes()
    if not arguments.scene:
        raise ValueError(f"SCENE: missing; one of {', '.join(NAMES)}")
    scene = scene_named(arguments.scene)
    for option in ("seconds", "out"):
        if getattr(arguments, option) is None:
            raise ValueError(f"--{option}: missing; or give --list for the scene's parameters, presets and measures")
    params = read_params(scene, arguments)
    return run_to_file(arguments.scene, scene, params, arguments.seconds, arguments.rate, arguments.out)


def run_to_file(name: str, scene: SceneKind[Any, Any, Any], params: Any, seconds: float, rate: float, out: Path) -> int:
    """Run a scene for `seconds` [s] of simulated time, and write `rate` frames a second [Hz] to `out`.

    Returns the exit status: 0; 1 for a run that diverged, which keeps the frames before that. Raises ValueError for
    arguments that are not allowed, before any work, and OSError if the file cannot be written.
    """
    check_number("--seconds", seconds, "s", 0.0, MAX_DURATION, above=True)
    check_number("--rate", rate, "Hz", 0.0, MAX_RATE, above=True)
    check_out_file("--out", out, endings=(".npz",))
    running: Scene[Any, Any, Any] = scene.make(params)
    if running.note:
        # A file would not show that another integrator ran than the requested one.
        raise argument_error(
            "integrator", params.integrator, "a method with damping: this net is damped by links, drag, air or contact"
        )
    for warning in () if scene.warnings is None else scene.warnings(running):
        say(f"Warning: {warning}")
    # More frames than steps would only repeat some of them.
    frames = max(1, min(round(seconds * rate), steps_to(running, seconds)))
    first = running.arrays()
    size = (frames + 1) * sum(array.nbytes for array, _ in first.values())
    if size > MAX_BYTES:
        raise argument_error(
            "--seconds, --rate", f"{frames} frames of {size / 1e9:.3g} GB", f"at most {MAX_BYTES / 1e9:g} GB"
        )
    units = {"t": "s", **{key: unit for key, (_, unit) in first.items()}}
    # Made at their full size, as a list of frames would have to be copied into arrays at the end.
    times = np.empty(frames + 1)
    arrays = {key: np.empty((frames + 1, *array.shape), array.dtype) for key, (array, _) in first.items()}
    count = 0  # frames kept
    problem = ""
    with Progress(transient=True, disable=not get_console().is_terminal) as progress:
        task = progress.add_task(f"{name}, {seconds:g} s", total=frames)
        for frame in range(frames + 1):
            if frame:
                try:
                    running.advance(steps_to(running, seconds * frame / frames))
                except DivergenceError as reason:
                    problem = str(reason)
                    break
            times[frame] = running.time
            for key, (array, _) in running.arrays().items():
                arrays[key][frame] = array
            count = frame + 1
            progress.update(task, completed=frame)
    about = {**described(scene, params), "units": units, "diverged": problem, "notes": list(scene.notes(params))}
    columns = {"t": times[:count], **{key: array[:count] for key, array in arrays.items()}}
    write_arrays(out, {**columns, "about": np.array(json.dumps(about))})
    say(f"{count} frames to t = {times[count - 1]:g} s, {', '.join(columns)}", out)
    if problem:
        say(f"The run ended early. {problem}")
        return 1
    return 0


def write_arrays(path: Path, arrays: dict[str, Any]) -> None:
    """Write an .npz file so that `path` holds all of it or its earlier content. Raises OSError."""
    with replacing(path) as draft:
        np.savez_compressed(draft, **arrays)
