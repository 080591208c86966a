"""The strain of a cloth's structural links."""

import numpy as np
import pytest

from sim.springs import cloth
from sim.springs.analysis.strain import structural_strain


def test_a_cloth_at_its_rest_lengths_has_no_strain():
    net = cloth(4, 5, width=0.7, length=1.1)
    assert structural_strain(net, net.x0) == pytest.approx(np.zeros((4, 5)), abs=1e-14)


def test_stretch_along_either_axis_is_the_strain_everywhere():
    net = cloth(4, 5)
    for axis in (0, 1):
        x = net.x0.copy()
        x[axis] *= 1.25
        assert structural_strain(net, x) == pytest.approx(np.full((4, 5), 0.25), rel=1e-12)


def test_a_moved_particle_strains_itself_and_its_four_neighbours_only():
    net = cloth(5, 5)
    x = net.x0.copy()
    x[2, 2, 2] += 0.1
    strain = structural_strain(net, x)
    expected = np.hypot(0.25, 0.1) / 0.25 - 1.0
    assert {tuple(at) for at in np.argwhere(strain > 1e-12)} == {(2, 2), (1, 2), (3, 2), (2, 1), (2, 3)}
    assert strain[2, 2] == pytest.approx(expected, rel=1e-12)
