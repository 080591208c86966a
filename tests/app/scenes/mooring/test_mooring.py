"""The mooring scene: its statics, what the panel says of tension and slack, drags, and the restoring curve."""

import dataclasses
import math
import random
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from app.formats.formatting import largest_force
from app.messages import GrabTo, Place, Release, vector_of
from app.scenes import scene_named
from app.scenes.contract import Advice
from app.scenes.mooring.arrangement import (
    DENSITY,
    body_of,
    build,
    first_places,
    hull_of,
    line_types,
    sea_of,
    surface_heights,
    surface_side,
)
from app.scenes.mooring.body_scene import MooringScene
from app.scenes.mooring.drawing.bed_view import BED_ROWS, bed_colours
from app.scenes.mooring.line_scene import FADE
from app.scenes.mooring.parameters import PRESETS, MooringParams
from app.scenes.mooring.readings.excursion import MAX_PATH, PATH_INTERVAL
from app.scenes.mooring.readings.report import BED, TENSIONS, notes_of
from app.scenes.mooring.readings.tensions import Tensions
from app.scenes.mooring.start import NO_REST
from app.scenes.mooring.view import MooringView
from app.server.loop.sim_loop import SimLoop
from sim.mooring import critical_step
from sim.mooring.rest import balance, interior
from sim.parameters import Parameter, check_record, parameters_of
from sim.validation import ConvergenceError, DivergenceError
from tests.sim.mooring.catenary import catenary

SMALL: dict[str, Any] = {"segments": 12, "lines": 1, "steady_force": 10.0, "time_step": 1 / 120}


def run(scene: MooringScene, seconds: float) -> None:
    for _ in range(round(seconds / scene.step / 4)):
        scene.advance(4)


def test_a_frame_turns_the_body_as_its_state_and_draws_the_watch_circle_about_its_place_of_rest():
    scene = MooringScene(MooringParams(**SMALL))
    turn = np.array([0.3, -0.2, 0.6])  # a rotation vector [rad] of length 0.7
    scene.state.x[:, scene.system.node_count + 1] = turn
    scene.excursion.rest = np.array([3.0, -1.0, 0.0])
    frame = scene.frame()
    np.testing.assert_allclose(frame.rotation, [math.cos(0.35), *(math.sin(0.35) * turn / 0.7)], atol=1e-6)
    assert frame.rest == (3.0, -1.0, 0.0)


def test_the_mouse_pulls_with_its_largest_force_at_most_and_says_so() -> None:
    scene = MooringScene(MooringParams(**SMALL, pull=0.5))
    weight = scene.params.density * hull_of(scene.params).volume * 9.81
    for away, is_at_limit in ((0.01, False), (1e3, True)):
        scene.handle(GrabTo(0, vector_of(scene.body_place() + (away, 0.0, 0.0))))
        pull = scene.frame().grab
        assert pull is not None
        assert pull.place == vector_of(scene.body_place())
        assert pull.limit == largest_force(0.5 * weight)
        assert (pull.load == 1.0) is is_at_limit
        force = (scene.driven()["steady"] - scene.system.kernel_view(scene.step).steady)[0]
        np.testing.assert_allclose(force, [0.5 * weight * pull.load, *[0.0] * 5], rtol=1e-6, atol=1e-3)
        assert force[0] > 0.0


@pytest.mark.parametrize("preset", PRESETS)
def test_every_preset_rests_runs_and_stays_within_its_stable_step(preset):
    scene = MooringScene(check_record(MooringParams, PRESETS[preset]))
    assert scene.step < scene.stability.critical_step
    run(scene, 1.0)
    found = scene.readings()
    assert all(line.at_fairlead.largest > 0.0 for line in found.lines)
    assert found.most_offset < 1.0


def test_the_rest_is_that_of_the_catenary():
    scene = MooringScene(MooringParams(wave_height=0.0))
    p, fairlead = scene.params, scene.points[0, -1]
    weight = (p.line_mass - DENSITY * line_types(p)[0].volume) * 9.81
    found = catenary(
        p.length, p.axial_stiffness, weight, float(np.hypot(*(fairlead - scene.points[0, 0])[:2])),
        float(fairlead[2] + p.depth),
    )  # fmt: skip
    reading = scene.readings().lines[0]
    assert reading.fairlead == pytest.approx(found.tension(np.array([p.length]))[0], rel=3e-3)
    assert reading.anchor == pytest.approx(found.horizontal, rel=0.01)
    assert reading.lying == pytest.approx(found.lying, abs=2.0 * p.length / p.segments)
    assert reading.uplift == 0.0


def test_without_waves_it_stays_at_rest_and_with_them_the_touchdown_wanders():
    scene = MooringScene(MooringParams(**SMALL, wave_height=0.0))
    run(scene, 5.0)
    assert scene.excursion.largest < 1e-3
    waves = MooringScene(MooringParams(**SMALL, wave_height=6.0, regular=True))
    lying = []
    run(waves, FADE)
    for _ in range(40):
        run(waves, 0.25)
        lying.append(waves.lying()[0])
    assert np.ptp(lying) > 0.0


def test_the_drawn_water_is_the_water_that_moves_the_lines():
    params = MooringParams(wave_height=4.0, direction=30.0)
    sea = sea_of(params)
    assert sea is not None
    place, t = np.array([[12.0, -7.0, 0.0]]), 3.3
    flow = sea.kinematics(place, t)
    # Linear waves: dz/dt is the upward velocity at the surface.
    h = 1e-4
    rise = (sea.elevation(place[:, :2], t + h) - sea.elevation(place[:, :2], t - h)) / (2.0 * h)
    drawn = surface_heights(params, sea, t, 0.5)
    axis = np.linspace(-0.5, 0.5, len(drawn)) * surface_side(params)
    wanted = 0.5 * sea.elevation(np.column_stack([axis, np.full_like(axis, axis[5])]), t)
    assert drawn[:, 5] == pytest.approx(wanted, abs=0.01)
    assert flow.velocity[0, 2] == pytest.approx(rise[0], rel=1e-5)
    assert 4.0 * math.sqrt(0.5 * float(np.square(sea.amplitude).sum())) == pytest.approx(4.0, rel=0.02)


def test_slack_is_counted_and_dated():
    """Wherever along a line a segment is slack: here the middle one of the first line."""
    tensions = Tensions(2)
    for t, one in ((0.5, 5.0), (1.0, 0.0), (1.5, 0.0), (2.0, 8.0)):
        at_anchor, at_fairlead = (
            np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 2.0]]),
            np.array([[one, 0.0, 0.0], [3.0, 0.0, 0.0]]),
        )
        tensions.measure(t, np.array([[1.0, one, 1.0], [2.0, 3.0, 3.0]]), at_anchor, at_fairlead)
        if t == 1.5:
            assert tensions.slack_since[0] == 1.0
    assert math.isnan(tensions.slack_since[0])
    first, second = tensions.readings(np.zeros(2))
    assert (first.at_fairlead.largest, tensions.most_at) == (8.0, (0, 2.0))
    assert (first.slack_fraction, second.slack_fraction) == (0.5, 0.0)
    assert (second.uplift, second.anchor) == (2.0, 2.0)  # its first segment stands upright


def test_a_snap_is_the_largest_tension_after_slack():
    scene = MooringScene(check_record(MooringParams, PRESETS["Snap in a storm"]))
    static, slack = scene.readings().lines[0].fairlead, False
    while scene.time < 40.0 and scene.tensions.at_fairlead.largest[0] < 4.0 * static:
        scene.advance(8)
        slack |= not math.isnan(scene.tensions.slack_since[0])
    assert slack
    rows = np.array(scene.take_plot_rows())
    assert np.nanmax(rows[:, 1]) <= rows[-1, 5] * (1.0 + 1e-9)  # the plot's largest so far


def test_dragging_an_anchor_a_fairlead_and_the_body():
    scene = MooringScene(MooringParams(**SMALL, wave_height=0.0))
    before = scene.readings().lines[0].fairlead
    scene.handle(Place("anchor 1", (-95.0, 5.0, 30.0)))
    run(scene, 14.0)
    assert scene.points[0, 0] == pytest.approx((-95.0, 5.0, -40.0), abs=1e-6)
    assert before < scene.tensions.dragged < 10.0 * before  # no jerk
    assert scene.readings().lines[0].at_fairlead.largest == pytest.approx(before, rel=1e-3)
    scene.handle(Place("anchor 1", (-1e6, 0.0, 0.0)))  # no farther than the line reaches
    assert np.linalg.norm(scene.attached.anchors[0].target) < 130.0
    scene.handle(Place("anchor 1", (-95.0, 5.0, 0.0)))
    scene.handle(Place("fairlead 1", vector_of(scene.body_place() + (0.0, 50.0, 0.0))))
    run(scene, 10.0)
    assert scene.attached.places.fairleads[0] == pytest.approx((0.0, hull_of(scene.params).extents[1, 1], 0.0))
    scene.handle(GrabTo(0, (0.0, 20.0, 0.0), client=1))
    scene.handle(GrabTo(0, (0.0, -20.0, 0.0), client=2))  # the other browser waits
    run(scene, 2.0)
    assert scene.body_place()[1] > 1.0
    scene.handle(Release(client=2))
    assert scene.frame().grab.target == (0.0, 20.0, 0.0)
    scene.handle(Release(client=1))
    assert scene.frame().grab is None


def test_the_restoring_curve_goes_through_the_state_of_rest_and_through_a_pushed_one():
    pushed, free = (MooringScene(MooringParams(segments=20, wave_height=0.0, steady_force=f)) for f in (15.0, 0.0))
    offset, force = free.curve_inputs().curve(free.rows)
    assert np.interp(0.0, offset, force) == pytest.approx(0.0, abs=400.0)
    assert (np.diff(force) > 0.0).all()
    moved = float(pushed.body_place()[0] - free.body_place()[0])
    assert np.interp(moved, offset, force) == pytest.approx(15e3, rel=0.1)
    assert -pushed.force_of_lines()[0] == pytest.approx(15e3, rel=0.02)


def test_the_chart_of_the_restoring_force_marks_the_state():
    scene = MooringScene(MooringParams(**SMALL, plot_restoring=True))
    run(scene, 1.0)
    charts = scene.curves()
    assert charts is not None
    offset, static, now = charts["plot_restoring"].columns
    assert (np.diff(offset) >= 0.0).all()
    assert np.isfinite(static).all()
    assert np.isfinite(now).sum() == 1  # a dot: a bar would read as a force from its foot
    assert charts["plot_restoring"].lines[1].dots
    assert np.nanmax(now) == pytest.approx(-1e-3 * scene.force_of_lines()[0])


def test_the_gauge_is_that_of_the_library_and_a_longer_step_diverges():
    scene = MooringScene(MooringParams(**SMALL))
    assert scene.stability.critical_step == pytest.approx(critical_step(scene.system, "leapfrog"), rel=1e-9)
    # Not far beyond the limit, drag and links that go slack keep the growth bounded.
    long = MooringScene(MooringParams(**{**SMALL, "time_step": 3.0 * scene.stability.critical_step}))
    with pytest.raises(DivergenceError, match="became unstable"):
        run(long, 5.0)
    kind = scene_named("mooring")
    assert kind.remedy is not None


def test_a_run_that_begins_with_lines_that_are_too_short_blames_them_and_no_step():
    """40 m of chain to an anchor 80 m away in 40 m of water: the straight way alone is more than twice as long."""
    kind = scene_named("mooring")
    short = check_record(kind.params, {**kind.presets["Chain catenary"], "length": 40.0, "time_step": 1 / 100})
    loop = SimLoop(kind.make(short), effort=lambda: 0.0)
    for _ in range(60):
        loop.tick(1 / 60)
    said = "40 m cannot reach an anchor 80 m away in 40 m of water: at least 84.5 m."
    assert loop.run.halted == said
    assert kind.remedy(loop.latest) == Advice("length", 84.5, "84.5 m")
    notes = notes_of(loop.latest)
    assert "there are no statistics" in notes[TENSIONS]
    assert notes[BED] == ""
    assert "<table" not in notes[TENSIONS]


def test_a_checkpoint_goes_on_as_the_run_did():
    scene = MooringScene(MooringParams(**SMALL))
    run(scene, 1.0)
    kept = scene.keep()
    run(scene, 1.0)
    expected = scene.frame()
    scene.resume(kept)
    run(scene, 1.0)
    np.testing.assert_array_equal(scene.frame().points, expected.points)
    assert scene.frame().offset == expected.offset


def test_a_change_of_forces_shows_in_the_tensions_before_the_next_step_and_counts_in_no_statistics():
    scene = MooringScene(MooringParams(**SMALL))
    run(scene, 1.0)
    before, readings = scene.end_tension(), scene.readings().lines[0]
    scene.change_forces(dataclasses.replace(scene.params, axial_stiffness=2.0 * scene.params.axial_stiffness))
    stiffer = scene.end_tension()
    assert (abs(stiffer - before) > 1e-3 * before).all()
    for _ in range(2):
        scene.resume(scene.keep())
        np.testing.assert_array_equal(scene.end_tension(), stiffer)
    assert scene.readings().lines[0].at_fairlead == readings.at_fairlead


def test_the_bed_is_darker_and_bluer_with_depth_and_is_lost_towards_the_sides():
    shallow, deep = (bed_colours(depth).reshape(BED_ROWS, BED_ROWS, 3) for depth in (8.0, 120.0))
    middle = slice(BED_ROWS // 2 - 5, BED_ROWS // 2 + 6)
    lit, dim = (bed[middle, middle].mean(axis=(0, 1)) for bed in (shallow, deep))
    assert (dim < 0.75 * lit).all()
    assert dim[2] / dim[0] > 1.5 * lit[2] / lit[0]
    np.testing.assert_allclose(shallow[0, 0], deep[0, 0])  # the colour of the water there
    assert (shallow[0, 0] < 0.75 * lit).all()
    assert shallow[middle, middle].std(axis=(0, 1)).min() > 0.01
    # `js/sea/underwater.js` takes what is redder than blue for oil.
    assert (shallow[..., 2] - shallow[..., 0] > 0.02).all()


@pytest.mark.parametrize(
    "changed",
    [
        {"steady_force": 400.0},
        *(
            pytest.param(one, marks=pytest.mark.long)
            for one in ({"density": 900.0}, {"direction": 90.0}, {"length": 99.0})
        ),
    ],
)
def test_the_restoring_curve_is_that_of_the_rest_now(changed):
    scene = MooringScene(MooringParams(plot_restoring=True, segments=12, wave_height=0.0))
    scene.curves()
    scene.params = dataclasses.replace(scene.params, **changed)
    scene.reset()
    charts = scene.curves()
    assert charts is not None
    offset, static, _ = charts["plot_restoring"].columns
    expected = scene.curve_inputs(2.0 ** math.ceil(math.log2(max(scene.excursion.largest, 1e-3)))).curve(scene.rows)
    assert np.interp(expected[0], offset, static) == pytest.approx(1e-3 * expected[1], abs=1e-6)


def test_the_painted_waterline_is_that_of_the_rest():
    light, heavy = (MooringScene(MooringParams(**SMALL, density=density)) for density in (450.0, 850.0))
    assert MooringView.shape_of(light.frame()) != MooringView.shape_of(heavy.frame())
    before = MooringView.shape_of(light.frame())
    light.state.x[2, light.system.node_count] += 0.7  # heave
    light.measure()
    assert light.frame().body[2] != pytest.approx(light.frame().rest[2])
    assert MooringView.shape_of(light.frame()) == before


def test_the_path_is_bounded_and_its_last_place_is_that_of_the_body():
    scene = MooringScene(MooringParams(**SMALL))
    for i in range(1, MAX_PATH + 300):
        scene.state.t = PATH_INTERVAL * i
        scene.state.x[0, scene.system.node_count] = 1e-3 * i
        scene.measure()
        scene.measure()  # no second place at the same time
    assert scene.excursion.path.shape == (MAX_PATH, 2)
    steps = np.diff(scene.excursion.path[:, 0])
    assert steps == pytest.approx(np.full(len(steps), 1e-3), abs=1e-6)
    assert scene.excursion.path[-1] == pytest.approx(scene.body_place()[:2], abs=1e-6)
    kept: Any = scene.keep()
    assert kept["excursion"].path.nbytes == MAX_PATH * 8


def test_a_mooring_without_rest_keeps_its_panel_and_says_why(monkeypatch):
    def fail(system):
        raise ConvergenceError("static state of the mooring", "3 N", 40)

    monkeypatch.setattr("app.scenes.mooring.start.at_rest", fail)
    scene = MooringScene(MooringParams(**SMALL))
    assert np.isfinite(scene.frame().points).all()
    with pytest.raises(DivergenceError, match=r"No state of rest .*3 N left.* Change their length"):
        scene.advance(1)
    monkeypatch.undo()
    scene.params = dataclasses.replace(scene.params, length=97.0)
    scene.reset()
    scene.advance(1)
    assert scene.time > 0.0


@pytest.mark.parametrize(
    "changed",
    [
        {"line_mass": 1.0, "diameter": 0.03}, {"line_mass": 0.35, "diameter": 0.02},
        {"line_mass": 5.0, "diameter": 0.08, "axial_stiffness": 1e8},
        {"line_mass": 2.0, "diameter": 0.03, "axial_stiffness": 3e8}, {"axial_stiffness": 1e10},
        {"line_mass": 10.0, "diameter": 0.05, "axial_stiffness": 1e9}, {"axial_stiffness": 1e10, "segments": 100},
        {"axial_stiffness": 1e8, "segments": 100, "line_mass": 1.0, "diameter": 0.03},
    ],
)  # fmt: skip
def test_light_ropes_and_stiff_lines_rest(changed):
    assert not MooringScene(MooringParams(**changed)).start.failure


def anywhere(rng: random.Random, one: Parameter) -> float:
    """A value between a slider's ends."""
    if one.log_from:
        return math.exp(rng.uniform(math.log(one.log_from), math.log(one.high)))
    return rng.uniform(one.low, one.high)


def an_end(rng: random.Random, one: Parameter) -> float:
    return rng.choice((one.low, one.high))


def random_params(rng: random.Random, value: Callable[[random.Random, Parameter], float] = anywhere) -> MooringParams:
    """A mooring inside the sliders."""
    values = {}
    for name, one in parameters_of(MooringParams).items():
        if name in STATIC:
            number = value(rng, one)
            values[name] = round(number) if isinstance(one.default, int) else number
    return MooringParams(**values, body=rng.choice(["buoy", "box"]), floats=rng.random() < 0.5, wave_height=0.0)


STATIC = (
    "lines", "length", "reach", "depth", "diameter", "line_mass", "axial_stiffness", "lift", "segments", "size",
    "density", "direction", "steady_force",
)  # fmt: skip


def corrections_of(params: MooringParams) -> int:
    """Corrections of the search for rest, which has to find it."""
    with pytest.MonkeyPatch.context() as patch:
        done = []
        for module, name in ((interior.Tangent, "step"), (balance, "corrected")):
            plain = getattr(module, name)
            patch.setattr(module, name, lambda *args, plain=plain: (done.append(1), plain(*args))[1])
        system = build(params, first_places(params), body_of(params, None), None)
        assert balance.what_is_left(system.at_rest().nodes, system.kernel_view(1.0))[1]
        return len(done)


@pytest.mark.long
@pytest.mark.parametrize("count", [100, pytest.param(2000, marks=pytest.mark.stress)])
def test_random_moorings_rest(count):
    rng = random.Random(4)
    assert max(corrections_of(random_params(rng)) for _ in range(count)) <= 60


@pytest.mark.parametrize("count", [60, pytest.param(1000, marks=pytest.mark.stress)])
def test_moorings_at_the_ends_of_the_sliders_rest_or_their_load_is_refused(count):
    rng, refused = random.Random(1), 0
    for _ in range(count):
        params = random_params(rng, an_end)
        try:
            assert corrections_of(params) <= 60
        except ConvergenceError:
            fault = MooringScene(params).start.fault
            assert fault is not None
            assert not fault.said.startswith(NO_REST), params  # lines that are too short, or a load that is too large
            refused += 1
    assert refused <= 0.02 * count


ENDS: dict[str, Any] = {
    "length": 1000.0, "line_mass": 0.01, "segments": 100, "steady_force": 5000.0, "lift": 5000.0, "direction": 180.0,
    "axial_stiffness": 1e3, "size": 40.0,
}  # fmt: skip


@pytest.mark.parametrize(
    "ends",
    [
        # A link of 10 m is stretched to 12 km, and what it does across follows from its pull over that length.
        {"lines": 4, "reach": 0.5, "depth": 500.0, "diameter": 0.5, "size": 0.5, "density": 900.0},
        # Which parts lie or float is known late, after as many corrections as there may be but for four.
        {"lines": 4, "reach": 900.0, "depth": 2.0, "diameter": 0.003, "axial_stiffness": 1e10, "body": "box",
         "density": 900.0, "steady_force": 0.0},
    ],
)  # fmt: skip
def test_light_lines_rest(ends):
    assert corrections_of(MooringParams(**{**ENDS, **ends})) <= 60


@pytest.mark.parametrize(
    ("ends", "said"),
    [
        (
            {"lines": 4, "axial_stiffness": 1e3},
            "5.000 kN stretches a line by 125.000.% or more: EA is low for its load",
        ),
        ({"lines": 4, "size": 0.5}, "5.000 kN is more than the buoyancy of the whole body, 0.543 kN"),
        ({"lines": 4, "size": 40.0}, "No state of rest"),
    ],
)
def test_without_rest_the_steady_force_is_blamed_if_lines_or_body_cannot_bear_it(ends, said, monkeypatch):
    def fail(system):
        raise ConvergenceError("static state of the mooring", "3 N", 40)

    monkeypatch.setattr("app.scenes.mooring.start.at_rest", fail)
    fault = MooringScene(MooringParams(**{"steady_force": 5000.0, "segments": 4, **ends})).start.fault
    assert fault is not None
    assert re.search(said, fault.said)
    assert fault.parameter == ("axial_stiffness" if "EA" in said else "steady_force" if "body" in said else "length")
