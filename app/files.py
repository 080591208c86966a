"""Files that appear whole: written under another name beside their place, then renamed."""

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

from sim.validation import argument_error


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A name to write to; when the block ends `path` is that file, and after an exception it is what it was before."""
    draft = path.with_name(f".{path.stem}.{os.getpid()}{path.suffix}")
    try:
        yield draft
        with draft.open("rb+") as file:
            os.fsync(file.fileno())
        os.replace(draft, path)
    except BaseException:
        draft.unlink(missing_ok=True)
        raise


def check_folder(option: str, path: Path) -> None:
    """Raises ValueError, naming the option, where no file can be made at `path`."""
    probe = path.with_name(f".{path.stem}.{os.getpid()}{path.suffix}")
    try:
        if not path.parent.is_dir():
            raise argument_error(option, str(path), "a file in a folder that exists")
        if path.is_dir():
            raise argument_error(option, str(path), "a file, not a folder")
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise argument_error(option, str(path), f"a file that can be written ({error.strerror})") from None
