"""The command line with odd terminals, files, hosts and signals: one line, the right exit status, and nothing left."""

import json
import os
import signal
import stat
import subprocess
import sys
import time
import tracemalloc
import urllib.request
from pathlib import Path

import numpy as np
import psutil
import pytest

from app.__main__ import main
from app.commands import serve as serve_command
from app.scenes import NAMES

ROOT = Path(__file__).parents[3]
RUN = ("run", "rope", "--seconds", "0.1", "--out")
needs_posix = pytest.mark.skipif(os.name != "posix", reason="links, pipes, full devices and signals are POSIX")


def program(*arguments: str, **changes: str) -> subprocess.Popen[str]:
    """`springtide` as a process of its own, with these environment variables."""
    return subprocess.Popen(
        [sys.executable, "-m", "app", *arguments], cwd=ROOT, env={**os.environ, **changes},
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="locale",
    )  # fmt: skip


@pytest.mark.skipif(os.name == "nt", reason="head is a program of Unix")
@pytest.mark.parametrize("words", [("run", "rope", "--list"), ("run", "--list")])
def test_a_reader_that_leaves_early_is_no_error(words):
    """As `head` does: longer output fails at a write, shorter output when it is flushed."""
    read, write = os.pipe()
    os.close(read)
    process = subprocess.run(
        [sys.executable, "-m", "app", *words],
        cwd=ROOT,
        stdout=write,
        stderr=subprocess.PIPE,
        encoding="locale",
        check=False,
    )
    os.close(write)
    assert (process.returncode, process.stderr) == (141, "")


def test_scenes_are_listed_without_a_scene(capsys):
    assert main(["run", "--list"]) == 0
    said = capsys.readouterr().out.split()
    assert set(NAMES) <= set(said)


def argument_error(capsys: pytest.CaptureFixture, *arguments: str) -> str:
    """The one line that a command with a bad argument prints."""
    assert main(list(arguments)) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1, lines
    return lines[0]


def parameters_in(path: Path) -> dict[str, object]:
    return json.loads(str(np.load(path)["about"]))["parameters"]


def test_a_preset_is_a_name_or_a_file(tmp_path):
    out, file = tmp_path / "a.npz", tmp_path / "mine.json"
    file.write_text(json.dumps({"scene": "rope", "parameters": {"points": 7}}), "utf-8")
    assert main([*RUN, str(out), "--preset", "Pendulum"]) == 0
    assert parameters_in(out)["points"] == 2
    assert main([*RUN, str(out), "--preset", "Pendulum", "--set", "points=3"]) == 0
    assert parameters_in(out)["points"] == 3
    assert main([*RUN, str(out), "--preset", str(file)]) == 0
    assert parameters_in(out)["points"] == 7


@pytest.mark.parametrize("host", ["", "a\0b", "no host", "\ud800", "ä" * 70])
def test_a_host_that_is_none_is_refused(capsys, monkeypatch, host):
    monkeypatch.setattr(serve_command, "open_server", None)  # nothing is to be started
    assert "--host" in argument_error(capsys, "--host", host, "--port", "0", "--no-open")


@needs_posix
def test_a_link_is_followed_and_stays_a_link(tmp_path):
    (tmp_path / "there").mkdir()
    target, link = tmp_path / "there" / "b.npz", tmp_path / "a.npz"
    link.symlink_to(target)
    for _ in range(2):  # the file is made, and replaced
        assert main([*RUN, str(link)]) == 0
        assert link.is_symlink()
        assert "x" in np.load(target)
    assert [path.name for path in target.parent.iterdir()] == ["b.npz"]


@needs_posix
def test_what_is_no_file_is_refused_and_left_alone(capsys, tmp_path):
    pipe, loop = tmp_path / "pipe.npz", tmp_path / "loop.npz"
    os.mkfifo(pipe)
    loop.symlink_to(loop)
    for path in (pipe, loop):
        assert "--out" in argument_error(capsys, *RUN, str(path))
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    assert loop.is_symlink()
    assert len(list(tmp_path.iterdir())) == 2


@pytest.mark.long
def test_an_ascii_terminal_takes_a_name_that_it_cannot_show(tmp_path):
    out = tmp_path / "mer–水.npz"
    # The name has to be one in the locale, or Python hands it over as bytes.
    process = program(*RUN, str(out), PYTHONIOENCODING="ascii", PYTHONUTF8="0", LC_ALL="C.UTF-8")
    said, errors = process.communicate(timeout=250)
    assert (process.returncode, errors) == (0, "")
    assert "mer\\u2013\\u6c34.npz" in said
    assert out.exists()


def served_ports(pid: int) -> list[int]:
    """The ports that a process listens on."""
    connections = psutil.Process(pid).net_connections("tcp")
    return [c.laddr.port for c in connections if c.status == psutil.CONN_LISTEN]


@pytest.mark.long
@needs_posix
def test_the_lab_is_served_where_nothing_can_be_printed(tmp_path):
    """As a newcomer has it, without compiled kernels."""
    command = [sys.executable, "-m", "app", "--port", "0", "--no-open"]
    cold = {**os.environ, "SPRINGTIDE_CACHE": str(tmp_path)}
    with open("/dev/full", "w", encoding="utf-8") as full:
        process = subprocess.Popen(command, cwd=ROOT, env=cold, stdout=full, stderr=subprocess.PIPE, encoding="locale")
    try:
        end = time.monotonic() + 60
        while not (listening := served_ports(process.pid)) and process.poll() is None and time.monotonic() < end:
            time.sleep(0.1)
        assert urllib.request.urlopen(f"http://127.0.0.1:{listening[0]}", timeout=30).status == 200
        time.sleep(1.0)  # the address was to be printed by now
        process.send_signal(signal.SIGINT)
        assert (process.wait(20), process.communicate()[1]) == (0, "")
    finally:
        process.kill()
        process.wait()


@needs_posix
def test_a_run_that_is_told_to_end_leaves_nothing(tmp_path):
    # A file of 100 MB, so that the signal comes while it is written.
    parameters = ("--set", "points=1000", "time_step=1e-3", "stiffness=100")
    process = program("run", "rope", "--seconds", "2", "--rate", "1000", "--out", str(tmp_path / "o.npz"), *parameters)
    end = time.monotonic() + 200
    while not list(tmp_path.glob(".*")) and time.monotonic() < end:
        time.sleep(0.001)
    time.sleep(0.2)  # beyond the trial whether the folder can be written
    while not list(tmp_path.glob(".*")) and time.monotonic() < end:
        time.sleep(0.01)
    process.send_signal(signal.SIGTERM)
    assert process.communicate(timeout=60)[1] == ""
    assert process.returncode == 128 + signal.SIGTERM
    assert list(tmp_path.iterdir()) == []


def test_waiting_for_the_end_never_blocks_for_long(monkeypatch):
    # On Windows a wait without a timeout cannot be interrupted by Ctrl-C.
    timeouts: list[float | None] = []

    class Done:
        def __init__(self) -> None:
            self.asked = 0

        def wait(self, timeout: float | None = None) -> bool:
            timeouts.append(timeout)
            self.asked += 1
            return self.asked == 3

    serve_command.wait_until(Done())  # type: ignore[arg-type]
    assert len(timeouts) == 3
    assert all(timeout is not None and timeout <= 1.0 for timeout in timeouts)


def test_a_run_holds_its_arrays_once(tmp_path):
    out = tmp_path / "a.npz"
    arguments = ["run", "rope", "--rate", "1000", "--out", str(out), "--set", "points=1000", "time_step=1e-3"]
    arguments.append("stiffness=100")
    assert main([*arguments, "--seconds", "0.01"]) == 0  # imports and kernels
    tracemalloc.start()
    try:
        assert main([*arguments, "--seconds", "0.4"]) == 0
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    arrays = np.load(out)
    size = sum(arrays[name].nbytes for name in arrays.files)
    assert size > 15e6
    assert peak < size + 20e6  # numpy writes an array in pieces of 17 MB


def test_a_mesh_of_huge_coordinates_is_refused_without_warnings(capsys, recwarn, tmp_path):
    mesh = tmp_path / "huge.obj"
    for size in ("1e300", "1e15"):
        corners = "".join(f"v {x} {y} {z}\n" for x, y, z in ((0, 0, 0), (size, 0, 0), (0, size, 0), (0, 0, size)))
        mesh.write_text(corners + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n", "utf-8")
        out = str(tmp_path / "a.npz")
        argument_error(capsys, "run", "radial_sea", "--seconds", "1", "--out", out, "--hull", str(mesh))
        assert not recwarn.list
