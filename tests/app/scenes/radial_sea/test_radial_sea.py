"""The radial scene without a browser: bodies settle where Archimedes says, oil adds what it should, nothing breaks."""

import dataclasses
import importlib.resources
import io
import itertools
import math
import re
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
import trimesh

from app.__main__ import main
from app.formats.formatting import fixed, largest_force
from app.messages import GrabTo, Place, Release
from app.scenes.contract import AnyScene
from app.scenes.radial_sea.bodies import BODY_KINDS, GRAVITY, place_of
from app.scenes.radial_sea.drawn_surface import FOAM_RADIUS, mean_square_slope, tile_of
from app.scenes.radial_sea.moorings import BED_DEPTH, LINE_REACH
from app.scenes.radial_sea.oil.well_blowout import LANDING, WellBlowout, slick_reach
from app.scenes.radial_sea.parameters import PRESETS, RadialSeaParams, column_of, hidden
from app.scenes.radial_sea.report import forces_html, marks_of
from app.scenes.radial_sea.scene import RadialSeaScene
from app.server.loop.sim_loop import SimLoop
from sim.floating import Hull, equilibrium_draft, heave_period
from sim.ocean.fluids.fluids import fluids
from sim.ocean.radial.gerstner import peak_wavenumber
from sim.ocean.radial.radial import RadialSea
from sim.ocean.statistics.foam import whitecaps
from sim.parameters import check_record, clamp_value, effect_of_change, parameters_of

CALM = {"waves": False, "rig": False, "ripples": False}


def with_parameters(**changes: Any) -> RadialSeaParams:
    return check_record(RadialSeaParams, changes)


def run(scene: RadialSeaScene, seconds: float) -> RadialSeaScene:
    for _ in range(round(seconds / scene.step / 6)):
        scene.advance(6)
    return scene


@pytest.mark.parametrize(
    "changes",
    [
        pytest.param({}, marks=pytest.mark.stress),
        pytest.param({"spill": "layer", "thickness": 0.2}, marks=pytest.mark.stress),
        {"spill": "layer", "thickness": 2.0, "density": 300.0},
        pytest.param({"spill": "layer", "thickness": 0.05, "oil": "IFO 180"}, marks=pytest.mark.stress),
        pytest.param({"spill": "mixed", "fraction": 0.4, "oil": "Arabian Light"}, marks=pytest.mark.stress),
    ],
)
def test_bodies_let_go_too_high_settle_at_the_drafts_of_the_readout(changes: dict) -> None:
    scene = RadialSeaScene(with_parameters(**CALM, **changes))
    scene.bodies.fleet.position[:, 2] += 0.1
    run(scene, 40.0)
    for reading in scene.readings().bodies:
        assert reading.draft == pytest.approx(reading.prediction.draft, abs=1e-4)


def test_oil_poured_on_adds_d_times_one_minus_the_ratio() -> None:
    scene = RadialSeaScene(with_parameters(**CALM))
    run(scene, 10.0)
    before = scene.bodies.meters.draft.copy()
    scene.change_forces(with_parameters(**CALM, spill="layer", thickness=0.2))
    run(scene, 50.0)
    extra = 0.2 * (1.0 - fluids()["Alaska North Slope 2002"].density / 1025.0)
    np.testing.assert_allclose(scene.bodies.meters.draft - before, extra, atol=1e-4)
    theory = scene.readings().bodies[0].prediction
    assert theory.draft - theory.draft_in_water == pytest.approx(extra, abs=1e-9)


def test_theory_is_that_of_the_hulls() -> None:
    params = RadialSeaParams(spill="layer", density=700.0, size=2.0)
    scene, column = RadialSeaScene(params), column_of(params)
    for reading in scene.readings().bodies:
        hull = Hull.of_shape(next(k.shape for k in BODY_KINDS if k.name == reading.kind), 2.0)
        assert reading.prediction.draft == equilibrium_draft(hull, 700.0, column.layers)
        assert reading.prediction.period == heave_period(hull, 700.0, column.layers)


def test_a_body_pushed_under_bobs_at_the_predicted_period() -> None:
    scene = RadialSeaScene(with_parameters(**CALM, time_step=1 / 120))
    scene.bodies.fleet.position[:, 2] -= 0.1
    run(scene, 7.0)
    for reading in scene.readings().bodies:
        assert reading.period == pytest.approx(reading.prediction.period, rel=0.04)


def test_what_is_denser_than_the_fluid_sinks_and_comes_to_rest_deep() -> None:
    scene = RadialSeaScene(with_parameters(**CALM, density=1010.0, spill="mixed", fraction=0.6, bodies=1))
    assert math.isinf(scene.readings().bodies[0].prediction.draft)
    run(scene, 55.0)
    assert (scene.bodies.fleet.position[:, 2] >= -61.0).all()
    assert (scene.bodies.fleet.position[:, 2] < -20.0).all()


def test_a_grabbed_buoy_goes_under_and_comes_back() -> None:
    scene = RadialSeaScene(with_parameters(**CALM))
    rest = scene.bodies.fleet.position[0].copy()
    for _ in range(60):
        scene.handle(GrabTo(0, (rest[0], rest[1], rest[2] - 0.8)))
        scene.advance(2)
    assert scene.bodies.fleet.position[0, 2] < rest[2] - 0.4
    assert scene.frame().grabs
    scene.handle(Release())
    run(scene, 40.0)
    assert scene.bodies.fleet.position[0, 2] == pytest.approx(rest[2], abs=1e-3)
    assert scene.frame().grabs == ()


def test_a_thrown_box_flies_and_its_mooring_brings_it_back() -> None:
    scene = RadialSeaScene(with_parameters(**CALM))
    home = scene.bodies.fleet.position[2, :2].copy()
    scene.bodies.fleet.velocity[2] = (6.0, 0.0, 5.0)
    run(scene, 1.0)
    assert np.hypot(*(scene.bodies.fleet.position[2, :2] - home)) > 3.0
    run(scene, 60.0)
    assert np.hypot(*(scene.bodies.fleet.position[2, :2] - home)) < 3.0


def test_the_pull_of_a_body_says_that_it_is_at_its_limit() -> None:
    scene = RadialSeaScene(with_parameters(**CALM, pull=2.0))
    weight = GRAVITY * float(scene.bodies.fleet.mass[0])
    x, y, z = scene.bodies.fleet.position[0].tolist()
    scene.handle(GrabTo(0, (x, y, z)))
    assert scene.frame().grabs[0].load == 0.0
    scene.advance(1)
    for away, is_at_limit in ((0.002, False), (30.0, True)):
        scene.handle(GrabTo(0, (x + away, y, z)))
        before = scene.bodies.fleet.velocity[0, 0]
        scene.advance(1)
        (pull,) = scene.frame().grabs
        assert pull.place == tuple(scene.bodies.fleet.position[0])
        assert pull.limit == largest_force(2.0 * weight)
        assert (pull.load == pytest.approx(1.0)) is is_at_limit
        # Added mass makes the body heavier than it is.
        gained = (scene.bodies.fleet.velocity[0, 0] - before) / (pull.load * 2.0 * GRAVITY * scene.step)
        assert 0.3 < gained < 1.0
    scene.handle(Release())
    scene.handle(GrabTo(0, (x, y, z)))
    assert scene.frame().grabs[0].load == 0.0


def test_a_body_held_by_one_browser_is_not_taken_over_by_another() -> None:
    scene = RadialSeaScene(with_parameters(**CALM))
    scene.handle(GrabTo(0, (1.0, 0.0, 0.0), client=1))
    scene.handle(GrabTo(0, (9.0, 0.0, 0.0), client=2))
    scene.handle(GrabTo(1, (2.0, 0.0, 0.0), client=2))
    assert [pull.target for pull in scene.frame().grabs] == [(1.0, 0.0, 0.0), (2.0, 0.0, 0.0)]
    scene.handle(GrabTo(0, (1.5, 0.0, 0.0), client=1))  # its own body stays dragged
    assert scene.frame().grabs[0].target == (1.5, 0.0, 0.0)


def test_a_browser_lets_go_only_of_what_it_holds() -> None:
    scene = RadialSeaScene(with_parameters(**CALM))
    scene.handle(GrabTo(0, (1.0, 0.0, 0.0), client=1))
    scene.handle(GrabTo(1, (2.0, 0.0, 0.0), client=2))
    scene.handle(Release(client=2))
    assert [pull.target for pull in scene.frame().grabs] == [(1.0, 0.0, 0.0)]
    assert scene.bodies.fleet.pull_limit[0] > 0.0
    assert scene.bodies.fleet.pull_limit[1] == 0.0
    scene.handle(Release(client=3))
    assert len(scene.frame().grabs) == 1
    scene.handle(GrabTo(1, (2.0, 0.0, 0.0), client=2))  # free again
    scene.handle(GrabTo(2, (3.0, 0.0, 0.0), client=2))  # and left for another one
    assert [pull.target for pull in scene.frame().grabs] == [(1.0, 0.0, 0.0), (3.0, 0.0, 0.0)]
    assert scene.bodies.fleet.pull_limit[1] == 0.0


def test_drifting_bodies_are_held_by_lines_that_the_picture_shows() -> None:
    scene = RadialSeaScene(with_parameters(rig=False, wind_speed=8.0))
    home = scene.bodies.fleet.position[:, :2].copy()
    frame, anchors = scene.frame(), scene.frame().anchors.copy()
    assert anchors.shape == (3, 4, 3)
    assert (anchors[..., 2] == -BED_DEPTH).all()
    assert np.linalg.norm(frame.fairleads - frame.positions, axis=1).max() < 1.5
    run(scene, 60.0)
    assert np.hypot(*(scene.bodies.fleet.position[:, :2] - home).T).max() < 8.0
    for reading in scene.readings().bodies:
        assert reading.offset > 0.2
        assert reading.tension > 0.0
        assert fixed(reading.offset, 2) in forces_html(scene.readings())
    np.testing.assert_array_equal(scene.frame().anchors, anchors)


def test_lines_pull_as_in_the_middle_of_a_step() -> None:
    """By its place at the beginning of each step a body would gain energy."""
    scene = RadialSeaScene(with_parameters(**CALM, bodies=1))
    fleet = scene.bodies.fleet
    fleet.velocity[0] = (2.0, -1.0, 0.0)
    scene.bodies.moor(0.5)
    level = fleet.mooring[0, :2] / fleet.velocity[0, :2]
    assert (level < 0.0).all()
    assert level[0] == pytest.approx(level[1], rel=0.02)
    length = scene.bodies.moorings.lines.length[0, 0]
    stiffness = scene.bodies.moorings.lines.stiffness[0] / length * (LINE_REACH / length) ** 2
    assert level[0] == pytest.approx(-0.25 * stiffness, rel=0.02)


def test_a_mooring_that_is_taken_off_pulls_no_longer() -> None:
    scene = RadialSeaScene(with_parameters(**CALM))
    scene.bodies.fleet.position[0, 0] += 20.0
    scene.advance(2)
    assert scene.bodies.fleet.mooring[0, 0] < 0.0
    scene.handle(GrabTo(1, (2.0, 0.0, 0.0), client=1))
    scene.change_forces(dataclasses.replace(scene.params, mooring=False))
    scene.advance(2)
    assert not scene.bodies.fleet.mooring.any()
    assert not len(scene.frame().fairleads)
    assert scene.bodies.fleet.pull_limit[1] > 0.0


def test_the_other_surface_is_computed_only_when_it_is_asked_for() -> None:
    scene = run(RadialSeaScene(RadialSeaParams()), 0.2)
    scene.frame()
    assert scene.tile is None
    assert scene.readings().surfaces == {}
    scene.params = RadialSeaParams(compare=True)  # as the loop does: it affects the look only
    scene.frame()
    assert set(scene.readings().surfaces) == {"sum", "fft"}


def test_a_change_of_the_grid_is_a_change_of_look() -> None:
    scene = run(RadialSeaScene(RadialSeaParams()), 0.2)
    scene.frame()
    for changes in ({"rings": 60}, {"spokes": 40}, {"ring_law": "power"}, {"centre": "camera"}):
        params = dataclasses.replace(scene.params, **changes)
        assert effect_of_change(scene.params, params) == "look"
        scene.params = params
        frame = scene.frame()
        assert (frame.grid.rings, frame.grid.spokes) == (params.rings, params.spokes)
        assert len(frame.surface.vertices) == len(frame.foam) == len(frame.grid)


@pytest.mark.parametrize("changes", [{"wind_speed": 10.0}, {"wind_speed": 18.0, "film": True, "exposure": 3600.0}])
def test_as_much_of_the_sea_is_foam_as_was_measured_for_the_slope_that_oil_leaves(changes: dict) -> None:
    scene = RadialSeaScene(with_parameters(rig=False, bodies=1, ripples=False, spill="mixed", **changes))
    foam = scene.frame().foam[: int((scene.grid.radii < FOAM_RADIUS).sum()) * scene.grid.spokes]
    left = scene.sum.mean_square_slope / mean_square_slope(scene.sum.waves)
    assert left < 0.9 if "film" in changes else left > 0.99
    # Half of the width over which foam begins lies on either side of the threshold.
    assert (foam > 0.5).mean() == pytest.approx(whitecaps(scene.params.wind_speed) * left, abs=2.0 / len(foam))


def test_what_is_not_in_the_column_does_not_reset_its_age() -> None:
    scene = run(RadialSeaScene(with_parameters(spill="layer", exposure=10.0)), 5.0)
    age, radiated = scene.age, scene.radiated_waves
    scene.change_forces(dataclasses.replace(scene.params, fraction=0.3, choppiness=0.5, density=500.0))
    assert scene.age == age
    assert scene.radiated_waves is radiated


@pytest.mark.parametrize("kind", [kind for kind in BODY_KINDS if kind.appearance.model], ids=lambda kind: kind.name)
def test_a_model_is_as_wide_as_the_hull_that_it_stands_for(kind) -> None:
    data = importlib.resources.files("assets").joinpath(f"{kind.appearance.model}.glb").read_bytes()
    drawn = trimesh.load(io.BytesIO(data), file_type="glb", force="mesh").bounds
    hull = Hull.of_shape(kind.shape)
    np.testing.assert_allclose(drawn[:, :2].T, hull.extents[:2], atol=0.03)
    assert drawn[0, 2] == pytest.approx(hull.extents[2, 0], abs=0.03)


def test_a_nonsense_grab_is_no_grab() -> None:
    scene = RadialSeaScene(RadialSeaParams())
    scene.handle(GrabTo(10**6, (0.0, 0.0, 0.0)))
    scene.handle(GrabTo(-1, (0.0, 0.0, 0.0)))
    scene.advance(2)
    assert scene.frame().grabs == ()


@pytest.mark.parametrize("name", list(PRESETS))
def test_each_preset_runs_and_its_frame_is_finite(name: str) -> None:
    scene = RadialSeaScene(check_record(RadialSeaParams, PRESETS[name]))
    run(scene, 4.0)
    frame = scene.frame()
    for array in (frame.surface.vertices, frame.surface.slope, frame.foam, frame.positions, frame.rotations):
        assert np.isfinite(array).all()
        assert array.dtype == np.float32
    readings = scene.readings()
    assert len(readings.bodies) == min(6, scene.params.bodies)
    assert scene.sum.evaluated > 0
    assert scene.sum.skipped > 0  # waves that a ring is too wide to show
    assert readings.surfaces == {}


def test_hostile_values_are_clamped_to_what_runs() -> None:
    def clamp(params: RadialSeaParams) -> RadialSeaParams:
        return RadialSeaParams(
            **{n: clamp_value(k, getattr(params, n)) for n, k in parameters_of(RadialSeaParams).items()}
        )  # type: ignore[arg-type]

    low = clamp(
        dataclasses.replace(
            RadialSeaParams(),
            **{n: -1e30 for n, k in parameters_of(RadialSeaParams()).items() if k.kind in (int, float)},
        )
    )
    high = clamp(
        dataclasses.replace(
            RadialSeaParams(),
            **{n: 1e30 for n, k in parameters_of(RadialSeaParams()).items() if k.kind in (int, float)},
        )
    )
    odd = clamp(dataclasses.replace(RadialSeaParams(), oil="; rm -rf", surface=7, wind_speed=math.nan, waves="yes"))  # type: ignore[arg-type]
    assert odd == RadialSeaParams()
    for params in (low, dataclasses.replace(high, bodies=20, rings=40, spokes=40, wave_count=32)):
        scene = RadialSeaScene(params)
        run(scene, 20 * params.time_step)
        assert np.isfinite(scene.frame().surface.vertices).all()


def test_parameters_change_under_way_without_a_jump_of_the_bodies() -> None:
    scene = run(RadialSeaScene(RadialSeaParams()), 2.0)
    changes = [
        {"wind_speed": 12.0}, {"spill": "layer"}, {"spill_hours": 6.0, "spread": True}, {"oil": "Maya"},
        {"surface": "fft"}, {"surface": "sum"}, {"density": 700.0}, {"fire": True, "jet": True}, {"fire_power": 50.0},
        {"rings": 60}, {"choppiness": 0.3}, {"film": True}, {"jet": False}, {"spill": "mixed"}, {"waves": False},
        {"centre": "camera"},
    ]  # fmt: skip
    params = RadialSeaParams()
    for change in changes:
        before = scene.bodies.fleet.position.copy()
        params = dataclasses.replace(params, **change)
        scene.change_forces(params)
        scene.advance(2)
        assert np.abs(scene.bodies.fleet.position - before).max() < 0.3
        assert np.isfinite(scene.frame().surface.vertices).all()


def test_the_surface_drawn_is_the_one_the_bodies_float_on() -> None:
    scene = run(RadialSeaScene(RadialSeaParams(ripples=False)), 3.0)
    vertices = scene.frame().surface.vertices[: 4 * 128]
    at = scene.sea.at(vertices[:, :2], scene.time)
    np.testing.assert_allclose(at.height, vertices[:, 2], atol=2e-5)


def test_the_camera_takes_the_rings_along() -> None:
    scene = run(RadialSeaScene(RadialSeaParams(centre="camera")), 0.2)
    scene.handle(Place("camera", (30.0, -12.0, 4.0)))
    scene.advance(1)
    vertices = scene.frame().surface.vertices
    assert np.abs(vertices[-1, :2] - (30.0, -12.0)).max() < 3.0


def test_bodies_that_bob_make_rings_and_bodies_at_rest_make_none() -> None:
    still = run(RadialSeaScene(RadialSeaParams(waves=False, rig=False)), 8.0)
    level = np.abs(still.frame().surface.vertices[:, 2]).max()
    bobbing = RadialSeaScene(RadialSeaParams(waves=False, rig=False))
    bobbing.bodies.fleet.position[:, 2] -= 0.3
    run(bobbing, 1.5)
    assert np.abs(bobbing.frame().surface.vertices[:, 2]).max() > 5e-3
    assert level < 1e-3


def test_oil_from_the_jet_makes_a_slick_that_grows() -> None:
    scene = run(RadialSeaScene(RadialSeaParams(jet=True)), 6.0)
    early = scene.readings().oil_budget
    run(scene, 12.0)
    late = scene.readings().oil_budget
    assert late.radius > early.radius > 0.0
    assert late.ejected == pytest.approx(late.in_flight + late.fed)
    assert late.fed == pytest.approx(math.pi * late.radius**2 * late.thickness)
    assert late.hits > early.hits > 0
    slick = scene.frame().slick
    assert slick is not None
    assert (slick.radius, slick.thickness) == (late.radius, late.thickness)
    x, y = slick.centre
    rim = np.array([x, x + slick.radius, x + 2 * slick.radius])
    np.testing.assert_allclose(slick_reach(slick, rim, np.full(3, y)), [slick.radius, 0.0, -slick.radius], atol=1e-9)


def test_the_slick_drifts_downwind_with_the_middle_of_its_oil_and_calms_the_waves_under_it() -> None:
    rough = {"wind_speed": 8.0, "wind_direction": 90.0, "bodies": 0, "ripples": False}
    params = with_parameters(**rough, jet=True, jet_flow=20.0, oil="IFO 180")
    scene = RadialSeaScene(params)
    fed, middle = 0.0, 0.0  # [m3], [m] of the middle of the oil downwind of where it lands, from what fell when
    for _ in range(150):
        before = scene.well_blowout.volume
        scene.advance(6)
        fed = scene.well_blowout.volume
        if fed > 0.0:
            middle = (middle + 0.03 * 8.0 * 0.1) * before / fed
    slick = scene.frame().slick
    assert slick is not None
    assert slick.centre == pytest.approx((LANDING[0], LANDING[1] + middle), abs=1e-9)
    assert middle > 0.5
    scene.change_forces(dataclasses.replace(params, jet=False))
    scene.advance(60)
    shut = scene.well_blowout.slick(scene.column)
    assert shut is not None
    share = fed / scene.well_blowout.volume  # what was in the air counts as fallen
    assert shut.centre[1] - LANDING[1] == pytest.approx(share * (middle + 0.03 * 8.0), rel=1e-6)

    scene.advance(1)
    cover = scene.sum.slick
    assert cover is not None
    assert (cover.centre, cover.radius) == (pytest.approx(shut.centre, abs=0.3), pytest.approx(shut.radius, rel=0.02))
    assert cover.column.thickness == pytest.approx(shut.thickness, rel=0.1)
    end = np.array([[cover.centre[0], cover.centre[1] + cover.radius]])  # where waves leave it that run downwind
    short = np.array([2.0 * math.pi / 2.0])
    path = cover.paths(end, np.zeros(1), short)[0, 0]
    assert path == pytest.approx(2.0 * cover.radius, rel=1e-6)
    assert scene.readings().oil_budget.wave_left == pytest.approx(
        math.exp(-2.0 * cover.radius * cover.attenuation(np.array([2.0 * math.pi]), scene.column)[0]), rel=1e-9
    )
    clean = RadialSeaScene(with_parameters(**rough))
    clean.advance(6)
    assert clean.sum.slick is None


@pytest.mark.parametrize(
    "changes",
    [
        {"spill": "mixed", "oil": "Bunker C Zalinski", "fraction": 0.02, "continuous": "oil", "wind_speed": 1.0},
        {"spill": "layer", "oil": "Maya", "thickness": 2.0, "temperature": 0.0, "spill_hours": 120.0},
    ],
)
def test_bodies_float_where_waves_creep_in_thick_oil(changes: dict[str, Any]) -> None:
    """Such a wave has no frequency: nothing may be divided by it."""
    scene = RadialSeaScene(with_parameters(**changes, exposure=0.0, ageing=False))
    assert (scene.sum.rate == 0.0).any()
    clean = RadialSeaScene(with_parameters(wind_speed=scene.params.wind_speed))
    run(scene, 1.0)
    assert np.isfinite(scene.bodies.fleet.lift).all()
    assert scene.readings().middle_period == clean.readings().middle_period


@pytest.mark.parametrize("surface", ["sum", "fft"])
def test_the_window_is_cut_where_sea_and_interface_are(surface: str) -> None:
    scene = run(
        RadialSeaScene(with_parameters(spill="layer", thickness=0.3, cutaway=True, surface=surface, ripples=False)), 2.0
    )
    cutaway = scene.frame().cutaway
    assert cutaway is not None
    assert cutaway.has_oil
    at = scene.sea.at(cutaway.points, scene.time)
    np.testing.assert_allclose(cutaway.top, at.height, atol=1e-6)
    np.testing.assert_allclose(cutaway.interface, np.minimum(at.interface - 0.3, at.height), atol=1e-6)
    assert cutaway.floor < cutaway.interface.min()
    buoy = scene.bodies.fleet.position[0, :2]
    wall = cutaway.points[:65]
    np.testing.assert_allclose(wall.mean(axis=0), buoy, atol=1e-9)
    np.testing.assert_allclose((wall - buoy) @ cutaway.direction, 0.0, atol=1e-9)
    np.testing.assert_allclose(
        np.ptp(wall @ [-cutaway.direction[1], cutaway.direction[0]]), 2 * cutaway.half_width, rtol=1e-6
    )
    # the line goes around once, the pit on its left, and closes
    x, y = cutaway.points.T
    assert 0.5 * float(x[:-1] @ np.diff(y) - y[:-1] @ np.diff(x)) == pytest.approx(
        2 * cutaway.half_width * cutaway.length
    )
    np.testing.assert_allclose(cutaway.points[0], cutaway.points[-1], atol=1e-9)


def test_a_window_into_clean_water_has_no_interface_and_none_is_cut_unasked() -> None:
    scene = RadialSeaScene(with_parameters(cutaway=True, bodies=0))
    cutaway = scene.frame().cutaway
    assert cutaway is not None
    assert not cutaway.has_oil
    assert (cutaway.interface == cutaway.top).all()
    assert RadialSeaScene(RadialSeaParams()).frame().cutaway is None


def test_closing_the_jet_keeps_its_oil() -> None:
    scene = run(RadialSeaScene(RadialSeaParams(jet=True)), 6.0)
    ejected = scene.readings().oil_budget.ejected
    scene.change_forces(RadialSeaParams(jet=False))
    tally = scene.readings().oil_budget
    assert tally.fed == pytest.approx(ejected)
    assert tally.in_flight == 0.0
    assert isinstance(scene.well_blowout, WellBlowout)


def test_square_and_radial_surfaces_are_as_high_under_the_same_wind() -> None:
    radial_sea = RadialSeaScene(RadialSeaParams())
    square = RadialSeaScene(RadialSeaParams(surface="fft"))
    assert square.sea.significant_height == pytest.approx(radial_sea.sea.significant_height, rel=0.15)
    run(square, 2.0)
    assert np.isfinite(square.bodies.fleet.position).all()


def test_bodies_start_apart() -> None:
    places = [place_of(i, 1.0) for i in range(200)]
    closest = min(math.dist(a, b) for a, b in itertools.combinations(places, 2))
    assert closest > 1.8


def test_hidden_parameters_are_parameters() -> None:
    for changes in PRESETS.values():
        assert hidden(check_record(RadialSeaParams, changes)) <= set(parameters_of(RadialSeaParams()))
    assert "thickness" in hidden(RadialSeaParams())
    assert "thickness" not in hidden(RadialSeaParams(spill="layer"))


@pytest.mark.parametrize("surface", ["sum", "fft"])
def test_a_spill_ages_and_its_parameter_sets_its_age_anew(surface: str) -> None:
    heavy = {"spill": "layer", "oil": "IFO 180", "thickness": 0.5, "exposure": 10.0, "bodies": 0, "surface": surface}
    heavy["compare"] = True  # so that the surface that is not drawn is made too
    scene = RadialSeaScene(with_parameters(**heavy))
    before, square = scene.sum.significant_height, tile_of(scene).significant_height
    run(scene, 60.0)
    assert scene.readings().age == pytest.approx(70.0, abs=0.2)
    aged = RadialSea(scene.sum.waves, scene.column, 70.0)
    assert scene.sum.significant_height == pytest.approx(aged.significant_height, rel=1e-3)
    assert scene.sum.significant_height < 0.995 * before
    scene.frame()
    assert scene.tile is not None
    assert scene.tile.significant_height < 0.995 * square
    scene.change_forces(with_parameters(**{**heavy, "exposure": 20.0}))
    assert scene.readings().age == 20.0
    still = RadialSeaScene(with_parameters(**heavy, ageing=False))
    assert run(still, 5.0).readings().age == 10.0


@pytest.mark.parametrize("surface", ["sum", "fft"])
def test_what_oil_took_of_the_waves_stays_taken_and_the_panel_says_how_much_is_left(surface: str) -> None:
    still = {"bodies": 0, "surface": surface, "ageing": False, "wind_speed": 4.0}
    oil = {"spill": "layer", "oil": "IFO 180", "thickness": 0.5, "exposure": 1200.0}
    scene = RadialSeaScene(with_parameters(**still, **oil))
    fresh = RadialSeaScene(with_parameters(**still)).readings().height
    heights = [(scene.readings().height, scene.tile_now().significant_height)]
    for changes in (
        {"spill": "none"},
        {"spill": "none", "wind_direction": 50.0},
        {"thickness": 0.3},
        {"thickness": 0.31},
    ):
        scene.change_forces(with_parameters(**{**still, **oil, **changes}))
        scene.advance(90)
        heights.append((scene.readings().height, scene.tile_now().significant_height))
        assert scene.readings().clean_height == pytest.approx(fresh, rel=2e-3)
    for sum_height, tile_height in heights:
        assert tile_height == pytest.approx(sum_height, rel=0.01)
    left = np.array(heights)[:, 0]
    assert left[0] < 0.9 * fresh
    assert left[1:3] == pytest.approx(left[0], rel=2e-3)  # clean water; other waves of another wind
    # Oil again: another 1200 s at once; a change of its thickness takes nothing and gives nothing back.
    assert left[3] < 0.98 * left[0]
    assert left[4] == pytest.approx(left[3], rel=1e-9)
    first, second = (dataclasses.replace(scene.column, thickness=thickness) for thickness in (0.5, 0.3))
    assert scene.sum.past == {first: 1200.0, second: 1200.0}
    loop = SimLoop(cast(AnyScene, scene))
    loop.tick(0.1)
    said = marks_of(loop.latest)["exposure"].replace("\u202f", "")
    k = np.array([peak_wavenumber(scene.wave_choice.spectrum, scene.wave_choice.conditions)])
    share = math.exp(-1200.0 * float((first.roots(k)[1] + second.roots(k)[1])[0]))
    assert float(re.findall(r"keeps ([\d.]+)", said)[0]) == pytest.approx(100.0 * share, rel=0.01)


def write_boat(path: Path, *, closed: bool = True) -> Path:
    """An STL of a wedge, 2 m long, 1 m wide, 0.5 m deep; without its stern unless closed."""
    corners = np.array([[-1, -0.5, 0], [-1, 0.5, 0], [1, 0, 0], [-1, -0.5, -0.5], [-1, 0.5, -0.5], [1, 0, -0.5]], float)
    faces = [(0, 2, 1), (3, 4, 5), (0, 3, 5), (0, 5, 2), (1, 2, 5), (1, 5, 4), (0, 1, 4), (0, 4, 3)]
    lines = ["solid boat"]
    for face in faces[: None if closed else 6]:
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += ["vertex {} {} {}".format(*corners[v]) for v in face]
        lines += ["endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid boat"]), "utf-8")
    return path


def test_a_hull_from_a_file_floats_besides_at_the_draft_of_the_readout(tmp_path: Path) -> None:
    path = write_boat(tmp_path / "boat.stl")
    scene = RadialSeaScene(dataclasses.replace(with_parameters(**CALM, spill="layer", thickness=0.1), hull=str(path)))
    run(scene, 1.0)
    reading = scene.readings().bodies[-1]
    assert reading.kind == "hull"
    prism = 450.0 * 0.5  # [kg/m2] over its waterplane, which is the same at every draft
    rho = scene.column.oil.density
    assert reading.prediction.draft == pytest.approx(0.1 + (prism - rho * 0.1) / 1025.0, abs=1e-9)
    frame = scene.frame()
    assert frame.kinds[-1] == "hull"
    assert "hull" in frame.hulls
    assert len(frame.positions) == 4
    scene.change_forces(dataclasses.replace(scene.params, bodies=1))
    assert scene.bodies.kinds == ("buoy_red", "hull")


def test_a_mesh_that_is_not_closed_ends_the_command_with_one_line(tmp_path: Path, capsys) -> None:
    path = write_boat(tmp_path / "open.stl", closed=False)
    out = ["--seconds", "1", "--out", str(tmp_path / "a.npz"), "--hull"]
    assert main(["run", "radial_sea", *out, str(path)]) == 2
    said = capsys.readouterr().err
    assert "closed" in said
    assert said.count("\n") == 1
    assert main(["run", "radial_sea", *out, str(tmp_path / "none.stl")]) == 2
    assert main(["run", "rope", *out, str(write_boat(tmp_path / "boat.stl"))]) == 2
    assert "radial" in capsys.readouterr().err
    assert main(["run", "radial_sea", *out, str(tmp_path / "boat.stl")]) == 0


def test_a_body_that_is_not_there_has_no_draft_in_the_plots():
    scene = RadialSeaScene(RadialSeaParams(bodies=1))
    scene.take_plot_rows()
    scene.advance(20)
    rows = np.array(scene.take_plot_rows())
    assert len(rows) > 1
    assert np.isnan(rows[:, 2:4]).all()
    assert np.isfinite(rows[:, [0, 1, 4, 5]]).all()


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"wind_speed": 14.0},
        {"spill": "layer", "oil": "IFO 180", "thickness": 0.5, "exposure": 600.0},
        {"spill": "layer", "oil": "IFO 180", "thickness": 0.01, "exposure": 600.0},
        {"spill": "layer", "oil": "Maya", "thickness": 0.05, "exposure": 1800.0, "film": True},
        {"spill": "mixed", "oil": "Maya", "fraction": 0.4, "exposure": 600.0},
    ],
)
def test_both_surfaces_have_the_height_of_the_spectrum_on_the_same_fluids(changes: dict[str, Any]) -> None:
    scene = RadialSeaScene(with_parameters(compare=True, bodies=0, **changes))
    scene.frame()
    found = scene.readings().surfaces
    # Independent of both: the integral over the spectrum, with the decay of the fluids.
    choice = scene.wave_choice
    k, step = np.linspace(math.log(1e-3), math.log(30.0), 400, retstep=True)
    k, theta = np.exp(k)[:, None], np.arange(72) * (2.0 * math.pi / 72)
    S = choice.spectrum(k * np.cos(theta), k * np.sin(theta), choice.conditions)
    _, decay = scene.column.roots(k[:, 0])
    energy = (S * k**2).sum(axis=1) * np.exp(-2.0 * decay * scene.age) * step * 2.0 * math.pi / 72
    height = 4.0 * math.sqrt(energy.sum())
    for reading in found.values():
        assert reading.height == pytest.approx(height, rel=0.01)
        assert reading.error == pytest.approx(reading.height / height - 1.0, abs=1e-3)


def test_radiated_waves_are_laid_on_the_rings_that_they_reach(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = RadialSeaScene(with_parameters(bodies=0))
    laid = []
    monkeypatch.setattr(scene.radiated_waves, "lay", lambda t, vertices, slopes, count: laid.append(vertices.copy()))
    scene.advance(1)
    scene.frame()
    rings, centre = laid[-2:]
    assert len(rings) == scene.grid.spokes * (scene.grid.radii < 57.6).sum()
    assert np.hypot(*rings[:, :2].T).max() < 60.0
    assert len(centre) == 1
