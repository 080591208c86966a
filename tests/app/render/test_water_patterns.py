"""The patterns that the water shader draws have the statistics that it is told, by the same arithmetic in numpy."""

import numpy as np
import pytest

from sim.particles.rain_rings import ring_wave
from tests.app.render.shader_twin import (
    constant,
    foam_cover,
    foam_pattern,
    fresnel,
    hash2,
    ring_slopes,
    ripples,
    rough_mirror,
)  # fmt: skip

POINTS = np.random.default_rng(1).uniform(-3000.0, 3000.0, (100_000, 2))


@pytest.mark.parametrize("bubbles", [True, False])
def test_as_much_is_drawn_as_foam_as_the_simulation_has(bubbles: bool) -> None:
    """From near and from as far as small bubbles are not seen; "Foam covers" in the panel is the mean of the shares."""
    v = foam_pattern(POINTS)[0 if bubbles else 1]
    variance = constant("FOAM_VARIANCE" if bubbles else "FOAM_COARSE_VARIANCE")
    for share in (0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 0.9):
        drawn = foam_cover(v, variance, share)
        assert drawn.mean() == pytest.approx(share, abs=0.015)
        assert ((drawn < 0.01) | (drawn > 0.99)).mean() > 0.4  # with edges: it is no grey film


def test_rings_that_are_not_seen_make_the_sea_as_rough_as_they_are() -> None:
    wave = ring_wave(9.81)
    x = POINTS / 100.0
    for share in (1.0, 0.3):
        slopes = np.concatenate([ring_slopes(x, t, share, *wave) for t in (0.0, 3.11, 700.3)])
        assert (slopes**2).sum(-1).mean() == pytest.approx(share * constant("RING_VARIANCE"), rel=0.03)
        assert abs(slopes.mean()) < 2e-3


def test_a_ring_stays_within_its_cell() -> None:
    """Otherwise it would end at the border of the cell as at a wall."""
    room = 0.5 * constant("RING_CELL") - constant("RING_REACH") - 1.0
    assert room >= 0.0


def test_random_numbers_of_the_shader_are_even() -> None:
    numbers = hash2(np.stack(np.meshgrid(np.arange(-300, 300), np.arange(-300, 300)), -1).astype(float))
    assert numbers.mean(axis=(0, 1)) == pytest.approx(0.5, abs=0.01)
    assert numbers.var(axis=(0, 1)) == pytest.approx(1.0 / 12.0, rel=0.02)


@pytest.mark.parametrize("distance", [5.0, 50.0, 500.0])
def test_ripples_seen_and_filtered_have_the_slope_that_is_asked_for(distance: float) -> None:
    """As from 0.3 of the distance above the water, with 1080 rows over 0.65 rad; a pixel is long at a low angle."""
    footprint = distance * 0.65 / 1080 / np.sqrt(0.3)
    for rms, longest, shortest in ((0.2, 3.75, 0.051), (0.12, 1.6, 0.05)):
        slope, lost = ripples(POINTS, footprint, rms, longest, shortest)
        assert (slope**2).sum(-1).mean() + lost.mean() == pytest.approx(rms**2, rel=0.05)
    if distance > 400.0:
        assert lost.mean() > 0.3 * rms**2  # much of it is filtered there
    if distance < 6.0:
        assert lost.mean() < 0.03 * rms**2


def test_the_sea_mirrors_as_cox_and_munk_s_facets_do_on_average() -> None:
    """Against the sum over all slopes along both axes, of facets that the eye sees, at any angle and wind."""
    t = np.linspace(-7.0, 7.0, 281)
    chance = np.exp(-0.5 * t * t)
    for index in (1.333, 1.48):
        for degrees in (0.0, 20.0, 40.0, 50.0, 60.0, 70.0, 75.0, 80.0, 85.0, 88.0):
            c, level = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
            for rms in (0.03, 0.1, 0.15, 0.2, 0.25):
                along, across = rms * t[:, None], rms * t[None, :]
                seen = np.maximum(c - along * level, 0.0)
                weight = chance[:, None] * chance * seen
                facets = fresnel(seen / np.sqrt(1.0 + along**2 + across**2), index)
                expected = float((weight * facets).sum() / weight.sum())
                assert rough_mirror(c, rms, index) == pytest.approx(expected, rel=0.03), (index, degrees, rms)
