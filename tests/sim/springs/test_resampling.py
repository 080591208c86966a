"""Resampling of a net's state to another grid."""

import numpy as np
import pytest

from sim.springs import cloth, rope
from sim.springs.resampling import resample


@pytest.mark.parametrize("shape", [(1, 1), (1, 7), (6, 5)])
def test_the_same_grid_gives_the_same_values_bit_for_bit(shape):
    values = np.random.default_rng(0).random((3, *shape))
    assert (resample(values, *shape) == values).all()


def test_a_finer_grid_passes_through_the_old_points():
    values = np.random.default_rng(0).random((3, 4, 5))
    assert resample(values, 7, 13)[:, ::2, ::3] == pytest.approx(values, abs=1e-15)


def test_a_straight_rope_and_a_flat_cloth_stay_so_on_any_grid():
    assert resample(rope(10).x0, 1, 23) == pytest.approx(rope(23).x0, abs=1e-15)
    assert resample(cloth(5, 8).x0, 12, 3) == pytest.approx(cloth(12, 3).x0, abs=1e-15)


def test_the_kernels_get_a_contiguous_array():
    assert resample(cloth(5, 8).x0, 12, 3).flags.c_contiguous
