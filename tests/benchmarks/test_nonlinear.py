"""The plain program of the nonlinear waves' benchmark is a second opinion: it comes to the same waves."""

import numpy as np
import pytest

from benchmarks.cases.waves import nonlinear
from benchmarks.cases.waves.nonlinear import ours, plain, start
from benchmarks.peers.nonlinear import PlainSea
from benchmarks.peers.separable import separable_flow
from sim.ocean.nonlinear import NonlinearSea


@pytest.mark.parametrize("order", [2, 3])
def test_both_programs_move_a_crossing_sea_alike(order: int) -> None:
    random = np.random.default_rng(3)
    x, y = np.arange(40)[:, None] * 2.5, np.arange(32) * 1.875
    elevation = potential = np.zeros((40, 32))
    for i, j in ((2, 0), (3, 1), (1, -1), (4, 2)):
        phase = 2.0 * np.pi * (i * x / 100.0 + j * y / 60.0) + random.uniform(0.0, 6.0)
        elevation, potential = elevation + 0.1 * np.cos(phase), potential + 0.5 * np.sin(phase)
    other = PlainSea(elevation, potential, (100.0, 60.0), order, 9.81)
    other.advance(1.0, 40)
    sea = NonlinearSea(length=(100.0, 60.0), order=order, start=(elevation, potential), breaking=False, step=0.025)
    sea.advance(1.0)
    moved = np.abs(sea.height - elevation).max()
    # Above order 2 ours keeps more waves of the potentials in between, which matter on coarser grids.
    assert np.abs(sea.height - other.height).max() < 2e-6 * moved


def test_a_row_of_each_program(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(nonlinear, "PERIODS", 2)
    _, elevation, _ = start(16)
    found = [ours(3, 16, 1e-5), plain(3, 16, 20)]
    assert elevation.shape == (16,)
    for row in found:
        assert row["form error"] < 5e-3
        assert row["phase error"] < 2e-3


def test_the_separable_loops_have_the_flow_of_the_linear_sea() -> None:
    random = np.random.default_rng(4)
    eta, psi = random.normal(size=(2, 16, 16))
    sea = NonlinearSea(length=40.0, order=1, start=(eta, psi))
    points = np.column_stack([random.uniform(0.0, 40.0, (9, 2)), np.full(9, -25.0)])
    found = separable_flow(points, np.fft.rfft2(sea.potential.T)[:, :-1] / 256.0, 40.0)
    assert found[:, 1:] == pytest.approx(sea.kinematics(points).velocity, abs=1e-13)
