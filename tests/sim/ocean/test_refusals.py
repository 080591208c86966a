"""Arguments at and beyond the edges of what is allowed: each is refused by its name, or gives the right limit."""

import math
from functools import partial

import numpy as np
import pytest

from sim.ocean import SPECTRA, RadialSea, Sea, draw_waves, zero_crossings
from sim.ocean.dispersion import (
    group_speed,
    mode_ratios,
    omega,
    phase_speed,
    two_layer,
    viscous_root,
    viscous_two_layer,
)
from sim.ocean.fluids.emulsions import arrhenius, pal_rhodes
from sim.ocean.fluids.fluid_column import FluidColumn
from sim.ocean.fluids.fluids import fluids, fresnel, mixed, oil_index
from sim.ocean.fluids.oil_film import light_through
from sim.ocean.fluids.slick import slick_radius
from sim.ocean.planets import RADIUS_RULES, gravity_of
from sim.ocean.radial.radial_grid import RadialGrid
from sim.ocean.spectra import Conditions
from sim.ocean.statistics.statistics import beaufort, expected, measured, resolved_in_time
from sim.ocean.weathering import Spill, weather
from tests.refusals import Row, assert_refused, each

NAN, INF = math.nan, math.inf
JONSWAP = SPECTRA["jonswap"]


def small(**values):
    return Sea(16, **{"length": 50.0, **values})


def drop(**values):
    small(wind_speed=0.0).ripples.add(0.0, **{"points": [[1.0, 2.0]], "width": 1.0, **values})


def shallow_waves():
    return draw_waves(JONSWAP, JONSWAP.conditions(depth=8.0), 4)


def radial() -> RadialSea:
    return RadialSea(draw_waves(JONSWAP, JONSWAP.conditions(), 4))


REFUSED: list[Row] = [
    *each(partial(Sea, length=50.0), size=[100000, 33, 64.0]),
    *each(
        small,
        length=[0.0, INF, 1e-300, 1e300],
        spectrum=["calm"],
        wind_speed=[NAN, 1e200],
        gravity=[-1.0, 1e-300, 1e300],
        depth=[0.0, -5.0, 1e-300, NAN],
        tension=[INF],
        viscosity=[-1.0, 1e300],
        film=["no"],
        choppiness=[-1.0, NAN],
        amplitudes=["loud"],
        seed=[1.5],
        precision=["half"],
        loop_period=[0.0],
        dispersion_scale=[-1.0],
    ),
    ("frequency", lambda: small(frequency=lambda k: k * NAN), ""),
    ("frequency", lambda: small(frequency=lambda k: 1.0), ""),
    ("frequency", lambda: small(frequency=3), ""),
    ("decay", lambda: small(decay=lambda k: -k), ""),
    ("points", lambda: small().height_at([[1e20, 0.0]], 0.0), ""),
    ("points", lambda: small().height_at("x", 0.0), ""),
    ("points", lambda: small().height_at([[1.0, 2.0], [3.0]], 0.0), ""),
    ("points", lambda: small().height_at([[1.0, 2.0, 3.0]], 0.0), ""),
    ("points", lambda: small().height_at([[1.0, NAN]], 0.0), ""),
    *each(
        partial(small().kinematics, points=[[0.0, 0.0, -1.0]], t=0.0),
        points=[[[0.0, 0.0]], [[0.0, 0.0, NAN]], "x"],
        t=[NAN, "1"],
        stretching=["wheel", None],
    ),
    *each(small().waves_at().largest, count=[0, -1, 2.5]),
    ("points", lambda: radial().kinematics([[0.0, 0.0]], 0.0), "(n, 3)"),
    ("t", lambda: radial().kinematics([[0.0, 0.0, 0.0]], INF), ""),
    ("waves", lambda: RadialSea(radial().waves, FluidColumn(gravity=1.62)), "under the column's gravity of 1.62"),
    ("waves", lambda: RadialSea(shallow_waves()), "waves of water 8 m deep, on a column inf m deep"),
    ("waves", lambda: radial().change(1.0, shallow_waves()), "waves of water 8 m deep, on a column inf m deep"),
    (
        "column",
        lambda: RadialSea(radial().waves, FluidColumn(thickness=0.1)).kinematics([[0.0, 0.0, 0.0]], 0.0),
        "layer",
    ),
    ("t", lambda: small().significant_height_at(NAN), ""),
    ("t", lambda: small().surface(NAN), ""),
    ("t", lambda: small(viscosity=1e-3).surface(-1.0), ""),
    *each(drop, points=[[[1.0]], [[1.0, INF]]], width=[0.0], volume=[NAN], impulse=[[1.0, 2.0]]),
    *each(SPECTRA["phillips"].conditions, wind_speed=[-1.0], wind_direction=[INF], gravity=[0.0], low_pass=[-1.0]),
    *each(JONSWAP.conditions, wind_speed=[NAN], fetch=[-5.0], spreading=["narrow"]),
    *each(SPECTRA["tma"].conditions, depth=[0.0], fetch=[NAN]),
    *each(SPECTRA["elfouhaily"].conditions, inverse_wave_age=[0.5]),
    *each(SPECTRA["pierson_moskowitz"].conditions, swell=[1.5]),
    *each(partial(small, spectrum="jonswap"), hs=[8.0], tp=[15.0], inverse_wave_age=[1.0]),
    ("fetch", lambda: small().change(1.0, fetch=1e4), "pierson_moskowitz uses"),
    ("fetch", lambda: small(spectrum="jonswap").change(1.0, spectrum="phillips", fetch=1e4), "phillips uses"),
    *each(JONSWAP.frequency_density, omega=[[1.0, 0.0], -1.0, "x", [NAN]]),
    ("hs", lambda: JONSWAP.frequency_density(1.0, hs=2.0), "jonswap uses"),
    ("tp", lambda: JONSWAP.moments(tp=8.0), "jonswap uses"),
    *each(JONSWAP.moments, cut_off=[0.0, -1.0, "all"], wind_speed=[NAN]),
    *each(partial(zero_crossings, height=[0.0, 1.0]), t=[[1.0, 0.0], [[1.0, 2.0]], [0.0, NAN]]),
    *each(partial(zero_crossings, [0.0, 1.0]), height=[[1.0], [0.0, INF]]),
    ("height", lambda: measured(np.zeros((4, 5)), 1.0, Conditions()), ""),
    ("earlier", lambda: measured(np.zeros((4, 4)), 1.0, Conditions(), np.zeros((5, 5))), ""),
    ("wind_speed", lambda: beaufort(-1.0), "-1"),
    *each(omega, k=["a", [[1.0, 2.0], [3.0]], True, 1e200, [1.0, -2.0], NAN]),
    *each(partial(omega, 1.0), gravity=[0.0], depth=[-1.0, NAN], tension=[-1.0], density=[INF]),
    ("lower_density", lambda: two_layer(1.0, 1025.0, 1.0, 850.0), ""),
    ("thickness", lambda: two_layer(1.0, 850.0, 0.0, 1025.0), ""),
    *each(partial(viscous_root, 1.0), viscosity=[-1e-6, "thick"]),
    ("upper_viscosity", lambda: viscous_two_layer(1.0, 850.0, 0.0, 1.0, 1025.0, 1e-3), ""),
    ("thickness", lambda: viscous_two_layer(1.0, 850.0, 1e-2, INF, 1025.0, 1e-3), ""),
    ("lower_viscosity", lambda: viscous_two_layer(1.0, 850.0, 1e-2, 1.0, 1025.0, NAN), ""),
    *each(partial(fresnel, index=1.33), angle=[2.0, -0.1, NAN]),
    ("index", lambda: fresnel(0.0, 0.9), ""),
    *each(oil_index, density=[NAN]),
    ("fraction", lambda: arrhenius(1.0, 1.0, 1.5), ""),
    ("first", lambda: arrhenius(0.0, 1.0, 0.5), ""),
    ("fraction", lambda: pal_rhodes(1.0, 1.0, 0.998), ""),
    ("law", lambda: mixed(fluids()["Maya"], fluids()["Mars"], 0.5, "stirred"), ""),
    ("continuous", lambda: mixed(fluids()["Maya"], fluids()["Mars"], 0.5, continuous=fluids()["Brent"]), ""),
    *each(FluidColumn, continuous=["air"], thickness=[-1.0], law=["nonsense"]),
    ("fraction", lambda: FluidColumn(fraction=0.001, continuous="oil"), ""),
    *each(light_through, thickness=[-1e-6, NAN, INF, "thin"]),
    *each(gravity_of, mass=[0.0, -1.0, NAN, INF, 1e308]),
    ("rule", lambda: gravity_of(1.0, "hollow"), ", ".join(RADIUS_RULES)),
    *each(partial(slick_radius, 1.0, 1.0, 850.0), viscosity=[0.0], gravity=[-9.8]),
    ("count", lambda: draw_waves(JONSWAP, JONSWAP.conditions(), 0), ""),
    *each(RadialGrid, rings=[2], law=["cubic"], inner=[1e5]),
    ("points", lambda: radial().at([[NAN, 0.0]], 0.0), ""),
    ("t", lambda: radial().on(RadialGrid(), INF), ""),
    *each(Spill, oil=["Bunker C Zalinski", "sea water"], water=["Brent"], volume=[0.0, NAN]),
    *each(Spill, wind_speed=[-1.0], temperature=[60.0, 288.15]),
    ("hours", lambda: weather(Spill()).at(121.0), ""),
]


@pytest.mark.parametrize(("name", "call", "words"), REFUSED)
def test_a_bad_argument_is_refused_by_name(name, call, words):
    assert_refused(name, call, words)


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
