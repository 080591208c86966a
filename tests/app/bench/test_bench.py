import csv
import dataclasses

import numpy as np
import pytest

from app.bench import command
from app.bench.cases import rope
from app.bench.own_runs import OwnRuns, largest_distances
from app.bench.peers.ladder import compared, rungs, summary
from app.bench.peers.record import Peer, is_installed
from app.bench.peers.rope import PEERS
from app.bench.tasks import rope as rope_task
from app.experiments import tables
from sim.springs.stability import critical_step
from tests.sim.springs.reference import exact


def ladder(order: int, method: str) -> tables.Rows:
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
    assert {"kernels", "realtime", "rope", "start", "work"} <= set(found)
    assert all(callable(module.rows) for module in found.values())


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
    figure = tables.work_precision(ladder(2, "leapfrog") + ladder(4, "rk4"), "Rope")
    left, right = figure.axes
    assert left.get_xlabel().endswith("[ms]")
    assert left.get_ylabel() == "error [m]"
    assert right.get_xlabel() == "force evaluations"
    assert {text.get_text() for text in right.texts} >= {"2", "4"}
    paths = tables.save_figures({"rope": figure}, tmp_path)
    assert [path.name for path in paths] == ["rope.svg", "rope.png"]
    assert all(path.stat().st_size > 1000 for path in paths)


def test_the_reference_is_as_good_as_it_says():
    net = rope_task.benchmark_rope(16)
    truth = rope_task.reference(net)
    assert truth.uncertainty < 1e-10
    x, _ = exact(net, 1.0)
    assert np.abs(truth.positions[1] - x).max() < 1e-10
    rung = rope_task.fixed_step_run(net, "rk4", 0.1)
    assert largest_distances(rung.run(), truth)[1] == pytest.approx(3.5e-8, rel=0.05)


def test_rungs_end_at_half_a_second_on_the_way():
    net = rope_task.benchmark_rope(16)
    for name in rope_task.FIXED_STEP_METHODS:
        steps = int(rope_task.fixed_step_run(net, name, 0.95).setting.split()[0])
        assert steps % 2 == 0
        assert 1.0 / steps <= 0.95 * critical_step(net, name)


@pytest.mark.parametrize(
    "peer", [peer for peer in PEERS if peer.package in ("numpy", "scipy")], ids=lambda peer: peer.name
)
def test_peers_solve_the_same_rope(peer):
    assert is_installed(peer.package)
    net = dataclasses.replace(rope_task.benchmark_rope(16), damping_model=peer.damping)
    run = peer.make(net, rungs(peer, net, quick=False)[0].value)
    assert max(largest_distances((run(0.5), run(1.0)), rope_task.reference(net))) < 1e-3


def test_a_peer_s_rungs_are_its_tolerances_or_parts_of_a_step():
    net = rope_task.benchmark_rope(16)
    critical = critical_step(net, "leapfrog")
    steps = [rung.value for rung in rungs(Peer("p", "numpy", print), net, quick=False)]
    assert steps == pytest.approx([0.8 * critical, 0.4 * critical, 0.2 * critical, 0.1 * critical])
    own = Peer("p", "numpy", print, step=1e-3)
    assert [rung.value for rung in rungs(own, net, quick=True)] == [1e-3, 0.25e-3]
    adaptive = Peer("p", "numpy", print, tolerances=(1e-4, 1e-6))
    assert [rung.label for rung in rungs(adaptive, net, quick=False)] == ["rtol 1e-04", "rtol 1e-06"]


def test_a_peer_s_ladder_is_compared_at_its_own_errors():
    """A peer that shifts the reference by its step: errors are the steps, and a shift of 10 m counts as diverged."""
    net = rope_task.benchmark_rope(16)
    truth = rope_task.reference(net)
    ours = OwnRuns(rope_task.ladders(net), truth)

    def make(_, setting):
        return lambda t: truth.positions[0 if t == 0.5 else 1] + np.array([setting, 0.0, 0.0])[:, None, None]

    table = compared(Peer("p", "numpy", make, tolerances=(10.0, 1e-3, 1e-6, 0.0)), net, ours, (0.5, 1.0), quick=False)
    assert [row.get("note", "")[:8] for row in table] == ["diverged", "", "", "no run o"]
    for row, error in zip(table[1:3], (1e-3, 1e-6), strict=True):
        assert row["error at 1 s [m]"] == pytest.approx(error)
        assert row["our error at the end [m]"] <= error
        assert row["times as long as ours"] == pytest.approx(row["peer [ms]"] / row["ours [ms]"])
    (found,) = summary([{"task": "R(16)"} | row for row in table])
    ratios = [row["times as long as ours"] for row in table[1:3]]
    assert found["rungs"] == 2
    assert (found["least times as long"], found["greatest times as long"]) == (min(ratios), max(ratios))
    assert found["and an error of [m]"] == pytest.approx((1e-3, 1e-6)[ratios.index(min(ratios))])


def test_our_own_run_at_a_peer_s_error_is_within_it():
    net = rope_task.benchmark_rope(16)
    ours = OwnRuns(rope_task.ladders(net), rope_task.reference(net))
    for limits in ((1e-3, 1e-2), (1e-6, 1e-5), (1e-9, 1e-8)):
        found = ours.quickest(limits)
        assert found is not None
        half, end = largest_distances(found.run(), ours.reference)
        assert half <= limits[0]
        assert end <= limits[1]
    assert ours.quickest((0.0, 0.0)) is None


def test_two_methods_agree_on_the_lab_rope():
    assert rope.truth_of(rope.PROBLEMS[0]).uncertainty < 1e-11


def test_leapfrog_needs_a_tenth_of_the_evaluations_of_the_lab_s_euler():
    problem = rope.PROBLEMS[0]
    truth = rope.truth_of(problem)
    table = [
        row for name in ("leapfrog", "symplectic_euler", "rk4") for row in rope.ladder(problem, name, truth, 3000, 1)
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
    assert tables.written(None) == ""
    assert tables.written(np.nan) == "-"
    assert tables.columns([{"a": 1}, {"b": 2, "a": 3}]) == ["a", "b"]
