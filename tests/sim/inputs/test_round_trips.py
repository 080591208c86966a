"""Whatever is written is read again: by this project, by pandas, xarray, MoorDyn and wavespectra."""

import csv
import io
import json
from pathlib import Path

import numpy as np
import pytest

from app.commands.run import write_arrays
from app.scenes import scene_named
from app.scenes.setups import described, read_file, read_setup_text, write_file
from sim.mooring import read_moordyn, write_moordyn
from sim.ocean import read_record, read_spectrum
from sim.tables import split_rows
from tests.sim.mooring.moordyn.altered import BASES, by_moordyn

F = np.arange(0.04, 0.405, 0.01)
S = 4.0 * np.exp(-(((F - 0.1) / 0.02) ** 2)) + 0.1
T = 0.5 * np.arange(400)
ETA = np.round(np.sin(0.8 * T) + 0.3 * np.sin(1.3 * T), 6)
HEADS = {"spectrum": ("frequency (Hz)", "density (m2/Hz)"), "record": ("time (s)", "eta (m)")}
COUNTRIES = {"de": (";", ","), "sv": (";", ","), "en": (",", ".")}  # marks and decimal signs of LibreOffice's CSV


def values_of(kind: str, path: Path) -> tuple[np.ndarray, np.ndarray]:
    """The two columns of a file, by this project's readers."""
    if kind == "record":
        record = read_record(path)
        return record.t, record.height
    spectrum = read_spectrum(path)
    return F, 2.0 * np.pi * spectrum.frequency_density(2.0 * np.pi * F)


@pytest.mark.parametrize("kind", HEADS)
@pytest.mark.parametrize("mark", ["", "\ufeff"])
@pytest.mark.parametrize("separator_line", [False, True])
@pytest.mark.parametrize("country", COUNTRIES)
def test_the_csv_of_each_country_is_read(kind, country, separator_line, mark, tmp_path):
    separator, decimal = COUNTRIES[country]
    rows = zip(*{"spectrum": (F, S), "record": (T, ETA)}[kind], strict=True)
    lines = [
        separator.join(HEADS[kind]),
        *(separator.join(f"{x:.6f}".replace(".", decimal) for x in row) for row in rows),
    ]
    if separator_line:
        lines.insert(0, f"sep={separator}")
    path = tmp_path / "table.csv"
    path.write_bytes((mark + "\r\n".join(lines) + "\r\n").encode("utf-8"))
    x, y = values_of(kind, path)
    expected = (F, S) if kind == "spectrum" else (T, ETA)
    assert x == pytest.approx(expected[0], abs=1e-6)
    assert y[:-1] == pytest.approx(expected[1][:-1], abs=1e-6)  # a spectrum is 0 beyond its last frequency


def test_tables_of_pandas_are_read_and_those_of_the_panel_by_pandas(tmp_path):
    pandas = pytest.importorskip("pandas")
    path = tmp_path / "record.csv"
    index = pandas.to_datetime("2020-01-02 23:50:00") + pandas.to_timedelta(T, "s")
    frame = pandas.DataFrame({"time": index, "eta (m)": ETA})
    for options in ({}, {"sep": ";", "decimal": ","}, {"sep": "\t"}, {"date_format": "%d.%m.%Y %H:%M:%S.%f"}):
        frame.to_csv(path, index=False, **options)
        assert read_record(path).t == pytest.approx(T, abs=1e-6)
        assert read_record(path).height == pytest.approx(ETA)
    written = "t [s],h [m]\n0.0,1.5\n0.5,\u22121.5\n".replace("\u2212", "-").encode("utf-8-sig")
    found = pandas.read_csv(io.BytesIO(written))
    assert list(found.columns) == ["t [s]", "h [m]"]
    assert found["h [m]"].tolist() == [1.5, -1.5]
    assert [row.words for row in split_rows(written.decode("utf-8-sig"), path)[0]][1] == ["0.0", "1.5"]


def test_results_of_a_class_have_a_mark_for_excel_and_are_read_again(tmp_path):
    from app.commands.lab_folders import write_files
    from app.lab.check.check import FolderResult
    from app.lab.course.answers import Answers

    results = [FolderResult(tmp_path / name, Answers(name, {}), [], 0.0) for name in ("\u00c5sa", "=1+1")]
    write_files(results, {"json": None, "csv": tmp_path / "class.csv", "report": None})
    content = (tmp_path / "class.csv").read_bytes()
    assert content.startswith(b"\xef\xbb\xbf")
    rows = list(csv.DictReader(io.StringIO(content.decode("utf-8-sig"))))
    assert [row["name"] for row in rows] == ["\u00c5sa", "'=1+1"]
    pandas = pytest.importorskip("pandas")
    assert pandas.read_csv(tmp_path / "class.csv")["name"].tolist() == ["\u00c5sa", "'=1+1"]


@pytest.mark.parametrize("base", BASES)
def test_a_deck_that_is_written_is_the_same_here_and_in_moordyn(base, tmp_path):
    (tmp_path / "before.txt").write_text(BASES[base], encoding="utf-8")
    before = read_moordyn(tmp_path / "before.txt")
    write_moordyn(before, tmp_path / "after.txt")
    after = read_moordyn(tmp_path / "after.txt")
    assert [line._replace(id=0) for line in after.lines] == [line._replace(id=0) for line in before.lines]
    assert (after.points, after.water) == (before.points, before.water)
    pytest.importorskip("moordyn")
    end = "---------------------- need this line"
    text = (tmp_path / "after.txt").read_text("utf-8").replace(end, f"0.0005 dtM\n0.5 TmaxIC\n{end}")
    theirs, ours = by_moordyn(BASES[base], tmp_path), by_moordyn(text, tmp_path)
    assert theirs is not None
    assert ours == pytest.approx(theirs, rel=1e-6)


def test_a_set_up_and_a_recording_are_read_again(tmp_path):
    kind = scene_named("rope")
    params = kind.params()
    assert read_file(write_file(kind, params)).params == params
    about = {**described(kind, params), "units": {}, "diverged": "", "notes": []}
    write_arrays(tmp_path / "run.npz", {"t": T, "about": np.array(json.dumps(about))})
    assert np.load(tmp_path / "run.npz")["t"] == pytest.approx(T)
    assert read_file(read_setup_text("--preset", tmp_path / "run.npz")).params == params


def test_a_spectrum_of_wavespectra_is_read(tmp_path):
    pytest.importorskip("netCDF4")
    xarray, _ = pytest.importorskip("xarray"), pytest.importorskip("wavespectra")
    directions = np.arange(0.0, 360.0, 15.0)
    D = np.cos(np.radians(directions - 270.0) / 2.0) ** 20
    density = S[:, None] * D / (D.sum() * 15.0)
    efth = xarray.DataArray(density, {"freq": F, "dir": directions}, ("freq", "dir"), "efth")
    efth.to_dataset().to_netcdf(tmp_path / "spectrum.nc")
    spectrum = read_spectrum(tmp_path / "spectrum.nc")
    height = 4.0 * np.sqrt(np.sum(0.5 * (S[1:] + S[:-1]) * np.diff(F)))
    assert spectrum.moments().significant_height == pytest.approx(height, rel=2e-3)
    efth.to_dataset().spec.to_swan(str(tmp_path / "spectrum.sp2"))
    assert read_spectrum(tmp_path / "spectrum.sp2").moments().significant_height == pytest.approx(height, rel=5e-3)
