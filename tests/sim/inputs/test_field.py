"""Twelve files as people had them: each is read as it was meant, with what cannot be meant said in one line."""

from pathlib import Path

import pytest

from sim.inputs.bounds import WARNING
from sim.mooring import read_moordyn
from sim.ocean import read_record, read_spectrum

FIELD = Path(__file__).parent / "field"
RECORDS = {"record_iso.csv": 129, "record_clock_columns.csv": 139, "record_openfast.out": 132}
SPECTRA = ("spectrum_sep.csv", "swan_exception_zero.sp2", "swan_exception_zero_some.sp2")
PLAIN = ("deck_commas.dat", "deck_comment.dat", "deck_outputs_space.dat")
DOUBTS = {
    "deck_anchor_typo.dat": "anchor 2 lies 180 m above the bed, points 1, 3 on it",
    "deck_kN.dat": "lighter than any line",
    "deck_z_positive.dat": "no point is under water",
}


def test_all_twelve_files_are_tried():
    assert {path.name for path in FIELD.iterdir()} == {*RECORDS, *SPECTRA, *PLAIN, *DOUBTS}


@pytest.mark.parametrize("name", RECORDS)
def test_a_record_with_stamps_is_read_in_seconds(name):
    record = read_record(FIELD / name)
    assert len(record.t) == RECORDS[name]
    assert record.t == pytest.approx([0.5 * i for i in range(RECORDS[name])])
    assert 4.0 * record.height.std() == pytest.approx(2.41, rel=0.02)
    assert "Tz 10 s" in record.notes[0]


@pytest.mark.parametrize("name", SPECTRA)
def test_a_spectrum_with_a_mark_of_excel_or_an_exception_of_0_is_read_whole(name):
    spectrum = read_spectrum(FIELD / name)
    assert spectrum.moments().significant_height == pytest.approx(1.5, rel=4e-3)
    assert spectrum.moments().peak_period == pytest.approx(10.0, rel=1e-4)


def system_of(name):
    said = []
    return read_moordyn(FIELD / name, said.append), [line for line in said if line.startswith(WARNING)]


@pytest.mark.parametrize("name", PLAIN)
def test_a_deck_that_moordyn_reads_is_read(name):
    system, said = system_of(name)
    assert said == []
    assert [(point.kind, point.position) for point in system.points] == [
        ("fixed", (500.0, 0.0, -150.0)),
        ("coupled", (0.0, 0.0, -9.0)),
    ]
    assert [(line.length, line.segments, line.type.stiffness) for line in system.lines] == [(535.0, 30, 1e9)]


@pytest.mark.parametrize("name", DOUBTS)
def test_a_deck_that_cannot_be_meant_gets_one_line(name):
    (said,) = system_of(name)[1]
    assert DOUBTS[name] in said
    with pytest.warns(UserWarning, match=DOUBTS[name]):
        read_moordyn(FIELD / name)
