"""Files of buoys, instruments and wave models, each made here from the description of its format."""

import json
import math

import numpy as np
import pytest

from sim.ocean import read_spectrum
from sim.ocean.spectrum_files.wave_models import text_reader
from tests.refusals import assert_refused
from tests.sim.ocean.test_field_files import HEIGHT, F, S, seen

FROM, SPREAD = 300.0, 20.0  # [degrees] of all waves
BEARINGS = np.arange(0.0, 360.0, 10.0)


def spreading(bearings: np.ndarray, step: float = 10.0) -> np.ndarray:
    """D (m,) [1/degree] about FROM at bearings of a step [degrees], with a spread of about SPREAD."""
    D = np.abs(np.cos(np.radians(bearings - FROM) / 2.0)) ** 32
    return D / (D.sum() * step)


def assert_is_the_sea(spectrum, height: float = HEIGHT, bearing: float | None = FROM, rel: float = 3e-3) -> None:
    """Hs, Tp and the direction that waves come from."""
    found = seen(spectrum)
    assert found[0] == pytest.approx(height, rel=rel)
    assert found[1] == pytest.approx(10.0, rel=1e-2)
    assert found[2] == (None if bearing is None else pytest.approx(bearing, abs=0.5))


# --- read by this library alone ---


def test_a_file_of_datawell_is_read(tmp_path):
    """.spt: twelve lines, then frequency, density over the largest, direction, spread, skewness and kurtosis."""
    head = [
        "4",
        f"{100.0 * HEIGHT:.0f}",
        "7.1",
        f"{S.max():.6f}",
        "20.0",
        "12.5",
        "7",
        "0.0",
        "0.0",
        "0.0",
        "120.0",
        "65.1",
    ]
    rows = [f"{f:.3f},{s / S.max():.6E},{FROM:.1f},{SPREAD:.1f},0.10,2.80" for f, s in zip(F, S, strict=True)]
    path = tmp_path / "Perran}2020-01-01T00h30.spt"
    path.write_text("\n".join([*head, *rows]) + "\n", encoding="utf-8")
    spectrum = read_spectrum(path)
    assert_is_the_sea(spectrum)
    assert spectrum.name == "Perran}2020-01-01T00h30.spt, 2020-01-01 00:30"
    assert any("magnetic north" in note for note in spectrum.notes)
    head[3] = "0.0"
    path.write_text("\n".join([*head, *rows]) + "\n", encoding="utf-8")
    assert_refused("path", lambda: read_spectrum(path), "largest density")


def awac(name: str, time: str, values: np.ndarray, kind: str = "") -> str:
    """A line of NMEA of an AWAC."""
    numbers = ",".join(f"{value:.4f}" for value in values)
    return f"{name},{kind and kind + ','}010220,{time},3,{F[0]:.2f},0.01,{len(values)},{numbers}*0A\n"


def test_a_file_of_an_awac_is_read(tmp_path):
    """Densities in cm2/Hz at all frequencies, coefficients of directions at fewer, and -9 if missing."""
    n, angle = 20, math.radians(FROM)
    r1, r2 = 0.94, 0.78
    parts = {"A1": r1 * math.cos(angle), "B1": r1 * math.sin(angle), "A2": r2 * math.cos(2 * angle),
             "B2": r2 * math.sin(2 * angle)}  # fmt: skip
    text = ""
    for time, factor in (("050000", 1.0), ("060000", 0.25)):
        for kind, value in parts.items():
            text += awac("$PNORF", time, np.where(np.arange(n) < 15, value, -9.0), kind)
        text += awac("$PNORE", time, 1e4 * factor * S) + f"$PNORW,010220,{time},3,4,1.5,1.4*00\n"
    path = tmp_path / "awac.txt"
    path.write_text(text, encoding="utf-8")
    assert_is_the_sea(read_spectrum(path, "2020-01-02 05:10"))
    last = read_spectrum(path)
    assert_is_the_sea(last, 0.5 * HEIGHT)
    assert last.name == "awac.txt, 2020-01-02 06:00"
    path.write_text("".join(line for line in text.splitlines(True) if not line.startswith("$PNORF,B2")), "utf-8")
    assert_is_the_sea(read_spectrum(path), 0.5 * HEIGHT, None)
    path.write_text(text.replace("0.01,37", "0.01,38"), encoding="utf-8")
    assert_refused("path", lambda: read_spectrum(path), "as many values")


# --- read with xarray and wavespectra ---


@pytest.fixture
def xarray():
    pytest.importorskip("netCDF4")
    pytest.importorskip("wavespectra")
    return pytest.importorskip("xarray")


TIMES = np.array(["2020-01-01T00:00", "2020-01-01T06:00"], "datetime64[ns]")


def spotter_rows() -> tuple[list[str], list[list[float]]]:
    """Names and values of a row of a Spotter for each of two times, the second with a quarter of the energy."""
    still = 0.0 * F
    columns = {"f": F, "df": still + 0.01, "a1": still, "b1": still, "a2": still, "b2": still, "varianceDensity": S,
               "direction": still + FROM, "directionalSpread": still + SPREAD}  # fmt: skip
    names, rows = [], [[], []]
    for name, values in columns.items():
        names += [f"{name}_{i}" for i in range(len(F))]
        for row, factor in zip(rows, (1.0, 0.25), strict=True):
            row.extend(np.round(values * (factor if name == "varianceDensity" else 1.0), 8).tolist())
    return names, rows


def test_files_of_a_spotter_are_read(tmp_path, xarray):
    names, rows = spotter_rows()
    bulk = ["Battery Voltage (V)", "Epoch Time", "Significant Wave Height (m)", "Latitude (deg)", "Longitude (deg)"]
    lines = [",".join([*bulk, *names])]
    for epoch, row in zip((1577836800, 1577858400), rows, strict=True):
        lines.append(",".join(map(str, [4.1, epoch, 1.5, 50.0, -5.0, *row])))
    path = tmp_path / "spotter.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    data = {"waves": [], "frequencyData": []}
    for time, row in zip(("2020-01-01T00:00:00.000Z", "2020-01-01T06:00:00.000Z"), rows, strict=True):
        place = {"latitude": 50.0, "longitude": -5.0, "timestamp": time}
        data["waves"].append({"significantWaveHeight": 1.5, **place})
        arrays = {
            name: row[i * len(F) : (i + 1) * len(F)]
            for i, name in enumerate(
                ("frequency", "df", "a1", "b1", "a2", "b2", "varianceDensity", "direction", "directionalSpread")
            )
        }
        data["frequencyData"].append({**arrays, **place})
    other = tmp_path / "spotter.json"
    other.write_text(json.dumps({"data": {"spotterId": "SPOT-1", **data}}), encoding="utf-8")
    for one in (path, other):
        assert_is_the_sea(read_spectrum(one, "2020-01-01"))
        assert_is_the_sea(read_spectrum(one), 0.5 * HEIGHT)


@pytest.mark.parametrize("directional", [True, False])
def test_netcdf_of_ndbc_is_read_with_the_spreading_of_its_moments(tmp_path, xarray, directional):
    axes = {"time": TIMES, "frequency": F, "latitude": [50.0], "longitude": [-5.0]}

    def of(values, factors=(1.0, 1.0)):
        return tuple(axes), np.stack([factor * values for factor in factors])[:, :, None, None]

    data = {"spectral_wave_density": of(S, (1.0, 4.0))}
    data["spectral_wave_density"][1][:, -2:] = np.nan
    if directional:
        data |= {"mean_wave_dir": of(0 * F + FROM), "principal_wave_dir": of(0 * F + FROM),
                 "wave_spectrum_r1": of(0 * F + 0.94), "wave_spectrum_r2": of(0 * F + 0.78)}  # fmt: skip
    path = tmp_path / "44013w2020.nc"
    xarray.Dataset(data, axes).to_netcdf(path)
    bearing = FROM if directional else None
    assert_is_the_sea(read_spectrum(path, "2020-01-01"), HEIGHT, bearing)
    last = read_spectrum(path)
    assert_is_the_sea(last, 2.0 * HEIGHT, bearing)
    assert f"left out, as they have no value: 2 of {len(F)} frequencies" in last.notes
    data["spectral_wave_density"][1][1] = np.nan
    xarray.Dataset(data, axes).to_netcdf(path)
    assert read_spectrum(path).name == "44013w2020.nc, 2020-01-01 00:00"  # the last one with values


def test_netcdf_of_era5_is_read_at_the_first_place_with_waves(tmp_path, xarray):
    """d2fd is log10 of m2 s/rad; directions go to 7.5, 22.5 ... degrees; places on land have no values."""
    f = 0.03453 * 1.1 ** np.arange(30)
    density = 4.0 * np.exp(-(((f - 0.1) / 0.02) ** 2))
    to = 7.5 + 15.0 * np.arange(24)
    D = spreading((to + 180.0) % 360.0, 15.0)
    with np.errstate(divide="ignore"):
        d2fd = np.log10(density[:, None] * D * 180.0 / math.pi)
    d2fd[~np.isfinite(d2fd) | (d2fd < -10)] = np.nan
    values = np.full((2, 30, 24, 1, 2), np.nan)
    values[:, :, :, 0, 1] = d2fd
    axes = {
        "time": TIMES,
        "frequency": np.arange(1, 31),
        "direction": np.arange(1, 25),
        "latitude": [50.0],
        "longitude": [0.0, 0.5],
    }
    path = tmp_path / "era5.nc"
    xarray.Dataset({"d2fd": (tuple(axes), values)}, axes).to_netcdf(path)
    spectrum = read_spectrum(path)
    height = 4.0 * math.sqrt((0.5 * (density[1:] + density[:-1]) * np.diff(f)).sum())
    assert seen(spectrum)[0] == pytest.approx(height, rel=3e-3)
    assert seen(spectrum)[2] == pytest.approx(FROM, abs=0.5)
    assert "place 2 of 2" in spectrum.notes
    assert_refused("place", lambda: read_spectrum(path, place=1), "with data")


def test_netcdf_of_wwm_is_read(tmp_path, xarray):
    """Action density over angular frequency and angle."""
    sigma = 2.0 * math.pi * F
    E = S[:, None] / (2.0 * math.pi) * spreading(BEARINGS) * 180.0 / math.pi  # [m2 s/rad2]
    action = np.stack([E / sigma[:, None]])[:, None]
    data = {"AC": (("ocean_time", "nbstation", "nfreq", "ndir"), action), "SPSIG": (("nfreq",), sigma),
            "SPDIR": (("ndir",), np.radians(BEARINGS)), "lon": (("nbstation",), [0.0]), "lat": (("nbstation",), [50.0]),
            "DEP": (("ocean_time", "nbstation"), [[30.0]])}  # fmt: skip
    path = tmp_path / "wwm.nc"
    xarray.Dataset(data, {"ocean_time": TIMES[:1]}).to_netcdf(path)
    assert_is_the_sea(read_spectrum(path))


def test_a_file_of_funwave_is_read(tmp_path, xarray):
    """Numbers of frequencies and directions, the peak period, both axes, then amplitudes; directions go to, from +x."""
    to = np.arange(-90.0, 91.0, 10.0)
    E = S[:, None] * spreading((270.0 - to) % 360.0)
    amplitude = np.sqrt(2.0 * E * 0.01 * 10.0)  # of each wave
    lines = [f"{len(F)} {len(to)} - NumFreq NumDir", "10.0 - PeakPeriod", *(f"{f:.4f} - Freq" for f in F),
             *(f"{d:.1f} - Dire" for d in to), *(" ".join(f"{a:.6f}" for a in row) for row in amplitude.T)]  # fmt: skip
    path = tmp_path / "wave.txt"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    assert_is_the_sea(read_spectrum(path), rel=5e-3)


@pytest.mark.parametrize("directional", [True, False])
def test_a_file_of_triaxys_is_read(tmp_path, xarray, directional):
    head = ["TRIAXYS BUOY DATA REPORT", "VERSION\t= 6a.02.08", "TYPE = DIRECTIONAL SPECTRUM" if directional else
            "TYPE = NON-DIRECTIONAL SPECTRUM", "DATE = 2020 Jan 01 06:00 (UTC)", f"NUMBER OF FREQUENCIES = {len(F)}",
            f"INITIAL FREQUENCY (Hz) = {F[0]:.3f}", "FREQUENCY SPACING (Hz) = 0.010",
            "RESOLVABLE FREQUENCY RANGE (Hz) = 0.040 TO 0.400"]  # fmt: skip
    if directional:
        closed = np.append(BEARINGS, 360.0)
        E = S[:, None] * np.append(spreading(BEARINGS), spreading(BEARINGS)[0])
        head += [
            "DIRECTION SPACING (DEG) = 10.0",
            f"ROWS ARE {len(F)} FREQUENCIES, COLUMNS ARE {len(closed)} DIRECTIONS",
        ]
        rows = [" ".join(f"{x:.8f}" for x in row) for row in E]
    else:
        head += ["COLUMN 2 = SPECTRAL DENSITY (M^2/Hz)"]
        rows = [f"{f:.3f} {s:.8f}" for f, s in zip(F, S, strict=True)]
    path = tmp_path / "triaxys.txt"
    path.write_text("\n".join([*head, *rows]) + "\n", encoding="utf-8")
    spectrum = read_spectrum(path)
    assert_is_the_sea(spectrum, HEIGHT, FROM if directional else None)
    assert any("magnetic north" in note for note in spectrum.notes)


def test_a_file_of_octopus_is_read(tmp_path, xarray):
    """Energies of bins behind each direction, under a row of frequencies, with their sums."""
    f = 0.04 * 1.08 ** np.arange(30)
    density = 4.0 * np.exp(-(((f - 0.1) / 0.02) ** 2))
    edges = np.gradient(f)
    energy = (density * edges)[:, None] * spreading(BEARINGS) * 10.0
    lines = [
        "Forecast valid for 01-Jan-2020", f"nfreqs,{len(f)}", f"ndir,{len(BEARINGS)}", "nrecs,1", "Latitude,50.0",
        "Longitude,-5.0", "Depth,100.0", "", "CCYYMM,DDHHmm,LPoint,WD,WS,ETot,TZ,VMD,ETotSe,TZSe,VMDSe,ETotSw,TZSw",
        "202001,'010600,spec_000,-999,-999,0.1,7.0,300.0,0.1,7.0,300.0,0.1,7.0",
        "freq," + ",".join(f"{x:.7f}" for x in f) + ",anspec",
    ]  # fmt: skip
    lines += [",".join([f"{d:.0f}", *(f"{x:.7f}" for x in energy[:, i]), f"{energy[:, i].sum():.7f}", ""])
              for i, d in enumerate(BEARINGS)]  # fmt: skip
    lines += ["fSpec," + ",".join(f"{x:.7f}" for x in density * edges), "den," + ",".join(f"{x:.7f}" for x in density)]
    path = tmp_path / "octopus.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    height = 4.0 * math.sqrt((0.5 * (density[1:] + density[:-1]) * np.diff(f)).sum())
    found = seen(read_spectrum(path))
    assert found[0] == pytest.approx(height, rel=0.02)
    assert found[2] == pytest.approx(FROM, abs=0.5)


def test_a_table_is_no_file_of_these(tmp_path):
    for text in ("f,S\n0.1,1\n", "# nfreq\n0.1 1\n", "", "{}", "37 19\n0.1 1\n"):
        assert text_reader(text) == ""
