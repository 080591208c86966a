import numpy as np
import pytest

from app.scenes.rope.scene import RopeParams
from app.study.sweep.design import Listed, Range, grid, grid_values, hypercube, size
from sim.parameters import parameters_of

PARAMETERS = parameters_of(RopeParams)


def test_a_grid_has_every_combination_once_the_last_parameter_the_fastest():
    cases = grid({"integrator": ("rk4", "leapfrog"), "points": (2, 3, 4)})
    assert len(cases) == 6
    assert [case["points"] for case in cases] == [2, 3, 4, 2, 3, 4]
    assert cases[3] == {"integrator": "leapfrog", "points": 2}
    assert size({"a": Listed((1, 2)), "b": Range(0.0, 1.0, 5, False)}) == 10


def test_ranges_hold_both_ends_exactly_and_are_evenly_spaced():
    steps = grid_values(Range(1e-3, 0.1, 24, True), PARAMETERS["time_step"])
    assert (steps[0], steps[-1]) == (1e-3, 0.1)
    assert np.allclose(np.diff(np.log(steps)), np.log(100) / 23)
    masses = grid_values(Range(0.1, 0.7, 7, False), PARAMETERS["mass"])
    assert (masses[0], masses[-1]) == (0.1, 0.7)
    assert np.allclose(np.diff(masses), 0.1)


def test_whole_numbers_are_rounded_to():
    points = grid_values(Range(2, 1000, 4, True), PARAMETERS["points"])
    assert points == (2, 16, 126, 1000)
    assert all(type(value) is int for value in points)


@pytest.mark.parametrize("count", [1, 7, 100])
def test_a_hypercube_has_one_case_in_each_share_of_every_range(count):
    axes = {"mass": Range(2.0, 4.0, 0, False), "stiffness": Range(1.0, 1e6, 0, True)}
    cases = hypercube(axes, PARAMETERS, count, seed=5)
    shares = [(case["mass"] - 2.0) / 2.0 for case in cases]
    assert sorted(int(share * count) for share in shares) == list(range(count))
    shares = [np.log10(case["stiffness"]) / 6.0 for case in cases]
    assert sorted(int(share * count) for share in shares) == list(range(count))


def test_a_hypercube_takes_lists_and_whole_numbers_in_equal_shares():
    axes = {"integrator": Listed(("rk4", "leapfrog")), "points": Range(2, 6, 0, False), "floor": Listed((True, False))}
    cases = hypercube(axes, PARAMETERS, 20, seed=0)
    assert [case["integrator"] for case in cases].count("rk4") == 10
    assert sorted(case["points"] for case in cases) == [p for p in range(2, 7) for _ in range(4)]
    assert sum(case["floor"] for case in cases) == 10


def test_a_seed_is_a_design():
    axes = {"mass": Range(2.0, 4.0, 0, False)}
    assert hypercube(axes, PARAMETERS, 9, seed=1) == hypercube(axes, PARAMETERS, 9, seed=1)
    assert hypercube(axes, PARAMETERS, 9, seed=1) != hypercube(axes, PARAMETERS, 9, seed=2)
