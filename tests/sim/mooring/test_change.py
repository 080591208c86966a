"""A MoorDyn file with other lengths and diameters: those are read again, and no other byte has changed."""

from pathlib import Path

import pytest

from sim.mooring import changed_moordyn, read_moordyn

FILES = sorted((Path(__file__).parent / "files").glob("*.txt"))
TEXT = (
    "\ufeff--- MoorDyn Input File ---\r\nÅ comment …\r\n---- LINE TYPES ----\r\n"
    "Name   Diam    MassDen  EA     BA/-zeta EI Cd  Ca  CdAx CaAx\r\n(-) (m) (kg/m) (N) (N-s) (Nm2) (-) (-) (-) (-)\r\n"
    "main   0.1     100.0    5e8    -0.8  0 1.6 1.0 0.1  0.0   # the chain, 1.6 Å\r\n"
    "other\t0.2\t50 1e8 -0.5 0 1.2 1.0 0.1 0.0\r\n"
    "---- POINTS ----\r\nID Type X Y Z M V CdA CA\r\n(-) (-) (m) (m) (m) (kg) (m3) (m2) (-)\r\n"
    "1 Fixed 180 0 -50 0 0 0 0\r\n2 Vessel 5 0 -3 0 0 0 0\r\n3 Fixed -180 0 -50 0 0 0 0\r\n"
    "---- LINES ----\r\nID Type NodeA NodeB UnstrLen NumSegs Outputs\r\n(-) (-) (-) (-) (m) (-) (-)\r\n"
    "1   main  1  2  -1.05   10   -\r\n2   other  3  2  200.0 10 -\r\n"
    "---- OPTIONS ----\r\n50 WtrDpth\r\n---- END ----"
).encode() + b"\r\n\xff not of UTF-8\r\n"


def test_what_is_changed_is_read_again_and_nothing_else_is() -> None:
    content = changed_moordyn(TEXT, {1: 187.123456789, 2: 210.0}, {"main": 0.12345})
    before, after = (read_moordyn("moor.txt", lambda line: None, one) for one in (TEXT, content))
    first, second = after.lines
    assert (first.length, second.length) == (187.123456789, 210.0)
    assert (first.type.diameter, second.type.diameter) == (0.12345, 0.2)
    as_before = [
        line._replace(length=old.length, type=line.type._replace(diameter=old.type.diameter))
        for line, old in zip(after.lines, before.lines, strict=True)
    ]
    assert as_before == list(before.lines)
    assert (after.points, after.water) == (before.points, before.water)
    rows, others = TEXT.split(b"\r\n"), content.split(b"\r\n")
    assert [i for i, (a, b) in enumerate(zip(rows, others, strict=True)) if a != b] == [5, 16, 17]
    for i, changed in ((5, b"0.12345"), (16, b"187.123456789"), (17, b"210.0")):
        words, new = rows[i].split(), others[i].split()
        assert [b for a, b in zip(words, new, strict=True) if a != b] == [changed]
    assert others[5].index(b"100.0") == rows[5].index(b"100.0")  # there is room


def test_a_change_and_its_way_back_give_the_file() -> None:
    there = changed_moordyn(TEXT, {2: 12345.678}, {"main": 0.3})
    assert changed_moordyn(there, {2: 200.0}, {"main": 0.1}) == TEXT
    assert changed_moordyn(TEXT) == TEXT


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_files_with_a_change_are_read_as_before_but_for_it(path: Path) -> None:
    content, system = path.read_bytes(), read_moordyn(path, lambda line: None)
    line = system.lines[0]
    changed = changed_moordyn(content, {line.id: 1.01 * line.length}, {line.type.name: 1.02 * line.type.diameter})
    other = read_moordyn(path, lambda line: None, changed)
    assert other.lines[0].length == 1.01 * line.length
    assert other.lines[0].type.diameter == 1.02 * line.type.diameter
    assert [one.length for one in other.lines[1:]] == [one.length for one in system.lines[1:]]
    assert len(changed.splitlines()) == len(content.splitlines())


@pytest.mark.parametrize(
    ("lengths", "diameters", "words"),
    [
        ({3: 10.0}, {}, r"length of line: 3 is not allowed; allowed: one of \[1, 2\]"),
        ({}, {"chain": 0.1}, "diameter of line type: "),
        ({1: 0.0}, {}, "length of line 1"),
        ({}, {"main": float("nan")}, "diameter of line type main"),
    ],
)
def test_what_cannot_be_changed_is_named(lengths, diameters, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        changed_moordyn(TEXT, lengths, diameters)
