"""Angles of the spectra: degrees in both panels, radians in the library, converted at one place."""

import math

import pytest

from app.scenes.radial_sea import parameters as radial
from app.scenes.sea_parameters import SPECTRUM_PARAMETERS
from app.scenes.square_sea import parameters as square
from sim.ocean import Sea
from sim.ocean.spectra import PARAMETERS
from sim.ocean.statistics.statistics import expected
from sim.parameters import parameters_of

SWELL = {"wind_speed": 0.0, "second_height": 1.0, "second_period": 6.0}


def test_no_angle_of_the_library_is_in_degrees_and_none_of_the_panels_in_radians() -> None:
    assert not any("°" in declared.unit for declared in PARAMETERS.values())
    for params in (radial.RadialSeaParams, square.SquareSeaParams):
        assert not any(declared.unit == "rad" for declared in parameters_of(params).values())
    found = SPECTRUM_PARAMETERS["second_direction"]
    assert (found.default, found.low, found.high, found.unit) == (90.0, -180.0, 180.0, "°")


@pytest.mark.parametrize("degrees", [-180.0, -35.0, 90.0, 180.0])
def test_a_direction_in_degrees_on_the_panel_is_the_same_in_radians_in_the_sea(degrees: float) -> None:
    under = radial.conditions_of(radial.RadialSeaParams(second_direction=degrees))
    assert under.second_direction == pytest.approx(math.radians(degrees), rel=1e-15)
    given = square.conditions(square.SquareSeaParams(second_direction=degrees))
    assert given["second_direction"] == under.second_direction


def test_swell_goes_where_its_direction_in_radians_points() -> None:
    for direction in (-2.0, 0.5, math.pi / 2):
        sea = Sea(128, 400.0, "jonswap", second_direction=direction, **SWELL)
        assert expected(sea).direction == pytest.approx(direction, abs=0.02)
