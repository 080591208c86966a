"""Chains: a row or a column of points has the same kernels, however its masses were given."""

import dataclasses

import numpy as np
import pytest

from sim.springs import INTEGRATORS, Contact, Grab, PinPath, rope
from sim.springs.net import Net
from sim.springs.points.arrays import GridArrays, RopeArrays, StrandArrays
from sim.springs.state import State, advance
from tests.sim.springs.nets import DAMPABLE

PATH = PinPath(0.0, ((0.0, 0.0, 0.0), (0.2, -0.1, 0.5), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))


def column_of(net: Net) -> Net:
    """The same chain with its points in one column."""
    ratios, grab = net.mass_ratios, net.grab
    return dataclasses.replace(
        net,
        x0=np.ascontiguousarray(net.x0.transpose(0, 2, 1)),
        families=tuple(f._replace(di=f.dj, dj=f.di) for f in net.families),
        mass_ratios=None if ratios is None else ratios.T,
        pinned=frozenset((j, i) for i, j in net.pinned),
        pin_paths=tuple(((j, i), path) for (i, j), path in net.pin_paths),
        grab=None if grab is None else grab._replace(row=grab.col, col=grab.row),
    )


@pytest.mark.parametrize("name", DAMPABLE)
def test_a_list_of_equal_masses_is_one_mass(name):
    one, listed = rope(9, mass=0.3), rope(9, mass=[0.3] * 9)
    a, b = State.at_rest(one), State.at_rest(listed)
    advance(one, a, name, 1e-3, 300)
    advance(listed, b, name, 1e-3, 300)
    assert (a.x == b.x).all()
    assert (a.v == b.v).all()
    assert a.force_evals == b.force_evals


@pytest.mark.parametrize("name", DAMPABLE)
def test_a_column_moves_as_a_row_does(name):
    """With unequal masses, a floor, a moving root and a hand at its end."""
    row = dataclasses.replace(
        rope(9, mass=np.linspace(0.5, 1.5, 9), floor=-0.1, contact=Contact(900.0, 4.0)),
        pin_paths=(((0, 0), PATH),),
        grab=Grab(0, 8, (1.0, 1.0, 0.0), 200.0, 5.0, 30.0),
    )
    column = column_of(row)
    a, b = State.at_rest(row), State.at_rest(column)
    advance(row, a, name, 1e-3, 600)
    advance(column, b, name, 1e-3, 600)
    assert a.x[2].min() < -0.1
    assert (a.x.ravel() == b.x.ravel()).all()


@pytest.mark.parametrize("mass", [0.3, np.linspace(0.2, 0.4, 9)])
@pytest.mark.parametrize("turned", [False, True])
def test_kernels_follow_the_shape_of_a_net_and_its_forces(mass, turned):
    net = column_of(rope(9, mass=mass)) if turned else rope(9, mass=mass)
    assert type(net.kernel_view(1.0)) is RopeArrays
    assert type(dataclasses.replace(net, thickness=0.01).kernel_view(1.0)) is StrandArrays
    other = net.families[0]._replace(di=2 if turned else 0, dj=0 if turned else 2)
    assert type(dataclasses.replace(net, families=(*net.families, other)).kernel_view(1.0)) is GridArrays


@pytest.mark.parametrize("name", [name for name in DAMPABLE if INTEGRATORS[name].implicit])
def test_a_rope_of_unequal_masses_settles_at_every_step(name):
    """As stiff as 1e6 N/m at 1/60 s."""
    net = rope(40, 1.0, np.full(40, 0.02) * np.linspace(1.0, 1.5, 40), 1e6, 0.5, 0.01)
    state = State.at_rest(net)
    advance(net, state, name, 1 / 60, 30)
    assert state.unsettled == 0
