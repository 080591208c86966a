"""Runs a student's functions in a separate process, so that they cannot harm the lab.

A call that takes more than 2 s of processor time is ended with its process, and the next call gets a new one. Time in
an import or in numba's compiler does not count, up to 30 s. A failure is a `RunError`, with its reason and place in
words for the student. If a process does not get the processor (`call_limit.py`), cannot be started, or ends because the
one that forked it has ended, the functions are not to blame: the error has the kind `BUSY`, for a lost process after
some tries.
"""

import ast
import contextlib
import os
import queue
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
import traceback
from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path
from typing import IO, Any, TypeAlias

import numpy as np

from app.lab.course.source import decoded
from app.lab.process.call_limit import ASLEEP, COMPUTING, ENDLESS, CallLimit
from app.lab.process.call_limit import BUSY as BUSY_MACHINE
from app.lab.process.child_processes import end_with_this_program, kill_with_children
from app.lab.process.cloth_march import FILE as CLOTH_FILE
from app.lab.process.rope_march import FILE as ROPE_FILE
from app.lab.process.rope_march import MarchResult, Segment, packed
from app.lab.process.shared import COMPILES, FORKS, TRACE_SIGNAL, CodePlace, place_in
from app.lab.process.tabulate import Interval
from app.lab.process.template import Forked, Template, can_fork
from app.lab.process.wire import Foreign, pack, receive, send, unpack

TIME_LIMIT = 2.0  # [s] of one call
LOAD_LIMIT = 10.0  # [s] until a new process is ready, which imports numpy; longer at each further try
MAX_LOAD_LIMIT = 90.0  # [s]
MAX_TRIES = 3  # of a call that loses its process
# Of a file that does not come to its end.
AT_LOADING = (
    'What stands outside of functions runs whenever the file is loaded: put it under if __name__ == "__main__":'
)
BUSY = "busy"  # kind of an error that the student's functions did not cause
COMPILE_LIMIT = 60.0  # [s] for compiling
TABLE_ROWS = 512  # of a table that are computed in one call
TRACE_TIME = 0.2  # [s] for a process without an answer to report its place
MAX_TRACE = 2**16  # [bytes] of what it says
FRAME = re.compile(r'File "(.+)", line (\d+) in (.+)')  # as faulthandler writes it
ESCAPED = re.compile(r"\\x[0-9a-f]{2}|\\u[0-9a-f]{4}|\\U[0-9a-f]{8}")  # its characters beyond ASCII
ROOT = Path(__file__).resolve().parents[3]  # the folder that holds `app`
START = "import sys; sys.path.insert(0, sys.argv[1]); from app.lab.process.worker import main; main()"
COMMAND = (sys.executable, "-P", "-c", START, str(ROOT))
TEMPLATE = Template() if can_fork() else None  # of all runners
Process: TypeAlias = subprocess.Popen[bytes] | Forked


class RunError(Exception):
    """Failure of a student's function to return a result.

    kind: "missing", "syntax", "raised", "endless", "ended", "memory", "printed", `BUSY`, or of a march those of
    `rope_march.Unfit`. file, line: in the student's folder. loading: the file itself does not run, so that all of its
    functions fail.
    """

    def __init__(self, kind: str, text: str, file: str, line: int | None = None, *, loading: bool = False) -> None:
        super().__init__(text)
        self.kind = kind
        self.text = text
        self.file = file
        self.line = line
        self.loading = loading

    def __str__(self) -> str:
        return f"{self.file}, line {self.line}: {self.text}" if self.line else f"{self.file}: {self.text}"


class LostError(Exception):
    """The process of a call has ended with its template."""


class Runner:
    """The functions in the Python files of one folder. Use it in a `with` block, which ends its process."""

    def __init__(self, folder: Path, time_limit: float = TIME_LIMIT, *, compiles: bool = False) -> None:
        """time_limit: [s] of one call. compiles: the process has numba, and a low priority."""
        self.folder = folder.resolve()
        self.time_limit = time_limit
        self.compiles = compiles
        self.starts = 0  # processes started
        self.effort = 0.0  # [s] of processor time that calls have taken
        self.is_fresh = False  # its process runs without a folder yet, which can still be set
        self.course: Mapping[str, str] = {}  # texts of the solutions that stand in for what a watched function calls
        self._told: Mapping[str, str] = {}  # those that the process has
        self._parsed: set[str] = set()  # files without a syntax error
        self._loaded: set[str] = set()  # files that the process has run
        self._broken: dict[str, RunError] = {}  # file -> reason why it does not run: it is not tried for each function
        self._load_limit = LOAD_LIMIT
        self._process: Process | None = None
        self._aborted = False
        self._trace: IO[bytes] | None = None  # file in which the process reports its place on request
        self._place: CodePlace | None = None  # reported unasked
        self._answers: queue.SimpleQueue[list[Any] | None] = queue.SimpleQueue()

    def __enter__(self) -> "Runner":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def call(self, file: str, function: str, *arguments: Any) -> Any:
        """Result of a function: None, numbers, texts, arrays, lists and tuples of these, or `Foreign`.

        Functions among the arguments run here when the student's function calls them. Raises RunError.
        """
        return self.ask("call", file, function, list(arguments))

    def march(
        self, own: Collection[str], step: str, x: np.ndarray, v: np.ndarray, segments: Sequence[Segment]
    ) -> MarchResult:
        """Advance a rope (`rope_march.py`), or a cloth (`cloth_march.py`), by the student's functions.

        own: names of the functions that the student has begun. step: name of the method's function. x, v: (n, 3).
        segments: one or more, of one rope or one cloth. Raises RunError.
        """
        sheet = segments[0].sheet
        arguments = [sorted(own), step, sheet, x, v, [packed(segment) for segment in segments]]
        file = ROPE_FILE if sheet is None else CLOTH_FILE
        answer = self.ask("march", file, step, arguments)
        if not is_march(answer, x.shape):
            self.close()
            raise RunError("ended", f"{step} wrote into the lab's pipe", file)
        return MarchResult(*answer)

    def table(
        self, file: str, function: str, columns: Sequence[np.ndarray], shape: tuple[int, ...] | None, allowed: Interval
    ) -> np.ndarray:
        """(n, *shape) results of a function for each row of its arguments (`tabulate.py`). Raises RunError.

        columns: (n, ...) each. shape: None for the number of entries of each result. The limit in time is that of each
        `TABLE_ROWS` rows.
        """
        parts: list[np.ndarray] = []
        for first in range(0, len(columns[0]), TABLE_ROWS):
            rows = [column[first : first + TABLE_ROWS] for column in columns]
            part = self.ask("table", file, function, [rows, shape, list(allowed)])
            is_table = isinstance(part, np.ndarray) and part.dtype == np.float64
            if not is_table or part.shape != (len(rows[0]), *(shape or ())) or not np.isfinite(part).all():
                self.close()
                raise RunError("ended", f"{function} wrote into the lab's pipe", file)
            parts.append(part)
        return np.concatenate(parts)

    def compile(self, own: Collection[str]) -> tuple[list[str], str]:
        """Compile the functions that move a rope, for later marches; returns the compiled ones, and why others failed.

        Raises RunError.
        """
        names, why = self.ask("compile", ROPE_FILE, "numba", [sorted(own)], COMPILE_LIMIT)
        return names, why

    def abort(self) -> None:
        """End the process from another thread: a call under way fails at once, and so do later ones."""
        self._aborted = True
        process = self._process
        if process is not None:
            with contextlib.suppress(OSError):  # it has ended already
                process.kill()

    def enter(self, folder: Path) -> None:
        """Change to another folder; possible until the first call."""
        self.folder = folder.resolve()

    def start(self) -> None:
        """Start the process, so that the next call need not wait for it. Raises RunError if it does not start."""
        self._ready()

    def ask(self, kind: str, file: str, function: str, arguments: list[Any], time_limit: float | None = None) -> Any:
        """Answer of the process to a message of a kind of `worker.py`. Raises RunError.

        function: its name for errors. time_limit: [s]; None for that of the runner.
        """
        if self._aborted:
            raise RunError("ended", "the lab has ended the process", file)
        if not (self.folder / file).is_file():
            raise RunError("missing", missing_file(self.folder, file), file, loading=True)
        if file in self._broken:
            raise self._broken[file]
        if file not in self._parsed:
            check_syntax(self.folder / file)
            self._parsed.add(file)
        try:
            for _ in range(MAX_TRIES):
                functions: list[Callable[..., Any]] = []
                with contextlib.suppress(LostError):
                    return self._answer(kind, file, function, arguments, time_limit or self.time_limit, functions)
                if functions:  # they may have been called, and must not run twice for one call
                    break
        except RunError as error:
            if error.loading:
                self._broken[file] = error
            raise
        raise RunError(BUSY, "the machine is busy: the process of the call was lost", file)

    def _answer(
        self, kind: str, file: str, function: str, arguments: list[Any], time_limit: float,
        functions: list[Callable[..., Any]],
    ) -> Any:  # fmt: skip
        """As `ask`, by the present process. functions: takes those among the arguments. Raises LostError, RunError."""

        def refer(function: Callable[..., Any]) -> int:
            functions.append(function)
            return len(functions) - 1

        process = self._ready()
        if self.is_fresh:
            self._say(process, ["folder", str(self.folder)])
            self.is_fresh, self._told = False, {}
        if self._told != self.course:
            self._say(process, ["course", "", "", dict(self.course)])
            self._told = self.course
        limit, self._place = CallLimit(process.pid, time_limit), None
        self._say(process, [kind, file, function, pack(arguments, refer)])
        while True:
            answer = self._next(limit, file, function)
            try:
                if answer[0] == "result":
                    self.effort += float(answer[2])
                    return unpack(answer[1], lambda _: Foreign("function"))
                if answer[0] == "loaded":
                    self._loaded.add(file)
                    continue
                if answer[0] == "at":
                    _, where, line, inner, work, used = answer
                    self._place = CodePlace(str(where), int(line), str(inner), str(work)) if line else None
                    limit.note(float(used))
                    continue
                if answer[0] == "failed":
                    _, kind, text, where, line, loading = answer
                    line = line if isinstance(line, int) else None
                    raise RunError(str(kind), str(text), str(where), line, loading=bool(loading))
                reply = compute(functions, answer)
            except RunError as error:
                if error.kind == "memory":
                    self.close()  # frees its resources
                raise
            except (LookupError, TypeError, ValueError):
                self.close()
                raise RunError("ended", f"{function} wrote into the lab's pipe", file) from None
            self._say(process, reply)

    def close(self) -> None:
        """End the process, and all that it has started."""
        process, trace = self._process, self._trace
        self._process, self._trace, self.is_fresh, self._loaded = None, None, False, set()
        if process is None:
            return
        if process.returncode is None:  # otherwise its number, and its group's, may now be another process's
            with contextlib.suppress(OSError):
                kill_group(process)
        if has_ended(process):
            dispose(process, trace)
        else:  # one of a low priority needs the processor to die, which can take seconds on a busy machine
            threading.Thread(target=dispose, args=(process, trace), daemon=True).start()

    def _ready(self) -> Process:
        """The process, started unless it runs already. Raises RunError if it does not start."""
        if self._process is not None and not has_ended(self._process):
            return self._process
        self.close()
        self.starts += 1
        # One thread for linear algebra: more would count as memory, and the arrays are small.
        surroundings = {
            **os.environ,
            "OPENBLAS_NUM_THREADS": "1",
            "OMP_NUM_THREADS": "1",
            "PYTHONDONTWRITEBYTECODE": "1",
        }
        try:
            process = self._process = self._started(surroundings)
        except OSError as error:  # no more processes, files or memory
            why = error.strerror or str(error) or type(error).__name__
            raise RunError(BUSY, f"the machine is busy: no process can be started: {why}", "Python") from error
        if self._aborted:
            process.kill()
        self._answers = queue.SimpleQueue()
        threading.Thread(target=read_answers, args=(process, self._answers), daemon=True).start()
        try:
            limit = CallLimit(process.pid, self._load_limit, wall=self._load_limit)
            self._next(limit, "Python", "the start of a process")
        except (LostError, RunError) as error:
            if self._aborted:
                raise
            self._load_limit = min(3.0 * self._load_limit, MAX_LOAD_LIMIT)
            raise RunError(
                BUSY, f"the machine is busy: no process can be started: {error or 'it was lost'}", "Python"
            ) from None
        self._load_limit = LOAD_LIMIT
        self.is_fresh = True
        return process

    def _started(self, surroundings: dict[str, str]) -> Process:
        """A new process; these are the environment variables of one that is not forked. Raises OSError."""
        trace = self._trace = tempfile.TemporaryFile()  # noqa: SIM115 - closed with the process
        if TEMPLATE is not None:
            return TEMPLATE.fork((*COMMAND, FORKS), surroundings, trace.fileno(), compiles=self.compiles)
        process = subprocess.Popen(
            [*COMMAND, str(trace.fileno()), COMPILES if self.compiles else ""],
            pass_fds=(trace.fileno(),) if TRACE_SIGNAL is not None else (),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=surroundings,
            start_new_session=True,  # Ctrl-C in the terminal is the lab's to handle; see also `lower_priority`
        )
        end_with_this_program(process, background=self.compiles)
        return process

    def _where(self) -> CodePlace | None:
        """The place in the student's code that the process is running; None if unknown."""
        if self._process is None or self._trace is None or TRACE_SIGNAL is None:
            return self._place
        return traced(self._process, self._trace, self.folder)

    def _is_loading(self, file: str) -> bool:
        """True if the process has not yet run a file to its end."""
        return file not in self._loaded and (self.folder / file).is_file()

    def _say(self, process: Process, message: list[Any]) -> None:
        """Send a message; the end of a process is noticed at the next answer."""
        assert process.stdin is not None
        with contextlib.suppress(OSError):
            send(process.stdin, message)

    def _next(self, limit: CallLimit, file: str, function: str) -> list[Any]:
        """The next message of the process. Raises RunError if none comes in time, or the process has ended.

        Raises LostError if it has ended with its template.
        """
        early: CodePlace | None = None  # half way to the limit
        while True:
            state = limit.look()
            if state == COMPUTING:
                with contextlib.suppress(queue.Empty):
                    answer = self._answers.get(timeout=limit.patience)
                    break
                if early is None and limit.taken > 0.5 * limit.seconds:
                    early = self._where()
                continue
            place, loading = self._where(), self._is_loading(file)
            if state == ENDLESS and place is not None and place.work and limit.extend():
                continue
            self.close()
            where, line, inner, work = place or CodePlace(file, None, file if loading else function)
            inner = where if inner == "<module>" else inner
            if state == BUSY_MACHINE:
                text = f"{inner} got {limit.taken:.2g} s of the processor within {limit.wall:g} s"
                raise RunError(BUSY, f"the machine is busy: {text}", where, line)
            if state == ASLEEP:
                why = "it is waiting, not computing"
            elif work:
                why = f"it was still {work}"
            elif place is None or repeats(self.folder, early, place):
                why = "is there an infinite loop?"
            else:
                why = f"line {line} takes that long"
            if loading and not work:
                why += f" {AT_LOADING}"
            text = f"{inner} did not finish within {limit.seconds:g} s: {why}"
            raise RunError("endless", text, where, line, loading=loading)
        if answer is None:
            process, loading = self._process, self._is_loading(file)
            if process is not None:
                has_ended(process, block=True)
            self.close()
            if isinstance(process, Forked) and process.is_orphan and not self._aborted:
                raise LostError
            status = process.returncode if process is not None else None
            how = f"signal {-status}" if status is not None and status < 0 else f"exit status {status}"
            raise RunError("ended", f"{file if loading else function} ended its process ({how})", file, loading=loading)
        return answer


def traced(process: Process, trace: IO[bytes], folder: Path) -> CodePlace | None:
    """The place in a folder at which a process is, as it writes it when it gets `TRACE_SIGNAL`."""
    assert TRACE_SIGNAL is not None
    before = os.fstat(trace.fileno()).st_size
    with contextlib.suppress(OSError):  # it has ended
        process.send_signal(TRACE_SIGNAL)
    end = time.monotonic() + TRACE_TIME
    while time.monotonic() < end:
        time.sleep(0.01)
        text = ESCAPED.sub(unescaped, os.pread(trace.fileno(), MAX_TRACE, before).decode("ascii", "replace"))
        place = place_in(folder, FRAME.findall(text))
        if place is not None:
            return place
    return None


def repeats(folder: Path, early: CodePlace | None, late: CodePlace) -> bool:
    """True if two places of one call lie in the same loop, or in a function that calls itself."""
    if early is None or early.file != late.file or late.line is None or early.line is None:
        return False
    try:
        tree = ast.parse((folder / late.file).read_bytes())
    except (OSError, SyntaxError, ValueError):
        return False
    for node in ast.walk(tree):
        is_loop = isinstance(node, ast.For | ast.While | ast.ListComp | ast.GeneratorExp | ast.SetComp | ast.DictComp)
        if isinstance(node, ast.FunctionDef):
            is_loop = any(isinstance(part, ast.Name) and part.id == node.name for part in ast.walk(node))
        if is_loop and all(node.lineno <= line <= (node.end_lineno or 0) for line in (early.line, late.line)):  # type: ignore[attr-defined]
            return True
    return False


def unescaped(escaped: "re.Match[str]") -> str:
    """The character of an escape sequence of `ESCAPED`."""
    return chr(int(escaped[0][2:], 16))


def missing_file(folder: Path, file: str) -> str:
    """Words for a file that is not there, with one that is near."""
    stem = file.removesuffix(".py")
    for path in sorted(folder.glob("*")) if folder.is_dir() else ():
        if path.suffix == ".ipynb" and path.stem.lower().startswith(stem):
            return f"there is {path.name}, a notebook: save it as Python, as {file}"
        if path.is_file() and re.match(rf"{stem}\W*(\d*\W*)?(copy)?\W*\.py(\.txt)?$", path.name, re.IGNORECASE):
            return f"there is {path.name}: rename it to {file}"
        if path.is_dir() and (path / file).is_file():
            return f"there is {path.name}/{file}: move it one folder up"
    return "there is no such file"


def check_syntax(path: Path) -> None:
    """Raises RunError for a file that cannot be parsed, in the words of the process, which is not needed for it."""
    try:
        ast.parse(decoded(path.read_bytes()))
    except SyntaxError as error:
        text = f"{type(error).__name__}: {error.msg}"
        if (error.text or "").lstrip().startswith(("%", "!")):
            text += ". This line is for notebooks: remove it"
        raise RunError("syntax", text, path.name, error.lineno, loading=True) from None
    except (OSError, ValueError, RecursionError, MemoryError):  # the process raises these too
        pass


def read_answers(process: Process, answers: "queue.SimpleQueue[list[Any] | None]") -> None:
    """Put every message of the process into the queue, and None at its end."""
    assert process.stdout is not None
    while True:
        try:
            answer = receive(process.stdout)
        except (OSError, ValueError):  # closed from here
            answer = None
        answers.put(answer)
        if answer is None:
            return


def kill_group(process: Process) -> None:
    """Kill a process and its descendants. Raises OSError if that is impossible."""
    if isinstance(process, Forked) and process.is_orphan and process.has_ended():
        return  # it has ended by itself, and its number may now be another's
    with contextlib.suppress(ProcessLookupError):  # just forked: it has no group yet, and has started nothing
        if os.name == "posix":
            os.killpg(process.pid, signal.SIGKILL)
            return
    if isinstance(process, Forked):
        process.kill()
    else:
        kill_with_children(process)


def dispose(process: Process, trace: IO[bytes] | None) -> None:
    """Wait for the end of a process, reap it, and close its files."""
    has_ended(process, block=True)
    for stream in (process.stdin, process.stdout, trace):
        with contextlib.suppress(OSError):  # unsent data is dropped
            if stream is not None:
                stream.close()
    process.wait()


def has_ended(process: Process, *, block: bool = False) -> bool:
    """True if a process has ended. It stays unreaped if the system allows it, so that its group keeps its number.

    block: wait for the end.
    """
    if isinstance(process, Forked):
        return process.has_ended(block=block)
    if process.returncode is None and hasattr(os, "waitid"):  # not on Windows, nor on macOS before Python 3.13
        with contextlib.suppress(ChildProcessError):  # another thread has reaped it
            return os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOWAIT | (0 if block else os.WNOHANG)) is not None
    if block:
        process.wait()
    return process.poll() is not None


def unexpected(error: Exception, file: str) -> RunError:
    """An error of the lab itself, as one for the panel; its traceback goes to the terminal."""
    traceback.print_exception(error)
    return RunError("ended", f"the lab could not run your functions: {type(error).__name__}: {error}", file)


def is_march(answer: Any, shape: tuple[int, ...]) -> bool:
    """True if an answer has the entries of a `MarchResult` of points (n, 3): a student may have forged it."""
    if not isinstance(answer, tuple) or len(answer) != len(MarchResult._fields):
        return False
    x, v, steps, seconds, effort, left = answer
    arrays = all(isinstance(array, np.ndarray) and array.dtype == np.float64 for array in (x, v))
    times = isinstance(seconds, float) and isinstance(effort, float)
    numbers = times and isinstance(steps, int) and isinstance(left, bool)
    return arrays and numbers and x.shape == (len(x), *shape) and v.shape == shape


def compute(functions: list[Callable[..., Any]], answer: list[Any]) -> list[Any]:
    """The reply to a callback: the value, or the reason why its arguments are refused."""
    function, arguments = functions[answer[1]], unpack(answer[2], lambda _: None)
    try:
        return ["value", pack(function(*arguments), lambda _: 0)]
    except Exception as error:  # whatever the student's function handed over
        return ["refused", f"the function passed in cannot take these arguments: {error}"]
