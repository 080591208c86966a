"""Angles modulo a turn: one number for each direction, also where it was rounded."""

import math

import numpy as np
import pytest

from sim.angles import angle_from, direction_of, within_turn

TURN = 2.0 * math.pi


def test_a_direction_of_west_has_one_sign():
    for north in (0.0, -0.0, 1e-17, -1e-17, 3e-13, -3e-13):
        assert direction_of(-1.0, north) == pytest.approx(math.pi)
    assert direction_of(-1.0, -1e-3) == pytest.approx(-math.pi + 1e-3)
    assert direction_of(0.0, -2.0) == pytest.approx(-0.5 * math.pi)
    assert math.isnan(direction_of(0.0, -0.0))


def test_whole_turns_are_0_also_if_they_were_rounded():
    whole = np.array([0.0, -0.0, -1e-17, TURN, -TURN, 3.0 * TURN, np.nextafter(TURN, 0.0), -3e-16])
    assert within_turn(whole) == pytest.approx(0.0, abs=1e-14)
    assert within_turn([-1.0, 7.0, 1e-6]) == pytest.approx([TURN - 1.0, 7.0 - TURN, 1e-6])


def test_differences_know_no_branch_cut():
    assert angle_from([math.pi, 3.0, -3.0], -math.pi) == pytest.approx([0.0, 3.0 - math.pi, math.pi - 3.0])
    assert abs(angle_from(1.0, 1.0 + math.pi)) == pytest.approx(math.pi)
    assert angle_from(0.25, 0.25 + 4.0 * TURN) == pytest.approx(0.0, abs=1e-14)
