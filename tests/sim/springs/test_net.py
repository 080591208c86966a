import dataclasses
import math

import numpy as np
import pytest
import scipy.linalg
import scipy.special

from sim.springs import Grab, cloth, lab_units, rope
from sim.springs.statics import hanging_chain


def test_a_rope_starts_at_rest_from_its_root_along_minus_x():
    net = rope(5, 2.0, root=(1.0, 2.0, 3.0))
    assert net.x0.shape == (3, 1, 5)
    assert net.x0[0, 0] == pytest.approx([1.0, 0.5, 0.0, -0.5, -1.0])
    assert (net.x0[1] == 2.0).all()
    assert (net.x0[2] == 3.0).all()
    assert net.pinned == {(0, 0)}
    assert net.families[0].rest == 0.5


def test_the_defaults_are_the_lab_s_but_for_its_gravity_of_10():
    net = rope()
    assert net.x0.shape[2] == 10
    assert (net.mass, net.drag, net.gravity) == (1.0, 1.0, (0.0, 0.0, -9.81))
    assert net.families == ((0, 1, 2.0 / 9, 800.0, 7.0),)
    assert net.damping_model == "isotropic"


def test_a_rope_of_two_ends_is_straight_between_them():
    net = rope(3, 2.0, root=(0.0, 0.0, 1.0), end=(1.0, 2.0, 3.0))
    assert net.pinned == {(0, 0), (0, 2)}
    assert net.x0[:, 0, 1] == pytest.approx([0.5, 1.0, 2.0])


def test_one_point_is_a_rope():
    assert rope(1).x0.tolist() == [[[0.0]], [[0.0]], [[0.0]]]


def test_with_stiffness_scales_all_families_so_that_the_stiffest_has_the_value():
    net = cloth(4, 4, stiffness=800.0, shear=400.0, bend=100.0)
    assert [f.stiffness for f in net.with_stiffness(80.0).families] == [80.0, 80.0, 40.0, 40.0, 10.0, 10.0]
    assert [f[:3] for f in net.with_stiffness(80.0).families] == [f[:3] for f in net.families]
    assert rope().with_stiffness(0.1).families[0].stiffness == 0.1
    slack = cloth(4, 4, stiffness=0.0, shear=0.0, bend=0.0)
    assert [f.stiffness for f in slack.with_stiffness(5.0).families] == [5.0] * 6


def test_numpy_numbers_are_numbers():
    net = rope(np.int64(4), np.float32(2.0), mass=np.int32(1))
    assert net.x0.shape == (3, 1, 4)
    assert isinstance(net.mass, float)


def test_in_lab_units_a_rope_stretches_with_its_points_and_in_material_units_it_does_not():
    """The lab's trap: ten points hang 2.56 m deep, fifty 17.3 m, of the same 2 m rope (its gravity is 10 m/s2)."""
    assert -hanging_chain(rope(10, gravity=10.0)).x[-1, 2] == pytest.approx(2.5625)
    assert -hanging_chain(rope(50, gravity=10.0)).x[-1, 2] == pytest.approx(17.3125)
    material = [hanging_chain(rope(n, 2.0, **lab_units(n, 2.0, 500.0, 1.0, 0.1, 0.2))).x[-1, 2] for n in (10, 50, 1000)]
    assert np.ptp(material) < 5e-3


def test_material_units_stretch_as_the_continuum():
    """A hanging bar stretches by w L^2/(2 EA), with any number of links, as half a link's mass stands at its end."""
    for links in (1, 8, 16, 64):
        net = rope(links + 1, 2.0, gravity=10.0, **lab_units(links + 1, 2.0, 500.0, 1.0, 0.0, 0.0))
        stretch = -hanging_chain(net).x[-1, 2] - 2.0
        assert stretch == pytest.approx(10.0 * 2.0**2 / (2.0 * 500.0), rel=1e-12)


def frequencies_of_hanging(links):
    """Lowest frequencies [rad/s] across and along of a rope of 2 m and 1 kg/m in material units, from its masses.

    Across, a link pulls with its tension over its length; along, with its stiffness. EA is so large that it hangs 2 m.
    """
    net = rope(links + 1, 2.0, gravity=10.0, **lab_units(links + 1, 2.0, 1e9, 1.0, 0.0, 0.0))
    across = hanging_chain(net).tension / (2.0 / links)
    along = np.full(links, net.families[0].stiffness)
    for stiffness in (across, along):
        matrix = np.diag(stiffness + np.append(stiffness[1:], 0.0))
        matrix -= np.diag(stiffness[1:], 1) + np.diag(stiffness[1:], -1)
        yield math.sqrt(scipy.linalg.eigh(matrix, np.diag(net.masses[0, 1:]), eigvals_only=True)[0])


def test_a_rope_in_material_units_swings_as_the_continuum_at_second_order():
    """Bernoulli: the first zero of J0, times sqrt(g / L) / 2. A bar: pi / 2, times sqrt(EA / mu) / L."""
    exact = 0.5 * scipy.special.jn_zeros(0, 1)[0] * math.sqrt(10.0 / 2.0), 0.5 * math.pi * math.sqrt(1e9) / 2.0
    errors = np.array([list(frequencies_of_hanging(links)) for links in (9, 18, 36)]) / exact - 1.0
    assert np.abs(errors[0]).max() < 4e-3
    assert errors[:-1] / errors[1:] == pytest.approx(4.0, rel=0.02)


def test_points_of_a_size_touch_floor_and_sphere_with_their_surface():
    view = rope(4, floor=-2.0, sphere=(0.1, 0.2, -1.0, 0.5), radius=0.1).kernel_view(1e-3)
    assert (view.floor, view.sx, view.sy, view.sz, view.sr) == pytest.approx((-1.9, 0.1, 0.2, -1.0, 0.6))


def test_the_table_of_links_has_each_link_of_each_family_in_the_order_of_rows_and_columns():
    net = dataclasses.replace(cloth(3, 4), side_ratio=0.5)
    rows, cols = net.shape
    ends, links = [], []
    for number, f in enumerate(net.families):
        for i in range(rows - f.di):
            for j in range(max(0, -f.dj), cols - max(0, f.dj)):
                on_side = (f.di == 0 and i in (0, rows - 1)) or (f.dj == 0 and j in (0, cols - 1))
                ratio = 0.5 if on_side else 1.0
                ends.append((i * cols + j, (i + f.di) * cols + j + f.dj, number))
                links.append((f.rest, ratio * f.stiffness, ratio * f.damping))
    view = net.kernel_view(1.0)
    assert np.array_equal(view.ends, ends)
    assert np.array_equal(view.links, links)


def test_only_a_net_with_a_grab_has_a_grabbed_point():
    net = cloth(3, 4)
    assert net.kernel_view(1.0).grabbed == -1
    assert dataclasses.replace(net, grab=Grab(1, 2, (0.0, 0.0, 0.0), 10.0, 1.0, 5.0)).kernel_view(1.0).grabbed == 6
