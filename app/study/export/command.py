"""`springtide export`: a scene as a sequence of files, in a folder that appears whole."""

import argparse
import importlib.util
import json
import os
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from app.commands.options import add_parameters, quantity, read_params
from app.formats.text_tables import say
from app.scenes import scene_named
from app.scenes.setups import shared_values
from app.study.export import cloth_meshes, sea_pictures
from app.study.export.cloth_meshes import ClothMeshes
from app.study.export.sea_pictures import SeaPictures
from app.study.export.sequence import Exporter, Sequence
from app.study.pool import progress_bar
from sim.files import draft_of
from sim.validation import DivergenceError, argument_error, check_number

EXPORTERS: Mapping[str, Exporter] = {
    "square_sea": Exporter(sea_pictures.FORMATS, SeaPictures),
    "cloth": Exporter(cloth_meshes.FORMATS, ClothMeshes),
}
MAX_DURATION = 1e5  # [s] of simulated time, and until the first frame
RATES = 1.0, 1000.0  # [Hz]
MAX_BYTES = 50e9  # of all files, before they are compressed
VERSION = 1  # of the JSON file


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of the command."""
    seconds = quantity("s")
    parser.add_argument("scene", metavar="SCENE", help="square_sea (EXR or PNG images that tile) or cloth (OBJ)")
    parser.add_argument("--seconds", type=seconds, required=True, metavar="S", help="simulated time [s]")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="a new or empty folder")
    rate = "frames a simulated second (default: 30)"
    parser.add_argument("--rate", type=quantity("Hz"), default=30.0, metavar="HZ", help=rate)
    parser.add_argument("--start", type=seconds, default=0.0, metavar="S", help="time of the first frame (default: 0)")
    forms = "exr (32-bit, the sea's default if OpenEXR is installed, else png), exr16, png, or obj (the cloth's)"
    parser.add_argument("--format", metavar="FORMAT", help=forms)
    add_parameters(parser)


def run(arguments: argparse.Namespace) -> int:
    """Write the frames of a scene; returns the exit status."""
    a = arguments
    return export(a.scene, read_params(scene_named(a.scene), a), a.seconds, a.rate, a.start, a.format, a.out)


def is_installed(form: str) -> bool:
    """True if the library that writes this format is installed."""
    return not form.startswith("exr") or importlib.util.find_spec("OpenEXR") is not None


def export(scene: str, params: Any, seconds: float, rate: float, start: float, form: str | None, out: Path) -> int:
    """Write `seconds` [s] of a scene from `start` [s] on, `rate` frames a second [Hz], into the new folder `out`.

    form: of the files; None for the first of the scene's that this installation can write. Returns the exit status: 0;
    1 for a run that diverged, which keeps the frames before that. Raises ValueError for arguments that are not allowed,
    before any work, and OSError if the files cannot be written; then there is no folder.
    """
    if scene not in EXPORTERS:
        raise argument_error("SCENE", scene, "one of " + ", ".join(EXPORTERS))
    formats = EXPORTERS[scene].formats
    form = form or next(name for name in formats if is_installed(name))
    if form not in formats:
        raise argument_error("--format", form, f"{' or '.join(formats)} for {scene}")
    check_number("--seconds", seconds, "s", 0.0, MAX_DURATION, above=True)
    check_number("--rate", rate, "Hz", *RATES)
    check_number("--start", start, "s", 0.0, MAX_DURATION)
    check_folder(out)
    if not is_installed(form):
        raise ValueError("export: OpenEXR is not installed (pip install '.[exr]'), or choose --format png")
    count = max(1, round(seconds * rate))
    sequence = EXPORTERS[scene].make(params, 1.0 / rate, form)
    size = count * sequence.bytes_per_frame
    if size > MAX_BYTES:
        raise argument_error(
            "--seconds, --rate", f"{count} frames of {size / 1e9:.3g} GB", f"at most {MAX_BYTES / 1e9:g} GB"
        )
    draft = draft_of(out)
    draft.mkdir()
    try:
        times, problem = write_frames(sequence, draft, scene, start, count)
        about = {
            "version": VERSION, "scene": scene, "format": form, "frames": len(times), "first_number": 1, "rate": rate,
            "rate_unit": "Hz", "start": times[0] if times else start, "start_unit": "s", **sequence.about(),
            "parameters": shared_values(params), "diverged": problem,
            "notes": list(scene_named(scene).notes(params)),
        }  # fmt: skip
        (draft / "sequence.json").write_text(json.dumps(about, indent=2, ensure_ascii=False) + "\n", "utf-8")
        if out.is_dir():
            out.rmdir()  # it is empty, and not every system replaces a folder
        os.replace(draft, out)
    except BaseException:
        shutil.rmtree(draft, ignore_errors=True)
        raise
    say(f"{len(times)} frames, {form}; sequence.json describes them", out)
    if problem:
        say(f"The run ended early. {problem}")
        return 1
    return 0


def write_frames(sequence: Sequence, folder: Path, scene: str, start: float, count: int) -> tuple[list[float], str]:
    """Write all frames, with progress. Returns their times [s], and why the run ended early, or ""."""
    times: list[float] = []
    with progress_bar() as progress:
        bar = progress.add_task(f"{scene}, {count} frames", total=count * sequence.passes)
        try:
            for time in sequence.write(folder, start, count):
                if time is not None:
                    times.append(time)
                progress.advance(bar)
        except DivergenceError as reason:
            return times, str(reason)
    return times, ""


def check_folder(out: Path) -> None:
    """Raises ValueError if `out` is not a new or an empty folder that can be made."""
    try:
        if os.path.lexists(out) and (out.is_symlink() or not out.is_dir() or any(out.iterdir())):
            raise argument_error("--out", str(out), "a new or empty folder: nothing is overwritten")
        if not out.parent.is_dir():
            raise argument_error("--out", str(out), "a new folder in a folder that exists")
        trial = draft_of(out)
        trial.mkdir()
        trial.rmdir()
    except OSError as error:
        raise argument_error("--out", str(out), f"a folder that can be made ({error.strerror})") from None
    except UnicodeError:
        raise argument_error("--out", str(out), "a name that the file system can store") from None
