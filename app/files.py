"""Checks of a command's output files and folders, made before any work."""

import os
from pathlib import Path

from sim.files import draft_of
from sim.validation import argument_error


def check_out_file(option: str, path: Path, *names: str, endings: tuple[str, ...]) -> None:
    """Raises ValueError, naming the option, where `path` cannot be written, or has not the ending of its format.

    names: files that the command also makes in the folder of `path`. endings: as ".html"; with another one the file may
    be somebody's work of another kind.
    """
    if path.suffix.lower() not in endings:
        raise argument_error(option, str(path), f"a name that ends in {' or '.join(endings)}")
    target = Path(os.path.realpath(path))
    try:
        if not target.parent.is_dir():
            raise argument_error(option, str(path), "a file in a folder that exists")
        if target.is_dir():
            raise argument_error(option, str(path), "a file, not a folder")
        if os.path.lexists(target) and not target.is_file():
            raise argument_error(option, str(path), "a file, not a pipe, a device or a link to itself")
        for trial in (draft_of(target), *(draft_of(path).with_name(name) for name in names)):
            if not os.path.lexists(trial):
                trial.touch()
                trial.unlink()
    except OSError as error:
        raise argument_error(option, str(path), f"a file that can be written ({error.strerror})") from None
    except UnicodeError:
        raise argument_error(option, str(path), "a name that the file system can store") from None


def make_out_folder(option: str, path: Path | None) -> None:
    """Make the folder that an option names, if it names one; raises ValueError if it cannot be made."""
    if path is None:
        return
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise argument_error(option, str(path), f"a folder that can be written ({error.strerror})") from None
