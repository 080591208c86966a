"""One run of some tests in a process of its own, forked so that numpy, numba and pytest are imported once for all."""

import json
import os
import signal
import sys
import time
from pathlib import Path
from typing import Any, NamedTuple

import imageio  # noqa: F401
import numba
import pyfftw  # noqa: F401
import pytest
import scipy.integrate
import scipy.optimize
import scipy.special  # noqa: F401
import trimesh  # noqa: F401
import viser  # noqa: F401

import app  # noqa: F401  first of all, as numpy's BLAS is to get one thread
from tests.faults.calls import CallRecorder

DIED, MISSING = "the process died", "a test is no longer there"
USAGE = 99  # exit status of a run that had no tests
OWN = ("app", "assets", "sim", "tests")
CRASHES = ("IndexError", "ZeroDivisionError", "OverflowError", "RuntimeWarning", "Timeout")


class Outcome(NamedTuple):
    """What a run of tests came to."""

    durations: dict[str, float]  # [s] of each test that passed
    failed: str  # the first that failed, or ""
    crash: bool  # whether it failed by an error that compiled code does not raise, or took too long
    ended: bool  # False where the time was up
    calls: dict[str, list[str]] = {}  # the functions that each test called, where that was asked for  # noqa: RUF012


class Recorder:
    """A plugin of pytest: what passed, how long it took, and the first failure.

    It ends the run at the first failure, if that is asked for. As plain Python there may be a failure behind a crash.
    """

    def __init__(self, *, until_failure: bool, plain: bool) -> None:
        self.durations: dict[str, float] = {}
        self.failures: list[str] = []
        self.crash, self.until_failure, self.plain = False, until_failure, plain

    def pytest_sessionstart(self, session: pytest.Session) -> None:
        self.session = session

    def pytest_collectreport(self, report: Any) -> None:
        if report.failed:
            self.failures.append(report.nodeid)

    def pytest_runtest_logreport(self, report: Any) -> None:
        if report.failed:
            crash = any(crash in report.longreprtext for crash in CRASHES)
            self.failures.insert(0 if self.crash and not crash else len(self.failures), report.nodeid)
            self.crash = crash and (self.crash or len(self.failures) == 1)
            if self.until_failure and not (self.plain and self.crash):
                self.session.shouldstop = "a test failed"
        elif report.when == "call" and report.passed:
            self.durations[report.nodeid] = report.duration


class Mode(NamedTuple):
    """How tests are run."""

    plain: bool  # kernels as plain Python
    cache: Path  # folder of compiled kernels
    sound: Path | None = None  # a checkout of which the compiled kernels are taken, where no kernel is different
    until_failure: bool = True  # end at the first failure
    with_calls: bool = False  # record which functions each test calls


def run_tests(tree: Path, tests: list[str], seconds: float, mode: Mode, timeout: float) -> Outcome:
    """Run tests of the checkout in `tree` for at most `seconds` [s], each for at most `timeout` [s]."""
    report, log = tree.parent / "report.json", tree.parent / "log.txt"
    report.unlink(missing_ok=True)
    child = os.fork()
    if child == 0:
        os.setsid()
        output = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(output, 1)
        os.dup2(output, 2)
        os._exit(in_child(tree, tests, report, mode, timeout))
    ended, status, start = False, 0, time.monotonic()
    try:
        while not ended and time.monotonic() - start < seconds:
            found, status = os.waitpid(child, os.WNOHANG)
            ended = found == child
            time.sleep(0.02)
    finally:
        if not ended:
            os.killpg(child, signal.SIGKILL)
            os.waitpid(child, 0)
    if ended and os.waitstatus_to_exitcode(status) == USAGE:
        if mode.until_failure:  # cases of a test come from the sources, too
            return Outcome({}, MISSING, False, True)
        raise RuntimeError(f"pytest did not find the tests; its output is in {log}")
    if not report.exists():
        return Outcome({}, DIED if ended else "", False, ended)
    return Outcome(**json.loads(report.read_text("utf-8")))


def use_kernels_of(sound: Path, tree: Path) -> None:
    """Take the compiled kernels of the checkout in `sound`: a fault outside of kernels leaves them as they are."""
    import sim.jit

    folder = sim.jit.kernel_folder
    sim.jit.ROOT = sound
    sim.jit.kernel_folder = lambda path: folder(sound / path.relative_to(tree.resolve()))  # type: ignore[assignment]
    for known in (sim.jit.source_of, sim.jit.imported_files):  # what its own import has asked for lies in `tree`
        known.cache_clear()


def in_child(tree: Path, tests: list[str], report: Path, mode: Mode, timeout: float) -> int:
    """The run itself; returns the exit status."""
    for name in [name for name in sys.modules if name.partition(".")[0] in OWN]:
        del sys.modules[name]
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    os.chdir(tree)
    sys.path[:] = [str(tree), *(path for path in sys.path if path not in ("", os.getcwd()))]
    os.environ["PYTHONPATH"] = str(tree)
    os.environ["SPRINGTIDE_CACHE"] = str(mode.cache)
    numba.config.DISABLE_JIT = mode.plain  # type: ignore[attr-defined]
    if mode.sound is not None:
        use_kernels_of(mode.sound, tree)
    recorder, calls = Recorder(until_failure=mode.until_failure, plain=mode.plain), CallRecorder(tree)
    plugins = [recorder, calls] if mode.with_calls else [recorder]
    options = ["-q", "-p", "no:cacheprovider", "--tb=native", "-m", "not stress and not browser"]
    options += ["--timeout-method", "signal"]  # "thread" ends the process, and with it the report
    if mode.until_failure and not mode.plain:  # a test that fails once by chance has not found the fault
        options += ["--reruns", "1"]
    status = pytest.main([*options, "--timeout", str(timeout), *tests], plugins=plugins)
    ran = (pytest.ExitCode.OK, pytest.ExitCode.INTERRUPTED)
    if mode.with_calls:  # a file may have none but those of a browser or of hours
        ran += (pytest.ExitCode.NO_TESTS_COLLECTED,)
    if recorder.failures or status in ran:
        failed = recorder.failures[0] if recorder.failures else ""
        found = Outcome(recorder.durations, failed, recorder.crash, True, calls.called)
        report.write_text(json.dumps(found._asdict()), "utf-8")
        return 0
    return USAGE if status in (pytest.ExitCode.USAGE_ERROR, pytest.ExitCode.NO_TESTS_COLLECTED) else int(status)
