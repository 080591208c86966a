"""Rotations of bodies."""

import numpy as np

from sim.floating.rotation import body_z_axes, rotation_matrix


def test_the_bodies_own_axes_are_the_matrices_last_columns():
    turns = np.random.default_rng(0).normal(size=(9, 4))
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    expected = [rotation_matrix(turn)[:, 2] for turn in turns]
    np.testing.assert_allclose(body_z_axes(turns), expected, atol=1e-15)
