import csv
import dataclasses
import sys
import time

import numpy as np
import pytest

from app.study import tables
from benchmarks import command
from benchmarks.cases.springs import rope as rope_case
from benchmarks.peers import ladder as peer_ladder
from benchmarks.peers.ladder import Task, compared, rungs, summary, undisturbed_time
from benchmarks.peers.own_runs import OwnRun, OwnRuns, Result
from benchmarks.peers.record import Peer, is_installed
from benchmarks.peers.rope import PEERS
from benchmarks.peers.sea import PRECISIONS, student
from benchmarks.reference import Reference, largest_distances
from benchmarks.tasks import rope, sea
from sim.springs.stability import critical_step
from tests.sim.springs.reference import exact


def test_the_reference_is_as_good_as_it_says():
    net = rope.benchmark_rope(16)
    truth = rope.reference(net)
    assert truth.uncertainty < 1e-10
    x, _ = exact(net, 1.0)
    assert np.abs(truth.positions[1] - x).max() < 1e-10
    rung = rope.fixed_step_run(net, "rk4", 0.1)
    assert largest_distances(rung.run(), truth)[1] == pytest.approx(3.5e-8, rel=0.05)


def test_rungs_end_at_half_a_second_on_the_way():
    net = rope.benchmark_rope(16)
    for name in rope.FIXED_STEP_METHODS:
        steps = int(rope.fixed_step_run(net, name, 0.95).setting.split()[0])
        assert steps % 2 == 0
        assert 1.0 / steps <= 0.95 * critical_step(net, name)


@pytest.mark.parametrize(
    "peer", [peer for peer in PEERS if peer.package in ("numpy", "scipy")], ids=lambda peer: peer.name
)
def test_peers_solve_the_same_rope(peer):
    assert is_installed(peer.package)
    net = dataclasses.replace(rope.benchmark_rope(16), damping_model=peer.damping)
    run = peer.make(net, rungs(peer, net, quick=False)[0].value)
    assert max(largest_distances((run(0.5), run(1.0)), rope.reference(net))) < 1e-3


def test_a_peer_s_rungs_are_its_tolerances_or_parts_of_a_step():
    net = rope.benchmark_rope(16)
    critical = critical_step(net, "leapfrog")
    steps = [rung.value for rung in rungs(Peer("p", "numpy", print), net, quick=False)]
    assert steps == pytest.approx([0.8 * critical, 0.4 * critical, 0.2 * critical, 0.1 * critical])
    own = Peer("p", "numpy", print, step=1e-3)
    assert [rung.value for rung in rungs(own, net, quick=True)] == [1e-3, 0.25e-3]
    adaptive = Peer("p", "numpy", print, tolerances=(1e-4, 1e-6))
    assert [rung.label for rung in rungs(adaptive, net, quick=False)] == ["rtol 1e-04", "rtol 1e-06"]


def test_a_peer_s_ladder_is_compared_at_its_own_errors():
    """A peer that shifts the reference by its step: errors are the steps, and a shift of 10 m counts as diverged."""
    net = rope.benchmark_rope(16)
    truth = rope.reference(net)
    ours = OwnRuns(rope.ladders(net), truth)

    def make(_, setting):
        return lambda t: truth.positions[0 if t == 0.5 else 1] + np.array([setting, 0.0, 0.0])[:, None, None]

    table = compared(
        Peer("p", "numpy", make, tolerances=(10.0, 1e-3, 1e-6, 0.0)), Task(net, (0.5, 1.0), ours), quick=False
    )
    assert [row.get("note", "")[:8] for row in table] == ["diverged", "", "", "beyond w"]
    for row, error in zip(table[1:3], (1e-3, 1e-6), strict=True):
        assert row["error at 1 s [m]"] == pytest.approx(error)
        assert row["our error at the end [m]"] <= error
        assert row["times as long as ours"] == pytest.approx(row["peer [ms]"] / row["ours [ms]"])
    (found,) = summary([{"task": "R(16)"} | row for row in table])
    ratios = [row["times as long as ours"] for row in table[1:3]]
    assert found["rungs"] == 2
    assert (found["least times as long"], found["greatest"]) == (min(ratios), max(ratios))
    assert found["and an error of [m]"] == pytest.approx((1e-3, 1e-6)[ratios.index(min(ratios))])


def made_up_runs(equal=1.0):
    """A coarse method of second order, and a fine one of eighth that starts at three times the time."""
    fronts = {"coarse": [(1.0, 1e-2), (2.0, 2.5e-3), (4.0, 6e-4)], "fine": [(3.0, 1e-3), (4.5, 4e-5), (6.75, 1.6e-6)]}
    found = OwnRuns(
        [[OwnRun(name, f"{time:g} s", tuple) for time, _ in points] for name, points in fronts.items()],
        Reference((np.zeros((3, 1, 1)),), 1e-9),
        equal,
    )
    for name, points in fronts.items():
        found.results |= {(name, f"{time:g} s"): Result(time, (error,)) for time, error in points}
    return found


def test_the_quickest_run_at_an_error_lies_on_the_front_of_all_methods():
    ours = made_up_runs()
    for limit, expected in {
        0.5: ("coarse", "1 s"),
        2.5e-3: ("coarse", "2 s"),
        2.4e-3: ("fine", "3 s"),
        7e-4: ("coarse", "4 s"),
        1e-4: ("fine", "4.5 s"),
        2e-6: ("fine", "6.75 s"),
    }.items():
        best = ours.quickest((limit,))
        assert best is not None
        assert (best.method, best.setting) == expected
    assert ours.quickest((1e-6,)) is None
    best = made_up_runs(equal=2.0).quickest((0.9e-6,))
    assert best is not None
    assert best.method == "fine"


def rungs_of(task, peer, ratios, **more):
    return [
        {"task": task, "peer": peer, "damping": "isotropic", "its setting": f"rtol {i}", "error at 1 s [m]": 10.0**-i}
        | {"first call [ms]": 30.0, "peer [ms]": 10.0, "ours [ms]": 10.0 / ratio, "our error at the end [m]": 0.1**i}
        | {peer_ladder.RATIO: ratio}
        | more
        for i, ratio in enumerate(ratios)
    ]


def test_a_ladder_is_summed_up_with_the_error_where_we_lead_least():
    table = rungs_of("R(16)", "close", [5.0, 0.5, 2.0]) + [{"task": "R(16)", "peer": "absent", "note": "not installed"}]
    (found,) = summary(table)
    assert found["rungs"] == 3
    assert (found["least times as long"], found["median"], found["greatest"]) == (0.5, 2.0, 5.0)
    assert (found["there with"], found["and an error of [m]"]) == ("rtol 1", 0.1)
    assert found["rungs that are faster"] == 1
    assert found["first call over later ones"] == 3.0


def test_a_run_of_some_peers_keeps_the_rows_of_the_others(tmp_path):
    old = rungs_of("R(128)", "a", [2.0, 3.0], load=1.5) + rungs_of("R(16)", "b", [4.0])
    tables.save_table(old, tmp_path / "rope_peers.csv")
    both = peer_ladder.merged(
        tmp_path / "rope_peers.csv", rungs_of("R(16)", "b", [7.0]) + rungs_of("R(16)", "c", [8.0])
    )
    assert [(row["task"], row["peer"], row[peer_ladder.RATIO]) for row in both] == [
        ("R(16)", "b", 7.0),
        ("R(16)", "c", 8.0),
        ("R(128)", "a", 2.0),
        ("R(128)", "a", 3.0),
    ]
    assert both[2]["load"] == 1.5
    assert peer_ladder.merged(tmp_path / "none.csv", both) == both


def test_the_figure_has_every_ladder_and_our_runs():
    table = rungs_of("R(16)", "a", [2.0, 3.0]) + rungs_of("R(16)", "b", [4.0]) + rungs_of("R(128)", "a", [5.0])
    drawn = peer_ladder.figures("rope_peers", [*table, {"task": "another", "peer": "x", "note": "why"}])
    assert list(drawn) == ["rope_peers_16", "rope_peers_128"]
    lines = {line.get_label(): line for line in drawn["rope_peers_16"].axes[0].lines}
    assert set(lines) == {"a", "b", "Springtide"}
    assert list(lines["a"].get_ydata()) == [1.0, 0.1]
    assert len(lines["Springtide"].get_xdata()) == 3


@pytest.mark.skipif(sys.platform == "win32", reason="processor time is counted too coarsely on Windows")
def test_waits_do_not_count_as_time_of_a_run():
    assert undisturbed_time(lambda: time.sleep(0.05)) < 0.049
    assert undisturbed_time(lambda: sum(range(10_000))) > 0.0


def test_peers_are_chosen_by_words_of_their_names(monkeypatch, tmp_path, capsys):
    measured = []
    monkeypatch.setattr(
        peer_ladder,
        "compared",
        lambda peer, task, quick: measured.append((task.subject, peer.name)) or rungs_of("", "", [2.0]),
    )
    peers = [Peer(name, "numpy", print) for name in ("numpy RK4", "scipy RK45")]
    for words, quick, expected in (
        ((), False, [(1, "numpy RK4"), (1, "scipy RK45"), (2, "numpy RK4"), (2, "scipy RK45")]),
        ((), True, [(1, "numpy RK4"), (1, "scipy RK45")]),
        (("SCIPY",), True, [(1, "scipy RK45"), (2, "scipy RK45")]),
        (("R(2) numpy", "r(1) s"), False, [(1, "scipy RK45"), (2, "numpy RK4")]),
    ):
        measured.clear()
        peer_ladder.tables("R", (1, 2), peers, lambda size, damping: Task(size, (1.0,), made_up_runs()), words, quick)
        assert measured == expected
    with pytest.raises(ValueError, match=r"^--peers: 'dop999' is not allowed"):
        command.run(["rope"], peers=["dop999"])
    monkeypatch.setattr(rope_case, "rows", None)  # not measured with words
    monkeypatch.setattr(rope, "peer_rows", lambda quick, words: rungs_of("R(16)", f"scipy {words[0]}", [2.0]))
    command.run(["rope"], peers=["DOP853"], out=tmp_path)
    command.run(["rope"], peers=["RK45"], out=tmp_path)
    with (tmp_path / "rope_peers_summary.csv").open(newline="") as file:
        assert {row["peer"] for row in csv.DictReader(file)} == {"scipy DOP853", "scipy RK45"}
    assert (tmp_path / "rope_peers_16.svg").exists()
    assert "rope_peers_summary" in capsys.readouterr().out


def test_errors_of_sea_frames_are_round_off_of_their_precision():
    task = sea.peer_task(64, "isotropic")
    deep = float(task.subject.frequencies.max()) * sea.TIME  # [rad] a phase, as large as they get
    for run in (
        *(ladder[0].run for ladder in task.ours.ladders),
        *(lambda p=p: (student(task.subject, p)(5.0),) for p in PRECISIONS),
    ):
        (error,) = largest_distances(run(), task.ours.reference)
        single = run()[0].dtype == np.float32
        assert (
            (1e-8 if single else 1e-17) < error < (1e-5 if single else 1e-15 * deep * task.subject.significant_height)
        )


def test_our_own_run_at_a_peer_s_error_is_within_it():
    net = rope.benchmark_rope(16)
    ours = OwnRuns(rope.ladders(net), rope.reference(net))
    for limits in ((1e-3, 1e-2), (1e-6, 1e-5), (1e-9, 1e-8)):
        found = ours.quickest(limits)
        assert found is not None
        half, end = largest_distances(found.run(), ours.reference)
        assert half <= limits[0]
        assert end <= limits[1]
    assert ours.quickest((0.0, 0.0)) is None
