"""Weathering of a spill: against plain steps of PyGNOME's laws, tabulated components, and closed forms of each law."""

import itertools
import math

import numpy as np
import pytest

from sim.ocean.fluids.fluid_column import FluidColumn
from sim.ocean.fluids.fluids import fluids
from sim.ocean.weathering import Spill, laws, oil_records, pseudo_components, weather
from sim.ocean.weathering.components import (
    api_gravity,
    boiled_off,
    can_weather,
    density_at,
    distillation_of,
    viscosity_at,
)
from tests import naive_spill


@pytest.mark.parametrize("oil", naive_spill.OILS)
def test_an_oil_s_parts_are_those_of_adios(oil):
    found, table = pseudo_components(oil), np.array(naive_spill.OILS[oil].parts).T
    assert found.share == pytest.approx(table[0], rel=1e-5)
    assert found.boiling_point == pytest.approx(table[1])
    assert 1e3 * found.molar_mass == pytest.approx(table[2], rel=1e-5)
    assert found.density == pytest.approx(table[3], rel=1e-5)


@pytest.mark.parametrize("oil", naive_spill.OILS)
@pytest.mark.parametrize("wind", [5.0, 7.0, 15.0])
def test_a_spill_of_100_m3_is_that_of_plain_steps_of_pygnome_s_laws(oil, wind):
    weathering = weather(Spill(oil=oil, volume=100.0, wind_speed=wind))
    for hours in (1.0, 6.0, 24.0):
        found, expected = weathering.at(hours), naive_spill.spill(oil, 100.0, wind, hours)
        for name, value in expected.items():
            assert getattr(found, name) == pytest.approx(value, rel=0.02, abs=1e-9), (name, hours)


def test_a_day_of_100_m3_at_7_m_s_of_the_table():
    # Evaporated, dispersed, water in the emulsion, area [km2], made with tests/naive_spill.py in steps of 1 s.
    table = {
        "Alaska North Slope 2002": (0.330, 0.462, 0.730, 0.910),
        "Arabian Light": (0.245, 0.0491, 0.891, 0.912),
        "diesel 2002": (0.702, 0.298, 0.0, 0.378),
    }
    for oil, row in table.items():
        day = weather(Spill(oil=oil)).at(24.0)
        found = day.evaporated, day.dispersed, day.water_content, day.area * 1e-6
        assert found == pytest.approx(row, rel=0.01), oil


@pytest.mark.parametrize("oil", [name for name in oil_records() if can_weather(name)])
@pytest.mark.parametrize(("volume", "wind", "temperature"), [(1.0, 0.0, 0.0), (100.0, 7.0, 15.0), (1e5, 25.0, 30.0)])
def test_the_budget_sums_to_the_oil_spilt_and_nothing_comes_back(oil, volume, wind, temperature):
    found = weather(Spill(oil=oil, volume=volume, wind_speed=wind, temperature=temperature))
    assert found.hours[-1] == 120.0
    assert np.abs(found.evaporated + found.dispersed + found.remaining - 1.0).max() < 2e-6
    for values in (found.evaporated, found.dispersed, found.water_content, found.area):
        assert np.isfinite(values).all()
        assert np.diff(values).min() >= -1e-12
    assert found.water_content.max() <= oil_records()[oil].emulsion_water + 1e-12
    for hours in (0.0, 24.0, 120.0):
        state = found.at(hours)
        assert 0.0 <= state.thickness < 0.2
        # Volume of oil, from its mass, and of the water in it, over the area.
        oil_volume = volume * density_at(oil, temperature) * state.remaining / state.oil_density
        assert state.thickness * state.area * (1.0 - state.water_content) == pytest.approx(oil_volume, rel=1e-9)
        column = FluidColumn(oil=state.fluid(oil), thickness=0.01)  # it floats
        assert column.layers[0][0] < fluids()["sea water"].density


def test_at_the_start_the_oil_is_fresh():
    for oil in ("Brent", "Maya"):
        start = weather(Spill(oil=oil)).at(0.0)
        fluid, fresh = start.fluid(oil), fluids()[oil]
        assert (fluid.density, fluid.viscosity) == pytest.approx((fresh.density, fresh.viscosity), rel=1e-9)
        assert (fluid.colour, fluid.refractive_index) == (fresh.colour, pytest.approx(fresh.refractive_index))
        assert (start.evaporated, start.dispersed, start.water_content) == (0.0, 0.0, 0.0)


def test_density_and_viscosity_at_other_temperatures():
    assert density_at("Maya", 0.0) == pytest.approx(944.8)
    assert density_at("Maya", 30.0) == pytest.approx(2 * 932.0 - 944.8)
    assert viscosity_at("Maya", 0.0) == pytest.approx(2.95 / 944.8)
    # ln nu is linear in 1/T: three temperatures evenly apart in 1/T have the middle one's geometric mean.
    warmer = 1.0 / (2.0 / 288.15 - 1.0 / 273.15) - 273.15
    mean = math.sqrt(viscosity_at("Maya", 0.0) * viscosity_at("Maya", warmer))
    assert mean == pytest.approx(viscosity_at("Maya", 15.0), rel=1e-12)


def test_distillation_of_records_and_of_jones():
    assert boiled_off("Alaska North Slope 2002", 180.0 + 273.15) == pytest.approx(0.226)
    assert api_gravity("diesel 2002") == pytest.approx(38.69, abs=0.01)  # as the record has it
    share, at = distillation_of("Maya")  # a crude oil without a distillation: 457 - 3.34 x 20.25 K at 20 %
    assert (share[0], share[-1]) == (0.0, 1.0)
    assert at[1] == pytest.approx(457.0 - 3.34 * 20.25, abs=0.2)
    assert np.diff(at)[1:] == pytest.approx((1357.0 - 247.7 * math.log(20.25)) / 5.0, abs=0.5)


def test_vapour_pressures_are_near_measured_ones():
    # Boiling points and vapour pressures at 25 C: n-hexane, n-heptane, n-octane (CRC Handbook); at boiling, 1 atm.
    boiling = np.array([341.9, 371.6, 398.8])
    assert laws.vapour_pressure(boiling, 298.15) == pytest.approx([20200.0, 6090.0, 1860.0], rel=0.18)
    for at in boiling:
        assert float(laws.vapour_pressure(np.array([at]), at)[0]) == pytest.approx(101325.0)


def test_evaporation_is_mackay_and_matsugu_s():
    parts = pseudo_components("diesel 2002")
    mass, volatile = 1000.0 * parts.share, laws.volatility(parts, 288.15)
    base = laws.evaporation_rates(parts, volatile, mass, 1e4, 0.0, 8.0)
    # K = 0.0048 U^0.78 X^(-1/9): wind, area and water each by its power; the pressure of each part by itself.
    assert laws.evaporation_rates(parts, volatile, mass, 1e4, 0.6, 8.0) == pytest.approx(0.4 * base)
    assert laws.evaporation_rates(parts, volatile, mass, 1e4, 0.0, 16.0) == pytest.approx(2.0**0.78 * base)
    assert laws.evaporation_rates(parts, volatile, mass, 4e4, 0.0, 8.0) == pytest.approx(4.0 ** (1 - 1 / 18) * base)
    assert laws.evaporation_rates(parts, volatile, mass, 1e4, 0.0, 0.2) == pytest.approx(8.0**-0.78 * base)
    # Pure n-heptane on 1 m2, by hand: 0.0048 x 1.380277 (18/100.2)^(1/3) x 1.1284^(-1/9) x 5^0.78 m/s.
    heptane = parts._replace(
        share=np.ones(1), boiling_point=np.array([371.6]), molar_mass=np.array([0.1002]), density=np.array([684.0])
    )
    volatile = laws.volatility(heptane, 298.15)
    loss = laws.evaporation_rates(heptane, volatile, np.array([0.1002]), 1.0, 0.0, 5.0)[0]
    pressure = float(laws.vapour_pressure(np.array([371.6]), 298.15)[0])
    assert loss == pytest.approx(0.012955 * pressure / (8.314 * 298.15), rel=2e-3)


def test_water_uptake_is_its_closed_form():
    # At first Y = K U^2 t, a film of drops of the largest size; then 1 - e^(-t) towards the smallest drops.
    assert laws.water_content(1.0, 10.0, 0.9) == pytest.approx(2.02e-6 * 100.0, rel=1e-3)
    for hours, wind, most in itertools.product((1.0, 10.0, 30.0), (4.0, 12.0), (0.7, 0.9)):
        rate, finest = 6 * 2.02e-6 * wind**2 / 1e-5, 6e6 * most / (1 - most)
        drops = finest * (1.0 - math.exp(-rate * hours * 3600.0 / finest)) * 1e-5
        assert laws.water_content(hours * 3600.0, wind, most) == pytest.approx(min(drops / (6.0 + drops), most))
    assert laws.water_content(-1.0, 10.0, 0.9) == laws.water_content(1e5, 10.0, 0.0) == 0.0


def test_emulsions_form_when_enough_has_evaporated():
    found = weather(Spill(oil="Alaska North Slope 2002", wind_speed=7.0))
    first = int(np.argmax(found.water_content > 0.0))
    assert found.evaporated[first - 1] <= 0.305 <= found.evaporated[first]  # of its record
    assert weather(Spill(oil="diesel 2002")).water_content.max() == 0.0
    assert weather(Spill(oil="Arabian Light")).water_content[1] > 0.0


def test_spreading_without_eddies_is_fay_s_square_root():
    # dA/dt = C^2/(2A) gives A^2 = A0^2 + C^2 (t - t0), here in 40000 plain steps, without what eddies add.
    volume, light = 100.0, 1.0 - 866.0 / 1025.0
    area, start = laws.initial_area(volume, light)
    assert (area, start) == pytest.approx((14320.0, 157.9), rel=1e-3)
    fay = math.pi * 1.45**2 * (volume**2 * 9.80665 * light / 1e-3) ** (1 / 3)
    eddies = 8.0 * math.pi * 0.033
    first, step = area, 86400.0 / 40000
    for _ in range(40000):
        area += step * (laws.area_growth(area, volume, light) - 7 / 6 * eddies * (area / eddies) ** (1 / 7))
    assert area == pytest.approx(math.sqrt(first**2 + fay**2 * 86400.0), rel=1e-3)
    assert laws.initial_area(volume, 0.0) == (math.inf, 0.0)


def test_a_slick_spreads_by_the_density_at_its_temperature():
    """A heavy oil, so that a few kg/m3 matter: Maya at 0, 15 and 30 C, on water of 1025 kg/m3."""
    for celsius, density in ((0.0, 944.8), (15.0, 932.0), (30.0, 2 * 932.0 - 944.8)):
        light = 1.0 - density / 1025.0
        first = math.pi * 1.21**4 / 1.53**2 * (1e4**5 * 9.80665 * light / 1e-12) ** (1 / 6)
        assert weather(Spill(oil="Maya", volume=1e4, temperature=celsius)).area[0] == pytest.approx(first, rel=1e-4)


def test_a_slick_stops_to_spread_at_its_least_thickness():
    thin = [laws.least_thickness(nu) for nu in (1e-7, 1e-6, 5e-5, 1e-4, 1.0)]
    assert thin == pytest.approx([1e-5, 1e-5, 1e-5 + 0.9091 * 4.9e-5, 1e-4, 1e-4], rel=1e-4)
    assert weather(Spill(oil="Maya", volume=1.0)).area[-1] == pytest.approx(1.0 / 1e-4, rel=1e-4)


def test_natural_dispersion_is_delvigne_and_sweeney_s():
    assert laws.wave_height(7.0) == pytest.approx(0.8584, rel=1e-4)
    assert laws.wave_height(4.43304) == pytest.approx(laws.wave_height(4.43306), rel=1e-4)
    assert laws.breaking_share(7.0) == pytest.approx(0.5 * 0.08 / 3.85, rel=1e-3)
    assert laws.breaking_share(2.0) == pytest.approx(0.5 * 0.025 / 3.85, rel=1e-3)
    # By hand: 0.0034 x 1025 x 9.80665 x 0.8584^2 = 25.18; 25.18^0.57 = 6.289; 2400 e^(-0.73682) = 1148.7 at 1e-4 m2/s.
    rate = laws.dispersion_rate(1e5, 1e-4, 0.5, 7.0, 1025.0)
    assert rate == pytest.approx(1148.7 * 6.289 * 0.010390 * 3.9e-8 * 0.5 * 1e5, rel=2e-3)


def test_weathered_oil_thickens_by_evaporation_and_by_water():
    assert laws.viscosity_factor(1e-5, 0.3, 0.0) == pytest.approx(math.exp(1500.0 * math.sqrt(1e-5) * 0.3))
    assert laws.viscosity_factor(1e-8, 0.3, 0.0) == pytest.approx(math.exp(0.3))
    assert laws.viscosity_factor(1e-2, 0.3, 0.84) == pytest.approx(math.exp(3.0) * 99.65, rel=1e-3)


def test_fingas_law_of_the_table():
    # D = 22.6 % at 180 C: 0.165 x 22.6 ln 1440 = 27.12 %; 5 degrees warmer, 0.225 ln 1440 more; diesel by the root.
    assert laws.fingas(0.226, 288.15, 1440.0) == pytest.approx(0.2712, abs=1e-4)
    assert laws.fingas(0.226, 293.15, 1440.0) == pytest.approx(0.2712 + 0.00225 * math.log(1440.0), abs=1e-4)
    assert laws.fingas(0.268, 288.15, 1440.0, is_crude=False) == pytest.approx(0.0254 * 26.8 * 0.37947, rel=1e-4)
    cold = laws.fingas(0.268, 278.15, 1440.0, is_crude=False)
    assert cold == pytest.approx((0.0254 * 26.8 - 0.1) * 0.37947, rel=1e-4)
    assert laws.fingas(0.226, 288.15, 0.5) == 0.0
    assert laws.fingas(1.0, 303.15, 7200.0) == 1.0


@pytest.mark.parametrize("is_crude", [True, False])
def test_stiver_and_mackay_s_rate_falls_with_what_has_evaporated(is_crude):
    # dF/dtheta = exp(6.3 - 10.3 (T0 + G F)/T).
    api, T = 32.0, 288.15
    start, slope = (
        (532.98 - 3.1295 * 32, 985.62 - 13.597 * 32) if is_crude else (654.45 - 4.6588 * 32, 388.19 - 3.8725 * 32)
    )
    for theta in (10.0, 1e3, 1e5):
        lost = [laws.stiver_mackay(theta * x, T, api, is_crude=is_crude) for x in (0.999, 1.0, 1.001)]
        rate = (lost[2] - lost[0]) / (0.002 * theta)
        assert rate == pytest.approx(math.exp(6.3 - 10.3 * (start + slope * lost[1]) / T), rel=1e-4)


def test_exposure_is_the_time_integral_of_area_over_volume():
    found = weather(Spill(wind_speed=6.0))
    areas, times = found.area, found.hours * 3600.0
    many = np.linspace(0.0, 24.0 * 3600.0, 100001)
    expected = 0.0025 * 6.0**0.78 * np.interp(many, times, areas).mean() * many[-1] / 100.0
    assert found.exposure(24.0) == pytest.approx(expected, rel=1e-3)


def test_in_a_wind_of_20_knots_oil_drifts_14_nautical_miles_a_day():
    """Responders' rule, 3 % of the wind (NOAA, Trajectory Analysis Handbook): 0.6 knots."""
    knot, nautical_mile = 1852.0 / 3600.0, 1852.0
    assert weather(Spill(wind_speed=20.0 * knot)).at(24.0).drift / nautical_mile == pytest.approx(14.4)


def test_more_wind_and_warmth_evaporate_more():
    lost = [weather(Spill(wind_speed=u, temperature=t)).at(3.0).evaporated for u, t in ((2, 5), (8, 5), (8, 25))]
    assert lost[0] < lost[1] < lost[2]
