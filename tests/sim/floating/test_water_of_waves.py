"""A body feels the waves of its water: by their length, and for many headings at once. Approximations are announced."""

import math
import warnings

import numpy as np
import pytest

from sim.floating import Body, Hull, float_in, heave_period, linear_forces, make_fleet, response_amplitude, roll_period
from sim.floating.linear import response
from sim.floating.linear.hydrodynamics import waterplane_of
from sim.mooring import moored
from sim.ocean import Sea
from sim.validation import ApproximationWarning
from sim.water import Water
from sim.waves import Waves
from tests.refusals import assert_refused

DEPTHS = (math.inf, 50.0, 20.0, 8.0, 4.0)  # [m]
PERIOD = 12.0  # [s]
OMEGA = 2.0 * math.pi / PERIOD
SMALL = Body(Hull.box(0.3, 0.2, 0.1), density=512.5)
BARGE = Body(Hull.box(20.0, 8.0, 4.0), density=512.5)


def waves(depth: float, headings: np.ndarray) -> Waves:
    water = Water(depth)
    k = float(water.wavenumber(np.array(OMEGA)))
    one = np.ones_like(headings)
    return Waves(k * np.cos(headings), k * np.sin(headings), one, 0.0 * one, water=water)


def motion(body: Body, depth: float, headings: np.ndarray) -> np.ndarray:
    """Motion (headings, 6) of a moored body without lines, in waves of 1 m."""
    m = moored(1, body, OMEGA, waves(depth, headings))
    D = m.stiffness - OMEGA**2 * m.mass - 1j * OMEGA * m.damping
    return np.linalg.solve(D, m.excitation.T).T


@pytest.mark.parametrize("depth", DEPTHS)
def test_a_small_body_surges_and_sways_as_the_water_of_any_depth(depth: float) -> None:
    headings = np.array([0.0, 0.5, 1.3, 2.5, -2.0])
    found, k = motion(SMALL, depth, headings), waves(depth, headings).k[0]
    along = 1.0 / math.tanh(min(k * depth, 300.0))
    assert np.abs(found[:, 0]) == pytest.approx(along * np.abs(np.cos(headings)), rel=5e-3)
    assert np.abs(found[1:, 1]) == pytest.approx(along * np.abs(np.sin(headings[1:])), rel=5e-3)
    assert np.abs(found[:, 2]) == pytest.approx(1.0, rel=5e-3)


@pytest.mark.parametrize("depth", DEPTHS)
@pytest.mark.parametrize("is_moored", [True, False])
def test_a_free_body_surges_sways_and_yaws_by_coth_in_waves_of_one_length(depth: float, is_moored: bool) -> None:
    """Over its motion in deep water, where it yaws as a body of its shape does (Capytaine's in test_long_waves)."""
    headings = np.array([0.3, 0.9, 2.0, -2.0])
    k = waves(depth, headings).k[0]
    deep = response_amplitude(SMALL, math.sqrt(9.81 * k), headings)
    free = response_amplitude(SMALL, OMEGA, headings, water=Water(depth))
    found = motion(SMALL, depth, headings) if is_moored else free
    along = 1.0 / math.tanh(min(k * depth, 300.0))
    for level in (0, 1, 5):
        assert np.abs(deep[:, level]).min() > 0.02 * k  # not a ratio of two zeros
        assert np.abs(found[:, level]) == pytest.approx(along * np.abs(deep[:, level]), rel=5e-3), level


@pytest.mark.parametrize("depth", DEPTHS)
def test_level_motions_are_those_of_deep_water_in_waves_of_the_same_length_times_coth(depth: float) -> None:
    """Surge, sway and yaw of waves of one length: the force is that of the length, the acceleration that of time."""
    headings = np.array([0.3, 0.9, 2.0])
    k = waves(depth, headings).k[0]
    deep = math.sqrt(9.81 * k)
    found = linear_forces(BARGE, OMEGA, headings, water=Water(depth)).excitation
    same_length = linear_forces(BARGE, deep, headings).excitation
    for level in (0, 1, 5):
        assert found[:, level] == pytest.approx(same_length[:, level], rel=1e-6), level
    # Water whose vertical acceleration is smaller pushes heave less against its stiffness.
    slower = same_length[:, 2].real - found[:, 2].real
    lift = 1025.0 * 9.81 * (k - OMEGA**2 / 9.81)
    assert (slower <= 1e-9).all()
    assert np.abs(slower).max() <= 2.0 * lift * (20.0 * 8.0 * 2.0 + 20.0 * 8.0**2)


def test_the_free_response_takes_the_depth_too() -> None:
    found = response_amplitude(SMALL, OMEGA, 0.0, water=Water(8.0))
    k = float(Water(8.0).wavenumber(np.array(OMEGA)))
    assert abs(found[0]) == pytest.approx(1.0 / math.tanh(8.0 * k), rel=5e-3)
    assert_refused("water", lambda: response_amplitude(SMALL, OMEGA, water=8.0), "a Water")  # type: ignore[arg-type]
    fresh = Water(8.0, density=1000.0)
    listed = response_amplitude(SMALL, OMEGA, 0.0, ((1000.0, math.inf),), fresh)
    np.testing.assert_array_equal(response_amplitude(SMALL, OMEGA, water=fresh), listed)


def test_arrays_of_headings_and_frequencies_are_each_of_them_alone() -> None:
    frequencies, headings = np.array([0.3, 0.7, 1.1, 1.9]), np.array([0.0, 0.4, -1.2, 3.1, 5.0])
    table = response_amplitude(BARGE, frequencies[:, None], headings, water=Water(30.0))
    assert table.shape == (4, 5, 6)
    for i, w in enumerate(frequencies):
        for j, heading in enumerate(headings):
            alone = response_amplitude(BARGE, float(w), float(heading), water=Water(30.0))
            assert table[i, j] == pytest.approx(alone, rel=1e-9, abs=1e-12)
    pairs = linear_forces(BARGE, frequencies, headings[:4])
    assert pairs.excitation.shape == (4, 6)
    assert pairs.added.shape == (4, 6, 6)
    assert_refused("heading", lambda: linear_forces(BARGE, frequencies, headings), "(4,)")
    assert_refused("heading", lambda: linear_forces(BARGE, frequencies, [0.0, 90.0, 0.0, 0.0]), "2 pi")


def test_a_moored_body_is_computed_once_for_all_headings(monkeypatch) -> None:
    count = 0
    whole = response.linear_hull

    def counted(*arguments):
        nonlocal count
        count += 1
        return whole(*arguments)

    monkeypatch.setattr(response, "linear_hull", counted)
    headings = np.linspace(0.0, 6.0, 80)
    found = moored(1, BARGE, OMEGA, waves(20.0, headings))
    assert count == 1
    alone = moored(1, BARGE, OMEGA, waves(20.0, headings[33:34]))
    assert found.excitation[33] == pytest.approx(alone.excitation[0], rel=1e-12)


def test_a_hull_below_the_bed_is_refused() -> None:
    body = Body(Hull.box(6.0, 4.0, 3.0), density=700.0)  # of a draft of 2.05 m
    words = "a hull of draft 2.04878 m, in water 1.2 m deep"
    sea = Sea(32, 60.0, "regular", wave_height=0.05, wave_period=6.0, wind_speed=0.0, depth=1.2)
    assert_refused("bodies[0]", lambda: float_in(sea, [body], 0.1, frames=2), words)
    assert_refused("water", lambda: moored(1, body, 1.0, water=Water(1.2)), words)
    assert_refused("water", lambda: response_amplitude(body, 1.0, water=Water(1.2)), words)


def catamaran(gap: float = 12.0, bridge: bool = False) -> Hull:
    """Two hulls of 20 m by 2 m by 6 m, under a deck that joins them if there is a bridge."""
    trimesh = pytest.importorskip("trimesh")
    boxes = []
    for side in (-0.5, 0.5):
        boxes.append(trimesh.creation.box((20.0, 2.0, 6.0)))
        boxes[-1].apply_translation((0.0, side * gap, 0.0))
    if bridge:
        boxes = [trimesh.creation.box((20.0, gap, 6.0))]
    mesh = trimesh.util.concatenate(boxes)
    return Hull.from_arrays(mesh.vertices, mesh.faces)


@pytest.mark.parametrize("use", [
    lambda hull: heave_period(hull, 683.0),
    lambda hull: roll_period(hull, 683.0),
    lambda hull: response_amplitude(Body(hull, 683.0), 1.0),
    lambda hull: moored(1, Body(hull, 683.0), 1.0),
    lambda hull: float_in(Sea(32, 60.0), [Body(hull, 683.0)], 0.1, frames=2),
])  # fmt: skip
def test_a_catamaran_has_no_coefficients_of_a_box(use) -> None:
    with pytest.raises(ValueError, match=r"2 parts at the waterline.*springtide hydrodynamics"):
        use(catamaran())


def test_the_parts_and_extents_of_a_waterplane_are_those_of_the_mesh() -> None:
    assert waterplane_of(catamaran(), 4.0) == (2, pytest.approx((20.0, 14.0)))
    assert waterplane_of(catamaran(bridge=True), 2.5) == (1, pytest.approx((20.0, 12.0)))
    trimesh = pytest.importorskip("trimesh")
    ring = trimesh.creation.annulus(r_min=3.0, r_max=5.0, height=2.0)
    assert waterplane_of(Hull.from_arrays(ring.vertices, ring.faces), 0.9) == (1, pytest.approx((10.0, 10.0), rel=1e-2))
    assert waterplane_of(prism(), 1.0) == (1, pytest.approx((11.0, 3.5)))


def test_a_hull_far_from_its_box_is_refused_with_both_sizes() -> None:
    cone = np.array([[3.0, 0.0, 2.0], [0.0, 3.0, 2.0], [-3.0, 0.0, 2.0], [0.0, -3.0, 2.0], [0.0, 0.0, -2.0]])
    hull = Hull.from_arrays(cone, np.array([[0, 1, 2], [0, 2, 3], [1, 0, 4], [2, 1, 4], [3, 2, 4], [0, 3, 4]]))
    with pytest.raises(ValueError, match=r"a draft of .* m, and the box with its volume and waterplane .* m"):
        heave_period(hull, 700.0)
    assert np.isfinite(heave_period(prism(), 500.0))


def prism() -> Hull:
    """A hull from a mesh: a deck of 12 m by 4 m over a bottom of 10 m by 3 m."""
    deck = np.array([[-6.0, -2.0, 1.0], [6.0, -2.0, 1.0], [6.0, 2.0, 1.0], [-6.0, 2.0, 1.0]])
    bottom = deck * [10.0 / 12.0, 3.0 / 4.0, -1.0]
    faces = [[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6]]
    for i in range(4):
        j = (i + 1) % 4
        faces += [[i, 4 + i, j], [j, 4 + i, 4 + j]]
    return Hull.from_arrays(np.concatenate([deck, bottom]), np.array(faces))


@pytest.mark.parametrize("use", [
    lambda hull: heave_period(hull, 500.0),
    lambda hull: response_amplitude(Body(hull, 500.0), 1.0),
    lambda hull: make_fleet([Body(hull, 500.0)]),
    lambda hull: moored(1, Body(hull, 500.0), 1.0),
])  # fmt: skip
def test_a_hull_from_a_mesh_says_each_time_that_it_has_the_coefficients_of_a_box(use) -> None:
    hull = prism()
    for _ in range(2):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            use(hull)
        (one,) = [w for w in caught if w.category is ApproximationWarning]
        assert "are those of a box 11" in str(one.message)
        assert "springtide hydrodynamics" in str(one.message)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        use(Hull.box(12.0, 4.0, 2.0))
