"""Ropes that touch themselves, lie over the sphere, are knotted, held at both ends, or carry a weight."""

import dataclasses
import math
from typing import Any

import numpy as np
import pytest

from app.messages import GrabTo, Place, Release
from app.scenes.rope.parameters import PRESETS, RopeParams
from app.scenes.rope.scene import RopeScene, build, needs, warm_up, warm_up_on_use
from app.scenes.rope.student_rope import left_out
from app.scenes.rope.view import solver_text
from app.scenes.springs.net_motion import rope_lengths
from benchmarks.knots import determinant
from sim.parameters import check_record, parameters_of
from sim.springs.statics import hanging_chain

Rope: Any = RopeScene  # whose types the tests know
STARTS = parameters_of(RopeParams)["start"].choices


def scene_of(preset: str, **changes: object) -> RopeScene:
    return Rope(check_record(RopeParams, {**PRESETS[preset], **changes}))


def run(scene: RopeScene, seconds: float) -> None:
    for _ in range(round(60 * seconds)):
        scene.advance(round(1 / 60 / scene.step))


def points_of(scene: RopeScene) -> np.ndarray:
    return scene.state.x[:, 0].T


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize("points", [10, 80, 300])
def test_links_begin_at_their_length_in_every_shape(start: str, points: int) -> None:
    """Except the chords of an arc, which are a little shorter."""
    net = build(check_record(RopeParams, {"start": start, "points": points, "length": 4.0}))
    lengths = np.linalg.norm(np.diff(net.x0[:, 0]), axis=0)
    rest = net.families[0].rest
    assert (lengths < rest * (1.0 + 1e-9)).all()
    assert lengths.mean() > rest * (0.7 if points == 10 else 0.99)


def test_a_rope_that_begins_over_the_sphere_touches_it_over_half_a_turn() -> None:
    scene = scene_of("Capstan")
    run(scene, 1.0)
    sphere = scene.net.sphere
    assert sphere is not None
    x, y, z, radius = sphere
    distance = np.linalg.norm(points_of(scene) - (x, y, z), axis=1) - radius - scene.net.radius
    over = points_of(scene)[:, 2] > z + 0.1
    assert np.abs(distance[over]).max() < 0.01
    friction = scene.params.friction
    assert scene.capstan_ratios(sphere)[-1] == pytest.approx(math.exp(math.pi * friction), rel=0.02)


def test_as_it_slips_over_the_sphere_friction_takes_what_exp_mu_theta_says() -> None:
    """The root goes up at 20 mm/s, so that the rope follows the weight slowly."""
    scene = scene_of("Capstan", friction=0.3)
    run(scene, 1.0)
    x, y, z = scene.handles.home
    ratios = []
    for step in range(180):
        scene.handle(Place("root", (x, y, z + 0.02 * step / 60)))
        run(scene, 1 / 60)
        curves = scene.curves()
        assert curves is not None
        _, tension, most = curves["plot_along"]
        ratios.append(float(tension[-1] / most[-1]))
    assert np.mean(ratios[90:]) == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("pull", ["root", "end"])
def test_a_knot_is_pulled_tight_by_either_end_and_stays(pull: str) -> None:
    scene = scene_of("Knot")
    run(scene, 0.5)
    last = scene.params.points - 1
    for _ in range(2):  # there and back, as fast as a hand is
        for place in ((2.0, 0.0, 3.0), (0.0, 0.0, 3.0)):
            at = place if pull == "root" else (-1.5 - place[0], 0.0, 3.0)
            scene.handle(Place("root", at) if pull == "root" else GrabTo(last, at, 1))
            run(scene, 1.0)
            held = points_of(scene)[0 if pull == "root" else last]
            assert held == pytest.approx(at, abs=1e-3)
            assert determinant(points_of(scene)) == 3


def test_a_held_end_is_at_rest_after_a_drag_and_in_a_resumed_run() -> None:
    scene = scene_of("Knot")
    last = scene.params.points - 1
    run(scene, 0.2)
    before, kept = points_of(scene)[last].copy(), scene.keep()
    scene.handle(GrabTo(last, (-2.0, 0.5, 2.5), 1))
    run(scene, 1.0)
    scene.handle(Release(1))
    run(scene, 0.5)
    assert points_of(scene)[last] == pytest.approx((-2.0, 0.5, 2.5), abs=1e-9)
    assert not scene.state.v[:, 0, last].any()
    scene.resume(kept)
    run(scene, 0.5)
    assert points_of(scene)[last] == pytest.approx(before, abs=1e-9)


@pytest.mark.parametrize("name", ["implicit_euler", "tr_bdf2"])
def test_a_knot_holds_at_the_step_of_a_frame_and_the_panel_counts_what_did_not_settle(name: str) -> None:
    scene = scene_of("Knot", integrator=name, time_step=1 / 60)
    run(scene, 0.5)
    scene.handle(Place("root", (1.2, 0.0, 3.0)))
    run(scene, 1.5)
    assert determinant(points_of(scene)) == 3
    scene.assess_stability()
    report, cost = scene.stability.solver, scene.stability.cost
    assert cost is not None
    assert (report.steps, report.unsettled) == (120, scene.state.unsettled)
    text = f"the solver had not settled in {report.unsettled} of 120 steps: use a smaller time step"
    assert (text in solver_text(report)) is (report.unsettled > 0)
    scene.change_forces(dataclasses.replace(scene.params, integrator="leapfrog", time_step=1 / 960))
    run(scene, 0.1)
    scene.assess_stability()
    assert scene.stability.solver == (96, 0, 0, False)


def test_beside_a_students_rope_only_what_the_tasks_have_is_there() -> None:
    params = check_record(RopeParams, {"self_contact": True, "end_held": True, "tip_mass": 2.0, "units": "material"})
    net = build(params, of_tasks=True)
    assert (net.thickness, net.mass_ratios, net.pinned) == (0.0, None, frozenset({(0, 0)}))
    words = " ".join(left_out(params))
    assert all(name in words for name in ("Touches itself", "End held", "Weight at the tip", "Mass per metre"))
    assert left_out(RopeParams()) == ()


@pytest.mark.parametrize("weight", [0.0, 0.5, 20.0])
def test_a_weight_stretches_every_link(weight: float) -> None:
    net = dataclasses.replace(build(check_record(RopeParams, {"tip_mass": weight})), floor=None)
    length, stretch = rope_lengths(net)
    hanging = hanging_chain(net).x[:, 2]
    assert hanging[0] - hanging[-1] == pytest.approx(length + stretch, rel=1e-9)
    link = net.families[0]
    below = weight + net.mass * np.arange(1, net.shape[1])
    assert stretch == pytest.approx((below * 10.0 / link.stiffness).sum(), rel=1e-9)


def test_what_a_rope_that_touches_itself_needs_is_compiled_on_use() -> None:
    for law in ("spring", "slack"):
        names = needs(check_record(RopeParams, {"self_contact": True, "law": law}))
        assert set(names) <= set(warm_up_on_use())
        assert not set(names) & set(warm_up())
