"""Angles modulo a turn: one number for each direction, also where it was rounded."""

import math

import numpy as np
import pytest

from sim.numerics.angles import direction_of, once_around, within_half_turn, within_turn

TURN = 2.0 * math.pi


def test_a_direction_of_west_has_one_sign():
    for north in (0.0, -0.0, 1e-17, -1e-17, 3e-13, -3e-13):
        assert direction_of(-1.0, north, 1.0) == pytest.approx(math.pi)
    assert direction_of(-1.0, -1e-3, 1.0) == pytest.approx(-math.pi + 1e-3)
    assert direction_of(0.0, -2.0, 3.0) == pytest.approx(-0.5 * math.pi)
    assert math.isnan(direction_of(0.0, -0.0, 0.0))
    assert math.isnan(direction_of(3e-7, -4e-7, 1.0))
    assert direction_of(3e-6, 4e-6, 1.0) == pytest.approx(math.atan2(4.0, 3.0))


def test_whole_turns_are_0_also_if_they_were_rounded():
    whole = np.array([0.0, -0.0, -1e-17, TURN, -TURN, 3.0 * TURN, np.nextafter(TURN, 0.0), -3e-16])
    assert within_turn(whole) == pytest.approx(0.0, abs=1e-14)
    assert within_turn([-1.0, 7.0, 1e-6]) == pytest.approx([TURN - 1.0, 7.0 - TURN, 1e-6])


def test_differences_know_no_branch_cut():
    assert within_half_turn([2.0 * math.pi, 4.0, -2.0]) == pytest.approx([0.0, 4.0 - TURN, -2.0])
    assert abs(within_half_turn(-math.pi)) == pytest.approx(math.pi)
    assert within_half_turn(-4.0 * TURN) == 0.0


def test_directions_all_around_are_there_once_and_rise():
    for angles in (np.linspace(0.0, TURN, 13), np.linspace(-math.pi, math.pi, 13), np.float32([0.0, 3.0, TURN])):
        found, places = once_around(angles)
        assert len(found) == len(angles) - 1
        assert (np.diff(found) > 0.4).all()
        assert within_half_turn(found - angles[places]) == pytest.approx(0.0, abs=1e-6)
    found, places = once_around(np.array([4.0, 1.0, 4.0 - TURN]))
    assert found == pytest.approx([1.0, 4.0])
    assert places.tolist() == [1, 0]
