"""Files that appear whole: each is written under another name in the same folder, and then renamed. File locks."""

import contextlib
import errno
import os
import secrets
import time
from collections.abc import Iterator
from pathlib import Path


def draft_of(path: Path) -> Path:
    """Draft name of a file, unique among the threads and processes of this machine."""
    return path.with_name(f".{path.stem}.{os.getpid()}-{secrets.token_hex(4)}{path.suffix}")


# [s] between tries to replace a file. Windows refuses while another program has it open, as an editor, an indexer or a
# virus scanner has for a moment.
PAUSES = (0.05, 0.1, 0.2, 0.3, 0.35) if os.name == "nt" else ()


def replace(draft: Path, target: Path) -> None:
    """Rename a file to the name of another, which it replaces. Raises OSError."""
    for pause in PAUSES:
        try:
            os.replace(draft, target)
        except PermissionError:
            time.sleep(pause)
        else:
            return
    os.replace(draft, target)


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a draft path to write to; it replaces `path` when the block ends, but not after an exception.

    A symbolic link is followed: the file that it leads to is replaced. Raises OSError if that fails.
    """
    target = Path(os.path.realpath(path))
    draft = draft_of(target)
    try:
        yield draft
        with draft.open("rb+") as file:
            os.fsync(file.fileno())
        replace(draft, target)
    except BaseException:
        draft.unlink(missing_ok=True)
        raise


@contextlib.contextmanager
def locked(path: Path) -> Iterator[None]:
    """Hold the lock that this file stands for; waits while another process, or another thread, holds it.

    The system releases the locks of a process that ends, however it ends. If the file cannot be made (a full disk, a
    read-only folder) nothing is locked.
    """
    try:
        file = path.open("ab")
    except OSError:
        yield
        return
    with file:
        lock(file.fileno())
        yield


try:
    import fcntl

    def lock(descriptor: int) -> None:
        """Lock an open file until it is closed."""
        with contextlib.suppress(OSError):  # a network folder without locks
            fcntl.flock(descriptor, fcntl.LOCK_EX)

except ImportError:  # Windows
    import msvcrt

    def lock(descriptor: int) -> None:
        """Lock an open file until it is closed."""
        while True:
            try:
                msvcrt.locking(descriptor, msvcrt.LK_LOCK, 1)  # type: ignore[attr-defined]
            except OSError as error:
                if error.errno != errno.EDEADLK:  # it has tried for ten seconds
                    return
            else:
                return
