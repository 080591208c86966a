import math

import numpy as np
import pytest

from app.bench.cases import cloth
from app.bench.own_runs import OwnRuns, largest_distances
from app.bench.peers import cloth as cloth_peers
from app.bench.peers import cloth_engines
from app.bench.peers.ladder import rungs
from app.bench.peers.record import is_installed
from app.bench.tasks import cloth as cloth_task
from sim.springs.forces.acceleration import set_acceleration
from tests.sim.springs.reference import exact


def test_the_reference_is_as_good_as_it_says():
    net = cloth_task.benchmark_cloth(8)
    truth = cloth_task.reference(net)
    assert truth.uncertainty < 1e-10
    assert np.abs(truth.positions[0] - exact(net, cloth_task.DURATION)[0]).max() < 1e-10


def test_a_rung_that_would_take_too_long_is_left_out_and_said_so():
    net = cloth_task.benchmark_cloth(8)
    truth = cloth_task.reference(net)
    explicit = cloth.ladder(net, "rk4", truth, 0.0, 0.0)
    assert [row["left out"] for row in explicit] == ["over 0 s"]
    assert explicit[0]["error [m]"] is None
    # A solver that iterates may well take less for more steps: each of its rungs is asked.
    assert len(cloth.ladder(net, "implicit_midpoint", truth, 0.0, 0.0)) == len(cloth_task.STEP_COUNTS)


def test_errors_the_reference_cannot_tell_are_left_out():
    net = cloth_task.benchmark_cloth(8)
    truth = cloth_task.reference(net)._replace(uncertainty=1e-7)
    rows = cloth.ladder(net, "rk4", truth, math.inf, 0.0)
    points = [row for row in rows if cloth.is_point(row)]
    assert len(points) > 1
    assert all(row["error [m]"] > 1e-6 for row in points)
    assert rows[-1]["left out"] == "finer than the reference can tell"


def test_a_ladder_counts_one_run_s_evaluations_and_falls_at_its_order():
    net = cloth_task.benchmark_cloth(8)
    rows = cloth.ladder(net, "leapfrog", cloth_task.reference(net), math.inf, 0.0)
    assert [row["force evaluations"] for row in rows] == [row["steps"] + 1 for row in rows]
    first, last = rows[2], rows[-1]
    order = math.log(first["error [m]"] / last["error [m]"]) / math.log(last["steps"] / first["steps"])
    assert order == pytest.approx(2.0, abs=0.1)


def test_findings_say_what_leads_and_what_was_left_out():
    point = {"task": "C(8)", "reference good to [m]": 1e-12}
    table = [
        {**point, "method": "quick", "error [m]": 1e-2, "least [ms]": 1.0},
        {**point, "method": "beaten", "error [m]": 2e-2, "least [ms]": 2.0},
        {"task": "C(8)", "method": "slow", "left out": "over 5 s"},
        {"task": "C(8)", "method": "slow", "left out": "over 5 s"},
        {"task": "C(8)", "method": "wild", "left out": "diverged"},
    ]
    (found,) = cloth.findings(table)
    assert found["on the front of time against error"] == "quick"
    assert found["rungs left out"] == "over 5 s: slow; diverged: wild"


def test_our_own_run_at_a_peer_s_error_is_within_it():
    net = cloth_task.benchmark_cloth(8)
    ours = OwnRuns(cloth_task.ladders(net), cloth_task.reference(net))
    for limit in (1e-2, 1e-6, 1e-9):
        found = ours.quickest((limit,))
        assert found is not None
        assert largest_distances(found.run(), ours.reference)[0] <= limit
    assert ours.quickest((0.0,)) is None


def test_the_numpy_peer_takes_the_steps_of_our_symplectic_euler():
    net = cloth_task.benchmark_cloth(8)
    steps = 200
    theirs = cloth_peers.numpy_slices(net, cloth_task.DURATION / steps)(cloth_task.DURATION)
    assert np.abs(theirs - cloth_task.run(net, "symplectic_euler", steps).x).max() < 1e-12


@pytest.mark.parametrize("damping", ["isotropic", "axial"])
def test_engines_are_given_our_springs(damping):
    net = cloth_task.benchmark_cloth(6, damping)
    rng = np.random.default_rng(1)
    x, v = net.x0 + 0.05 * rng.standard_normal(net.x0.shape), rng.standard_normal(net.x0.shape)
    ours = np.empty_like(x)
    set_acceleration(x.reshape(-1), v.reshape(-1), 0.0, net.kernel_view(1.0), ours.reshape(-1))
    p, u = x.reshape(3, -1).T, v.reshape(3, -1).T
    masses = np.array([mass for _, mass in cloth_engines.particles(net)])
    f = masses[:, None] * net.gravity
    for i, j, rest, k, b in cloth_engines.springs(net):
        r, w = p[j] - p[i], u[j] - u[i]
        length = math.sqrt(r @ r)
        along = r * (w @ r) / length**2 if damping == "axial" else w
        pull = k * (1.0 - rest / length) * r + b * along
        f[i] += pull
        f[j] -= pull
    expected = np.divide(f, masses[:, None], out=np.zeros_like(f), where=masses[:, None] > 0.0)
    assert np.abs(ours.reshape(3, -1).T - expected).max() < 1e-9 * np.abs(expected).max()


@pytest.mark.parametrize("peer", cloth_engines.ENGINES, ids=lambda peer: peer.name)
def test_engines_that_are_installed_solve_the_same_cloth(peer):
    if not is_installed(peer.package):
        pytest.skip(f"{peer.package} is not installed")
    net = cloth_task.benchmark_cloth(8, peer.damping)
    theirs = peer.make(net, rungs(peer, net, quick=False)[0].value)(cloth_task.DURATION)
    assert largest_distances((theirs,), cloth_task.reference(net))[0] < 0.02
