"""Plumes: McCaffrey's regimes, Briggs's rise, and the way of gas that joins them."""

import math

import numpy as np
import pytest
from scipy.special import erf

from sim.particles.plume import (
    BENT_WIDENING,
    DRAG_TIME,
    STILL_WIDENING,
    buoyancy_flux,
    centreline,
    flame_height,
    radiated_light,
    soot_made,
    track,
    turbulent_radius,
)  # fmt: skip


def test_the_flame_of_a_megawatt_pool_is_as_high_as_heskestad_says() -> None:
    assert flame_height(1e6, 1.0) == pytest.approx(0.235 * 1000**0.4 - 1.02)  # 2.70 m
    assert flame_height(1e3, 4.0) == 2.0


def test_the_middle_of_a_plume_is_as_fast_and_hot_as_mccaffrey_measured() -> None:
    """A fire of 1 MW: q = 15.85; in the flame, in the intermittent flame and in the plume."""
    speed, rise = centreline([1.0, 2.0, 10.0], 1e6)
    assert speed == pytest.approx([6.8, 1.9 * 1000**0.2, 1.1 * (10 / 1000**0.4) ** (-1 / 3) * 1000**0.2], rel=1e-6)
    assert rise[0] == pytest.approx(853.0, rel=1e-3)  # the same everywhere in the flame, 800 to 900 K as measured
    assert rise[2] == pytest.approx(22.3 * (10 / 1000**0.4) ** (-5 / 3), rel=1e-3)
    below, above = centreline(0.08 * 1000**0.4 * np.array([0.9999, 1.0001]), 1e6)[0]
    assert above == pytest.approx(below, rel=0.02)  # the fits meet


def test_the_buoyancy_of_a_fire_is_that_of_its_convected_heat() -> None:
    assert buoyancy_flux(1e6) == pytest.approx(0.7 * 8.84, rel=1e-2)


def test_without_wind_gas_goes_by_mccaffrey() -> None:
    way = track(100e6, 4.0, 0.0, 20.0)
    age = way.step * np.arange(len(way.height))
    speed = np.gradient(way.height.astype(float), age)[5:-5]
    assert speed == pytest.approx(centreline(way.height[5:-5], 100e6)[0], rel=0.03)
    flame = way.height < 0.08 * 100e3**0.4  # dz/dt = kappa sqrt(z)
    assert way.height[flame] == pytest.approx((3.4 * age[flame]) ** 2, rel=5e-4)
    # A flame is as wide as the fire: dr/dz = STILL_WIDENING (1 - exp(-(z/L)^2)), L the flame's height.
    z, length = way.height.astype(float), flame_height(100e6, 4.0)
    still = z - 0.5 * math.sqrt(math.pi) * length * erf(z / length)
    assert way.radius == pytest.approx(2.0 + STILL_WIDENING * still, rel=5e-4)


def test_far_in_the_wind_gas_goes_by_briggs() -> None:
    wind = 12.0
    way = track(100e6, 4.0, wind, 600.0)
    age = way.step * np.arange(len(way.height))
    # A plume takes the time of both laws together: without that of still air it goes by Briggs's alone. Within the
    # flame, which is a hundredth of this height, it takes less.
    still = track(100e6, 4.0, 0.0, 600.0)
    rising = np.interp(way.height, still.height, still.step * np.arange(len(still.height)))  # [s]
    rise = 1.6 * buoyancy_flux(100e6) ** (1 / 3) * (wind * (age - rising)[200:]) ** (2 / 3) / wind
    assert way.height[200:] == pytest.approx(rise, rel=0.02)
    growth = np.diff(way.height[[400, 500]].astype(float)) / np.diff(rise[[200, 300]])
    assert growth == pytest.approx(1.0, rel=0.01)
    own = np.sqrt(np.square(way.radius[[400, 500]]) - np.square(turbulent_radius(wind * age[[400, 500]])))
    assert np.diff(own) / np.diff(way.height[[400, 500]]) == pytest.approx(BENT_WIDENING, rel=0.06)


def test_wind_s_turbulence_widens_smoke_as_briggs_curves_say() -> None:
    assert turbulent_radius(1000.0) == pytest.approx(2.0 * math.sqrt(76.28 * 37.95), rel=1e-3)
    way = track(400e6, 9.0, 20.0, 55.2)
    own = math.sqrt(way.radius[-1] ** 2 - turbulent_radius(20.0 * (55.2 - DRAG_TIME)) ** 2)
    assert 0.3 < (own - 4.5) / way.height[-1] < BENT_WIDENING  # as it is not bent over at first


def test_gas_in_the_wind_is_as_hot_as_in_still_air_after_as_long_a_way() -> None:
    power, wind, age = 400e6, 20.0, 5.0
    still, blown = track(power, 9.0, 0.0, 20.0), track(power, 9.0, wind, 20.0)
    heat = float(np.interp(age, blown.step * np.arange(512), blown.heat))
    ages = blown.step * np.arange(512)
    along = wind * (ages - DRAG_TIME * (1.0 - np.exp(-ages / DRAG_TIME)))
    way = np.append(0.0, np.cumsum(np.hypot(np.diff(along), np.diff(blown.height))))
    assert heat == pytest.approx(float(np.interp(np.interp(age, ages, way), still.height, still.heat)), rel=2e-4)


def test_soot_of_a_megawatt_darkens_twenty_square_metres_a_second() -> None:
    assert soot_made(1e6) == pytest.approx(0.1 * 8700.0 / 42.0)


def test_wind_bends_the_plume_and_gas_cools_all_the_way() -> None:
    heights = [float(track(100e6, 4.0, wind, 30.0).height[-1]) for wind in (0.0, 3.0, 10.0)]
    assert heights[0] > heights[1] > heights[2]
    heat = track(100e6, 4.0, 5.0, 30.0).heat
    assert heat[0] == pytest.approx(1.0, rel=1e-3)
    assert (np.diff(heat) <= 1e-6).all()
    assert heat[-1] < 0.1


def test_light_is_that_of_a_sphere() -> None:
    assert 4.0 * math.pi * radiated_light(1e6) == pytest.approx(0.3e6)
