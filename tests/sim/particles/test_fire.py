"""Fire: parcels follow the closed form of their equation, whatever the step; eddies move them only sideways."""

import math

import numpy as np
import pytest

from sim.particles.fire import DRAG_TIME, RISE, Fire, flame_height


def one_parcel(steps: int, duration: float, wind: tuple[float, float] = (0.0, 0.0), **more) -> Fire:
    fire = Fire((1.0, 2.0, 3.0), count=1, life=100.0, wind=wind, eddies=0.0, **more)
    fire.age[:] = 0.0
    fire.step(0.0)
    for _ in range(steps):
        fire.step(duration / steps)
    return fire


@pytest.mark.parametrize("steps", [1, 7, 200])
def test_a_parcel_rises_by_the_closed_form_at_any_step(steps: int) -> None:
    t = 2.5
    fire = one_parcel(steps, t, (4.0, -1.0))
    c, tau = fire.cooling, DRAG_TIME
    rate = 1 / tau - 1 / c
    speed = RISE * (math.exp(-t / c) - math.exp(-t / tau)) / rate
    height = 3.0 + RISE * (c * (1 - math.exp(-t / c)) - tau * (1 - math.exp(-t / tau))) / rate
    assert fire.velocity[2, 0] == pytest.approx(speed, rel=1e-4)
    assert fire.position[2, 0] == pytest.approx(height, rel=1e-4)
    assert fire.velocity[0, 0] == pytest.approx(4.0 * (1 - math.exp(-t / tau)), rel=1e-4)
    drift = t - tau * (1 - math.exp(-t / tau))
    way = fire.position[:2, 0] - one_parcel(0, t).position[:2, 0]  # from where it started
    assert way == pytest.approx([4.0 * drift, -1.0 * drift], rel=1e-3)
    assert fire.velocity[1, 0] == pytest.approx(-1.0 * (1 - math.exp(-t / tau)), rel=1e-4)
    assert fire.heat[0] == pytest.approx(math.exp(-t / c), rel=1e-4)


def test_smoke_drifts_with_the_wind_in_the_end() -> None:
    fire = one_parcel(60, 60.0, (6.0, 0.0))
    np.testing.assert_allclose(fire.velocity[:, 0], [6.0, 0.0, 0.0], atol=1e-3)


def test_the_flame_of_a_megawatt_pool_is_as_high_as_heskestad_says() -> None:
    assert flame_height(1e6, 1.0) == pytest.approx(0.235 * 1000**0.4 - 1.02)  # 2.70 m
    assert flame_height(1e3, 4.0) == 2.0


def test_a_steady_fire_starts_as_many_parcels_as_end() -> None:
    fire = Fire((0.0, 0.0, 0.0), count=2000, life=4.0)
    for _ in range(120):
        fire.step(1 / 30)
    before = fire.started
    for _ in range(300):
        fire.step(1 / 30)
    assert fire.started - before == pytest.approx(2000 / 4.0 * 10.0, rel=0.05)
    assert fire.burning.all()
    assert np.isfinite(fire.position).all()


def test_eddies_move_parcels_sideways_only() -> None:
    calm, wild = Fire((0, 0, 0), count=50, eddies=0.0), Fire((0, 0, 0), count=50, eddies=1.0)
    for fire in (calm, wild):
        for _ in range(200):
            fire.step(0.03)
    np.testing.assert_array_equal(calm.position[2], wild.position[2])
    assert np.abs(calm.position[:2] - wild.position[:2]).max() > 0.5


@pytest.mark.parametrize(
    "bad", [{"power": -1.0}, {"count": 0}, {"life": math.inf}, {"wind": (math.nan, 0.0)}, {"updraft": math.nan}]
)
def test_what_is_not_allowed_is_refused_by_name(bad: dict) -> None:
    with pytest.raises(ValueError, match=next(iter(bad))):
        Fire((0.0, 0.0, 0.0), **bad)


def test_cold_smoke_rises_with_the_air() -> None:
    np.testing.assert_allclose(one_parcel(60, 60.0, updraft=2.5).velocity[:, 0], [0.0, 0.0, 2.5], atol=1e-3)


def test_parcels_start_evenly_over_the_pool() -> None:
    fire = Fire((5.0, -3.0, 1.0), count=4000, life=1000.0)
    fire.age[:] = 0.0
    fire.step(0.0)
    x, y, z = fire.position
    r, radius = np.hypot(x - 5.0, y + 3.0), 0.5 * fire.diameter
    assert r.max() <= radius * (1.0 + 1e-6)
    assert np.square(r).mean() == pytest.approx(0.5 * radius**2, rel=0.05)
    assert x.mean() == pytest.approx(5.0, abs=0.05 * radius)
    assert y.mean() == pytest.approx(-3.0, abs=0.05 * radius)
    assert (z == 1.0).all()
