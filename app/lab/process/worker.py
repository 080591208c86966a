"""The process that runs a student's functions. `runner.py` starts it and speaks to it by pipes.

It sends `["ready"]` once, and gets `["folder", path]` once. It takes `["call", file, function, arguments]` and answers
with `["result", value, processor time]`, `["callback", number, arguments]` (a function among the arguments is called:
the other side computes it), or `["failed", kind, text, file, line, loading]` (loading: the file itself does not run).
It sends `["loaded", file]` once it has run a file. With `["march", file, function, arguments]` it advances a rope or
a cloth by the student's functions (`rope_march.py`, `cloth_march.py`), with `["compile", file, "", [names]]` it
compiles those of a rope for that, and with `["table", file, function, [columns, shape, allowed]]` it calls one function
at many arguments (`tabulate.py`). `["watch", file, function, [twice, arguments]]` is a call that fails where the
function has a side effect (`diagnosis/effects.py`). `["edits", file, function, [far, arguments]]` calls
its edits, and `["edited", file, function, [number, arguments]]` one of them (`diagnosis/edits.py`). During a long call
it sends `["at", file, line, function, processor time]` repeatedly on systems that do not tell the lab
(`call_limit.py`). Printed lines are counted and dropped: the pipes belong to the lab.
"""

import contextlib
import faulthandler
import importlib
import importlib.util
import io
import os
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any, NoReturn

from app.lab.check.diagnosis.edits import Edit, own_edits
from app.lab.check.diagnosis.effects import Effect, copied, state_of, watched
from app.lab.process.cloth_march import ClothFunctions
from app.lab.process.rope_march import ClothData, Functions, Unfit, march, unpacked
from app.lab.process.shared import BACKGROUND_NICENESS, COMPILES, FORKS, ROPE_NICENESS, TRACE_SIGNAL, lower_priority
from app.lab.process.tabulate import Interval, tabulate
from app.lab.process.template import fork_on_request
from app.lab.process.wire import pack, receive, send, unpack

MAX_LINES = 10_000  # printed in one call or march
MEMORY = 768 * 2**20  # [bytes] that a call may allocate, if the system can limit it
EDIT_TIME = 0.5  # [s] of processor time for the edits of a function
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
        self.states: dict[str, Any] = {}  # of the modules, before any watched call
        self.edits: list[Edit] = []  # of the last requested function
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

    def serve(self) -> None:
        """Report that the process is ready, then answer until the lab closes the pipe."""
        send(self.outgoing, ["ready"])
        told = receive(self.incoming)
        if told is None:
            return
        self.enter(Path(told[1]))
        while (message := receive(self.incoming)) is not None:
            kind, file, function, arguments = message
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
            codes = [(frame.f_code, line) for frame, line in frames]
            own = [(code, line) for code, line in codes if Path(code.co_filename).parent == self.folder]
            with self.sending, contextlib.suppress(OSError):  # the lab has ended
                if self.in_call.is_set():  # no place is sent after the result
                    at = [(Path(code.co_filename).name, line, code.co_name) for code, line in own] or [("", 0, "")]
                    send(self.outgoing, ["at", *at[0], time.process_time() - self.began])

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
            target = getattr(module, function, None)
            if not callable(target):
                return ["failed", "missing", f"there is no function {function}", file, None, False]
            if kind == "table":
                columns, shape, allowed = unpack(arguments, self.remote)
                return ["result", pack(tabulate(target, function, columns, shape, Interval(*allowed)), lambda _: 0)]
            if kind == "watch":
                twice, arguments = arguments
                value = self.watch(file, function, unpack(arguments, self.remote), twice=twice)
            elif kind == "edits":
                far, arguments = arguments
                value = self.try_edits(file, function, unpack(arguments, self.remote), far=far)
            elif kind == "edited":
                number, arguments = arguments
                module, target = self.modules[file], self.edits[number].function
                given = unpack(arguments, self.remote)
                value = watched(target, [module], given, self.folder, lambda: (target, [module]), twice=False)
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

    def watch(self, file: str, function: str, arguments: list[Any], *, twice: bool) -> Any:
        """The result of a function without side effects. Raises Effect."""
        module = self.modules[file]
        if file not in self.states:
            self.states[file] = state_of([module])
        others = modules_below(module, self.folder)

        def anew() -> tuple[Callable[..., Any], list[ModuleType]]:
            module = self.run(file)
            return getattr(module, function), [module, *others]

        target, modules = getattr(module, function), [module, *others]
        if state_of([module]) != self.states[file]:  # an earlier call has changed something
            target, modules = anew()
        return watched(target, modules, arguments, self.folder, anew, twice=twice)

    def try_edits(self, file: str, function: str, arguments: list[Any], *, far: bool) -> list[Any]:
        """The results of the edits of a function: number, before, after, line, condition and result of each."""
        self.edits, found = [], []
        end = time.process_time() + EDIT_TIME
        for edit in own_edits((self.folder / file).read_bytes(), function, vars(self.modules[file]), far=far):
            if time.process_time() > end:
                break
            try:
                value = edit.function(*copied(arguments))
            except Exception:
                continue
            found.append([len(self.edits), edit.before, edit.after, edit.line, edit.condition, value])
            self.edits.append(edit)
        return found

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


def modules_below(module: ModuleType, folder: Path) -> list[ModuleType]:
    """The modules of a folder that one of its modules uses, directly or indirectly."""
    found = [module]
    for user in found:
        for value in vars(user).values():
            name = None if isinstance(value, ModuleType) else getattr(value, "__module__", None)
            other = value if name is None else sys.modules.get(name)
            if isinstance(other, ModuleType) and all(other is not known for known in found):
                file = getattr(other, "__file__", None) or ""
                if os.path.dirname(file) == str(folder) and file != module.__file__:
                    found.append(other)
    return found[1:]


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
