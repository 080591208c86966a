import dataclasses
import math
import re

import numpy as np
import pytest

from app import pictures
from app.messages import Point, Reset
from app.scenes.square_sea import report as sea_report
from app.scenes.square_sea import scene as phillips
from app.scenes.square_sea.parameters import conditions
from app.scenes.square_sea.scene import PRESETS, Params, Scene
from app.server.loop import SimLoop
from sim.ocean import Sea
from sim.ocean.foam import whitecaps
from sim.parameters import parameters_of

SMALL = {"size": "64", "mesh": "32"}
EVERY_OTHER = {  # a parameter that is hidden by default, and what shows it
    "depth": {"deep": False},
    "gravity": {"planet": "by gravity"},
    "fetch": {"spectrum": "jonswap"},
    "peak_enhancement": {"spectrum": "tma"},
    "swell": {"spectrum": "jonswap"},
    "inverse_wave_age": {"spectrum": "elfouhaily"},
    "phillips_constant": {"spectrum": "phillips"},
    "foam_threshold": {"foam_by_wind": False},
    "drops": {"rain": 20.0, "length": 32.0},
    "rings": {"rain": 20.0, "length": 32.0},
}


def run(scene: Scene, frames: int, steps: int = 2) -> None:
    for _ in range(frames):
        scene.advance(steps)
        scene.frame()


def arrays(scene: Scene) -> list[np.ndarray]:
    picture = scene.frame()
    found = [picture.vertices, picture.slopes, picture.foam]
    if picture.rain is not None:
        found += [picture.rain.drops, picture.rain.velocity, picture.rain.splashes]
    return found


def test_the_presets_are_the_six_and_the_first_is_the_defaults():
    names = ["earth breeze", "storm arriving", "storm over", "light planet", "heavy planet", "rain shower"]
    assert [name.lower() for name in PRESETS] == names
    assert PRESETS["Earth breeze"] == {}


@pytest.mark.parametrize("name", PRESETS)
def test_a_preset_runs_three_seconds_and_everything_drawn_is_finite(name):
    scene = Scene(Params(**PRESETS[name]))
    for _ in range(30):
        run(scene, 1, 6)
        assert all(np.isfinite(array).all() for array in arrays(scene))
    assert scene.time == pytest.approx(3.0)
    assert scene.readings().report.measured.significant_height > 0.0


@pytest.mark.parametrize(
    "change", [{"wind_speed": 22.0}, {"spectrum": "jonswap"}, {"planet_mass": 10.0}, {"deep": False}]
)
def test_new_weather_grows_out_of_the_sea_without_a_jump(change):
    scene = Scene(Params(**SMALL, foam=False, transition=10.0))
    scene.advance(180)
    before = scene.frame().vertices
    scene.set_params(dataclasses.replace(scene.params, **change))
    after = scene.frame().vertices
    assert after is not before
    assert np.abs(after - before).max() <= 1e-3 * np.abs(before[..., 2]).max()


def test_a_storm_arrives_from_a_calm_and_leaves_one():
    arriving = Scene(Params(**{**PRESETS["Storm arriving"], **SMALL, "rain": 0.0}))
    leaving = Scene(Params(**{**PRESETS["Storm over"], **SMALL}))
    heights = {scene: [] for scene in (arriving, leaving)}
    for scene, found in heights.items():
        for _ in range(5):
            found.append(scene.sea.significant_height_at(scene.time))
            scene.advance(600)
    assert heights[arriving] == sorted(heights[arriving])
    assert heights[arriving][-1] > 5.0 * heights[arriving][0]
    assert heights[leaving] == sorted(heights[leaving], reverse=True)
    assert heights[leaving][-1] < 0.4 * heights[leaving][0]


def test_a_picture_costs_three_transforms_and_one_without_choppiness():
    for choppiness, each in ((1.0, 3), (0.0, 1)):
        scene = Scene(Params(**SMALL, choppiness=choppiness))
        run(scene, 10)
        assert scene.counts["transforms"] == 10 * each
        assert scene.counts["steps"] == 20


def test_steps_cost_nothing_and_an_unchanged_sea_is_the_same_picture():
    scene = Scene(Params(**SMALL))
    scene.advance(10_000)
    assert scene.counts["transforms"] == 0
    assert scene.frame() is scene.frame()
    assert scene.counts["pictures"] == 1


def test_a_new_look_on_a_paused_sea_computes_and_sends_no_surface():
    scene = Scene(Params(**SMALL))
    scene.advance(5)
    before, done = scene.frame(), scene.counts["transforms"]
    scene.set_params(dataclasses.replace(scene.params, clouds=0.9, daylight=0.3, grid=True))
    after = scene.frame()
    assert after.params.clouds == 0.9
    assert after.vertices is before.vertices  # what the viewer sends only where it is new
    assert scene.counts["transforms"] == done
    scene.set_params(dataclasses.replace(scene.params, amplitude=2.0))
    assert scene.frame().vertices is not before.vertices


def test_nobody_looking_costs_nothing():
    scene = Scene(Params(**SMALL, rain=20.0))
    loop = SimLoop(scene, audience=lambda: 0)
    done = dict(scene.counts)
    for _ in range(60):
        loop.tick(1 / 30)
    assert dict(scene.counts) == done


def test_without_rain_no_ring_is_begun_and_no_drop_falls():
    scene = Scene(Params(**SMALL, length=32.0))
    run(scene, 20)
    assert scene.counts["rings"] == scene.counts["showers"] == 0
    assert scene.sea._ripples is None
    assert scene.frame().rain is None


def test_statistics_probe_and_spectrum_are_computed_only_where_shown():
    scene = Scene(Params(**SMALL, statistics=False))
    run(scene, 30)
    assert scene.counts["statistics"] == scene.counts["probe readings"] == scene.counts["probe spectra"] == 0
    assert scene.readings().report is None
    shown = Scene(Params(**SMALL, plot_probe=True, plot_spectrum=True))
    run(shown, 30)
    assert shown.counts["probe readings"] == 30
    assert 1 <= shown.counts["statistics"] <= 3


def test_the_rain_that_is_counted_is_the_rain_that_theory_has():
    scene = Scene(Params(**SMALL, length=32.0, wind_speed=3.0, rain=25.0, drops=1500, rings=0.0))
    run(scene, 30)  # a second for the first drops to reach the water
    shower = scene.shower
    begun, start = shower.rain.hits, scene.time
    run(scene, 240)
    hits = shower.rain.hits - begun
    expected = shower.rain.rainfall.flux * shower.span**2 * (scene.time - start)
    assert hits > 500
    assert hits * shower.rain.weight == pytest.approx(expected, rel=4.0 / math.sqrt(hits))
    assert scene.readings().rain.fallen == shower.rain.hits * shower.rain.weight


def test_rain_makes_rings_where_the_grid_can_carry_them():
    fine = Scene(Params(length=32.0, size="128", mesh="64", rain=25.0))
    run(fine, 60)
    assert fine.counts["rings"] == fine.shower.rain.hits > 0
    assert fine.sea.ripples.rms > 0.0
    coarse = Scene(Params(length=1024.0, size="128", mesh="64", rain=25.0))
    run(coarse, 60)
    assert coarse.shower.rain.hits > 0
    assert coarse.counts["rings"] == 0
    assert coarse.readings().rain.drops_a_ring == 0.0


def test_a_ring_is_as_deep_as_its_blow_says():
    from app.scenes.square_sea.rainfall import STEEPNESS, Rainfall

    sea = Sea(256, 32.0, wind_speed=0.0, choppiness=0.0)
    shower = Rainfall(sea, 25.0, 100, (0.0, 0.0), 1.0, 1.0, 0)
    sea.ripples.add(0.0, [[16.0, 16.0]], shower.width, impulse=shower.drops_a_ring * shower.momentum)
    deepest = min(float(sea.surface(t).height[128, 128]) for t in np.linspace(0.0, 0.6, 61))
    assert -deepest == pytest.approx(STEEPNESS * shower.width, rel=0.03)


def test_the_sea_is_as_white_as_monahan_measured():
    scene = Scene(Params(wind_speed=15.0, length=512.0, size="128", statistics=False))
    covered = []
    for frame in range(900):
        run(scene, 1)
        if frame >= 450:
            covered.append(scene.covered)
    assert np.mean(covered) == pytest.approx(whitecaps(15.0), rel=0.15)


def test_slopes_of_the_mesh_are_those_of_the_displaced_surface():
    scene = Scene(Params(size="128", mesh="128", length=512.0, choppiness=0.6, low_pass=8.0))
    scene.advance(60)
    picture = scene.frame()
    surface = scene.sea.surface(scene.time)
    Dxx, Dyy, Dxy = surface.strain
    hx, hy = surface.slope[..., 0], surface.slope[..., 1]
    J = surface.jacobian
    exact = np.stack([((1 + Dyy) * hx - Dxy * hy) / J, ((1 + Dxx) * hy - Dxy * hx) / J], axis=-1)
    assert J.min() > 0.3
    assert np.sqrt(np.mean((picture.slopes - exact) ** 2)) < 0.01 * np.sqrt(np.mean(exact**2))


def test_the_amplitude_scales_heights_and_displacements_alike():
    plain, double = (Scene(Params(**SMALL, amplitude=a, foam=False)) for a in (1.0, 2.0))
    rest = np.arange(32) * plain.params.length / 32
    flat = np.stack([*np.meshgrid(rest, rest, indexing="ij"), np.zeros((32, 32))], -1)
    np.testing.assert_allclose(
        double.frame().vertices - flat, 2.0 * (plain.frame().vertices - flat), rtol=1e-3, atol=1e-4
    )


def test_a_click_puts_the_probe_where_the_ray_meets_the_water():
    scene = Scene(Params(**SMALL))
    scene.advance(60)
    scene.frame()
    origin, direction = (40.0, 60.0, 8.0), (0.9, 0.3, -0.12)
    scene.handle(Point(origin, direction))
    scene.advance(1)
    x, y, z = scene.frame().probe
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
    scene = Scene(Params(**SMALL))
    at = scene.probe.at
    scene.handle(Point(*ray))
    assert scene.probe.at == at
    assert not scene.placed


def test_the_probe_finds_the_energy_of_the_sea_in_its_trace():
    scene = Scene(Params(**SMALL, wind_speed=6.0, plot_spectrum=True, statistics=False, foam=False))
    run(scene, 4000, 6)  # 400 s
    f, measured, theory = scene.curves()["plot_spectrum"]
    band = f[1] - f[0]
    drawn = (scene.sea.significant_height / 4.0) ** 2
    assert measured.sum() * band == pytest.approx(drawn, rel=0.35)  # one place of a sea of few waves
    assert theory.sum() * band == pytest.approx(0.99 * float(scene.sea.energy_at(scene.time).sum()), rel=0.02)
    assert (f * measured).sum() / measured.sum() == pytest.approx((f * theory).sum() / theory.sum(), rel=0.15)


def test_another_size_shows_the_same_sea_and_keeps_time():
    scene = Scene(Params(size="128", mesh="64"))
    scene.advance(100)
    shared = scene.sea.amplitudes_at(scene.time)[:20, :20]
    scene.set_params(dataclasses.replace(scene.params, size="64"))
    np.testing.assert_allclose(scene.sea.amplitudes_at(scene.time)[:20, :20], shared)
    assert scene.time == pytest.approx(100 / 60)


def test_a_reset_is_the_same_sea_again():
    scene = Scene(Params(**{**PRESETS["Storm arriving"], **SMALL}))
    first = scene.frame().vertices
    run(scene, 20)
    loop = SimLoop(scene)
    loop.handle(Reset())
    np.testing.assert_array_equal(scene.frame().vertices, first)
    assert scene.time == 0.0


def ends() -> list[tuple[str, object]]:
    found = []
    for name, parameter in parameters_of(Params).items():
        values = parameter.choices or (
            (False, True) if parameter.kind is bool else (parameter.kind(parameter.low), parameter.kind(parameter.high))
        )
        found += [(name, value) for value in values]
    return found


@pytest.mark.parametrize(("name", "value"), ends())
def test_both_ends_of_every_parameter_survive(name, value):
    start = Params(**{**SMALL, **EVERY_OTHER.get(name, {})})
    scene = Scene(start)
    run(scene, 3)
    # Set live, and from the start.
    scene.set_params(dataclasses.replace(start, **{name: value}))
    run(scene, 60)
    fresh = Scene(dataclasses.replace(start, **{name: value}))
    run(fresh, 3)
    for each in (scene, fresh):
        assert all(np.isfinite(array).all() for array in arrays(each))
        assert math.isfinite(each.readings().foam)


@pytest.mark.parametrize("spectrum", ["phillips", "pierson_moskowitz", "jonswap", "tma", "elfouhaily"])
@pytest.mark.parametrize("wind", [0.0, 1e-200, 0.05, 60.0])
def test_any_wind_makes_a_finite_sea(spectrum, wind):
    scene = Scene(Params(**SMALL, spectrum=spectrum, wind_speed=wind, planet_mass=0.01, deep=False, depth=0.1))
    run(scene, 2)
    assert all(np.isfinite(array).all() for array in arrays(scene))
    assert conditions(scene.params)["wind_speed"] in (0.0, wind)


def test_the_warm_up_compiles_what_a_scene_calls():
    assert len(list(phillips.warm_up())) == 5


@pytest.mark.parametrize("name", PRESETS)
def test_the_panel_has_words_for_every_preset(name):
    picture = pictures.view_named("phillips")
    loop = SimLoop(Scene(Params(**{**PRESETS[name], **SMALL, "plot_probe": True})))
    for _ in range(40):
        loop.tick(1 / 30)
    assert set(picture.marks(loop.latest)) <= set(parameters_of(Params))
    texts = [picture.readout(loop.latest), *picture.marks(loop.latest).values()]
    texts += picture.notes(loop.latest).values()
    assert all(texts)
    assert not any(re.search(r"\b(nan|inf)\b", text) for text in texts)
    assert "Lab says, physics says" in picture.notes(loop.latest)


@pytest.mark.parametrize("change", [{"deep": False}, {"planet": "Enceladus"}, {"wind_speed": 0.0}])
def test_the_dominant_waves_have_a_length_or_no_words(change):
    scene = Scene(Params(**change))
    scene.advance(1)
    picture, gauge = scene.frame(), scene.readings()
    words = sea_report.lab_says(picture.params, gauge.report)
    assert not re.search(r"\bnan\b", words)
    assert ("dominant waves here" in words) == (gauge.report.theory.wave[0] > 0.0) == ("wind_speed" not in change)
