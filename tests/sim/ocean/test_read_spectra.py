"""`read_spectra`: all spectra of a file that is read once, equal to those that `read_spectrum` reads one by one."""

import datetime
import pickle
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from sim.ocean import read_spectra, read_spectrum
from sim.ocean.spectrum_files import buoys
from tests.refusals import assert_refused

F = (0.05, 0.08, 0.1, 0.12, 0.16)  # [Hz]
HOUR = datetime.timedelta(hours=1)
START = datetime.datetime(2021, 3, 5, 0, 40)
K, OMEGA = np.array([0.02, 0.03]), np.array([0.5, 0.6, 0.8])


def written_buoy(folder: Path, hours: int) -> Path:
    """The five files of a buoy, hour after hour; the third hour has no densities, the fifth no directions."""
    head = "#YY  MM DD hh mm " + " ".join(f"{f:.4f}" for f in F)
    rng = np.random.default_rng(1)
    lows = {"w": (0.1, 9.0), "d": (0.0, 360.0), "i": (0.0, 360.0), "j": (0.3, 0.9), "k": (0.2, 0.8)}
    for letter, (low, high) in lows.items():
        rows = [head]
        for hour in range(hours):
            values = rng.uniform(low, high, len(F))
            if letter == "w" and hour == 2:
                values[:] = 999.0
            if letter == "w" or hour != 4:
                time = START + hour * HOUR
                rows.append(f"{time:%Y %m %d %H %M} " + " ".join(f"{value:.2f}" for value in values))
        (folder / f"46999{letter}2021.txt").write_text("\n".join(rows) + "\n", "utf-8")
    return folder / "46999w2021.txt"


def written_swan(folder: Path) -> Path:
    times = (f"2021030{day}.060000\nLOCATION 1\n{low} 45.0 20.0\n2.0 50.0 20.0\n1.0 60.0 20.0\n" for day, low in
             ((5, 0.5), (6, 0.7)))  # fmt: skip
    path = folder / "swan.spc"
    path.write_text(
        "SWAN 1\nTIME\n1\nLOCATIONS\n1\n0.0 0.0\nAFREQ\n3\n0.05\n0.1\n0.2\nQUANT\n3\nVaDens\nm2/Hz\n-99\n"
        "NDIR\ndegr\n-999\nDSPRDEGR\ndegr\n-9\n" + "".join(times), "utf-8")  # fmt: skip
    return path


def same(one: object, other: object) -> None:
    assert (one.name, one.notes) == (other.name, other.notes)  # type: ignore[attr-defined]
    c = one.conditions()  # type: ignore[attr-defined]
    np.testing.assert_array_equal(one(K, -0.5 * K, c), other(K, -0.5 * K, c))  # type: ignore[operator]
    np.testing.assert_array_equal(one.frequency_density(OMEGA), other.frequency_density(OMEGA))  # type: ignore[attr-defined]


def test_all_spectra_of_a_buoy_take_one_reading_of_each_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path, hours, reads, opened = written_buoy(tmp_path, 7), 7, Counter[str](), Path.open

    def counted(self: Path, *arguments: object, **more: object) -> object:
        reads[self.name] += 1
        return opened(self, *arguments, **more)  # type: ignore[arg-type]

    monkeypatch.setattr(Path, "open", counted)
    read_spectrum(path)
    one_reading = Counter(reads)
    assert len(one_reading) == 5
    reads.clear()
    parsed, records_of = Counter[str](), buoys.records_of
    monkeypatch.setattr(buoys, "records_of", lambda text, path: parsed.update([path.name]) or records_of(text, path))
    series = read_spectra(path)
    found = dict(series)
    assert reads == one_reading
    assert set(parsed.values()) == {1}
    assert list(found) == [START + hour * HOUR for hour in range(hours) if hour != 2]
    assert len(series) == hours - 1
    assert START + 2 * HOUR not in series
    for time, spectrum in found.items():
        same(spectrum, read_spectrum(path, str(time)))
    has_notes = {time for time, spectrum in found.items() if any("no directions" in note for note in spectrum.notes)}
    assert has_notes == {START + 4 * HOUR}
    assert_refused("time", lambda: read_spectrum(path, str(START + 2 * HOUR)), "has none")


def test_a_series_of_swan_has_its_times_and_can_be_saved(tmp_path: Path) -> None:
    path = written_swan(tmp_path)
    series = read_spectra(path)
    times = [datetime.datetime(2021, 3, day, 6) for day in (5, 6)]
    assert list(series) == times
    again = pickle.loads(pickle.dumps(series))
    for time in reversed(times):
        same(series[time], read_spectrum(path, str(time)))
        same(again[time], series[time])
    assert series == series
    assert series != again
    assert isinstance(hash(series), int)
    with pytest.raises(KeyError):
        series[times[0] + HOUR]


def test_a_file_of_one_spectrum_is_no_series(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_text("frequency (Hz),S (m2/Hz)\n0.05,0.1\n0.1,2.0\n0.2,0.3\n", "utf-8")
    assert_refused("path", lambda: read_spectra(path), "read_spectrum")
    assert_refused("time", lambda: read_spectrum(path, "2021-03-05"), "table of one")
    assert_refused("place", lambda: read_spectra(path, place=0), "at least 1")
