"""The saved versions of a student's folder, found by looking at its files.

A look compares the stamps of files, so that it costs little, works on network drives, and goes on where a folder is
removed and made again. After a change the files are read for some seconds whatever their stamps are: a clock of files
can be as coarse as 2 s, and a second save within it changes no stamp.
"""

import contextlib
import os
import time
from collections.abc import Sequence
from pathlib import Path

from app.lab.saved import Saved, keep, read_files
from app.lab.task import Task

LOOK_INTERVAL = 0.5  # [s] between two looks
SETTLE_TIME = 0.05  # [s] without a further change before a save is read: editors write a file in several steps
MAX_SETTLE_TIME = 0.4  # [s]
COARSE_TIME = 3.0  # [s] after a change during which files are read at each look
Stamps = frozenset[tuple[str, int, int, int]]


def stamps(folder: Path, ending: str) -> Stamps | None:
    """Name, inode, size [bytes] and time of change [ns] of each file directly in a folder; None without a folder.

    ending: of their names.
    """
    found: set[tuple[str, int, int, int]] = set()
    try:
        with os.scandir(folder) as entries:
            for entry in entries:
                if entry.name.endswith(ending):
                    with contextlib.suppress(OSError):  # removed meanwhile, or a link to nothing
                        stat = os.stat(entry.path)  # as `entry.stat` gives no inode on Windows
                        found.add((entry.name, stat.st_ino, stat.st_size, stat.st_mtime_ns))
    except OSError:  # the folder was removed, or its drive is away
        return None
    return frozenset(found)


class Look:
    """Looks at the files of a folder that have one ending."""

    def __init__(self, folder: Path, ending: str) -> None:
        self.folder, self.ending = folder, ending
        self.seen: Stamps | None = None
        self.sure_at = 0.0  # [s] of the monotonic clock from which equal stamps mean equal files

    def has_changed(self) -> bool:
        """True if a file may have changed since the last look. Waits until a save is complete."""
        now = stamps(self.folder, self.ending)
        if now is None:
            return False
        if now == self.seen:
            return time.monotonic() < self.sure_at
        end = time.monotonic() + MAX_SETTLE_TIME
        while self.seen is not None and time.monotonic() < end:
            time.sleep(SETTLE_TIME)
            before, now = now, stamps(self.folder, self.ending)
            if now == before:
                break
        if now is None:
            return False
        self.seen, self.sure_at = now, time.monotonic() + COARSE_TIME
        return True

    def forget(self) -> None:
        """Have the next look find a change, as what it found could not be taken up."""
        self.seen = None


class Versions:
    """The versions of one folder. Use it from one thread at a time."""

    def __init__(self, folder: Path, tasks: Sequence[Task], copies: Path) -> None:
        """copies: an empty folder for the copies of the versions."""
        self.folder, self.tasks, self.copies = folder, tasks, copies
        self.newest: Saved | None = None
        self.files = Look(folder, ".py")

    def look(self) -> Saved | None:
        """The newest version, if it was saved since the last look; None otherwise.

        Raises OSError where it cannot be copied; the next look tries it again.
        """
        if not self.files.has_changed():
            return None
        texts = read_files(self.folder)
        if self.newest is not None and texts == self.newest.texts:
            return None
        number = 1 if self.newest is None else self.newest.number + 1
        folder = self.copies / str(number)
        try:
            folder.mkdir(exist_ok=True)
            self.newest = keep(texts, folder, number, self.tasks)
        except OSError:
            self.files.forget()
            raise
        return self.newest
