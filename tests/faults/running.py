"""Each fault of the list, in a copy of the checkout, against the tests that reach it."""

import contextlib
import csv
import functools
import hashlib
import multiprocessing
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from sim.cache import own_folder
from sim.files import replacing
from tests.faults.choosing import Records, Trial, trial_of_finder
from tests.faults.drawing import ROOT, SEED, Listed, read_list
from tests.faults.trial import DIED, MISSING, Mode, Outcome, run_tests

RESULTS = ROOT / "assets" / "bench" / "faults.csv"
COLUMNS = ("module", "kind", "before", "occurrence", "after", "result", "by", "seconds")
RECORDING_LIMIT = 1200.0  # [s] for all tests of a file, once
PLAIN_TEST = 2.0  # [s] that a test may take as plain Python
SLOWER = 10.0  # times as long as without the fault, and SLOWEST, takes a test that has no end
SLOWEST = 30.0  # [s]


def copy_of_checkout(work: Path, name: str) -> Path:
    """A fresh copy of the sources and what tests read, below `work`."""
    tree = work / name
    shutil.rmtree(tree, ignore_errors=True)
    listed = subprocess.run(
        ["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, capture_output=True, encoding="utf-8", check=True
    ).stdout.split("\n")
    for path in filter(None, listed):
        if (ROOT / path).is_file():
            (tree / path).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / path, tree / path)
    return tree


def link_cache(source: Path, target: Path) -> None:
    """The compiled kernels in a cache, as links: what is compiled or removed beside them leaves it as it is."""
    if source.is_dir():
        shutil.copytree(source, target, copy_function=link, dirs_exist_ok=True)


def link(source: str, target: str) -> None:
    """A link, or a copy on another file system; a file that is there stays."""
    if not os.path.exists(target):
        try:
            os.link(source, target)
        except OSError:
            shutil.copy2(source, target)


class Worker:
    """One process of the pool: its own copies of the checkout, and its own links to the compiled kernels.

    Tests without a fault compile into the cache of all workers.
    """

    def __init__(self, work: Path, number: int, limit: float) -> None:
        self.work, self.shared, self.limit = work / f"worker-{number}", work / "cache", limit
        self.work.mkdir(parents=True, exist_ok=True)
        self.tree = copy_of_checkout(self.work, "tree")
        self.sound = copy_of_checkout(self.work, "sound")

    @functools.cached_property
    def cache(self) -> Path:
        """Links to what has been compiled when the first fault is tried; what a fault compiles is removed."""
        folder = self.work / "cache"
        shutil.rmtree(folder, ignore_errors=True)
        link_cache(self.shared, folder)
        return folder

    def record(self, name: str, plain: bool) -> Outcome:
        """The tests of a file without a fault."""
        mode = Mode(plain, self.shared, until_failure=False, with_calls=True)
        return self.run([name], RECORDING_LIMIT, mode, PLAIN_TEST if plain else RECORDING_LIMIT)

    def try_fault(self, trial: Trial) -> tuple[str, str]:
        """("found", the test that found it), ("not found", ""), or ("open", why)."""
        fault = trial.listed.fault
        path = self.tree / fault.module
        sound = path.read_text("utf-8")
        wrong = fault.planted(sound)
        assert wrong is not None
        known = {folder.name for folder in self.cache.glob("kernels/*/*")}
        end = time.monotonic() + self.limit
        try:
            path.write_text(wrong, "utf-8")
            for part in trial.parts:
                left = end - time.monotonic()
                if left < 1.0:
                    return "open", f"no end within {self.limit:g} s"
                mode = Mode(part.plain, self.cache, self.sound if trial.same_kernels and not part.plain else None)
                if part.plain:  # what that does not find is for the compiled kernels
                    left /= 2
                # Where kernels are compiled, nobody knows how long a test takes.
                timeout = max(SLOWEST, SLOWER * part.longest) if trial.same_kernels else left
                outcome = self.run(part.tests, left, mode, timeout)
                if outcome.failed == MISSING:  # a case with another name is none that fails
                    files = list(dict.fromkeys(test.partition("::")[0] for test in part.tests))
                    outcome = self.run(files, end - time.monotonic(), mode, timeout)
                if outcome.failed and not (part.plain and outcome.crash):
                    return "found", outcome.failed
                if not outcome.ended and not part.plain:
                    return "open", f"no end within {self.limit:g} s"
            return "not found", "" if trial.parts else "no test"
        finally:
            path.write_text(sound, "utf-8")
            for folder in self.cache.glob("kernels/*/*"):
                if folder.is_dir() and folder.name not in known:
                    shutil.rmtree(folder)

    def run(self, tests: list[str], seconds: float, mode: Mode, timeout: float) -> Outcome:
        (self.work / "tests.txt").write_text("\n".join(tests), "utf-8")
        return run_tests(self.tree, [f"@{self.work / 'tests.txt'}"], seconds, mode, timeout)


worker: Worker  # of this process of the pool


def begin(work: Path, numbers: "multiprocessing.Queue[int]", limit: float) -> None:
    """The start of a process of the pool, which ends what it started when it is terminated."""
    global worker
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    worker = Worker(work, numbers.get(), limit)


def record_one(job: tuple[str, bool]) -> tuple[tuple[str, bool], Outcome]:
    return job, worker.record(*job)


def try_one(trial: Trial) -> tuple[Listed, str, str, float]:
    start = time.monotonic()
    result, by = worker.try_fault(trial)
    return trial.listed, result, by, time.monotonic() - start


@contextlib.contextmanager
def processes(work: Path, number: int, limit: float) -> Iterator[Any]:
    """A pool of processes, forked so that what tests import is there at once. It is terminated at the end."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    context = multiprocessing.get_context("fork")
    numbers = context.Queue()
    for i in range(number):
        numbers.put(i)
    with context.Pool(number, begin, (work, numbers, limit)) as pool:
        yield pool


def key_of_fault(listed: Listed) -> tuple[str, ...]:
    fault = listed.fault
    return fault.module, fault.kind, fault.before, str(fault.occurrence), fault.after


def key_of(row: dict[str, str]) -> tuple[str, ...]:
    return tuple(row[name] for name in COLUMNS[:5])


def read_results() -> dict[tuple[str, ...], dict[str, str]]:
    """The results there are, by fault."""
    if not RESULTS.exists():
        return {}
    with RESULTS.open(newline="", encoding="utf-8") as file:
        return {key_of(row): row for row in csv.DictReader(file)}


def write_results(results: dict[tuple[str, ...], dict[str, str]]) -> None:
    """Those of the list, in its order."""
    keys = [key_of_fault(listed) for listed in read_list()]
    with replacing(RESULTS) as draft, draft.open("w", newline="", encoding="utf-8") as file:
        writer: csv.DictWriter[str] = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(results[key] for key in keys if key in results)


def in_random_order(faults: list[Listed]) -> list[Listed]:
    """So that a run that is cut short has tried a sample of all."""
    return sorted(faults, key=lambda listed: hashlib.sha256(f"{SEED} {key_of_fault(listed)}".encode()).digest())


def names_of_tests(marks: str) -> set[str]:
    """The tests of the checkout that pytest chooses by an expression of marks."""
    command = [sys.executable, "-m", "pytest", "--collect-only", "-m", marks]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, encoding="utf-8", check=True).stdout
    return {line for line in listed.split("\n") if "::" in line}


def write_result(listed: Listed, result: str, by: str, took: float) -> None:
    key = key_of_fault(listed)
    latest = read_results()  # another run may have written since
    latest[key] = dict(zip(COLUMNS, (*key, result, by, f"{took:.1f}"), strict=True))
    write_results(latest)
    print(f"{result:10} {took:6.1f} s  {listed.fault.module}: {listed.fault.after}  [{by}]", flush=True)


def not_found_again(work: Path, chosen: list[Listed], long: set[str], *, workers: int, limit: float) -> list[Listed]:
    """Those of the faults, all found before, that the test that found each no longer finds, or that a long test found.

    long: the tests that README's command leaves out.
    """
    results = read_results()
    quick = names_of_tests("not stress and not long and not browser")
    quick |= {name.partition("::")[0] for name in quick}  # a file that could not be read found a fault, too
    jobs, left = [], []
    for listed in chosen:
        finder = results[key_of_fault(listed)]["by"]
        trial = trial_of_finder(listed, ROOT / listed.fault.module, finder) if finder in quick else None
        if trial is None:
            left.append(listed)
        else:
            jobs.append(trial)
    print(f"{len(jobs)} tests to try again, {len(left)} faults without one", flush=True)
    with processes(work, workers, limit) as pool:
        for listed, result, by, took in pool.imap_unordered(try_one, jobs):
            if result == "found" and by not in long:
                write_result(listed, result, by, took)
            else:
                left.append(listed)
    return left


def wanted(listed: Listed, results: dict[tuple[str, ...], dict[str, str]], start: str, only: str) -> bool:
    """Whether to try a fault: one without a result, or with the result `only`."""
    row = results.get(key_of_fault(listed))
    return listed.fault.module.startswith(start) and (row["result"] if row else "") == only


def run_faults(work: Path, start: str, only: str, *, workers: int, limit: float, most: int) -> None:
    """Try each fault of the list that has no result yet, of modules that begin with `start`.

    only: "": those without a result, or those with this result, again: of those that were found, at first the test that
    found each alone. limit: time of a fault [s]. most: so many faults. Each result is written at once, so that a run
    that is interrupted goes on where it was. "long": found by a test that README's command leaves out.
    """
    print(f"seed {SEED}", flush=True)
    work.mkdir(parents=True, exist_ok=True)
    link_cache(own_folder(), work / "cache")
    records, results = Records(work), read_results()
    long = names_of_tests("long and not stress")
    chosen = [listed for listed in in_random_order(read_list()) if wanted(listed, results, start, only)][:most]
    if only == "found":
        chosen = not_found_again(work, chosen, long, workers=workers, limit=limit)
    if not chosen:
        return
    with processes(work, workers, limit) as pool:
        missing = records.missing()
        for number, ((name, plain), outcome) in enumerate(pool.imap_unordered(record_one, missing), 1):
            if outcome.ended and outcome.failed != DIED:
                records.keep(name, plain, outcome)
            how = "plain" if plain else "compiled"
            print(f"({number} of {len(missing)}, {how}: {len(outcome.durations)} tests of {name})", flush=True)

        jobs = []
        for listed in chosen:
            trial = records.trial(listed, ROOT / listed.fault.module)
            if listed.equivalent:
                write_result(listed, "equivalent", listed.equivalent, 0.0)
            elif trial is not None:
                jobs.append(trial)
        for listed, result, by, took in pool.imap_unordered(try_one, jobs):
            write_result(listed, "long" if by in long else result, by, took)
