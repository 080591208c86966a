"""Drafts by Archimedes through one and two fluids, and the periods of heave and roll there."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from sim.floating import Body, Hull, equilibrium_draft, heave_period, make_fleet, roll_period, step, still_water
from sim.floating.linear.periods import heave_period_at
from sim.floating.statics.equilibrium import upright
from sim.floating.statics.prediction import predict

WATER = [(1025.0, math.inf)]
SPILL = [(850.0, 0.2), (1025.0, math.inf)]
THICK = [(850.0, 5.0), (1025.0, math.inf)]


def as_mesh(hull):
    return Hull.from_arrays(hull.vertices, hull.faces)


def prism_draft(density, height, upper, thickness, lower):
    """Draft of a prism in oil on water, by Archimedes: it floats in the oil only, or reaches into the water."""
    if density * height <= upper * thickness:
        return density * height / upper
    return thickness + (density * height - upper * thickness) / lower


def test_the_reference_box_sinks_by_the_published_numbers():
    box = Hull.box(1.0, 1.0, 1.0)
    assert equilibrium_draft(box, 500.0, WATER) == pytest.approx(0.4878, abs=5e-5)
    assert equilibrium_draft(box, 500.0, SPILL) == pytest.approx(0.5220, abs=5e-5)
    assert equilibrium_draft(box, 500.0, THICK) == pytest.approx(0.5882, abs=5e-5)
    extra = equilibrium_draft(box, 500.0, SPILL) - equilibrium_draft(box, 500.0, WATER)
    assert extra == pytest.approx(0.2 * (1 - 850 / 1025), abs=1e-12)


@pytest.mark.parametrize("make", [lambda: Hull.box(1.3, 0.7, 0.9), lambda: Hull.cylinder(0.4, 0.9)])
@pytest.mark.parametrize("mesh", [False, True])
@pytest.mark.parametrize("density", [20.0, 120.0, 500.0, 840.0])
@pytest.mark.parametrize("thickness", [0.0, 0.05, 0.2, 0.6])
def test_prisms_float_at_the_closed_form(make, mesh, density, thickness):
    hull = as_mesh(make()) if mesh else make()
    layers = [(850.0, thickness), (1025.0, math.inf)]
    expected = prism_draft(density, 0.9, 850.0, thickness, 1025.0)
    assert equilibrium_draft(hull, density, layers) == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("density", [10.0, 300.0, 512.5, 800.0, 1000.0])
@pytest.mark.parametrize("thickness", [0.0, 0.1, 0.4, 3.0])
def test_spheres_float_where_their_caps_weigh_as_much(density, thickness):
    r = 0.5

    def cap(h):
        h = min(max(h, 0.0), 2 * r)
        return math.pi * h * h * (3 * r - h) / 3

    def excess(h):
        return 850 * (cap(h) - cap(h - thickness)) + 1025 * cap(h - thickness) - density * 4 / 3 * math.pi * r**3

    expected = brentq(excess, 0.0, thickness + 2 * r, xtol=1e-13)
    found = equilibrium_draft(Hull.sphere(r), density, [(850.0, thickness), (1025.0, math.inf)])
    assert found == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("density", [100.0, 700.0])
def test_a_cone_floats_at_the_cube_root(density):
    """A pyramid on its tip, V(h) = V (h/H)^3, as a mesh file would give it."""
    base = np.array([[-1, -1, 2], [1, -1, 2], [1, 1, 2], [-1, 1, 2], [0, 0, 0]], dtype=float)
    faces = np.array([[4, 1, 0], [4, 2, 1], [4, 3, 2], [4, 0, 3], [0, 1, 2], [0, 2, 3]])
    draft = equilibrium_draft(Hull.from_arrays(base, faces), density, WATER)
    assert draft == pytest.approx(2 * (density / 1025) ** (1 / 3), abs=1e-9)


def test_a_mesh_of_a_sphere_approaches_the_sphere():
    errors = []
    for frequency in (4, 8, 16):
        mesh = as_mesh(Hull.sphere(0.5, frequency))
        lowest = -mesh.extents[2, 0]  # the mesh's own lowest point is a little below the sphere's
        errors.append(
            abs(
                equilibrium_draft(mesh, 300.0, SPILL) - lowest + 0.5 - equilibrium_draft(Hull.sphere(0.5), 300.0, SPILL)
            )
        )
    assert errors[0] < 2e-4
    assert errors[2] < 1e-5


def test_between_the_densities_a_body_rests_on_the_interface():
    draft = equilibrium_draft(Hull.box(1.0, 1.0, 1.0), 900.0, THICK)
    assert draft == pytest.approx(5.0 + 50 / 175, abs=1e-12)  # 850 (1 - s) + 1025 s = 900


def test_what_is_denser_than_the_last_layer_sinks():
    assert equilibrium_draft(Hull.sphere(0.5), 1025.1, SPILL) == math.inf
    assert heave_period(Hull.sphere(0.5), 2000.0, SPILL) == math.inf
    assert roll_period(Hull.sphere(0.5), 2000.0, SPILL) == math.inf
    assert equilibrium_draft(Hull.box(1.0, 1.0, 1.0), 1025.0, WATER) == pytest.approx(1.0, abs=1e-12)


def test_three_layers_add_up():
    layers = [(700.0, 0.1), (850.0, 0.2), (1025.0, math.inf)]
    expected = 0.3 + (600 - 0.1 * 700 - 0.2 * 850) / 1025
    assert equilibrium_draft(Hull.box(1.0, 1.0, 1.0), 600.0, layers) == pytest.approx(expected, abs=1e-12)


def test_gravity_does_not_change_the_draft():
    drafts = {equilibrium_draft(Hull.sphere(0.5), 300.0, SPILL, gravity=g) for g in (0.1, 9.81, 981.0)}
    assert len(drafts) == 1


def test_heave_periods_match_the_published_numbers():
    hemisphere = (Hull.sphere(0.5), 512.5, WATER)
    # Hulme 1982: A33 is 0.42 of the mass at kR = 1.05, where this hemisphere oscillates
    assert heave_period(*hemisphere) == pytest.approx(2 * math.pi * math.sqrt(1.42 * 2 * 0.5 / 3 / 9.81), rel=5e-3)
    assert heave_period(*hemisphere, added=0.0) == pytest.approx(1.158, abs=1e-3)
    buoy = (Hull.cylinder(0.5, 4.0), 512.5, WATER)
    assert heave_period(*buoy, added=0.0) == pytest.approx(2.837, abs=1e-3)
    assert 2.984 < heave_period(*buoy) < 1.03 * 2.984  # with that of a disc of no thickness: 2.984 s


def test_roll_period_of_a_raft_is_that_of_its_metacentric_height():
    x, y, z, density = 3.0, 2.0, 0.5, 400.0
    draft = density * z / 1025
    gm = draft / 2 - z / 2 + y**2 / (12 * draft)
    inertia = (y**2 + z**2) / 12
    expected = 2 * math.pi * math.sqrt(inertia / (9.81 * gm))
    assert roll_period(Hull.box(x, y, z), density, WATER, added=0.0) == pytest.approx(expected, rel=1e-9)
    gm = draft / 2 - z / 2 + x**2 / (12 * draft)
    expected = 2 * math.pi * math.sqrt((x**2 + z**2) / 12 / (9.81 * gm))
    assert roll_period(Hull.box(x, y, z), density, WATER, added=0.0, axis=1) == pytest.approx(expected, rel=1e-9)


def test_a_half_dense_cube_is_not_stable_upright():
    assert roll_period(Hull.box(1.0, 1.0, 1.0), 512.5, WATER) == math.inf


@pytest.mark.parametrize("height", [-0.1, 0.0, 0.1, 0.5, 0.8, 1.0, 1.2])
def test_closed_forms_of_the_primitives_match_their_fine_meshes(height):
    for hull in (Hull.box(1.0, 0.6, 1.0), Hull.cylinder(0.5, 1.0), Hull.sphere(0.5, 40)):
        exact, fine = upright(hull, height), upright(as_mesh(hull), height)
        assert exact.volume == pytest.approx(fine.volume, abs=1e-4)
        if 0.2 < height < 0.9:
            assert exact.area == pytest.approx(fine.area, abs=2e-3)
            assert exact.centre == pytest.approx(fine.centre, abs=1e-3)
            assert exact.second == pytest.approx(fine.second, abs=1e-3)


def test_the_prediction_of_a_scene_is_that_of_the_functions():
    box = Hull.box(2.0, 1.5, 0.8)
    found = predict(box, 500.0, SPILL, 1000.0)
    assert found.height == pytest.approx(0.8, rel=1e-12)
    assert found.draft == pytest.approx(prism_draft(500.0, 0.8, 850.0, 0.2, 1025.0), rel=1e-6)
    assert found.draft_in_water == pytest.approx(0.4, rel=1e-6)
    assert found.period == heave_period_at(box, 500.0, SPILL, found.draft)


def test_every_default_fluid_is_sea_water():
    """A half-dense cube has one draft and one period, whether or not its fluid is named."""
    cube, raft = Hull.box(1.0, 1.0, 1.0), Hull.box(2.0, 2.0, 0.5)
    assert equilibrium_draft(cube, 500.0) == pytest.approx(500 / 1025, abs=1e-12)
    assert heave_period(cube, 500.0) == heave_period(cube, 500.0, WATER)
    assert roll_period(raft, 500.0) == roll_period(raft, 500.0, WATER) < math.inf
    fleet = make_fleet([Body(cube, 500.0, (0.0, 0.0, 0.5 - 500 / 1025))])
    for named, default in zip(still_water(fleet, WATER), still_water(fleet), strict=True):
        assert np.array_equal(named, default)
    step(fleet, still_water(fleet), 1 / 60)
    assert fleet.position[0, 2] == pytest.approx(0.5 - 500 / 1025, abs=1e-12)
