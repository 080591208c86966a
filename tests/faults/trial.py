"""One run of some tests in a process of its own, forked so that numpy, numba and pytest are imported once for all."""

import json
import os
import signal
import sys
import time
from pathlib import Path
from typing import Any, NamedTuple

import numba
import pytest
import scipy.integrate
import scipy.optimize
import scipy.special  # noqa: F401
import trimesh  # noqa: F401

import app  # noqa: F401  first of all, as numpy's BLAS is to get one thread

USAGE = 99  # exit status of a run that had no tests
OWN = ("app", "assets", "sim", "tests")
CRASHES = ("IndexError", "ZeroDivisionError", "OverflowError", "RuntimeWarning", "Timeout")


class Outcome(NamedTuple):
    """What a run of tests came to."""

    durations: dict[str, float]  # [s] of each test that passed
    failed: str  # the first that failed, or ""
    crash: bool  # whether it failed by an error that compiled code does not raise, or took too long
    ended: bool  # False where the time was up, or the process died


class Recorder:
    """A plugin of pytest: what passed, how long it took, and the first failure."""

    def __init__(self) -> None:
        self.durations: dict[str, float] = {}
        self.failures: list[str] = []
        self.crash = False

    def pytest_collectreport(self, report: Any) -> None:
        if report.failed:
            self.failures.append(report.nodeid)

    def pytest_runtest_logreport(self, report: Any) -> None:
        if report.failed:
            self.failures.append(report.nodeid)
            if len(self.failures) == 1:
                self.crash = any(f"{crash}" in report.longreprtext for crash in CRASHES)
        elif report.when == "call" and report.passed:
            self.durations[report.nodeid] = report.duration


def run_tests(tree: Path, tests: list[str], seconds: float, *, plain: bool, options: tuple[str, ...]) -> Outcome:
    """Run tests of the checkout in `tree` for at most `seconds` [s]; plain: kernels as plain Python."""
    report, log = tree.parent / "report.json", tree.parent / "log.txt"
    report.unlink(missing_ok=True)
    child = os.fork()
    if child == 0:
        os.setsid()
        output = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(output, 1)
        os.dup2(output, 2)
        os._exit(in_child(tree, tests, report, plain=plain, options=options))
    ended, status, start = False, 0, time.monotonic()
    while not ended and time.monotonic() - start < seconds:
        found, status = os.waitpid(child, os.WNOHANG)
        ended = found == child
        time.sleep(0.05)
    if not ended:
        os.killpg(child, signal.SIGKILL)
        os.waitpid(child, 0)
    if ended and os.waitstatus_to_exitcode(status) == USAGE:
        raise RuntimeError(f"pytest did not find the tests; its output is in {log}")
    if not report.exists():
        return Outcome({}, "", False, False)
    return Outcome(**json.loads(report.read_text()))


def in_child(tree: Path, tests: list[str], report: Path, *, plain: bool, options: tuple[str, ...]) -> int:
    """The run itself; returns the exit status."""
    for name in [name for name in sys.modules if name.partition(".")[0] in OWN]:
        del sys.modules[name]
    os.chdir(tree)
    sys.path[:] = [str(tree), *(path for path in sys.path if path not in ("", os.getcwd()))]
    os.environ["PYTHONPATH"] = str(tree)
    os.environ["SPRINGTIDE_CACHE"] = str(tree.parent / "cache")
    numba.config.DISABLE_JIT = plain  # type: ignore[attr-defined]
    recorder = Recorder()
    status = pytest.main(["-q", "-p", "no:cacheprovider", "--tb=native", *options, *tests], plugins=[recorder])
    if recorder.failures or status == pytest.ExitCode.OK:
        failed = recorder.failures[0] if recorder.failures else ""
        report.write_text(json.dumps(Outcome(recorder.durations, failed, recorder.crash, True)._asdict()))
        return 0
    return USAGE if status in (pytest.ExitCode.USAGE_ERROR, pytest.ExitCode.NO_TESTS_COLLECTED) else int(status)
