"""A student's Python files as they were when they were saved: copies, so that a version can run on while the next is
written."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

from app.lab.course.source import read_source
from app.lab.course.task import Task

MAX_SIZE = 2**20  # [bytes] of a file that is copied


class Saved(NamedTuple):
    """One version of the files."""

    number: int  # from 1
    folder: Path  # the copies
    texts: Mapping[str, bytes]  # file -> what it holds
    begun: frozenset[str]  # functions of the tasks that have a body

    def affected(self, before: "Saved | None", tasks: Iterable[Task]) -> frozenset[str]:
        """The files of tasks whose functions may do something else than in an earlier version.

        Those that differ; all where another file does, as any function may use that.
        """
        old = {} if before is None else before.texts
        changed = frozenset(name for name in {*self.texts, *old} if self.texts.get(name) != old.get(name))
        files = frozenset(task.file for task in tasks if task.file)
        return changed if changed <= files else files


def read_files(folder: Path) -> dict[str, bytes]:
    """The Python files directly in a folder; those that cannot be read, or are too large, are left out."""
    texts = {}
    for path in sorted(folder.glob("*.py")):
        try:
            if path.stat().st_size <= MAX_SIZE:
                texts[path.name] = path.read_bytes()
        except OSError:  # removed meanwhile, or not ours to read
            continue
    return texts


def store(texts: Mapping[str, bytes], folder: Path, number: int, tasks: Iterable[Task]) -> Saved:
    """Write the files into an empty folder. Raises OSError if a file cannot be written."""
    for name, text in texts.items():
        (folder / name).write_bytes(text)
    sources = {name: read_source(text) for name, text in texts.items()}
    of_task = {task.name: sources[task.file] for task in tasks if task.file in sources}
    begun = [name for name, source in of_task.items() if source.has(name) and source.is_begun(name)]
    return Saved(number, folder, texts, frozenset(begun))
