import math

import numpy as np
import pytest

from benchmarks.cases.springs import cloth
from tests.sim.springs.reference import exact


def test_the_reference_is_as_good_as_it_says():
    net = cloth.benchmark_cloth(8)
    truth = cloth.reference(net)
    assert truth.uncertainty < 1e-10
    assert np.abs(truth.positions[0] - exact(net, cloth.DURATION)[0]).max() < 1e-10


def test_a_rung_that_would_take_too_long_is_left_out_and_said_so():
    net = cloth.benchmark_cloth(8)
    truth = cloth.reference(net)
    explicit = cloth.ladder(net, "rk4", truth, 0.0, 0.0)
    assert [row["left out"] for row in explicit] == ["over 0 s"]
    assert explicit[0]["error [m]"] is None
    # A solver that iterates may well take less for more steps: each of its rungs is asked.
    assert len(cloth.ladder(net, "implicit_midpoint", truth, 0.0, 0.0)) == len(cloth.STEP_COUNTS)


def test_errors_the_reference_cannot_tell_are_left_out():
    net = cloth.benchmark_cloth(8)
    truth = cloth.reference(net)._replace(uncertainty=1e-7)
    rows = cloth.ladder(net, "rk4", truth, math.inf, 0.0)
    points = [row for row in rows if cloth.is_point(row)]
    assert len(points) > 1
    assert all(row["error [m]"] > 1e-6 for row in points)
    assert rows[-1]["left out"] == "finer than the reference can tell"


def test_a_ladder_counts_one_run_s_evaluations_and_falls_at_its_order():
    net = cloth.benchmark_cloth(8)
    rows = cloth.ladder(net, "leapfrog", cloth.reference(net), math.inf, 0.0)
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
