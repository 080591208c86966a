"""The functions of the water's shader, as Chromium compiles them, against closed forms and the same sums in numpy."""

import itertools
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from app.render.material import Waterline, waterline_table
from sim.ocean.oil_film import APPEARANCES, EXTINCTION, light_through, mirrored_light
from sim.particles.rain_rings import ring_wave
from tests.app.render import shader_twin
from tests.browser.glsl import evaluate

POINTS = np.random.default_rng(1).uniform(-300.0, 300.0, (40_000, 2))
FOOTPRINT = 0.65 / 1080 / np.sqrt(0.3)  # over the distance, seen from 0.3 of it above the water, 1080 rows in 0.65 rad


@pytest.fixture(scope="module")
def page(chromium: Any) -> Iterator[Any]:
    page = chromium.new_page()
    yield page
    page.close()


def test_reflectance_is_fresnel_s_averaged_over_cox_and_munk_s_facets(page: Any) -> None:
    t = np.linspace(-7.0, 7.0, 181)
    chance = np.exp(-0.5 * t * t)
    table = [
        (np.cos(np.radians(degrees)), rms, index)
        for index in (1.333, 1.48)
        for degrees in (0.0, 20.0, 40.0, 50.0, 60.0, 70.0, 75.0, 80.0, 85.0, 88.0)
        for rms in (0.03, 0.1, 0.15, 0.2, 0.25)
    ]
    expected = []
    for c, rms, index in table:
        along, across = rms * t[:, None], rms * t[None, :]
        seen = np.maximum(c - along * np.sqrt(1.0 - c * c), 0.0)
        weight = chance[:, None] * chance * seen
        facets = shader_twin.fresnel(seen / np.sqrt(1.0 + along**2 + across**2), index)
        expected.append(float((weight * facets).sum() / weight.sum()))
    found = evaluate(page, "vec4(roughMirror(p.x, p.y, p.z), fresnel(p.x, p.z), 0.0)", np.array(table))
    np.testing.assert_allclose(found[:, 0], expected, rtol=0.03)
    smooth = [shader_twin.fresnel(np.float64(c), index) for c, _, index in table]
    np.testing.assert_allclose(found[:, 2], smooth, rtol=1e-3)


def test_oil_has_the_colours_of_its_thickness(page: Any) -> None:
    """Over all classes of the Bonn Agreement's code: what is mirrored, and what light is let through."""
    bounds = [*APPEARANCES.values(), 1e-3]
    thickness = np.concatenate([np.geomspace(low, high, 12) for low, high in itertools.pairwise(bounds)])
    index, water = 1.48, 1.333
    uniforms = {"oilFilm": (index, water, 1.0), "oilExtinction": EXTINCTION}
    gain = evaluate(page, "vec4(filmGain(p.x, 1.0), 0.0)", thickness[:, None], uniforms)[:, :3]
    through = evaluate(page, "vec4(lightThrough(p.x), 0.0)", thickness[:, None], uniforms)[:, :3]
    face = ((1.0 - index) / (1.0 + index)) ** 2
    np.testing.assert_allclose(gain * face, mirrored_light(thickness, index, water), rtol=2e-3)
    np.testing.assert_allclose(through, light_through(thickness), atol=1e-5)


@pytest.mark.parametrize("distance", [5.0, 50.0, 500.0])
def test_normals_drawn_and_filtered_have_the_spectrum_s_slope_variance(page: Any, distance: float) -> None:
    """Ripples of the shader, and the simulated waves of a tile, at the pixel that is seen at this distance."""
    footprint = distance * FOOTPRINT
    points = np.column_stack([POINTS, np.full(len(POINTS), footprint)])
    for rms, longest, shortest in ((0.2, 3.75, 0.051), (0.12, 1.6, 0.05)):
        uniforms = {"ripple": (rms, longest, shortest), "wind": (0.4, 9.81, 1.0)}
        slope = evaluate(page, "ripples(p.xy, p.z)", points, uniforms)
        variance = (slope[:, :2] ** 2).sum(-1).mean() + slope[:, 2].mean()
        assert variance == pytest.approx(rms**2, rel=0.05)
    n, length = 64, 64.0
    noise = np.random.default_rng(2).normal(size=(n, n))
    k = np.fft.fftfreq(n)[:, None], np.fft.fftfreq(n)[None, :]
    wave = np.fft.fft2(noise) * np.exp(-(((np.hypot(*k) - 0.12) / 0.08) ** 2))
    slopes = np.stack([np.fft.ifft2(1j * one * wave).real for one in k], -1)
    tile = np.dstack([slopes, np.zeros((n, n)), (slopes**2).sum(-1)])
    grid = {"grid": (n + 1, n + 1, length), "extent": (5.0, 1.0, 0.0)}
    level = max(np.log2(footprint * n / length), 0.0)
    for share in (0.0, 0.5, 1.0):
        points[:, 2] = share
        drawn = evaluate(page, f"wavesAt(waveSlopes, p.xy, p.z, {level:.3f}, true)", points, grid, tile)
        total = (drawn[:, :2] ** 2).sum(-1).mean() + drawn[:, 3].mean()
        assert total == pytest.approx((slopes**2).sum(-1).mean(), rel=0.05), share


def test_foam_and_rings_have_the_shares_that_they_are_told(page: Any) -> None:
    points = np.column_stack([POINTS, np.zeros(len(POINTS))])
    for share in (0.1, 0.35, 0.7):
        points[:, 2] = share
        cover = evaluate(page, "foamCover(p.xy, p.z, 0.01)", points, {"wind": (0.4, 9.81, 1.0)})[:, 0]
        assert cover.mean() == pytest.approx(share, abs=0.015)
    wavelength, speed = ring_wave(9.81)
    for share in (0.3, 0.9):
        life = shader_twin.constant("RING_REACH") * wavelength / speed
        side = shader_twin.constant("RING_CELL") * wavelength
        flux = share * shader_twin.constant("RING_LAYERS") / (life * side**2)
        uniforms = {"rainRings": (flux, wavelength, speed), "seaState": (3.1, 0.5, 0.0)}
        rings = evaluate(page, "rainSlopes(0.03 * p.xy, 0.0)", POINTS, uniforms)
        expected = share * shader_twin.constant("RING_VARIANCE")
        assert (rings[:, :2] ** 2).sum(-1).mean() == pytest.approx(expected, rel=0.06)


def test_rays_from_the_water_meet_what_stands_in_it_and_above_it(page: Any) -> None:
    """A box of 4 m by 2 m and 3 m high that is turned by a right angle, 10 m away, and a deck from 8 to 9 m over it."""
    box = Waterline((10.0, 0.0), np.pi / 2, (1.9, 0.9), 0.1, 3.0, color=(1.0, 0.0, 0.0))
    deck = Waterline((10.0, 0.0), 0.0, (1.9, 1.9), 0.1, 9.0, 8.0, (0.0, 0.0, 1.0))
    uniforms = {f"waterlines[{k}]": row for k, row in enumerate(waterline_table([box, deck]))}
    rises = {0.1: (1.0, 0.0), 0.25: (1.0, 0.0), 0.6: (0.0, 0.0), 1.05: (0.0, 1.0), 1.5: (0.0, 0.0)}  # red, blue
    rays = np.array([(1.0, 0.0, rise) for rise in rises] + [(-1.0, 0.0, 0.1), (1.0, 0.35, 0.1), (1.0, 0.15, 0.1)])
    expected = [*rises.values(), (0.0, 0.0), (0.0, 0.0), (1.0, 0.0)]
    met = evaluate(page, "mirroredHulls(vec3(0.0), normalize(p.xyz), 0.002, vec3(1.0))", rays, uniforms)
    np.testing.assert_allclose(met[:, [0, 2]], expected, atol=0.02)
    np.testing.assert_allclose(met[:, 3], np.sum(expected, axis=1), atol=0.02)
    # Facets that are tilted spread the rays: what is small and far is mirrored in part.
    spread = evaluate(page, "mirroredHulls(vec3(0.0), normalize(p.xyz), 0.3, vec3(1.0))", rays[:1], uniforms)
    assert 0.1 < spread[0, 3] < 0.95
