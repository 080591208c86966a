"""Added masses against Lamb's closed forms and tables."""

import math

import numpy as np
import pytest
from scipy.special import elliprd

from sim.floating import Hull
from sim.floating.added_mass import carlson_rd, ellipsoid, plate


def test_carlson_matches_scipy():
    rng = np.random.default_rng(0)
    for x, y, z in 10 ** rng.uniform(-6, 6, (200, 3)):
        assert carlson_rd(x, y, z) == pytest.approx(float(elliprd(x, y, z)), rel=1e-10)


def test_ellipsoid_tends_to_sphere_and_disc():
    along, about = ellipsoid(np.ones(3))
    assert along == pytest.approx(2 / 3 * math.pi * np.ones(3), rel=1e-10)
    assert about == pytest.approx(np.zeros(3), abs=1e-12)
    along, about = ellipsoid(np.array([1.0, 1.0, 1e-7]))
    assert along[2] == pytest.approx(8 / 3, rel=1e-6)
    assert about == pytest.approx([16 / 45, 16 / 45, 0], rel=1e-6)


@pytest.mark.parametrize(("ratio", "k1", "k2", "k3"), [(2.00, 0.209, 0.702, 0.240), (3.99, 0.082, 0.860, 0.608)])
def test_prolate_spheroids_match_lambs_table(ratio, k1, k2, k3):
    """Lamb Art. 115: coefficients of the fluid displaced, and of its inertia V (a^2 + b^2)/5."""
    along, about = ellipsoid(np.array([ratio, 1.0, 1.0]))
    volume = 4 / 3 * math.pi * ratio
    assert along / volume == pytest.approx([k1, k2, k2], abs=3e-3)  # the table's last digit is not always right
    e = math.sqrt(1 - 1 / ratio**2)  # Lamb Art. 114, eq. 6 and 7
    alpha = 2 * (1 - e * e) / e**3 * (math.atanh(e) - e)
    beta = 1 / e**2 - (1 - e * e) / e**3 * math.atanh(e)
    assert along / volume == pytest.approx([alpha / (2 - alpha), beta / (2 - beta), beta / (2 - beta)], rel=1e-9)
    assert about == pytest.approx(volume * (ratio**2 + 1) / 5 * np.array([0, k3, k3]), rel=3e-3)


def test_primitives_have_their_closed_forms():
    assert Hull.sphere(0.5).added_mass()[0] == pytest.approx(math.pi / 12 * np.ones(3))
    along, about = Hull.cylinder(0.5, 2.0).added_mass()
    assert along == pytest.approx([math.pi / 2, math.pi / 2, 1 / 3])
    assert about[2] == 0
    assert Hull.box(1.0, 2.0, 1.0).added_mass()[0] == pytest.approx(
        [0.757 * math.pi / 2, 0.579 * math.pi / 4, 0.757 * math.pi / 2]
    )


def test_a_long_plate_tends_to_the_two_dimensional_value():
    assert plate(1.0, 1000.0) == pytest.approx(math.pi / 4 * 1000, rel=1e-3)
    assert plate(1.0, 10.0 + 1e-9) == pytest.approx(plate(1.0, 10.0), rel=1e-6)


def test_a_mesh_of_a_sphere_is_a_sphere():
    sphere = Hull.sphere(0.7, frequency=6)
    along, about = Hull.from_arrays(sphere.vertices, sphere.faces).added_mass()
    assert along == pytest.approx(sphere.volume / 2 * np.ones(3), rel=1e-6)
    assert about == pytest.approx(np.zeros(3), abs=1e-9)


def test_an_ellipsoid_mesh_is_its_ellipsoid():
    sphere = Hull.sphere(1.0, frequency=12)
    axes = np.array([2.0, 1.0, 0.5])
    along, about = Hull.from_arrays(sphere.vertices * axes, sphere.faces).added_mass()
    assert along == pytest.approx(ellipsoid(axes)[0], rel=1e-4)
    assert about == pytest.approx(ellipsoid(axes)[1], rel=1e-3)
