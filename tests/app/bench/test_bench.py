import csv
import dataclasses

import numpy as np
import pytest

from app.bench import command
from app.bench.cases import rope
from app.bench.cases.kernels import task_rope
from app.bench.installed import is_installed
from app.bench.peers.rope_peers import PEERS
from app.bench.tasks import rope_task
from app.experiments import tables as report
from sim.springs.stability import critical_step
from tests.sim.springs.reference import exact


def ladder(order: int, method: str) -> report.Rows:
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


def test_every_module_with_rows_is_a_benchmark():
    found = command.benchmarks()
    assert {"kernels", "realtime", "rope", "start"} <= set(found)
    assert "report" not in found


def test_an_unknown_benchmark_is_refused_with_the_known_ones():
    with pytest.raises(ValueError, match=r"^bench: 'ropes' is not allowed; allowed: one of .*rope"):
        command.run(["ropes"])


def test_a_folder_that_cannot_be_made_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
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
    assert "numba" in (tmp_path / "machine.txt").read_text()


def test_work_precision_figures_have_units_orders_and_both_formats(tmp_path):
    figure = report.work_precision(ladder(2, "leapfrog") + ladder(4, "rk4"), "Rope")
    left, right = figure.axes
    assert left.get_xlabel().endswith("[ms]")
    assert left.get_ylabel() == "error [m]"
    assert right.get_xlabel() == "force evaluations"
    assert {text.get_text() for text in right.texts} >= {"2", "4"}
    paths = report.save_figures({"rope": figure}, tmp_path)
    assert [path.name for path in paths] == ["rope.svg", "rope.png"]
    assert all(path.stat().st_size > 1000 for path in paths)


def test_the_reference_is_as_good_as_it_says():
    net = task_rope(16)
    truth = rope_task.reference(net)
    assert truth.uncertainty < 1e-10
    x, _ = exact(net, 1.0)
    assert np.abs(truth.end - x).max() < 1e-10
    rung = rope_task.rung(net, "rk4", 0.1)
    assert rope_task.errors(*rung.run(), truth)[1] == pytest.approx(3.5e-8, rel=0.05)


def test_rungs_end_at_half_a_second_on_the_way():
    for name in rope_task.METHODS:
        ours = rope_task.rung(task_rope(16), name, 0.95)
        assert ours.steps % 2 == 0
        assert 1.0 / ours.steps <= 0.95 * critical_step(ours.net, name)


@pytest.mark.parametrize(
    "peer", [peer for peer in PEERS if peer.package in ("numpy", "scipy")], ids=lambda peer: peer.name
)
def test_peers_solve_the_same_rope(peer):
    assert is_installed(peer.package)
    net = dataclasses.replace(task_rope(16), damping_model=peer.model)
    run = peer.make(net, 0.8 * critical_step(net, "leapfrog"))
    at_half, at_end = rope_task.errors(run(0.5), run(1.0), rope_task.reference(net))
    assert max(at_half, at_end) < 1e-3


def test_our_own_run_at_a_peer_s_error_is_within_it():
    net = task_rope(16)
    tried = rope_task.Tried(net, rope_task.reference(net))
    for limit in ((1e-3, 1e-2), (1e-6, 1e-5), (1e-9, 1e-8)):
        found = tried.cheapest(limit)
        assert found is not None
        half, end = rope_task.errors(*found.run(), tried.truth)
        assert half <= limit[0]
        assert end <= limit[1]
    assert tried.cheapest((0.0, 0.0)) is None


def test_two_methods_agree_on_the_lab_rope():
    assert rope.truth_of(rope.PROBLEMS[0]).uncertainty < 1e-11


def test_leapfrog_needs_a_tenth_of_the_evaluations_of_the_lab_s_euler():
    problem = rope.PROBLEMS[0]
    truth = rope.truth_of(problem)
    table = [
        row for name in ("leapfrog", "symplectic_euler", "rk4") for row in rope.ladder(problem, name, truth, 3000, 1)
    ]
    leapfrog, euler = (rope.evaluations_at(table, name, rope.LEVEL) for name in ("leapfrog", "symplectic_euler"))
    assert euler > 10.0 * leapfrog
    assert np.isnan(rope.evaluations_at(table, "rk4", 1.0))


def test_the_front_is_what_nothing_beats_in_both_time_and_error():
    points = {"quick": (1e-2, 1.0), "exact": (1e-6, 9.0), "between": (1e-4, 3.0), "beaten": (1e-3, 4.0)}
    table = [{"method": name, "error [m]": error, "least [ms]": time} for name, (error, time) in points.items()]
    assert report.front(table) == ["quick", "exact", "between"]


def test_tables_say_what_is_missing():
    assert report.written(None) == ""
    assert report.written(np.nan) == "-"
    assert report.columns([{"a": 1}, {"b": 2, "a": 3}]) == ["a", "b"]
