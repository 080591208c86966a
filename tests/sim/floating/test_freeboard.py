"""Hulls with their deck near the waterline: linear theory is that of the water just below it."""

import math
from pathlib import Path

import numpy as np
import pytest

from sim.floating import Body, Hull, heave_period, metacentric_height, response_amplitude, righting_arm, with_dataset
from sim.floating.hulls.closed_mesh import area_vectors
from sim.floating.linear.hydrodynamics import linear_hull, plane_force
from sim.floating.linear.response import linear_forces
from sim.floating.statics.hydrostatics import add_pressure

pytest.importorskip("xarray")
pytest.importorskip("netCDF4")
BARGE = Path(__file__).parents[3] / "assets" / "barge.nc"
MASS = 2.952e6  # [kg], at which the draft of the barge is 3 m
INERTIA = (8e7, 9e8, 9e8)  # [kg m2]
HEIGHTS = [3.3, 3.03, 3.003, 3.0003, 3.0 + 1e-8]


def barge(height: float, with_table: bool = True) -> Body:
    """A barge of one load, with a deck at this height [m] over its keel."""
    hull = Hull.box(60.0, 16.0, height)
    if with_table:
        hull = with_dataset(hull, BARGE)
    return Body(hull, mass=MASS, center_of_gravity=(0.0, 0.0, 2.5 - height / 2.0), inertia=INERTIA)


@pytest.mark.parametrize("with_table", [True, False])
@pytest.mark.parametrize("height", HEIGHTS)
def test_freeboard_changes_no_term_of_the_response(height, with_table):
    omega = [0.3, 0.5, 1.0, 1.5]
    low, high = (linear_forces(barge(one, with_table), omega, 0.7) for one in (height, 6.0))
    for name in ("mass", "stiffness", "added", "damping", "excitation"):
        given, expected = getattr(low, name), getattr(high, name)
        assert given == pytest.approx(expected, rel=1e-7, abs=1e-7 * np.abs(expected).max()), name
    one, other = (response_amplitude(barge(h, with_table), omega, 0.7) for h in (height, 6.0))
    assert np.abs(one - other).max() < 1e-6 * np.abs(other).max()


@pytest.mark.parametrize("height", HEIGHTS)
def test_metacentric_height_and_heave_are_those_of_the_waterplane(height):
    ship = barge(height)
    assert metacentric_height(ship) == pytest.approx(1.5 + 16.0**2 / (12.0 * 3.0) - 2.5, rel=1e-9)
    assert metacentric_height(ship, axis=1) == pytest.approx(1.5 + 60.0**2 / (12.0 * 3.0) - 2.5, rel=1e-9)
    assert heave_period(*ship.loaded()) == pytest.approx(heave_period(*barge(6.0).loaded()), rel=1e-7)
    tilt = 1e-4 * (height - 3.0) / 8.0
    if height > 3.0001:
        assert righting_arm(ship, [tilt])[0] / tilt == pytest.approx(metacentric_height(ship), rel=1e-4)


def test_the_table_s_own_draft_has_the_table_s_coefficients():
    """|X3| at 1.5 rad/s was 244.5 instead of 365.5 kN/m with 0.3 mm of freeboard, and A33 2 % too large."""
    hull = barge(3.0003).hull
    linear, table = linear_hull(hull, 3.0), hull.shape.table
    length = math.sqrt(60.0 * 16.0) / 2.0
    assert linear.added_mass[:, 2, 2] == pytest.approx(table.added_mass[0, 0, :, 2, 2] * length**3, rel=1e-12)
    assert linear.excitation[:, 0, 2] == pytest.approx(table.excitation[0, 0, :, 0, 2] * length**2, rel=1e-12)
    assert abs(linear_forces(barge(3.0003), [1.5]).excitation[0, 2]) == pytest.approx(365.5e3, rel=1e-3)


def test_a_deck_in_the_surface_is_dry():
    """A closed panel hull ends at its design draft, where a lid on the water becomes its deck."""
    ring = [(8.0 * math.cos(a), 5.0 * math.sin(a)) for a in np.linspace(0.0, 2.0 * math.pi, 24, endpoint=False)]
    vertices = np.array([(x, y, 0.0) for x, y in ring] + [(0.6 * x, 0.6 * y, -3.0) for x, y in ring] + [(0, 0, 0)])
    vertices = np.vstack((vertices, (0.0, 0.0, -3.0)))
    faces = []
    for i in range(24):
        j = (i + 1) % 24
        faces += [(i, i + 24, j), (j, i + 24, j + 24), (48, i, j), (49, j + 24, i + 24)]
    hull = Hull.from_arrays(vertices, np.array(faces))
    plane = plane_force(hull, 3.0)
    area = 24 * 0.5 * 8.0 * 5.0 * math.sin(2.0 * math.pi / 24.0)
    assert plane.rise[2] == pytest.approx(area, rel=1e-12)
    for shift in (-1e-12, 1e-12):
        assert plane_force(hull, 3.0 + shift).rise[2] == pytest.approx(area, rel=1e-9)
    assert plane_force(hull, 3.0 + 1e-3).rise[2] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_the_force_of_a_plane_is_the_change_of_the_pressure(seed):
    """Against differences of the pressure over the wet surface, of a lopsided hull away from its corners."""
    rng = np.random.default_rng(seed)
    base = np.array([(-3.0, -1.0), (-3.0, 1.0), (1.0, 1.0), (3.0, 0.0), (1.0, -1.0)])
    deck = np.column_stack((base * rng.uniform(1.0, 1.4) + (0.3, 0.1), np.full(5, 0.8)))
    faces = [(0, 2, 1), (0, 3, 2), (0, 4, 3), (5, 6, 7), (5, 7, 8), (5, 8, 9)]
    for i in range(5):
        j = (i + 1) % 5
        faces += [(i, j, i + 5), (j, j + 5, i + 5)]
    hull = Hull.from_arrays(np.vstack((deck, np.column_stack((base, np.zeros(5))))), np.array(faces))
    draft, h = 0.43, 1e-5
    x, f = np.ascontiguousarray(hull.vertices.T), np.ascontiguousarray(hull.faces.T)
    area = np.ascontiguousarray(area_vectors(hull.vertices, hull.faces).T)

    def force(change: np.ndarray) -> np.ndarray:
        out = np.zeros(9)
        add_pressure(x, f, area, 0, len(hull.faces), hull.extents[2, 0] + draft - x[2] + change, -1.0, out)
        return out[:6]

    plane = plane_force(hull, draft)
    for found, change in ((plane.rise, np.ones_like(x[0])), (plane.slope[0], x[0]), (plane.slope[1], x[1])):
        assert found == pytest.approx((force(h * change) - force(-h * change)) / (2.0 * h), abs=1e-7)
