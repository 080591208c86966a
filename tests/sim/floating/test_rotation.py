"""Rotations of bodies."""

import itertools
import math

import numpy as np
import trimesh.transformations as reference

from sim.floating.motion.rotation import body_z_axes, heading_angle, product, quaternion_by_vector, rotation_matrix

TURNS = np.random.default_rng(0).normal(size=(9, 4))


def test_the_matrix_of_a_quaternion_is_that_of_trimesh():
    for turn in TURNS:
        np.testing.assert_allclose(rotation_matrix(turn), reference.quaternion_matrix(turn)[:3, :3], atol=1e-15)


def test_the_z_axes_of_bodies_are_the_last_columns_of_their_matrices():
    turns = TURNS / np.linalg.norm(TURNS, axis=1, keepdims=True)
    expected = [reference.quaternion_matrix(turn)[:3, 2] for turn in turns]
    np.testing.assert_allclose(body_z_axes(turns), expected, atol=1e-15)


def test_a_product_of_quaternions_is_one_rotation_after_the_other():
    for a, b in itertools.pairwise(TURNS):
        np.testing.assert_allclose(product(a, b), reference.quaternion_multiply(a, b), atol=1e-14)


def test_the_quaternion_of_a_rotation_vector_turns_about_it_by_its_length():
    for axis, angle in zip(TURNS[:, :3], (1e-9, 0.1, 1.0, 3.0, 7.0), strict=False):
        turn = quaternion_by_vector(angle * axis / np.linalg.norm(axis))
        np.testing.assert_allclose(turn, reference.quaternion_about_axis(angle, axis), atol=1e-15)
    assert quaternion_by_vector((0.0, 0.0, 0.0)) == (1.0, 0.0, 0.0, 0.0)


def test_the_heading_of_a_body_upside_down_is_that_of_its_x_axis():
    for yaw in (-2.0, 0.0, 0.4, 3.0):
        for over in (0.0, 1.0, math.pi):
            turn = reference.quaternion_from_euler(over, 0.0, yaw, "sxyz")  # about x, then about the vertical
            assert math.isclose(heading_angle(turn), yaw, abs_tol=1e-12)
