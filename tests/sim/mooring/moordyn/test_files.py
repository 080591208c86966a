"""MoorDyn's files: read, written, and refused in one line that names the place."""

import dataclasses
import math
import re
from pathlib import Path

import numpy as np
import pytest

from sim.mooring import Line, LineType, Point, System, read_moordyn, simulate, write_moordyn
from sim.springs import rope
from sim.water import Water
from tests.refusals import assert_refused
from tests.sim.mooring.systems import chain_on_bed, floating_body

TEXT = """--------------------- MoorDyn Input File ------------------------------------
A chain on the bed, as MoorDyn's own examples are laid out
----------------------- LINE TYPES ------------------------------------------
TypeName   Diam    Mass/m     EA     BA/-zeta     EI         Cd     Ca     CdAx    CaAx
(name)     (m)     (kg/m)     (N)    (N-s/-)    (N-m^2)      (-)    (-)    (-)     (-)
chain      0.09    80.0      5e7     -0.8        0          1.6    1.0    0.1     0.0
---------------------- POINTS -----------------------------------------------
ID  Attachment  X       Y      Z      M      V      CdA    CA
(#)   (-)       (m)    (m)    (m)    (kg)   (m^3)  (m^2)  (-)
1     Fixed    -140.0   0.0   -40.0    0      0      0      0
2     Coupled    0.0    0.0     0.0    0      0      0      0
---------------------- LINES ------------------------------------------------
ID    LineType   AttachA  AttachB  UnstrLen  NumSegs   LineOutputs
(#)    (name)      (#)      (#)      (m)       (-)        (-)
1      chain        1        2       160.0      40         pt
---------------------- OPTIONS ----------------------------------------------
0.001    dtM
3.0e6    kBot
3.0e5    cBot
1025     rhoW
40       WtrDpth
9.81     g
2        dtIC
------------------------- OUTPUTS -------------------------------------------
FairTen1
------------------------- need this line ------------------------------------
"""
CHAIN = next(line for line in TEXT.splitlines(keepends=True) if line.startswith("chain"))
LINE = next(line for line in TEXT.splitlines(keepends=True) if line.startswith("1      chain"))


CHAIN_OF_FILE = dataclasses.replace(chain_on_bed(40), slack_damping=True)


def written(tmp_path, text: str):
    path = tmp_path / "line.txt"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_file_in_the_form_of_moordyn_is_the_system_that_it_describes(tmp_path):
    assert read_moordyn(written(tmp_path, TEXT)) == CHAIN_OF_FILE


def test_line_ends_and_marks_of_windows_comments_and_letters_of_any_alphabet_are_read(tmp_path):
    text = TEXT.replace("pt\n", "pt  ! a line\n").replace("0.001    dtM", "# Schrittweite f\u00fcr dtM\n0.001  dtM")
    path = tmp_path / "windows.txt"
    path.write_bytes(b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode())
    assert read_moordyn(path) == CHAIN_OF_FILE
    path.write_bytes(text.split("\n", 2)[2].encode("utf-8-sig"))  # begins with the mark and the header of its types
    assert read_moordyn(path) == CHAIN_OF_FILE
    path.write_bytes(text.encode("latin-1"))
    assert read_moordyn(path) == CHAIN_OF_FILE


def test_without_a_depth_the_water_is_as_deep_as_its_lowest_anchor(tmp_path):
    text = TEXT.replace("40       WtrDpth\n", "").replace(
        "2     Coupled    0.0    0.0     0.0", "2  Fixed  0.0  0.0  -9.0"
    )
    assert read_moordyn(written(tmp_path, text)).water.depth == 40.0


def test_a_system_that_is_written_is_read_as_it_was(tmp_path):
    kind = LineType("rope", 0.1 / 3.0, 7.0, 1e7 / 3.0, 2e4, 1.1, 1.2, 0.3, 0.04, 1e4 / 3.0)
    curve = ((0.0, 0.0), (0.1 / 3.0, 2e5), (0.1, 9e5))
    other = kind._replace(name="table", bending=0.0, curve=curve, stiffness=9e6)
    points = (
        Point(3, "fixed", (1.0 / 3.0, 0.0, -20.0)), Point(4, "free", (5.0, 0.0, -9.0), 12.0, 0.1, 0.2, 0.5),
        Point(8, "coupled", (9.0, 1.0, 0.0)),
    )  # fmt: skip
    lines = (Line(5, kind, 3, 4, 13.0, 7), Line(6, other, 4, 8, 11.0, 5))
    system = System(lines, points, Water(20.0, gravity=9.8), friction=0.4, slack_damping=True)
    path = tmp_path / "out.txt"
    write_moordyn(system, path)
    # Numbered from 1 on, as MoorDyn wants it.
    renumbered = tuple(point._replace(id=i) for i, point in enumerate(points, 1))
    relined = (lines[0]._replace(id=1, start=1, end=2), lines[1]._replace(id=2, start=2, end=3))
    assert read_moordyn(path) == dataclasses.replace(system, points=renumbered, lines=relined)


def test_the_numbers_of_a_file_are_written_as_a_person_writes_them(tmp_path: Path) -> None:
    path = tmp_path / "in.txt"
    path.write_text(TEXT, "utf-8")
    write_moordyn(read_moordyn(path), path)
    words = path.read_text("utf-8").split()
    assert {"0.09", "80", "-0.8", "1.6", "0.1"} <= set(words)
    assert not any(len(word) > 15 for word in words if re.fullmatch(r"-?[0-9.]+", word))


def replaced(old: str, new: str) -> str:
    assert old in TEXT
    return TEXT.replace(old, new)


BROKEN = [
    ("LINE TYPES, line 6", replaced("5e7", "stiff"), "'stiff'"),
    ("LINE TYPES, line 6: EA", replaced("5e7     -0.8", "SYROPE:ea.dat|1|2 -0.8"), "Syrope"),
    ("LINE TYPES, line 6: EA", replaced("5e7     -0.8", "5e7|1e6 -0.8"), "viscoelastic"),
    ("line type chain: bending", replaced("-0.8        0  ", "-0.8       -1e4"), "-10000"),
    ("LINE TYPES, line 6: EI", replaced("-0.8        0  ", "-0.8    ei.dat "), "not modelled"),
    (
        "LINE TYPES, line 6",
        replaced("chain      0.09    80.0      5e7     -0.8        0 ", "chain 0.09 80.0 5e7"),
        "9 to 13 columns",
    ),
    ("line type chain: diameter", replaced("0.09", "0"), "0"),
    ("line type chain: diameter", replaced("0.09", "-1"), "-1"),
    ("LINE TYPES, line 6", replaced("0.09", "nan"), "nan"),
    ("line type chain: mass", replaced("80.0", "0.0"), "0.0"),
    ("LINE TYPES, line 6", replaced("80.0", "inf"), "inf"),
    ("line type chain: drag_across", replaced("1.6", "-1.6"), "-1.6"),
    ("RODS, line 10", replaced("---------------------- POINTS -", "----- RODS -"), "10 to 11 columns"),
    ("line 7: section", replaced("---------------------- POINTS -", "----- BUOYS -"), "BUOYS"),
    ("line 12: section", replaced("- LINES -", "- POINTS -"), "POINTS"),
    ("file", replaced("---------------------- LINES --", "---------------------- OUTPUTS -"), "LINES"),
    ("file", TEXT.split("----------------------- LINE TYPES")[0], "LINE TYPES"),
    ("POINTS, line 10: attachment", replaced("Fixed  ", "Nailed "), "'Nailed'"),
    ("POINTS, line 10", replaced("-140.0 ", "west  "), "'west'"),
    ("POINTS, line 11: ID", replaced("2     Coupled", "1     Coupled"), "1"),
    ("POINTS, line 10", replaced("1     Fixed ", "1.5   Fixed "), "'1.5'"),
    (
        "POINTS, line 11",
        replaced("2     Coupled    0.0    0.0     0.0    0      0      0      0", "2 Coupled 0 0"),
        "8 to 12 columns",
    ),
    ("point 1: position", replaced("-140.0", "-1.4e7"), "nearer"),
    ("POINTS, line 10", replaced("-140.0 ", "1e999  "), "'1e999'"),
    ("point 2: mass", replaced("0.0    0      0      0      0\n----", "0.0   -5      0      0      0\n----"), "-5"),
    ("LINES, line 15: type", replaced("1      chain   ", "1      wire    "), "'wire'"),
    ("LINES, line 15: attachment", replaced("1        2       160", "1        3       160"), "'3'"),
    ("LINES, line 15: attachment", replaced("1        2       160", "1      Body1     160"), "'Body1'"),
    ("LINES, line 15: attachment", replaced("1        2       160", "1      R1A       160"), "'R1A'"),
    ("line 1: end", replaced("1        2       160", "1        1       160"), "1"),
    ("line 1: length", replaced("160.0 ", "0     "), "0"),
    ("line 1: length", replaced("160.0 ", "-1600 "), "100000"),
    ("LINES, line 15", replaced("160.0 ", "nan   "), "nan"),
    ("line 1: segments", replaced("   40         pt", "    0         pt"), "0"),
    ("LINES, line 15", replaced("   40         pt", "  4.5         pt"), "4.5"),
    ("line 1: segments", replaced("   40         pt", " 1e9          pt"), "1000000000"),
    ("LINES, line 15", replaced("160.0      40         pt", "160.0"), "6 to 7 columns"),
    ("OPTIONS, line 18", replaced("3.0e6", "much "), "'much'"),
    ("bed_stiffness", replaced("3.0e6", "-3e6 "), "-3"),
    ("density", replaced("1025 ", "-1025"), "-1025"),
    ("water: depth", replaced("40       WtrDpth", "2e5      WtrDpth"), "200000"),
    (
        "LINE TYPES, line 5",
        replaced("(name)     (m)     (kg/m)     (N)    (N-s/-)    (N-m^2)      (-)    (-)    (-)     (-)\n", ""),
        "units",
    ),
    ("POINTS, line 9", replaced("(#)   (-)       (m)    (m)    (m)    (kg)   (m^3)  (m^2)  (-)\n", ""), "units"),
    ("LINES, line 14", replaced("(#)    (name)      (#)      (#)      (m)       (-)        (-)\n", ""), "units"),
    ("LINE TYPES, line 7: name", replaced(CHAIN, CHAIN + CHAIN), "'chain'"),
    ("LINE TYPES, line 6", replaced(CHAIN, CHAIN[:-1] + "  0.3  0.1  0.1\n"), "vortex"),
    ("line type chain: stiffness", replaced("5e7 ", "-5e7"), "-5"),
    ("line type chain: damping", replaced("-0.8", "-8e9"), "-100"),
    ("line 12: section", replaced("- LINES -", "- FAILURE -"), "FAILURE"),
    ("POINTS, line 10", replaced("-40.0    0 ", "-40.0  nan "), "'nan'"),
    ("POINTS, line 10", replaced("-40.0    0 ", "-40.0  0 7 7 "), "12 with a force"),
    ("LINES, line 16: ID", replaced(LINE, LINE + LINE), "1"),
    ("LINES, line 15", replaced("160.0 ", "160,0 "), "'160,0'"),
    ("LINES, line 15", replaced("160.0 ", "1_60.0"), "'1_60.0'"),
    ("LINES, line 15", replaced("160.0 ", "\uff11\uff16\uff10   "), "finite"),
    ("LINES, line 15", replaced("   40         pt", "   40  pt  7"), "6 to 7 columns"),
    ("LINES, line 15", TEXT[: TEXT.index("160.0")], "6 to 7 columns"),
    ("file", TEXT[: TEXT.index(LINE)], "LINES"),
    ("line 1: segments", replaced("   40         pt", "  -40         pt"), "-40"),
    ("OPTIONS, line 18", replaced("3.0e6", "inf  "), "'inf'"),
    ("OPTIONS, line 19: kb", replaced("cBot", "kb"), "3e+06"),
    ("OPTIONS, line 23", replaced("2        dtIC", "dtIC"), "2 columns"),
    (
        "OPTIONS: WtrDpth",
        replaced("40       WtrDpth\n", "").replace("Fixed    -140.0   0.0   -40.0", "Free -140 0 -40"),
        "depth",
    ),
]


@pytest.mark.parametrize(("name", "text", "words"), BROKEN)
def test_what_is_not_understood_is_refused_in_one_line(tmp_path, name, text, words):
    path = written(tmp_path, text)
    with pytest.raises(ValueError, match="is not allowed; allowed: ") as error:
        read_moordyn(path)
    assert str(error.value).startswith(name)
    assert words in str(error.value)
    assert "\n" not in str(error.value)


def test_a_file_that_cannot_be_read_is_named(tmp_path):
    with pytest.raises(ValueError, match=r"^file: .*none\.txt: no such file$"):
        read_moordyn(tmp_path / "none.txt")
    assert_refused("file", lambda: read_moordyn(tmp_path), "a file")
    binary = tmp_path / "binary"
    binary.write_bytes(bytes(range(256)) * 10)
    assert_refused("file", lambda: read_moordyn(binary))


SYSTEM = chain_on_bed(4)
POINTS, LINES = SYSTEM.points, SYSTEM.lines
BODY = floating_body()
TRIANGLE, PUSH = np.triu(np.ones((6, 6))), np.ones((1, 6))
ROWS = [
    ("lines", lambda: System((), POINTS, Water(40.0))),
    ("lines: id", lambda: System((LINES[0], LINES[0]), POINTS, Water(40.0))),
    ("points: id", lambda: System(LINES, (*POINTS, POINTS[0]), Water(40.0))),
    ("points: id", lambda: System(LINES, (*POINTS, POINTS[0]._replace(id="3")), Water(40.0))),
    ("water", lambda: dataclasses.replace(SYSTEM, water=40.0)),
    ("water: depth", lambda: dataclasses.replace(SYSTEM, water=Water())),
    ("depth", lambda: Water(math.nan)),
    ("gravity", lambda: Water(40.0, gravity=-1.0)),
    ("water: gravity", lambda: dataclasses.replace(SYSTEM, water=Water(40.0, gravity=1e5))),
    ("current", lambda: dataclasses.replace(SYSTEM, current=(1.0, math.inf, 0.0))),
    ("friction", lambda: dataclasses.replace(SYSTEM, friction=-0.1)),
    ("point 1: kind", lambda: System(LINES, (POINTS[0]._replace(kind="nail"), POINTS[1]), Water(40.0))),
    ("point 1: body", lambda: System(LINES, (POINTS[0]._replace(kind="body", body=7), POINTS[1]), Water(40.0))),
    ("point 2: body", lambda: System(LINES, (POINTS[0], POINTS[1]._replace(body=1)), Water(40.0), bodies=(BODY,))),
    ("point 5", lambda: System(LINES, (*POINTS, Point(5, "free", (0.0, 0.0, -1.0))), Water(40.0))),
    ("body 1: mass", lambda: System(LINES, POINTS, Water(40.0), bodies=(BODY._replace(mass=np.zeros((6, 6))),))),
    (
        "body 1: mass",
        lambda: System(LINES, POINTS, Water(40.0), bodies=(BODY._replace(mass=TRIANGLE),)),
    ),
    ("body 1: stiffness", lambda: System(LINES, POINTS, Water(40.0), bodies=(BODY._replace(stiffness=-np.eye(6)),))),
    ("body 1: damping", lambda: System(LINES, POINTS, Water(40.0), bodies=(BODY._replace(damping=np.eye(5)),))),
    (
        "body 1: excitation",
        lambda: System(LINES, POINTS, Water(40.0), bodies=(BODY._replace(excitation=PUSH),)),
    ),
    ("system", lambda: simulate(None)),  # type: ignore[arg-type]
    ("motion", lambda: simulate(SYSTEM, motion={1: lambda t: (0.0, 0.0, 0.0)})),
    ("motion", lambda: simulate(rope(3), motion={})),  # a net has x and v instead
    ("x", lambda: simulate(SYSTEM, x=SYSTEM.start())),
    ("motion[2]", lambda: simulate(SYSTEM, motion={2: 3.0})),  # type: ignore[dict-item]
    ("motion[2](0)", lambda: simulate(SYSTEM, motion={2: lambda t: (0.0, math.nan, 0.0)})),
    ("duration", lambda: simulate(SYSTEM, duration=0.0)),
    ("frames", lambda: simulate(SYSTEM, frames=1)),
    ("step", lambda: simulate(SYSTEM, step=-1.0)),
    ("step", lambda: simulate(SYSTEM, step=1e-12)),
    ("integrator", lambda: simulate(SYSTEM, integrator="implicit_midpoint")),
    ("integrator", lambda: simulate(SYSTEM, integrator="nosuch")),
    ("system: bodies", lambda: write_moordyn(dataclasses.replace(SYSTEM, bodies=(BODY,)), "none.txt")),
]


@pytest.mark.parametrize(("name", "call"), ROWS)
def test_what_no_mooring_has_is_refused(name, call):
    assert_refused(name, call)
