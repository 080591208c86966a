"""Every registered spectrum against its own closed forms, and against the numbers published for it."""

import math

import numpy as np
import pytest

from sim.ocean.spectra import PARAMETERS, SPECTRA, Conditions, elfouhaily, jonswap
from sim.ocean.spectra.spreading import SPREADINGS, hasselmann_exponent, spread
from sim.ocean.statistics.statistics import theory
from sim.parameters import parameters_of
from tests.naive_ocean import plane_integral


def under(name: str, **values: float | str) -> Conditions:
    """The conditions of a spectrum."""
    return SPECTRA[name].conditions(**values)


def height(name: str, **values: float | str) -> float:
    return 4.0 * math.sqrt(plane_integral(SPECTRA[name], under(name, **values)))


def test_the_seven_are_there():
    names = {"phillips", "pierson_moskowitz", "jonswap", "tma", "elfouhaily", "sea_state", "regular"}
    assert names <= set(SPECTRA)


@pytest.mark.parametrize("degrees", [1.0, 30.0, 179.5, 180.0, -180.0, -37.0])
def test_a_regular_wave_runs_along_the_wind(degrees):
    """Also between the directions of the sum; that of west is 180 degrees."""
    c = under("regular", wind_direction=math.radians(degrees))
    wanted = math.radians(180.0 if degrees == -180.0 else degrees)
    assert theory(SPECTRA["regular"], c).direction == pytest.approx(wanted, abs=1e-5)


@pytest.mark.parametrize("name", [name for name, s in SPECTRA.items() if s.significant_height and not s.line])
def test_declared_height_is_the_integral(name):
    spectrum = SPECTRA[name]
    for wind in (5.0, 20.0):
        expected = spectrum.significant_height(under(name, wind_speed=wind))
        assert height(name, wind_speed=wind) == pytest.approx(expected, rel=2e-5)


@pytest.mark.parametrize("gamma", [1.0, 3.3, 7.0, 10.0, 20.0])
def test_the_height_of_jonswap_is_exact_at_any_peak_factor(gamma):
    c = under("jonswap", peak_enhancement=gamma)
    found = height("jonswap", peak_enhancement=gamma)
    assert SPECTRA["jonswap"].significant_height(c) == pytest.approx(found, rel=1e-4)
    if gamma <= 7.0:  # DNV-RP-C205, 3.5.5.5, which states it for gamma up to 7
        dnv = 4.0 * math.sqrt(
            0.076 * 9810.0**-0.22 * 9.81**2 / (5.0 * SPECTRA["jonswap"].peak(c) ** 4 * (1.0 - 0.287 * math.log(gamma)))
        )
        assert found == pytest.approx(dnv, rel=0.01)


@pytest.mark.parametrize("gravity", [0.0981, 9.81, pytest.param(45.5, marks=pytest.mark.stress), 981.0])
@pytest.mark.parametrize("wind", [0.5, 7.0, *(pytest.param(w, marks=pytest.mark.stress) for w in (3.0, 15.0)), 30.0])
def test_jonswap_stops_at_full_growth(gravity, wind):
    """The sea of Pierson and Moskowitz at the same wind, given with its published height 0.20925 U19.5^2/g and peak."""
    at_mast = 1.026 * wind  # [m/s] 19.5 m up
    full = (22.0 / 0.87716) ** 3 * 1.026**3 * wind**2 / gravity  # [m]

    def of(fetch):
        return under("jonswap", wind_speed=wind, gravity=gravity, fetch=fetch)

    if not 100.0 <= full <= 5e6:  # the fetch that a parameter may have
        full = 5e6 if full > 5e6 else 100.0
    spectrum = SPECTRA["jonswap"]
    grown, longer = (spectrum.significant_height(of(fetch)) for fetch in (full, 2.0 * full))
    if full * gravity / wind**2 > 1.70e4:
        own = 4.0 * math.sqrt(0.076 * 1.704e4**-0.22 / 5.0) / 0.87716**2  # JONSWAP's constants there, gamma 1
        assert grown == pytest.approx(own * at_mast**2 / gravity, rel=1e-3)
        assert grown == pytest.approx(1.049 * 0.20925 * at_mast**2 / gravity, rel=2e-3)
        assert longer == pytest.approx(grown, rel=1e-3)
        assert spectrum.peak(of(full)) == pytest.approx(0.87716 * gravity / at_mast, rel=1e-3)
    else:
        assert longer > grown
    integral = plane_integral(spectrum, of(2.0 * full), k_max=2e3 * max(gravity / wind**2, 1.0))
    assert 4.0 * math.sqrt(integral) == pytest.approx(longer, rel=2e-3)


@pytest.mark.parametrize("name", ["jonswap", "tma"])
def test_a_full_grown_sea_has_the_peak_of_pierson_and_moskowitz_at_the_same_u10(name):
    for u10 in (5.0, 10.0, 25.0):
        grown = SPECTRA[name].peak(under(name, wind_speed=SPECTRA[name].wind_speed(u10), fetch=1e7))
        pierson = SPECTRA["pierson_moskowitz"]
        expected = pierson.peak(under("pierson_moskowitz", wind_speed=pierson.wind_speed(u10)))
        assert grown == pytest.approx(expected, rel=1e-9)


def test_the_peak_factor_falls_to_1_at_full_growth_and_is_as_given_before():
    def factor(fetch):
        c = under("jonswap", wind_speed=10.0, fetch=fetch)
        w = np.array([SPECTRA["jonswap"].peak(c)])
        x = c.gravity * fetch / 100.0
        return float(jonswap.frequency(w, c)[0] / (0.076 * x**-0.22 * c.gravity**2 * w[0] ** -5.0 * math.exp(-1.25)))

    full = 1.704e4 * 100.0 / 9.81
    assert [factor(share * full) for share in (0.01, 0.5, 0.855)] == pytest.approx([3.3] * 3, rel=1e-3)
    assert 1.2 < factor(0.95 * full) < 3.0
    assert factor(full) == pytest.approx(1.0, abs=5e-3)


def test_a_sea_state_has_the_height_and_period_given():
    for gamma in (1.0, 3.3, 10.0):
        values = {"hs": 3.0, "tp": 9.0, "peak_enhancement": gamma}
        assert height("sea_state", **values) == pytest.approx(3.0, rel=1e-4)
        assert height("sea_state", **values, wind_speed=0.0, depth=30.0) == pytest.approx(3.0, rel=1e-4)
        assert theory(SPECTRA["sea_state"], under("sea_state", **values)).peak_period == pytest.approx(9.0, rel=4e-3)
    c = under("jonswap", wind_speed=12.0)
    same = {"hs": height("jonswap", wind_speed=12.0), "tp": 2 * math.pi / jonswap.peak(c)}
    k = np.geomspace(0.01, 5.0, 40)
    one, other = SPECTRA["sea_state"](k, 0.2 * k, under("sea_state", **same)), SPECTRA["jonswap"](k, 0.2 * k, c)
    assert one == pytest.approx(other, rel=1e-3)


def test_a_second_system_adds_its_energy_and_runs_its_own_way():
    second = {"second_height": 1.5, "second_period": 14.0, "second_direction": math.radians(120.0)}
    for name in SPECTRA:
        spectrum, c, alone = SPECTRA[name], under(name, **second), under(name)
        both, one = theory(spectrum, c).significant_height, theory(spectrum, alone).significant_height
        assert both == pytest.approx(math.hypot(one, 1.5), rel=1e-3)
    swell = theory(SPECTRA["jonswap"], under("jonswap", wind_speed=0.0, **second))
    assert swell.significant_height == pytest.approx(1.5, rel=1e-3)
    assert swell.peak_period == pytest.approx(14.0, rel=5e-3)
    assert swell.direction == pytest.approx(math.radians(120.0), abs=1e-3)


def test_each_spectrum_takes_the_wind_at_its_own_height():
    assert {s.wind_height for s in SPECTRA.values()} == {10.0, 19.5}
    for name, spectrum in SPECTRA.items():
        assert spectrum.wind_speed(10.0) == (10.26 if name == "pierson_moskowitz" else 10.0)


def test_no_wind_is_too_weak_to_be_evaluated():
    for name, spectrum in SPECTRA.items():
        for wind in (0.0, 1e-200, 1e-9):
            S = spectrum(np.array([1e-3, 1.0]), np.zeros(2), under(name, wind_speed=wind))
            assert (S > 0.0).any() == (name == "sea_state")


@pytest.mark.parametrize("name", [name for name, s in SPECTRA.items() if s.peak])
def test_declared_peak_is_the_maximum(name):
    spectrum = SPECTRA[name]
    c = under(name, wind_speed=12.0)
    # The peak is found on a grid whose frequencies lie 0.4 % apart.
    tolerance = 0.08 if name == "elfouhaily" else 4e-3  # k_p of elfouhaily is the paper's parameter, not the maximum
    assert 2 * math.pi / theory(spectrum, c).peak_period == pytest.approx(spectrum.peak(c), rel=tolerance)


@pytest.mark.parametrize(
    ("name", "parameter"), [(name, p) for name, s in SPECTRA.items() for p in parameters_of(s.conditions)]
)
def test_declared_parameters_matter(name, parameter):
    declared = PARAMETERS[parameter]
    spectrum, others = SPECTRA[name], {"spreading": "cos2s"} if parameter == "spread_exponent" else {}
    if parameter in {"second_period", "second_direction"}:
        others = {"second_height": 1.0}
    if spectrum.line is not None and parameter in {"wave_height", "wave_period"}:
        one, other = (spectrum.line(under(name, **{parameter: end})) for end in (declared.low, declared.high))
        assert one != other
        return
    ends = declared.choices[:2] if declared.choices else (declared.low, declared.high)
    if parameter == "second_direction":
        ends = declared.low, 0.0  # its two ends are one direction
    k = np.geomspace(1e-3, 10.0, 50)
    one, other = (spectrum(k, 0.3 * k, under(name, **{parameter: end}, **others)) for end in ends)
    assert not np.array_equal(one, other)


@pytest.mark.parametrize("name", SPECTRA)
def test_what_a_spectrum_does_not_read_is_said_to_have_no_effect(name):
    values = {parameter: declared.default for parameter, declared in PARAMETERS.items()}
    read = set(parameters_of(SPECTRA[name].conditions))
    second = {"second_period", "second_direction"}
    assert SPECTRA[name].unused(values) == PARAMETERS.keys() - read | {"spread_exponent"} | second
    assert SPECTRA[name].unused(values | {"spreading": "cos2s"}) == PARAMETERS.keys() - read | second
    assert SPECTRA[name].unused(values | {"spreading": "cos2s", "second_height": 1.0}) == PARAMETERS.keys() - read


@pytest.mark.parametrize("name", SPECTRA)
def test_spectra_are_finite_and_never_negative(name):
    k = np.concatenate([[0.0], np.geomspace(1e-6, 1e5, 200)])
    S = SPECTRA[name](k[:, None], -k[None, :], under(name, wind_direction=2.0, wind_speed=3.0))
    assert np.isfinite(S).all()
    assert (S >= 0.0).all()
    assert S[0, 0] == 0.0
    level = under(name, wind_speed=0.0)
    assert SPECTRA[name](k[:, None], k[None, :], level).any() == (name == "sea_state")
    assert SPECTRA[name].is_level(level) == (name not in {"sea_state", "regular"})


@pytest.mark.parametrize("name", SPECTRA)
def test_turning_the_wind_turns_the_spectrum(name):
    rng = np.random.default_rng(0)
    kx, ky = rng.normal(size=(2, 100))
    turn = 0.7
    turned = SPECTRA[name](
        kx * math.cos(turn) - ky * math.sin(turn),
        kx * math.sin(turn) + ky * math.cos(turn),
        under(name, wind_direction=turn),
    )
    assert turned == pytest.approx(SPECTRA[name](kx, ky, under(name)), rel=1e-9, abs=1e-15)


def test_pierson_moskowitz_at_ten_metres_a_second():
    c = under("pierson_moskowitz", wind_speed=10.0)
    assert SPECTRA["pierson_moskowitz"].significant_height(c) == pytest.approx(2.13300, abs=2e-5)
    assert SPECTRA["pierson_moskowitz"].peak(c) == pytest.approx(0.8772 * 0.981, rel=1e-4)


@pytest.mark.parametrize("gravity", [0.0981, 2.114, 9.81, 45.5, 981.0])
def test_planets_collapse(gravity):
    conditions = under("pierson_moskowitz", wind_speed=10.0, gravity=gravity)
    found = plane_integral(SPECTRA["pierson_moskowitz"], conditions, k_max=2e3 * max(gravity / 9.81, 1.0))
    assert 4 * math.sqrt(found) * gravity / 100.0 == pytest.approx(0.20925, rel=1e-3)


def test_jonswap_of_the_table():
    assert height("jonswap") == pytest.approx(2.1386, abs=1e-4)
    assert height("jonswap", wind_speed=20.0, fetch=5.5e5) == pytest.approx(10.21, abs=5e-3)


@pytest.mark.parametrize(("depth", "expected"), [(5.0, 1.2848), (10.0, 1.6700), (20.0, 2.0027), (50.0, 2.1356)])
def test_tma_of_the_table(depth, expected):
    assert height("tma", depth=depth) == pytest.approx(expected, abs=1e-4)


@pytest.mark.parametrize(("wind", "expected"), [(5.0, 0.2527), (8.0, 0.2548), (10.0, 0.2556), (15.0, 0.2559)])
def test_elfouhaily_of_the_table(wind, expected):
    assert height("elfouhaily", wind_speed=wind) * 9.81 / wind**2 == pytest.approx(expected, abs=6e-5)


def test_phillips_at_the_lab_constant_has_the_height_of_pierson_moskowitz():
    assert height("phillips") == pytest.approx(height("pierson_moskowitz"), rel=1e-4)


@pytest.mark.parametrize("name", SPREADINGS)
def test_spreading_far_below_the_peak_is_finite(name):
    ratio, theta = np.logspace(-9, 0, 50)[:, None], np.linspace(-np.pi, np.pi, 16)
    assert np.isfinite(spread(name, ratio, theta, 10.0, 0.5, 5.0)).all()


@pytest.mark.parametrize("name", SPREADINGS)
@pytest.mark.parametrize("swell", [0.0, 0.4, 1.0])
def test_spreading_integrates_to_one(name, swell):
    theta = (np.arange(2000) + 0.5) * (2 * math.pi / 2000) - math.pi
    for ratio in (0.3, 0.7, 1.0, 1.7, 5.0, 20.0):
        D = spread(name, np.full_like(theta, ratio), theta, 8.0, swell, 0.9)
        assert D.sum() * (2 * math.pi / 2000) == pytest.approx(1.0, abs=7e-4 if swell else 4e-5)
        assert (D >= 0.0).all()


@pytest.mark.parametrize("inverse_age", [0.84, 1.17, 2.0])
def test_hasselmann_s_exponent_is_the_paper_s_on_both_sides_of_its_split_and_has_no_jump(inverse_age):
    """Hasselmann, Dunckel and Ewing (1980): two fits, split at 1.05 f_p."""
    below, above = np.linspace(0.3, 1.02, 50), np.linspace(1.08, 10.0, 50)
    assert hasselmann_exponent(below, inverse_age) == pytest.approx(6.97 * below**4.06, rel=1e-12)
    fit = 9.77 * above ** (-2.33 - 1.45 * (inverse_age - 1.17))
    assert hasselmann_exponent(above, inverse_age) == pytest.approx(fit, rel=1e-12)
    fine = hasselmann_exponent(np.linspace(0.9, 1.2, 3001), inverse_age)
    assert np.abs(np.diff(fine)).max() < 5e-3  # steps of 1e-4 f_p; the slope is 33 at most
    assert fine.max() == pytest.approx(8.6, abs=0.3)


def test_swell_narrows_the_sea():
    for name in SPREADINGS:
        ahead = [spread(name, np.ones(1), np.zeros(1), 8.0, xi, 0.9)[0] for xi in (0.0, 0.5, 1.0)]
        assert ahead[0] < ahead[1] < ahead[2], name


def test_low_pass_is_fluid_left_alone_for_a_time():
    """l = 2 sqrt(nu T): the energy factor exp(-k^2 l^2) is exp(-4 nu k^2 T)."""
    k, nu, T = np.array([0.5, 3.0]), 1e-3, 600.0
    fresh = SPECTRA["phillips"](k, 0 * k, under("phillips"))
    aged = SPECTRA["phillips"](k, 0 * k, under("phillips", low_pass=2 * math.sqrt(nu * T)))
    assert aged == pytest.approx(fresh * np.exp(-4 * nu * k**2 * T), rel=1e-12)


@pytest.mark.parametrize("k", [0.02, 1.0, 60.0, 370.0, 2000.0])
def test_elfouhaily_s_spreading_is_that_of_its_waves_speed(k):
    """Eq. 57: Delta = tanh(a0 + ap (c/cp)^2.5 + am (cm/c)^2.5), seen in the ratio of two directions."""
    c = under("elfouhaily", wind_speed=9.0)
    along, aside = (
        float(SPECTRA["elfouhaily"](np.array([k * math.cos(a)]), np.array([k * math.sin(a)]), c)[0])
        for a in (0.0, math.pi / 3)
    )
    found = (along / aside - 1.0) / (1.0 + 0.5 * along / aside)
    speed, slowest, fastest = math.sqrt(9.81 / k + 9.81 * k / 370.0**2), math.sqrt(2 * 9.81 / 370.0), 9.0 / 0.84
    wind = 0.13 * elfouhaily.friction_velocity(c) / slowest
    Delta = math.tanh(0.25 * math.log(2.0) + 4.0 * (speed / fastest) ** 2.5 + wind * (slowest / speed) ** 2.5)
    assert found == pytest.approx(Delta, rel=1e-9)


def test_donelan_and_banner_s_spreading_is_narrowest_at_the_peak_and_has_no_jumps():
    """beta by the angle at which sech^2(beta theta) has fallen to a half; Donelan et al. (1985), Banner (1990)."""
    p = np.linspace(0.3, 4.0, 1500)
    half = np.empty(len(p))
    theta = np.linspace(0.0, math.pi, 20_001)
    for i, one in enumerate(p):
        D = spread("donelan_banner", np.full(len(theta), one), theta, 1.0, 0.0, 1.0)
        half[i] = theta[np.searchsorted(-D, -0.5 * D[0])]
    beta = math.acosh(math.sqrt(2.0)) / half
    assert beta[p < 0.55] == pytest.approx(2.61 * 0.56**1.3, rel=1e-3)
    assert p[beta.argmax()] == pytest.approx(0.95, abs=0.01)
    assert beta.max() == pytest.approx(2.61 * 0.95**1.3, rel=5e-3)
    at = lambda ratio: float(np.interp(ratio, p, beta))  # noqa: E731
    assert at(1.3) == pytest.approx(2.28 * 1.3**-1.3, rel=2e-3)
    assert at(1.6) / at(1.0) == pytest.approx(1.6**-1.3, rel=0.01)
    assert np.abs(np.diff(beta)).max() < 0.02
    assert at(4.0) == pytest.approx(10.0 ** (-0.4 + 0.8393 * math.exp(-0.567 * math.log(16.0))), rel=2e-3)
