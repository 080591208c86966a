"""Planets: gravity from mass under each rule, and what it does to a sea."""

import pytest

from sim.ocean import Sea
from sim.ocean.planets import EARTH_GRAVITY, SOLAR_SYSTEM, gravity_of


@pytest.mark.parametrize(
    ("rule", "light", "heavy"), [("same_radius", 0.0981, 981.0), ("same_density", 2.114, 45.5), ("rocky", 1.18, 81.6)]
)
def test_a_hundredth_and_a_hundred_earths(rule, light, heavy):
    assert gravity_of(0.01, rule) == pytest.approx(light, rel=1e-3)
    assert gravity_of(100.0, rule) == pytest.approx(heavy, rel=1e-3)
    assert gravity_of(1.0, rule) == EARTH_GRAVITY


@pytest.mark.parametrize(
    ("body", "gravity"), [("Earth", 9.82), ("Moon", 1.62), ("Mars", 3.73), ("Titan", 1.354), ("Jupiter", 25.92)]
)
def test_presets_have_the_gravity_of_their_fact_sheet(body, gravity):
    assert SOLAR_SYSTEM[body].gravity == pytest.approx(gravity, rel=3e-3)


GM_AND_DIAMETER = {  # [m3/s2] from the motion of probes and moons, and [m], the mean one (JPL)
    "Mercury": (2.2032e13, 4879.4e3), "Venus": (3.24859e14, 12103.6e3), "Earth": (3.986004e14, 12742.0e3),
    "Moon": (4.9028e12, 3474.8e3), "Mars": (4.282837e13, 6779.0e3), "Jupiter": (1.26686534e17, 139822.0e3),
    "Saturn": (3.7931187e16, 116464.0e3), "Uranus": (5.793939e15, 50724.0e3), "Neptune": (6.836529e15, 49244.0e3),
    "Pluto": (8.71e11, 2376.0e3), "Europa": (3.203e12, 3121.6e3), "Titan": (8.978e12, 5149.4e3),
    "Enceladus": (7.21e9, 504.2e3),
}  # fmt: skip


@pytest.mark.parametrize("body", SOLAR_SYSTEM)
def test_every_body_has_the_gravity_of_its_measured_gm_and_diameter(body):
    gm, diameter = GM_AND_DIAMETER[body]
    assert SOLAR_SYSTEM[body].gravity == pytest.approx(gm / (0.5 * diameter) ** 2, rel=2e-3)


@pytest.mark.parametrize("gravity", [0.0981, 45.5, 981.0])
def test_seas_of_all_planets_are_one_sea_scaled(gravity):
    """Hs g/U^2 is the same where the tile scales as U^2/g, and so is the whole surface."""
    here, earth = (Sea(256, 9000.0 / g, gravity=g, amplitudes="fixed", precision="double") for g in (gravity, 9.81))
    ratio = gravity / 9.81
    assert here.significant_height * ratio == pytest.approx(earth.significant_height, rel=1e-12)
    assert here.significant_height * gravity / 100.0 == pytest.approx(0.20925, rel=5e-3)
    assert here.surface(3.0 / ratio).height * ratio == pytest.approx(earth.surface(3.0).height, abs=1e-10)
