"""Wave forces on hulls that are turned: from each direction, from its mirror image, and as a hull turns a little."""

import math
from pathlib import Path

import numpy as np
import pytest

from sim.floating import Body, Hull, make_fleet, with_dataset
from sim.floating.linear.excitation import HEADING_TOLERANCE, WaveExcitation
from sim.ocean.radial.radial import RadialSea
from sim.waves import Waves
from tests.sim.floating.test_hydrodynamics import wedge

H, T = 1 / 60, 0.7  # [s]
BOX, BARGE = Hull.box(3.0, 1.5, 1.0), Hull.box(60.0, 16.0, 6.0)
HULLS = {"box": BOX, "cylinder": Hull.cylinder(0.9, 1.0), "sphere": Hull.sphere(0.8), "own": wedge(), "dataset": BARGE}
BARGE_FILE = Path(__file__).parents[3] / "assets" / "barge.nc"


def forces_on(hull: Hull, yaws: tuple[float, ...], bearing: float) -> np.ndarray:
    """Force and moment (yaws, 6) at unit density in waves that run towards `bearing` [rad], as the hull turns.

    The waves are about twice as long as the hull.
    """
    body, one = Body(hull, 512.5).afloat(), np.ones(1)
    fleet = make_fleet([body])
    k = math.pi / float(hull.size[0])
    sea = RadialSea(Waves(k * math.cos(bearing) * one, k * math.sin(bearing) * one, 0.1 * one, 2.5 * one))
    excitation = WaveExcitation([body], np.ones(1))
    found = []
    for yaw in yaws:
        fleet.rotation[0] = math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)
        excitation.impulses = ()  # the upward force is a rate of change, of one pose
        found.append(excitation.forces(fleet, np.zeros((1, 2)), sea.waves_at(T), T, H)[0])
    return np.array(found)


@pytest.mark.parametrize("bearing", [0.3, 1.7, 2.6])
def test_waves_from_the_mirror_image_push_to_the_other_side(bearing: float) -> None:
    one, other = forces_on(BOX, (0.0,), bearing)[0], forces_on(BOX, (0.0,), -bearing)[0]
    assert other == pytest.approx(one * [1, -1, 1, -1, 1, -1], abs=1e-6 * np.abs(one).max())
    assert abs(one[1]) > 0.1 * abs(one[0])


@pytest.mark.parametrize("name", ["box", "cylinder", "own", "dataset"])
def test_a_hull_and_waves_that_turn_together_have_turned_forces(name: str) -> None:
    """By a multiple of the spacing of the table's directions, between which it interpolates."""
    turn, bearing, hull = math.pi / 3, 0.3, HULLS[name]
    if name == "dataset":
        pytest.importorskip("xarray")
        pytest.importorskip("netCDF4")
        hull = with_dataset(hull, BARGE_FILE)
    one, other = forces_on(hull, (0.0,), bearing)[0], forces_on(hull, (turn,), bearing + turn)[0]
    c, s = math.cos(turn), math.sin(turn)
    about = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    expected = np.concatenate([about @ one[:3], about @ one[3:]])
    assert other == pytest.approx(expected, abs=1e-6 * np.abs(one).max())


@pytest.mark.parametrize("name", ["cylinder", "sphere"])
def test_a_round_hull_that_turns_has_the_same_forces(name: str) -> None:
    found = forces_on(HULLS[name], (0.0, 0.7, 2.0), 0.3)
    assert np.array_equal(found, found[[0, 0, 0]])


def test_forces_are_those_of_another_heading_from_the_tolerance_on() -> None:
    first, within, beyond = forces_on(BOX, (0.5, 0.5 + 0.9 * HEADING_TOLERANCE, 0.5 + 1.1 * HEADING_TOLERANCE), 0.3)
    assert np.array_equal(within, first)
    assert np.abs(beyond - first).max() > 1e-3 * np.abs(first).max()
    assert beyond == pytest.approx(forces_on(BOX, (0.5 + 1.1 * HEADING_TOLERANCE,), 0.3)[0])
