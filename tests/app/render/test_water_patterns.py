"""The patterns that the water shader draws have the statistics that it is told, by the same arithmetic in numpy."""

import numpy as np
import pytest

from sim.particles.rain_rings import ring_wave
from tests.app.render.shader_twin import constant, foam_cover, foam_pattern, hash2, ring_slopes

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
