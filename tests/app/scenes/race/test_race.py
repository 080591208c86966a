"""The race scene without a browser."""

import dataclasses
import itertools
import json
import math
import re
from typing import Any

import numpy as np
import pytest

from app.commands.run import run_to_file
from app.formats import formatting
from app.messages import GrabTo, Place, Release
from app.render.markup.html import ERROR_COLOUR
from app.render.markup.line_chart import line_chart
from app.scenes.contract import FRAME_INTERVAL
from app.scenes.quantities import measured
from app.scenes.race import SCENE
from app.scenes.race.charts import ERROR_TICKS, MAX_ROWS, RaceCharts, round_up
from app.scenes.race.entrants import tick_of
from app.scenes.race.html import results_table
from app.scenes.race.parameters import PRESETS, RaceParams, hidden
from app.scenes.race.scene import RaceScene, compile_gauge
from app.scenes.race.view import LABEL_SHARE, SHOWN_ASPECT, RaceView, label_heights, shown_height
from app.scenes.rope.parameters import RopeParams
from app.scenes.rope.scene import RopeScene
from app.scenes.springs.methods import method_name
from app.scenes.springs.rope_handles import offset_of
from app.scenes.springs.rope_parameters import ROOT, build_rope
from app.server.loop.sim_loop import SimLoop
from sim.frames import steps_for
from sim.parameters import check_record, effect_of_change, parameters_of
from sim.springs import simulate
from sim.springs.analysis.reference_run import (
    ATOL,
    HORIZON_SEPARATION,
    MAX_EVALUATION_RATE,
    RTOL,
    ReferenceRun,
    too_costly,
)  # fmt: skip

RaceOf: Any = RaceScene  # whose types the tests know
Loop: Any = SimLoop  # of a scene whose types the tests know

ALIKE = {"integrator": "leapfrog", "integrator_3": "symplectic_euler", "time_step": 1 / 60, "race_steps": "same step"}


def race(**changes) -> Any:
    """A race of ropes at one step."""
    return RaceOf(RaceParams(**{**ALIKE, **changes}))


def change(scene: RaceScene, **changes: object) -> None:
    """Change parameters as the simulation loop does, by what they affect."""
    params = dataclasses.replace(scene.params, **changes)
    Loop(scene, paused=True).runs.take(params, effect_of_change(scene.params, params))


def run(scene: RaceScene, seconds: float) -> None:
    """In frames of about 1/60 s, as the lab does."""
    ticks = max(1, round(1 / 60 / scene.step))
    for _ in range(round(seconds / (ticks * scene.step))):
        scene.advance(ticks)


def raced(preset: str, seconds: float, **others) -> Any:
    scene = RaceOf(dataclasses.replace(check_record(RaceParams, PRESETS[preset]), **others))
    run(scene, seconds)
    return scene


@pytest.mark.parametrize("preset", PRESETS)
def test_every_race_runs_and_is_shown(preset):
    scene = raced(preset, 2.0)
    frame = scene.frame()
    assert frame.ropes.shape == (scene.params.ropes, scene.params.points, 3)
    assert np.isfinite(frame.ropes).all()
    assert np.abs(frame.ropes).max() < 12.0
    assert frame.references.shape == frame.ropes.shape
    assert len(frame.labels) == len(set(frame.labels)) == scene.params.ropes
    words = results_table(scene.readings())
    assert all(method_name(rope.integrator) in words for rope in scene.readings().results)
    for rope in scene.readings().results:  # force evaluations a second
        assert f">{formatting.number(round(rope.evals / rope.step))}<" in words
    charts = scene.curves()
    for chart in charts.values():
        assert len(chart.columns) == len(chart.lines) + 1
        assert len({len(column) for column in chart.columns}) == 1
    assert len(charts["plot_errors"].columns[0]) > 30


@pytest.mark.parametrize(("preset", "held"), [("Euler at rising stiffness", 2), ("RK4 at the same values", 5)])
def test_ropes_over_their_limit_diverge_and_the_others_go_on(preset, held):
    scene = raced(preset, 5.0)
    assert scene.time == pytest.approx(5.0)
    for number, rope in enumerate(scene.readings().results, 1):
        over = rope.gauge.h_omega > rope.gauge.limit
        assert over == (number > held) == bool(rope.failure)
        if over:
            assert rope.failure.startswith("diverged at ")
            assert f"step is too long (hω {rope.gauge.h_omega:.2f} of {rope.gauge.limit:.2f})" in rope.failure
            assert np.isnan(rope.error)
        else:
            assert rope.error < 0.1


def test_a_rope_races_as_it_would_alone():
    scene = raced("RK4 at the same values", 2.0)
    entrant = scene.race.entrants[2]
    alone = simulate(
        dataclasses.replace(entrant.net, x0=entrant.net.x0), duration=2.0, frames=2, step=entrant.step, integrator="rk4"
    )
    np.testing.assert_allclose(entrant.state.x[:, 0].T, alone.x[-1], atol=1e-12)


@pytest.mark.parametrize("damping", [7.0, 0.0])
def test_the_reference_run_is_as_accurate_as_its_separation_says(damping):
    """Against an eighth-order method at a tolerance a thousand times finer."""
    params = RaceParams(damping=damping, drag=damping / 7.0, floor=False)
    net = build_rope(params)
    reference = ReferenceRun(net, params.length)
    truth = simulate(net, duration=4.0, frames=241, integrator="dop853", rtol=1e-13, atol=1e-15)
    for frame in range(1, 241):
        reference.advance(net, (frame - 1) / 60, 1 / 60)
        assert np.linalg.norm(reference.x.T - truth.x[frame], axis=1).max() < 3.0 * reference.separation


def test_the_error_shown_is_the_distance_from_the_truth():
    scene = raced("Euler against RK4 against leapfrog", 2.0)
    truth = simulate(build_rope(scene.params), duration=2.0, frames=2, integrator="dop853", rtol=1e-12, atol=1e-14).x[
        -1
    ]
    for entrant, rope in zip(scene.race.entrants, scene.readings().results, strict=True):
        error = np.linalg.norm(entrant.state.x[:, 0].T - truth, axis=1).max()
        assert rope.error == pytest.approx(error, abs=rope.error_floor)
        assert rope.error > rope.error_floor


def test_half_the_step_shows_the_order_of_the_leapfrogs():
    scene = raced("Leapfrog read literally", 1.5)
    chart = scene.curves()["plot_errors"]
    errors = np.nanmean(chart.columns[2:], axis=1)  # the start has none
    assert [rope.integrator for rope in scene.readings().results] == ["leapfrog"] * 2 + ["leapfrog_lagged"] * 2
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)
    assert errors[2] / errors[3] == pytest.approx(2.0, rel=0.1)


def test_equal_cost_is_equal_force_evaluations_a_second():
    scene = raced("Undamped until chaos", 1.0)
    assert scene.params.race_steps == "same cost"
    each = [
        entrant.state.force_evals / entrant.state.t
        for entrant in scene.race.entrants
        if entrant.integrator != "leapfrog"
    ]
    np.testing.assert_allclose(each, 960.0, rtol=0.05)


def test_chaos_ends_the_undamped_reference_run_and_the_chart_is_shaded_from_there():
    scene = raced("Undamped until chaos", 1.0)
    assert scene.readings().reference_horizon is None
    while scene.readings().reference_horizon is None and scene.time < 60.0:
        scene.advance(8)
    lost = scene.readings().reference_horizon
    assert 2.0 < lost < 60.0
    assert scene.race.references[0].separation > HORIZON_SEPARATION * scene.params.length
    assert scene.frame().references is None
    run(scene, 0.5)
    chart = scene.curves()["plot_errors"]
    t, zone = chart.columns[:2]
    assert (zone[t > lost + 0.05] > 10.0).all()
    assert (zone[t < lost - 0.05] < 10.0).all()
    assert all(np.isnan(rope.error_floor) for rope in scene.readings().results)
    assert "Chaotic after t =" in results_table(scene.readings())
    scene.reset()
    assert scene.readings().reference_horizon is None
    assert scene.frame().references is not None


def test_damping_keeps_the_reference():
    assert raced("Euler against RK4 against leapfrog", 12.0).readings().reference_horizon is None


def test_a_reference_run_that_is_too_expensive_is_left_out_and_says_so():
    scene = race(ropes=2, points=1000, stiffness=1e9, integrator="implicit_euler", integrator_2="tr_bdf2")
    scene.advance(2)
    assert "too many for ropes of 1000 points" in scene.readings().no_reference
    assert scene.frame().references is None
    assert all(not rope.failure and np.isnan(rope.error) for rope in scene.readings().results)
    assert "There is no reference run" in results_table(scene.readings())


def test_a_reference_run_may_be_too_expensive_by_its_damping_alone():
    """Where damping limits the step, the estimated cost is the actual one of the two runs to a factor of two."""
    net, duration = build_rope(RopeParams(points=10, damping=7000.0)), 0.1
    taken = simulate(net, duration=duration, frames=2, integrator="dopri5", rtol=RTOL, atol=ATOL).force_evals
    most = MAX_EVALUATION_RATE / (2 * taken * 10 / duration)  # references
    assert too_costly(net, round(0.5 * most)) == ""
    assert "too many for ropes of 10 points" in too_costly(net, round(2.0 * most))


def test_a_method_that_takes_no_damping_fails_at_once():
    scene = race(ropes=2, integrator_2="pefrl")
    run(scene, 0.5)
    first, second = scene.readings().results
    assert (first.failure, second.failure) == (
        "",
        "allows no damping: set damping and air drag to 0, and switch the floor off",
    )
    assert f'style="color:{ERROR_COLOUR}">{second.failure}<' in results_table(scene.readings())
    assert scene.time == pytest.approx(0.5)


def test_a_rope_whose_method_takes_no_damping_stops_where_the_net_becomes_damped():
    scene = race(ropes=2, integrator="rk4", integrator_2="pefrl", damping=0.0, drag=0.0, floor=False, time_step=1 / 960)
    run(scene, 0.2)
    assert [result.failure for result in scene.readings().results] == ["", ""]
    change(scene, damping=3.0)
    stopped = scene.frame().ropes[1]
    run(scene, 0.2)
    first, second = scene.readings().results
    assert (first.failure, second.failure.partition(":")[0]) == ("", "allows no damping")
    np.testing.assert_array_equal(scene.frame().ropes[1], stopped)
    assert scene.time == pytest.approx(0.4)


def test_all_ropes_may_fail_and_the_clock_goes_on():
    scene = race(ropes=2, integrator="explicit_euler", integrator_2="explicit_euler", stiffness=5e4)
    run(scene, 2.0)
    assert all(rope.failure for rope in scene.readings().results)
    assert scene.time == pytest.approx(2.0)
    assert scene.frame().references is not None


def test_numerical_dissipation_is_told_from_the_ropes_own_damping():
    """Without damping, all energy that is lost is lost by the method: implicit Euler, not leapfrog or PEFRL."""
    alike = {"damping": 0.0, "drag": 0.0, "floor": False, "time_step": 1 / 480}
    scene = race(ropes=3, integrator="implicit_euler", integrator_2="leapfrog", integrator_3="pefrl", **alike)
    run(scene, 1.5)
    euler, leapfrog, pefrl = scene.readings().results
    assert euler.numerical_dissipation > 1.0
    assert euler.numerical_dissipation == pytest.approx(
        scene.race.entrants[0].account.initial.total - scene.race.entrants[0].stored_energy()
    )
    assert abs(leapfrog.numerical_dissipation) < 0.1
    assert abs(pefrl.numerical_dissipation) < 1e-4
    assert (leapfrog.corrections, pefrl.corrections) == (0.0, 0.0)
    assert 1.0 <= euler.corrections < 10.0


def test_other_methods_start_the_race_again_and_other_forces_do_not():
    scene = race(ropes=2)
    run(scene, 0.5)
    change(scene, damping=3.0)
    assert scene.time == pytest.approx(0.5)
    run(scene, 0.5)
    assert scene.readings().results[0].error < 1e-2
    for changes in ({"integrator_2": "leapfrog"}, {"stiffness_ratio": 2.0}, {"ropes": 3}, {"time_step": 0.01}):
        change(scene, **changes)
        assert scene.time == 0.0
        run(scene, 0.2)


def test_every_parameter_that_starts_the_race_again_says_so():
    """The parameters on which the ropes are compared."""
    named = {f"{what}_{number}" for what in ("integrator", "step") for number in range(2, 7)}
    first = {"ropes", "points", "length", "units", "integrator", "time_step", "race_steps", "stiffness_ratio"}
    declared = parameters_of(RaceParams).items()
    assert {name for name, parameter in declared if parameter.affects == "start"} == first | named


def test_a_change_of_forces_is_booked_as_work_and_no_method_is_charged_with_it():
    scene = race(ropes=2, integrator="rk4", integrator_2="pefrl", damping=0.0, drag=0.0, floor=False, time_step=1 / 960)
    run(scene, 0.5)
    initial = [entrant.account.initial for entrant in scene.race.entrants]
    before = [entrant.stored_energy() for entrant in scene.race.entrants]
    taken = [result.numerical_dissipation for result in scene.readings().results]
    change(scene, stiffness=1200.0, gravity=6.0, mass=0.7)
    jumps = [entrant.stored_energy() - old for entrant, old in zip(scene.race.entrants, before, strict=True)]
    assert min(map(abs, jumps)) > 1.0
    assert [result.numerical_dissipation for result in scene.readings().results] == pytest.approx(taken, abs=1e-10)
    assert [entrant.account.initial for entrant in scene.race.entrants] == initial
    run(scene, 0.5)
    assert all(abs(result.numerical_dissipation) < 1e-4 for result in scene.readings().results)


def test_a_change_of_look_costs_nothing_and_leaves_the_accounts_alone():
    """Bit for bit the same as in a race that is left alone."""
    alone, changed = race(ropes=2, speed=2.0), race(ropes=2, speed=2.0)
    loops = [Loop(scene, clock=lambda: 0.0, effort=lambda: 0.0) for scene in (alone, changed)]
    looks = (
        {"grid": False},
        {"spacing": 1.0},
        {"show_reference": False},
        {"plot_errors": False},
        {"show_points": False},
    )
    for frame in range(60):
        if frame % 10 == 5:
            loops[1].runs.take(dataclasses.replace(changed.params, **looks[frame // 10 % len(looks)]), "look")
        for loop in loops:
            loop.tick(FRAME_INTERVAL)
    for one, other in zip(alone.race.entrants, changed.race.entrants, strict=True):
        assert np.array_equal(one.state.x, other.state.x)
        assert (one.state.dissipated, one.state.work) == (other.state.dissipated, other.state.work)
        assert one.state.force_evals == other.state.force_evals
        assert one.numerical_dissipation() == other.numerical_dissipation()


def test_a_drag_of_one_rope_pulls_all_alike_and_the_reference_run_too():
    scene = race(ropes=3, integrator="rk4", integrator_2="rk4", integrator_3="rk4", spacing=0.5)
    run(scene, 3.0)
    bead = scene.frame().ropes[2, 6]
    scene.handle(GrabTo(2 * 10 + 6, (bead[0] + 0.6, bead[1] + 0.4, bead[2])))
    run(scene, 0.5)
    assert scene.frame().grab.particle == 26
    xs = [entrant.state.x for entrant in scene.race.entrants]
    np.testing.assert_array_equal(xs[0], xs[1])
    np.testing.assert_array_equal(xs[0], xs[2])
    assert scene.frame().ropes[2, 6, 0] > bead[0] + 0.2
    assert scene.frame().ropes[2, 6, 1] > bead[1] + 0.1
    assert scene.readings().results[0].error < 1e-3
    scene.handle(Release())
    assert scene.frame().grab is None


@pytest.mark.parametrize(
    "changes", [*PRESETS.values(), {"ropes": 1}, {"ropes": 6, "spacing": 2.0}, {"length": 10.0}, {"length": 0.5}]
)
def test_the_first_view_shows_the_whole_fall_of_all_ropes_and_their_labels(changes):
    """The ropes of the reference runs: one that gains energy by its method may leave the picture."""
    params = check_record(RaceParams, changes)
    scene = RaceOf(params)
    corners = [scene.frame().ropes.reshape(-1, 3)]
    for _ in range(30):
        run(scene, 0.1)
        corners.append(scene.frame().references.reshape(-1, 3))
    position, target = np.array(RaceView.first_view(object.__new__(RaceView), params))
    ahead = (target - position) / np.linalg.norm(target - position)
    right = np.cross(ahead, (0.0, 0.0, 1.0)) / np.hypot(*ahead[:2])
    row = LABEL_SHARE * shown_height(params)
    for number, height in enumerate(label_heights(params.ropes)):
        corners.append([(0.0, offset_of(number, params.ropes, params.spacing), ROOT[2] + row * (height + 1.0))])
    seen = np.concatenate(corners) - position
    reach = np.tan(0.5 * RaceView.FIELD_OF_VIEW) * (seen @ ahead)
    assert (abs(seen @ right) < SHOWN_ASPECT * reach).all()
    assert (abs(seen @ np.cross(right, ahead)) < reach).all()


@pytest.mark.parametrize(("count", "rows"), [(1, [0]), (2, [0, 0]), (3, [0, 1, 0]), (6, [0, 1, 2, 2, 1, 0])])
def test_no_two_labels_of_a_side_have_one_height(count, rows):
    heights = label_heights(count)
    np.testing.assert_allclose(heights - heights[0], rows)


def test_labels_say_what_differs():
    assert RaceOf(RaceParams()).frame().labels == (
        "1: explicit Euler, 1/240 s",
        "2: Runge-Kutta 4, 1/60 s",
        "3: leapfrog, 1/240 s",
    )
    assert raced("RK4 at the same values", 0.0).frame().labels[:2] == ("1: 160 N/m", "2: 400 N/m")
    assert RaceOf(RaceParams(ropes=1)).frame().labels == ("1: explicit Euler",)


def test_nets_are_made_anew_only_where_something_moves_or_other_forces_act():
    scene = RaceScene(RaceParams(stiffness_ratio=2.0))

    def nets(ticks=1):
        scene.advance(ticks)
        return scene.moving_nets[1]

    first = nets()
    assert nets() is first
    scene.handle(GrabTo(5, (0.5, 0.0, 0.5)))
    assert nets() is not first
    assert nets()[0].grab is not None
    scene.handle(Release())
    nets()
    kept, rest = scene.keep(), nets()
    assert nets() is rest
    scene.change_forces(dataclasses.replace(scene.params, stiffness=2.0 * scene.params.stiffness))
    assert [net.families[0].stiffness for net in nets()] == [2.0 * net.families[0].stiffness for net in rest]
    scene.resume(kept)
    assert [net.families[0].stiffness for net in nets()] == [net.families[0].stiffness for net in rest]


def test_the_first_view_of_one_rope_is_as_high_as_its_distance_shows():
    params = RaceParams(ropes=1)
    position, target = np.array(RaceView.first_view(object.__new__(RaceView), params))
    height = 2.0 * math.tan(0.5 * RaceView.FIELD_OF_VIEW) * np.linalg.norm(target - position)
    assert height == pytest.approx(shown_height(params))


def test_all_ropes_look_equally_large_from_the_front():
    params = RaceParams(ropes=6)
    position, target = np.array(RaceView.first_view(object.__new__(RaceView), params))
    ahead = (target - position) / np.linalg.norm(target - position)
    depths = [
        (np.array([0.0, offset_of(number, params.ropes, params.spacing), ROOT[2]]) - position) @ ahead
        for number in range(6)
    ]
    assert max(depths) / min(depths) < 1.05
    swing = np.array([1.0, 0.0, 0.0])  # the direction in which ropes swing is seen at full length, within 3 %
    assert np.linalg.norm(np.cross(ahead, swing)) > 0.97


def test_all_roots_follow_the_same_arrows():
    scene = race(ropes=2, integrator="rk4")
    scene.handle(Place("root", (0.3, 0.2, 3.4)))
    run(scene, 2.0)
    for entrant in scene.race.entrants:
        np.testing.assert_allclose(entrant.state.x[:, 0, 0], (0.3, 0.2, 3.4), atol=1e-12)
    np.testing.assert_allclose(scene.race.references[0].x[:, 0], (0.3, 0.2, 3.4), atol=1e-12)
    roots = scene.frame().ropes[:, 0]
    np.testing.assert_allclose(roots[1] - roots[0], (0.0, scene.params.spacing, 0.0), atol=1e-6)
    assert scene.readings().results[0].error < 1e-3


def test_the_charts_of_a_race_clip_no_value_without_a_mark():
    """An energy error that grows slowly is drawn as it is; what a diverging rope adds at its end has a cross."""
    scene = race(ropes=2, points=2)
    charts = RaceCharts(scene.race)
    n = 200
    t = np.arange(n) / 30.0
    slow = np.linspace(0.0, 3.0 * charts.max_energy, n)
    fast = 1e-3 * 1.2 ** np.arange(n)
    errors = np.concatenate((1e-12 * np.ones(n // 2), np.geomspace(1e-12, 1e4, n - n // 2)))
    charts.rows[:n] = np.array([t, 1e-9 * np.ones(n), errors, slow, errors, fast]).T
    charts.rows[n - 2 : n, 5] = math.nan
    charts.count = n
    scene.race.entrants[1].failure = "diverged: too long a step"
    for name, chart in charts.charts().items():
        assert chart.numbers is not None
        crosses = [i for i, line in enumerate(chart.lines) if line.cross]
        at = [int(np.flatnonzero(np.isfinite(chart.columns[1 + i]))[0]) for i in crosses]
        for line, drawn, value in zip(chart.lines, chart.columns[1:], chart.numbers, strict=True):
            if line.cross or line.fill or value is None:
                continue
            known = np.isfinite(value) & (t > 0.0)
            differs = known & ~(drawn == value)
            low = differs & np.isfinite(drawn)
            assert (drawn[low] == ERROR_TICKS[0][0]).all()
            cut = np.flatnonzero(differs & np.isnan(drawn))
            assert not cut.size or any(place <= cut[0] for place in at), name
    energies = charts.charts()["plot_energies"]
    np.testing.assert_array_equal(energies.columns[1], slow)
    assert np.nanmax(energies.columns[2]) <= charts.max_energy
    assert [line.label for line in energies.lines if line.cross] == ["2: diverged"]
    assert [line.label for line in charts.charts()["plot_errors"].lines if line.cross] == [
        "1: beyond 10 m",
        "2: diverged",
    ]
    assert ERROR_TICKS[0][1].startswith("≤")


def test_a_long_race_keeps_fewer_rows_but_those_of_its_start():
    scene = race(ropes=2, points=2)
    scene.charts = charts = RaceCharts(scene.race)
    charts.row_interval = 1e-9
    assert all(chart.columns[0].size == 0 for chart in charts.charts().values())
    for _ in range(2 * MAX_ROWS + 10):
        scene.race.advance(scene.race.nets_with(scene.net), 1)
        charts.update()
    t = charts.charts()["plot_errors"].columns[0]
    assert MAX_ROWS / 2 <= len(t) <= MAX_ROWS
    assert t[0] == pytest.approx(scene.step)
    assert (np.diff(t) > 0).all()
    assert charts.charts() is charts.charts()


@pytest.mark.parametrize(
    "name", [name for name, parameter in parameters_of(RaceParams).items() if parameter.group in ("Main", "Time")]
)
def test_both_ends_of_every_race_parameter_survive(name):
    parameter = parameters_of(RaceParams)[name]
    ends = parameter.choices or ((False, True) if parameter.kind is bool else (parameter.low, parameter.high))
    for value in ends:
        scene = race(**{name: value if parameter.choices else parameter.kind(value)})
        steps = int(np.clip(round(1 / 60 / scene.step), 1, 100))
        for _ in range(20):
            scene.advance(steps)
        assert np.isfinite(scene.frame().ropes).all()
        assert np.isfinite(scene.race.points()).all()


@pytest.mark.parametrize(("ratio", "shown"), [(1.0, []), (4.0, ["800 N/m", "3200 N/m"])])
def test_the_table_tells_the_stiffness_of_each_rope_where_two_differ(ratio, shown):
    words = results_table(race(ropes=2, stiffness=800.0, stiffness_ratio=ratio).readings())
    assert re.findall(r"\d+ N/m", re.sub(r"(?<=\d)\s(?=\d)", "", words)) == shown


def test_a_step_takes_as_long_as_the_shortest_of_a_few_timings():
    """On a clock that each evaluation moves by 1 ms, and some disturbance by more."""
    entrant = race(ropes=1).race.entrants[0]
    ticks, disturbances = [0.0], itertools.cycle((0.0, 0.0, 0.3, 0.2, 0.1, 0.1))
    take = entrant.take_steps

    def noted(net, state, steps, **more):
        ticks[0] += 1e-3 * steps + next(disturbances)
        take(net, state, steps, **more)

    entrant.take_steps, entrant.clock, entrant.step_time = noted, lambda: ticks[0], 0.0
    assert entrant.timed_step() == pytest.approx(1e-3)


def test_parameters_that_mean_nothing_are_hidden():
    three = hidden(RaceParams())
    assert {"integrator_4", "step_2", "axial_stiffness"} <= three
    assert not {"integrator_3", "plot_errors", "stiffness_ratio"} & three
    assert "step_2" not in hidden(RaceParams(race_steps="own steps"))
    assert {"race_steps", "stiffness_ratio", "spacing", "integrator_2"} <= hidden(RaceParams(ropes=1))


def test_a_race_runs_to_a_file(tmp_path, capsys):
    params = race(ropes=2, integrator="explicit_euler", integrator_2="rk4").params
    assert run_to_file("race", SCENE, params, 1.0, 30.0, tmp_path / "race.npz") == 0
    capsys.readouterr()
    file = np.load(tmp_path / "race.npz")
    assert file["x"].shape == (31, 2, 10, 3)
    assert file["reference"].shape == (31, 1, 10, 3)
    error = np.linalg.norm(file["x"][:, 1] - file["reference"][:, 0], axis=2).max(axis=1)
    np.testing.assert_allclose(file["error"][:, 1], error)
    assert "m" in json.loads(str(file["about"]))["units"]["separation"]


@pytest.mark.parametrize(("t", "end"), [(0.1, 2.0), (2.0, 2.0), (2.1, 5.0), (10.0, 10.0), (11.0, 20.0), (99.0, 100.0)])
def test_the_charts_end_at_a_round_time(t, end):
    assert round_up(t) == pytest.approx(end)


@pytest.mark.parametrize("steps", [[0.1, 0.03], [1 / 60] * 6, [1e-5, 0.1], [1 / 240, 3 / 960, 4 / 960], [0.01, 0.007]])
def test_all_ropes_meet_at_the_end_of_a_tick_with_steps_that_are_hardly_shorter(steps):
    tick = tick_of(steps)
    assert tick <= max(1 / 30, max(steps)) * (1 + 1e-9)
    taken = [tick / steps_for(tick, step) for step in steps]
    assert all(step >= own * (1 - 1e-9) for step, own in zip(steps, taken, strict=True))
    if max(steps) < 1 / 60:
        assert all(own > 0.95 * step for step, own in zip(steps, taken, strict=True))


def test_a_sweep_records_each_rope_of_a_race():
    scene = raced("Euler against RK4 against leapfrog", 0.5)
    found = {name: one for name, one in measured(SCENE, scene).items() if not math.isnan(one.value)}
    assert found["error_1"].value > found["error_2"].value > 0.0
    assert set(found) == {f"{what}_{n}" for what in ("error", "numerical_dissipation", "h_omega") for n in (1, 2, 3)}


def test_the_gauge_is_compiled_ahead_as_it_is_called():
    compile_gauge(RaceOf(RaceParams()).race.entrants[0].net)


def test_all_roots_swing_as_the_root_of_a_rope_does():
    scene = race(ropes=2, root_swing=0.3, swing_period=0.7)
    rope = RopeScene(RopeParams(root_swing=0.3, swing_period=0.7, time_step=scene.race.tick))
    for _ in range(60):
        scene.advance(1)
        rope.advance(1)
        for entrant in scene.race.entrants:
            np.testing.assert_allclose(entrant.state.x[:, 0, 0], rope.state.x[:, 0, 0], atol=1e-9)
    assert rope.state.x[0, 0, 0] != ROOT[0]


def test_the_curves_of_a_rope_that_has_diverged_end_and_a_cross_says_when():
    scene = SCENE.make(check_record(RaceParams, {**PRESETS["Shaken at the root"], "time_step": 1 / 60}))
    while not scene.race.entrants[0].failure:
        scene.advance(1)
    scene.advance(20)
    for name, chart in scene.curves().items():
        columns = dict(zip([line.label for line in chart.lines], chart.columns[1:], strict=True))
        numbers = dict(zip([line.label for line in chart.lines], chart.numbers, strict=True))
        said = f"1: {scene.race.entrants[0].failure.partition(':')[0]}"
        errors = columns[method_label := next(label for label in columns if label.startswith("1 "))]
        end = 1 + int(np.flatnonzero(np.isnan(errors[1:]))[0])  # an error begins after the start
        assert np.isnan(errors[end:]).all()
        lost = 1 + int(np.flatnonzero(np.isnan(numbers[method_label][1:]))[0])
        assert np.isnan(numbers[method_label][lost:]).all()
        assert lost >= end  # files have the last numbers of a divergence, too
        assert np.isfinite(errors[1:end]).all()
        assert np.flatnonzero(np.isfinite(columns[said])).tolist() == [end]
        assert numbers[said] is None  # a mark, no number for files
        svg = line_chart(name, chart.first, chart.lines, chart.columns, chart.end, SCENE.curves[name].ticks).svg
        assert svg.count("m0 -10l-10 10") == 2 * sum(line.cross for line in chart.lines)  # in the chart and in its key
