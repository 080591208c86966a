"""The jet: parabolas, energy, hits on a surface that moves, and not a litre lost."""

import math

import numpy as np
import pytest

from sim.ocean.fluids.slick import slick_radius, slick_thickness
from sim.particles.jet import Jet

FLAT = np.zeros((8, 8))


def test_a_parcel_flies_the_parabola_and_lands_at_its_range() -> None:
    jet = Jet((0.0, 0.0, 10.0), (8.0, 0.0, 6.0), spread=0.0, count=1, flight=0.1)
    landed = []
    for _ in range(400):
        hits = jet.step(0.01, FLAT, (-50.0, -50.0), 20.0)
        if len(hits.volume):
            landed.append(hits.position[0])
            break
    t = (6.0 + math.sqrt(36.0 + 2 * 9.81 * 10.0)) / 9.81
    np.testing.assert_allclose(landed[0], [8.0 * t, 0.0, 0.0], atol=1e-3)


def test_energy_is_kept_in_the_air_and_lost_to_drag_by_the_closed_form() -> None:
    jet = Jet((0.0, 0.0, 50.0), (5.0, 1.0, 12.0), spread=0.1, count=100, flight=1.0)
    for _ in range(100):
        jet.step(0.02, FLAT, (-500.0, -500.0), 200.0)
    assert jet.flying.sum() == 100
    energy = 0.5 * (jet.velocity**2).sum(axis=0) + 9.81 * jet.position[2]
    start = energy.copy()
    jet.rate = 0.0
    jet.step(0.5, FLAT, (-500.0, -500.0), 200.0)
    still = jet.flying
    after = 0.5 * (jet.velocity**2).sum(axis=0) + 9.81 * jet.position[2]
    np.testing.assert_allclose(after[still], start[still], rtol=1e-12)
    slow = Jet((0.0, 0.0, 1e4), (3.0, 0.0, 0.0), spread=0.0, count=1, flight=0.1, drag_time=0.5)
    for _ in range(200):
        slow.step(0.1, FLAT, (-1e4, -1e4), 1e4)
    assert slow.velocity[2, 0] == pytest.approx(-9.81 * 0.5, rel=1e-9)


def test_nothing_of_what_is_ejected_is_lost() -> None:
    jet = Jet((0.0, 0.0, 12.0), (4.0, 0.0, 9.0), flow=0.7, count=300, flight=2.0)
    fed, hits = 0.0, 0
    for i in range(900):
        height = 0.8 * np.sin(i / 20 + np.arange(8))[:, None] * np.ones(8)
        landed = jet.step(1 / 60, height, (-40.0, -40.0), 80.0 / 7)
        fed += landed.volume.sum()
        hits += len(landed.volume)
        assert jet.ejected == pytest.approx(jet.in_flight + jet.fed, rel=1e-12)
    assert jet.ejected == pytest.approx(0.7 * 15.0)
    assert fed == pytest.approx(jet.fed)
    assert hits == jet.hits > 1000
    assert jet.serial == hits + jet.flying.sum()


def test_it_lands_on_the_surface_where_that_is() -> None:
    jet = Jet((0.0, 0.0, 12.0), (6.0, 0.0, 3.0), count=200, flight=1.0)
    slope = 0.05
    height = slope * (np.arange(21) * 4.0 - 40.0)[:, None] * np.ones(21)
    found = np.concatenate([jet.step(1 / 60, height, (-40.0, -40.0), 4.0).position for _ in range(300)])
    np.testing.assert_allclose(found[:, 2], slope * found[:, 0], atol=0.02)


def test_fay_spreads_by_inertia_first_and_by_viscosity_then() -> None:
    lift = (1 - 850 / 1025) * 9.81
    assert slick_radius(10.0, 1.0, 850.0) == pytest.approx(1.14 * (lift * 10.0) ** 0.25)
    late = slick_radius(10.0, 1e5, 850.0)
    assert late == pytest.approx(1.45 * (lift * 100.0 * 1e5**1.5 / 1.19e-6**0.5) ** (1 / 6))
    assert slick_thickness(10.0, late) == pytest.approx(10.0 / (math.pi * late**2))
    assert slick_radius(0.0, 5.0, 850.0) == slick_thickness(0.0, 0.0) == 0.0
    with pytest.raises(ValueError, match="oil"):
        slick_radius(1.0, 1.0, 1030.0)


def test_drag_and_wind_carry_a_parcel_along_the_closed_form() -> None:
    """v = v_end + (v0 - v_end) exp(-t/tau) and its integral, in one step or many."""
    wind, tau, t = (3.0, -2.0), 0.8, 1.5
    ends = np.array([3.0, -2.0, -9.81 * tau])
    for steps in (1, 30):
        jet = Jet((0.0, 0.0, 1e4), (5.0, 1.0, 12.0), spread=0.0, count=1, flight=0.1, drag_time=tau, wind=wind)
        while not jet.flying[0]:
            jet.step(0.01, FLAT, (-1e4, -1e4), 1e4)
        x, v = jet.position[:, 0].copy(), jet.velocity[:, 0].copy()
        for _ in range(steps):
            jet.step(t / steps, FLAT, (-1e4, -1e4), 1e4)
        left = math.exp(-t / tau)
        np.testing.assert_allclose(jet.velocity[:, 0], ends + (v - ends) * left, rtol=1e-9)
        np.testing.assert_allclose(jet.position[:, 0], x + ends * t + (v - ends) * tau * (1.0 - left), rtol=1e-9)
