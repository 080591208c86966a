import math

import numpy as np
import pytest

from benchmarks.cases.springs import cloth
from benchmarks.peers import cloth as cloth_peers
from benchmarks.peers import cloth_engines
from benchmarks.peers.ladder import rungs
from benchmarks.peers.own_runs import OwnRuns
from benchmarks.peers.record import is_installed
from benchmarks.reference import largest_distances
from benchmarks.tasks import stiff
from benchmarks.tasks.cloth import ladders
from sim.springs.points.acceleration import set_acceleration


def test_our_own_run_at_a_peer_s_error_is_within_it():
    net = cloth.benchmark_cloth(8)
    ours = OwnRuns(ladders(net), cloth.reference(net))
    for limit in (1e-2, 1e-6, 1e-9):
        found = ours.quickest((limit,))
        assert found is not None
        assert largest_distances(found.run(), ours.reference)[0] <= limit
    assert ours.quickest((0.0,)) is None


def test_the_numpy_peer_takes_the_steps_of_our_symplectic_euler():
    net = cloth.benchmark_cloth(8)
    steps = 200
    theirs = cloth_peers.numpy_slices(net, cloth.DURATION / steps)(cloth.DURATION)
    assert np.abs(theirs - cloth.run(net, "symplectic_euler", steps).x).max() < 1e-12


@pytest.mark.parametrize("damping", ["isotropic", "axial"])
def test_engines_are_given_our_springs(damping):
    net = cloth.benchmark_cloth(6, damping)
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
    net = cloth.benchmark_cloth(8, peer.damping)
    theirs = peer.make(net, rungs(peer, net, quick=False)[0].value)(cloth.DURATION)
    assert largest_distances((theirs,), cloth.reference(net))[0] < 0.02


def test_a_stiff_cloth_has_a_reference_and_our_runs_approach_it():
    net, _, ours = stiff.peer_task(6, "axial")
    (true,) = ours.reference.positions
    assert ours.reference.uncertainty < 1e-7
    assert np.linalg.norm(true - net.x0, axis=0).max() > 0.25  # it has fallen
    for name in ("implicit_euler", "tr_bdf2"):
        coarse, fine = (largest_distances(cloth.positions(net, name, n), ours.reference)[0] for n in (32, 128))
        assert fine < 0.35 * coarse < 0.01
