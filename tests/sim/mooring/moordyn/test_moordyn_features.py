"""Small MoorDyn files, one for each feature of files: what is read, tensions at rest, and what is left out.

`moordyn_rest.csv` holds tensions [N] of the first and the last segment of each line, made with MoorDyn 2.7.2 from the
files in `files`: run on for 500 s from its initial state with the coupled points and bodies held, in steps of 0.5 ms
(stiff_cable: 200 s, 0.1 ms), with drag coefficients of 20 and 4 so that all motion ends, as the mean of the last 60 s.
It reads no version 1: that file went in as version 2.
"""

import csv
import dataclasses
import math
import warnings
from pathlib import Path

import numpy as np
import pytest

from sim.mooring import Line, LineType, Point, System, read_moordyn, write_moordyn
from tests.refusals import assert_refused

FILES = Path(__file__).with_name("files")
with Path(__file__).with_name("moordyn_rest.csv").open(encoding="utf-8") as file:
    RESTS = [(row["file"], int(row["line"]), float(row["start"]), float(row["end"])) for row in csv.DictReader(file)]
NAMES = sorted({name for name, *_ in RESTS})


def of_file(name: str) -> System:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return read_moordyn(FILES / f"{name}.txt")


def test_there_are_twelve_systems():
    assert len(NAMES) == 12
    assert {path.stem for path in FILES.glob("*.txt")} == set(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_tensions_at_rest_are_those_of_moordyn(name):
    rest = of_file(name).at_rest()
    for file, line, start, end in RESTS:
        if file == name:
            assert rest.tension[line][0] == pytest.approx(start, rel=1e-3)
            assert rest.tension[line][-1] == pytest.approx(end, rel=1e-3)


def test_version_1_has_its_own_order_of_coefficients_nodes_and_lines():
    system = of_file("version1")
    assert system.lines[1].type == LineType("rope", 0.12, 12.5, 2e7, -0.5, 1.0, 1.2, 0.0, 0.05)
    assert system.lines[1] == Line(2, system.lines[1].type, 2, 3, 126.0, 12)
    assert system.points[1] == Point(2, "free", (120.0, 0.0, -60.0), 800.0, 1.5, 0.5, 0.5, None, (0.0, 0.0, 2500.0))
    assert [point.kind for point in system.points] == ["fixed", "free", "coupled"] * 2
    assert system.slack_damping


def test_a_line_may_have_the_ends_first_under_the_column_names_of_version_1(tmp_path):
    text = (FILES / "version1.txt").read_text(encoding="utf-8")
    for line in ("1 chain 150.0 15 1 2", "2 rope 126.0 12 2 3", "3 chain 140.0 14 4 5", "4 rope 117.0 12 5 6"):
        number, kind, length, count, start, end = line.split()
        text = text.replace(line, f"{number} {kind} {start} {end} {length} {count}")
    path = tmp_path / "mixed.txt"
    path.write_text(text, encoding="utf-8")
    assert read_moordyn(path) == of_file("version1")


def test_points_of_a_coupled_body_are_where_its_angles_turn_them():
    """About x by 20 degrees, the new y by -35 and the new z by 60, as MoorDyn turns bodies."""
    system = of_file("turned_body")
    place = np.array([-10.0, 2.0, -3.0])
    for axis, degrees in ((2, 60.0), (1, -35.0), (0, 20.0)):
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        a, b = (axis + 1) % 3, (axis + 2) % 3
        place[a], place[b] = c * place[a] - s * place[b], s * place[a] + c * place[b]
    assert system.points[1].position == pytest.approx(place + [2.0, -3.0, -6.0], rel=1e-12)
    assert [point.kind for point in system.points] == ["fixed", "coupled", "fixed", "coupled"]
    assert system.points[2].position == pytest.approx((90 + 4 * math.cos(math.pi / 6), 42.0, -50.0))


def test_a_free_body_has_the_mass_of_its_row_and_the_buoyancy_of_all_its_volume():
    system = of_file("buoy")
    (body,) = system.bodies
    mass = np.asarray(body.mass)
    assert mass[0, 0] == pytest.approx(4000.0 + 0.5 * 1025.0 * 12.0)
    assert mass[3, 3] == pytest.approx(9000.0 + 4000.0 * 0.5**2)
    assert mass[0, 4] == mass[4, 0] == pytest.approx(4000.0 * 0.5)  # u x c: a turn about y moves the centre along x
    assert mass[1, 3] == mass[3, 1] == pytest.approx(-4000.0 * 0.5)
    lift = (12.0 * 1025.0 - 4000.0) * 9.81
    assert body.steady == pytest.approx((0.0, 0.0, lift, 0.0, 0.0, 0.0))
    assert np.asarray(body.stiffness)[3, 3] > 0.5 * lift  # and what its ropes add: see `test_turning.py`
    assert system.points[-1] == Point(-1, "body", (0.0, 0.0, -20.0), drag_area=6.0, body=1)


def test_depth_length_and_attachments_may_be_given_in_other_words():
    system = of_file("clump_and_float")
    assert system.water.depth == 70.0
    assert system.lines[0].length == pytest.approx(1.02 * math.hypot(60.0, 5.0))
    assert [point.kind for point in system.points] == ["fixed", "free", "free", "coupled"]


def test_a_table_of_strain_and_tension_is_read_beside_the_file():
    kind = of_file("table").lines[1].type
    assert kind.curve == ((0.0, 0.0), (0.01, 2e5), (0.02, 6e5), (0.04, 1.6e6), (0.08, 4.5e6))
    assert kind.stiffness == pytest.approx(4.5e6 / 0.08)  # of the damping, as MoorDyn has it


CHAIN = (FILES / "chain.txt").read_text(encoding="utf-8")


def test_a_table_may_hold_comments_and_empty_lines(tmp_path):
    (tmp_path / "c.dat").write_text("a\nb\nc\n0 0\n\n# measured\n  ! twice\n0.1 1e5\n0.2 3e5\n", encoding="utf-8")
    kind = read_moordyn(changed(tmp_path, ("1.0e9", "c.dat"))).lines[0].type
    assert kind.curve == ((0.0, 0.0), (0.1, 1e5), (0.2, 3e5))


def changed(tmp_path, *replacements: tuple[str, str]) -> Path:
    text = CHAIN
    for old, new in replacements:
        assert old in text
        text = text.replace(old, new)
    path = tmp_path / "line.txt"
    path.write_text(text, encoding="utf-8")
    return path


def test_options_that_only_steer_moordyn_are_listed_in_one_line():
    said: list[str] = []
    read_moordyn(FILES / "chain.txt", said.append)
    assert said == ["left out, as they control MoorDyn only: cfl, ICgenDynamic, dtWave"]


WATER = [
    ("1 WaveKin", "WaveKin 1: waves and currents of files are not read; set `waves` of the System"),
    ("2 Currents", "Currents 2: waves and currents of files are not read; set `current` of the System"),
    ("SEASTATE WaterKin", "WaterKin SEASTATE: waves and currents of files are not read; set `waves` and `current` of"),
    ("bed.txt SeafloorFile", "SeafloorFile bed.txt: the bed is level here"),
    ("7 kTop", "kTop 7: an unknown option, left out"),
    ("0 WaveKin", ""),
]


@pytest.mark.parametrize(("option", "words"), WATER)
def test_what_may_change_forces_is_warned_of(tmp_path, option, words):
    path = changed(tmp_path, ("1 ICgenDynamic", option))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        assert read_moordyn(path) == of_file("chain")
    assert [str(one.message)[: len(words) + 10] for one in caught] == ([f"line.txt: {words}"] if words else [])


def test_water_is_as_deep_as_the_lowest_fixed_point_below_the_bed(tmp_path):
    with pytest.warns(UserWarning, match=r"WtrDpth 90: the water is 100 m deep"):
        assert read_moordyn(changed(tmp_path, ("100 depth", "90 WtrDpth"))) == of_file("chain")


def test_a_file_with_many_obstacles_names_all_of_them_in_one_message(tmp_path):
    path = changed(
        tmp_path,
        ("1.0e9 -1.0", "1e9|2e9 -1.0"),
        ("(m^2) (-)\n---------------------- RODS",
         "(m^2) (-)\n1 CoupledPinned 0 0 0 0 0 0 0 0 0 0 0 0\n---------------------- RODS"),
        ("---------------------- OPTIONS",
         "---- FAILURE ----\nFailureID Point\n() ()\n1 2 1 0 1e6\n---------------------- OPTIONS"),
        ("9.81 g", "much g"),
    )  # fmt: skip
    with pytest.raises(ValueError, match="FAILURE") as error:
        read_moordyn(path)
    text = str(error.value)
    for words in ("viscoelastic", "pinned bodies", "'FAILURE'", "'much'"):
        assert words in text
    assert "\n" not in text
    assert text.count(" is not allowed; allowed: ") == 4


def test_of_very_many_obstacles_the_first_ones_are_named_and_the_others_counted(tmp_path):
    row = "1 c 1 2 320.0 20 p\n"
    path = changed(tmp_path, (row, row + "".join(f"{i} wire 1 2 3.0 4 p\n" for i in range(2, 5000))))
    with pytest.raises(ValueError, match=r"; 4986 more$") as error:
        read_moordyn(path)
    assert len(str(error.value)) < 2000


@pytest.mark.parametrize(("row", "name"), [
    ("1 Free 0 0 -5 0 0 0 -1 0 4 1 1 0", "mass"), ("1 Free 0 0 -5 0 0 0 9 0 4|-1|4 1 1 0", "I"),
    ("1 Free 0 0 -5 0 0 0 9 0|1 4 1 1 0", "CG"), ("1 Free 0 0 -5 0 0 0 9 0 4 -1 1 0", "volume"),
    ("1 Body2 0 0 -5 0 0 0 9 0 4 1 1 0", "attachment"), ("1 Free 0 0 -5 0 0 0 9 0 4 1 1|1|1|1 0", "CdA"),
])  # fmt: skip
def test_a_body_that_is_none_is_refused(tmp_path, row, name):
    path = changed(tmp_path, ("(m^2) (-)\n---------------------- RODS", f"(m^2) (-)\n{row}\n---------------- RODS"))
    assert_refused(f"BODIES, line 13: {name}", lambda: read_moordyn(path))


POINTS_OF_10 = """--- a taut rope, its points with an index of MoorDyn-F
---------------------- LINE TYPES -------------------------------
Name  Diam  MassDen  EA     BA/-zeta EI Cd  Ca  CdAx CaAx
(-)   (m)   (kg/m)   (N)    (N-s/-) (-) (-) (-) (-)  (-)
rope  0.1   8.5      2.0E7  -1.0    0   1.6 1.0 0.2  0.0
---------------------- POINTS -----------------------------------
ID Type     X     Y  Z    M    V     CdA   CA  ExternIdx
(-) (-)    (m)   (m) (m)  (kg) (m^3) (m^2) (-) (-)
1  Vessel  -20.0 0.0 -8.0   0  0     0.5   0.3   4
2  Fixed  -150.0 0.0 -120.0 0  0     0     0     0
---------------------- LINES ------------------------------------
ID LineType AttachA AttachB UnstrLen NumSegs Outputs
(-) (-)     (-)     (-)     (m)      (-)     (-)
1  rope     2       1       168.0    20      -
"""


def test_a_tenth_column_of_points_is_left_out_with_a_line_that_names_it(tmp_path):
    path, said = tmp_path / "line.txt", []
    path.write_text(POINTS_OF_10, encoding="utf-8")
    system = read_moordyn(path, said.append)
    assert said == ["left out, as MoorDyn does not read it: the tenth column of points, externidx"]
    assert system.points[0] == Point(1, "coupled", (-20.0, 0.0, -8.0), 0.0, 0.0, 0.5, 0.3)
    nine = "\n".join(line.rsplit(None, 1)[0] if line.startswith(("1  Vessel", "2  Fixed")) else line
                     for line in POINTS_OF_10.replace("  ExternIdx", "").splitlines())  # fmt: skip
    path.write_text(nine, encoding="utf-8")
    said.clear()
    assert read_moordyn(path, said.append) == system
    assert said == []
    assert system.at_rest().tension[1][0] > 0.0


BUOY = (FILES / "buoy.txt").read_text(encoding="utf-8")
ROW = "1 free 0 0 -20 0 0 0 4000 0.5 9000 12.0 6.0|10.0 0.5"


def buoy(tmp_path, row: str, *replacements: tuple[str, str]) -> System:
    """The system of the buoy's file with another body."""
    text = BUOY
    for old, new in ((ROW, row), *replacements):
        assert old in text
        text = text.replace(old, new)
    (tmp_path / "buoy.txt").write_text(text, encoding="utf-8")
    return read_moordyn(tmp_path / "buoy.txt", lambda _: None)


def test_a_free_body_without_inertia_whose_points_are_in_its_middle_is_a_free_point(tmp_path):
    """Its lines lead to the point, which has the mass, volume and drag of the body and of its points."""
    at_middle = [("4 Body1 1.5 0.0 -1.0 0 0 0 0", "4 Body1 0 0 0 100 0.5 0.25 0"),
                 ("5 Body1 -0.75 1.299038105676658 -1.0", "5 Body1 0 0 0"),
                 ("6 Body1 -0.75 -1.299038105676658 -1.0", "6 Body1 0 0 0")]  # fmt: skip
    system = buoy(tmp_path, "1 free 0 0 -20 0 0 0 4000 0 0 12.0 6.0 0.5", *at_middle)
    assert system.bodies == ()
    assert [point.id for point in system.points] == [1, 2, 3, 4]
    point = system.points[3]
    assert point[:2] == (4, "free")
    assert (point.mass, point.volume, point.drag_area) == pytest.approx((4100.0, 12.5, 6.25))
    assert point.added_mass * point.volume == pytest.approx(6.0)
    assert [line.end for line in system.lines] == [4, 4, 4]
    with_point = BUOY.replace(ROW + "\n", "").replace(
        "4 Body1 1.5 0.0 -1.0 0 0 0 0", "4 Free 0 0 -20 4100 12.5 6.25 0.48"
    )
    with_point = "\n".join(line for line in with_point.splitlines() if not line.startswith(("5 Body", "6 Body")))
    (tmp_path / "point.txt").write_text(
        with_point.replace("2 rope 2 5", "2 rope 2 4").replace("3 rope 3 6", "3 rope 3 4"), "utf-8"
    )
    assert read_moordyn(tmp_path / "point.txt") == system


def test_a_free_body_without_mass_is_where_its_lines_hold_it(tmp_path):
    """A plate that three ropes hang from: as a body of a gram for its mass and inertia."""
    massless = buoy(tmp_path, "1 free 0 0 -20 0 0 0 0 0 0 12.0 6.0 0.5")
    light = buoy(tmp_path, "1 free 0 0 -20 0 0 0 1e-3 0 1e-3 12.0 6.0 0.5")
    rests = [system.at_rest() for system in (massless, light)]
    for line in (1, 2, 3):
        assert rests[0].tension[line] == pytest.approx(rests[1].tension[line], rel=1e-6)
    mass = np.asarray(massless.bodies[0].mass)
    assert 0.0 < mass[0, 0] - 0.5 * 1025.0 * 12.0 < 0.1
    assert (np.linalg.eigvalsh(mass) > 0.0).all()
    from sim.mooring import critical_step

    assert critical_step(massless, "rk4") > 0.2 * critical_step(of_file("buoy"), "rk4")


TABLES = [
    ("c.dat, line 5", "a\nb\nc\n0 0\n0.1 hard\n", "'hard'"),
    ("c.dat, line 3", "curve\nStrain Tension\n(-) (kN)\n0 0\n0.1 1e2\n", "tension in N"),
    ("c.dat, line 3", "curve\nStrain Tension\n(%) (N)\n0 0\n10 1e5\n", "strain without a unit"),
    ("c.dat, line 5", "a\nb\nc\n0 0\n0.1 1e5 7\n", "2 columns"),
    ("c.dat", "a\nb\nc\n", "rows"),
    ("line type c: curve", "a\nb\nc\n0 0\n0.1 1e5\n0.2 1e5\n", "growing"),
    ("line type c: curve", "a\nb\nc\n0 0\n0.1 1e5\n0.1 2e5\n", "growing"),
    ("c.dat", None, "no such file"),
]


@pytest.mark.parametrize(("name", "table", "words"), TABLES)
def test_a_table_that_is_none_is_refused(tmp_path, name, table, words):
    if table is not None:
        (tmp_path / "c.dat").write_text(table, encoding="utf-8")
    with pytest.raises(ValueError, match=name) as error:
        read_moordyn(changed(tmp_path, ("1.0e9", "c.dat")))
    assert words in str(error.value)
    assert "\n" not in str(error.value)


HOSTILE = [
    "", "\n", "\x00" * 100, "---", "--- LINE TYPES ---", "--- OPTIONS ---\n1\n", CHAIN[:300], CHAIN.replace(" ", ""),
    CHAIN.replace("\n", " "), CHAIN.replace("0.1 200", "1e400 200"), CHAIN.replace("320.0 20", "320.0 1e30"),
    CHAIN.replace("320.0 20", "-1e9 20"), CHAIN.replace("Coupled 10.0", "Body9 10.0"),
    CHAIN.replace("Coupled 10.0", "Turbine1 10.0"), CHAIN.replace("1 c 1 2", "1 c 2 2"),
    CHAIN.replace("1.0e9", "../../etc/passwd"), CHAIN.replace("1.0e9", "."), CHAIN.replace("1.0e9", "a\x00.dat"),
    CHAIN.replace("c 0.1", "c 0.1 " * 500), CHAIN + CHAIN, CHAIN.replace("1025 rho", "1025 rho\n1000 rhoW"),
    CHAIN.replace("100 depth", "-5 depth").replace("-100.0", "100.0"), CHAIN.replace("9.81 g", "nan g"),
    CHAIN.replace("2 Coupled", "99999999999999999999 Coupled"), CHAIN.replace("1 c 1 2", "1 c 1 99999999999999999999"),
]  # fmt: skip


@pytest.mark.parametrize("text", HOSTILE)
def test_a_hostile_file_is_refused_in_one_line(tmp_path, text):
    path = tmp_path / "hostile.txt"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError) as error:  # noqa: PT011
        read_moordyn(path, lambda text: None)
    assert 10 < len(str(error.value)) < 5000
    assert "\n" not in str(error.value)


def test_moordyn_reads_what_is_written(tmp_path):
    moordyn = pytest.importorskip("moordyn")
    system = of_file("table")
    kind = system.lines[0].type._replace(name="stiff", bending=1e4)
    lines = (system.lines[0]._replace(type=kind, id=7), system.lines[1]._replace(id=9, start=2, end=3))
    write_moordyn(dataclasses.replace(system, lines=lines), tmp_path / "out.txt")
    text = (tmp_path / "out.txt").read_text(encoding="utf-8")
    (tmp_path / "out.txt").write_text(text.replace("9.81", "0 TmaxIC\n0.001 dtM\n9.81", 1), encoding="utf-8")
    found = moordyn.Create(str(tmp_path / "out.txt"))
    try:
        assert (moordyn.GetNumberPoints(found), moordyn.GetNumberLines(found)) == (3, 2)
        moordyn.Init(found, list(system.points[2].position), [0.0] * 3)
        for i, line in enumerate(lines, 1):
            there = moordyn.GetLine(found, i)
            assert moordyn.GetLineN(there) == line.segments
            assert moordyn.GetLineUnstretchedLength(there) == pytest.approx(line.length)
    finally:
        moordyn.Close(found)


def test_what_a_file_of_lines_and_points_does_not_hold_is_not_written(tmp_path):
    system = of_file("version1")
    assert_refused("system: forces on points", lambda: write_moordyn(system, tmp_path / "out.txt"), "[2, 5]")
    beam = of_file("stiff_cable")
    clamped = dataclasses.replace(beam, lines=(beam.lines[0]._replace(clamp_at_start=(1.0, 0.0, 0.0)),))
    assert_refused("system: clamps of lines", lambda: write_moordyn(clamped, tmp_path / "out.txt"))
    spaced = dataclasses.replace(beam, lines=(beam.lines[0]._replace(type=beam.lines[0].type._replace(name="a b")),))
    assert_refused("system: line types", lambda: write_moordyn(spaced, tmp_path / "out.txt"), "a b")
