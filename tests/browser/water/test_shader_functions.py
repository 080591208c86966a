"""The functions of the water's shader, as Chromium compiles them, against closed forms and the same sums in numpy."""

import itertools
import math
import re
from collections.abc import Iterator
from typing import Any
from unittest.mock import MagicMock

import numpy as np
import pytest
from numpy.typing import NDArray

from app.render.material import WATER_UNIFORMS, Grid, Waterline, uniform_table, waterline_table
from app.render.scripts import modules
from app.render.skies import set_sky
from sim.ocean.fluids.oil_film import APPEARANCES, EXTINCTION, light_through, mirrored_light
from sim.ocean.radial.radial_grid import RadialGrid
from sim.particles.rain_rings import ring_flux, ring_wave
from tests.browser.glsl import evaluate, page_with_modules

POINTS = np.random.default_rng(1).uniform(-300.0, 300.0, (40_000, 2))
FOOTPRINT = 0.65 / 1080 / np.sqrt(0.3)  # over the distance, seen from 0.3 of it above the water, 1080 rows in 0.65 rad


def constant(name: str, part: int = 0) -> float:
    """The value of the constant `name` in the shader, or a part of it."""
    values = re.findall(rf"\b{name} = (?:vec2\()?([-0-9.e]+)(?:, ([-0-9.e]+)\))?[;,]", modules()["sea/water_shader.js"])
    assert len(values) == 1
    return float(values[0][part])


def fresnel(c: NDArray[np.float64], n: float) -> NDArray[np.float64]:
    """Reflectance of unpolarised light at the cosine c on a fluid of index n."""
    g = np.sqrt(n * n - 1.0 + c * c)
    p, q = (g - c) / (g + c), (c * (g + c) - 1.0) / (c * (g - c) + 1.0)
    return 0.5 * p * p * (1.0 + q * q)


@pytest.fixture(scope="module")
def page(chromium: Any) -> Iterator[Any]:
    page = page_with_modules(chromium)
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
        facets = fresnel(seen / np.sqrt(1.0 + along**2 + across**2), index)
        expected.append(float((weight * facets).sum() / weight.sum()))
    found = evaluate(page, "vec4(roughMirror(p.x, p.y, p.z), fresnel(p.x, p.z), 0.0)", np.array(table))
    np.testing.assert_allclose(found[:, 0], expected, rtol=0.03)
    smooth = [fresnel(np.float64(c), index) for c, _, index in table]
    np.testing.assert_allclose(found[:, 2], smooth, rtol=1e-3)


def test_oil_has_the_colours_of_its_thickness(page: Any) -> None:
    """Over all classes of the Bonn Agreement's code: what is mirrored, and what light is let through."""
    bounds = [*APPEARANCES.values(), 1e-3]
    thickness = np.concatenate([np.geomspace(low, high, 12) for low, high in itertools.pairwise(bounds)])
    index, water = 1.48, 1.333
    uniforms = {"oilFilm": (index, water, 1.0), "oilExtinction": EXTINCTION}
    gain = evaluate(page, f"vec4(filmGain(p.x, 0.0, 1.0, {index}), 0.0)", thickness[:, None], uniforms)[:, :3]
    through = evaluate(page, "vec4(lightThrough(p.x), 0.0)", thickness[:, None], uniforms)[:, :3]
    face = ((1.0 - index) / (1.0 + index)) ** 2
    np.testing.assert_allclose(gain * face, mirrored_light(thickness, index, water), rtol=2e-3)
    np.testing.assert_allclose(through, light_through(thickness), atol=1e-5)
    # Where a film begins, it mirrors as the water: its edge is no line. Of many fringes in a pixel none is seen.
    edge = evaluate(page, f"vec4(filmGain(0.0, 0.0, p.x, {water}), 0.0)", np.array([[1.0], [0.2]]), uniforms)[:, :3]
    np.testing.assert_allclose(edge, 1.0, rtol=0.02)
    blurred = evaluate(page, f"vec4(filmGain(p.x, 1e-6, 1.0, {index}), 0.0)", thickness[:12, None], uniforms)[:, :3]
    assert np.ptp(blurred, axis=0).max() < 0.01 < np.ptp(gain[:12], axis=0).min()


@pytest.mark.parametrize("thickness", [1e-3, 0.2])
def test_the_rim_of_a_slick_has_bands_of_every_appearance(page: Any, thickness: float) -> None:
    """In the order of their thickness, each wide enough to be seen: by where the rim begins and ends."""
    radius, bounds = 45.0, [*APPEARANCES.values()]
    points = np.random.default_rng(2).uniform(-1.5 * radius, 1.5 * radius, (40_000, 2))
    uniforms = {"slick": (0.0, 0.0, radius), "slickOptics": (thickness, 0.02, 0.1), "wind": (0.7, 9.81, 1.0)}
    found = evaluate(page, "vec4(oilThickness(p.xy, slickCover(p.xy)), slickCover(p.xy), 0, 0)", points, uniforms)
    kind = np.searchsorted(bounds, found[:, 0])  # 0: too thin to be seen
    away = np.hypot(*points.T)
    places = [np.median(away[kind == i + 1]) for i in range(len(bounds))]
    assert places == sorted(places, reverse=True)
    assert (np.bincount(kind, minlength=6)[1:] > 0.02 * (found[:, 1] > 0.0).sum()).all()
    assert found[away < 10.0, 0] == pytest.approx(thickness, rel=4.0)  # streaks
    assert (found[away > 1.4 * radius] == 0.0).all()


@pytest.mark.parametrize("footprint", [0.02, 0.7])
def test_facets_that_glint_have_their_variance_and_the_light_of_a_smooth_path(page: Any, footprint: float) -> None:
    """At two times, at 80,000 random places."""
    points = 3e3 * np.random.default_rng(3).random((80_000, 2))
    light = "mirroredFrom(normalize(vec3(1.0, 0.0, 0.5)), normalize(vec3(-1.0, 0.1, 0.4)), {}, {}, 0.37, 1.34)"
    variance, share = 0.004, constant("GLINT_SHARE")
    smooth = evaluate(page, f"vec4({light.format('vec2(0.02)', variance)})", points[:1])[0, 0]
    for time in (0.0, 7.3):
        facet = f"facetAt(p.xy, {footprint}, {share * variance})"
        mirrored = light.format(f"vec2(0.02) + {facet}.xy", (1.0 - share) * variance)
        found = evaluate(page, f"vec4({facet}.xy, {facet}.z * {mirrored}, 0.0)", points, {"seaState": (time, 1.0, 0.0)})
        assert found[:, :2].var(axis=0) == pytest.approx(share * variance, rel=0.03)
        assert found[:, 2].mean() == pytest.approx(smooth, rel=0.05)
        assert found[:, 2].max() > 2.0 * smooth


@pytest.mark.parametrize(("details", "least", "most"), [(2, 0.2, 1.0), (0, 0.0, 0.1)])
def test_at_less_detail_few_sparkles_are_a_single_pixel(page: Any, details: int, least: float, most: float) -> None:
    """Drawn pixels at a grazing angle, which are four times as long as wide on the water."""
    x, y = np.meshgrid(0.02 * np.arange(200), 0.08 * np.arange(200), indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel()])
    share = constant("GLINT_SHARE" if details == 2 else "WIDE_GLINT_SHARE")
    facet = f"facetAt(p.xy, facetWidth(vec2(0.02, 0.08)), {share * 0.004})"
    sun = "normalize(vec3(1.0, 0.0, 0.5)), normalize(vec3(-1.0, 0.1, 0.4))"
    light = f"{facet}.z * mirroredFrom({sun}, vec2(0.1) + {facet}.xy, {(1.0 - share) * 0.004}, 0.37, 1.34)"
    found = evaluate(page, f"vec4({light}, 0.0, 0.0, 0.0)", points, {"seaState": (1.0, 1.0, 0.0)}, details=details)
    bright = found[:, 0].reshape(x.shape) > 3.0 * found[:, 0].mean()
    around = np.zeros(x.shape, int)
    for shift in itertools.product((-1, 0, 1), repeat=2):
        around += np.roll(bright, shift, (0, 1))
    single = (around[bright] == 1).mean()
    assert bright.mean() > 0.01
    assert least <= single <= most


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
        filtered = slope[:, 2].mean() / rms**2
        assert {5.0: filtered < 0.03, 500.0: filtered > 0.3}.get(distance, True)
    n, length = 64, 64.0
    noise = np.random.default_rng(2).normal(size=(n, n))
    k = np.fft.fftfreq(n)[:, None], np.fft.fftfreq(n)[None, :]
    wave = np.fft.fft2(noise) * np.exp(-(((np.hypot(*k) - 0.12) / 0.08) ** 2))
    slopes = np.stack([np.fft.ifft2(1j * one * wave).real for one in k], -1)
    tile = np.dstack([slopes, np.zeros((n, n)), (slopes**2).sum(-1)])
    grid = {"grid": (n + 1, n + 1, length)}
    level = max(np.log2(footprint * n / length), 0.0)
    for share in (0.0, 0.5, 1.0):
        points[:, 2] = share
        drawn = evaluate(page, f"wavesAt(waveSlopes, p.xy, p.z, {level:.3f}, true)", points, grid, tile)
        total = (drawn[:, :2] ** 2).sum(-1).mean() + drawn[:, 3].mean()
        assert total == pytest.approx((slopes**2).sum(-1).mean(), rel=0.05), share


@pytest.mark.parametrize("law", ["geometric", "power"])
def test_a_texture_of_rings_has_at_each_vertex_what_was_written_there(page: Any, law: str) -> None:
    n = 32
    grid = RadialGrid(rings=n - 1, spokes=n, inner=0.4, radius=5000.0, law=law)
    table = Grid(n, n, 5000.0, grid.ring_law)
    uniforms = {"grid": table[:3], "ringLaw": table.ring_law, "gridMiddle": (30.0, -20.0, 0.0)}
    numbers = np.random.default_rng(4).uniform(-1.0, 1.0, len(grid))
    texels = np.zeros((n, n, 4))
    texels[0, :, 0], texels[1:, :, 0] = numbers[-1], numbers[:-1].reshape(n - 1, n)
    points = np.column_stack([grid.x, grid.y]).astype(float) + (30.0, -20.0)
    points[-n - 1 : -1] = 30.0, -20.0  # the last ring is where the texture ends
    expected = np.concatenate([numbers[: -n - 1], np.full(n + 1, numbers[-1])])
    found = evaluate(page, "ringsAt(wavePlaces, p.xy)", points, uniforms, texels)[:, 0]
    np.testing.assert_allclose(found, expected, atol=3e-3)
    rings = evaluate(page, "vec4(ringAt(p.x), 0.0, 0.0, 0.0)", grid.radii[:, None], uniforms)[:, 0]
    np.testing.assert_allclose(rings, np.arange(1, n), atol=2e-3)


def test_foam_has_the_share_that_it_is_told(page: Any) -> None:
    """Foam from near and from where small bubbles are not seen: "Foam covers" in the panel is the mean of shares."""
    points = np.column_stack([POINTS, np.zeros(len(POINTS))])
    for share, footprint in itertools.product((0.05, 0.2, 0.5, 0.9), (0.01, 0.25)):
        points[:, 2] = share
        cover = evaluate(page, f"foamCover(p.xy, p.z, {footprint})", points, {"wind": (0.4, 9.81, 1.0)})[:, 0]
        assert cover.mean() == pytest.approx(share, abs=0.02)
        assert ((cover < 0.01) | (cover > 0.99)).mean() > 0.4  # with edges: it is no grey film
        # At the lowest quality white water is still white, as much of it.
        few = evaluate(page, f"foamCover(p.xy, p.z, {footprint})", points, {"wind": (0.4, 9.81, 1.0)}, details=0)[:, 0]
        assert few.mean() == pytest.approx(share, abs=0.03)
        assert 0.5 * share < (few > 0.5).mean() < 2.0 * share


def rain(page: Any, rate: float, footprint: float, lean: float, details: int) -> NDArray[np.float64]:
    """Of a sea in rain of this rate [mm/h]: two slopes, missing variance and jets (n, 4) in pixels of a width [m]."""
    uniforms = {"rainRings": (ring_flux(rate), *ring_wave(9.81)), "seaState": (3.1, 0.5, 0.0)}
    call = f"rainSlopes(0.5 * p.xy, {footprint}, vec2({0.6 * lean}, {0.8 * lean}))"
    return evaluate(page, call, POINTS, uniforms, details=details)


@pytest.mark.parametrize("rate", [2.0, 15.0, 100.0])
def test_rings_and_jets_of_rain_are_as_many_seen_from_near_and_from_far(page: Any, rate: float) -> None:
    for details in (2, 1, 0):
        near, far = rain(page, rate, 1e-4, 1.5, details), rain(page, rate, 0.3, 1.5, details)
        assert (near[:, :2] ** 2).sum(-1).mean() == pytest.approx(far[:, 2].mean(), rel=0.1)
        assert abs(near[:, :2].mean()) < 0.02 * math.sqrt(far[:, 2].mean())
        assert near[:, 3].mean() == pytest.approx(far[:, 3].mean(), rel=0.2)
        assert (near[:, 2] == 0.0).all()
        assert (far[:, :2] == 0.0).all()
    # Seen more flatly, jets hide more of the sea.
    assert rain(page, rate, 0.3, 6.0, 0)[:, 3].mean() > 3.0 * rain(page, rate, 0.3, 1.5, 0)[:, 3].mean()


def test_rings_of_large_drops_are_the_waves_of_least_group_speed() -> None:
    k = np.linspace(0.1, 1.0, 100_001)  # over that of the least phase speed, which is sqrt(2) in these units
    frequency = np.sqrt(k + k**3)
    speed = np.gradient(frequency, k)
    slowest = speed.argmin()
    assert constant("RING_LENGTH", 1) == pytest.approx(1.0 / k[slowest], rel=0.01)
    assert constant("RING_SPEED", 1) == pytest.approx(speed[slowest] / math.sqrt(2.0), rel=0.01)
    assert constant("CREST_SPEED", 1) == pytest.approx(frequency[slowest] / k[slowest] / speed[slowest], rel=0.01)
    # A ring stays within its cell, or it would end at the border as at a wall.
    assert 0.5 * constant("RING_CELL") - constant("RING_REACH") - 1.0 >= 0.0


def test_random_numbers_are_even(page: Any) -> None:
    cells = np.stack(np.meshgrid(np.arange(-150.0, 150.0), np.arange(-150.0, 150.0)), -1).reshape(-1, 2)
    found = evaluate(page, "vec4(hash2(p.xy), 0.0, 0.0)", cells)[:, :2]
    assert found.mean(axis=0) == pytest.approx(0.5, abs=0.01)
    assert found.var(axis=0) == pytest.approx(1.0 / 12.0, rel=0.02)


@pytest.mark.parametrize("name", ["park", "sunset"])
def test_sea_and_sky_meet_at_the_horizon_without_a_line(page: Any, name: str) -> None:
    """Noon and sunset, all around: the lowest row of the sky and the highest of the water, 0.001 rad apart each way.

    Without the photographs, which this program does not have: what is compared is haze and glow around the sun.
    """
    material = set_sky(MagicMock(), name)
    table = uniform_table(material, (0.0, 1.0, 0.03), Grid(9, 9, 100.0))
    uniforms: dict[str, Any] = dict(zip(WATER_UNIFORMS, table, strict=True))
    bearing = np.linspace(-np.pi, np.pi, 361) + 0.004
    rays = np.column_stack([np.cos(bearing), np.sin(bearing), np.full(len(bearing), 0.001)])
    sky = evaluate(page, "vec4(skyLight(normalize(p.xyz)), 0.0)", rays, uniforms)[:, :3]
    far = "1e6 * normalize(vec3(p.xy, -p.z))"
    sea = evaluate(page, f"vec4(shadeSea({far}, vec2(0.0), vec2(1e3)), 0.0)", rays, uniforms)[:, :3]
    assert sea.min() > 0.01
    np.testing.assert_allclose(sky, sea, rtol=0.03)


def test_rays_from_the_water_meet_what_stands_in_it_and_above_it(page: Any) -> None:
    """A box of 4 m by 2 m and 3 m high that is turned by a right angle, 10 m away, and a deck from 8 to 9 m over it."""
    box = Waterline((10.0, 0.0), np.pi / 2, (1.9, 0.9), 0.1, 3.0, color=(1.0, 0.0, 0.0))
    deck = Waterline((10.0, 0.0), 0.0, (1.9, 1.9), 0.1, 9.0, 8.0, (0.0, 0.0, 1.0))
    table = waterline_table([box, deck]).reshape(-1, 4)
    uniforms = {f"waterlines[{k}]": row for k, row in enumerate(table)}
    rises = {0.1: (1.0, 0.0), 0.25: (1.0, 0.0), 0.6: (0.0, 0.0), 1.05: (0.0, 1.0), 1.5: (0.0, 0.0)}  # red, blue
    rays = np.array([(1.0, 0.0, rise) for rise in rises] + [(-1.0, 0.0, 0.1), (1.0, 0.35, 0.1), (1.0, 0.15, 0.1)])
    expected = [*rises.values(), (0.0, 0.0), (0.0, 0.0), (1.0, 0.0)]
    met = evaluate(page, "meetHulls(vec3(0.0), normalize(p.xyz), 0.002, vec3(1.0), p.w)", rays, uniforms)
    np.testing.assert_allclose(met[:, [0, 2]], expected, atol=0.02)
    np.testing.assert_allclose(met[:, 3], np.sum(expected, axis=1), atol=0.02)
    # Facets that are tilted spread the rays: what is small and far is mirrored in part.
    spread = evaluate(page, "meetHulls(vec3(0.0), normalize(p.xyz), 0.3, vec3(1.0), p.w)", rays[:1], uniforms)
    assert 0.1 < spread[0, 3] < 0.95


def test_the_distance_from_what_stands_in_the_water(page: Any) -> None:
    """A turned rectangle of 4 m by 2 m with round corners, a circle, and a deck over both, which does not count."""
    box, circle = Waterline((10.0, 0.0), 0.4, (1.5, 0.5), 0.5, 3.0), Waterline((-6.0, 2.0), 0.0, (0.0, 0.0), 1.5, 3.0)
    deck = Waterline((0.0, 0.0), 0.0, (20.0, 20.0), 0.1, 9.0, 8.0)
    table = waterline_table([box, circle, deck]).reshape(-1, 4)
    uniforms = {f"waterlines[{k}]": row for k, row in enumerate(table)}
    places = np.random.default_rng(2).uniform(-15.0, 15.0, (500, 2))
    expression = "(meetHulls(vec3(p.xy, 0.0), vec3(0.0, 0.0, 1.0), 0.1, vec3(1.0), p.w), vec4(p.w))"
    offset = (places - box.centre) @ [[np.cos(0.4), -np.sin(0.4)], [np.sin(0.4), np.cos(0.4)]]
    from_box = np.hypot(*np.maximum(np.abs(offset) - box.half_sides, 0.0).T) - box.corner
    expected = np.maximum(np.minimum(from_box, np.hypot(*(places - circle.centre).T) - circle.corner), 0.0)
    np.testing.assert_allclose(evaluate(page, expression, places, uniforms)[:, 0], expected, atol=1e-4)
