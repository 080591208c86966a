"""Fire: parcels go the way of the plume, whatever the step; eddies move them only sideways."""

import math

import numpy as np
import pytest

from sim.particles.fire import DRAG_TIME, Fire


def young(fire: Fire) -> Fire:
    """The same fire with all parcels at their start."""
    fire.age[:] = 0.0
    fire.step(0.0)
    return fire


@pytest.mark.parametrize("steps", [1, 7, 200])
def test_parcels_go_the_way_of_the_plume_at_any_step(steps: int) -> None:
    t = 2.5
    fire = young(Fire((1.0, 2.0, 3.0), count=4000, life=100.0, wind=(4.0, -1.0), eddies=0.0))
    for _ in range(steps):
        fire.step(t / steps)
    way = fire.track
    ages = way.step * np.arange(len(way.height))
    drift = t - DRAG_TIME * (1 - math.exp(-t / DRAG_TIME))
    height, radius, heat = (float(np.interp(t, ages, values)) for values in way[1:])
    # A mean over 4000 places on a disc is uncertain by 0.5/sqrt(4000) radii; two of these.
    assert fire.position[0].mean() == pytest.approx(1.0 + 4.0 * drift, abs=0.016 * radius)
    assert fire.position[1].mean() == pytest.approx(2.0 - drift, abs=0.016 * radius)
    assert fire.position[2].mean() == pytest.approx(3.0 + height, rel=2e-4)
    assert fire.heat == pytest.approx(heat, rel=1e-5)
    assert fire.spread == pytest.approx(radius, rel=1e-5)


def test_a_steady_fire_starts_as_many_parcels_as_end() -> None:
    fire = Fire((0.0, 0.0, 0.0), count=4000, life=4.0)
    for _ in range(900):
        fire.step(1 / 30)
    before = fire.started
    for _ in range(600):
        fire.step(1 / 30)
    # Lives scatter by 0.79 of their mean, so the number is uncertain by 0.79 sqrt(20,000 starts) = 0.6 %; two of these.
    assert fire.started - before == pytest.approx(4000 / 4.0 * 20.0, rel=0.011)
    assert fire.burning.all()
    assert np.isfinite(fire.position).all()


def test_eddies_move_parcels_sideways_only() -> None:
    calm, wild = Fire((0, 0, 0), count=50, eddies=0.0), Fire((0, 0, 0), count=50, eddies=1.0)
    for fire in (calm, wild):
        for _ in range(200):
            fire.step(0.03)
    np.testing.assert_array_equal(calm.position[2], wild.position[2])
    assert np.abs(calm.position[:2] - wild.position[:2]).max() > 0.5


def test_puffs_come_at_the_frequency_of_a_pool_fire_s() -> None:
    """1.5/sqrt(D), here 0.5 a second: where smoke 3 s old is to the side, by the time at which it started."""
    fire, duration, side = Fire((0.0, 0.0, 0.0), diameter=9.0, count=1, life=100.0), 60.0, []
    young(fire)
    for start in np.arange(0.0, duration, 0.2):
        fire.age[:], fire.time = 0.0, start
        fire.step(3.0)
        side.append(fire.position[0, 0])
    # Slower puffs have 0.231 of this frequency, so that the fifth harmonic of the duration is theirs at most.
    spectrum = np.abs(np.fft.rfft(side))
    assert 15 + spectrum[15:].argmax() == 0.5 * duration
    assert np.ptp(side) > 0.1 * fire.spread[0]


def test_parcels_start_evenly_over_the_pool() -> None:
    fire = young(Fire((5.0, -3.0, 1.0), count=4000, life=1000.0))
    x, y, z = fire.position
    r, radius = np.hypot(x - 5.0, y + 3.0), 0.5 * fire.diameter
    assert r.max() <= radius * (1.0 + 1e-6)
    # Two standard errors of 4000 places: r^2 scatters by 0.58 of its mean, x by half a radius.
    assert np.square(r).mean() == pytest.approx(0.5 * radius**2, rel=0.018)
    assert x.mean() == pytest.approx(5.0, abs=0.016 * radius)
    assert y.mean() == pytest.approx(-3.0, abs=0.016 * radius)
    assert (z == 1.0).all()
