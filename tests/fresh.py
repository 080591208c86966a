"""Fresh interpreters that have imported numba and have compiled with it once: each is there a second or two sooner.

On Windows, which cannot fork them, they are fresh only.
"""

import atexit
import functools
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import msgspec

from sim import jit
from sim.cache import processor

ROOT = Path(__file__).parent.parent
# Runs each program that it is told in a child of its own, which is forked before anything of ours is imported.
SERVER = """
import json, os, signal, sys, traceback
import numba, numpy
numba.njit(lambda x: x + 1)(numpy.zeros(3))
for line in sys.stdin:
    code, environment, folder = json.loads(line)
    child = os.fork()
    if not child:
        status = 1
        try:
            os.environ.update(environment)
            sys.path[:0] = environment.get("PYTHONPATH", "").split(os.pathsep)
            sys.dont_write_bytecode = bool(os.environ.get("PYTHONDONTWRITEBYTECODE"))  # read at a start only
            for number, name in enumerate(("in", "out", "errors")):
                os.dup2(os.open(os.path.join(folder, name), os.O_RDWR | os.O_CREAT), number)
            signal.alarm(120)
            exec(compile(code, "<code>", "exec"), {"__name__": "__main__"})
            status = 0
        except BaseException:
            traceback.print_exc()
        sys.stdout.flush(), sys.stderr.flush()
        os._exit(status)
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)
"""


@functools.cache
def noted() -> str:
    """A folder with the note alone that numba works as expected, which takes seconds to try."""
    folder = Path(tempfile.mkdtemp(prefix="springtide-noted-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    place = folder / "kernels" / processor()
    place.mkdir(parents=True)
    for note in jit.CACHE.glob("compiler-*") if jit.CACHE else ():
        (place / note.name).touch()
    return str(folder)


@functools.cache
def server() -> "subprocess.Popen[str]":
    process = subprocess.Popen(
        [sys.executable, "-c", SERVER], cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, encoding="locale"
    )
    atexit.register(process.kill)
    return process


def python(code: str, **environment: str) -> str:
    """What a fresh interpreter prints; one that numba is to be imported in anew where a variable is one of numba's."""
    environment = {"SPRINGTIDE_KERNELS": noted(), **environment}
    if not hasattr(os, "fork") or any(name.startswith("NUMBA_") for name in environment):
        done = subprocess.run(
            [sys.executable, "-c", code], cwd=ROOT, env={**os.environ, **environment},
            capture_output=True, encoding="locale", timeout=120, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        return done.stdout.strip()
    with tempfile.TemporaryDirectory() as folder:
        pipe = server()
        assert pipe.stdin is not None
        assert pipe.stdout is not None
        print(msgspec.json.encode((code, environment, folder)).decode(), file=pipe.stdin, flush=True)
        assert pipe.stdout.readline() == "0\n", Path(folder, "errors").read_text("utf-8")
        return Path(folder, "out").read_text("utf-8").strip()


def of_each(code: str, names: tuple[str, ...], folder: Path, environment: dict[str, str]) -> list[list[str]]:
    """The words of the lines that a program prints that forks for each of its arguments, where the system can."""
    groups = [names] if hasattr(os, "fork") else [(name,) for name in names]
    lines: list[str] = []
    for group in groups:
        done = subprocess.run(
            [sys.executable, "-c", code, *group], cwd=folder, env={**os.environ, **environment},
            capture_output=True, encoding="locale", timeout=280, check=True,
        )  # fmt: skip
        lines += done.stdout.splitlines()
    return [line.split() for line in lines]
