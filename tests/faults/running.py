"""Each fault of the list, in a copy of the checkout, against the tests that concern its module."""

import csv
import hashlib
import json
import os
import re
import shutil
import subprocess
import time
from collections import Counter
from pathlib import Path

from tests.faults.drawing import ROOT, Listed, read_list
from tests.faults.trial import OWN, Outcome, run_tests
from tests.test_layers import imports, module_of

RESULTS = ROOT / "assets" / "bench" / "faults.csv"
COLUMNS = ("module", "kind", "before", "occurrence", "after", "result", "by", "seconds")
PLAIN_LIMIT, COMPILED_LIMIT = 60.0, 300.0  # [s] for all tests of a fault
PLAIN_TEST, QUICK = 1.0, 0.1  # [s] that a test may take as plain Python, and that it takes to be among the quick ones
DISCOVERED = re.compile(r"^sim/(ocean/spectra|springs/integrators|floating/shapes)/\w+\.py$")
OTHER_TESTS = {  # of modules with tests of other names
    "sim/validation.py": (
        "tests/sim/test_validation.py",
        "tests/sim/springs/test_net.py",
        "tests/sim/springs/test_refusals.py",
        "tests/sim/ocean/test_refusals.py",
    ),
}


def copy_of_checkout(work: Path) -> Path:
    """A fresh copy of the sources and what tests read, below `work`."""
    tree = work / "tree"
    shutil.rmtree(tree, ignore_errors=True)
    names = subprocess.run(
        ["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.split("\n")
    for name in filter(None, names):
        if (ROOT / name).is_file():
            (tree / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, tree / name)
    return tree


def link_cache(work: Path) -> None:
    """The compiled kernels, as links, so that what a fault compiles is not kept beside them."""
    cache, own = Path(os.environ.get("SPRINGTIDE_CACHE", "none")) / "kernels", work / "cache" / "kernels"
    own.mkdir(parents=True, exist_ok=True)
    for folder in cache.iterdir() if cache.exists() else ():
        if folder.is_dir() and not (own / folder.name).exists():
            shutil.copytree(folder, own / folder.name, copy_function=os.link)


def forget_new_kernels(work: Path, known: set[str]) -> None:
    for folder in (work / "cache" / "kernels").iterdir():
        if folder.is_dir() and folder.name not in known:
            shutil.rmtree(folder)


def files_for(module: str) -> list[str]:
    """The tests of a module, the nearest first: of its folder's tests those that lead to it by their imports.

    Where none do: all of the folder, if its package finds its modules by being there; else the nearest of all tests.
    """
    steps = distances(module)
    near = [name for name in files_by_place(module) if name in steps]
    if not near and DISCOVERED.search(module):
        return files_by_place(module)
    if not near:
        near = [name for name in steps if re.fullmatch(r"tests/(sim|app/scenes)/.*test_\w+\.py", name)]
    return sorted(near, key=lambda name: steps[name])


def files_by_place(module: str) -> list[str]:
    """The tests that lie where a module lies."""
    if module in OTHER_TESTS:
        return [name for name in OTHER_TESTS[module] if (ROOT / name).exists()]
    parts = module.split("/")
    if parts[0] == "app":
        scene = parts[2] if len(parts) > 3 and parts[2] != "springs" else ""
        return sorted(
            path.relative_to(ROOT).as_posix() for path in (ROOT / "tests/app/scenes").glob(f"test_{scene}*.py")
        )
    if len(parts) == 2:
        return [f"tests/sim/test_{parts[1]}"]
    return sorted(
        path.relative_to(ROOT).as_posix() for path in (ROOT / "tests" / parts[0] / parts[1]).glob("test_*.py")
    )


def distances(module: str) -> dict[str, int]:
    """How many imports lead from each source to a module, of those that lead there at all."""
    paths = {module_of(path): path for top in OWN for path in (ROOT / top).rglob("*.py")}
    importers: dict[str, list[str]] = {name: [] for name in paths}
    for name, path in paths.items():
        for other in imports(path):
            if other in importers:
                importers[other].append(name)
    start = module_of(ROOT / module)
    found, waiting = {start: 0}, [start]
    for name in waiting:
        for importer in importers[name]:
            if importer not in found:
                found[importer] = found[name] + 1
                waiting.append(importer)
    return {paths[name].relative_to(ROOT).as_posix(): steps for name, steps in found.items()}


class PlainTests:
    """The tests of a file that are quick as plain Python, found by trying; kept in `work`."""

    def __init__(self, work: Path, tree: Path) -> None:
        self.tree, self.path = tree, work / "plain.json"
        self.files: dict[str, dict[str, float]] = json.loads(self.path.read_text()) if self.path.exists() else {}

    def of(self, name: str) -> dict[str, float]:
        """How long each of them takes [s]."""
        key = f"{name} {hashlib.sha256((self.tree / name).read_bytes()).hexdigest()[:16]}"
        if key not in self.files:
            outcome = run_tests(self.tree, [name], 300.0, plain=True, options=("--timeout", str(PLAIN_TEST)))
            self.files[key] = {test: seconds for test, seconds in outcome.durations.items() if seconds < QUICK}
            self.path.write_text(json.dumps(self.files))
        return self.files[key]


def key_of_fault(listed: Listed) -> tuple[str, ...]:
    fault = listed.fault
    return fault.module, fault.kind, fault.before, str(fault.occurrence), fault.after


def key_of(row: dict[str, str]) -> tuple[str, ...]:
    return tuple(row[name] for name in COLUMNS[:5])


def read_results() -> dict[tuple[str, ...], dict[str, str]]:
    """The results there are, by fault."""
    if not RESULTS.exists():
        return {}
    with RESULTS.open(newline="") as file:
        return {key_of(row): row for row in csv.DictReader(file)}


def write_results(results: dict[tuple[str, ...], dict[str, str]]) -> None:
    """Those of the list, in its order."""
    keys = [key_of_fault(listed) for listed in read_list()]
    with RESULTS.open("w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(results[key] for key in keys if key in results)


class Trials:
    """Tries faults one after the other."""

    def __init__(self, work: Path, *, plain_only: bool) -> None:
        work.mkdir(parents=True, exist_ok=True)
        self.work, self.plain_only = work, plain_only
        self.tree = copy_of_checkout(work)
        link_cache(work)
        self.plain_tests = PlainTests(work, self.tree)

    def try_fault(self, listed: Listed) -> tuple[str, str]:
        """("found", the test that found it), ("not found", ""), or ("gone", "") where the source has no such line."""
        fault = listed.fault
        path = self.tree / fault.module
        sound = path.read_text()
        wrong = fault.planted(sound)
        if wrong is None:
            return "gone", ""
        files = files_for(fault.module)
        # Kernels of springs are in one another, so that compiling them again takes longer than most tests.
        plain = [
            test
            for name in files
            if fault.module.startswith("sim/springs/") and name.startswith("tests/sim/")
            for test, _ in sorted(self.plain_tests.of(name).items(), key=lambda pair: pair[1])
        ]
        known = {folder.name for folder in (self.work / "cache" / "kernels").iterdir()}
        try:
            path.write_text(wrong)
            return self.first_failure(plain, files)
        finally:
            path.write_text(sound)
            forget_new_kernels(self.work, known)

    def first_failure(self, plain: list[str], files: list[str]) -> tuple[str, str]:
        """The result, from tests as plain Python first; what they do not notice is tried compiled, or left open."""
        if plain:
            (self.work / "tests.txt").write_text("\n".join(plain))
            outcome = self.run([f"@{self.work / 'tests.txt'}"], PLAIN_LIMIT, plain=True)
            if outcome.failed and not outcome.crash:
                return "found", outcome.failed
        if self.plain_only:
            return "open", ""
        if not files:
            return "not found", "no test"
        outcome = self.run(files, COMPILED_LIMIT, plain=False)
        if outcome.failed:
            return "found", outcome.failed
        if not outcome.ended:
            return "found", f"no end within {COMPILED_LIMIT:g} s, or a crash"
        return "not found", ""

    def run(self, tests: list[str], seconds: float, *, plain: bool) -> Outcome:
        return run_tests(self.tree, tests, seconds, plain=plain, options=("-x", "--timeout", "60"))


def in_rounds(faults: list[Listed]) -> list[Listed]:
    """The first fault of each module, then the second of each, ..., so that a run that is cut short has tried all."""
    turns: Counter[str] = Counter()
    numbered = []
    for listed in faults:
        numbered.append((turns[listed.fault.module], listed))
        turns[listed.fault.module] += 1
    return [listed for _, listed in sorted(numbered, key=lambda pair: pair[0])]


def run_faults(work: Path, start: str, only: str, seconds: float, *, plain_only: bool) -> None:
    """Try each fault of the list that has no result yet, of modules that begin with `start`.

    only: "": those without a result; "not found": those that no test noticed, again. seconds: after which none begins.
    """
    trials, until = Trials(work, plain_only=plain_only), time.monotonic() + seconds
    results = read_results()
    for listed in in_rounds(read_list()):
        key = key_of_fault(listed)
        before = results[key]["result"] if key in results else ""
        wanted = before == only or (before == "open" and not only)
        if not listed.fault.module.startswith(start) or not wanted or time.monotonic() > until:
            continue
        if listed.equivalent:
            result, by, took = "equivalent", listed.equivalent, 0.0
        else:
            begun = time.monotonic()
            result, by = trials.try_fault(listed)
            took = time.monotonic() - begun
        results[key] = dict(zip(COLUMNS, (*key, result, by, f"{took:.1f}"), strict=True))
        print(f"{result:10} {took:6.1f} s  {listed.fault.module}: {listed.fault.after}  [{by}]", flush=True)
        write_results(results)
