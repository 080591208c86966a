"""The rope scene without a browser."""

import contextlib
import dataclasses

import numpy as np
import pytest

from app.messages import DivergenceError, Grab, Place, Release, finite_vector
from app.scenes.contract import FRAME_INTERVAL
from app.scenes.rope.scene import PRESETS, ROOT, SLOW, SWIFT, Params, Scene
from sim.parameters import check_record, parameters_of
from sim.springs.statics import hanging_chain
from sim.springs.tracking import CriticallyDampedTracker


def run(scene: Scene, frames: int, steps: int) -> None:
    for _ in range(frames):
        scene.advance(steps)


@pytest.mark.parametrize("preset", [name for name in PRESETS if name != "Euler explodes"])
def test_every_preset_runs(preset: str) -> None:
    scene = Scene(check_record(Params, PRESETS[preset]))
    frame = max(1, round(1 / 60 / scene.step))
    for _ in range(180):
        scene.advance(frame)
    picture = scene.frame()
    assert np.isfinite(picture.points).all()
    assert np.abs(picture.points).max() < 20


def test_explicit_euler_at_the_labs_defaults_explodes_and_the_reason_is_given() -> None:
    scene = Scene(Params(integrator="explicit_euler"))
    with pytest.raises(DivergenceError, match=r"h ω = .* over explicit_euler's limit.* s would hold"):
        run(scene, 600, 1)
    assert np.isfinite(scene.frame().points).all()
    scene.reset()
    scene.set_params(Params())
    scene.advance(60)


def test_the_diagnosed_step_holds() -> None:
    scene = Scene(Params(integrator="explicit_euler"))
    holds = scene.readings().stability.critical_step
    scene = Scene(Params(integrator="explicit_euler", time_step=0.8 * holds))
    for _ in range(500):
        scene.advance(10)


def test_the_rope_comes_to_rest_as_the_exact_chain() -> None:
    scene = Scene(Params(drag=5.0))
    for _ in range(300):
        scene.advance(10)
    np.testing.assert_allclose(scene.state.x[2, 0], hanging_chain(scene.net)[0][:, 2], atol=1e-6)


def test_the_root_follows_where_it_is_placed() -> None:
    scene = Scene(Params())
    scene.handle(Place("root", (0.3, -0.2, 3.5)))
    for _ in range(120):
        scene.advance(1)
    np.testing.assert_allclose(scene.state.x[:, 0, 0], (0.3, -0.2, 3.5), atol=1e-12)
    assert (scene.state.v[:, 0, 0] == 0).all()


def test_a_rope_lost_in_the_floor_starts_from_home_again() -> None:
    scene = Scene(Params())
    scene.handle(Place("root", (0.0, 0.0, -90.0)))
    scene.reset()
    with pytest.raises(DivergenceError):
        run(scene, 600, 1)
    scene.reset()
    assert tuple(scene.state.x[:, 0, 0]) == ROOT
    run(scene, 600, 1)


def test_a_pull_is_capped() -> None:
    scene = Scene(Params(pull=50.0, gravity=0.0, drag=2.0, floor=False))
    scene.handle(Grab(9, (-50.0, 0.0, 3.0)))
    for _ in range(600):
        scene.advance(1)
    # A taut rope pulled by 50 N in line with it stretches by F/k a link, root to held point.
    stretched = np.linalg.norm(scene.state.x[:, 0, 9] - np.array(ROOT))
    assert stretched == pytest.approx(2.0 + 9 * 50.0 / 800.0, rel=1e-3)
    assert scene.frame().pull is not None
    assert scene.frame().pull.load == 1.0
    scene.handle(Release())
    assert scene.frame().pull is None


@pytest.mark.parametrize("particle", [-1, 10, 10**9])
def test_grabbing_what_is_not_there_does_nothing(particle: int) -> None:
    scene = Scene(Params())
    scene.handle(Grab(particle, (0.0, 0.0, 0.0)))
    assert scene.held is None
    scene.advance(5)


@pytest.mark.parametrize("name", list(parameters_of(Params)))
def test_both_ends_of_every_parameter_survive_two_seconds(name: str) -> None:
    parameter = parameters_of(Params)[name]
    ends = parameter.choices or ((False, True) if parameter.kind is bool else (parameter.low, parameter.high))
    for value in ends:
        value = value if parameter.choices else parameter.kind(value)
        scene = Scene(dataclasses.replace(Params(), **{name: value}))
        steps = int(np.clip(round(1 / 60 / scene.step), 1, 200))
        with contextlib.suppress(DivergenceError):  # an end may be unstable; what was good is kept
            run(scene, 120, steps)
        assert np.isfinite(scene.frame().points).all()
        assert np.isfinite(scene.frame().tension).all()


def test_changing_the_points_keeps_the_shape() -> None:
    scene = Scene(Params())
    scene.advance(40)
    before = scene.state.x.copy()
    scene.set_params(Params(points=19))
    np.testing.assert_allclose(scene.state.x[:, :, ::2], before, atol=1e-12)
    scene.advance(10)


def test_every_integrator_can_be_chosen_while_moving() -> None:
    scene = Scene(Params())
    for name in parameters_of(Params)["integrator"].choices:
        scene.set_params(Params(integrator=name, time_step=1 / 400))
        scene.advance(20)
        assert np.isfinite(scene.frame().points).all()
        assert (scene.integrator.name == name) == (scene.readings().note == "")


def test_where_the_chosen_method_refuses_damping_another_runs_and_says_so() -> None:
    scene = Scene(Params(integrator="pefrl"))
    scene.advance(10)
    assert scene.integrator.name == "leapfrog"
    assert "pefrl takes no damping, so leapfrog runs" in scene.readings().note
    scene.set_params(Params(integrator="pefrl", damping=0.0, drag=0.0, floor=False))
    scene.advance(10)
    assert (scene.integrator.name, scene.readings().note) == ("pefrl", "")


def test_the_energy_plots_error_is_small_and_reset_leaves_a_gap() -> None:
    scene = Scene(Params(plot_energy=True, time_step=1 / 600, integrator="rk4"))
    scene.take_plot_rows()
    for _ in range(60):
        scene.advance(10)
    rows = np.array(scene.take_plot_rows())
    assert len(rows) >= 25
    assert np.abs(rows[:, 6]).max() < 1e-4
    scene.reset()
    assert np.isnan(scene.take_plot_rows()[0][0])


def test_nothing_is_sampled_with_the_plots_off() -> None:
    scene = Scene(Params())
    scene.take_plot_rows()
    scene.advance(60)
    assert scene.take_plot_rows() == ()


def test_the_follower_is_exact_whatever_the_frame() -> None:
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
def test_what_is_no_vector_is_none(values: object) -> None:
    assert finite_vector(values) is None


def test_far_vectors_come_within_reach() -> None:
    assert finite_vector((1e9, -1e9, 1)) == (100.0, -100.0, 1.0)


def test_pictures_come_less_often_the_slower_the_rope_is():
    scene = Scene(Params())
    assert scene.frame == FRAME_INTERVAL  # just let go: how fast it will be is not known
    scene.advance(2)
    assert np.abs(scene.state.v).max() < SWIFT
    assert scene.frame == 2 * FRAME_INTERVAL
    scene.advance(10)
    assert scene.frame == FRAME_INTERVAL
    run(scene, 600, 2)
    assert np.abs(scene.state.v).max() < SLOW
    assert scene.frame == 4 * FRAME_INTERVAL
    plotted = dataclasses.replace(scene.params, plot_tip=True)
    scene.set_params(plotted)
    assert scene.frame == FRAME_INTERVAL  # gravity may be another
    scene.advance(1)
    assert scene.frame == 2 * FRAME_INTERVAL  # a plot has a row for each picture
    scene.handle(Grab(5, (0.0, 0.0, 2.0)))
    assert scene.frame == FRAME_INTERVAL
    scene.handle(Release())
    scene.handle(Place("root", (0.5, 0.0, 3.0)))
    assert scene.frame == FRAME_INTERVAL
