"""On Windows what a student's function has started ends with the lab, and when the lab ends its process."""

import subprocess
import sys
import time
from pathlib import Path

import pytest

from app.lab.process.child_processes import end_with_this_program, kill_with_children
from tests.waiting import wait_for

ROOT = Path(__file__).parents[4]
pytestmark = pytest.mark.skipif(sys.platform != "win32", reason="elsewhere processes have groups, and see their parent")
# Starts another process; that one makes a file longer and longer, and neither ends.
CHILD = "import subprocess, sys; subprocess.Popen([sys.executable, '-c', sys.argv[1], sys.argv[2]])\nwhile True: pass"
GRANDCHILD = """import sys, time
while True:
    with open(sys.argv[1], "a") as file:
        file.write(".")
    time.sleep(0.01)
"""
# A lab that is killed in the middle, once it is told to.
LAB = """import os, subprocess, sys
from app.lab.process.child_processes import end_with_this_program
end_with_this_program(subprocess.Popen(sys.argv[1:], stdin=subprocess.DEVNULL))
sys.stdin.readline()
os._exit(9)
"""


def grows(path: Path) -> bool:
    before = path.stat().st_size
    time.sleep(1.0)
    return path.stat().st_size > before


def command(path: Path) -> list[str]:
    return [sys.executable, "-c", CHILD, GRANDCHILD, str(path)]


def begun(path: Path) -> bool:
    end = time.monotonic() + 20.0
    while time.monotonic() < end and not path.exists():
        time.sleep(0.1)
    return path.exists()


def test_children_are_killed_with_their_process(tmp_path: Path) -> None:
    path = tmp_path / "dots"
    process = subprocess.Popen(command(path))
    end_with_this_program(process)
    assert begun(path)
    assert grows(path)
    kill_with_children(process)
    process.wait(10.0)
    wait_for(lambda: not grows(path))


def test_all_end_with_the_lab(tmp_path: Path) -> None:
    path = tmp_path / "dots"
    lab = subprocess.Popen(
        [sys.executable, "-c", LAB, *command(path)], cwd=ROOT, stdin=subprocess.PIPE, encoding="locale"
    )
    assert begun(path)
    assert grows(path)
    lab.communicate("now\n", 60.0)
    assert lab.returncode == 9
    wait_for(lambda: not grows(path))
