"""Rods of MoorDyn's files: tensions at rest against MoorDyn and by moments, clamps, and what is refused.

MOORDYN: tensions [N] at the ends of each line, made with MoorDyn 2.7.2 from the files in `rods`: run on for 100 s or
200 s from its initial state with the coupled rods held, in steps of 0.2 or 0.5 ms, with drag coefficients of 4.
"""

import math
import tempfile
from pathlib import Path

import numpy as np
import pytest

from sim.mooring import System, critical_step, read_moordyn, simulate
from tests.refusals import assert_refused

RODS = Path(__file__).with_name("rods")
MOORDYN = {
    "rod_clamp": {1: (1219.17, 2156.94)},
    "rod_body": {1: (6191.66, 7229.14), 2: (6191.42, 7228.91), 3: (6191.42, 7228.91)},
}


def of_file(name: str, said: list[str] | None = None) -> System:
    return read_moordyn(RODS / f"{name}.txt", ([] if said is None else said).append)


@pytest.mark.parametrize("name", MOORDYN)
def test_tensions_of_lines_on_rods_are_those_of_moordyn(name):
    rest = of_file(name).at_rest()
    for line, (start, end) in MOORDYN[name].items():
        assert rest.tension[line][0] == pytest.approx(start, rel=1e-3)
        assert rest.tension[line][-1] == pytest.approx(end, rel=1e-3)


def test_a_rod_that_is_held_is_the_points_at_its_ends_and_clamps_lines_with_ei():
    """The point at the end without a line is left out. Without EI the line is hinged."""
    system = of_file("rod_clamp")
    (line,) = system.lines
    ends = [next(point for point in system.points if point.id == one) for one in (line.start, line.end)]
    assert [(point.kind, point.position) for point in ends] == [
        ("fixed", (-50.0, 0.0, -57.0)),
        ("coupled", (0.0, 0.0, -10.0)),
    ]
    assert len(system.points) == 3
    assert line.clamp_at_start == pytest.approx(np.array([2.0, 0.0, 1.0]) / math.sqrt(5.0))
    assert line.clamp_at_end == pytest.approx((0.0, 0.0, 1.0))  # into the end B of a rod that points down
    # the other ends, where lines leave the rods against their direction
    (other,) = read_text_of("rod_clamp", ("R1B R2B", "R1A R2A")).lines
    assert other.clamp_at_start == pytest.approx(np.array([-2.0, 0.0, -1.0]) / math.sqrt(5.0))
    assert other.clamp_at_end == pytest.approx((0.0, 0.0, -1.0))
    hinged = read_text_of("rod_clamp", ("300000.0", "0.0"))
    assert hinged.lines[0].clamp_at_start is None


def read_text_of(name: str, *replacements: tuple[str, str]) -> System:
    """The system of a file of rods with changes."""
    text = (RODS / f"{name}.txt").read_text(encoding="utf-8")
    for old, new in replacements:
        assert old in text, old
        text = text.replace(old, new)
    with tempfile.TemporaryDirectory() as made:
        path = Path(made) / "rods.txt"
        path.write_text(text, encoding="utf-8")
        return read_moordyn(path, lambda _: None)


def weight_in_water(diameter: float, mass: float) -> float:
    """Of a metre of rod [N/m]."""
    return 9.81 * (mass - 1025.0 * 0.25 * math.pi * diameter**2)


def test_a_rod_with_a_hinge_rests_where_the_moments_about_it_are_none():
    said: list[str] = []
    system = of_file("rod_pinned", said)
    assert said == ["rod 1 is the stiff line 3"]
    rest = system.at_rest()
    rod = rest.x[3]
    assert rod[0] == pytest.approx([0.0, 0.0, -55.0])
    length = math.dist((0, 0, -55), (3, 1, -35.3))
    assert math.dist(rod[0], rod[-1]) == pytest.approx(length, rel=1e-3)
    # straight within a thousandth of its length
    along = (rod[-1] - rod[0]) / np.linalg.norm(rod[-1] - rod[0])
    aside = (rod - rod[0]) - np.outer((rod - rod[0]) @ along, along)
    assert np.abs(aside).max() < 1e-3 * length
    arm = rod[-1] - rod[0]
    pulls = np.zeros(3)
    for line, at, inner in ((1, -1, -2), (2, -1, -2)):
        x = rest.x[line]
        half = 0.5 * system.lines[line - 1].length / 10 * weight_in_water(0.05, 5.0)
        pulls += rest.tension[line][-1] * (x[inner] - x[at]) / np.linalg.norm(x[inner] - x[at]) - [0.0, 0.0, half]
    own = np.array([0.0, 0.0, -length * weight_in_water(0.6, 150.0)])
    moment = np.cross(arm, pulls) + np.cross(0.5 * arm, own)
    assert np.linalg.norm(moment) < 2e-3 * np.linalg.norm(np.cross(arm, pulls)) + 2e-3 * length * abs(own[2])


def test_a_rod_that_hangs_on_two_ropes_is_in_balance():
    system = of_file("rod_free")
    rest = system.at_rest()
    rod = rest.x[3]
    assert math.dist(rod[0], rod[-1]) == pytest.approx(12.0, rel=1e-3)
    vertical = rest.tension[1][-1] * (rest.x[1][-2] - rest.x[1][-1])[2] / np.linalg.norm(rest.x[1][-2] - rest.x[1][-1])
    vertical += rest.tension[2][0] * (rest.x[2][1] - rest.x[2][0])[2] / np.linalg.norm(rest.x[2][1] - rest.x[2][0])
    ropes = 0.5 * (2.4 + 3.0) * weight_in_water(0.05, 5.0)
    assert vertical == pytest.approx(12.0 * weight_in_water(0.5, 400.0) + ropes, rel=1e-3)


def test_ends_with_drag_are_left_out_with_a_line(tmp_path):
    path, said = tmp_path / "rods.txt", []
    path.write_text((RODS / "rod_free.txt").read_text("utf-8").replace("1.0 0.0 0.0\n", "1.0 0.6 1.0\n"), "utf-8")
    assert read_moordyn(path, said.append) == of_file("rod_free")
    assert said == ["rod 1 is the stiff line 3", "left out: drag and added mass of the flat ends of rods"]


def test_rods_that_turn_march_in_a_step_of_a_millisecond():
    for name in ("rod_free", "rod_pinned"):
        system = of_file(name)
        assert critical_step(system, "leapfrog") > 5e-4
    rest = system.at_rest()
    run = simulate(system, duration=0.2, frames=3, step=2e-4)
    assert run.x[3][-1] == pytest.approx(rest.x[3], abs=1e-4)


def test_a_free_body_of_rods_has_their_mass_volume_and_drag():
    system = of_file("rod_body")
    along = [point for point in system.points if point.kind == "body" and point.mass > 0.0 and point.id > 4]
    assert sum(point.mass for point in along) == pytest.approx(9.0 * 300.0, rel=1e-4)
    assert sum(point.volume for point in along) == pytest.approx(9.0 * 0.25 * math.pi * 0.8**2, rel=1e-4)
    assert sum(point.drag_area for point in along) == pytest.approx(9.0 * 0.8 * 1.2, rel=1e-4)


def test_a_rod_of_no_segments_has_no_length_but_a_direction():
    system = read_text_of("rod_clamp", ("0 0 -10 2 -", "0 0 -10 0 -"))
    (line,) = system.lines
    assert next(point for point in system.points if point.id == line.end).position == (0.0, 0.0, -8.0)
    assert line.clamp_at_end == pytest.approx((0.0, 0.0, 1.0))


REFUSED = [
    ("RODS, line 13: type", ("1 pipe Free", "1 tube Free"), "pipe"),
    ("RODS, line 13: attachment", ("1 pipe Free", "1 pipe Nailed"), "CoupledPinned"),
    ("RODS, line 13: attachment", ("1 pipe Free", "1 pipe Body3"), "a body of the file"),
    ("RODS, line 13: NumSegs", ("-25 8 -", "-25 -8 -"), "0 or above"),
    ("RODS, line 13", ("-6 0 -25 6", "-6 zero -25 6"), "finite"),
    ("ROD TYPES, line 9", ("pipe 0.5 400", "pipe 0 400"), "diameter above 0"),
    ("ROD TYPES, line 9", ("1.0 0.0 0.0\n", "1.0 0.0 0.0 5.0\n"), "linear damping"),
    ("LINES, line 22: attachment", ("1 rope 1 R1A", "1 rope 1 R7A"), "an end of a rod"),
]


@pytest.mark.parametrize(("name", "change", "words"), REFUSED)
def test_a_rod_that_is_none_is_refused(name, change, words):
    assert_refused(name, lambda: read_text_of("rod_free", change), words)


def test_a_free_body_that_would_turn_far_is_refused():
    """Two of its three ropes lead to one side of it. A body moves by linear theory, in which that has no meaning."""
    change = ("3 rope 3 R3B", "3 rope 3 R2B")
    assert_refused("body 1", lambda: read_text_of("rod_body", change), "bodies turn by small angles")
