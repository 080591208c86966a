"""`springtide stability`, coarse."""

import csv
import math
from collections.abc import Iterator

import numpy as np
import pytest

from app.study import pool
from app.study.stability import command, damping, drift, figures, linear, rope
from sim.springs import INTEGRATORS
from sim.springs.analysis.growth import step_growth
from sim.springs.stability import critical_step
from tests.wine import needs_pools

SAMPLE = ("explicit_euler", "leapfrog", "rk4", "implicit_euler", "implicit_midpoint")  # a third of the time


@pytest.fixture(
    scope="module",
    params=[
        pytest.param(SAMPLE, id="sample"),
        pytest.param(tuple(INTEGRATORS), id="all", marks=pytest.mark.stress),
    ],
)
def maps(request: pytest.FixtureRequest) -> Iterator[list[linear.LinearMap]]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(linear, "INTEGRATORS", {name: INTEGRATORS[name] for name in request.param})
        yield linear.measure(quick=True, workers=1)


def test_the_linear_maps_agree_with_theory_all_over(maps):
    table = linear.rows(maps)
    assert [row["integrator"] for row in table] == list(linear.INTEGRATORS)
    for row in table:
        if row["integrator"] != "leapfrog":  # with damping its declared limit is a bound
            assert row["disagree"] == 0, row
            assert row["limit off at most [%]"] is None or row["limit off at most [%]"] < 2.0, row
        unlimited = np.isinf(INTEGRATORS[row["integrator"]].limit(0.5))
        assert (row["grow"] == 0) == unlimited


def test_a_wrong_limit_is_noticed(maps):
    found = next(m for m in maps if m.name == "rk4")
    wrong = found._replace(theory=1.2 * found.theory)
    assert linear.disagreements(wrong)[1] > 0
    assert np.nanmax(linear.deviations(wrong)) > 0.1
    nowhere = found._replace(theory=np.full_like(found.theory, np.inf))
    assert linear.disagreements(nowhere)[0] == (found.rates > 0).sum()


def test_methods_add_the_damping_that_they_do(maps):
    by_name = {m.name: linear.extra_damping(m) for m in maps}
    z = maps[0].steps
    # Undamped implicit Euler loses ln(1 + z^2)/2 of the amplitude's logarithm a step.
    np.testing.assert_allclose(by_name["implicit_euler"][0], np.log1p(z * z) / (2.0 * z), rtol=0.02)
    assert np.abs(by_name["implicit_midpoint"][0]).max() == 0.0
    assert by_name["explicit_euler"][0].max() < 0.0


@pytest.mark.parametrize("name", INTEGRATORS)
@pytest.mark.parametrize("net", damping.networks())
def test_the_critical_step_is_where_growth_begins_at_every_damping(net, name):
    record = INTEGRATORS[name]
    for b in (0.0, 10.0, 1e3, 1e5):
        built, state = damping.at_rest(net, b)
        if record.undamped_only and b > 0.0:
            continue
        h = critical_step(built, name, state)
        if 0.0 < h < math.inf:
            assert step_growth(record, built, 0.95 * h, state.x) < damping.GROWS, b
            if name != "leapfrog" or b == 0.0:  # with damping its critical step is a bound
                assert step_growth(record, built, 1.05 * h, state.x) > damping.GROWS, b
        else:
            assert damping.measured_step(record, built, state, h) == h, b


def test_the_table_of_the_rope_names_the_stiffness_that_is_off_most():
    steps, stiffnesses = np.array([0.01, 0.1, 1.0]), np.array([1.0, 10.0, 100.0])
    found = rope.RopeMap(
        "rk4",
        steps,
        stiffnesses,
        np.zeros((3, 3), int),
        np.array([0.2, 0.13, 0.1]),
        np.array([0.2] * 3),
        np.array([0.05] * 3),
    )
    (row,) = rope.rows([found])
    assert (row["at k [N/m]"], row["at most [%]"]) == (100.0, pytest.approx(50.0))
    assert row["step off, median [%]"] == pytest.approx(35.0)


def test_the_map_shows_added_damping_where_nothing_grows(maps):
    figure = figures.linear_figure(maps)
    shown = [axes for axes in figure.axes if axes.collections and axes.get_title()]
    for axes, found in zip(shown, maps, strict=True):
        extra, grows = (
            np.ma.masked_invalid(one.get_array()).reshape(found.rates.shape) for one in axes.collections[:2]
        )
        assert np.array_equal(extra.mask, ~(found.rates <= 0.0))
        assert extra.compressed() == pytest.approx(linear.extra_damping(found)[found.rates <= 0.0])
        assert np.array_equal(~np.ma.getmaskarray(grows), found.rates > 0.0)


def test_a_limit_where_theory_knows_none_is_the_first_step_that_grows():
    net, state = damping.at_rest("rope", 10.0)
    assert 0.01 < critical_step(net, "rk4", state) < 0.1
    assert damping.measured_step(INTEGRATORS["rk4"], net, state, math.inf) == 0.1
    assert damping.measured_step(INTEGRATORS["implicit_euler"], net, state, math.inf) == math.inf


def test_the_table_over_damping_tells_a_wrong_limit():
    right = damping.DampingRow(
        "rope", "rk4", np.zeros(4), np.array([0.1, 0.0, math.inf, math.nan]), np.array([0.1, 0.0, math.inf, math.nan])
    )
    assert damping.rows([right])[0]["step off at most [%]"] == 0.0
    wrong = right._replace(theory=np.array([0.05, 0.0, math.inf, math.nan]))
    assert damping.rows([wrong])[0]["step off at most [%]"] == pytest.approx(100.0)


def test_symplectic_energies_are_bounded_and_the_others_drift():
    names = ("symplectic_euler", "leapfrog", "implicit_euler", "explicit_euler")
    drifts = [drift.Drift(name, INTEGRATORS[name].symplectic, *drift.course(name, 20_000)) for name in names]
    courses = {row["integrator"]: row["course"] for row in drift.rows(drifts)}
    assert courses == {
        "symplectic_euler": "bounded",
        "leapfrog": "bounded",
        "implicit_euler": "comes to rest",
        "explicit_euler": "diverged",
    }


def test_energies_of_symplectic_methods_stand_beside_those_of_the_others():
    t = np.array([0.0, 1.0, 2.0])
    drifts = [drift.Drift(name, INTEGRATORS[name].symplectic, t, 1e-3 * t) for name in ("leapfrog", "rk4", "pefrl")]
    left, right, *_ = figures.drift_figure(drifts).axes
    for axes, title, names in ((left, "symplectic", ["leapfrog", "pefrl"]), (right, "not symplectic", ["rk4"])):
        assert axes.get_title() == title
        assert [line.get_label() for line in axes.lines] == names


def test_the_command_keeps_tables_and_figures(tmp_path, monkeypatch, capsys, maps):
    monkeypatch.setattr(linear, "measure", lambda **_: maps[:2])
    names = {name: INTEGRATORS[name] for name in ("leapfrog", "implicit_euler")}
    monkeypatch.setattr(rope, "INTEGRATORS", names)
    monkeypatch.setattr(drift, "INTEGRATORS", names)
    monkeypatch.setattr(damping, "INTEGRATORS", names)
    assert command.measure_maps(quick=True, out=tmp_path, workers=1) == 0
    assert "leapfrog" in capsys.readouterr().out
    kept = {path.name for path in tmp_path.iterdir()}
    for name in ("linear", "rope", "damping", "drift"):
        assert {f"{name}.csv", f"{name}_curves.csv", f"{name}.svg", f"{name}.png"} <= kept
    assert "machine.txt" in kept
    with (tmp_path / "rope.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert rows[0]["integrator"] == "leapfrog"
    assert float(rows[0]["step off, median [%]"]) < 2.0


@needs_pools
def test_work_is_spread_in_order():
    assert pool.spread(divmod, [(7, 2), (9, 4)], "division", workers=1) == [(3, 1), (2, 1)]
    assert pool.spread(divmod, [(7, 2), (9, 4)], "division", workers=2) == [(3, 1), (2, 1)]
