"""The list of faults to plant: that it is one, and that each kind of fault is what it says."""

from collections import Counter

import pytest

from tests.faults import table
from tests.faults.drawing import modules, read_list
from tests.faults.running import key_of_fault
from tests.faults.sites import Fault, faults_in

CASES = {
    "y = 2.0 * x": {("constant", "y = 2.2 * x"), ("operator", "y = 2.0 / x")}, "y = a + b": {("sign", "y = a - b")},
    "y = -a": {("sign", "y = a")}, "y -= a": {("sign", "y += a")}, "y = x**2": {("exponent", "y = x**3")},
    "y = x[1]": {("index", "y = x[0]")}, "y = x[0, i]": {("index", "y = x[1, i]"), ("constant", "y = x[1, i]")},
    "y = a < b": {("comparison", "y = a > b")}, "y = math.sin(a)": {("function", "y = math.cos(a)")},
    "y = max(a, b)": {("function", "y = min(a, b)")}, "y = f(a, b)": {("arguments", "y = f(b, a)")},
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


def test_there_are_three_hundred_faults_in_all_of_sim_and_the_reports():
    faults = [listed.fault for listed in read_list()]
    assert len(set(faults)) == len(faults) >= 300
    of_each = Counter(fault.module for fault in faults)
    assert set(of_each) <= set(modules())
    assert len(of_each) > 0.8 * len(modules())
    assert max(of_each.values()) < 10


def test_untried_and_open_faults_count_as_not_found(monkeypatch, capsys):
    listed = [one for one in read_list() if not one.equivalent][:4]
    rows = {
        key_of_fault(one): {"result": result}
        for one, result in zip(listed, ("found", "not found", "open"), strict=False)
    }
    monkeypatch.setattr(table, "read_list", lambda: listed)
    monkeypatch.setattr(table, "read_results", lambda: rows)
    table.print_table()
    assert capsys.readouterr().out.splitlines()[-1] == "| all | 1 | 1 | 1 | 1 | 0 | 25 % |"
