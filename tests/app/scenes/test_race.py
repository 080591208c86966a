"""Ropes in a race, without a browser."""

import dataclasses
import json

import numpy as np
import pytest

from app.commands.run import run_to_file
from app.messages import DivergenceError, Grab, Place, Release
from app.scenes.race.race import tick_of
from app.scenes.race.race_charts import KEPT, RaceCharts, round_up
from app.scenes.race.report import standings
from app.scenes.rope.measures import measures
from app.scenes.rope.parameters import PRESETS, ROOT, Params, build, hidden
from app.scenes.rope.scene import Scene
from app.scenes.rope.scene import scene as rope_scene
from sim.parameters import check_record, parameters_of
from sim.springs import INTEGRATORS, simulate
from sim.springs.analysis.reference_run import HORIZON_SEPARATION, ReferenceRun
from sim.springs.state import steps_for

RACES = [name for name, parameters in PRESETS.items() if parameters.get("ropes", 1) > 1]


def run(scene: Scene, seconds: float) -> None:
    """In frames of about 1/60 s, as the lab does."""
    ticks = max(1, round(1 / 60 / scene.step))
    for _ in range(round(seconds / (ticks * scene.step))):
        scene.advance(ticks)


def raced(preset: str, seconds: float, **others) -> Scene:
    scene = Scene(dataclasses.replace(check_record(Params, PRESETS[preset]), **others))
    run(scene, seconds)
    return scene


@pytest.mark.parametrize("preset", RACES)
def test_every_race_runs_and_is_shown(preset):
    scene = raced(preset, 2.0)
    picture = scene.frame().race
    assert picture.ropes.shape == (scene.params.ropes, scene.params.points, 3)
    assert np.isfinite(picture.ropes).all()
    assert np.abs(picture.ropes).max() < 12.0
    assert picture.ghosts.shape == picture.ropes.shape
    assert len(picture.labels) == len(set(picture.labels)) == scene.params.ropes
    words = standings(scene.readings())
    assert all(rope.integrator in words for rope in scene.readings().standings)
    charts = scene.curves()
    for chart in charts.values():
        assert len(chart.columns) == len(chart.lines) + 1
        assert len({len(column) for column in chart.columns}) == 1
    assert len(charts["plot_errors"].columns[0]) > 30


@pytest.mark.parametrize(("preset", "held"), [("Euler at rising stiffness", 2), ("RK4 at the same values", 5)])
def test_those_diverge_that_are_over_their_limit_and_the_others_race_on(preset, held):
    scene = raced(preset, 5.0)
    assert scene.time == pytest.approx(5.0)
    for number, rope in enumerate(scene.readings().standings, 1):
        over = rope.gauge.h_omega > rope.gauge.limit
        assert over == (number > held) == bool(rope.out)
        if over:
            assert rope.out.startswith("diverged at ")
            assert f"h ω = {rope.gauge.h_omega:.3g} is over {rope.gauge.limit:.3g}" in rope.out
            assert np.isnan(rope.error)
        else:
            assert rope.error < 0.1


def test_a_rope_races_as_it_would_alone():
    scene = raced("RK4 at the same values", 2.0)
    lane = scene.race.lanes[2]
    alone = simulate(dataclasses.replace(lane.net, x0=lane.net.x0), "rk4", lane.step, 2.0, 2)
    np.testing.assert_allclose(lane.state.x[:, 0].T, alone.x[-1], atol=1e-12)


@pytest.mark.parametrize("damping", [7.0, 0.0])
def test_the_reference_is_as_good_as_its_shadow_says(damping):
    """Against an eighth-order method at a tolerance a thousand times finer."""
    params = Params(damping=damping, drag=damping / 7.0, floor=False)
    net = build(params)
    ghost = ReferenceRun(net, params.length)
    truth = simulate(net, "dop853", duration=4.0, frames=241, rtol=1e-13, atol=1e-15)
    for frame in range(1, 241):
        ghost.advance(net, (frame - 1) / 60, 1 / 60)
        assert np.linalg.norm(ghost.x.T - truth.x[frame], axis=1).max() < 3.0 * ghost.separation


def test_the_error_shown_is_the_distance_from_the_truth():
    scene = raced("Euler against RK4 against leapfrog", 2.0)
    truth = simulate(build(scene.params), "dop853", duration=2.0, frames=2, rtol=1e-12, atol=1e-14).x[-1]
    for lane, rope in zip(scene.race.lanes, scene.readings().standings, strict=True):
        error = np.linalg.norm(lane.state.x[:, 0].T - truth, axis=1).max()
        assert rope.error == pytest.approx(error, abs=rope.certain)
        assert rope.error > rope.certain


def test_half_the_step_shows_the_order_of_the_leapfrogs():
    scene = raced("Leapfrog read literally", 1.5)
    chart = scene.curves()["plot_errors"]
    errors = np.mean(chart.columns[2:], axis=1)
    assert [rope.integrator for rope in scene.readings().standings] == ["leapfrog"] * 2 + ["leapfrog_lagged"] * 2
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)
    assert errors[2] / errors[3] == pytest.approx(2.0, rel=0.1)


def test_equal_cost_is_equal_force_evaluations_a_second():
    scene = raced("Undamped until chaos", 1.0)
    assert scene.params.race_steps == "same cost"
    each = [lane.state.force_evals / lane.state.t for lane in scene.race.lanes if lane.record.name != "leapfrog"]
    np.testing.assert_allclose(each, 960.0, rtol=0.05)


def test_chaos_takes_the_undamped_reference_and_the_chart_is_shaded_from_there():
    scene = raced("Undamped until chaos", 1.0)
    assert scene.readings().horizon is None
    while scene.readings().horizon is None and scene.time < 60.0:
        scene.advance(8)
    lost = scene.readings().horizon
    assert 2.0 < lost < 60.0
    assert scene.race.ghosts[0].separation > HORIZON_SEPARATION * scene.params.length
    assert scene.frame().race.ghosts is None
    run(scene, 0.5)
    chart = scene.curves()["plot_errors"]
    t, zone = chart.columns[:2]
    assert (zone[t > lost + 0.05] > 10.0).all()
    assert (zone[t < lost - 0.05] < 10.0).all()
    assert all(np.isnan(rope.certain) for rope in scene.readings().standings)
    assert "Chaos took the reference" in standings(scene.readings())
    scene.reset()
    assert scene.readings().horizon is None
    assert scene.frame().race.ghosts is not None


def test_damping_keeps_the_reference():
    assert raced("Euler against RK4 against leapfrog", 12.0).readings().horizon is None


def test_a_reference_too_dear_is_left_out_and_says_so():
    scene = Scene(Params(ropes=2, points=1000, stiffness=1e9, integrator="implicit_euler", integrator_2="tr_bdf2"))
    scene.advance(2)
    assert "too many for ropes of 1000 points" in scene.readings().no_ghost
    assert scene.frame().race.ghosts is None
    assert all(not rope.out and np.isnan(rope.error) for rope in scene.readings().standings)
    assert "There is no reference" in standings(scene.readings())


def test_a_reference_is_too_dear_by_its_damping_alone_too():
    # 4e8 /s against a frequency of 1e3 rad/s: an explicit method's steps would be 8 ns long.
    scene = Scene(Params(ropes=2, damping=1e5, mass=1e-3, integrator="implicit_euler", integrator_2="tr_bdf2"))
    scene.advance(2)
    assert "too many for ropes of 10 points" in scene.readings().no_ghost


def test_a_method_that_refuses_damping_is_out_at_once():
    scene = Scene(Params(ropes=2, integrator_2="pefrl"))
    run(scene, 0.5)
    first, second = scene.readings().standings
    assert (first.out, second.out) == ("", "takes no damping: set damping and drag to 0, the floor off")
    assert scene.time == pytest.approx(0.5)


def test_all_ropes_may_go_and_the_clock_runs_on():
    scene = Scene(Params(ropes=2, integrator="explicit_euler", integrator_2="explicit_euler", stiffness=5e4))
    run(scene, 2.0)
    assert all(rope.out for rope in scene.readings().standings)
    assert scene.time == pytest.approx(2.0)
    assert scene.frame().race.ghosts is not None


def test_numerical_damping_is_told_from_the_ropes_own():
    """Without any damping all that goes is the method's: implicit Euler takes, leapfrog and PEFRL do not."""
    alike = {"damping": 0.0, "drag": 0.0, "floor": False, "time_step": 1 / 480}
    scene = Scene(Params(ropes=3, integrator="implicit_euler", integrator_2="leapfrog", integrator_3="pefrl", **alike))
    run(scene, 1.5)
    euler, leapfrog, pefrl = scene.readings().standings
    assert euler.taken > 1.0
    assert euler.taken == pytest.approx(scene.race.lanes[0].initial - scene.race.lanes[0].total())
    assert abs(leapfrog.taken) < 0.1
    assert abs(pefrl.taken) < 1e-4
    assert (leapfrog.corrections, pefrl.corrections) == (0.0, 0.0)
    assert 1.0 <= euler.corrections < 10.0


def test_other_methods_start_the_race_anew_and_other_physics_does_not():
    scene = Scene(Params(ropes=2))
    run(scene, 0.5)
    scene.set_params(dataclasses.replace(scene.params, damping=3.0))
    assert scene.time == pytest.approx(0.5)
    run(scene, 0.5)
    assert scene.readings().standings[0].error < 1e-2
    for change in ({"integrator_2": "leapfrog"}, {"stiffness_ratio": 2.0}, {"ropes": 3}, {"time_step": 0.01}):
        scene.set_params(dataclasses.replace(scene.params, **change))
        assert scene.time == 0.0
        run(scene, 0.2)
    scene.set_params(dataclasses.replace(scene.params, ropes=1))
    assert scene.race is None
    scene.advance(3)
    assert scene.frame().race is None


def test_a_drag_of_one_rope_pulls_all_alike_and_the_reference_too():
    scene = Scene(Params(ropes=3, integrator="rk4", integrator_2="rk4", integrator_3="rk4", spacing=0.5))
    run(scene, 3.0)
    bead = scene.frame().race.ropes[2, 6]
    scene.handle(Grab(2 * 10 + 6, (bead[0] + 0.6, bead[1] + 0.4, bead[2])))
    run(scene, 0.5)
    assert scene.frame().pull.particle == 26
    xs = [lane.state.x for lane in scene.race.lanes]
    np.testing.assert_array_equal(xs[0], xs[1])
    np.testing.assert_array_equal(xs[0], xs[2])
    assert scene.frame().race.ropes[2, 6, 0] > bead[0] + 0.2
    assert scene.frame().race.ropes[2, 6, 1] > bead[1] + 0.1
    assert scene.readings().standings[0].error < 1e-3
    scene.handle(Release())
    assert scene.frame().pull is None


def test_all_roots_follow_the_one_gizmo():
    scene = Scene(Params(ropes=2, integrator="rk4"))
    scene.handle(Place("root", (0.3, 0.2, 3.4)))
    run(scene, 2.0)
    for lane in scene.race.lanes:
        np.testing.assert_allclose(lane.state.x[:, 0, 0], (0.3, 0.2, 3.4), atol=1e-12)
    np.testing.assert_allclose(scene.race.ghosts[0].x[:, 0], (0.3, 0.2, 3.4), atol=1e-12)
    roots = scene.frame().race.ropes[:, 0]
    np.testing.assert_allclose(roots[1] - roots[0], (0.0, scene.params.spacing, 0.0), atol=1e-6)
    assert scene.readings().standings[0].error < 1e-3


def test_a_long_race_thins_its_rows_and_keeps_its_beginning():
    scene = Scene(Params(ropes=2, points=2))
    scene.charts = charts = RaceCharts(scene.race)
    charts.every = 1e-9
    assert charts.charts() == {}
    for _ in range(2 * KEPT + 10):
        charts.due = 0.0
        scene.race.advance(scene.net, 1)
        charts.sample()
    t = charts.charts()["plot_errors"].columns[0]
    assert KEPT / 2 <= len(t) <= KEPT
    assert t[0] == pytest.approx(scene.step)
    assert (np.diff(t) > 0).all()
    assert charts.charts() is charts.charts()


@pytest.mark.parametrize(
    "name", [name for name, parameter in parameters_of(Params).items() if parameter.group in ("Race", "Time")]
)
def test_both_ends_of_every_race_parameter_survive(name):
    parameter = parameters_of(Params)[name]
    ends = parameter.choices or ((False, True) if parameter.kind is bool else (parameter.low, parameter.high))
    for value in ends:
        scene = Scene(
            dataclasses.replace(Params(ropes=3), **{name: value if parameter.choices else parameter.kind(value)})
        )
        steps = int(np.clip(round(1 / 60 / scene.step), 1, 100))
        for _ in range(20):
            try:
                scene.advance(steps)
            except DivergenceError:
                assert scene.race is None
                break
        assert np.isfinite(scene.frame().points).all()
        assert scene.race is None or np.isfinite(scene.race.points()).all()


def test_a_race_hides_what_means_nothing_in_it():
    alone, race = hidden(Params()), hidden(Params(ropes=3))
    assert {"integrator_2", "plot_errors", "spacing"} <= alone
    assert {"sphere", "plot_tip", "integrator_4", "step_2"} <= race
    assert not {"integrator_3", "plot_errors", "stiffness_ratio"} & race
    assert "step_2" not in hidden(Params(ropes=3, race_steps="own steps"))


def test_a_race_runs_to_a_file(tmp_path, capsys):
    params = Params(ropes=2, integrator="explicit_euler", integrator_2="rk4")
    assert run_to_file("rope", rope_scene, params, 1.0, 30.0, tmp_path / "race.npz") == 0
    capsys.readouterr()
    file = np.load(tmp_path / "race.npz")
    assert file["x"].shape == (31, 2, 10, 3)
    assert file["reference"].shape == (31, 1, 10, 3)
    error = np.linalg.norm(file["x"][:, 1] - file["reference"][:, 0], axis=2).max(axis=1)
    np.testing.assert_allclose(file["error"][:, 1], error)
    assert "m" in json.loads(str(file["about"]))["units"]["separation"]


@pytest.mark.parametrize("name", [name for name, record in INTEGRATORS.items() if record.implicit])
def test_stiffness_without_fear(name):
    """1e9 N/m at the lab's own step: in bounds for ten seconds, at a bounded price that is shown."""
    scene = Scene(Params(integrator=name, stiffness=1e9))
    dearest = 0.0
    for _ in range(600):
        before = scene.state.force_evals
        scene.advance(1)
        dearest = max(dearest, scene.state.force_evals - before)
        assert np.linalg.norm(scene.state.x[:, 0].T - ROOT, axis=1).max() < 2.01
    assert dearest <= 60
    paid = scene.readings().paid
    assert 1.0 <= paid.corrections <= 25.0
    assert paid.dissipated > 0.0
    if name == "implicit_euler":
        assert paid.taken > 0.1 * paid.dissipated
    assert Scene(Params()).readings().paid is None


@pytest.mark.parametrize(("t", "end"), [(0.1, 2.0), (2.0, 2.0), (2.1, 5.0), (10.0, 10.0), (11.0, 20.0), (99.0, 100.0)])
def test_the_charts_end_at_a_round_time(t, end):
    assert round_up(t) == pytest.approx(end)


@pytest.mark.parametrize("steps", [[0.1, 0.03], [1 / 60] * 6, [1e-5, 0.1], [1 / 240, 3 / 960, 4 / 960], [0.01, 0.007]])
def test_all_meet_at_the_end_of_a_tick_without_much_shorter_steps(steps):
    tick = tick_of(steps)
    assert tick <= max(1 / 30, max(steps)) * (1 + 1e-9)
    taken = [tick / steps_for(tick, step) for step in steps]
    assert all(step >= own * (1 - 1e-9) for step, own in zip(steps, taken, strict=True))
    if max(steps) < 1 / 60:
        assert all(own > 0.95 * step for step, own in zip(steps, taken, strict=True))


def test_a_sweep_records_each_rope_of_a_race():
    scene = raced("Euler against RK4 against leapfrog", 0.5)
    found = measures(scene)
    assert found["error_1"].value > found["error_2"].value > 0.0
    assert set(found) == {f"{what}_{n}" for what in ("error", "taken", "h_omega") for n in (1, 2, 3)}
    assert "tip_height" in measures(Scene(Params()))
