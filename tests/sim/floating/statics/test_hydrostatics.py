"""Submerged volume, centre of buoyancy, waterplane and pressure in any pose, against slicing and closed forms."""

import math
from typing import Any

import numpy as np
import pytest

from sim.floating import Hull, pressure_force, submerged
from sim.floating.motion.rotation import rotation_matrix
from sim.floating.shapes.sphere import geodesic
from tests.naive_floating import lumpy, pressure_by_points, quaternion, sliced


def random_case(seed):
    """A hull, a pose that cuts the surface, and the height of a tilted or bumpy surface above each vertex."""
    rng = np.random.default_rng(seed)
    vertices, faces = geodesic(2)
    hull = [
        Hull.box(*rng.uniform(0.1, 3.0, 3)),
        Hull.sphere(rng.uniform(0.1, 2.0), frequency=3),
        Hull.cylinder(rng.uniform(0.1, 1.0), rng.uniform(0.1, 3.0)),
        Hull.from_arrays(lumpy(rng, vertices), faces),
    ][seed % 4]
    rotation = quaternion(rng)
    size = np.abs(hull.vertices).max()
    position = np.array([*rng.uniform(-5, 5, 2), rng.uniform(-1, 1) * size])
    place = hull.vertices @ rotation_matrix(rotation).T + position
    heights = (place[:, :2] - position[:2]) @ rng.normal(0, 0.3, 2)
    if seed % 2:
        heights += rng.normal(0, 0.05 * size, len(heights))
    return hull, position, rotation, place, heights


def seeds(start: int, end: int) -> list[Any]:
    """Seeds of random hulls; a plain run takes every other one."""
    return [pytest.param(seed, marks=pytest.mark.long if seed % 2 else ()) for seed in range(start, end)]


@pytest.mark.parametrize("seed", seeds(0, 60))
def test_volume_and_centre_match_slicing(seed):
    hull, position, rotation, place, heights = random_case(seed)
    below = submerged(hull, position, rotation, heights)
    volume, moment, area = sliced(place, hull.faces, heights - place[:, 2])
    size = hull.volume ** (1 / 3)
    assert below.volume == pytest.approx(volume, abs=1e-9 * hull.volume)
    assert below.area == pytest.approx(area, abs=1e-6 * size**2)
    if volume > 1e-6 * hull.volume:
        assert volume * (below.centre - moment / volume)[:2] == pytest.approx(0, abs=1e-9 * hull.volume * size)


@pytest.mark.parametrize("seed", seeds(100, 140))
def test_centre_of_buoyancy_under_a_level_surface_matches_slicing(seed):
    hull, position, rotation, place, _ = random_case(seed)
    below = submerged(hull, position, rotation, surface=0.1)
    volume, moment, _ = sliced(place, hull.faces, 0.1 - place[:, 2])
    assert below.volume == pytest.approx(volume, abs=1e-9 * hull.volume)
    if volume > 1e-6 * hull.volume:
        expected = moment / volume + [0, 0, 0.1]
        assert volume * (below.centre - expected) == pytest.approx(0, abs=1e-9 * hull.volume)


@pytest.mark.parametrize("seed", range(0, 60, 2))
def test_pressure_is_the_weight_displaced_at_the_centre_of_buoyancy(seed):
    """Under a plane of slope s the force of d g rho is rho g V (-s, 1), through the centre of buoyancy."""
    hull, position, rotation, place, heights = random_case(seed)
    slope = np.linalg.lstsq(place[:, :2] - position[:2], heights, rcond=None)[0]
    below = submerged(hull, position, rotation, heights)
    force, moment = pressure_force(hull, position, rotation, heights, density=1000.0, gravity=10.0)
    lift = 1e4 * below.volume * np.array([-slope[0], -slope[1], 1.0])
    scale = 1e4 * hull.volume
    assert force == pytest.approx(lift, abs=1e-10 * scale)
    if below.volume > 1e-6 * hull.volume:
        expected = np.cross(below.centre - position, lift)
        assert moment == pytest.approx(expected, abs=1e-9 * scale * np.abs(hull.vertices).max())


@pytest.mark.parametrize("seed", range(1, 16, 2))
def test_pressure_under_a_bumpy_surface_matches_point_sums(seed):
    hull, position, rotation, place, heights = random_case(seed)
    force, moment = pressure_force(hull, position, rotation, heights, density=1.0, gravity=1.0)
    sum_force, sum_moment = pressure_by_points(place - position, hull.faces, heights - place[:, 2], 60)
    size = hull.volume ** (1 / 3)
    reach = np.abs(hull.vertices).max()
    assert force == pytest.approx(-sum_force, abs=1e-3 * reach * size**2)
    assert moment == pytest.approx(-sum_moment, abs=1e-3 * reach**2 * size**2)


@pytest.mark.parametrize(("frequency", "error"), [(5, 4e-4), (8, 1.5e-4)])
def test_a_sphere_of_triangles_floats_where_the_sphere_does(frequency, error):
    """Cap volume against the mesh in 1000 poses, as a difference of height on the true waterplane, over the radius."""
    rng, hull = np.random.default_rng(0), Hull.sphere(1.0, frequency)
    for _ in range(1000):
        z = rng.uniform(-0.8, 0.8)
        below = submerged(hull, (0, 0, z), quaternion(rng))
        h = 1 - z
        assert abs(below.volume - math.pi * h * h * (3 - h) / 3) / (math.pi * h * (2 - h)) < error


def test_a_wholly_submerged_hull_feels_archimedes_and_no_waterplane():
    hull = Hull.cylinder(0.3, 1.0)
    below = submerged(hull, (0.0, 0.0, -5.0), (0.3, 0.1, 0.9, 0.2))
    assert below.volume == pytest.approx(hull.volume, rel=1e-12)
    assert below.centre == pytest.approx([0, 0, -5], abs=1e-12)
    assert below.area == pytest.approx(0, abs=1e-12)
    force, moment = pressure_force(hull, (0.0, 0.0, -5.0), (0.3, 0.1, 0.9, 0.2))
    assert force == pytest.approx([0, 0, 1025 * 9.81 * hull.volume], abs=1e-8)
    assert moment == pytest.approx(np.zeros(3), abs=1e-8)


def test_a_hull_in_the_air_feels_nothing():
    below = submerged(Hull.sphere(0.5), (0.0, 0.0, 2.0))
    assert below.volume == 0
    assert below.area == 0
    assert np.isnan(below.centre).all()


def test_a_box_with_its_bottom_in_the_surface_is_dry_and_its_top_wet():
    box = Hull.box(1.0, 1.0, 1.0)
    assert submerged(box, (0, 0, 0.5)).volume == 0
    assert submerged(box, (0, 0, -0.5)).volume == pytest.approx(1.0)


def test_waterplane_moments_of_a_floating_box_are_its_rectangle():
    below = submerged(Hull.box(2.0, 1.0, 0.5), (3.0, -4.0, 0.1))
    assert below.area == pytest.approx(2.0)
    assert below.second == pytest.approx([8 / 12, 2 / 12, 0], abs=1e-13)
