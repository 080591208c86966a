"""The bodies of the radial sea: drafts in waves, the sum of Archimedes from the readings, own densities, the slick."""

import math

import numpy as np
import pytest

from app.scenes.quantities import measured
from app.scenes.radial_sea import SCENE
from app.scenes.radial_sea.moorings import LINE_REACH
from app.scenes.radial_sea.oil.well_blowout import JetTotal
from app.scenes.radial_sea.parameters import PRESETS, RadialSeaParams, weathered_oil
from app.scenes.radial_sea.report import forces_html
from app.scenes.radial_sea.scene import RadialSeaScene
from app.server.loop.sim_loop import SimLoop
from sim.floating import equilibrium_draft, submerged
from sim.floating.motion.heave_meter import HeaveMeter
from sim.parameters import check_record

CALM = {"waves": False, "rig": False, "ripples": False}


def scene_with(**changes) -> RadialSeaScene:
    return RadialSeaScene(check_record(RadialSeaParams, changes))


WINDOW = np.hanning(3600)[:, None] / np.hanning(3600).sum()  # a minute, its ends faded: no wave is cut


@pytest.mark.parametrize("preset", [pytest.param("Clear water", marks=pytest.mark.stress), "Storm with buoys"])
def test_in_waves_bodies_float_on_average_as_archimedes_says(preset: str) -> None:
    """Draft within 1 mm, buoyancy within 0.1 % of the weight: over a minute, and as the page shows them.

    A ball's mean draft differs from that at rest by -A'/(2 A) of the variance of its draft: its cuts differ in area.
    The mooring lines are level here, as others pull down.
    """
    scene = scene_with(**PRESETS[preset])
    lines = scene.bodies.moorings.lines
    lines.anchors[:, :, 2] = scene.bodies.fleet.position[:, None, 2] + scene.bodies.meters.keel[:, None]
    lines.length[:] = LINE_REACH
    bodies, drafts, forces = scene.bodies, [], []
    for _ in range(70 * 60):
        scene.advance(1)
        drafts.append(bodies.meters.draft.copy())
        forces.append(bodies.fleet.lift.copy())
    rest = np.array([bodies.prediction(i).draft for i in range(bodies.count)])
    last = np.array(drafts[-3600:])
    curved = np.zeros(bodies.count)
    radius = np.array([bodies.hulls[kind].size[0] / 2 for kind in bodies.kinds])
    area_change = (radius - rest) / (rest * (2 * radius - rest))
    curved[bodies.meters.is_round] = (-area_change * (last.var(axis=0)))[bodies.meters.is_round]
    assert (WINDOW * last).sum(axis=0) - rest - curved == pytest.approx(np.zeros(bodies.count), abs=1e-3)
    shown = np.array([body.mean_draft for body in bodies.readings(scene.time, bodies.count)])
    assert shown - rest - curved == pytest.approx(np.zeros(bodies.count), abs=1e-3)
    weight = bodies.fleet.mass * scene.column.gravity
    mean = (WINDOW[:, :, None] * np.array(forces[-3600:])).sum(axis=0) / weight[:, None]
    assert mean[:, 0] == pytest.approx(np.ones(bodies.count), abs=1e-3)
    assert mean.sum(axis=1) == pytest.approx(np.ones(bodies.count), abs=2e-4)  # no upward force is left out
    shown = np.array([body.mean_lift[0] for body in bodies.readings(scene.time, bodies.count)])
    assert shown / weight == pytest.approx(np.ones(bodies.count), abs=1e-3)


@pytest.mark.parametrize("spill", ["none", "layer", "mixed"])
def test_archimedes_sum_can_be_done_from_the_readings(spill: str) -> None:
    scene = scene_with(**CALM, spill=spill, thickness=0.15)
    for _ in range(20):
        scene.advance(1)
    densities = [density for density, _ in scene.column.layers]
    for reading in scene.readings().bodies:
        assert reading.mass == pytest.approx(reading.density * reading.volume)
        displaced = sum(rho * v for rho, v in zip(densities, reading.wet_volume, strict=False))
        assert 9.81 * displaced == pytest.approx(reading.buoyancy, rel=1e-12)
        assert reading.buoyancy == pytest.approx(9.81 * reading.mass, rel=1e-4)
    box = scene.readings().bodies[2]
    area = (1.2 * 1.5) ** 2
    assert sum(box.wet_volume) == pytest.approx(area * box.draft, rel=1e-4)
    assert box.wet_volume[0] == pytest.approx(area * (0.15 if spill == "layer" else box.draft), rel=1e-4)


def test_a_leaning_box_has_the_draft_of_its_wet_volume() -> None:
    scene = scene_with(**CALM)
    angle = 0.2
    scene.bodies.fleet.rotation[2] = (math.cos(angle / 2), math.sin(angle / 2), 0.0, 0.0)
    at = scene.sea.at(scene.bodies.fleet.position[:, :2], 0.0)
    scene.bodies.measure(0.0, at, 1 / 60)
    leaning = scene.bodies.meters.draft[2]
    hull = scene.bodies.hulls["crate"]
    found = submerged(hull, scene.bodies.fleet.position[2], scene.bodies.fleet.rotation[2])
    assert leaning == pytest.approx(found.volume / (1.2 * 1.5) ** 2, rel=1e-6)


def test_bodies_of_their_own_densities_float_at_their_own_drafts() -> None:
    scene = scene_with(**CALM, bodies=5, own_densities=True, density=500.0, density_1=200.0, density_3=800.0)
    assert scene.bodies.fleet.density.tolist() == [200.0, 600.0, 800.0, 500.0, 500.0]
    scene.change_forces(
        check_record(
            RadialSeaParams, {**CALM, "bodies": 5, "own_densities": True, "density_1": 300.0, "density_3": 700.0}
        )
    )
    assert scene.bodies.fleet.density.tolist() == [300.0, 600.0, 700.0, 450.0, 450.0]
    for _ in range(60 * 10):
        scene.advance(6)
    for i, reading in enumerate(scene.readings().bodies):
        hull = scene.bodies.hulls[reading.kind]
        rest = equilibrium_draft(hull, scene.bodies.densities[i], scene.column.layers)
        assert reading.prediction.draft == rest
        assert reading.draft == pytest.approx(rest, abs=1e-4)
    scene.change_forces(check_record(RadialSeaParams, {**CALM, "bodies": 5}))
    assert scene.bodies.fleet.density.tolist() == [450.0] * 5
    assert scene.bodies.fleet.mass[0] == pytest.approx(450.0 * scene.bodies.hulls["buoy_red"].volume)


@pytest.mark.long
def test_the_slick_of_the_jet_counts_at_rest() -> None:
    scene = scene_with(waves=False, ripples=False, jet=True, bodies=1)
    scene.well_blowout.closed_jets_total = JetTotal(2000.0, 2000.0, 100)
    for _ in range(100 * 6):
        scene.advance(10)
    slick = scene.well_blowout.slick(scene.column)
    assert slick is not None
    reading = scene.readings().bodies[0]
    layers = [(scene.column.oil.density, slick.thickness), (scene.column.water.density, math.inf)]
    hull = scene.bodies.hulls[reading.kind]
    assert slick.thickness > 2e-3
    assert reading.prediction.draft == pytest.approx(equilibrium_draft(hull, 450.0, layers), abs=2e-5)
    assert reading.draft == pytest.approx(reading.prediction.draft, abs=3e-4)
    added = reading.prediction.draft - reading.prediction.draft_in_water
    assert added == pytest.approx(slick.thickness * (1 - layers[0][0] / layers[1][0]), abs=2e-5)


def test_a_body_in_the_slick_is_predicted_in_its_oil() -> None:
    """And in the mixture alone if there is one: it takes the oil up."""
    for changes, is_layered in (({}, True), ({"spill": "layer"}, True), ({"spill": "mixed"}, False)):
        bodies = scene_with(**CALM, bodies=2, **changes).bodies
        column, before = bodies.column, [bodies.prediction(i).draft for i in range(2)]
        bodies.slick = np.array([0.0, 0.3])
        layers = ((column.oil.density, column.thickness + 0.3), (column.water.density, math.inf))
        expected = equilibrium_draft(bodies.hulls[bodies.kinds[1]], bodies.densities[1], layers)
        assert bodies.prediction(0).draft == before[0]
        assert bodies.prediction(1).draft == pytest.approx(expected if is_layered else before[1], abs=1e-9)
        assert abs(expected - before[1]) > 1e-3


def test_the_edge_of_the_slick_is_no_step() -> None:
    scene = scene_with(waves=False, jet=True)
    scene.well_blowout.closed_jets_total = JetTotal(500.0, 500.0, 100)
    scene.advance(60)
    slick = scene.well_blowout.slick(scene.column)
    assert slick is not None
    x = slick.centre[0] + slick.radius + np.linspace(-5.0, 1.0, 61)
    found = scene.slick_at(np.column_stack([x, np.full(61, slick.centre[1])]))
    assert found[0] == slick.thickness
    assert found[-1] == 0.0
    assert np.abs(np.diff(found)).max() < 0.05 * slick.thickness


def test_weights_and_forces_are_on_screen_and_in_sweeps() -> None:
    loop = SimLoop(scene_with(**CALM, spill="layer"))
    loop.tick(0.1)
    text = forces_html(loop.latest.readings)
    box = loop.latest.readings.bodies[2]
    for shown in (f"{box.mass:,.0f}", "wet in oil", "in water", "mean upward force"):
        assert shown.replace(",", "") in text.replace("\u202f", "").replace(",", ""), shown
    found = measured(SCENE, loop.scene)
    assert found["box_mass"].value == pytest.approx(box.density * box.volume)
    assert found["box_wet_volume_below"].value == box.wet_volume[1] != box.wet_volume[0]
    spill = weathered_oil(loop.scene.params)
    for name, value in {
        "evaporated": spill.evaporated, "dispersed": spill.dispersed, "water_content": spill.water_content,
        "slick_area": spill.area,
    }.items():  # fmt: skip
        assert found[name].value == value
    loop = SimLoop(scene_with(**CALM))
    loop.tick(0.1)
    text = forces_html(loop.latest.readings)
    assert "wet volume" in text
    assert "wet in oil" not in text


def test_a_mean_begins_anew_when_a_body_is_let_go() -> None:
    meter = HeaveMeter(2)
    for i in range(600):
        meter.update(i / 60, np.array([0.5, 0.5]), 1 / 60)
    meter.restart(0)
    for i in range(60):
        meter.update(10 + i / 60, np.array([0.7, 0.7]), 1 / 60)
    assert meter.mean.of(0)[0] == pytest.approx(0.7)
    # A sample stands for 0.1 s: 100 of 0.5 m, then 10 of 0.7 m, under a window that fades to nothing next to both ends.
    window = np.sin(np.pi * np.arange(1, 111) / 111) ** 2
    assert meter.mean.of(1)[0] == pytest.approx(0.5 + 0.2 * window[-10:].sum() / window.sum(), abs=1e-12)


def test_on_the_square_seas_surface_buoyancy_carries_the_weight_too() -> None:
    scene = scene_with(surface="fft")
    bodies, buoyancy = scene.bodies, []
    for _ in range(35 * 60):
        scene.advance(1)
        buoyancy.append(bodies.fleet.buoyancy + bodies.fleet.mooring[:, 2])  # lines pull down
    window = np.hanning(1800)[:, None] / np.hanning(1800).sum()
    mean = (window * np.array(buoyancy[-1800:])).sum(axis=0)
    assert mean / (bodies.fleet.mass * scene.column.gravity) == pytest.approx(np.ones(bodies.count), abs=2e-3)
