"""What is waited for is compiled in other processes; one that is killed costs what it was at and no more."""

import os
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from app.scenes.ahead import compiling
from app.scenes.ahead.compiling import Compiling, Job
from tests.fresh import noted

ROOT = Path(__file__).parents[4]


@pytest.fixture
def queue(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Compiling]:
    """Workers that write what they are asked for to a file, and take 0.05 s for it; "fatal" ends them."""
    program = (
        "import sys, time, os\n"
        "for line in sys.stdin:\n"
        f"    open({str(tmp_path / 'asked')!r}, 'a').write(line)\n"
        "    time.sleep(0.05)\n"
        "    if 'fatal' in line: os._exit(1)\n"
        "    print('wrong' if 'wrong' in line else '', flush=True)\n"
    )

    def start(*, ahead: bool) -> "subprocess.Popen[str]":
        return subprocess.Popen(
            [sys.executable, "-c", program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, encoding="locale"
        )

    monkeypatch.setattr(compiling, "start_process", start)
    made = Compiling(1)
    yield made
    made.close()
    assert not made.processes or all(process.poll() is not None for process in made.processes.values())


def asked(tmp_path: Path) -> list[str]:
    return [line.split("\t")[1] for line in (tmp_path / "asked").read_text("utf-8").splitlines()]


def jobs(*pieces: str) -> list[Job]:
    return [Job("rope", piece, False) for piece in pieces]


def test_what_is_wanted_last_comes_first_and_nothing_twice(queue: Compiling, tmp_path: Path) -> None:
    with queue.changed:  # so that the worker sees all at once
        queue.want(jobs("a", "b"))
        queue.want(jobs("c", "b"))
    assert queue.wait(jobs("a", "b", "c"), 30.0)
    queue.want(jobs("a"))
    assert queue.wait(jobs("a"), 30.0)
    assert asked(tmp_path) == ["c", "b", "a"]
    assert queue.progress() == ([], 0)


def test_a_worker_that_dies_or_fails_is_replaced_and_its_job_given_up(
    queue: Compiling, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    queue.want(jobs("fatal", "wrong", "good"))
    assert queue.wait(jobs("fatal", "wrong", "good"), 30.0)
    assert asked(tmp_path) == ["fatal", "wrong", "good"]
    assert [line.split(": ", 1)[1] for line in capfd.readouterr().err.splitlines()] == [
        "rope: fatal could not be compiled ahead: the process ended",
        "rope: wrong could not be compiled ahead: wrong",
    ]


def test_the_rest_is_compiled_by_another_worker(queue: Compiling, monkeypatch: pytest.MonkeyPatch) -> None:
    left = {"rope": [Job("rope", "x", False)], "race": [Job("race", "y", True)]}
    monkeypatch.setattr(compiling, "uncompiled", lambda name, params: left.get(name, []))
    monkeypatch.setattr(compiling, "CACHE", Path())
    queue.go_on_with("race")
    assert queue.wait([Job("rope", "x", False), Job("race", "y", True)], 30.0)
    assert list(queue.threads) == [compiling.AHEAD]
    assert queue.missing("race", None) == []


@pytest.mark.skipif(compiling.CACHE is None, reason="nothing can be kept here")
def test_a_worker_compiles_a_piece_that_the_next_process_only_loads(tmp_path: Path) -> None:
    folders = {"SPRINGTIDE_CACHE": str(tmp_path), "SPRINGTIDE_KERNELS": noted()}
    environment = {**os.environ, **folders, "PYTHONPATH": str(ROOT)}
    worker = [sys.executable, "-m", "app.scenes.ahead.compile_worker", "--ahead"]

    def ask(line: str) -> "subprocess.CompletedProcess[str]":
        return subprocess.run(
            worker, input=line, env=environment, capture_output=True, encoding="locale", timeout=120, check=True
        )

    assert ask("race\tdrawing\t1\n").stdout == "\n"
    assert list(tmp_path.rglob("race-drawn-drawing-*.warm"))
    kept = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.nbc")}
    assert kept
    loaded, unknown = ask("race\tdrawing\t1\nrace\tno such piece\t0\n").stdout.splitlines()
    assert loaded == ""
    assert {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.nbc")} == kept
    assert "KeyError" in unknown


def test_ctrl_c_leaves_a_worker_to_the_lab() -> None:
    code = "import signal, sys; from app.scenes.ahead.compile_worker import main; main(); "
    told = "print(signal.getsignal(signal.SIGINT) is signal.SIG_IGN, file=sys.stderr)"
    command = [sys.executable, "-c", code + told]
    ended = subprocess.run(command, input="", cwd=ROOT, capture_output=True, encoding="locale", timeout=60)
    assert ended.stderr.splitlines()[-1] == "True"


def test_a_killed_worker_gives_its_locks_back(tmp_path: Path) -> None:
    code = (
        "from sim.files import locked; from pathlib import Path; import time\n"
        f"with locked(Path({str(tmp_path / 'lock')!r})): print('held', flush=True); time.sleep(100)"
    )
    holder = subprocess.Popen([sys.executable, "-c", code], cwd=ROOT, stdout=subprocess.PIPE, encoding="locale")
    assert holder.stdout is not None
    assert holder.stdout.readline() == "held\n"
    waiter = subprocess.Popen([sys.executable, "-c", code], cwd=ROOT, stdout=subprocess.PIPE, encoding="locale")
    assert waiter.stdout is not None
    time.sleep(0.3)
    holder.kill()
    assert waiter.stdout.readline() == "held\n"
    for process in (holder, waiter):
        process.kill()
        process.wait()


def test_a_worker_that_starts_while_the_queue_is_closed_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    starting, go_on = threading.Event(), threading.Event()
    started: list[subprocess.Popen[str]] = []

    def start(*, ahead: bool) -> "subprocess.Popen[str]":
        starting.set()
        assert go_on.wait(30.0)
        command = [sys.executable, "-c", "import time; time.sleep(600)"]
        started.append(subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, encoding="locale"))
        return started[0]

    monkeypatch.setattr(compiling, "start_process", start)
    queue = Compiling(1)
    queue.want(jobs("a"))
    assert starting.wait(30.0)
    queue.close()  # it finds no process
    go_on.set()
    queue.threads[0].join(30.0)
    ended = not queue.threads[0].is_alive()
    started[0].kill()  # of a thread that waits for it, too
    assert ended
