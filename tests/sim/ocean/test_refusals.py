"""Arguments at and beyond the edges of what is allowed: each is refused by its name, or gives the right limit."""

import math

import numpy as np
import pytest

from sim.ocean import Sea
from sim.ocean.dispersion import group_speed, mode_ratios, omega, phase_speed, two_layer, viscous_root
from sim.ocean.fluids import fresnel
from sim.ocean.planets import gravity_of
from sim.ocean.slick import slick_radius
from sim.ocean.spectra import SPECTRA
from sim.ocean.statistics import expected, measured, resolved_in_time
from sim.particles.plume import flame_height
from sim.particles.rain import rainfall, terminal_speed


def small(**values):
    return Sea(16, values.pop("length", 50.0), **values)


@pytest.mark.parametrize(
    ("name", "call"),
    [
        ("gravity", lambda: small(gravity=1e-300)),
        ("gravity", lambda: small(gravity=1e300)),
        ("depth", lambda: small(depth=1e-300)),
        ("depth", lambda: small(depth=math.nan)),
        ("length", lambda: small(length=1e-300)),
        ("length", lambda: small(length=1e300)),
        ("wind_speed", lambda: small(wind_speed=1e200)),
        ("viscosity", lambda: small(viscosity=1e300)),
        ("film", lambda: small(film="no")),
        ("frequency", lambda: small(frequency=lambda k: k * math.nan)),
        ("frequency", lambda: small(frequency=lambda k: 1.0)),
        ("frequency", lambda: small(frequency=3)),
        ("decay", lambda: small(decay=lambda k: -k)),
        ("points", lambda: small().height_at([[1e20, 0.0]], 0.0)),
        ("points", lambda: small().height_at("x", 0.0)),
        ("points", lambda: small().height_at([[1.0, 2.0], [3.0]], 0.0)),
        ("t", lambda: small().significant_height_at(math.nan)),
        ("k", lambda: omega("a")),
        ("k", lambda: omega([[1.0, 2.0], [3.0]])),
        ("k", lambda: omega(True)),
        ("k", lambda: omega(1e200)),
        ("k", lambda: two_layer(None, 850.0, 1.0, 1025.0)),
        ("angle", lambda: fresnel(2.0, 1.33)),
        ("angle", lambda: fresnel(-0.1, 1.33)),
        ("angle", lambda: fresnel(math.nan, 1.33)),
        ("mass", lambda: gravity_of(1e308)),
        ("viscosity", lambda: slick_radius(1.0, 1.0, 850.0, viscosity=0.0)),
        ("gravity", lambda: slick_radius(1.0, 1.0, 850.0, gravity=-9.8)),
        ("rate", lambda: rainfall(0.0)),
        ("rate", lambda: rainfall(-1.0)),
        ("rate", lambda: rainfall(math.nan)),
        ("gravity", lambda: terminal_speed(0.001, -9.0)),
        ("diameter", lambda: terminal_speed(-0.001)),
        ("power", lambda: flame_height(-1.0, 1.0)),
        ("diameter", lambda: flame_height(1e6, math.inf)),
    ],
)
def test_it_is_refused_by_name(name, call):
    with pytest.raises(ValueError, match=rf"^{name}: .* is not allowed; allowed: "):
        call()


@pytest.mark.parametrize("spectrum", [name for name, spectrum in SPECTRA.items() if spectrum.by_wind])
@pytest.mark.parametrize("wind", [1e-200, 1e-5])
def test_a_wind_that_is_next_to_none_makes_no_waves(spectrum, wind):
    assert not small(spectrum=spectrum, wind_speed=wind).surface(1.0).height.any()


def test_next_to_no_viscosity_is_none():
    assert np.isfinite(small(viscosity=1e-160).surface(9.0).height).all()
    assert viscous_root(1.0, 1e-300) == (omega(1.0), 0.0)
    assert viscous_root(1.0, 1e-300, film=True) == (omega(1.0), 0.0)


def test_speeds_and_ratios_have_their_limits_at_k_0():
    assert phase_speed(0.0) == group_speed(0.0) == math.inf
    for speed in (phase_speed, group_speed):
        assert speed([0.0, 1e-9], depth=3.0) == pytest.approx(math.sqrt(9.81 * 3.0), rel=1e-9)
    assert mode_ratios(0.0, 850.0, 1.0, 1025.0) == pytest.approx((1.0, -(1025.0 / 850.0 - 1.0)), rel=1e-4)
    assert mode_ratios(0.0, 850.0, 1.0, 1025.0, depth=4.0) == pytest.approx(
        mode_ratios(1e-5, 850.0, 1.0, 1025.0, depth=4.0), rel=1e-3
    )


def test_waves_that_turn_faster_than_frames_follow_have_no_direction():
    """Earth's gravity 100 times over and 8 m/s: a peak period of 0.056 s, drawn at 30 Hz."""
    sea = Sea(64, 2.0, wind_speed=8.0, gravity=981.0, wind_direction=math.radians(20.0), precision="double")
    period = expected(sea).peak_period

    def direction(interval):
        now, before = (sea.surface(t).height for t in (1.0, 1.0 - interval))
        return measured(now, 2.0, sea.conditions, before, interval).direction

    assert math.isnan(direction(1 / 30))
    assert not resolved_in_time(period, 1 / 30)
    for interval in (1 / 500, 1 / 90):
        assert resolved_in_time(period, interval)
        assert direction(interval) == pytest.approx(math.radians(20.0), abs=0.15)
