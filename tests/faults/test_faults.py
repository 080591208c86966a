"""The list of faults to plant: that it is one, and that each kind of fault is what it says."""

import contextlib
import math
from collections import Counter
from types import SimpleNamespace

import pytest

from tests.faults import running, table
from tests.faults.calls import reached, read_source
from tests.faults.choosing import Part, Trial, files_for
from tests.faults.drawing import LINES_PER_FAULT, ROOT, Listed, drawn, modules, read_list
from tests.faults.running import key_of_fault
from tests.faults.sites import Fault, faults_in
from tests.faults.trial import MISSING, Outcome

CASES = {
    "y = 2.0 * x": {("constant", "y = 2.2 * x"), ("operator", "y = 2.0 / x")}, "y = a + b": {("sign", "y = a - b")},
    "y = -a": {("sign", "y = a")}, "y -= a": {("sign", "y += a")}, "y = x**2": {("exponent", "y = x**3")},
    "y = x[1]": {("index", "y = x[0]")}, "y = x[0, i]": {("index", "y = x[1, i]"), ("constant", "y = x[1, i]")},
    "y = a < b": {("comparison", "y = a > b")}, "y = math.sin(a)": {("function", "y = math.cos(a)")},
    "y = max(a, b)": {("function", "y = min(a, b)")}, "y = a and b": {("logic", "y = a or b")},
    "y = not a": {("logic", "y = a")}, "y = a or b": {("logic", "y = a and b")},
    "y = a is None": {("comparison", "y = a is not None")}, "y = a not in b": {("comparison", "y = a in b")},
    "y = a == b": {("comparison", "y = a != b")}, "y = f(a, on=True)": {("flag", "y = f(a, on=False)")},
    "y = zip(a, b, strict=True)": set(), "y = f(a, b)": {("arguments", "y = f(b, a)")},
    "y: tuple[float, ...] = f(1e-300)": set(), 'raise argument_error("y", 2, "3 to 4")': set(),
    'y = f"{a:.3f}" + "2"': set(),
}  # fmt: skip


@pytest.mark.parametrize("line", CASES)
def test_a_line_has_the_faults_of_its_kinds(line):
    assert {(fault.kind, fault.after) for fault in faults_in("m.py", line)} == CASES[line]


def test_a_fault_is_planted_into_the_line_it_was_found_in_and_into_no_other():
    source = "def f(x):\n    y = x + 1\n    y = x + 1\n    return y"
    fault = Fault("m.py", "sign", "y = x + 1", 1, "y = x - 1")
    assert fault in faults_in("m.py", source)
    assert fault.planted(source) == "def f(x):\n    y = x + 1\n    y = x - 1\n    return y"
    assert fault._replace(occurrence=2).planted(source) is None


def test_there_are_eight_hundred_faults_in_proportion_to_the_lines_of_each_package():
    faults = [listed.fault for listed in read_list()]
    assert len(set(faults)) == len(faults) >= 800
    of_each = Counter("/".join(fault.module.split("/")[:2]) for fault in faults)
    lines, number = Counter[str](), Counter[str]()
    for module in modules():
        package = "/".join(module.split("/")[:2])
        lines[package] += (ROOT / module).read_text("utf-8").count("\n")
        number[package] += 1
    assert {fault.module for fault in faults} <= set(modules())
    for package, count in lines.items():
        # By chance a module has one more or one less: three standard deviations. Some hold nothing to be made wrong.
        chance = max(6.0, 1.5 * math.sqrt(number[package]))
        assert of_each[package] == pytest.approx(count / LINES_PER_FAULT, rel=0.0, abs=chance), package


def test_a_list_is_drawn_alike_and_keeps_what_it_has():
    module = "sim/springs/rope.py"
    source = (ROOT / module).read_text("utf-8")
    first = drawn(module, source, [])
    assert first == drawn(module, source, [])
    kept = [Listed(fault, "why") for fault in faults_in(module, source)[:2]]
    assert drawn(module, source, kept)[:2] == kept
    gone = Listed(Fault(module, "sign", "a line that is no longer there", 0, "another"), "")
    assert gone not in drawn(module, source, [gone])


KERNELS = """
GRAVITY = 9.81

@kernel(inline=True)
def weight(m):
    return m * GRAVITY

@kernel
def total(m):
    return weight(m[0])

class Net:
    scale: float = 2.0

    def heavy(self):
        return total(self.m)

def other(x):
    def inner(y):
        return y + 1
    return inner(x)

@each_link("sum")
def stretched(link, x, p):
    return link.rest + 1

never = kernel(lambda p: 0 > 1, inline=True)
"""


def test_a_line_is_reached_by_what_calls_it_and_a_kernel_by_what_mentions_it(tmp_path):
    (tmp_path / "m.py").write_text(KERNELS, "utf-8")
    sources = {"m.py": read_source(tmp_path / "m.py", "m.py")}
    line_of = {text: number for number, text in enumerate(KERNELS.split("\n"), 1)}
    kernels = {"m.py:weight", "m.py:total", "m.py:Net.heavy"}
    assert reached("m.py", line_of["GRAVITY = 9.81"], sources) == (kernels, True)
    assert reached("m.py", line_of["    return m * GRAVITY"], sources) == (kernels, True)
    assert reached("m.py", line_of["        return total(self.m)"], sources) == ({"m.py:Net.heavy"}, False)
    assert reached("m.py", line_of["        return y + 1"], sources) == ({"m.py:other.<locals>.inner"}, False)
    assert reached("m.py", line_of["    scale: float = 2.0"], sources) == (set(), False)
    assert reached("m.py", line_of["    return link.rest + 1"], sources) == ({"m.py:stretched"}, True)
    assert reached("m.py", line_of["never = kernel(lambda p: 0 > 1, inline=True)"], sources) == (set(), True)


def test_a_file_of_tests_lies_where_its_module_lies():
    for module, name in {
        "sim/springs/forces/under_water/water.py": "tests/sim/springs/",
        "app/scenes/mooring/readings/report.py": "tests/app/scenes/mooring/",
        "app/server/loop/sim_loop.py": "tests/app/server/",
        "sim/validation.py": "tests/sim/test_validation.py",
    }.items():
        files = files_for(module)
        assert files, module
        assert all(file.startswith(name) for file in files), (module, files)
    assert all(files_for(module) for module in {listed.fault.module for listed in read_list()})


def test_untried_and_open_faults_count_as_not_found(monkeypatch, capsys):
    listed = [one for one in read_list() if not one.equivalent][:4]
    rows = {
        key_of_fault(one): {"result": result}
        for one, result in zip(listed, ("found", "not found", "open"), strict=False)
    }
    monkeypatch.setattr(table, "read_list", lambda: listed)
    monkeypatch.setattr(table, "read_results", lambda: rows)
    table.print_table()
    assert capsys.readouterr().out.splitlines()[-1] == "| all | 1 | 0 | 1 | 1 | 1 | 0 | 25 % |"


def test_what_was_found_is_found_again_by_its_own_test_or_is_left(monkeypatch, tmp_path):
    faults = [one for one in read_list() if not one.equivalent][:5]
    finders = ("quick", "gone", "long", "blind", "slow")
    rows = {key_of_fault(one): {"by": by} for one, by in zip(faults, finders, strict=True)}
    outcomes = {"quick": ("found", "quick"), "blind": ("not found", ""), "slow": ("found", "long")}
    tried, written = [], []

    def try_one(trial):
        [part] = trial.parts
        tried.extend(part.tests)
        return trial.listed, *outcomes[part.tests[0]], 1.0

    monkeypatch.setattr(running, "names_of_tests", lambda marks: {"quick", "blind", "slow"})
    monkeypatch.setattr(running, "read_results", lambda: rows)
    monkeypatch.setattr(running, "try_one", try_one)
    monkeypatch.setattr(running, "write_result", lambda *row: written.append(row))
    monkeypatch.setattr(running, "processes", lambda *_: contextlib.nullcontext(SimpleNamespace(imap_unordered=map)))
    left = running.not_found_again(tmp_path, faults, {"long"}, workers=1, limit=1.0)
    assert tried == ["quick", "blind", "slow"]
    assert written == [(faults[0], "found", "quick", 1.0)]
    assert sorted(left) == sorted(faults[1:])


def test_a_case_that_has_another_name_by_a_fault_has_not_found_it(monkeypatch, tmp_path):
    fault = Fault("m.py", "sign", "y = x + 1", 0, "y = x - 1")
    (tmp_path / "m.py").write_text("y = x + 1\n", "utf-8")
    worker = object.__new__(running.Worker)
    worker.tree = worker.sound = worker.cache = tmp_path
    worker.limit = 10.0
    asked = []

    def run(tests, seconds, mode, timeout):
        assert "x - 1" in (tmp_path / "m.py").read_text("utf-8")
        asked.append(tests)
        return Outcome({}, MISSING if len(asked) == 1 else "", False, True)

    monkeypatch.setattr(worker, "run", run)
    trial = Trial(Listed(fault, ""), [Part(False, ["t.py::a[1]", "t.py::b", "s.py::c"], 0.0)], True)
    assert worker.try_fault(trial) == ("not found", "")
    assert asked == [["t.py::a[1]", "t.py::b", "s.py::c"], ["t.py", "s.py"]]
    assert (tmp_path / "m.py").read_text("utf-8") == "y = x + 1\n"
