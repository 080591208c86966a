"""A student's Python files as they were when they were saved: copies, so that a version can run on while the next is
written."""

import ast
import contextlib
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

from app.lab.program_check import is_begun
from app.lab.task import Task

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


def stamps(folder: Path) -> frozenset[tuple[str, int, int, int]]:
    """Name, inode, size and time of change of each Python file directly in a folder: cheaper than reading them."""
    found: set[tuple[str, int, int, int]] = set()
    with contextlib.suppress(OSError), os.scandir(folder) as entries:  # the folder, or a file, was removed meanwhile
        for entry in entries:
            if entry.name.endswith(".py"):
                stat = entry.stat()
                found.add((entry.name, stat.st_ino, stat.st_size, stat.st_mtime_ns))
    return frozenset(found)


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


def keep(texts: Mapping[str, bytes], folder: Path, number: int, tasks: Iterable[Task]) -> Saved:
    """Write the files into a folder of their own. Raises OSError where that cannot be done."""
    for name, text in texts.items():
        (folder / name).write_bytes(text)
    begun = [task.name for task in tasks if is_there(task, texts) and is_begun(folder, task)]
    return Saved(number, folder, texts, frozenset(begun))


def is_there(task: Task, texts: Mapping[str, bytes]) -> bool:
    """True if a file defines the function of a task at its top level.

    Of a file that cannot be parsed all functions count: running them says what is wrong with it.
    """
    if task.file not in texts:
        return False
    try:
        tree = ast.parse(texts[task.file])
    except (SyntaxError, ValueError, RecursionError, MemoryError):  # the last two where it nests too deeply
        return True
    names = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
    imports = [node for node in tree.body if isinstance(node, ast.ImportFrom)]
    names |= {alias.asname or alias.name for node in imports for alias in node.names}
    targets = [target for node in tree.body if isinstance(node, ast.Assign) for target in node.targets]
    return task.name in names | {target.id for target in targets if isinstance(target, ast.Name)}
