"""Rings against the Cauchy-Poisson integral, and their ledger: volume, energy, decay, cost."""

import itertools

import numpy as np
import pytest

from sim.ocean import Sea
from sim.ocean.tile.ripples import gaussian_volume
from tests.naive_ocean import dropped_gaussian, pushed_gaussian


def flat(size: int, length: float, **options) -> Sea:
    return Sea(size, length, wind_speed=0.0, **{"precision": "double", "choppiness": 0.0, **options})


def at_distance(sea: Sea, r: float, t: float) -> tuple[float, float]:
    """(distance [m], height [m]) of the grid point nearest to r from the middle of the tile along x."""
    cell = sea.length / sea.size
    i = sea.size // 2 + round(r / cell)
    return (i - sea.size // 2) * cell, float(sea.surface(t).height[i, sea.size // 2])


@pytest.mark.parametrize(("t", "width", "value"), [(3.0, 0.02, -4.4908), (2.0, 0.02, -2.0285)])
def test_reference_integral_has_the_published_values(t, width, value):
    assert dropped_gaussian(1.0, t, width) == pytest.approx(value, abs=1e-4)


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize(("t", "width"), [(2.0, 0.02), (3.0, 0.02), (3.0, 0.05)])
def test_ring_of_one_drop_is_cauchy_and_poissons(t, width, precision):
    sea = flat(1024, 16.0, precision=precision)
    sea.ripples.add(0.0, [[8.0, 8.0]], width, volume=1.0)
    r, height = at_distance(sea, 1.0, t)
    assert r == 1.0
    # The tile's images add 0.1 % at 3 s; see the raised level taken off.
    assert height - sea.ripples.mean == pytest.approx(dropped_gaussian(r, t, width), rel=5e-3)


def test_ring_of_a_blow_is_its_integral():
    sea = flat(512, 16.0)
    sea.ripples.add(0.0, [[8.0, 8.0]], 0.1, impulse=50.0)
    r, height = at_distance(sea, 1.0, 1.5)
    assert height == pytest.approx(50.0 * pushed_gaussian(r, 1.5, 0.1, 1025.0), rel=5e-3)


def test_volume_is_kept_to_rounding():
    sea = flat(64, 10.0, viscosity=1e-3)
    rng = np.random.default_rng(0)
    volumes = rng.uniform(1e-6, 1e-3, 200)
    for i in range(200):
        sea.ripples.add(0.01 * i, rng.uniform(0.0, 10.0, (1, 2)), 0.3, volume=volumes[i])
    total = float(sea.surface(5.0).height.mean()) * 100.0
    assert total == pytest.approx(volumes.sum(), rel=1e-12)


def test_drop_begins_as_the_gaussian_it_is():
    sea = flat(128, 10.0)
    sea.ripples.add(0.0, [[5.0, 5.0]], 0.3, volume=gaussian_volume(0.01, 0.3))
    x = np.arange(128) * 10.0 / 128 - 5.0
    expected = 0.01 * np.exp(-(x[:, None] ** 2 + x[None, :] ** 2) / (2 * 0.3**2))
    assert np.abs(sea.surface(0.0).height - expected).max() < 1e-8


def test_many_drops_are_the_sum_of_each():
    rng = np.random.default_rng(3)
    points, widths, volumes = rng.uniform(0.0, 10.0, (7, 2)), rng.uniform(0.3, 1.0, 7), rng.normal(size=7)
    together = flat(64, 10.0)
    together.ripples.add(0.0, points, widths, volume=volumes, impulse=2.0)
    alone = np.zeros((64, 64))
    for point, width, volume in zip(points, widths, volumes, strict=True):
        sea = flat(64, 10.0)
        sea.ripples.add(0.0, [point], width, volume=volume, impulse=2.0)
        alone += sea.surface(1.3).height
    assert np.abs(together.surface(1.3).height - alone).max() < 1e-12 * np.abs(alone).max() + 1e-13


def test_the_rings_of_a_moved_drop_are_moved():
    """By whole cells, and over the edge of the tile."""
    found = []
    for cells in (0, 5):
        sea = flat(16, 8.0)
        sea.ripples.add(0.0, [[1.0 + 0.5 * cells, 2.0]], 0.7, volume=0.3, impulse=20.0)
        found.append(sea.surface(1.3).height)
    assert np.roll(found[0], 5, axis=0) == pytest.approx(found[1], abs=1e-12)


def test_steps_do_not_matter():
    """Drops in between move the origin of time; the first drop's ring does not notice."""
    rng = np.random.default_rng(1)
    stepped, direct = flat(64, 10.0, viscosity=1e-4), flat(64, 10.0, viscosity=1e-4)
    for sea in (stepped, direct):
        sea.ripples.add(0.0, [[5.0, 5.0]], 0.5, volume=1.0)
    for t in np.cumsum(rng.uniform(0.0, 0.1, 100)):
        stepped.ripples.advance(float(t))
    np.testing.assert_allclose(stepped.surface(10.0).height, direct.surface(10.0).height, atol=1e-13)


def test_energy_only_falls():
    sea = flat(64, 2.0, viscosity=1e-5, tension=0.0728)
    sea.ripples.add(0.0, [[1.0, 1.0]], 0.05, volume=1e-5)
    levels = []
    for t in (0.0, 0.5, 1.0, 5.0, 20.0):
        sea.ripples.advance(t)
        levels.append(sea.ripples.rms)
    assert all(a > b > 0.0 for a, b in itertools.pairwise(levels))


def test_without_viscosity_energy_stays():
    sea = flat(64, 2.0, precision="single")
    sea.ripples.add(0.0, [[1.0, 1.0]], 0.1, volume=1e-3)
    first = sea.ripples.rms
    for i in range(1, 500):
        sea.ripples.advance(0.033 * i)
    assert sea.ripples.rms == pytest.approx(first, rel=1e-5)


def test_rings_cost_no_transform_and_quiet_ones_no_pass():
    sea = flat(32, 2.0)
    sea.ripples.leak = 1.0
    sea.ripples.add(0.0, [[1.0, 1.0]], 0.2, volume=1e-3)
    for i in range(1, 3000):
        _ = sea.surface(0.01 * i).height
    assert sea.transforms.count == 2999
    assert not sea.ripples.alive
    assert sea.surface(40.0).height == pytest.approx(1e-3 / 4.0)


def test_rings_ride_on_the_sea_in_every_field():
    sea, plain = (Sea(32, 50.0, precision="double") for _ in range(2))
    sea.ripples.add(1.0, [[20.0, 30.0]], 4.0, volume=5.0)
    ring = flat(32, 50.0, choppiness=1.0)
    ring.ripples.add(1.0, [[20.0, 30.0]], 4.0, volume=5.0)
    both, one, other = (each.surface(3.0) for each in (sea, plain, ring))
    for field in ("displacement", "slope"):
        np.testing.assert_allclose(getattr(both, field), getattr(one, field) + getattr(other, field), atol=1e-12)
    heights = [each.height - each.mean_height for each in (both, one, other)]  # the mean is of second order
    np.testing.assert_allclose(heights[0], heights[1] + heights[2], atol=1e-12)
    # Rings bring water: 5 m3 on the tile.
    assert float((both.height * both.jacobian).mean()) == pytest.approx(5.0 / 50.0**2, abs=2.5e-4)


def test_ring_goes_on_when_gravity_changes():
    sea = flat(64, 20.0)
    sea.ripples.add(0.0, [[10.0, 10.0]], 0.8, volume=1.0)
    before = sea.surface(2.0).height
    sea.change(2.0, gravity=1.6)
    assert np.abs(sea.surface(2.0).height - before).max() < 1e-13


def test_ring_spreads_alike_all_round():
    sea = flat(128, 20.0)
    sea.ripples.add(0.0, [[10.0, 10.0]], 0.6, volume=1.0)
    height = sea.surface(2.0).height
    np.testing.assert_allclose(height, height.T, atol=1e-13)
    np.testing.assert_allclose(height[1:], height[:0:-1], atol=1e-13)


def test_rings_do_not_run_back():
    sea = flat(16, 10.0)
    sea.ripples.add(5.0, [[1.0, 1.0]], 2.0, volume=1.0)
    with pytest.raises(ValueError, match=r"^t: "):
        _ = sea.surface(4.0).height


def test_no_drops_change_nothing():
    sea = flat(16, 10.0)
    sea.ripples.add(5.0, np.empty((0, 2)), 2.0, volume=1.0)
    assert not sea.ripples.alive
    assert not sea.surface(1.0).height.any()
