"""The tests to try a fault against: those that reach its line, quick ones first."""

import functools
import hashlib
import json
import math
import re
from collections import Counter
from pathlib import Path
from typing import Any, NamedTuple

from sim.files import replacing
from tests.faults.calls import reached, read_source
from tests.faults.drawing import ROOT, Listed, modules
from tests.faults.trial import OWN, Outcome
from tests.repository.test_layers import imports, module_of

# Their kernels are in one another, so that compiling them again takes longer than most tests.
PLAIN = ("sim/springs/", "sim/floating/", "sim/mooring/")
FIRST_TESTS, FIRST_FILES, FIRST_SECONDS = 40, 6, 8.0  # of a first run, as it finds most faults
NEXT_SECONDS = 60.0  # that the other tests took without a fault
OTHER_SECONDS = 10.0  # that tests took that are not seen to reach the line
# So many times as expensive is a test that is less likely to look at the result: one whose file does not import the
# module itself where others do, and one that lies elsewhere.
INDIRECT, FAR = 2.0, 5.0
START = 0.05  # [s] of a test that takes no time


class Part(NamedTuple):
    """Tests that are run together."""

    plain: bool  # with kernels as plain Python
    tests: list[str]
    longest: float  # [s] of one of them without a fault


class Trial(NamedTuple):
    """A fault, and the tests to try it against, in turn."""

    listed: Listed
    parts: list[Part]
    same_kernels: bool  # whether the fault leaves all compiled kernels as they are


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


@functools.cache
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


def files_by_place(module: str) -> list[str]:
    """The tests that lie where a module lies: of its folder, or of the nearest folder around it that has tests."""
    folder = Path(module).parent
    named = ROOT / "tests" / folder / f"test_{Path(module).name}"
    if len(folder.parts) == 1:
        paths = [named] if named.exists() else []
    else:
        while not (paths := list((ROOT / "tests" / folder).glob("**/test_*.py"))) and len(folder.parts) > 2:
            folder = folder.parent
    return sorted(path.relative_to(ROOT).as_posix() for path in paths)


def files_for(module: str) -> list[str]:
    """The files of tests of a module, the nearest by imports first: of those that lie where it lies, or else of all.

    All that lie there, where no import leads to it: its package finds its modules by their being there.
    """
    steps = distances(module)
    placed = files_by_place(module)
    near = [name for name in placed if name in steps] or placed
    if not near:
        near = [name for name in steps if re.fullmatch(r"tests/(sim|app)/.*test_\w+\.py", name)]
    return sorted(near, key=lambda name: steps.get(name, 0))


def all_files() -> list[str]:
    """All files of tests, but those that need a browser or hours."""
    paths = sorted((ROOT / "tests").rglob("test_*.py"))
    names = [path.relative_to(ROOT).as_posix() for path in paths]
    return [name for name in names if not name.startswith(("tests/stress/", "tests/browser/"))]


@functools.cache
def digest(name: str) -> str:
    """Hash of a file of tests and of the sources that it may run: for one of the library, those that it imports."""
    in_library = name.startswith("tests/sim/")
    sources = [module for module in modules() if not in_library or name in distances(module)]
    return hashlib.sha256(b"".join((ROOT / path).read_bytes() for path in (name, *sources))).hexdigest()[:16]


class Records:
    """How long each test takes, and what it calls, from one run of each file without a fault; kept in `work`.

    A file is run again where its text or a source that it may run is another. This compiles all kernels, too.
    """

    def __init__(self, work: Path) -> None:
        self.path = work / "calls.json"
        self.files: dict[str, dict[str, Any]] = json.loads(self.path.read_text("utf-8")) if self.path.exists() else {}

    def key(self, name: str, plain: bool) -> str:
        return f"{'plain' if plain else 'compiled'} {name} {digest(name)}"

    def missing(self) -> list[tuple[str, bool]]:
        """The files to run, and whether as plain Python."""
        names = all_files()
        jobs = [(name, False) for name in names]
        jobs += [(name, True) for name in names if name.removeprefix("tests/").startswith(PLAIN)]
        return [job for job in jobs if self.key(*job) not in self.files]

    def keep(self, name: str, plain: bool, outcome: Outcome) -> None:
        self.files[self.key(name, plain)] = {"durations": outcome.durations, "calls": outcome.calls}
        with replacing(self.path) as draft:
            draft.write_text(json.dumps(self.files), "utf-8")

    @functools.cached_property
    def by_function(self) -> dict[bool, dict[str, list[str]]]:
        """The tests that call each function, as plain Python and compiled."""
        found: dict[bool, dict[str, list[str]]] = {False: {}, True: {}}
        for name, plain in self.known():
            for test, called in self.files[self.key(name, plain)]["calls"].items():
                for function in called:
                    found[plain].setdefault(function, []).append(test)
        return found

    def known(self) -> list[tuple[str, bool]]:
        return [(name, plain) for name in all_files() for plain in (False, True) if self.key(name, plain) in self.files]

    def durations(self, name: str, *, plain: bool) -> dict[str, float]:
        """Time of each test of a file that passes [s]."""
        return self.files.get(self.key(name, plain), {"durations": {}})["durations"]

    def trial(self, listed: Listed, path: Path) -> Trial | None:
        """The tests for a fault in the source at `path`; None without its line."""
        module = listed.fault.module
        around = reached_from(listed, path)
        if around is None:
            return None
        functions, with_kernels = around
        near = files_for(module)

        def calling(*, plain: bool) -> list[str]:
            tests = {test for function in functions for test in self.by_function[plain].get(function, ())}
            return self.quick_first(tests, module, near, plain=plain)

        plain = calling(plain=True) if with_kernels and module.startswith(PLAIN) else []
        compiled = calling(plain=False)
        # What runs in another process is not seen to be called.
        nearby = {test for name in near for test in self.durations(name, plain=False)} - set(compiled)
        others = self.quick_first(nearby, module, near, plain=False)
        parts = [*self.parts(plain, [], plain=True), *self.parts(compiled, others, plain=False)]
        return Trial(listed, [part for part in parts if part.tests], not with_kernels)

    def quick_first(self, tests: set[str], module: str, near: list[str], *, plain: bool) -> list[str]:
        """Tests in the order in which to try them: those that look at the module, and a few of each name, first."""
        costs: dict[str, float] = {}
        same: Counter[str] = Counter()
        direct = {name for name in near if distances(module).get(name) == 1} or set(near)
        times = {test: self.time(test, plain=plain) for test in tests}
        for test in sorted(times, key=lambda test: (times[test], test)):
            name, _, case = test.partition("[")
            costs[test] = (times[test] + START) * (1 + same[name] / 4)
            file = test.partition("::")[0]
            costs[test] *= 1.0 if file in direct else INDIRECT if file in near else FAR
            costs[test] /= FAR if Path(module).stem in case else 1.0
            same[name] += 1
        return sorted((test for test in costs if costs[test] < math.inf), key=costs.__getitem__)

    def time(self, test: str, *, plain: bool) -> float:
        """Time of a test without a fault [s]; infinite where it did not pass."""
        return self.durations(test.partition("::")[0], plain=plain).get(test, math.inf)

    def parts(self, tests: list[str], others: list[str], *, plain: bool) -> list[Part]:
        """A few quick tests, and the rest up to NEXT_SECONDS, each by files, as these share their fixtures.

        others: tests that are less likely to notice; up to OTHER_SECONDS, where there are any `tests`.
        """
        first: list[str] = []
        rest: list[str] = []
        files: set[str] = set()
        spent = 0.0
        for test in tests or others:
            files.add(test.partition("::")[0])
            spent += self.time(test, plain=plain)
            few = len(first) < FIRST_TESTS and len(files) <= FIRST_FILES and spent < FIRST_SECONDS
            if not first or (few and not rest):
                first.append(test)
            elif spent < NEXT_SECONDS:
                rest.append(test)
        spent = 0.0
        for test in others if tests else []:
            spent += self.time(test, plain=plain)
            if spent < OTHER_SECONDS:
                rest.append(test)
        parts = [by_files(part) for part in (first, rest)]
        return [Part(plain, part, max((self.time(test, plain=plain) for test in part), default=0.0)) for part in parts]


def reached_from(listed: Listed, path: Path) -> tuple[set[str], bool] | None:
    """Tests that reach a fault's line in the source at `path`, as `reached` returns them; None without its line."""
    module = listed.fault.module
    line = listed.fault.line(path.read_text("utf-8"))
    if line is None:
        return None
    own = [name for name in distances(module) if name.startswith(("app/", "sim/"))]
    return reached(module, line + 1, {name: read_source(ROOT / name, name) for name in own})


def trial_of_finder(listed: Listed, path: Path, finder: str) -> Trial | None:
    """The test that found a fault, alone, compiled, as all tests run without being told otherwise."""
    around = reached_from(listed, path)
    return None if around is None else Trial(listed, [Part(False, [finder], 0.0)], not around[1])


def by_files(tests: list[str]) -> list[str]:
    """Tests in the order of the first one of their files."""
    order = list(dict.fromkeys(test.partition("::")[0] for test in tests))
    return sorted(tests, key=lambda test: order.index(test.partition("::")[0]))
