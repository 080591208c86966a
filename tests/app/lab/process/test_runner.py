"""Functions of students in a process of their own: what can go wrong in one is named, and the next call works."""

import contextlib
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from app.lab.process import call_limit, runner
from app.lab.process.call_limit import ASLEEP, COMPUTING, ENDLESS, CallLimit
from app.lab.process.runner import START, RunError, Runner, has_ended
from app.lab.process.shared import FORKS
from app.lab.process.template import Template
from app.lab.process.wire import receive, send
from tests.waiting import wait_for

ROOT = Path(__file__).parents[4]
# What a function does -> the kind of the error and a part of its text.
ACCIDENTS = {
    "while True: pass": ("endless", "infinite loop"),
    "import time\n    time.sleep(60)": ("endless", "did not finish within"),
    "exit()": ("ended", "calls exit()"),
    "import os\n    os._exit(3)": ("ended", "exit status 3"),
    "import os\n    os.kill(os.getpid(), 11)": ("ended", "signal 11"),
    "return np.ones(1 << 27)": ("memory", "MiB"),
    "kept = []\n    while True: kept.append(bytearray(1 << 22))": ("memory", "MiB"),
    "for i in range(1_000_000): print(i)": ("printed", "more than 10000 lines"),
    "try:\n        while True: print()\n    except Exception: pass": ("printed", "more than 10000 lines"),
    "import os\n    while True: os.write(1, b'x' * 9999)": ("endless", "infinite loop"),
    "import os\n    for n in range(3, 30):\n        try: os.write(n, bytes([2, 0, 0, 0, 0, 0, 0, 0, 0x91, 0xC0]))"
    "\n        except OSError: pass\n    while True: pass": ("ended", "wrote into the lab's pipe"),
    "return 1 / 0": ("raised", "ZeroDivisionError: division by zero"),
    "return f(1)": ("raised", "RecursionError"),
    "return input()": ("raised", "EOFError"),
    "raise KeyboardInterrupt": ("raised", "KeyboardInterrupt"),
}
# What not every system can tell or limit.
LINUX_ONLY = {body for body, (kind, said) in ACCIDENTS.items() if kind == "memory" or said.startswith("signal")}


def write(folder: Path, body: str) -> None:
    (folder / "mine.py").write_text(
        f"import numpy as np\n\ndef f(x):\n    {body}\n\ndef right(x):\n    return 2 * x\n", "utf-8"
    )


@pytest.mark.parametrize(
    "body",
    [
        pytest.param(
            body, marks=pytest.mark.skipif(body in LINUX_ONLY and sys.platform != "linux", reason="Linux only")
        )
        for body in ACCIDENTS
    ],
)
def test_what_goes_wrong_is_named_and_the_next_call_works(tmp_path: Path, body: str) -> None:
    write(tmp_path, body)
    with Runner(tmp_path, time_limit=1.0 if ACCIDENTS[body][0] == "endless" else 20.0) as runner:
        with pytest.raises(RunError) as caught:
            runner.call("mine.py", "f", 1.0)
        assert caught.value.file == "mine.py"
        if not (ACCIDENTS[body][0] == "endless" and caught.value.kind == BUSY):  # which is true of a busy machine
            assert caught.value.kind == ACCIDENTS[body][0]
            assert ACCIDENTS[body][1] in str(caught.value)
        assert runner.call("mine.py", "right", 3.0) == 6.0


def test_the_effort_of_the_calls_is_processor_time_of_the_worker(tmp_path: Path) -> None:
    write(tmp_path, "import time\n    return time.process_time()")
    efforts = [0.0]
    with Runner(tmp_path, time_limit=20.0) as runner:
        for _ in range(3):
            assert efforts[-1] <= runner.call("mine.py", "f", 1.0)
            efforts.append(runner.effort)
    assert efforts == sorted(efforts)


def test_an_endless_loop_is_found_in_any_folder_and_function(tmp_path: Path) -> None:
    folder = tmp_path / "Übung ∂"
    folder.mkdir()
    text = "def größe(x):\n    while True:\n        x = -x\n\ndef f(x):\n    return größe(x)\n"
    (folder / "mine.py").write_text(text, "utf-8")
    with Runner(folder, time_limit=0.5) as runner, pytest.raises(RunError, match="größe did not finish") as caught:
        runner.call("mine.py", "f", 1.0)
    assert (caught.value.file, caught.value.line in (2, 3)) == ("mine.py", True)


def test_the_limit_that_is_told_is_the_one_that_was_passed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(tmp_path, "while True: pass")
    with Runner(tmp_path, time_limit=0.5) as runner, pytest.raises(RunError, match=r"within 0\.5 s"):
        runner.call("mine.py", "f", 1.0)
    monkeypatch.setattr("app.lab.process.runner.LOAD_LIMIT", 1e-6)
    monkeypatch.setattr("app.lab.process.runner.read_answers", lambda *_: None)  # a fork may be ready first
    with Runner(tmp_path, time_limit=5.0) as runner, pytest.raises(RunError, match=r"within 1e-06 s"):
        runner.start()


BUSY = "import os, time\n    os.sched_setaffinity(0, {x})\n    while time.process_time() < 0.15: pass\n    return x"


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="elsewhere nothing tells how long a process ran")
def test_a_call_that_waits_for_the_processor_is_no_endless_loop(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "app.lab.process.call_limit.MAX_WAIT", 200.0
    )  # a low priority can get a hundredth of a busy processor
    write(tmp_path, BUSY)
    core = min(os.sched_getaffinity(0))
    endless = f"import os; os.sched_setaffinity(0, {{{core}}})\nwhile 1: pass"
    loops = [subprocess.Popen([sys.executable, "-c", endless], start_new_session=True) for _ in range(8)]
    try:
        with Runner(tmp_path, 0.5) as runner:
            start = time.monotonic()
            assert runner.call("mine.py", "f", core) == core
            assert time.monotonic() - start > 0.5
    finally:
        for loop in loops:
            loop.kill()
            loop.wait()


def over_after(
    monkeypatch: pytest.MonkeyPatch, used: Callable[[float], tuple[bool, float]], *, told: bool = False
) -> tuple[float, str]:
    """Time [s] after which a call with a limit of 0.5 s is over, and why.

    used: whether the process sleeps and the processor time [s] it has, of time [s]. told: the process tells that.
    """
    clock = [100.0]
    monkeypatch.setattr(call_limit, "time", SimpleNamespace(monotonic=lambda: clock[0]))
    monkeypatch.setattr(call_limit, "processor_time", lambda _: used(clock[0] - 100.0))
    monkeypatch.setattr(call_limit, "sys", SimpleNamespace(platform="darwin" if told else "linux"))
    limit = CallLimit(0, 0.5)
    while (state := limit.look()) == COMPUTING:
        clock[0] += limit.patience + 1e-3
        if told:
            limit.note(used(clock[0] - 100.0)[1])
    return clock[0] - 100.0, state


@pytest.mark.parametrize("told", [False, True])
def test_a_limit_is_one_of_processor_time_and_on_a_busy_machine_ten_times_as_long(
    monkeypatch: pytest.MonkeyPatch, told: bool
) -> None:
    seconds, state = over_after(monkeypatch, lambda t: (False, t), told=told)
    assert (round(seconds, 1), state) == (0.5, ENDLESS)
    seconds, state = over_after(monkeypatch, lambda t: (False, t / 4.0), told=told)
    assert (round(seconds, 1), state) == (2.0, ENDLESS)
    seconds, state = over_after(monkeypatch, lambda t: (True, 0.0), told=told)
    assert (round(seconds, 1), state) == (0.6 if seconds > 0.55 else 0.5, ASLEEP)
    if not told:  # it waits for the processor, which only Linux tells
        seconds, state = over_after(monkeypatch, lambda t: (False, t / 50.0))
        assert (round(seconds, 1), state) == (5.0, call_limit.BUSY)
    # It computes, then sleeps: the sleep counts from its beginning.
    seconds, state = over_after(monkeypatch, lambda t: (t > 0.3, min(t, 0.3)), told=told)
    assert (0.75 < seconds < 0.95, state) == (True, ASLEEP)


def test_what_a_process_has_computed_before_a_call_does_not_count(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(call_limit, "processor_time", lambda _: (False, 7.0))
    monkeypatch.setattr(call_limit, "sys", SimpleNamespace(platform="linux"))
    limit = CallLimit(0, 0.5)
    assert (limit.look(), limit.taken) == (COMPUTING, 0.0)


def test_a_process_that_tells_nothing_is_no_endless_loop(monkeypatch: pytest.MonkeyPatch) -> None:
    """On a busy machine neither the function nor the thread that tells its time gets the processor."""
    clock = [100.0]
    monkeypatch.setattr(call_limit, "time", SimpleNamespace(monotonic=lambda: clock[0]))
    monkeypatch.setattr(call_limit, "sys", SimpleNamespace(platform="win32"))
    limit = CallLimit(0, 0.5)
    while (state := limit.look()) == COMPUTING:
        clock[0] += limit.patience + 1e-3
    assert (round(clock[0] - 100.0, 1), state) == (5.0, call_limit.BUSY)


def test_a_call_that_gets_no_processor_says_that_the_machine_is_busy(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(tmp_path, "import time; time.sleep(60)")
    monkeypatch.setattr(call_limit, "MAX_WAIT", 1.0)
    monkeypatch.setattr(call_limit, "processor_time", lambda _: (False, 0.0))  # it waits, and has not run
    with Runner(tmp_path, time_limit=0.3) as one:
        with pytest.raises(RunError, match=r"the machine is busy: f got 0 s of the processor within 0\.3 s") as caught:
            one.call("mine.py", "f", 1.0)
        assert caught.value.kind == runner.BUSY
        monkeypatch.undo()
        assert one.call("mine.py", "right", 3.0) == 6.0


def test_a_worker_tells_its_place_and_time_where_the_system_does_not(tmp_path: Path) -> None:
    """As on Windows and macOS, by a thread; here the thread runs on Linux too."""
    write(tmp_path, "import time; end = time.process_time() + 0.5\n    while time.process_time() < end: pass")
    start = START.replace("main()", "sys.platform = 'darwin'; main()").replace(
        "from app", "import app.lab.process.shared\nfrom app"
    )
    process = subprocess.Popen(
        [sys.executable, "-P", "-c", start, str(ROOT), "2", ""], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    assert process.stdin is not None
    assert process.stdout is not None
    assert receive(process.stdout) == ["ready"]
    send(process.stdin, ["folder", str(tmp_path)])
    send(process.stdin, ["call", "mine.py", "f", [1.0]])
    told = []
    while (message := receive(process.stdout)) is not None:
        told.append(message)
        if message[0] == "result":
            break
    process.stdin.close()
    process.wait()
    process.stdout.close()
    places = [message[1:] for message in told if message[0] == "at" and message[2]]
    assert places
    assert {(file, line, name) for file, line, name, *_ in places} <= {("mine.py", 4, "f"), ("mine.py", 5, "f")}
    used = [message[-1] for message in told if message[0] == "at"]
    assert used == sorted(used)
    assert used[-1] <= told[-1][2]
    assert 0.5 <= told[-1][2] < 5.0


PRIORITIES = """import os
from pathlib import Path
def spring_force(x1, x2, *rest):
    group = Path("/proc/self/autogroup")
    of_session = int(group.read_text().split()[-1]) if group.exists() else 0
    return (x2 - x1) * 0 + [os.getpriority(os.PRIO_PROCESS, 0), of_session, 0.0]
"""
ROPE_TWICE = """import sys, numpy as np
from pathlib import Path
from app.lab.process.rope_march import Forces, Segment
from app.lab.process.runner import Runner
x = np.linspace([0.0, 0.0, 3.0], [1.0, 0.0, 3.0], 3)
segment = Segment(1, 0.1, Forces(1.0, 800.0, 7.0, 0.0, 0.2, 0.0), np.zeros((0, 4, 3)))
with Runner(Path(sys.argv[1])) as runner:
    for _ in range(2):
        v = runner.march({"spring_force"}, "step_euler", x, 0.0 * x, [segment]).v[-1]
        print(*np.round(-10.0 * v[:2]).astype(int))
"""


@pytest.mark.skipif(not hasattr(os, "getpriority"), reason="priorities are POSIX")
@pytest.mark.parametrize(("user", "added"), [("ada", 19), ("", 0)])
def test_a_rope_is_tried_at_once_and_then_yields_to_the_labs_of_a_hub(tmp_path: Path, user: str, added: int) -> None:
    (tmp_path / "rope.py").write_text(PRIORITIES, "utf-8")
    surroundings = {key: value for key, value in os.environ.items() if key != "JUPYTERHUB_USER"}
    output = subprocess.run(
        [sys.executable, "-c", ROPE_TWICE, tmp_path],
        env=surroundings | ({"JUPYTERHUB_USER": user} if user else {}), cwd=ROOT, capture_output=True,
        encoding="locale", check=True,
    )  # fmt: skip
    own = os.getpriority(os.PRIO_PROCESS, 0)
    has_sessions = Path("/proc/self/autogroup").exists()
    expected = [[niceness, niceness if has_sessions else 0] for niceness in (own, min(19, own + added))]
    assert [[int(number) for number in line.split()] for line in output.stdout.splitlines()] == expected


def test_an_abort_before_the_process_runs_is_not_lost(tmp_path: Path) -> None:
    write(tmp_path, "while True: pass")
    with Runner(tmp_path, time_limit=20.0) as runner:
        runner.abort()
        with pytest.raises(RunError) as caught:
            runner.call("mine.py", "f", 1.0)
        assert caught.value.kind == "ended"


def test_an_error_names_file_and_line(tmp_path: Path) -> None:
    write(tmp_path, "import own\n    return own.g(x)")
    (tmp_path / "own.py").write_text("def g(x):\n    y = 1\n    return x + 'a'\n", "utf-8")
    with Runner(tmp_path) as runner, pytest.raises(RunError, match=r"own\.py, line 3: TypeError"):
        runner.call("mine.py", "f", 1.0)
    (tmp_path / "broken.py").write_text("x = 1\ndef f(:\n", "utf-8")
    with Runner(tmp_path) as runner, pytest.raises(RunError, match=r"broken\.py, line 2: SyntaxError"):
        runner.call("broken.py", "f", 1.0)


def test_what_is_not_there_is_named(tmp_path: Path) -> None:
    write(tmp_path, "return x")
    with Runner(tmp_path) as runner:
        with pytest.raises(RunError, match="no such file"):
            runner.call("other.py", "f", 1.0)
        with pytest.raises(RunError, match="no function h"):
            runner.call("mine.py", "h", 1.0)
        with pytest.raises(RunError, match="takes 1 positional argument"):
            runner.call("mine.py", "f", 1.0, 2.0)


def test_values_pass_unchanged(tmp_path: Path) -> None:
    write(tmp_path, "return x")
    array = np.random.default_rng(1).normal(size=(2, 3))
    with Runner(tmp_path) as runner:
        for value in (None, True, 3, 2.5, "text", [1.0, [2.0]], (1, (2.5,)), float("inf")):
            assert runner.call("mine.py", "f", value) == value
        for given in (array, array.astype("f4"), array > 0, np.arange(3), array.T, np.zeros((0, 3)), np.array(1 + 2j)):
            back = runner.call("mine.py", "f", given)
            assert back.dtype == given.dtype
            assert np.array_equal(back, given)
        assert runner.call("mine.py", "f", np.float32(0.5)) == 0.5
        assert runner.starts == 1


def test_an_answer_that_is_no_march_of_these_points_is_told() -> None:
    x, steps, seconds = np.zeros((4, 3)), 7, 0.5
    good = (np.zeros((2, 4, 3)), x, steps, seconds, seconds, False)
    assert runner.is_march(good, x.shape)
    forged: dict[int, list[object]] = {
        0: [x, np.zeros((2, 5, 3)), np.zeros((2, 4, 3), np.float32), None],
        1: [np.zeros((5, 3)), np.zeros((4, 3), int), [0.0]],
        2: [7.0, None],
        3: [1, "0.5"],
        4: [1, None],
        5: [0, None],
    }
    for place, values in forged.items():
        for value in values:
            assert not runner.is_march((*good[:place], value, *good[place + 1 :]), x.shape), (place, value)
    assert not runner.is_march(good[:5], x.shape)
    assert not runner.is_march([*good], x.shape)


def test_values_that_cannot_pass_are_named_by_their_type(tmp_path: Path) -> None:
    write(tmp_path, "return (i for i in range(3)) if x else {1: 2}")
    with Runner(tmp_path) as runner:
        assert runner.call("mine.py", "f", 1).type_name == "generator"
        assert runner.call("mine.py", "f", 0).type_name == "dict"


def test_a_function_among_the_arguments_is_computed_here(tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text("def f(x, h, a):\n    return x + h * a(x, 2.0)\n", "utf-8")
    seen = []

    def acceleration(x: np.ndarray, v: float) -> np.ndarray:
        seen.append((x.copy(), v))
        return 3.0 * x + v

    with Runner(tmp_path) as runner:
        assert np.array_equal(runner.call("mine.py", "f", np.ones(3), 0.5, acceleration), np.full(3, 3.5))
        assert len(seen) == 1
        (tmp_path / "other.py").write_text("def f(x, h, a):\n    return a(x)\n", "utf-8")
        with pytest.raises(RunError, match=r"other\.py, line 2: ValueError: .*cannot take these arguments"):
            runner.call("other.py", "f", np.ones(3), 0.5, acceleration)


def test_the_arguments_of_the_lab_stay_as_they_are(tmp_path: Path) -> None:
    write(tmp_path, "x += 1\n    return x")
    x = np.zeros(3)
    with Runner(tmp_path) as runner:
        assert np.array_equal(runner.call("mine.py", "f", x), np.ones(3))
    assert not x.any()


def gone(pid: int) -> bool:
    """Whether no process of this number runs any more."""
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return True
    state = Path(f"/proc/{pid}/stat")
    return state.exists() and state.read_text("utf-8").rpartition(")")[2].split()[0] == "Z"


@pytest.mark.skipif(os.name != "posix", reason="needs process groups")
def test_no_process_stays_behind(tmp_path: Path) -> None:
    start = "import subprocess, sys\n    p = subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(600)'])"
    write(tmp_path, f"{start}\n    return p.pid")
    with Runner(tmp_path, time_limit=20.0) as runner:
        pid = runner.call("mine.py", "f", 0)
        assert not gone(pid)
    end = time.monotonic() + 10.0
    while not gone(pid) and time.monotonic() < end:
        time.sleep(0.02)
    assert gone(pid)


@pytest.mark.skipif(os.name != "posix", reason="needs signals")
def test_an_endless_loop_ends_when_the_lab_is_killed(tmp_path: Path) -> None:
    write(tmp_path, "open('pid', 'w').write(str(__import__('os').getpid()))\n    while True: pass")
    lab = subprocess.Popen(
        [
            sys.executable,
            "-c",
            f"from app.lab.process.runner import *; Runner(Path({str(tmp_path)!r}), 600).call('mine.py', 'f', 1)",
        ],
        cwd=ROOT,
    )
    end = time.monotonic() + 30.0
    while not ((tmp_path / "pid").exists() and (tmp_path / "pid").read_text("utf-8")) and time.monotonic() < end:
        time.sleep(0.02)
    pid = int((tmp_path / "pid").read_text("utf-8"))
    lab.send_signal(signal.SIGKILL)
    lab.wait()
    while not gone(pid) and time.monotonic() < end:
        time.sleep(0.05)
    assert gone(pid)


@pytest.fixture
def killed(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The groups that are killed; each must still have its number, which a process keeps until it is reaped."""
    groups: list[int] = []
    killpg = os.killpg

    def kill(group: int, number: int) -> None:
        os.kill(group, 0)  # raises ProcessLookupError for a process that was reaped
        groups.append(group)
        killpg(group, number)

    monkeypatch.setattr(os, "killpg", kill)
    return groups


def has_group(group: int) -> bool:
    try:
        os.kill(-group, 0)
    except ProcessLookupError:
        return False
    return True


@pytest.mark.skipif(os.name != "posix", reason="process groups and sessions are POSIX")
def test_a_process_has_a_session_of_its_own(tmp_path: Path) -> None:
    write(tmp_path, "import os\n    return [os.getpid(), os.getpgid(0), os.getsid(0)]")
    with Runner(tmp_path) as runner:
        process, group, session = runner.call("mine.py", "f", 1.0)
    assert (group, session) == (process, process)


def test_a_call_does_not_wait_for_the_death_of_the_last_process(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(tmp_path, "while True: pass")
    dead, disposed = threading.Event(), threading.Event()

    def dispose(*arguments: Any) -> None:
        dead.wait()
        runner.dispose(*arguments)
        disposed.set()

    with Runner(tmp_path, time_limit=0.2) as one:
        with monkeypatch.context() as patch:
            patch.setattr("app.lab.process.runner.dispose", dispose)
            patch.setattr("app.lab.process.runner.has_ended", lambda *_, **__: False)
            with pytest.raises(RunError, match="infinite"):
                one.call("mine.py", "f", 1.0)
        assert one.call("mine.py", "right", 3.0) == 6.0
        assert not disposed.is_set()
        dead.set()
        assert disposed.wait(10.0)


CHILD = "import os, subprocess\n    subprocess.Popen(['sleep', '60'])\n    os._exit(3)"


@pytest.mark.skipif(not hasattr(os, "waitid"), reason="what has ended can only be seen by reaping it")
def test_what_an_ended_process_has_started_is_ended_and_no_other_group(tmp_path: Path, killed: list[int]) -> None:
    write(tmp_path, CHILD)
    with Runner(tmp_path) as runner:
        with pytest.raises(RunError, match="exit status 3"):
            runner.call("mine.py", "f", 1.0)
        assert len(killed) == 1
        wait_for(lambda: not has_group(killed[0]))
        runner.call("mine.py", "right", 1.0)
        process = runner._process
        assert process is not None
        os.kill(process.pid, signal.SIGKILL)  # it ends between two calls
        assert has_ended(process, block=True)
        assert runner.call("mine.py", "right", 3.0) == 6.0
        assert killed[1:] == [process.pid]
        process = runner._process
        assert process is not None
        runner.abort()
        process.wait()  # it is reaped: nobody may use its number
    assert len(killed) == 2


@pytest.mark.skipif(runner.TEMPLATE is None, reason="processes are forked on Linux only")
def test_processes_are_forked_from_one_that_is_started_again_where_it_has_ended(tmp_path: Path) -> None:
    write(tmp_path, "import os\n    return [os.getpid(), os.getppid()]")
    with Runner(tmp_path) as first, Runner(tmp_path) as second:
        (one, parent), (other, its_parent) = first.call("mine.py", "f", 1.0), second.call("mine.py", "f", 1.0)
        assert one != other
        assert parent == its_parent == runner.TEMPLATE.process.pid
        os.kill(parent, signal.SIGKILL)
        wait_for(lambda: gone(one) and gone(other))
        for one_more in (first, second):
            assert one_more.call("mine.py", "right", 3.0) == 6.0
            assert one_more.call("mine.py", "f", 1.0)[1] == runner.TEMPLATE.process.pid != parent


def children(parent: int, word: str = "") -> list[int]:
    """The processes of a parent, also those that are to be reaped; or those that run by a command with a word."""
    found = []
    for path in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            state, its_parent = (path / "stat").read_text("utf-8").rpartition(")")[2].split()[:2]
            words = (path / "cmdline").read_text("utf-8").split("\0")
            if int(its_parent) == parent and (not word or (state != "Z" and word in words)):
                found.append(int(path.name))
    return found


@pytest.mark.skipif(runner.TEMPLATE is None, reason="processes are forked on Linux only")
@pytest.mark.parametrize("kills", [3, pytest.param(20, marks=pytest.mark.stress)])
def test_a_template_that_is_killed_blames_no_function(tmp_path: Path, kills: int, monkeypatch) -> None:
    before_test = runner.TEMPLATE.process
    monkeypatch.setattr(runner, "TEMPLATE", Template())
    write(tmp_path, "__import__('time').sleep(0.02)\n    return x")
    rng = np.random.default_rng(1)
    calls, errors, stop = [0] * 4, [], threading.Event()

    def call(number: int) -> None:
        with Runner(tmp_path) as each:
            while not stop.is_set():
                try:
                    assert each.call("mine.py", "f", 2.0) == 2.0
                    calls[number] += 1
                except RunError as error:
                    errors.append(str(error))

    threads = [threading.Thread(target=call, args=(number,)) for number in range(4)]
    for thread in threads:
        thread.start()
    try:
        for _ in range(kills):
            before = list(calls)
            wait_for(lambda before=before: all(now > then for now, then in zip(calls, before, strict=True)))
            time.sleep(rng.uniform(0.0, 1.0))
            os.kill(runner.TEMPLATE.process.pid, signal.SIGKILL)
        wait_for(lambda: len(children(runner.TEMPLATE.process.pid)) == 4)  # those of earlier ones have ended
        before = list(calls)
        wait_for(lambda: all(now > then for now, then in zip(calls, before, strict=True)))
        mine = {process.pid for process in (before_test, runner.TEMPLATE.process) if process is not None}
        assert set(children(os.getpid(), FORKS)) <= mine
    finally:
        stop.set()
        for thread in threads:
            thread.join()
        runner.TEMPLATE.process.kill()
        runner.TEMPLATE.process.wait()
    assert errors == []


@pytest.mark.skipif(runner.TEMPLATE is None, reason="processes are forked on Linux only")
def test_threads_that_find_no_template_start_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(tmp_path, "return x")
    template, starts = Template(), []
    start = template.start

    def slow_start(*arguments: Any) -> None:
        starts.append(arguments)
        time.sleep(0.2)  # the other thread gets there, too
        start(*arguments)

    monkeypatch.setattr(template, "start", slow_start)
    monkeypatch.setattr(runner, "TEMPLATE", template)
    with Runner(tmp_path) as first, Runner(tmp_path) as second, ThreadPoolExecutor(2) as pool:
        assert list(pool.map(lambda each: each.call("mine.py", "f", 1.0), (first, second))) == [1.0, 1.0]
    assert len(starts) == 1
    template.process.kill()
    template.process.wait()


@pytest.mark.skipif(runner.TEMPLATE is None, reason="processes are forked on Linux only")
def test_a_template_lives_whatever_it_is_asked_to_reap(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(tmp_path, "return x")
    template = Template()
    monkeypatch.setattr(runner, "TEMPLATE", template)
    with Runner(tmp_path) as one:
        one.call("mine.py", "f", 1.0)
        assert template.reap(template.connected, os.getpid()) is None  # no child of it
        assert template.reap(socket.socket(), one._process.pid) is None  # of another template
        assert one.call("mine.py", "f", 2.0) == 2.0
        assert one.starts == 1
        assert template.process.poll() is None
    with monkeypatch.context() as patch, Runner(tmp_path) as one:
        patch.setattr(os, "pidfd_open", lambda _: (_ for _ in ()).throw(OSError(24, "Too many open files")))
        with pytest.raises(RunError, match="no process can be started: Too many open files") as caught:
            one.call("mine.py", "f", 1.0)
    assert caught.value.kind == runner.BUSY
    wait_for(lambda: children(template.process.pid) == [])
    template.process.kill()
    template.process.wait()


def test_a_process_that_is_slow_to_start_gets_more_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(tmp_path, "return x")
    monkeypatch.setattr("app.lab.process.runner.LOAD_LIMIT", 1e-6)
    monkeypatch.setattr("app.lab.process.runner.MAX_LOAD_LIMIT", 20.0)
    limits = []
    with Runner(tmp_path) as one:
        with monkeypatch.context() as patch:
            patch.setattr("app.lab.process.runner.read_answers", lambda *_: None)  # never ready
            for _ in range(3):
                limits.append(one._load_limit)
                with pytest.raises(RunError, match=r"the machine is busy: no process can be started: .*within"):
                    one.call("mine.py", "f", 1.0)
        assert limits == pytest.approx([1e-6, 3e-6, 9e-6])
        one._load_limit = 20.0
        assert one.call("mine.py", "f", 1.0) == 1.0
        assert one._load_limit == 1e-6


@pytest.mark.skipif(runner.TEMPLATE is None, reason="processes are forked on Linux only")
def test_forked_processes_draw_different_random_numbers(tmp_path: Path) -> None:
    write(tmp_path, "import random\n    return [random.random(), float(np.random.default_rng().random())]")
    drawn = []
    for _ in range(2):
        with Runner(tmp_path) as each:
            drawn += each.call("mine.py", "f", 1.0)
    assert len(set(drawn)) == 4
