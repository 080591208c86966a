"""The process that runs a student's functions. `runner.py` starts it and speaks to it by pipes.

It sends `["ready"]` once, and gets `["folder", path]` once. It takes `["call", file, function, arguments]` and answers
with `["result", value, processor time]`, `["callback", number, arguments]` (a function among the arguments is called:
the other side computes it), or `["failed", kind, text, file, line, loading]` (loading: the file itself does not run).
It sends `["loaded", file]` once it has run a file. With `["march", file, function, arguments]` it advances a rope or
a cloth by the student's functions (`rope_march.py`, `cloth_march.py`), with `["compile", file, "", [names]]` it
compiles those of a rope for that, and with `["table", file, function, [columns, shape, allowed]]` it calls one function
at many arguments (`tabulate.py`). Printed lines are counted and dropped: the pipes belong to the lab.

`["watch", file, function, [twice, samples]]` calls a function at several arguments, and fails where it has a side
effect (`checked_calls.py`, `diagnosis/effects.py`). `["oscillate", file, function, [steps, samples]]` does so with
steps of an oscillator, each from that before (`diagnosis/oscillator.py`).
`["edits", file, function, [kind, names, conditions, arguments]]` calls a function's edits,
`["words", file, function, [numbers, units, clashes]]` describes some of them, and
`["edited", file, function, [number, samples]]` calls one of them (`diagnosis/edits.py`).
`["course", "", "", {name: text}]` has no answer: while a function is watched, these solutions stand in for the
functions of the course that it calls, and `["called", file, function, []]` tells which it has called.

During a long call it sends `["at", file, line, function, work, processor time]` repeatedly on systems that do not tell
the lab (`call_limit.py`).
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

from app.lab.diagnosis.effects import Effect
from app.lab.process.checked_calls import CheckedCalls, plain, solutions
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
from app.lab.process.student_modules import StudentModules
from app.lab.process.tabulate import Interval, tabulate
from app.lab.process.template import fork_on_request
from app.lab.process.wire import pack, receive, send, unpack

MAX_LINES = 10_000  # printed in one call or march
MEMORY = 768 * 2**20  # [bytes] that a call may allocate, if the system can limit it
CHECKS = ("watch", "oscillate", "edits", "words", "edited", "called")  # messages of the check
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

    modules: StudentModules
    checks: CheckedCalls

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
        self.compiled: dict[str, Callable[..., Any]] = {}
        self.was_tried = was_tried
        self.in_call = threading.Event()
        self.began = 0.0  # [s] of processor time, at the start of the call
        self.sending = threading.Lock()  # for one message

    def serve(self) -> None:
        """Report that the process is ready, then answer until the lab closes the pipe."""
        send(self.outgoing, ["ready"])
        told = receive(self.incoming)
        if told is None:
            return
        self.modules = StudentModules(Path(told[1]))
        self.checks = CheckedCalls(self.modules)
        while (message := receive(self.incoming)) is not None:
            kind, file, function, arguments = message
            if kind == "course":
                self.checks.course = solutions(arguments)
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
            calls = [(f.f_code.co_filename, line, f.f_code.co_name) for f, line in frames]
            place = place_in(self.modules.folder, calls)
            with self.sending, contextlib.suppress(OSError):  # the lab has ended
                if self.in_call.is_set():  # no place is sent after the result
                    send(self.outgoing, ["at", *(place or CodePlace("", 0, "")), time.process_time() - self.began])

    def answer(self, kind: str, file: str, function: str, arguments: Any) -> list[Any]:
        """The message with the result of a call or a march."""
        loading = False
        try:
            if kind == "compile":
                from app.lab.process.compiled import compile_functions  # numba, which takes a second to import

                self.compiled, why = compile_functions(self.modules.folder / file, *unpack(arguments, self.remote))
                return ["result", pack([sorted(self.compiled), why], lambda _: 0)]
            loading = file not in self.modules.loaded
            module = self.modules.load(file)
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
            if kind in CHECKS:
                value = self.checks.answer(kind, file, function, unpack(arguments, self.remote))
            else:
                value = target(*unpack(arguments, self.remote))
            return ["result", pack(value, lambda _: 0)]
        except Effect as error:
            return ["failed", error.kind, error.text, error.file or file, error.line, False]
        except Unfit as error:
            return ["failed", error.kind, error.text, file, error.line, False]
        except PrintedTooMuchError:
            text = f"prints more than {MAX_LINES} lines at a time"
            return ["failed", "printed", text, *self.modules.place(file), loading]
        except MemoryError:
            text = f"asks for more memory than a call may take, {MEMORY // 2**20} MiB"
            return ["failed", "memory", text, *self.modules.place(file), loading]
        except SystemExit:
            return ["failed", "ended", "calls exit(), which ends the program", *self.modules.place(file), loading]
        except SyntaxError as error:
            where = Path(error.filename or file).name
            return ["failed", "syntax", f"{type(error).__name__}: {error.msg}", where, error.lineno, loading]
        except BaseException as error:
            text = "".join(traceback.format_exception_only(error)).strip().splitlines()
            return ["failed", "raised", text[-1] if text else type(error).__name__, *self.modules.place(file), loading]

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


def missing(module: ModuleType, function: str) -> str:
    """Words for a function that a module lacks, with a name that is near."""
    text = f"there is no function {function}"
    if function in vars(module):
        return f"{text}: its name stands for a value of type {type(vars(module)[function]).__name__}"
    for name, value in vars(module).items():
        if isinstance(value, type) and callable(getattr(value, function, None)):
            return f"{text} at the left margin: it is a method of the class {name}"
    import difflib  # for a rare case

    names = [name for name, value in vars(module).items() if callable(value)]
    plainest = {name.lower().replace("_", ""): name for name in names}
    near = difflib.get_close_matches(function.replace("_", ""), plainest, 1, 0.8)
    return f"{text}. Is it {plainest[near[0]]}?" if near else text


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
