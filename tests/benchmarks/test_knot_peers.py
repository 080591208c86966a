import itertools

import numpy as np
import pytest

from benchmarks.knots import least_distance
from benchmarks.peers import knot as knot_peers
from benchmarks.peers.ladder import DEEPEST, RATIO, rungs, shown, summary
from benchmarks.peers.record import Peer, is_installed
from benchmarks.tasks import knot

QUICK = knot_peers.Setting(480, (1e4, 10.0))


def test_the_least_distance_of_links_is_that_of_their_nearest_places():
    """Against many places on each link; also of links that are parallel, or lie in one line."""
    rng = np.random.default_rng(0)
    parts = np.linspace(0.0, 1.0, 201)[:, None]
    beside = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 0.3, 0.0), (0.4, 0.3, 0.0), (2.0, 0.0, 0.0)])
    for points in (beside, *(rng.standard_normal((4, 3)) for _ in range(50))):
        places = [a + parts * (b - a) for a, b in itertools.pairwise(points)]
        slow = min(
            np.linalg.norm(places[i][:, None] - places[j], axis=2).min()
            for i in range(len(places))
            for j in range(i + 2, len(places))
        )
        assert least_distance(points, 2) <= slow + 1e-12
        assert least_distance(points, 2) == pytest.approx(slow, abs=0.03)


def test_a_knot_stays_is_lost_or_ends_early():
    net = knot.benchmark_knot(80)
    knotted, straight = net.x0[:, 0].T, np.zeros((80, 3))
    straight[:, 0] = 0.05 * np.arange(80)
    count = round(knot_peers.DURATION * knot_peers.FRAMES_PER_SECOND)
    assert knot.outcome(np.array([knotted] * count)).holds
    assert knot.outcome(np.array([knotted] * 30)).knot == "diverges at 1.0 s"
    assert knot.outcome(np.array([])).knot == "diverges at 0.0 s"
    lost = knot.outcome(np.array([knotted] * 59 + [straight] * (count - 59)))
    assert lost.knot == "lost at 2.0 s"
    crossed = straight.copy()  # the last link lies 0.01 m above the middle of the 20th
    crossed[76:] = (3.8, 1.0, 0.0), (1.025, 1.0, 0.01), (1.025, 0.025, 0.01), (1.025, -0.025, 0.01)
    deep = knot.outcome(np.array([knotted, crossed])).deepest
    assert deep == pytest.approx(2.0 - 0.01 / knot.RADIUS)


def test_the_end_is_pulled_by_the_force_and_the_knot_gets_tight():
    """The last link carries the force; the rope is then longer than from end to end by the knot alone."""
    net = knot.benchmark_knot(80)
    frames = knot.own_run(net, QUICK)()
    assert knot.outcome(frames).holds
    lengths = np.linalg.norm(np.diff(frames[-1], axis=0), axis=1)
    family = net.families[0]
    assert family.stiffness * (lengths[-1] - family.rest) == pytest.approx(knot_peers.FORCE, rel=0.1)
    in_knot = lengths.sum() - np.linalg.norm(frames[-1, -1] - frames[-1, 0])
    assert 8.0 < in_knot / (2.0 * knot.RADIUS) < 13.0


def test_our_run_for_a_peer_is_the_quickest_that_is_no_deeper_and_keeps_the_knot():
    ours = knot.OwnKnots(knot.benchmark_knot(80))
    settings = [knot_peers.Setting(rate, (1.0, 1.0)) for rate in (60, 120, 240, 480)]
    outcomes = [knot.Outcome(0.9, "stays"), knot.Outcome(0.1, "lost at 1.0 s"), knot.Outcome(0.5, "stays")]
    outcomes.append(knot.Outcome(0.05, "stays"))
    ours.results = list(zip((1.0, 0.5, 3.0, 2.0), settings, outcomes, strict=True))
    for deepest, rate in ((1.0, 60), (0.6, 480), (0.05, 480)):
        best = ours.quickest(deepest)
        assert best is not None
        assert best[0].rate == rate
    assert ours.quickest(0.04) is None


def test_a_peer_that_is_as_deep_as_we_are_is_compared_with_that_run(monkeypatch):
    """A peer that is our own run; and one that loses its knot is not timed."""
    net = knot.benchmark_knot(80)
    ours = knot.OwnKnots(net)
    frames = knot.own_run(net, QUICK)()
    ours.results = [(1.0, QUICK, knot.outcome(frames))]
    monkeypatch.setattr(knot, "in_turns", lambda calls, most: [[0.5], [0.25]][: len(calls)])
    peer = Peer("own", "numpy", knot.own_run, settings=knot_peers.ladder(QUICK))
    (row,) = knot.compared(peer, ours, False)
    assert row["knot"] == "stays"
    assert row[DEEPEST] == row["our " + DEEPEST]
    assert row[RATIO] == 2.0
    assert row["its setting"] == row["with"] == "step 1/480 s, contact 10000 10"
    lost = Peer("lost", "numpy", lambda net, setting: lambda: frames[:, :40], settings=knot_peers.ladder(QUICK))
    (failed,) = knot.compared(lost, ours, False)
    assert failed["note"] == "its knot fails"
    assert "peer [ms]" not in failed
    table = [{"task": "K(80)"} | each for each in (row, failed)]
    assert shown(table)[1]["knot"] == "lost at 0.0 s"
    assert "error [m]" not in shown(table)[0]
    (found,) = summary(table)
    assert found["and a depth of [radii]"] == row[DEEPEST]


def test_absent_programs_have_a_row_that_says_so(monkeypatch):
    monkeypatch.setattr(knot, "PEERS", (Peer("absent", "not_there", print),))
    absent = {"task": "K(80)", "peer": "absent", "damping": "isotropic", "note": "not installed"}
    assert knot.peer_rows() == [absent]
    assert knot.peer_rows(words=("else",)) == []


def test_directors_are_right_handed_frames_along_the_rope():
    points = knot.benchmark_knot(80).x0[:, 0].T
    directors = np.moveaxis(knot_peers.frames_along(points), 2, 0)
    assert np.abs(directors @ directors.transpose(0, 2, 1) - np.eye(3)).max() < 1e-12
    assert np.linalg.det(directors) == pytest.approx(1.0)
    ways = np.diff(points, axis=0)
    assert np.abs(np.cross(directors[:, 2], ways)).max() < 1e-12
    assert (np.diff(directors[:, 0], axis=0) ** 2).sum(axis=1).max() < 1.0


@pytest.mark.parametrize("peer", knot_peers.PEERS, ids=lambda peer: peer.name)
def test_programs_that_are_installed_are_given_our_rope(peer, monkeypatch):
    """Half a second of the pull, in which links hardly touch: the ropes part by a fifth of the way of its end.

    Chains of capsules, which are stiff and damp their joints, part by two fifths.
    """
    if not is_installed(peer.package):
        pytest.skip(f"{peer.package} is not installed")
    monkeypatch.setattr(knot_peers, "stages", lambda: range(5))
    net = knot.benchmark_knot(80, peer.damping)
    ours = knot.own_run(net, QUICK)()[-1]
    theirs = peer.make(net, rungs(peer, net, False)[1].value)()[-1]
    part = 0.4 if "capsules" in peer.name or "newton" in peer.name else 0.2
    assert np.linalg.norm(theirs - ours, axis=1).max() < part * np.linalg.norm(ours[-1] - net.x0[:, 0, -1])
