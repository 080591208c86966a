import csv
import re
import subprocess
import sys

import numpy as np
import pytest

from app.__main__ import main
from app.commands.checkout import ELSEWHERE
from app.formats import text_tables
from app.study import tables
from benchmarks import command
from benchmarks.cases.springs import rope


def ladder(order: int, method: str) -> text_tables.Rows:
    return [
        {
            "method": method,
            "force evaluations": 100 * 2**i,
            "least [ms]": 0.1 * 2**i,
            "error [m]": 1e-2 / 2 ** (order * i),
            "reference good to [m]": 1e-12,
        }
        for i in range(5)
    ]


def test_every_case_is_a_benchmark():
    found = command.benchmarks()
    assert {"kernels", "realtime", "rope", "start"} <= set(found)
    assert all(callable(module.rows) for module in found.values())


def test_an_unknown_benchmark_is_refused_with_the_known_ones():
    with pytest.raises(ValueError, match=r"^bench: 'ropes' is not allowed; allowed: one of .*rope"):
        command.run(["ropes"])


def test_an_installed_program_says_in_one_line_where_its_benchmarks_are(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("app.commands.checkout.CHECKOUT", tmp_path)
    for words in (["bench"], ["bench", "rope", "--quick"], ["bench", "--peers", "dop999"]):
        assert main(words) == 2
        assert capsys.readouterr().err == f"springtide: bench: {ELSEWHERE}\n"
    assert main(["hydrodynamics", "--compare"]) == 2
    assert "--compare: works only in a checkout" in capsys.readouterr().err


def test_the_module_is_the_command():
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks", "ropes"], capture_output=True, encoding="locale", check=False
    )
    assert done.returncode == 2
    assert re.match(r"springtide: bench: 'ropes' is not allowed; allowed: one of .*rope", done.stderr)


def test_a_folder_that_cannot_be_made_is_refused(tmp_path):
    (tmp_path / "file").write_text("", "utf-8")
    with pytest.raises(ValueError, match=r"^--out: "):
        command.run(["realtime"], out=tmp_path / "file" / "inner")


def test_a_run_prints_its_table_and_keeps_it(tmp_path, monkeypatch, capsys):
    table = [{"what": "a [b]", "time [ms]": 1.23456, "note": None}, {"what": "c", "extra": 3}]
    monkeypatch.setattr(command.benchmarks()["realtime"], "rows", lambda quick: table)
    assert command.run(["realtime"], quick=True, out=tmp_path) == 0
    shown = capsys.readouterr().out
    assert "time [ms]" in shown
    assert "1.235" in shown
    with (tmp_path / "realtime.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert rows[0] == {"what": "a [b]", "time [ms]": "1.23456", "note": "", "extra": ""}
    assert rows[1]["extra"] == "3"
    assert "numba" in (tmp_path / "machine.txt").read_text("utf-8")


def test_work_precision_figures_have_units_orders_and_both_formats(tmp_path):
    figure = tables.work_precision(ladder(2, "leapfrog") + ladder(4, "rk4"), "Rope")
    left, right = figure.axes
    assert left.get_xlabel().endswith("[ms]")
    assert left.get_ylabel() == "error [m]"
    assert right.get_xlabel() == "force evaluations"
    assert {text.get_text() for text in right.texts} >= {"2", "4"}
    paths = tables.save_figures({"rope": figure}, tmp_path)
    assert [path.name for path in paths] == ["rope.svg", "rope.png"]
    assert all(path.stat().st_size > 1000 for path in paths)


def test_two_methods_agree_on_the_lab_rope():
    assert rope.truth_of(rope.PROBLEMS[0]).uncertainty < 1e-11


def test_leapfrog_needs_a_tenth_of_the_evaluations_of_the_lab_s_euler():
    problem = rope.PROBLEMS[0]
    truth = rope.truth_of(problem)
    table = [
        row for name in ("leapfrog", "symplectic_euler", "rk4") for row in rope.ladder(problem, name, truth, 6000, 1)
    ]
    leapfrog, euler = (
        rope.evaluations_at(table, name, rope.COMPARED_ERROR) for name in ("leapfrog", "symplectic_euler")
    )
    assert euler > 10.0 * leapfrog
    assert np.isnan(rope.evaluations_at(table, "rk4", 1.0))


def test_the_front_is_what_nothing_beats_in_both_time_and_error():
    points = {"quick": (1e-2, 1.0), "exact": (1e-6, 9.0), "between": (1e-4, 3.0), "beaten": (1e-3, 4.0)}
    table = [{"method": name, "error [m]": error, "least [ms]": time} for name, (error, time) in points.items()]
    assert tables.front(table) == ["quick", "exact", "between"]


def test_tables_say_what_is_missing():
    assert text_tables.written(None) == ""
    assert text_tables.written(np.nan) == "-"
    assert text_tables.columns([{"a": 1}, {"b": 2, "a": 3}]) == ["a", "b"]
