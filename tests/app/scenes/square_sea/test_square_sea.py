import dataclasses
import math
import re
from typing import Any

import numpy as np
import pytest

from app.messages import PointAlong, Reset
from app.scenes.quantities import measured
from app.scenes.square_sea import SCENE, report
from app.scenes.square_sea import scene as square_sea
from app.scenes.square_sea.parameters import (
    PLANET_TITLES,
    PRESETS,
    SquareSeaParams,
    conditions,
    gravity,
    rain_settings,
)
from app.scenes.square_sea.rainfall import RING_STEEPNESS, SeaRain
from app.scenes.square_sea.scene import SquareSeaScene
from app.scenes.square_sea.statistics import theory
from app.server.loop.sim_loop import SimLoop
from sim.ocean import Sea
from sim.ocean.spectra import SPECTRA
from sim.ocean.statistics.foam import slope_and_frequency, whitecaps
from sim.parameters import effect_of_change, parameters_of

Scene: Any = SquareSeaScene  # its frames and readings have more than every scene has
SMALL: dict[str, Any] = {"size": "64", "mesh": "32"}
EVERY_OTHER = {  # a parameter that is hidden by default, and what shows it
    "depth": {"deep": False}, "gravity": {"planet": "by gravity"}, "fetch": {"spectrum": "jonswap"},
    "peak_enhancement": {"spectrum": "tma"}, "swell": {"spectrum": "jonswap"},
    "spread_exponent": {"spreading": "cos2s"}, "inverse_wave_age": {"spectrum": "elfouhaily"},
    "phillips_constant": {"spectrum": "phillips"}, "foam_threshold": {"foam_by_wind": False},
    "drops": {"rain": 20.0, "length": 32.0}, "rings": {"rain": 20.0, "length": 32.0},
}  # fmt: skip


def change_parameters(scene: Any, **values: object) -> None:
    """Give the scene other parameters as the simulation loop does."""
    params = dataclasses.replace(scene.params, **values)
    effect = effect_of_change(scene.params, params)
    if effect == "forces":
        scene.change_forces(params)
    scene.params = params
    if effect == "start":
        scene.reset()


def run(scene: Any, frames: int, steps: int = 2) -> None:
    for _ in range(frames):
        scene.advance(steps)
        scene.frame()


def arrays(scene: Any) -> list[np.ndarray]:
    frame = scene.frame()
    found = [frame.vertices, frame.slopes, frame.foam]
    if frame.rain is not None:
        found += [frame.rain.drops, frame.rain.velocity, frame.rain.splashes]
    return found


@pytest.mark.parametrize("name", PRESETS)
def test_a_preset_runs_three_seconds_and_everything_drawn_is_finite(name):
    scene = Scene(SquareSeaParams(**PRESETS[name]))
    for _ in range(30):
        run(scene, 1, 6)
        assert all(np.isfinite(array).all() for array in arrays(scene))
    assert scene.time == pytest.approx(3.0)
    assert scene.readings().report.measured.significant_height > 0.0


@pytest.mark.parametrize(
    "change", [{"wind_speed": 22.0}, {"spectrum": "jonswap"}, {"planet_mass": 10.0}, {"deep": False}]
)
def test_new_weather_grows_out_of_the_sea_without_a_jump(change):
    scene = Scene(SquareSeaParams(**SMALL, foam=False, transition=10.0))
    scene.advance(180)
    before = scene.frame().vertices
    change_parameters(scene, **change)
    after = scene.frame().vertices
    assert after is not before
    assert np.abs(after - before).max() <= 1e-3 * np.abs(before[..., 2]).max()


def test_a_storm_arrives_from_a_calm_and_leaves_one():
    arriving = Scene(SquareSeaParams(**{**PRESETS["Storm arriving"], **SMALL, "rain": 0.0}))
    leaving = Scene(SquareSeaParams(**{**PRESETS["Storm over"], **SMALL}))
    heights = {scene: [] for scene in (arriving, leaving)}
    for scene, found in heights.items():
        for _ in range(5):
            found.append(scene.sea.significant_height_at(scene.time))
            scene.advance(600)
    assert heights[arriving] == sorted(heights[arriving])
    assert heights[arriving][-1] > 5.0 * heights[arriving][0]
    assert heights[leaving] == sorted(heights[leaving], reverse=True)
    assert heights[leaving][-1] < 0.4 * heights[leaving][0]


def test_a_frame_costs_three_transforms_and_one_without_choppiness():
    for choppiness, each in ((1.0, 3), (0.0, 1)):
        scene = Scene(SquareSeaParams(**SMALL, choppiness=choppiness))
        run(scene, 10)
        assert scene.counts["transforms"] == 10 * each
        assert scene.counts["steps"] == 20


def test_steps_cost_nothing_and_an_unchanged_sea_is_the_same_frame():
    scene = Scene(SquareSeaParams(**SMALL))
    scene.advance(10_000)
    assert scene.counts["transforms"] == 0
    assert scene.frame() is scene.frame()
    assert scene.counts["frames"] == 1


def test_a_new_look_on_a_paused_sea_computes_and_sends_no_surface():
    scene = Scene(SquareSeaParams(**SMALL))
    scene.advance(5)
    before, done = scene.frame(), scene.counts["transforms"]
    change_parameters(scene, clouds=0.9, daylight=0.3, grid=True)
    after = scene.frame()
    assert after.params.clouds == 0.9
    assert after.vertices is before.vertices  # what the viewer sends only where it is new
    assert scene.counts["transforms"] == done
    change_parameters(scene, amplitude=2.0)
    assert scene.frame().vertices is not before.vertices


def test_a_paused_sea_shows_its_wave_gauge_and_statistics_as_soon_as_they_are_wanted():
    scene = Scene(SquareSeaParams(**SMALL, statistics=False, gauge=False))
    scene.advance(5)
    assert scene.frame().gauge is None
    change_parameters(scene, statistics=True, plot_wave_gauge=True)
    assert scene.frame().gauge is not None
    assert scene.readings().report is not None
    assert scene.frame() is scene.frame()


def test_another_length_starts_the_sea_again_with_the_wave_gauge_where_a_new_scene_has_it():
    scene = Scene(SquareSeaParams(**SMALL, length=64.0))
    scene.handle(PointAlong((40.0, 60.0, 8.0), (0.9, 0.3, -0.12)))
    assert scene.gauge_placed
    scene.advance(5)
    change_parameters(scene, length=128.0)
    assert scene.time == 0.0
    assert scene.sea.length == 128.0
    assert scene.gauge.at == Scene(scene.params).gauge.at
    assert not scene.gauge_placed


def test_nobody_looking_costs_nothing():
    scene = Scene(SquareSeaParams(**SMALL, rain=20.0))
    loop = SimLoop(scene, audience=lambda: 0)
    done = dict(scene.counts)
    for _ in range(60):
        loop.tick(1 / 30)
    assert dict(scene.counts) == done


def test_without_rain_no_ring_is_begun_and_no_drop_falls():
    scene = Scene(SquareSeaParams(**SMALL, length=32.0))
    run(scene, 20)
    assert scene.counts["rings"] == scene.counts["rainfall steps"] == 0
    assert scene.sea._heights.ripples is None
    assert scene.frame().rain is None


def test_statistics_and_spectrum_are_computed_only_where_shown_and_a_hidden_gauge_is_read_for_the_plot_only():
    scene = Scene(SquareSeaParams(**SMALL, statistics=False, gauge=False))
    run(scene, 30)
    assert scene.counts["statistics"] == scene.counts["gauge spectra"] == 0
    rows = scene.take_plot_rows()
    assert scene.counts["gauge readings"] == len(rows) < 30
    # After the row of the first frame.
    assert np.diff([row[0] for row in rows[1:]]).min() > 0.99 * square_sea.PLOT_ROW_INTERVAL
    assert scene.readings().report is None
    shown = Scene(SquareSeaParams(**SMALL, plot_wave_gauge=True, plot_wave_spectrum=True))
    run(shown, 30)
    assert shown.counts["gauge readings"] == 31  # of the start, and of each frame
    assert 1 <= shown.counts["statistics"] <= 3


def test_slope_and_frequency_of_waves_that_stay_the_same_are_found_once() -> None:
    scene = Scene(SquareSeaParams(size="64", mesh="64", viscosity=0.0))
    for _ in range(100):
        scene.advance(4)
        scene.frame()
    assert scene.counts["slopes"] == 1
    before = scene.waves.slope, scene.waves.frequency
    scene.change_forces(SquareSeaParams(size="64", mesh="64", viscosity=0.0, wind_speed=20.0, transition=0.2))
    for _ in range(120):  # 8 s, or 40 transition times: the last are steady again
        scene.advance(4)
        scene.frame()
    assert (scene.waves.slope, scene.waves.frequency) != before
    assert 3 <= scene.counts["slopes"] < 14
    assert (scene.waves.slope, scene.waves.frequency) == slope_and_frequency(scene.sea, scene.time)
    decaying = Scene(SquareSeaParams(size="64", mesh="64", viscosity=1e-3))
    for _ in range(60):  # 4 s, every half of one
        decaying.advance(4)
        decaying.frame()
    assert decaying.counts["slopes"] >= 7


def test_the_rain_that_is_counted_is_the_rain_that_theory_has():
    scene = Scene(SquareSeaParams(**SMALL, length=32.0, wind_speed=3.0, rain=25.0, drops=1500, rings=0.0))
    run(scene, 30)  # a second for the first drops to reach the water
    rainfall = scene.rainfall
    begun, start = rainfall.rain.hits, scene.time
    run(scene, 240)
    hits = rainfall.rain.hits - begun
    expected = rainfall.rain.rainfall.flux * rainfall.span**2 * (scene.time - start)
    assert hits > 500
    assert hits * rainfall.rain.weight == pytest.approx(expected, rel=4.0 / math.sqrt(hits))
    assert scene.readings().rain.fallen == rainfall.rain.hits * rainfall.rain.weight


def test_rain_makes_rings_where_the_grid_can_carry_them():
    fine = Scene(SquareSeaParams(length=32.0, size="128", mesh="64", rain=25.0))
    run(fine, 60)
    assert fine.counts["rings"] == fine.rainfall.rain.hits > 0
    assert fine.sea.ripples.rms > 0.0
    coarse = Scene(SquareSeaParams(length=1024.0, size="128", mesh="64", rain=25.0))
    run(coarse, 60)
    assert coarse.rainfall.rain.hits > 0
    assert coarse.counts["rings"] == 0
    assert coarse.readings().rain.drops_per_ring == 0.0


def test_a_ring_is_as_deep_as_its_blow_says():
    sea = Sea(256, 32.0, wind_speed=0.0, choppiness=0.0)
    settings = rain_settings(SquareSeaParams(rain=25.0, drops=100, wind_speed=0.0))
    rainfall = SeaRain(sea, settings, 1.0, 0)
    sea.ripples.add(0.0, [[16.0, 16.0]], rainfall.ring_width, impulse=rainfall.drops_per_ring * rainfall.momentum)
    deepest = min(float(sea.surface(t).height[128, 128]) for t in np.linspace(0.0, 0.6, 61))
    assert -deepest == pytest.approx(RING_STEEPNESS * rainfall.ring_width, rel=0.03)


def test_the_sea_is_as_white_as_monahan_measured():
    """Cover over Monahan's law at three winds: its mean over the first 5 s, and over 15 to 30 s, when it is steady."""
    first, later = [], []
    for wind in (10.0, 15.0, 25.0):
        scene = Scene(SquareSeaParams(wind_speed=wind, length=512.0, size="128", statistics=False))
        cover = []
        for _ in range(900):
            run(scene, 1)
            cover.append(scene.foam.cover / whitecaps(wind))
        first.append(np.mean(cover[:150]))
        later.append(np.mean(cover[450:]))
    assert np.mean(first) == pytest.approx(1.0, abs=0.1)
    assert later == pytest.approx([1.0] * 3, abs=0.06)


def test_foam_fades_over_its_lifetime():
    scene = Scene(SquareSeaParams(**SMALL, wind_speed=15.0, foam_by_wind=False, foam_threshold=0.7, foam_fade=3.0))
    run(scene, 30)
    before, since = scene.frame().foam, scene.time
    change_parameters(scene, foam_threshold=-1.0)  # no new foam
    run(scene, 60)
    assert before.max() > 0.5
    assert scene.frame().foam == pytest.approx(before * math.exp(-(scene.time - since) / 3.0), abs=1e-5)


def test_the_cover_expected_goes_from_one_wind_s_to_the_other_s_as_the_waves_do():
    scene = Scene(SquareSeaParams(**SMALL, wind_speed=8.0, transition=10.0))
    run(scene, 30)
    change_parameters(scene, wind_speed=15.0)
    since = scene.time
    run(scene, 150)
    part = math.exp(-(scene.time - since) / 10.0)
    expected = whitecaps(15.0) + (whitecaps(8.0) - whitecaps(15.0)) * part
    assert 0.3 < part < 0.7
    assert scene.readings().expected_foam_cover == pytest.approx(expected, rel=1e-6)


def test_slopes_of_the_mesh_are_those_of_the_displaced_surface():
    scene = Scene(SquareSeaParams(size="128", mesh="128", length=512.0, choppiness=0.6, low_pass=8.0))
    scene.advance(60)
    frame = scene.frame()
    surface = scene.sea.surface(scene.time)
    Dxx, Dyy, Dxy = surface.strain
    hx, hy = surface.slope[..., 0], surface.slope[..., 1]
    J = surface.jacobian
    exact = np.stack([((1 + Dyy) * hx - Dxy * hy) / J, ((1 + Dxx) * hy - Dxy * hx) / J], axis=-1)
    assert J.min() > 0.3
    assert np.sqrt(np.mean((frame.slopes - exact) ** 2)) < 0.01 * np.sqrt(np.mean(exact**2))


def test_the_amplitude_scales_heights_and_displacements_alike():
    plain, double = (Scene(SquareSeaParams(**SMALL, amplitude=a, foam=False)) for a in (1.0, 2.0))
    rest = np.arange(32) * plain.params.length / 32
    flat = np.stack([*np.meshgrid(rest, rest, indexing="ij"), np.zeros((32, 32))], -1)
    moved = [scene.frame().vertices - flat for scene in (plain, double)]
    means = [a * scene.sea.surface(scene.time).mean_height for a, scene in ((1.0, plain), (2.0, double))]
    assert means[1] == pytest.approx(4.0 * means[0], rel=1e-5)  # of second order
    for each, mean in zip(moved, means, strict=True):
        each[..., 2] -= mean
    np.testing.assert_allclose(moved[1], 2.0 * moved[0], rtol=1e-3, atol=1e-4)


def test_a_click_puts_the_wave_gauge_where_the_ray_meets_the_water():
    scene = Scene(SquareSeaParams(**SMALL))
    scene.advance(60)
    scene.frame()
    origin, direction = (40.0, 60.0, 8.0), (0.9, 0.3, -0.12)
    scene.handle(PointAlong(origin, direction))
    scene.advance(1)
    x, y, z = scene.frame().gauge
    height, _ = scene.sea.height_at([[x, y]], scene.time)
    assert z == pytest.approx(float(height[0]), abs=1e-4)
    along = ((x - origin[0]) * direction[0] + (y - origin[1]) * direction[1]) / (0.9**2 + 0.3**2)
    assert (x, y) == pytest.approx((origin[0] + along * direction[0], origin[1] + along * direction[1]))
    assert z == pytest.approx(origin[2] + along * direction[2], abs=0.1)


@pytest.mark.parametrize(
    "ray",
    [((0.0, 0.0, 5.0), (0.0, 0.0, 1.0)), ((0.0, 0.0, -50.0), (0.0, 0.0, -1.0)), ((0.0, 0.0, 5.0), (0.0, 0.0, 0.0))],
)
def test_a_click_that_meets_no_water_moves_nothing(ray):
    scene = Scene(SquareSeaParams(**SMALL))
    at = scene.gauge.at
    scene.handle(PointAlong(*ray))
    assert scene.gauge.at == at
    assert not scene.gauge_placed


def test_the_wave_gauge_finds_the_energy_of_the_sea_in_its_trace():
    scene = Scene(SquareSeaParams(**SMALL, wind_speed=6.0, plot_wave_spectrum=True, statistics=False, foam=False))
    run(scene, 4000, 6)  # 400 s
    f, measured, theory = scene.curves()["plot_wave_spectrum"]
    band = f[1] - f[0]
    drawn = (scene.sea.significant_height / 4.0) ** 2
    assert measured.sum() * band == pytest.approx(drawn, rel=0.35)  # one place of a sea of few waves
    assert theory.sum() * band == pytest.approx(0.99 * float(scene.sea.energy_at(scene.time).sum()), rel=0.02)
    assert (f * measured).sum() / measured.sum() == pytest.approx((f * theory).sum() / theory.sum(), rel=0.15)


def test_the_wave_gauge_forgets_what_comes_after_a_checkpoint_and_nothing_else():
    scene = Scene(SquareSeaParams(**SMALL, plot_wave_spectrum=True, statistics=False))
    run(scene, 10)
    kept, trace = scene.keep(), list(scene.gauge.trace)
    run(scene, 10)
    scene.resume(kept)
    assert list(scene.gauge.trace) == trace != []


def test_another_size_shows_the_same_sea_and_keeps_time():
    scene = Scene(SquareSeaParams(size="128", mesh="64"))
    scene.advance(100)
    shared = scene.sea.amplitudes_at(scene.time)[:20, :20]
    change_parameters(scene, size="64")
    np.testing.assert_allclose(scene.sea.amplitudes_at(scene.time)[:20, :20], shared)
    assert scene.time == pytest.approx(100 / 60)


def test_a_reset_is_the_same_sea_again():
    scene = Scene(SquareSeaParams(**{**PRESETS["Storm arriving"], **SMALL}))
    first = scene.frame().vertices
    run(scene, 20)
    loop = SimLoop(scene)
    loop.handle(Reset())
    np.testing.assert_array_equal(scene.frame().vertices, first)
    assert scene.time == 0.0


def ends() -> list[tuple[str, object]]:
    found = []
    for name, parameter in parameters_of(SquareSeaParams).items():
        values = parameter.choices or (
            (False, True) if parameter.kind is bool else (parameter.kind(parameter.low), parameter.kind(parameter.high))
        )
        found += [(name, value) for value in values]
    return found


@pytest.mark.parametrize(("name", "value"), ends())
def test_both_ends_of_every_parameter_survive(name, value):
    start = SquareSeaParams(**{**SMALL, **EVERY_OTHER.get(name, {})})
    scene = Scene(start)
    run(scene, 3)
    # Set live, and from the start.
    change_parameters(scene, **{name: value})
    run(scene, 60)
    fresh = Scene(dataclasses.replace(start, **{name: value}))
    run(fresh, 3)
    for each in (scene, fresh):
        assert all(np.isfinite(array).all() for array in arrays(each))
        assert math.isfinite(each.readings().foam_cover)


@pytest.mark.parametrize("spectrum", SPECTRA)
@pytest.mark.parametrize("wind", [0.0, 1e-200, 0.05, 60.0])
def test_any_wind_makes_a_finite_sea(spectrum, wind):
    scene = Scene(SquareSeaParams(**SMALL, spectrum=spectrum, wind_speed=wind, planet_mass=0.01, deep=False, depth=0.1))
    run(scene, 2)
    assert all(np.isfinite(array).all() for array in arrays(scene))
    assert conditions(scene.params)["wind_speed"] == SPECTRA[spectrum].wind_speed(wind)


def test_the_warm_up_compiles_what_a_scene_calls():
    pieces = square_sea.warm_up()
    assert len(pieces) == 5
    for compile_piece in pieces.values():
        compile_piece()


@pytest.mark.parametrize("name", PRESETS)
def test_the_panel_has_words_for_every_preset(name):
    loop = SimLoop(Scene(SquareSeaParams(**{**PRESETS[name], **SMALL, "plot_wave_gauge": True})))
    for _ in range(40):
        loop.tick(1 / 30)
    assert set(report.marks(loop.latest)) <= set(parameters_of(SquareSeaParams))
    texts = [report.readout(loop.latest), *report.marks(loop.latest).values()]
    assert all(texts)
    assert not any(re.search(r"\b(nan|inf)\b", text) for text in texts)


@pytest.mark.parametrize("change", [{"deep": False}, {"planet": "Enceladus"}, {"wind_speed": 0.0}])
def test_the_dominant_waves_have_a_length_where_there_are_waves(change):
    loop = SimLoop(Scene(SquareSeaParams(**change)))
    loop.tick(1 / 30)
    found = {name: quantity.value(loop.latest) for name, quantity in SCENE.quantities.items() if quantity.shown}
    has_waves = "wind_speed" not in change
    assert math.isfinite(found["wave_length"]) == math.isfinite(found["open_speed"]) == has_waves
    assert (found["open_height"] > 0.0) == has_waves


def test_a_sweep_records_the_highest_crest_and_the_waves_about_the_peak():
    scene = Scene(SquareSeaParams(size="128", mesh="64", amplitude=1.5))
    scene.advance(2)
    found = {name: measure.value for name, measure in measured(SCENE, scene).items()}
    assert found["crest_height"] == pytest.approx(1.5 * scene.sea.surface(scene.time).height.max(), rel=1e-6)
    length = 9.81 * found["expected_period"] ** 2 / (2.0 * math.pi)  # of deep water
    assert found["wave_length"] == pytest.approx(length, rel=0.1)
    assert found["wave_speed"] == pytest.approx(found["wave_length"] / found["expected_period"], rel=1e-9)
    stated = theory(scene.sea, scene.time, scene.params)
    expected = {
        "expected_height": stated.statistics.significant_height, "expected_slope": stated.statistics.mean_square_slope,
        "height_scatter": stated.scatter, "endless_height": stated.whole,
    }  # fmt: skip
    assert {name: found[name] for name in expected} == expected


def test_an_earth_of_the_list_and_one_by_mass_have_one_gravity() -> None:
    earth, by_mass = SquareSeaParams(planet="Earth"), SquareSeaParams(planet="by mass", planet_mass=1.0)
    assert gravity(earth) == gravity(by_mass)
    assert f"{gravity(earth):g} m/s²" in PLANET_TITLES["Earth"]
