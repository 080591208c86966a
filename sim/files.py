"""Files that appear whole: each is written under another name in the same folder, and then renamed."""

import contextlib
import os
import secrets
from collections.abc import Iterator
from pathlib import Path


def draft_of(path: Path) -> Path:
    """The name that a file is first written to: no other thread or process of this machine uses it."""
    return path.with_name(f".{path.stem}.{os.getpid()}-{secrets.token_hex(4)}{path.suffix}")


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A name to write to; when the block ends `path` is that file, and after an exception it is what it was before.

    A symbolic link is followed: the file that it leads to is replaced. Raises OSError where that cannot be done.
    """
    target = Path(os.path.realpath(path))
    draft = draft_of(target)
    try:
        yield draft
        with draft.open("rb+") as file:
            os.fsync(file.fileno())
        os.replace(draft, target)
    except BaseException:
        draft.unlink(missing_ok=True)
        raise
