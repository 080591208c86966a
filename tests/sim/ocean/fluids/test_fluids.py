"""Fluids: the oil table, the mixture laws and the optics against the published numbers."""

import math

import numpy as np
import pytest

from sim.ocean.fluids.emulsions import (
    MIXTURE_LAWS,
    arrhenius,
    grunberg_nissan,
    kendall_monroe,
    mooney,
    pal_rhodes,
    pal_rhodes_factor,
    taylor,
)
from sim.ocean.fluids.fluid_column import FluidColumn
from sim.ocean.fluids.fluids import (
    diffuse_reflectance,
    fluids,
    fresnel,
    mixed,
    mixed_density,
    normal_reflectance,
    oil_index,
)


def test_water_and_eleven_oils_are_there_in_si():
    found = fluids()
    assert len(found) == 13
    maya = found["Maya"]
    assert (maya.density, maya.viscosity) == (932.0, pytest.approx(0.58))
    assert maya.kinematic_viscosity == pytest.approx(6.2e-4, rel=0.01)
    assert maya.surface_tension == pytest.approx(0.0284)
    assert found["Brent"].surface_tension is None
    for fluid in found.values():
        assert 600.0 < fluid.density < 1100.0
        assert 0.0 < fluid.viscosity < 100.0
        assert len(fluid.colour) == 7


def test_mixture_laws_of_the_table():
    assert arrhenius(50.0, 1.0, 0.3) == pytest.approx(3.234, abs=5e-4)
    assert kendall_monroe(50.0, 1.0, 0.3) == pytest.approx(5.883, abs=5e-4)
    assert taylor(50.0, 1.0, 0.3) == pytest.approx(1.741, abs=5e-4)
    assert taylor(1.0, 50.0, 0.7) == pytest.approx(86.0, abs=0.05)
    assert grunberg_nissan(50.0, 1.0, 0.3, 1.0) == pytest.approx(arrhenius(50.0, 1.0, 0.3) * math.exp(0.21))
    assert mixed_density(850.0, 1025.0, 0.2) == pytest.approx(990.0)


@pytest.mark.parametrize("law", MIXTURE_LAWS)
def test_nothing_mixed_in_changes_nothing(law):
    water, oil = fluids()["sea water"], fluids()["Maya"]
    for fraction, same in ((0.0, water), (1.0, oil)):
        blend = mixed(oil, water, fraction, law)
        assert (blend.density, blend.viscosity) == pytest.approx((same.density, same.viscosity), rel=1e-12)
        assert (blend.colour, blend.refractive_index) == (same.colour, same.refractive_index)


def test_einstein_is_taylors_limit_of_stiff_drops():
    assert taylor(1e9, 1.0, 0.1) == pytest.approx(1.25, rel=1e-8)


def test_thick_emulsions_of_the_table():
    # Mousse of 75 % water: exp(1.875/0.5125) = 38.8; Pal and Rhodes: x = 0.892857, (4.03545)^2.49.
    assert mooney(1.0, 12.0, 0.75) == pytest.approx(12.0 * 38.80, rel=1e-3)
    assert pal_rhodes(1.0, 12.0, 0.75) == pytest.approx(12.0 * 32.26, rel=1e-3)
    assert pal_rhodes_factor(0.84) == pytest.approx(100.0, rel=0.01)  # by the definition of phi_100
    # The audit's figure: Alaska North Slope crude with 70 % of water is about 245 mPa s by PyGNOME's form.
    assert pal_rhodes(1.2, 12.0, 0.70) == pytest.approx(245.0, rel=0.02)


@pytest.mark.parametrize(("law", "slope"), [(mooney, 2.5), (pal_rhodes, 2.49 / (1.187 * 0.84))])
def test_few_stiff_drops_resist_as_einstein_s_spheres(law, slope):
    # Pal and Rhodes's slope is 2.497: Einstein's 2.5 within 0.2 %.
    assert (law(1.0, 3.0, 1e-7) / 3.0 - 1.0) / 1e-7 == pytest.approx(slope, rel=1e-5)
    assert slope == pytest.approx(2.5, rel=2e-3)


@pytest.mark.parametrize("law", [name for name, law in MIXTURE_LAWS.items() if law.is_emulsion])
@pytest.mark.parametrize("fraction", [0.05, 0.49, 0.51, 0.95])
def test_the_continuous_fluid_is_the_one_chosen(law, fraction):
    water, oil = fluids()["sea water"], fluids()["Maya"]
    formula = MIXTURE_LAWS[law].viscosity
    oil_in_water = formula(oil.viscosity, water.viscosity, fraction)
    water_in_oil = formula(water.viscosity, oil.viscosity, 1.0 - fraction)
    for continuous, expected in (
        ("water", oil_in_water),
        ("oil", water_in_oil),
        ("plentiful", water_in_oil if fraction > 0.5 else oil_in_water),
    ):
        column = FluidColumn(oil=oil, water=water, fraction=fraction, law=law, continuous=continuous)
        assert column.surface.viscosity == pytest.approx(expected, rel=1e-12)
        assert column.drops == pytest.approx(fraction if expected == oil_in_water else 1.0 - fraction)
        tension = oil.surface_tension if expected == water_in_oil else water.surface_tension
        assert column.surface.surface_tension == tension


def test_optics_of_the_table():
    assert normal_reflectance(1.333) == pytest.approx(0.02037, abs=5e-6)
    assert normal_reflectance(1.34) == pytest.approx(0.02111, abs=5e-6)
    assert normal_reflectance(1.47) == pytest.approx(0.03621, abs=5e-6)
    assert (diffuse_reflectance(1.333), diffuse_reflectance(1.47)) == pytest.approx((0.0664, 0.0873), abs=5e-5)
    grazing = [fresnel(math.radians(75.0), n).mean for n in (1.333, 1.47)]
    assert grazing == pytest.approx([0.212, 0.247], abs=5e-4)


def test_fresnel_limits():
    angle = np.linspace(0.0, math.pi / 2, 50)
    found = fresnel(angle, 1.333)
    assert found.s[0] == pytest.approx(found.p[0]) == pytest.approx(normal_reflectance(1.333))
    assert found.mean[-1] == pytest.approx(1.0)
    assert fresnel(math.atan(1.333), 1.333).p == pytest.approx(0.0, abs=1e-30)  # at Brewster's angle
    assert fresnel(angle[:-1], 1.0).mean.max() < 1e-28


def test_index_of_oils_by_the_one_third_rule():
    assert oil_index(866.0) == pytest.approx(1.488, abs=2e-3)
    assert oil_index(932.0) == pytest.approx(1.534, abs=2e-3)
    assert fluids()["fresh water"].refractive_index == 1.333
    assert fluids()["Maya"].refractive_index == oil_index(932.0)


@pytest.mark.parametrize("index", [1.0, 1.05, 1.333, 10.0])
def test_light_from_above_is_reflected_by_the_difference_of_the_indices(index):
    assert normal_reflectance(index) == pytest.approx(((index - 1.0) / (index + 1.0)) ** 2)
    assert normal_reflectance(index) == pytest.approx(float(fresnel(0.0, index).mean))
