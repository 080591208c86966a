"""The process that runs a student's functions. `runner.py` starts it and speaks to it by pipes.

It sends `["ready"]` once, and gets `["folder", path]` once. It takes `["call", file, function, arguments]` and answers
with `["result", value, processor time]`, `["callback", number, arguments]` (a function among the arguments is called:
the other side computes it), or `["failed", kind, text, file, line, loading]` (loading: the file itself does not run).
It sends `["loaded", file]` once it has run a file. With `["march", file, function, arguments]` it advances a rope or
a cloth by the student's functions (`rope_march.py`, `cloth_march.py`), with `["compile", file, "", [names]]` it
compiles those of a rope for that, and with `["table", file, function, [columns, shape, allowed]]` it calls one function
at many arguments (`tabulate.py`). Printed lines are counted and dropped: the pipes belong to the lab.

`["watch", file, function, [twice, arguments]]` is a call that fails where the function has a side effect
(`diagnosis/effects.py`). `["edits", file, function, [kind, names, conditions, arguments]]` calls its edits,
`["words", file, function, [numbers, units, clashes]]` describes some of them, and
`["edited", file, function, [number, arguments]]` calls one of them (`diagnosis/edits.py`).
`["course", "", "", {name: text}]` has no answer: while a function is watched, these solutions stand in for the
functions of the course that it calls, and `["called", file, function, []]` tells which it has called. During a long
call it sends
`["at", file, line, function, work, processor time]` repeatedly on systems that do not tell the lab (`call_limit.py`).
"""

import ast
import builtins
import contextlib
import difflib
import faulthandler
import functools
import importlib
import importlib.util
import io
import os
import signal
import sys
import threading
import time
import traceback
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any, NoReturn

import numpy as np

from app.lab.check.diagnosis.causes import causes, late_causes, traps
from app.lab.check.diagnosis.edits import Candidate, Tree, more_slips, slips
from app.lab.check.diagnosis.effects import Effect, copied, state_of, watched
from app.lab.process.cloth_march import ClothFunctions
from app.lab.process.rope_march import ClothData, Functions, Unfit, march, unpacked
from app.lab.process.shared import (
    BACKGROUND_NICENESS,
    COMPILES,
    FORKS,
    ROPE_NICENESS,
    TRACE_SIGNAL,
    CodePlace,
    lower_priority,
    place_in,
)
from app.lab.process.tabulate import Interval, tabulate
from app.lab.process.template import fork_on_request
from app.lab.process.wire import pack, receive, send, unpack

MAX_LINES = 10_000  # printed in one call or march
MEMORY = 768 * 2**20  # [bytes] that a call may allocate, if the system can limit it
EDIT_TIME = 0.5  # [s] of processor time for the edits of a function
OF_THE_PROGRAM = ("app", "sim", "assets")  # packages whose names a student's file may have
SLIPS = "slips"
EDITS = {"traps": traps, "causes": causes, "more slips": more_slips}  # kinds of edits beside `SLIPS`
LOOK_AT_PARENT = 1.0  # [s] between two checks that the lab still runs
PLACE_INTERVAL = 0.1  # [s] between two messages of a long call on its place and processor time


class PrintedTooMuchError(BaseException):
    """Raised for too many printed lines; no `Exception`, so that a student's `except Exception` lets it pass."""


class CountedOutput(io.TextIOBase):
    """Stands for standard output: counts lines and drops them."""

    def __init__(self) -> None:
        self.lines = 0

    def writable(self) -> bool:
        return True

    def write(self, text: str, /) -> int:
        self.lines += text.count("\n")
        if self.lines > MAX_LINES:
            raise PrintedTooMuchError
        return len(text)


class Worker:
    """Loads a student's files and calls their functions."""

    folder: Path

    def __init__(self, *, was_tried: bool) -> None:
        """was_tried: another process has tried the functions, for which the student waits."""
        self.output = CountedOutput()
        # The pipes get other numbers; 0, 1 and 2, which the student's code sees, lead nowhere.
        self.incoming = os.fdopen(os.dup(0), "rb")
        self.outgoing = os.fdopen(os.dup(1), "wb")
        nowhere = os.open(os.devnull, os.O_RDWR)
        for number in (0, 1, 2):
            os.dup2(nowhere, number)
        sys.stdin = io.StringIO()
        sys.stdout = sys.stderr = self.output
        self.modules: dict[str, ModuleType] = {}
        self.imported: set[str] = set()  # files whose imports in functions are done
        self.states: dict[str, Any] = {}  # of the modules, before any watched call
        self.course: dict[str, Callable[..., Any]] = {}  # solutions of the course, by name
        self.called: set[str] = set()  # of these, by the functions that were watched
        self.tree: Tree | None = None  # of the last function with edits
        self.edits: list[tuple[Candidate, Callable[..., Any]]] = []
        self.compiled: dict[str, Callable[..., Any]] = {}
        self.was_tried = was_tried
        self.in_call = threading.Event()
        self.began = 0.0  # [s] of processor time, at the start of the call
        self.sending = threading.Lock()  # for one message

    def enter(self, folder: Path) -> None:
        """Work in the student's folder."""
        self.folder = folder
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

    def serve(self) -> None:
        """Report that the process is ready, then answer until the lab closes the pipe."""
        send(self.outgoing, ["ready"])
        told = receive(self.incoming)
        if told is None:
            return
        self.enter(Path(told[1]))
        while (message := receive(self.incoming)) is not None:
            kind, file, function, arguments = message
            if kind == "course":
                self.course = solutions(arguments)
                continue
            self.output.lines = 0
            self.began = time.process_time()
            self.in_call.set()
            answer = self.answer(kind, file, function, arguments)
            if answer[0] == "result":
                answer.append(time.process_time() - self.began)
            self.in_call.clear()
            try:
                self.say(answer)
            except BrokenPipeError:
                return
            except ValueError as error:  # the result is too long to send
                self.say(["failed", "raised", f"the result has {error}", file, None, False])
            if kind == "march" and not self.was_tried:
                self.was_tried = True
                lower_priority(ROPE_NICENESS)

    def say(self, message: list[Any]) -> None:
        """Send a message."""
        with self.sending:
            send(self.outgoing, message)

    def say_where(self) -> NoReturn:
        """Report the place of a long call; runs in a separate thread."""
        main = threading.main_thread().ident
        while True:
            self.in_call.wait()
            time.sleep(PLACE_INTERVAL)
            frames = traceback.walk_stack(sys._current_frames()[main or 0])
            place = place_in(self.folder, [(f.f_code.co_filename, line, f.f_code.co_name) for f, line in frames])
            with self.sending, contextlib.suppress(OSError):  # the lab has ended
                if self.in_call.is_set():  # no place is sent after the result
                    send(self.outgoing, ["at", *(place or CodePlace("", 0, "")), time.process_time() - self.began])

    def answer(self, kind: str, file: str, function: str, arguments: Any) -> list[Any]:
        """The message with the result of a call or a march."""
        loading = False
        try:
            if kind == "compile":
                from app.lab.process.compiled import compile_functions  # numba, which takes a second to import

                self.compiled, why = compile_functions(self.folder / file, *unpack(arguments, self.remote))
                return ["result", pack([sorted(self.compiled), why], lambda _: 0)]
            loading = file not in self.modules
            module = self.load(file)
            if loading:
                self.say(["loaded", file])
                loading = False
            if kind == "march":
                own, step, sheet, x, v, segments = unpack(arguments, self.remote)
                if sheet is None:
                    functions = Functions(module, own, step, self.compiled)
                else:
                    functions = ClothFunctions(module, own, step, ClothData(*sheet))
                done = march(functions, x, v, [unpacked(segment) for segment in segments])
                return ["result", pack(tuple(done), lambda _: 0)]
            target = plain(getattr(module, function, None))
            if not callable(target):
                return ["failed", "missing", missing(module, function), file, None, False]
            if kind == "table":
                columns, shape, allowed = unpack(arguments, self.remote)
                return ["result", pack(tabulate(target, function, columns, shape, Interval(*allowed)), lambda _: 0)]
            if kind == "watch":
                twice, arguments = arguments
                value = self.watch(file, function, unpack(arguments, self.remote), twice=twice)
            elif kind == "edits":
                *facts, arguments = arguments
                with self.solved([module, *self.others(file)], function):
                    which, names, conditions = facts
                    given = unpack(arguments, self.remote)
                    value = self.try_edits(file, function, which, names, conditions, given)
            elif kind == "called":
                value, self.called = sorted(self.called), set()
            elif kind == "words":
                value = self.edits_in_words(*arguments)
            elif kind == "edited":
                number, arguments = arguments
                with self.solved([module, *self.others(file)], function):
                    value = self.try_edit(file, self.edits[number][1], unpack(arguments, self.remote))
            else:
                value = target(*unpack(arguments, self.remote))
            return ["result", pack(value, lambda _: 0)]
        except Effect as error:
            return ["failed", error.kind, error.text, error.file or file, error.line, False]
        except Unfit as error:
            return ["failed", error.kind, error.text, file, error.line, False]
        except PrintedTooMuchError:
            return ["failed", "printed", f"prints more than {MAX_LINES} lines at a time", *self.place(file), loading]
        except MemoryError:
            text = f"asks for more memory than a call may take, {MEMORY // 2**20} MiB"
            return ["failed", "memory", text, *self.place(file), loading]
        except SystemExit:
            return ["failed", "ended", "calls exit(), which ends the program", *self.place(file), loading]
        except SyntaxError as error:
            where = Path(error.filename or file).name
            return ["failed", "syntax", f"{type(error).__name__}: {error.msg}", where, error.lineno, loading]
        except BaseException as error:
            text = "".join(traceback.format_exception_only(error)).strip().splitlines()
            return ["failed", "raised", text[-1] if text else type(error).__name__, *self.place(file), loading]

    @contextlib.contextmanager
    def solved(self, modules: list[ModuleType], function: str) -> Iterator[None]:
        """The course's own solutions in place of the other functions of the course that the student's modules have."""
        before: list[tuple[ModuleType, str, Any]] = []
        for own in modules:
            for key, value in list(vars(own).items()):
                name = key if key in self.course else getattr(value, "__name__", "")
                if name in self.course and name != function and (callable(value) or key == name):
                    before.append((own, key, value))
                    setattr(own, key, functools.partial(self.solution, name))
        try:
            yield
        finally:
            for own, key, value in before:
                setattr(own, key, value)

    def solution(self, name: str, *arguments: Any, **named: Any) -> Any:
        """The value of a solution of the course, whose use is noted."""
        self.called.add(name)
        return self.course[name](*arguments, **named)

    def watch(self, file: str, function: str, arguments: list[Any], *, twice: bool) -> Any:
        """The result of a function without side effects. Raises Effect."""
        module = self.modules[file]
        if file not in self.states:
            self.states[file] = state_of([module])
        others = self.others(file)

        def anew() -> tuple[Callable[..., Any], list[ModuleType]]:
            module = self.run(file)
            return plain(getattr(module, function)), [module, *others]

        target, modules = plain(getattr(module, function)), [module, *others]
        if state_of([module]) != self.states[file]:  # an earlier call has changed something
            target, modules = anew()
        with self.solved(modules, function):
            return watched(target, modules, arguments, self.folder, anew, twice=twice)

    def others(self, file: str) -> list[ModuleType]:
        """The student's modules that a file uses, also those that its functions import."""
        module = self.modules[file]
        if file not in self.imported:
            self.imported.add(file)
            with contextlib.suppress(SyntaxError, ValueError):
                for name in imports_of((self.folder / file).read_bytes()):
                    if (self.folder / f"{name}.py").is_file():
                        with contextlib.suppress(Exception):  # the function says so when it is called
                            importlib.import_module(name)
        loaded = [value for value in list(sys.modules.values()) if isinstance(value, ModuleType)]
        own = [value for value in loaded if os.path.dirname(getattr(value, "__file__", None) or "") == str(self.folder)]
        return [value for value in own if value is not module and value.__file__ != module.__file__]

    def try_edits(
        self, file: str, function: str, kind: str, names: list[str], conditions: list[str], arguments: list[Any]
    ) -> list[Any]:
        """The results of the edits of a function: number and result of each. kind: of `EDITS`.

        names, conditions: as of `slips`.
        """
        self.edits, found = [], []
        end = time.process_time() + EDIT_TIME
        try:
            source, known = (self.folder / file).read_bytes(), vars(self.modules[file])
            tree = self.tree = Tree(source, function, known, tuple(self.course))
        except LookupError:
            return []
        is_clean = raises_no_warning(plain(getattr(self.modules[file], function)), arguments)
        found_edits = EDITS[kind](tree) if kind != SLIPS else (*slips(tree, names, conditions), *late_causes(tree))
        for candidate in found_edits:
            if time.process_time() > end:
                break
            target = tree.function(candidate)
            if target is None:
                continue
            try:
                with strict(is_clean):
                    value = target(*copied(arguments))
            except Exception:
                continue
            found.append([len(self.edits), value])
            self.edits.append((candidate, target))
        return found

    def edits_in_words(self, numbers: list[int], units: dict[str, str], most: int) -> list[Any]:
        """Edits in words, without those that join more than `most` pairs of other units. units: of the arguments."""
        assert self.tree is not None
        chosen = [(number, self.edits[number][0]) for number in numbers]
        clear = [(number, candidate) for number, candidate in chosen if self.tree.clashes(candidate, units) <= most]
        return [[number, *self.tree.words(candidate)] for number, candidate in clear]

    def try_edit(self, file: str, target: Callable[..., Any], arguments: list[Any]) -> Any:
        """The result of an edit, which must not warn where the function itself does not. Raises Effect."""
        module = self.modules[file]
        function = plain(getattr(module, target.__name__))
        with strict(raises_no_warning(function, arguments)):
            return watched(target, [module], arguments, self.folder, lambda: (target, [module]), twice=False)

    def place(self, file: str) -> tuple[str, int | None]:
        """File and line of the student's code where the present exception arose."""
        _, error, _ = sys.exc_info()
        frames = traceback.extract_tb(error.__traceback__ if error else None)
        own = [frame for frame in frames if Path(frame.filename).parent == self.folder]
        return (Path(own[-1].filename).name, own[-1].lineno) if own else (file, None)

    def load(self, file: str) -> ModuleType:
        """The student's module, run once."""
        if file not in self.modules:
            self.modules[file] = self.run(file)
        return self.modules[file]

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

    def remote(self, number: int) -> Any:
        """A function of the lab as the student's function calls it."""

        def function(*arguments: Any) -> Any:
            self.say(["callback", number, pack(list(arguments), lambda _: 0)])
            message = receive(self.incoming)
            if message is None:
                os._exit(0)  # the lab has ended
            if message[0] == "refused":
                raise ValueError(message[1])
            return unpack(message[1], self.remote)

        return function


def imports_of(source: bytes) -> Iterator[str]:
    """The names of the modules that a file imports anywhere. Raises SyntaxError, ValueError."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module


def plain(function: Any) -> Any:
    """A function without numba's compiler: the check needs few calls of it."""
    return getattr(function, "py_func", function)


def missing(module: ModuleType, function: str) -> str:
    """Words for a function that a module lacks, with a name that is near."""
    text = f"there is no function {function}"
    if function in vars(module):
        return f"{text}: its name stands for a value of type {type(vars(module)[function]).__name__}"
    for name, value in vars(module).items():
        if isinstance(value, type) and callable(getattr(value, function, None)):
            return f"{text} at the left margin: it is a method of the class {name}"
    names = [name for name, value in vars(module).items() if callable(value)]
    plainest = {name.lower().replace("_", ""): name for name in names}
    near = difflib.get_close_matches(function.replace("_", ""), plainest, 1, 0.8)
    return f"{text}. Is it {plainest[near[0]]}?" if near else text


def solutions(sources: dict[str, str]) -> dict[str, Callable[..., Any]]:
    """Functions from their texts, which use no other name than np; without those that cannot be run."""
    found = {}
    for name, source in sources.items():
        inside: dict[str, Any] = {"np": np}
        with contextlib.suppress(Exception):  # of a teacher's file
            exec(compile(source, f"<{name} of the course>", "exec"), inside)
            found[name] = inside[name]
    return found


@contextlib.contextmanager
def strict(is_strict: bool) -> Iterator[None]:
    """Warnings, and numbers that are not finite, are errors in a `with` block."""
    with contextlib.ExitStack() as opened:
        if is_strict:
            opened.enter_context(np.errstate(all="raise", under="ignore"))
            opened.enter_context(warnings.catch_warnings())
            warnings.simplefilter("error")
        yield


def raises_no_warning(function: Callable[..., Any], arguments: list[Any]) -> bool:
    """False if a function warns at these arguments, or has a number on the way that is not finite."""
    try:
        with strict(True):
            function(*copied(arguments))
    except (FloatingPointError, Warning):
        return False
    except Exception:
        return True
    return True


def limit_memory() -> None:
    """Limit this process to `MEMORY` more than it has, if the system can (Linux)."""
    if sys.platform != "linux":
        return
    import resource

    pages = int(Path("/proc/self/statm").read_text("utf-8").split()[0])
    bound = pages * resource.getpagesize() + MEMORY
    with contextlib.suppress(ValueError, OSError):  # if a lower limit is already set
        resource.setrlimit(resource.RLIMIT_AS, (bound, bound))


def end_with_parent(parent: int) -> None:
    """End this process and its children when the lab has ended, also in the middle of an infinite loop.

    parent: the number of the process that started this one.
    """

    def watch() -> NoReturn:
        while os.getppid() == parent:
            time.sleep(LOOK_AT_PARENT)
        if os.name == "posix" and os.getpgid(0) == os.getpid():
            os.killpg(0, signal.SIGKILL)
        os._exit(0)

    threading.Thread(target=watch, daemon=True).start()


def main() -> None:
    """The process, or the template that it is forked from."""
    if sys.argv[2] == FORKS:
        trace, compiles, parent = fork_on_request()
    else:
        trace, compiles, parent = int(sys.argv[2]), sys.argv[3] == COMPILES, os.getppid()
    end_with_parent(parent)
    if TRACE_SIGNAL is not None:
        faulthandler.register(TRACE_SIGNAL, file=trace, all_threads=False)
    worker = Worker(was_tried=compiles)
    if sys.platform != "linux":
        threading.Thread(target=worker.say_where, daemon=True).start()
    lower_priority(BACKGROUND_NICENESS if compiles else 0)
    if compiles:
        importlib.import_module("app.lab.process.compiled")  # before the memory is limited
    limit_memory()
    worker.serve()
