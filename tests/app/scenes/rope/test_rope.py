"""The rope scene without a browser."""

import contextlib
import dataclasses
import html
import math
import re
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest

from app.messages import GrabTo, Place, Release, finite_vector
from app.render.markup.html import ERROR_COLOUR, GOOD_COLOUR, WARNING_COLOUR, WRONG_COLOUR, coloured
from app.scenes.contract import FRAME_INTERVAL
from app.scenes.quantities import measured
from app.scenes.rope import SCENE
from app.scenes.rope.parameters import PRESETS, RopeParams
from app.scenes.rope.scene import FULL_RATE_SPEED, QUARTER_RATE_SPEED, RopeScene
from app.scenes.springs.divergence import (
    divergence_text,
    holding_step,
    leapfrog_alternative,
    short_divergence_text,
)
from app.scenes.springs.drawing.html import stability_bar, step_mark
from app.scenes.springs.drawing.ropes_view import bead_radius
from app.scenes.springs.net_motion import rope_lengths
from app.scenes.springs.rope_parameters import ROOT, ROPE_RADIUS, SPHERE
from app.scenes.springs.speed_advice import held, step_warnings
from app.scenes.springs.tracking import CriticallyDampedTracker
from app.server.loop.sim_loop import SimLoop
from sim.parameters import check_record, effect_of_change, parameters_of
from sim.springs import INTEGRATORS
from sim.springs.analysis.extremes import extremes
from sim.springs.stability import Gauge
from sim.springs.state import velocities
from sim.springs.statics import hanging_chain
from sim.validation import DivergenceError

Rope: Any = RopeScene  # whose types the tests know
Loop: Any = SimLoop  # of a scene whose types the tests know


def run(scene: RopeScene, frames: int, steps: int) -> None:
    for _ in range(frames):
        scene.advance(steps)


def change(scene: RopeScene, **changes: object) -> None:
    """Change parameters as the simulation loop does, by what they affect."""
    params = dataclasses.replace(scene.params, **changes)
    Loop(scene, paused=True).runs.take(params, effect_of_change(scene.params, params))


@pytest.mark.parametrize("preset", [name for name in PRESETS if name != "Euler explodes"])
def test_every_preset_runs(preset: str) -> None:
    scene = Rope(check_record(RopeParams, PRESETS[preset]))
    run(scene, 180, max(1, round(1 / 60 / scene.step)))
    frame = scene.frame()
    assert np.isfinite(frame.points).all()
    assert np.abs(frame.points).max() < 20


def test_explicit_euler_at_the_labs_defaults_explodes_and_the_reason_is_given() -> None:
    scene = Rope(RopeParams(integrator="explicit_euler"))
    with pytest.raises(
        DivergenceError,
        match=r"explicit Euler \(hω 0.93 of 0.51; h: the step, .*\). Use a time step up to 1/111 s \(9 ms\) or leap",
    ):
        run(scene, 600, 1)
    assert np.isfinite(scene.frame().points).all()
    scene.reset()
    change(scene, integrator="leapfrog")
    scene.advance(60)


def test_the_diagnosed_step_holds() -> None:
    scene = Rope(RopeParams(integrator="explicit_euler"))
    holds = scene.readings().stability.critical_step
    scene = Rope(RopeParams(integrator="explicit_euler", time_step=0.8 * holds))
    for _ in range(500):
        scene.advance(10)


def test_the_rope_comes_to_rest_as_the_exact_chain() -> None:
    scene = Rope(RopeParams(drag=5.0))
    for _ in range(300):
        scene.advance(10)
    np.testing.assert_allclose(scene.state.x[2, 0], hanging_chain(scene.net)[0][:, 2], atol=1e-6)


def test_the_root_follows_where_it_is_placed() -> None:
    scene = Rope(RopeParams())
    scene.handle(Place("root", (0.3, -0.2, 3.5)))
    for _ in range(120):
        scene.advance(1)
    np.testing.assert_allclose(scene.state.x[:, 0, 0], (0.3, -0.2, 3.5), atol=1e-12)
    assert (scene.state.v[:, 0, 0] == 0).all()


def test_a_link_lies_on_a_small_sphere_within_a_fifth_of_its_tube() -> None:
    """Of 0.22 m, on a sphere of 0.05 m: points alone would pass on both sides of it."""
    params = RopeParams(sphere=True, sphere_radius=0.05, contact_stiffness=2e4, time_step=1 / 2000)
    scene = Rope(params)
    scene.handles.sphere.place_at((-1.0, 0.0, 3.0 - 0.05 - ROPE_RADIUS))  # below the middle of the fifth link
    scene.change_forces(params)
    assert scene.net.links_touch
    depths = []
    for _ in range(60):
        scene.advance(10)
        points = scene.frame().points.astype(float)
        line = points[4] + np.linspace(0.0, 1.0, 400)[:, None] * (points[5] - points[4])
        gap = np.linalg.norm(line - scene.handles.sphere.position, axis=1).min() - 0.05
        depths.append(1.0 - gap / ROPE_RADIUS)  # of the tube's radius
    assert points[-1, 2] < 2.7  # the rest falls
    assert points[4:6, 2].max() > 2.9
    assert 0.0 < max(depths) < 0.2


def test_a_reset_puts_root_and_sphere_back() -> None:
    scene = Rope(RopeParams(sphere=True))
    scene.handle(Place("root", (0.0, 0.0, -90.0)))
    scene.handle(Place("sphere", (1.0, 2.0, 3.0)))
    with pytest.raises(DivergenceError):
        run(scene, 600, 1)
    scene.reset()
    assert tuple(scene.state.x[:, 0, 0]) == ROOT
    assert scene.handles.sphere.position == SPHERE
    assert scene.handles.at_rest
    run(scene, 600, 1)


def test_a_pull_is_capped() -> None:
    scene = Rope(RopeParams(pull=50.0, gravity=0.0, drag=2.0, floor=False))
    scene.handle(GrabTo(9, (-50.0, 0.0, 3.0)))
    for _ in range(600):
        scene.advance(1)
    # A taut rope pulled by 50 N in line with it stretches by F/k a link, root to held point.
    stretched = np.linalg.norm(scene.state.x[:, 0, 9] - np.array(ROOT))
    assert stretched == pytest.approx(2.0 + 9 * 50.0 / 800.0, rel=1e-3)
    assert scene.frame().grab is not None
    assert scene.frame().grab.load == 1.0
    scene.handle(Release())
    assert scene.frame().grab is None


@pytest.mark.parametrize("particle", [-1, 10, 10**9])
def test_grabbing_what_is_not_there_does_nothing(particle: int) -> None:
    scene = Rope(RopeParams())
    scene.handle(GrabTo(particle, (0.0, 0.0, 0.0)))
    assert scene.handles.grab.grabbed is None
    scene.advance(5)


@pytest.mark.parametrize(
    "name",  # each law has a kernel of its own, which takes seconds to compile
    [pytest.param(name, marks=pytest.mark.long if name == "law" else ()) for name in parameters_of(RopeParams)],
)
def test_both_ends_of_every_parameter_survive_two_seconds(name: str) -> None:
    parameter = parameters_of(RopeParams)[name]
    ends = parameter.choices or ((False, True) if parameter.kind is bool else (parameter.low, parameter.high))
    for value in ends:
        value = value if parameter.choices else parameter.kind(value)
        scene = Rope(dataclasses.replace(RopeParams(), **{name: value}))
        steps = int(np.clip(round(1 / 60 / scene.step), 1, 200))
        with contextlib.suppress(DivergenceError):  # an end may be unstable; what was good is kept
            run(scene, 120, steps)
        assert np.isfinite(scene.frame().points).all()
        assert np.isfinite(scene.frame().tension).all()


def test_changing_the_points_keeps_the_shape() -> None:
    scene = Rope(RopeParams())
    scene.advance(40)
    before = scene.state.x.copy()
    change(scene, points=19)
    np.testing.assert_allclose(scene.state.x[:, :, ::2], before, atol=1e-12)
    scene.advance(10)


def test_a_student_s_rope_begins_again_with_other_points_or_another_method() -> None:
    scene: Any = RopeScene(RopeParams())
    scene.student = Mock()
    for change, begins in (({"stiffness": 500.0}, 0), ({"points": 14}, 1), ({"integrator": "rk4"}, 2)):
        scene.change_forces(dataclasses.replace(scene.params, **change))
        assert scene.student.begin.call_count == begins, change
    assert scene.student.begin.call_args.args[0].shape == (14, 3)


def test_every_integrator_can_be_chosen_while_moving() -> None:
    scene = Rope(RopeParams())
    for name in parameters_of(RopeParams)["integrator"].choices:
        change(scene, integrator=name, time_step=1 / 400)
        scene.advance(20)
        assert np.isfinite(scene.frame().points).all()
        assert (scene.motion.integrator == name) == (scene.readings().note == "")


def test_where_the_chosen_method_takes_no_damping_another_runs_and_the_note_says_so() -> None:
    scene = Rope(RopeParams(integrator="pefrl"))
    scene.advance(10)
    assert scene.motion.integrator == "leapfrog"
    assert "pefrl allows no damping, so leapfrog runs" in scene.readings().note
    change(scene, damping=0.0, drag=0.0, floor=False)
    scene.advance(10)
    assert (scene.motion.integrator, scene.readings().note) == ("pefrl", "")


def test_plots_are_recorded_while_closed_with_a_small_error_and_begin_anew_with_a_reset() -> None:
    scene = Rope(RopeParams(time_step=1 / 600, integrator="rk4"))
    scene.take_plot_rows()
    for _ in range(60):
        scene.advance(10)
    rows = np.array(scene.take_plot_rows())
    assert len(rows) >= 25
    total, parts, error = rows[:, 1], rows[:, 2:6], rows[:, 7]
    np.testing.assert_allclose(total, parts.sum(axis=1), atol=1e-12)
    assert np.abs(error).max() < 1e-4
    assert total[-1] < total[0] - 10.0
    scene.reset()
    assert scene.take_plot_rows() == ()  # those before it are gone


def test_the_tracker_is_exact_for_any_frame_interval() -> None:
    fine, coarse = CriticallyDampedTracker((0.0, 0.0, 0.0)), CriticallyDampedTracker((0.0, 0.0, 0.0))
    for follower, parts in ((fine, 64), (coarse, 2)):
        follower.target = (1.0, -2.0, 0.5)
        for _ in range(parts):
            follower.advance(0.0, 0.2 / parts)
    np.testing.assert_allclose(fine.position, coarse.position, atol=1e-12)
    # (1 + r t) exp(-r t) of a jump remains.
    remains = (1 + 25 * 0.2) * np.exp(-25 * 0.2)
    assert fine.position[0] == pytest.approx(1 - remains)


@pytest.mark.parametrize("values", [None, "abc", (1, 2), (1, 2, float("nan")), (1, 2, float("inf")), (1, 2, 3, 4)])
def test_values_that_are_not_three_finite_numbers_give_none(values: Any) -> None:
    assert finite_vector(values) is None


def test_far_vectors_are_bounded() -> None:
    assert finite_vector((1e9, -1e9, 1)) == (100.0, -100.0, 1.0)


def test_frames_come_less_often_the_slower_the_rope_is() -> None:
    scene = Rope(RopeParams())
    assert scene.frame_interval == FRAME_INTERVAL  # just released: how fast it will be is not known
    scene.advance(2)
    assert np.abs(scene.state.v).max() < FULL_RATE_SPEED
    assert scene.frame_interval == 2 * FRAME_INTERVAL
    scene.advance(10)
    assert scene.frame_interval == FRAME_INTERVAL
    run(scene, 600, 2)
    assert np.abs(scene.state.v).max() < QUARTER_RATE_SPEED
    assert scene.frame_interval == 4 * FRAME_INTERVAL
    change(scene, plot_tip=True)
    assert scene.frame_interval == 2 * FRAME_INTERVAL  # a plot has a row for each frame
    change(scene, gravity=5.0)
    assert scene.frame_interval == FRAME_INTERVAL  # how fast it will be is not known
    scene.advance(1)
    assert scene.frame_interval == 2 * FRAME_INTERVAL
    scene.handle(GrabTo(5, (0.0, 0.0, 2.0)))
    assert scene.frame_interval == FRAME_INTERVAL
    scene.handle(Release())
    scene.handle(Place("root", (0.5, 0.0, 3.0)))
    assert scene.frame_interval == FRAME_INTERVAL


LOOKS = (
    {"grid": False}, {"colour": "plain"}, {"speed": 2.0}, {"show_points": False}, {"plot_energy": True},
    {"plot_tip": True}, {"speed": 0.7, "plot_energy": False}, {"speed": 1.0},
)  # fmt: skip


@pytest.mark.parametrize("integrator", ["leapfrog", "rk4", "leapfrog_lagged"])
def test_a_change_of_look_leaves_the_energy_account_alone_bit_for_bit(integrator: str) -> None:
    """Compared where both have taken the same number of steps, as another speed takes other steps in a frame."""
    params = RopeParams(integrator=integrator, time_step=1 / 480)
    alone, changed = Rope(params), Rope(params)
    loops = [Loop(scene, clock=lambda: 0.0, effort=lambda: 0.0) for scene in (alone, changed)]
    accounts: list[dict[int, tuple[float, ...]]] = [{}, {}]
    for frame in range(90):
        if frame % 10 == 5:
            loops[1].runs.take(dataclasses.replace(changed.params, **LOOKS[frame // 10 % len(LOOKS)]), "look")
        for loop, account in zip(loops, accounts, strict=True):
            loop.tick(FRAME_INTERVAL)
            scene, state = loop.scene, loop.scene.state
            error = scene.motion.energy_error()
            account[state.steps] = (state.dissipated, state.work, *scene.motion.account.initial, error)
    assert changed.params != alone.params
    common = accounts[0].keys() & accounts[1].keys()
    assert len(common) > 30
    assert all(accounts[0][steps] == accounts[1][steps] for steps in common)
    assert alone.state.dissipated > 1.0


def test_a_change_of_look_costs_no_stability_check(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = Rope(RopeParams())
    scene.advance(2)
    monkeypatch.setattr("app.scenes.rope.scene.top_modes", None)  # a call would fail
    monkeypatch.setattr("app.scenes.springs.net_motion.gauge", None)
    for look in LOOKS:
        change(scene, **look)


def test_a_rope_at_rest_is_not_assessed_again():
    def assessed(**changes: Any) -> int:
        scene = Rope(RopeParams(**changes))
        moments = {scene.assessed_at}  # [s]
        while scene.time < 2.0:
            scene.advance(round(1 / 60 / scene.step))
            moments.add(scene.assessed_at)
        return len(moments) - 1

    assert assessed(gravity=0.0) == 0
    assert assessed() in (3, 4)
    scene = Rope(RopeParams(gravity=0.0))
    for moved, has_news in ((0.9e-3, False), (1.1e-3, True)):  # of a link
        scene.state.x[2, 0, -1] = scene.assessed_x[2, 0, -1] + moved * scene.net.families[0].rest
        assert scene.has_news() is has_news
    # The corrections of an implicit method may change at any time.
    assert assessed(gravity=0.0, integrator="tr_bdf2") > 0


CHANGES = (
    {"stiffness": 2000.0}, {"gravity": 4.0}, {"mass": 2.5}, {"contact_stiffness": 3000.0}, {"length": 2.4},
    {"points": 19}, {"damping": 0.5}, {"units": "material"}, {"floor": False},
)  # fmt: skip


@pytest.mark.parametrize("changes", CHANGES, ids=lambda changes: next(iter(changes)))
def test_a_change_of_forces_is_booked_as_work_and_not_as_an_error(changes: dict[str, object]) -> None:
    scene = Rope(RopeParams(integrator="rk4", time_step=1 / 4800))
    run(scene, 60, 80)
    state, initial, before = scene.state, scene.motion.account.initial, scene.motion.energy_error()
    stored, dissipated, work = scene.motion.stored_energy(), state.dissipated, state.work
    change(scene, **changes)
    jump = scene.motion.stored_energy() - stored
    assert (scene.motion.account.initial, state.dissipated) == (initial, dissipated)
    assert state.work == work + jump
    assert scene.motion.energy_error() == pytest.approx(before, abs=1e-10)
    if set(changes) & {"stiffness", "gravity", "mass"}:
        assert abs(jump) > 1.0
    run(scene, 60, 80)
    assert abs(scene.motion.energy_error()) < 1e-4
    assert scene.state.dissipated > dissipated


def test_another_method_goes_on_with_the_same_account() -> None:
    scene = Rope(RopeParams(time_step=1 / 2400))
    run(scene, 30, 40)
    initial = scene.motion.account.initial
    dissipated = scene.state.dissipated
    change(scene, integrator="implicit_euler")
    assert (scene.motion.account.initial, scene.state.dissipated) == (initial, dissipated)
    cost = scene.readings().cost
    assert cost.numerical_dissipation == cost.damping_dissipation == 0.0  # counted from here
    run(scene, 30, 40)
    change(scene, stiffness=900.0)
    assert scene.readings().cost.numerical_dissipation > 0.01


def test_the_cost_of_a_method_does_not_count_the_steps_of_the_one_before() -> None:
    """RK4 computes the forces four times a step, and has no corrections."""
    scene = Rope(RopeParams(integrator="rk4", time_step=1 / 240))
    run(scene, 30, 4)
    change(scene, integrator="implicit_midpoint")
    assert scene.readings().cost.corrections == 0.0  # it has taken no step yet
    evals, steps = scene.state.force_evals, scene.state.steps
    run(scene, 40, 4)
    scene.assess_stability()
    before = (scene.state.force_evals - evals) / (scene.state.steps - steps)
    assert 1.0 <= scene.readings().cost.corrections < 4.0
    assert scene.readings().cost.corrections == pytest.approx(before, abs=0.5)


@pytest.mark.parametrize("name", [name for name, record in INTEGRATORS.items() if record.implicit])
def test_the_stiffest_rope_holds_with_every_implicit_method(name: str) -> None:
    """1e9 N/m at the lab's own step: in bounds for ten seconds, at a bounded cost that is shown."""
    scene = Rope(RopeParams(integrator=name, stiffness=1e9))
    most_evals = 0.0
    for _ in range(600):
        before = scene.state.force_evals
        scene.advance(1)
        most_evals = max(most_evals, scene.state.force_evals - before)
        assert np.linalg.norm(scene.state.x[:, 0].T - ROOT, axis=1).max() < 2.01
    assert most_evals <= 60
    cost = scene.readings().cost
    assert 1.0 <= cost.corrections <= 25.0
    assert cost.damping_dissipation > 0.0
    before = scene.state.force_evals
    scene.advance(1)
    evals = scene.state.force_evals - before
    assert scene.readings().cost.corrections == evals - {"tr_bdf2": 1}.get(name, 0)
    if name == "implicit_euler":
        assert cost.numerical_dissipation > 0.1 * cost.damping_dissipation
    assert Rope(RopeParams()).readings().cost is None


def test_the_root_swings_about_where_it_was_put_and_comes_to_rest_again() -> None:
    scene = Rope(RopeParams(root_swing=0.3, swing_period=2.0, time_step=1 / 240))
    places = []
    for _ in range(240):
        scene.advance(4)
        places.append(scene.state.x[:, 0, 0].copy())
    x, y, z = np.array(places[60:]).T
    assert x.max() == pytest.approx(ROOT[0] + 0.3, rel=0.03)
    assert x.min() == pytest.approx(ROOT[0] - 0.3, rel=0.03)
    assert (np.ptp(y), np.ptp(z)) == (0.0, 0.0)
    assert scene.frame().root == ROOT
    scene.params = dataclasses.replace(scene.params, root_swing=0.0)
    scene.advance(480)
    assert scene.handles.at_rest
    assert tuple(scene.state.x[:, 0, 0]) == ROOT


def test_a_sweep_records_the_tip_of_the_rope_and_nothing_dissipated_at_the_start() -> None:
    scene = Rope(RopeParams())
    assert measured(SCENE, scene)["dissipated_energy"].value == measured(SCENE, scene)["energy_error"].value == 0.0
    run(scene, 30, 2)
    found = {name: measure.value for name, measure in measured(SCENE, scene).items()}
    assert found["tip_height"] == scene.state.x[2, 0, 9] < scene.state.x[2, 0, 1]
    assert found["tip_speed"] == np.linalg.norm(velocities(scene.net, scene.state)[:, 0, 9]) > 0.1


def test_the_line_under_the_time_step_names_the_largest_that_is_stable() -> None:
    assert step_mark(0.0123) == "limit 1/82 s (12 ms)"
    # The last figures change all the time while a rope swings.
    assert step_mark(1 / 163) == step_mark(1 / 164) == "limit 1/170 s (5.9 ms)"
    assert [held(69_300.0), held(69_400.0), held(0.0), held(math.inf)] == [69_000.0, 69_000.0, 0.0, math.inf]
    assert step_mark(0.0) == "no step is stable with this method"
    assert step_mark(math.inf) == step_mark(math.inf, math.inf) == "every step is stable"
    assert step_mark(0.0123, 0.0123) == "limit 1/82 s (12 ms), right below it"
    assert step_mark(0.0123, 1 / 163) == "limit 1/82 s (12 ms), right up to 1/170 s (5.9 ms)"
    assert step_mark(math.inf, 1 / 163) == "every step is stable, right up to 1/170 s (5.9 ms)"
    assert step_mark(0.0123, 0.0) == "limit 1/82 s (12 ms), right at no step"
    assert step_mark(0.0123, 0.0123, 0.0122) == step_mark(0.0123, 0.0123)
    in_contact = "limit 1/82 s (12 ms), right below it; in contact about 1/170 s (5.9 ms)"
    assert step_mark(0.0123, 0.0123, 1 / 163) == in_contact


@pytest.mark.parametrize(
    ("h_omega", "share", "colour"), [(1.5, 75, GOOD_COLOUR), (1.7, 85, WARNING_COLOUR), (2.1, 105, ERROR_COLOUR)]
)
def test_the_stability_bar_has_the_step_in_the_colour_of_its_verdict(h_omega: float, share: int, colour: str) -> None:
    bar = stability_bar(Gauge(h_omega / 1e-3, 0.0, h_omega, 2.0, 2e-3, 1e-3 * h_omega, h_omega / 1e-3))
    assert coloured(f"{share}\u00a0%", colour) in bar
    assert f"width:{min(50.0 * h_omega, 100.0):.0f}%;background:{colour}" in bar
    assert "right" not in share_and_verdict(bar)  # where accuracy is not assessed, nothing is said of it


def share_and_verdict(bar: str) -> str:
    """The line over the bar, as it is read."""
    line = bar[: bar.index('<span class="springtide-info"')]
    return html.unescape(re.sub("<[^>]*>", "", line)).replace("\xa0", " ").strip()


STEP_OF_1_MS = Gauge(1e3, 0.1, 1.0, 2.0, 2e-3, 1e-3, 1e3, 2e-3, 0.003)


def test_a_step_that_is_right_is_told_from_one_that_is_only_stable() -> None:
    right = stability_bar(STEP_OF_1_MS)
    assert share_and_verdict(right) == "Step: 50 % of the largest stable, right to 1 %"
    assert GOOD_COLOUR in right
    assert 'class="wrong"' not in right
    wrong = stability_bar(STEP_OF_1_MS._replace(accurate_step=5e-4, error=0.034, accurate_method="implicit_midpoint"))
    assert share_and_verdict(wrong) == "Step: 50 % of the largest stable, 3.4 % off"
    assert wrong.count(WRONG_COLOUR) == 3  # two words and the bar
    assert '<div class="wrong" style="left:25%"></div>' in wrong  # hatched from there, not by colour alone
    assert "<div>Right: implicit midpoint at this step.</div>" in wrong
    unstable = STEP_OF_1_MS._replace(critical_step=8e-4, accurate_step=5e-4, error=0.034)
    assert 'class="wrong"' not in stability_bar(unstable)


def test_of_a_method_without_a_limit_the_bar_shows_where_it_is_right() -> None:
    gauge = STEP_OF_1_MS._replace(limit=math.inf, critical_step=math.inf, accurate_step=5e-4, error=1.7)
    bar = stability_bar(gauge)
    assert share_and_verdict(bar) == "Step: any is stable, more than 100 % off"
    assert f"width:100%;background:{WRONG_COLOUR}" in bar
    assert 'style="left:50%"' in bar
    assert share_and_verdict(stability_bar(gauge._replace(accurate_step=math.inf, error=0.0))).endswith("right to 1 %")


def test_of_an_unstable_step_nothing_else_is_said() -> None:
    bar = stability_bar(STEP_OF_1_MS._replace(step=3e-3, error=0.5, accurate_step=1e-3))
    assert share_and_verdict(bar) == "Step: 150 % of the largest stable"
    assert WRONG_COLOUR not in bar


def test_a_step_that_is_too_long_only_in_contact_is_told_before_the_net_lands() -> None:
    rk4, gauge = INTEGRATORS["rk4"], STEP_OF_1_MS._replace(landed_step=9.1e-4)
    told = "in contact with floor or sphere, where about 1/1100 s (910 µs) is stable"
    bar = stability_bar(gauge)
    assert f"Too long {told}." in bar
    assert WARNING_COLOUR in bar
    assert GOOD_COLOUR not in bar
    assert step_warnings(rk4, gauge) == [
        f"The time step of 1/1000 s (1 ms) is stable with Runge-Kutta 4 now, but too long {told}."
    ]
    assert divergence_text(1.0, rk4, 1e-3, gauge, "").endswith(f"but too long {told}.")
    assert "its step is too long" in short_divergence_text(1.0, gauge)
    advice = holding_step(1e-3, gauge)
    assert advice is not None
    assert advice.value == 1 / 1920
    for harmless in (STEP_OF_1_MS, STEP_OF_1_MS._replace(landed_step=1.1e-3), gauge._replace(critical_step=9.5e-4)):
        assert told not in stability_bar(harmless)


def test_the_panel_says_what_limits_a_step_that_only_damping_limits() -> None:
    """The mode nearest to the limit is not stiff; leapfrog's limit is that of the stiffest, 2/50 s."""
    gauge = Gauge(0.0, math.inf, 0.0, 0.0, 1e-3, 2e-3, 50.0)
    assert "The worst of the last 5 s: damping alone limits it." in stability_bar(gauge)
    assert "200\u00a0%" in stability_bar(gauge)
    assert leapfrog_alternative(INTEGRATORS["rk4"], gauge) == "leapfrog with one up to 1/25 s (40 ms)"
    text = divergence_text(1.0, INTEGRATORS["rk4"], 2e-3, gauge, "")
    assert "200\u00a0% of the largest stable one for Runge-Kutta 4 (damping alone limits it)" in text


@pytest.mark.parametrize("points", [2, 10, 60])
def test_the_length_at_which_a_rope_hangs_is_that_of_the_exact_chain(points: int) -> None:
    net = Rope(RopeParams(points=points)).net
    length, stretch = rope_lengths(net)
    assert length == pytest.approx(2.0, rel=1e-12)
    assert length + stretch == pytest.approx(ROOT[2] - hanging_chain(net)[0][-1, 2], rel=1e-9)


def test_a_rope_has_left_its_bounds_at_three_times_the_length_it_hangs_at() -> None:
    scene = Rope(RopeParams(floor=False))
    start = extremes(scene.state.x, scene.state.v).reach
    assert scene.motion.max_reach == pytest.approx(4.0 + 3.0 * 2.5625 + start)  # the lab's ten points hang 2.56 m deep


def test_beads_are_as_large_in_every_direction_of_the_rope() -> None:
    """They are made once for a number of points: level at a start, in any shape when a run comes back."""
    along = np.array([1.0, 0.0, 0.0]), np.array([1.0, 1.0, 1.0]) / math.sqrt(3.0)
    level, slanted = (bead_radius(0.05 * np.outer(np.arange(40), direction), ROPE_RADIUS) for direction in along)
    assert level == pytest.approx(0.4 * 0.05, rel=1e-12)
    assert slanted == pytest.approx(level, rel=1e-12)
