"""Measured spectra and records: height, period and directions in the seas, and the formats of files."""

import gzip
import math
from pathlib import Path

import numpy as np
import pytest

from sim.ocean import RadialSea, Sea, draw_waves, measured_spectrum, read_spectrum, recorded_waves
from sim.ocean.records.measured import spread_by_mean, spread_by_moments
from sim.ocean.spectra.record import Conditions
from sim.ocean.spectrum_files.wave_models import refused
from sim.ocean.statistics.statistics import expected, theory
from tests.refusals import assert_refused

FREQUENCY = np.concatenate(
    [np.arange(0.03, 0.098, 0.005), np.arange(0.1, 0.49, 0.01)]
)  # [Hz] as a buoy of NDBC has them
CIRCLE = np.radians(np.arange(0.0, 360.0, 5.0))


def density(f: np.ndarray) -> np.ndarray:
    """A swell of 11 s and a wind sea of 5 s [m2/Hz]."""
    swell, wind = 6.0 * np.exp(-(((f - 1 / 11) / 0.012) ** 2)), 0.8 * np.exp(-(((f - 0.2) / 0.05) ** 2))
    return swell + wind


def height(f: np.ndarray, S: np.ndarray) -> float:
    """Hs [m] by trapezoids."""
    return 4.0 * math.sqrt((0.5 * (S[1:] + S[:-1]) * np.diff(f)).sum())


def alpha(f: np.ndarray) -> np.ndarray:
    """Mean direction that waves come from [degrees from north]: swell from the south-west, wind sea from the north."""
    return np.where(f < 0.14, 225.0, 10.0)


def assert_is_the_file(sea_height: float, sea_period: float, S: np.ndarray = density(FREQUENCY)) -> None:  # noqa: B008
    """Hs within 0.5 % and Tp within 2 % of the file's."""
    assert sea_height == pytest.approx(height(FREQUENCY, S), rel=5e-3)
    assert sea_period == pytest.approx(1.0 / FREQUENCY[S.argmax()], rel=0.02)


def test_the_square_sea_has_height_and_period_of_a_measured_spectrum():
    spectrum = measured_spectrum(FREQUENCY, density(FREQUENCY))
    sea = Sea(256, 1500.0, spectrum, wind_direction=0.4, spreading="cos2s", spread_exponent=12.0)
    found = expected(sea)
    assert_is_the_file(found.significant_height, found.peak_period)
    assert found.direction == pytest.approx(0.4, abs=0.02)
    moments = spectrum.moments()
    assert_is_the_file(moments.significant_height, moments.peak_period)
    # what lies outside the file is not there
    assert (spectrum.frequency_density([0.1, 2 * math.pi * 0.485]) == 0.0).all()
    sea.change(10.0, spectrum="sea_state", hs=1.0)
    assert sea.significant_height_at(1e9) == pytest.approx(1.0, rel=0.05)


def test_the_sum_of_waves_has_height_and_directions_of_a_measured_spectrum():
    D = spread_by_mean(CIRCLE, np.full(len(FREQUENCY), -2.0), np.full(len(FREQUENCY), 0.9))
    spectrum = measured_spectrum(FREQUENCY, density(FREQUENCY)[:, None] * D, CIRCLE)
    waves = draw_waves(spectrum, spectrum.conditions(depth=30.0), 400)
    assert waves.significant_height == pytest.approx(height(FREQUENCY, density(FREQUENCY)), rel=5e-3)
    first = np.mean(np.exp(1j * np.arctan2(waves.ky, waves.kx)))
    assert first == pytest.approx(0.9 * np.exp(-2j), abs=0.02)
    sea = RadialSea(draw_waves(spectrum, spectrum.conditions(), 400))
    assert sea.significant_height == pytest.approx(waves.significant_height, rel=1e-3)


@pytest.mark.parametrize("depth", [math.inf, 12.0])
def test_a_directional_spectrum_has_its_energy_at_any_depth_and_any_spacing_of_directions(depth):
    uneven = np.radians([10.0, 40.0, 55.0, 60.0, 90.0, 130.0, 200.0, 290.0])
    S = density(FREQUENCY)[:, None] * np.exp(np.cos(uneven - 1.0) * 4.0)
    spectrum = measured_spectrum(FREQUENCY, S, uneven)
    around = np.append(uneven, uneven[0] + 2 * math.pi)
    along = 0.5 * (np.diff(around) * (S + np.roll(S, -1, axis=1))).sum(axis=1)
    c = spectrum.conditions(depth=depth)
    assert theory(spectrum, c, 20.0).significant_height == pytest.approx(height(FREQUENCY, along), rel=2e-3)
    assert spectrum.frequency_density([0.6], c) == pytest.approx(
        np.interp(0.6 / 2 / math.pi, FREQUENCY, along) / 2 / math.pi
    )


def test_the_spreading_of_greatest_entropy_has_the_four_moments_of_the_buoy():
    first, second = np.array([0.3, 0.8, 0.95]), np.array([0.2, 0.5, 0.84])
    mean, other = np.array([1.0, -2.0, 3.0]), np.array([1.4, -1.9, 3.02])
    fine = np.radians(np.arange(360.0))
    D = spread_by_moments(fine, mean, first, other, second)
    assert (D > 0.0).all()
    assert D.sum(axis=1) * fine[1] == pytest.approx(1.0)
    assert (D * np.exp(1j * fine)).sum(axis=1) * fine[1] == pytest.approx(first * np.exp(1j * mean), abs=1e-5)
    assert (D * np.exp(2j * fine)).sum(axis=1) * fine[1] == pytest.approx(second * np.exp(2j * other), abs=1e-5)
    # moments that no spreading has
    impossible = spread_by_moments(CIRCLE, mean, np.full(3, 0.9), mean + 1.5, np.full(3, 0.95))
    assert np.isfinite(impossible).all()
    assert (impossible >= 0.0).all()


# --- files ---


def realtime(values: np.ndarray, name: str, first: str = "") -> str:
    """Text of a file of the last days: value and frequency in turn, the newest first."""
    row = " ".join(f"{value:.3f} ({f:.3f})" for value, f in zip(values, FREQUENCY, strict=True))
    old = " ".join(f"{0.5 * value:.3f} ({f:.3f})" for value, f in zip(values, FREQUENCY, strict=True))
    head = f"#YY  MM DD hh mm {first and 'Sep_Freq  < '}{name}_1 (freq_1) {name}_2 (freq_2) ... >\n"
    return f"{head}2024 02 01 05 40 {first}{row}\n2024 02 01 04 40 {first}{old}\n"


def history(values: np.ndarray, form: str = "%.2f") -> str:
    """Text of a file of a past year: a line of frequencies, then values."""
    head = "#YY  MM DD hh mm  " + "  ".join(f"{f:.4f}".lstrip("0") for f in FREQUENCY)
    rows = [" ".join(form % value for value in one * values) for one in (1.0, 0.5)]
    missing = " ".join(["999.0"] * len(FREQUENCY))
    return f"{head}\n2019 12 31 23 40 {rows[0]}\n2020 01 01 00 40 {rows[1]}\n2020 01 01 01 40 {missing}\n"


def write_directions(folder: Path, names: dict[str, str], text, r_scale: float = 1.0) -> None:
    """The four files beside that of the density."""
    r1, r2 = np.full(len(FREQUENCY), 0.9), np.full(len(FREQUENCY), 0.7)
    for kind, values in {
        "alpha1": alpha(FREQUENCY), "alpha2": alpha(FREQUENCY) + 3.0, "r1": r_scale * r1, "r2": r_scale * r2,
    }.items():  # fmt: skip
        (folder / names[kind]).write_text(text(values, kind), encoding="utf-8")


def assert_comes_from_both(spectrum, factor: float = 1.0) -> None:
    """Its swell goes to the north-east, its wind sea to the south; Hs and r1 are those of the files."""
    assert spectrum.moments().significant_height == pytest.approx(
        math.sqrt(factor) * height(FREQUENCY, density(FREQUENCY)), rel=5e-3
    )
    theta = np.linspace(0.0, 2.0 * math.pi, 720, endpoint=False)
    c = spectrum.conditions()
    for f, degrees in ((0.09, 225.0), (0.2, 10.0)):
        k = (2.0 * math.pi * f) ** 2 / 9.81
        S = spectrum(k * np.cos(theta), k * np.sin(theta), c)
        first = (S * np.exp(1j * theta)).sum() / S.sum()
        x, y = math.sin(math.radians(degrees + 180.0)), math.cos(math.radians(degrees + 180.0))  # east, north
        assert first == pytest.approx(0.9 * complex(x, y), abs=0.01)


def test_files_of_the_last_days_of_a_buoy_are_read(tmp_path):
    path = tmp_path / "44013.data_spec"
    path.write_text(realtime(density(FREQUENCY), "spec", "0.140 "), encoding="utf-8")
    alone = read_spectrum(path)
    assert alone.name == "44013.data_spec, 2024-02-01 05:40"
    assert alone.title == alone.name
    assert alone.uses("spreading")
    assert alone.moments().significant_height == pytest.approx(height(FREQUENCY, density(FREQUENCY)), rel=5e-3)
    names = {"alpha1": "44013.swdir", "alpha2": "44013.swdir2", "r1": "44013.swr1", "r2": "44013.swr2"}
    write_directions(
        tmp_path, names, lambda values, kind: realtime(values, kind).replace("0.450", "0.900").replace("0.350", "0.700")
    )
    both = read_spectrum(path)
    assert not both.uses("spreading")
    assert_comes_from_both(both)
    for name in ("44013.swdir2", "44013.swr2"):  # without the second moments
        (tmp_path / name).unlink()
    assert_comes_from_both(read_spectrum(path))
    (tmp_path / "44013.swr1").unlink()
    assert read_spectrum(path).uses("spreading")
    assert "alpha1 and of r1" in read_spectrum(path).notes[-1]
    assert_refused("path", lambda: read_spectrum(tmp_path / "44013.swdir"), "alpha1")
    (tmp_path / "44013.swr1").write_text("", encoding="utf-8")
    assert_refused("path", lambda: read_spectrum(path), "a file with at least one record")


def test_files_of_a_past_year_of_a_buoy_are_read(tmp_path):
    """Also packed by gzip, with r1 and r2 in percents, and by time; a record without values is passed over."""
    (tmp_path / "44013w2019.txt.gz").write_bytes(gzip.compress(history(density(FREQUENCY), "%.4f").encode()))
    names = {
        kind: f"44013{letter}2019.txt.gz" for kind, letter in zip(("alpha1", "alpha2", "r1", "r2"), "dijk", strict=True)
    }
    write_directions(
        tmp_path,
        names,
        lambda values, kind: (
            history(values) if "r" in kind else history(values).replace("\n2020 01 01 00", "\n2020 01 01 02")
        ),
        100.0,
    )
    spectrum = read_spectrum(tmp_path / "44013w2019.txt.gz", "2019-12-31T23:00")
    assert spectrum.name == "44013w2019.txt.gz, 2019-12-31 23:40"
    assert_comes_from_both(spectrum)
    alone = read_spectrum(tmp_path / "44013w2019.txt.gz")
    assert alone.name.endswith("2020-01-01 00:40")
    assert "at the same time" in alone.notes[-1]
    late = lambda: read_spectrum(tmp_path / "44013w2019.txt.gz", "2020-06-01 00:00")  # noqa: E731
    assert_refused("time", late, "2019-12-31 23:40 to 2020-01-01 00:40")
    old = "YY MM DD hh .05 .06 .07\n98 07 01 05 1.0 2.0 1.0\n"
    (tmp_path / "old.txt").write_text(old, encoding="utf-8")
    assert read_spectrum(tmp_path / "old.txt").name == "old.txt, 1998-07-01 05:00"


def test_a_summary_becomes_swell_and_wind_sea(tmp_path):
    path = tmp_path / "44013.spec"
    path.write_text(
        "#YY  MM DD hh mm WVHT  SwH  SwP  WWH  WWP SwD WWD  STEEPNESS  APD MWD\n"
        "#yr  mo dy hr mn    m    m  sec    m  sec  -  degT     -      sec degT\n"
        "2024 02 01 05 40  2.2  2.0 11.0  0.9  5.0 SW N  AVERAGE  6.2 226\n"
        "2024 02 01 04 40  1.0   MM   MM  1.0  4.0  MM   E    STEEP  4.6 137\n",
        encoding="utf-8",
    )
    spectrum = read_spectrum(path)
    assert spectrum.moments().significant_height == pytest.approx(math.hypot(2.0, 0.9), rel=5e-3)
    assert spectrum.moments().peak_period == pytest.approx(11.0, rel=0.01)
    east = read_spectrum(path, "2024-02-01 04:40")
    assert theory(east, east.conditions(), 20.0).direction == pytest.approx(math.pi)
    assert east.moments().significant_height == pytest.approx(1.0, rel=5e-3)


TABLES = {
    "names": lambda f, S: "Frequency [Hz],Density (m2/Hz)\n" + "".join(f"{a},{b}\n" for a, b in zip(f, S, strict=True)),
    "numbers": lambda f, S: "# of a buoy\n" + "".join(f"{a} {b}\n" for a, b in zip(f[::-1], S[::-1], strict=True)),
    "decimal commas": lambda f, S: (
        "f;S;note\n" + "".join(f"{a};{b};x\n".replace(".", ",") for a, b in zip(f, S, strict=True))
    ),
    "omega": lambda f, S: (
        "omega\tS\n" + "".join(f"{2 * math.pi * a}\t{b / 2 / math.pi}\n" for a, b in zip(f, S, strict=True))
    ),
}


@pytest.mark.parametrize("form", TABLES)
def test_a_table_of_frequencies_is_read(tmp_path, form):
    path = tmp_path / "sea.csv"
    path.write_text(TABLES[form](FREQUENCY, density(FREQUENCY)), encoding="utf-8-sig")
    spectrum = read_spectrum(path)
    assert spectrum.significant_height(spectrum.conditions()) == pytest.approx(height(FREQUENCY, density(FREQUENCY)))
    assert_refused("time", lambda: read_spectrum(path, "2020-01-01"), "table of one")


def test_tables_with_directions_are_read(tmp_path):
    spread = math.degrees(math.sqrt(2.0 - 2.0 * 0.9))
    for name, value in (("spread", spread), ("r1", 0.9)):
        rows = zip(FREQUENCY, density(FREQUENCY), alpha(FREQUENCY), strict=True)
        text = f"f,S,dir,{name}\n" + "".join(f"{a},{b},{c},{value}\n" for a, b, c in rows)
        (tmp_path / "sea.csv").write_text(text, encoding="utf-8")
        assert_comes_from_both(read_spectrum(tmp_path / "sea.csv"))
    degrees = np.arange(0.0, 360.0, 10.0)
    D = spread_by_mean(np.radians(degrees), np.radians(alpha(FREQUENCY)), np.full(len(FREQUENCY), 0.9))
    rows = np.column_stack([FREQUENCY, density(FREQUENCY)[:, None] * D * math.pi / 180.0])
    text = "f," + ",".join(f"{d:g}" for d in degrees) + "\n" + "".join(",".join(map(str, row)) + "\n" for row in rows)
    (tmp_path / "both.csv").write_text(text, encoding="utf-8")
    assert_comes_from_both(read_spectrum(tmp_path / "both.csv"))


def test_the_error_of_a_reader_is_told_in_one_line(tmp_path):
    for error, told in (
        (KeyError("efth"), "('efth')"),
        (ValueError("no  such\tvariable\nin a file"), "(no such variable)"),
        (RuntimeError(), "(RuntimeError)"),
        (OSError("x" * 500), f"({'x' * 120})"),
    ):
        assert str(refused(tmp_path / "a.nc", error)).endswith(told)


def test_files_of_wave_models_are_read(tmp_path):
    pytest.importorskip("wavespectra")
    xarray = pytest.importorskip("xarray")
    degrees = np.arange(0.0, 360.0, 10.0)
    D = spread_by_mean(np.radians(degrees), np.radians(alpha(FREQUENCY)), np.full(len(FREQUENCY), 0.9))
    E = density(FREQUENCY)[:, None] * D * math.pi / 180.0
    times = np.array(["2020-01-01T00:00", "2020-01-01T03:00"], "datetime64[ns]")
    axes = {"time": times, "site": [1], "freq": FREQUENCY, "dir": degrees}
    data = xarray.DataArray(np.stack([E, 2.0 * E])[:, None], axes, tuple(axes), name="efth").to_dataset()
    data["lon"], data["lat"] = ("site", [10.0]), ("site", [50.0])
    data.spec.to_swan(tmp_path / "swan.spc")
    data.spec.to_netcdf(tmp_path / "own.nc")
    data.spec.to_ww3(tmp_path / "ww3.nc")
    for name in ("swan.spc", "own.nc", "ww3.nc"):
        spectrum = read_spectrum(tmp_path / name)
        assert spectrum.name == f"{name}, 2020-01-01 03:00"
        assert_comes_from_both(spectrum, 2.0)
        assert_comes_from_both(read_spectrum(tmp_path / name, "2020-01-01 00:00"))


# --- records ---


@pytest.fixture(scope="module")
def record() -> tuple[np.ndarray, np.ndarray]:
    """20 minutes of a sea that does not repeat in this time, sampled at 2 Hz [s, m]."""
    spectrum = measured_spectrum(FREQUENCY, density(FREQUENCY))
    waves = draw_waves(spectrum, spectrum.conditions(), 300, seed=5)
    t = 100.0 + 0.5 * np.arange(2400)
    theta = waves.phase - np.sqrt(9.81 * waves.k) * t[:, None]
    return t, 0.3 + (waves.amplitude * np.cos(theta)).sum(axis=1)


def test_a_record_passes_its_place_as_it_was_recorded(record):
    t, eta = record
    place = (30.0, -20.0)
    waves = recorded_waves(t, eta, 0.7, place)
    sea = RadialSea(waves, choppiness=0.0)
    wanted, significant = eta - eta.mean(), 4.0 * eta.std()
    found = np.array([sea.at([place], time).height[0] for time in t[::8]])
    assert np.sqrt(np.mean((found - wanted[::8]) ** 2)) < 0.01 * significant
    assert np.arctan2(waves.ky, waves.kx) == pytest.approx(0.7)
    assert waves.significant_height == pytest.approx(significant, rel=1e-3)
    # along a crest it is the same
    across = (place[0] - 50.0 * math.sin(0.7), place[1] + 50.0 * math.cos(0.7))
    assert sea.at([across], 300.0).height[0] == pytest.approx(sea.at([place], 300.0).height[0], abs=1e-6)


def test_a_record_on_water_of_a_depth_passes_as_recorded(record):
    t, eta = record
    conditions = Conditions(depth=15.0)
    waves = recorded_waves(t, eta, -1.0, (5.0, 0.0), conditions, error=0.001)
    theta = waves.phase + 5.0 * waves.kx - waves.omega * t[::7, None]
    found = (waves.amplitude * np.cos(theta)).sum(axis=1)
    assert np.sqrt(np.mean((found - eta[::7] + eta.mean()) ** 2)) < 0.002 * 4.0 * eta.std()


def test_short_waves_that_surface_tension_speeds_pass_as_recorded():
    """At 5 Hz they are a tenth longer than without it; half a minute later the phase is still right."""
    t = np.arange(0.0, 40.0, 0.04)
    eta = 0.01 * np.cos(2.0 * math.pi * 5.0 * t)
    waves = recorded_waves(t, eta)
    assert waves.k[0] < 0.98 * (10.0 * math.pi) ** 2 / 9.81
    sea = RadialSea(waves, choppiness=0.0)
    found = [sea.at([[0.0, 0.0]], one).height[0] for one in t[800:830]]
    assert found == pytest.approx(eta[800:830], abs=1e-5)


def test_the_shortest_wave_of_a_record_has_its_amplitude():
    """Two samples a wave, of an even number and of an odd one."""
    up_and_down = 0.5 * (-1.0) ** np.arange(16)
    waves = recorded_waves(np.arange(16.0), up_and_down)
    assert waves.amplitude == pytest.approx([0.5])
    t = np.arange(15.0)
    assert recorded_waves(t, np.cos(2.0 * math.pi * 7.0 / 15.0 * t)).amplitude == pytest.approx([1.0])


T = np.arange(0.0, 30.0, 0.5)
REFUSED = [
    ("frequency", lambda: measured_spectrum([0.1, 0.2], [1.0, 1.0]), "at least three"),
    ("frequency", lambda: measured_spectrum([0.1, 0.3, 0.2], [1.0, 1.0, 1.0]), "rising"),
    ("frequency", lambda: measured_spectrum([0.0, 0.1, 0.2], [1.0, 1.0, 1.0]), "0.0001"),
    ("density", lambda: measured_spectrum([0.1, 0.2, 0.3], [1.0, 1.0]), "(3,)"),
    ("density", lambda: measured_spectrum([0.1, 0.2, 0.3], [1.0, -1.0, 0.0]), "-1.0"),
    ("density", lambda: measured_spectrum([0.1, 0.2, 0.3], [1.0, math.nan, 0.0]), "nan"),
    ("density", lambda: measured_spectrum([0.1, 0.2, 0.3], [0.0, 0.0, 0.0]), "some above 0"),
    ("density", lambda: measured_spectrum([0.1, 0.2, 0.3], np.ones((4, 3)), np.arange(4.0)), "(3, 4)"),
    ("direction", lambda: measured_spectrum([0.1, 0.2, 0.3], np.ones((3, 4)), [0.0, 1.0, 2.0, 2 * math.pi]), "once"),
    ("t", lambda: recorded_waves([0.0, 1.0, 3.0, *range(4, 12)], np.ones(11)), "equally spaced"),
    ("t", lambda: recorded_waves(T[:4], T[:4]), "at least 8"),
    ("height", lambda: recorded_waves(T, T[:-1]), "one for each"),
    ("height", lambda: recorded_waves(T, np.where(T == 3.0, math.nan, T)), "finite"),
    ("height", lambda: recorded_waves(T, np.ones(len(T))), "a record with waves"),
    ("height", lambda: recorded_waves(T / 100.0, np.sin(T * 7.0)), "10 Hz"),
    ("water", lambda: recorded_waves(T, np.sin(T), water=20.0), "FluidColumn"),  # type: ignore[arg-type]
]


@pytest.mark.parametrize(("name", "call", "words"), REFUSED)
def test_arrays_that_are_no_spectrum_or_record_are_refused(name, call, words):
    assert_refused(name, call, words)
