"""What a column of fluids hands on of the exact relations: which mode, which viscosity, which ratio."""

import math

import numpy as np
import pytest

from sim.ocean.dispersion import mode_ratios, omega, two_layer, viscous_root, viscous_two_layer
from sim.ocean.fluids.fluid_column import FluidColumn
from sim.ocean.fluids.fluids import fluids

K = np.array([0.05, 0.5, 5.0, 50.0])
OIL = next(f for f in fluids().values() if f.surface_tension and f.interface_tension and f.viscosity > 0.005)
LAYER = FluidColumn(oil=OIL, thickness=0.2)


def two(column):
    oil, water = column.oil, column.water
    return (
        oil.density, column.thickness, water.density, column.gravity, math.inf, oil.surface_tension,
        oil.interface_tension,
    )  # fmt: skip


def test_over_a_layer_the_waves_are_those_of_the_surface_mode():
    surface, interface = two_layer(K, *two(LAYER))
    assert LAYER.omega(K) == pytest.approx(surface, rel=1e-12)
    assert (LAYER.omega(K) > 1.5 * interface).all()
    assert LAYER.interface_ratio(K) == pytest.approx(mode_ratios(K, *two(LAYER)).surface, rel=1e-12)
    assert LAYER.interface_ratio(K)[0] == pytest.approx(1.0, abs=0.02)
    assert abs(LAYER.interface_ratio(K)[-1]) < 0.01


def test_the_roots_over_a_layer_are_those_of_both_viscosities():
    oil, water = LAYER.oil, LAYER.water
    expected = viscous_two_layer(
        K, oil.density, oil.viscosity, 0.2, water.density, water.viscosity, LAYER.gravity, oil.surface_tension,
        oil.interface_tension,
    )  # fmt: skip
    for found, root in zip(LAYER.roots(K), expected, strict=True):
        assert found == pytest.approx(root, rel=1e-12)


@pytest.mark.parametrize("thickness", [0.01, 1.0])
def test_the_roots_of_many_waves_are_those_of_each(thickness):
    """Over a heavy oil, where the short ones creep."""
    k, rest = np.geomspace(0.01, 1000.0, 6), (988.0, 6.8, thickness, 1025.0, 0.00122, 9.81, 0.03, 0.02)
    together = np.array(viscous_two_layer(k, *rest))
    alone = np.concatenate([np.array(viscous_two_layer(k[i : i + 1], *rest)) for i in range(len(k))], axis=1)
    assert together == pytest.approx(alone, rel=1e-6, abs=1e-9)
    assert alone[0, 0] > 0.0 == alone[0, -1]


@pytest.mark.parametrize("column", [FluidColumn(), FluidColumn(oil=OIL, fraction=0.3)])
def test_one_fluid_has_its_own_frequency_and_the_decay_of_its_viscosity(column):
    fluid = column.surface
    assert column.omega(K) == pytest.approx(omega(K, 9.81, math.inf, fluid.surface_tension or 0.0, fluid.density))
    assert (column.interface_ratio(K) == 1.0).all()
    frequency, decay = column.roots(K[:2])
    exact = viscous_root(K[:2], fluid.viscosity / fluid.density)
    assert frequency == pytest.approx(exact[0], rel=1e-3)
    assert decay == pytest.approx(exact[1], rel=1e-3)
