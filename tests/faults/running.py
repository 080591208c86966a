"""Each fault of the list, in a copy of the checkout, against the tests that concern its module."""

import csv
import functools
import hashlib
import json
import os
import re
import shutil
import subprocess
import time
from collections import Counter
from pathlib import Path
from typing import Any

from tests.faults.calls import function_at, is_kernel
from tests.faults.drawing import ROOT, Listed, read_list
from tests.faults.trial import OWN, Mode, Outcome, run_tests
from tests.test_layers import imports, module_of

RESULTS = ROOT / "assets" / "bench" / "faults.csv"
COLUMNS = ("module", "kind", "before", "occurrence", "after", "result", "by", "seconds")
PLAIN_LIMIT, COMPILED_LIMIT = 60.0, 300.0  # [s] for all tests of a fault
PLAIN_TEST = 2.0  # [s] that a test may take as plain Python
DISCOVERED = re.compile(r"^sim/(ocean/spectra|springs/integrators|floating/shapes)/\w+\.py$")
OTHER_TESTS = {  # of modules with tests of other names
    "sim/validation.py": (
        "tests/sim/test_validation.py",
        "tests/sim/springs/test_net.py",
        "tests/sim/springs/test_refusals.py",
        "tests/sim/ocean/test_refusals.py",
    )
}


def copy_of_checkout(work: Path, name: str) -> Path:
    """A fresh copy of the sources and what tests read, below `work`."""
    tree = work / name
    shutil.rmtree(tree, ignore_errors=True)
    listed = subprocess.run(
        ["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.split("\n")
    for path in filter(None, listed):
        if (ROOT / path).is_file():
            (tree / path).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / path, tree / path)
    return tree


def link_cache(work: Path) -> None:
    """The compiled kernels, as links, so that what a fault compiles is not kept beside them."""
    cache, own = Path(os.environ.get("SPRINGTIDE_CACHE", "none")) / "kernels", work / "cache" / "kernels"
    own.mkdir(parents=True, exist_ok=True)
    for folder in cache.glob("*/*"):
        target = own / folder.relative_to(cache)
        if folder.is_dir() and not target.exists():
            shutil.copytree(folder, target, copy_function=os.link)


def forget_new_kernels(work: Path, known: set[str]) -> None:
    for folder in (work / "cache" / "kernels").glob("*/*"):
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
    if parts[:2] == ["app", "formats"]:
        return [f"tests/app/formats/test_{parts[2]}"]
    if parts[0] == "app":
        scene = parts[2] if len(parts) > 3 and parts[2] != "springs" else ""
        sweep = ROOT / "tests/app/sweep/test_case.py"  # it reads the measures of all scenes
        return sorted(
            path.relative_to(ROOT).as_posix()
            for path in [*(ROOT / "tests/app/scenes").glob(f"test_{scene}*.py"), sweep]
        )
    if len(parts) == 2:
        return [f"tests/sim/test_{parts[1]}"]
    others = [ROOT / "tests/app/commands/test_hydrodynamics.py"] if parts[1] == "floating" else []
    paths = [*(ROOT / "tests" / parts[0] / parts[1]).glob("test_*.py"), *others]
    return sorted(path.relative_to(ROOT).as_posix() for path in paths)


@functools.cache
def import_graph() -> tuple[dict[str, Path], dict[str, list[str]]]:
    """The sources by the names of their modules, and which modules import each."""
    paths = {module_of(path): path for top in OWN for path in (ROOT / top).rglob("*.py")}
    importers: dict[str, list[str]] = {name: [] for name in paths}
    for name, path in paths.items():
        for other in imports(path):
            if other in importers:
                importers[other].append(name)
    return paths, importers


def distances(module: str) -> dict[str, int]:
    """How many imports lead from each source to a module, of those that lead there at all."""
    paths, importers = import_graph()
    start = module_of(ROOT / module)
    found, waiting = {start: 0}, [start]
    for name in waiting:
        for importer in importers[name]:
            if importer not in found:
                found[importer] = found[name] + 1
                waiting.append(importer)
    return {paths[name].relative_to(ROOT).as_posix(): steps for name, steps in found.items()}


class CallingTests:
    """Which tests reach a function, found by running them once; kept in `work`."""

    def __init__(self, work: Path, tree: Path) -> None:
        self.tree, self.path = tree, work / "calls.json"
        self.files: dict[str, dict[str, Any]] = json.loads(self.path.read_text()) if self.path.exists() else {}

    def of(self, files: list[str], module: str, first: int | None, *, plain: bool) -> list[str]:
        """Those in `files` that call the function at line `first` of a module, the quick ones first."""
        found = []
        for name in files:
            known = self.known(name, plain=plain)
            found += [
                (seconds, test)
                for test, seconds in known["durations"].items()
                if first is None or f"{module}:{first}" in known["calls"].get(test, ())
            ]
        return [test for _, test in sorted(found)]

    def known(self, name: str, *, plain: bool) -> dict[str, Any]:
        """How long each test of a file takes [s], and what it calls."""
        key = f"{'plain' if plain else 'compiled'} {name} {file_hash(self.tree / name)}"
        if key not in self.files:
            mode = Mode(plain, until_failure=False, with_calls=True)
            seconds = PLAIN_TEST if plain else COMPILED_LIMIT
            outcome = run_tests(self.tree, [name], 4 * COMPILED_LIMIT, mode, seconds)
            print(f"({'plain' if plain else 'compiled'}: {len(outcome.durations)} tests of {name})", flush=True)
            self.files[key] = {"durations": outcome.durations, "calls": outcome.calls}
            self.path.write_text(json.dumps(self.files))
        return self.files[key]


def file_hash(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()[:16]


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
        writer: csv.DictWriter[str] = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(results[key] for key in keys if key in results)


class Trials:
    """Tries faults one after the other."""

    def __init__(self, work: Path, *, plain_only: bool) -> None:
        work.mkdir(parents=True, exist_ok=True)
        self.work, self.plain_only = work, plain_only
        self.tree = copy_of_checkout(work, "tree")
        self.sound = copy_of_checkout(work, "sound")
        link_cache(work)
        self.calling = CallingTests(work, self.tree)

    def try_fault(self, listed: Listed) -> tuple[str, str]:
        """("found", the test that found it), ("not found", ""), ("open", why), or ("gone", "") without such a line."""
        fault = listed.fault
        path = self.tree / fault.module
        sound = path.read_text()
        line, wrong = fault.line(sound), fault.planted(sound)
        if line is None or wrong is None:
            return "gone", ""
        files, first = files_for(fault.module), function_at(sound, line + 1)
        # Only a fault in a function that is not compiled itself leaves all compiled kernels as they are.
        same_kernels = first is not None and not is_kernel(sound, first)
        # Kernels of springs and bodies are in one another, so that compiling them again takes longer than most tests.
        in_kernels = fault.module.startswith(("sim/springs/", "sim/floating/"))
        near = [name for name in files if name.startswith("tests/sim/")]
        plain = self.calling.of(near, fault.module, first, plain=True) if in_kernels else []
        reaching = self.calling.of(files, fault.module, first, plain=False) if same_kernels else []
        if reaching and not self.plain_only:
            plain = []
        known = {folder.name for folder in (self.work / "cache" / "kernels").glob("*/*")}
        try:
            path.write_text(wrong)
            return self.first_failure(plain, reaching, files, same_kernels=same_kernels)
        finally:
            path.write_text(sound)
            forget_new_kernels(self.work, known)

    def first_failure(
        self, plain: list[str], reaching: list[str], files: list[str], *, same_kernels: bool
    ) -> tuple[str, str]:
        """The result, from tests as plain Python first; what they do not notice is tried compiled, or left open."""
        if plain:
            outcome = self.run(plain, PLAIN_LIMIT, Mode(plain=True))
            if outcome.failed and not outcome.crash:
                return "found", outcome.failed
        if self.plain_only:
            return "open", ""
        if not files:
            return "not found", "no test"
        outcome = self.run(reaching or files, COMPILED_LIMIT, Mode(False, self.sound if same_kernels else None))
        if outcome.failed:
            return "found", outcome.failed
        return ("not found", "") if outcome.ended else ("open", f"no end within {COMPILED_LIMIT:g} s")

    def run(self, tests: list[str], seconds: float, mode: Mode) -> Outcome:
        (self.work / "tests.txt").write_text("\n".join(tests))
        return run_tests(self.tree, [f"@{self.work / 'tests.txt'}"], seconds, mode, seconds)


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
        results = read_results()  # another run may have written since
        results[key] = dict(zip(COLUMNS, (*key, result, by, f"{took:.1f}"), strict=True))
        print(f"{result:10} {took:6.1f} s  {listed.fault.module}: {listed.fault.after}  [{by}]", flush=True)
        write_results(results)
