"""The Python files of a student as modules of the process that runs them."""

import ast
import builtins
import contextlib
import importlib
import importlib.util
import os
import sys
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

OF_THE_PROGRAM = ("app", "sim", "assets")  # packages whose names a student's file may have


class StudentModules:
    """The modules of one folder, each loaded once."""

    def __init__(self, folder: Path) -> None:
        """Change to the folder, in which imports look first."""
        self.folder = folder
        self.loaded: dict[str, ModuleType] = {}
        self.used: dict[str, list[ModuleType]] = {}  # by each file, of the student
        os.chdir(folder)
        sys.path.insert(0, str(folder))
        own = {name: f"{name}.py" for name in OF_THE_PROGRAM if (folder / f"{name}.py").is_file()}
        if own:
            builtins.__import__ = self.importing(own, builtins.__import__)

    def importing(self, own: dict[str, str], otherwise: Callable[..., Any]) -> Callable[..., Any]:
        """Python's import, by which a student's file gets the student's sim.py, not the package of that name.

        own: files by the names of their modules. otherwise: the import of everything else.
        """

        def own_import(name: str, known: Any = None, *rest: Any, **named: Any) -> Any:
            importer = (known or {}).get("__file__") or ""
            if name in own and os.path.dirname(importer) == str(self.folder):
                return self.load(own[name])
            return otherwise(name, known, *rest, **named)

        return own_import

    def load(self, file: str) -> ModuleType:
        """The student's module, run once."""
        if file not in self.loaded:
            self.loaded[file] = self.run(file)
        return self.loaded[file]

    def run(self, file: str) -> ModuleType:
        """Run a file as a new module."""
        name = Path(file).stem
        spec = importlib.util.spec_from_file_location(name, self.folder / file)
        if spec is None or spec.loader is None:
            raise ImportError(f"{file} is not Python")
        module = importlib.util.module_from_spec(spec)
        known, sys.modules[name] = sys.modules.get(name), module
        try:
            spec.loader.exec_module(module)
        finally:
            if known is not None:  # other files hold on to the first one
                sys.modules[name] = known
        return module

    def others(self, file: str) -> list[ModuleType]:
        """The student's modules that a file uses, also those that its functions import."""
        if file not in self.used:
            self.used[file] = list(self.imports_of(file, {file}))
        return self.used[file]

    def imports_of(self, file: str, seen: set[str]) -> Iterator[ModuleType]:
        """The student's modules that a file imports, and those that these import. seen: files, to which it adds."""
        for name in imported_names(self.folder / file):
            own = f"{name}.py"
            if own in seen or not (self.folder / own).is_file():
                continue
            seen.add(own)
            with contextlib.suppress(Exception):  # the function says so when it is called
                yield self.load(own) if name in OF_THE_PROGRAM else importlib.import_module(name)
                yield from self.imports_of(own, seen)

    def place(self, file: str) -> tuple[str, int | None]:
        """File and line of the student's code where the present exception arose."""
        _, error, _ = sys.exc_info()
        frames = traceback.extract_tb(error.__traceback__ if error else None)
        own = [frame for frame in frames if Path(frame.filename).parent == self.folder]
        return (Path(own[-1].filename).name, own[-1].lineno) if own else (file, None)


def imported_names(path: Path) -> list[str]:
    """The names of the modules that a file imports anywhere; none if it cannot be read."""
    try:
        nodes = list(ast.walk(ast.parse(path.read_bytes())))
    except (OSError, SyntaxError, ValueError):
        return []
    whole = [alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names]
    return whole + [node.module for node in nodes if isinstance(node, ast.ImportFrom) and node.module]
