"""The numbers in the panel's texts of the square sea, against closed forms written out here, over many settings."""

import itertools
import math
import re
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from app.messages import Snapshot
from app.render.markup.html import WARNING_COLOUR, bold
from app.scenes import quantities
from app.scenes.square_sea.parameters import SquareSeaParams
from app.scenes.square_sea.quantities import QUANTITIES, open_sea
from app.scenes.square_sea.report import (
    breaking_text,
    foam_text,
    low_pass_line,
    marks,
    readout,
    statistics_table,
    viscosity_line,
    wind_line,
)
from app.scenes.square_sea.scene import SquareSeaScene
from app.server.loop.sim_loop import SimLoop
from sim.parameters import check_record
from sim.water import EARTH_GRAVITY

Loop: Any = SimLoop  # of a scene whose types the tests know

DIGITS = {"⁰": "0", "¹": "1", "²": "2", "³": "3", "⁴": "4", "⁵": "5", "⁶": "6", "⁷": "7", "⁸": "8", "⁹": "9", "⁻": "-"}
SECONDS = {"ms": 1e-3, "s": 1.0, "min": 60.0, "h": 3600.0, "days": 86400.0, "years": 31557600.0, "µs": 1e-6}


def params(**values: Any) -> SquareSeaParams:
    return check_record(SquareSeaParams, values)


def numbers(text: object) -> list[float]:
    """All numbers of a text, powers of ten included."""
    plain = re.sub(r"<[^>]*>", " ", str(text)).replace("\u202f", "").replace("−", "-")
    plain = re.sub(r" × 10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)", lambda m: "e" + "".join(DIGITS[c] for c in m[1]), plain)
    return [float(n) for n in re.findall(r"(?<![A-Za-z\d])-?\d+(?:\.\d+)?(?:e-?\d+)?", plain)]


def duration(text: str) -> float:
    """The last duration [s] of a text."""
    found = re.findall(r"(\d[\d.]*(?: × 10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?) (ms|s|min|h|days|years|µs)\b", text.replace("\u202f", ""))
    return numbers(found[-1][0])[0] * SECONDS[found[-1][1]]


def decay_of(length: float, nu: float, g: float) -> float:
    """Lamb's Art. 349 by the roots of its quartic, [1/s]: the slowest of those that vanish with depth."""
    k = 2.0 * math.pi / length
    theta = nu * k**2 / math.sqrt(g * k)
    m = np.roots([1.0, 0.0, 2.0, -4.0, 1.0 + 1.0 / theta**2])
    return float((-theta * (m[m.real > 0.0] ** 2 - 1.0).real).min() * math.sqrt(g * k))


@pytest.mark.parametrize("nu", [1e-6, 1e-4, 4e-3, 2e-2, 0.1, 1.0, 10.0])
@pytest.mark.parametrize("mass", [0.01, 1.0, 100.0])
def test_the_time_in_which_a_wave_of_1_m_fades_is_lambs(nu: float, mass: float) -> None:
    g = 9.81 * mass ** (1.0 / 3.0)
    line = viscosity_line(params(viscosity=nu, planet_mass=mass), 0.0)
    assert duration(line) == pytest.approx(1.0 / decay_of(1.0, nu, g), rel=0.05)


def test_the_labs_length_is_stated_where_decay_is_weak_and_only_there() -> None:
    assert "length l = 150 mm" in viscosity_line(params(viscosity=1e-4), 6e-3)  # 60 s
    assert "l =" not in viscosity_line(params(viscosity=1.0), 60.0)
    assert viscosity_line(params(), 0.0) == "no decay"
    assert "reset" in viscosity_line(params(), 6e-3)


@pytest.mark.parametrize("length", [0.05, 0.2, 3.0, 30.0])
def test_the_low_pass_is_that_much_decay(length: float) -> None:
    line = low_pass_line(params(low_pass=length))
    water, oil = line.split(" in water, or ")
    # A wave of wavenumber 1/l is lowered by e^(-1/2).
    assert duration(water) == pytest.approx(0.5 / decay_of(2 * math.pi * length, 1e-6, 9.81), rel=0.06)
    assert duration(oil.split(" in heavy")[0]) == pytest.approx(
        0.5 / decay_of(2 * math.pi * length, 2e-2, 9.81), rel=0.06
    )


@pytest.mark.parametrize(("wind", "mass"), list(itertools.product([3.0, 8.0, 20.0], [0.01, 1.0, 100.0])))
def test_height_and_speed_in_a_storm_are_pierson_and_moskowitzs(wind: float, mass: float) -> None:
    g, p = 9.81 * mass ** (1.0 / 3.0), params(wind_speed=wind, planet_mass=mass)
    U = 1.026 * wind  # 19.5 m above the sea
    # c = g/omega_p, with the little that surface tension adds
    assert open_sea(p, wind, g) == pytest.approx((0.20925 * U**2 / g, U / 0.8772), rel=6e-3)
    assert open_sea(p, 2.0 * wind, g) == pytest.approx((0.20925 * 4 * U**2 / g, 2 * U / 0.8772), rel=6e-3)
    assert open_sea(p, wind, 9.81) == pytest.approx((0.20925 * U**2 / 9.81, U / 0.8772), rel=6e-3)


@pytest.mark.parametrize("wind", [3.0, 8.0, 15.0])
@pytest.mark.parametrize("mass", [1.0, 100.0])
def test_the_speed_of_a_fetch_limited_sea_is_hasselmann_s(wind: float, mass: float) -> None:
    g, p = 9.81 * mass ** (1.0 / 3.0), params(wind_speed=wind, planet_mass=mass, spectrum="jonswap")
    chi = min(g * 1e5 / wind**2, 1.704e4)
    speed = wind * chi ** (1.0 / 3.0) / 22.0
    assert open_sea(p, wind, g)[1] == pytest.approx(speed, rel=6e-3)


def test_shallow_water_is_said_to_break_the_waves() -> None:
    for depth, wind in itertools.product([0.5, 1.0, 3.0, 10.0], [5.0, 10.0, 20.0]):
        p = params(deep=False, depth=depth, wind_speed=wind)
        height = 0.20925 * (1.026 * wind) ** 2 / 9.81
        text = breaking_text(p)
        assert bool(text) == (height > 0.6 * depth)
        if text:
            assert numbers(text)[:2] == pytest.approx([height, height / depth], rel=6e-2)
    assert breaking_text(params()) == ""


def read(seconds: float = 4.0, **values: Any) -> Snapshot:
    scene = SquareSeaScene(params(size="64", mesh="32", **values))
    loop = Loop(scene)
    for step in range(int(seconds * 15)):
        loop.tick(step / 15)
    snapshot = loop.latest
    assert snapshot is not None
    return snapshot


def test_foam_is_claimed_for_the_sea_that_is_there() -> None:
    W = 3.84e-6 * 15.0**3.41
    earth = read(wind_speed=15.0, length=400.0)
    assert earth.readings.expected_foam_cover == pytest.approx(W, rel=1e-6)
    assert "by Monahan's law" in foam_text(earth.readings, 9.81)
    assert "measured on the Earth" in foam_text(earth.readings, 45.5)
    for damped in ({"low_pass": 10.0}, {"amplitude": 0.05}, {"viscosity": 1.0}):
        readings = read(wind_speed=15.0, length=400.0, **damped).readings
        assert readings.expected_foam_cover < 0.6 * W
        assert readings.expected_foam_cover == pytest.approx(W * readings.slope_left, rel=1e-9)
        assert "of slope left" in foam_text(readings, 9.81)


def test_a_sea_that_is_not_pressed_together_is_said_to_have_no_foam() -> None:
    readings = read(wind_speed=20.0, choppiness=0.0, seconds=0.5).readings
    assert readings.foam_cover == 0.0
    assert foam_text(readings, 9.81).startswith("No foam")
    assert foam_text(read(wind_speed=20.0, seconds=0.5).readings, 9.81).startswith("Foam covers")


def test_lines_under_controls_follow_the_spectrum() -> None:
    assert "8.21 m/s at 19.5 m" in wind_line(params())
    assert "19.5" not in wind_line(params(spectrum="jonswap"))
    grown = marks(read(spectrum="jonswap", wind_speed=7.0, seconds=0.2))
    assert "fully grown" in grown["fetch"]
    assert numbers(grown["size"]) == pytest.approx([params().length / 64.0, params().length / 32.0], rel=6e-3)
    assert numbers(grown["fetch"])[0] == pytest.approx(1.704e4 * 49.0 / 9.81, rel=6e-3)
    regular = read(spectrum="regular", wave_period=6.0, wave_height=1.0, seconds=0.2)
    assert numbers(marks(regular)["wave_period"])[1] == pytest.approx(6.2, abs=0.05)
    assert "fetch" not in marks(regular)
    fast = read(planet="by gravity", gravity=981.0, seconds=0.5, length=32.0)
    assert "not resolved in time" in str(readout(fast))
    assert "not resolved in time" not in str(readout(regular))


def test_the_band_of_heights_is_two_standard_deviations() -> None:
    r = read(1.0, length=400.0).readings.report
    height = r.theory.statistics.significant_height
    assert f"{height:.3g} ± {2.0 * r.theory.scatter * height:.2g}" in str(statistics_table(r))
    drawn = f"{r.measured.significant_height:.3g}"
    assert str(bold(drawn)) in str(statistics_table(r))
    high = r._replace(measured=r.measured._replace(significant_height=(1.0 + 3.0 * r.theory.scatter) * height))
    assert str(bold(drawn)) not in str(statistics_table(high))
    assert WARNING_COLOUR in str(statistics_table(high))


def test_the_height_over_the_earth_s_is_that_of_the_sea_as_drawn() -> None:
    scene = SquareSeaScene(SquareSeaParams(size="64", mesh="32", planet_mass=20.0))
    scene.frame()
    now = SimpleNamespace(readings=scene.readings(), frame=scene.frame())
    height = now.readings.report.measured.significant_height
    on_earth = open_sea(scene.params, scene.params.wind_speed, EARTH_GRAVITY).height
    assert quantities.read(QUANTITIES, "measured_over_earth", now) == pytest.approx(height / on_earth)
    level = SimpleNamespace(readings=now.readings._replace(report=None))
    assert math.isnan(quantities.read(QUANTITIES, "measured_over_earth", level))
