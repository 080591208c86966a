"""Side effects of a function: a changed argument, a memory between calls, a written file.

The process of a student's functions calls `watched`. It compares the arguments, the state of the student's modules and
the settings of Python and numpy before and after a call, and finds the line of a change by a second, traced call.
Only numpy is imported here, so that the process starts fast.
"""

import ast
import collections
import contextlib
import inspect
import os
import sys
import threading
import types
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property, lru_cache
from pathlib import Path
from types import FrameType, ModuleType
from typing import Any, NamedTuple, TypeAlias

import numpy as np

ARGUMENT, STATE, SETTING, FILE = "argument changed", "state kept between calls", "setting changed", "file written"
EFFECTS = (ARGUMENT, STATE, SETTING, FILE)  # kinds, which are the names of the mistakes
SAME_RESULT = 1e-9  # of the largest value, by which two results of equal calls may differ
MAX_DEPTH = 6  # of nested values that are compared
MAX_CODE = 70  # characters of a shown line
VARIABLES = ("os.putenv", "os.unsetenv")  # audit events
WRITES = frozenset(("os.mkdir", "os.remove", "os.rename", "os.rmdir", "os.truncate"))  # audit events beside "open"
RANDOM = ("numpy's random numbers", "Python's random numbers")
SETTINGS = frozenset((
    *RANDOM, "numpy's error handling", "numpy's print options", "the working folder", "the environment variables",
    "Python's recursion limit", "the module search path",
))  # fmt: skip
HIDDEN = "something carries over between calls, or is drawn at random. Compute everything from the arguments."
OPERATORS: dict[type[ast.operator], str] = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "**", ast.FloorDiv: "//", ast.Mod: "%",
    ast.MatMult: "@",
}  # fmt: skip


# Makes a fresh copy of a function, and of the modules where it may store state.
Anew: TypeAlias = Callable[[], tuple[Callable[..., Any], Sequence[ModuleType]]]


class Effect(Exception):  # noqa: N818 - a judgement on a function, not an error of the program
    """Side effect of a function. kind: one of `EFFECTS`. file, line: of the cause, if known."""

    def __init__(self, kind: str, text: str, file: str = "", line: int | None = None) -> None:
        super().__init__(text)
        self.kind, self.text, self.file, self.line = kind, text, file, line


class CodeLine(NamedTuple):
    """A running line of a student's code."""

    path: str
    line: int
    function: str


def copied(arguments: Sequence[Any]) -> tuple[Any, ...]:
    """Copies of arguments, which a function may change."""
    return tuple(copy_of(argument) for argument in arguments)


def copy_of(value: Any) -> Any:
    """Copy of a value, which a function may change."""
    if isinstance(value, list | tuple):
        return type(value)(copy_of(part) for part in value)
    return value.copy() if isinstance(value, np.ndarray) else value


def watched(
    function: Callable[..., Any], modules: Sequence[ModuleType], arguments: Sequence[Any], folder: Path, anew: Anew,
    *, twice: bool,
) -> Any:  # fmt: skip
    """The result of a function at these arguments. Raises Effect if it has a side effect.

    modules: in which it may store state. folder: of the student's files. twice: also compare a second call with
    equal arguments.
    """
    copies = copied(arguments)
    before = [digest(value) for value in copies]
    state = state_of(modules) | settings()
    with restored(), AUDIT.written(folder) as files:
        value = function(*copies)
        after = state_of(modules) | settings()
    names = names_of(function, len(copies))
    changed = [name for name, now, old in zip(names, copies, before, strict=True) if digest(now) != old]
    if changed:
        place = traced(function, copied(arguments), folder, lambda now: [digest(value) for value in now] != before)
        raise argument_effect(function, changed, place)
    if any(key in SETTINGS and key not in state for key in after):  # it has loaded a module with random numbers
        shake()
        return watched(function, modules, arguments, folder, anew, twice=twice)
    state_changes = [key for key in after if after[key] != state.get(key)]
    if (twice or state_changes) and is_plain(value):
        with restored():
            differs = not alike(value, function(*copied(arguments)))
            alternates = differs and alike(value, function(*copied(arguments)))
        if differs:
            raise state_effect(anew, state_changes, arguments, folder, alternates=alternates, differs=True)
    if state_changes:
        raise state_effect(anew, state_changes, arguments, folder, alternates=False, differs=False)
    if files:
        path, place = files[0]
        text = f"it writes the file {Path(path).name}{in_line(function, place)}. A function only returns its result."
        raise Effect(FILE, text, *file_and_line(place))
    return value


def argument_effect(function: Callable[..., Any], names: Sequence[str], place: CodeLine | None) -> Effect:
    """The effect of a function that changes its arguments of these names."""
    which = f"its argument {names[0]}" if len(names) == 1 else f"its arguments {' and '.join(names)}"
    text = f"it changes {which}{in_line(function, place)}. {advice(function, names[0], place)}"
    return Effect(ARGUMENT, text, *file_and_line(place))


def advice(function: Callable[..., Any], name: str, place: CodeLine | None) -> str:
    """Advice for leaving an argument unchanged."""
    statement = statement_at(place)
    if isinstance(statement, ast.AugAssign) and isinstance(statement.target, ast.Name):
        left, sign = statement.target.id, OPERATORS.get(type(statement.op))
        value = ast.unparse(statement.value)
        if isinstance(statement.value, ast.BinOp | ast.IfExp | ast.UnaryOp) and sign not in ("+", None):
            value = f"({value})"
        if sign:
            return f"Write {left} = {left} {sign} {value}, which makes a new array."
    if place is not None and place.function != function.__name__:
        return f"Let {place.function} work on a copy."
    return f"Begin with a copy: {name} = {name}.copy()."


def state_effect(
    anew: Anew, names: Sequence[str], arguments: Sequence[Any], folder: Path, *, alternates: bool, differs: bool
) -> Effect:
    """The effect of a function that changes things outside of it. names: of these, in words."""
    if not names:
        return Effect(STATE, f"two calls with the same arguments give different results{turns(alternates)}: {HIDDEN}")
    function, modules = anew()
    shake()
    first, key = state_of(modules) | settings(), names[0]
    with restored():
        place = traced(
            function, copied(arguments), folder, lambda _: (state_of(modules) | settings()).get(key) != first.get(key)
        )
    is_setting = key in SETTINGS and key not in RANDOM
    verb = "draws random numbers, or sets their seed" if key in RANDOM else f"changes {key}"
    text = f"it {verb}{in_line(function, place)}"
    if differs:
        text += f"; two calls with the same arguments give different results{turns(alternates)}"
    advice = "Leave settings as they are." if is_setting else "Compute everything from the arguments."
    return Effect(SETTING if is_setting else STATE, f"{text}. {advice}", *file_and_line(place))


def turns(alternates: bool) -> str:
    """Words for alternating results."""
    return ", in turns from call to call" if alternates else ""


def in_line(function: Callable[..., Any], place: CodeLine | None) -> str:
    """The line of an effect in words, and its function if that is another one."""
    if place is None:
        return ""
    statement = statement_at(place)
    code = "" if statement is None else ast.unparse(statement)
    excerpt = f": {code}" if code and len(code) <= MAX_CODE and "\n" not in code else ""
    other = f", which {place.function} runs" if place.function != function.__name__ else ""
    return f" (line {place.line}{other}{excerpt})"


def file_and_line(place: CodeLine | None) -> tuple[str, int | None]:
    """A place as `Effect` takes it."""
    return ("", None) if place is None else (Path(place.path).name, place.line)


def statement_at(place: CodeLine | None) -> ast.stmt | None:
    """The innermost statement on a line; None if it holds others, or the file cannot be read."""
    if place is None:
        return None
    try:
        tree = ast.parse(Path(place.path).read_bytes())
    except (OSError, SyntaxError, ValueError):
        return None
    statements = [
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.stmt) and node.lineno <= place.line <= (node.end_lineno or node.lineno)
    ]
    return None if not statements or hasattr(statements[-1], "body") else statements[-1]


def names_of(function: Callable[..., Any], number: int) -> list[str]:
    """The names of the arguments as the student has them."""
    code = getattr(function, "__code__", None)
    names = list(code.co_varnames[: code.co_argcount]) if code is not None else []
    return names[:number] + [f"number {i + 1}" for i in range(len(names), number)]


def alike(one: Any, other: Any) -> bool:
    """True if two results of equal calls agree."""
    if isinstance(one, tuple | list) and isinstance(other, tuple | list) and len(one) == len(other):
        return all(alike(a, b) for a, b in zip(one, other, strict=True))
    try:
        a, b = np.asarray(one, np.float64), np.asarray(other, np.float64)
    except (TypeError, ValueError):
        return digest(one) == digest(other)
    if a.shape != b.shape:
        return False
    finite = np.isfinite(a) & np.isfinite(b)
    if not np.array_equal(a[~finite], b[~finite], equal_nan=True):
        return False
    return bool((np.abs(a - b)[finite] <= SAME_RESULT * np.abs(a[finite]).max(initial=0.0)).all())


def digest(value: Any, folder: str = "", depth: int = MAX_DEPTH) -> Any:
    """A value that differs after a change of another one.

    Lists, dicts, sets, arrays and numbers count, and objects of the student's own classes, in files of `folder`. What
    an object of a library keeps is its own affair, as long as results do not change.
    """
    if isinstance(value, np.ndarray) and value.dtype.kind != "O":
        return value.dtype.str, value.shape, value.tobytes()
    if depth == 0:
        return id(value)
    if isinstance(value, list | tuple | np.ndarray | collections.deque):
        return type(value), tuple(digest(part, folder, depth - 1) for part in value)
    if isinstance(value, dict):
        return tuple((repr(key), digest(part, folder, depth - 1)) for key, part in value.items())
    if value is None or isinstance(value, int | float | complex | str | bytes | set | frozenset | np.generic):
        return type(value), repr(value)
    if folder and is_own(type(value), folder):
        cached = {name for name, part in inspect.getmembers_static(type(value)) if isinstance(part, cached_property)}
        held = (
            {key: part for key, part in vars(value).items() if key not in cached} if hasattr(value, "__dict__") else {}
        )
        return id(value), digest(held, folder, depth - 1)
    return id(value)


@lru_cache(1024)
def is_own(kind: type, folder: str) -> bool:
    """True for a class of a file in a folder."""
    file = getattr(sys.modules.get(kind.__module__), "__file__", None) or ""
    return os.path.dirname(file) == folder


def is_plain(value: Any) -> bool:
    """True for numbers, texts, arrays, and lists and tuples of them, by which two calls can be compared."""
    if isinstance(value, list | tuple):
        return all(map(is_plain, value))
    return value is None or isinstance(value, int | float | complex | str | np.ndarray | np.generic)


def state_of(modules: Sequence[ModuleType]) -> dict[str, Any]:
    """The state that functions of modules may keep: names in words, with digests. The first module goes unnamed."""
    digests: dict[str, Any] = {}
    folder = os.path.dirname(getattr(modules[0], "__file__", None) or "")
    for module in modules:
        inside = "" if module is modules[0] else f"{module.__name__}."
        for own_name, value in vars(module).items():
            if own_name.startswith("__"):
                continue
            name = f"{inside}{own_name}"
            if isinstance(value, types.FunctionType):
                digests.update(state_of_function(name, value, folder))
            elif isinstance(value, type) and value.__module__ == module.__name__:
                parts = {key: part for key, part in vars(value).items() if not key.startswith("__")}
                digests.update({f"{name}.{key}": digest(part, folder) for key, part in parts.items()})
            else:
                digests[name] = digest(value, folder)
    return digests


def state_of_function(name: str, function: types.FunctionType, folder: str) -> Mapping[str, Any]:
    """The state that a function itself holds: attributes, values of defaults, names around it."""
    digests = {f"{name}.{key}": digest(value, folder) for key, value in vars(function).items()}
    code = function.__code__
    arguments = code.co_varnames[: code.co_argcount]
    defaults = function.__defaults__ or ()
    for argument, value in zip(arguments[len(arguments) - len(defaults) :], defaults, strict=True):
        digests[f"the default of the argument {argument} of {name}"] = digest(value, folder)
    for cell_name, cell in zip(code.co_freevars, function.__closure__ or (), strict=True):
        try:
            digests[f"{cell_name} in {name}"] = digest(cell.cell_contents, folder)
        except ValueError:  # nothing in it yet
            continue
    return digests


def settings() -> dict[str, Any]:
    """Settings of Python and numpy that a function may change, as of `state_of`."""
    values: dict[str, Any] = {
        "numpy's error handling": tuple(np.geterr().values()),
        "numpy's print options": repr(np.get_printoptions()),
        "the working folder": os.getcwd(),
        "the environment variables": AUDIT.environment(),
        "Python's recursion limit": sys.getrecursionlimit(),
        "the module search path": tuple(sys.path),
    }
    if (numpy_random := sys.modules.get("numpy.random")) is not None:
        values[RANDOM[0]] = digest(numpy_random.get_state())
    if (python_random := sys.modules.get("random")) is not None:
        values[RANDOM[1]] = hash(python_random.getstate())
    return values


@contextlib.contextmanager
def restored() -> Iterator[None]:
    """Restore the settings after a `with` block, so that a second call changes them, too."""
    with np.errstate(), np.printoptions(), contextlib.chdir(os.getcwd()):
        yield


def shake() -> None:
    """Draw random numbers, so that a function that sets their seed changes their state again."""
    for name in ("numpy.random", "random"):
        if (module := sys.modules.get(name)) is not None:
            module.random()


def traced(
    function: Callable[..., Any], arguments: tuple[Any, ...], folder: Path, has_changed: Callable[[Sequence[Any]], bool]
) -> CodeLine | None:
    """The line of a student's code that changes something in a call at these arguments; None if not found.

    has_changed: from the arguments.
    """
    last: CodeLine | None = None
    code_line: CodeLine | None = None

    def trace(frame: FrameType, event: str, _: Any) -> Any:
        nonlocal last, code_line
        if code_line is None and has_changed(arguments):
            code_line = last
        if event == "line":
            last = place_of(frame)
        elif event == "return" and frame.f_back is not None and is_own(frame.f_back):
            last = place_of(frame.f_back)
        return None if code_line is not None else trace

    def is_own(frame: FrameType) -> bool:
        return os.path.dirname(frame.f_code.co_filename) == str(folder)

    before = sys.gettrace()
    sys.settrace(lambda frame, event, arg: trace if is_own(frame) else None)
    try:
        function(*arguments)
    except Exception:  # it is called again, in another state
        pass
    finally:
        sys.settrace(before)
    return code_line


def place_of(frame: FrameType) -> CodeLine:
    """The line that a frame is at."""
    return CodeLine(frame.f_code.co_filename, frame.f_lineno, frame.f_code.co_name)


Written: TypeAlias = list[tuple[str, CodeLine | None]]


class Audit:
    """Notes the files that a student's function writes, and changes of the environment, by a permanent audit hook."""

    def __init__(self) -> None:
        self.writes: Written | None = None
        self.has_hook = False
        self.thread = 0
        self.folder = ""
        self.variables: int | None = None  # hash of the environment variables; None after a change

    def listen(self) -> None:
        """Set the hook, once."""
        if not self.has_hook:
            sys.addaudithook(self.note)
            self.has_hook = True

    def environment(self) -> int:
        """Hash of the environment variables, which are read again after a change only: that takes long."""
        self.listen()
        if self.variables is None:
            self.variables = hash(frozenset(os.environ.items()))
        return self.variables

    @contextlib.contextmanager
    def written(self, folder: Path) -> Iterator[Written]:
        """Path and line of each file that this thread writes in a `with` block."""
        self.listen()
        writes: Written = []
        self.writes, self.thread, self.folder = writes, threading.get_ident(), str(folder)
        try:
            yield writes
        finally:
            self.writes = None

    def note(self, event: str, arguments: tuple[Any, ...]) -> None:
        """Note an event that writes a file or changes the environment."""
        if event in VARIABLES:
            self.variables = None
        if self.writes is None or threading.get_ident() != self.thread or not (event == "open" or event in WRITES):
            return
        path, *how = arguments
        if event == "open" and not is_writing(*how[:2]):
            return
        if isinstance(path, str | Path) and "__pycache__" not in str(path) and str(path) != os.devnull:
            frame: FrameType | None = inspect.currentframe()
            while frame is not None and os.path.dirname(frame.f_code.co_filename) != self.folder:
                frame = frame.f_back
            self.writes.append((str(path), None if frame is None else place_of(frame)))


def is_writing(mode: str | None, flags: int) -> bool:
    """True if a file is opened to be written."""
    return bool(flags & (os.O_WRONLY | os.O_RDWR)) or any(sign in (mode or "") for sign in "wax+")


AUDIT = Audit()
