"""The rings of bodies: where they are laid, how they fade, and that slopes are those of the heights."""

import numpy as np
import pytest

from app.scenes.radial_sea.radiated_waves import LENGTH, WIDEST, RadiatedWaves

STEP = 0.01  # [m] of differences


def laid(points: np.ndarray, density: float = 1000.0) -> tuple[np.ndarray, np.ndarray]:
    """Heights (n,) and slopes (n, 2) of rings 1.5 s after two presses, at points (n, 2) [m]."""
    rings = RadiatedWaves()
    rings.press(0.0, np.array([[3.0, -2.0], [-4.0, 1.0]]), np.array([2.0, 2.0]), np.array([4000.0, 2500.0]), density)
    vertices = np.zeros((len(points), 3), np.float32)
    vertices[:, :2] = points
    slopes = np.zeros((len(points), 2), np.float32)
    rings.lay(1.5, vertices, slopes, len(points))
    return vertices[:, 2].astype(float), slopes.astype(float)


def test_the_slopes_are_those_of_the_heights():
    points = np.random.default_rng(1).uniform(-8.0, 8.0, (60, 2))
    _, slopes = laid(points)
    for axis in (0, 1):
        step = np.eye(2)[axis] * STEP
        found = (laid(points + step)[0] - laid(points - step)[0]) / (2.0 * STEP)
        assert found == pytest.approx(slopes[:, axis], abs=0.03 * np.abs(slopes).max())
    assert np.abs(slopes).max() > 1e-3


def test_rings_are_where_the_bodies_pressed_and_fade_to_the_edge_of_their_square():
    heights, _ = laid(np.array([[3.0, -2.0], [-4.0, 1.0], [3.0, 12.0], [0.3 * LENGTH, 0.0]]))
    assert np.abs(heights[:2]).min() > 3.0 * np.abs(heights[2:]).max()
    edge = 0.5 * LENGTH
    outside, slopes = laid(np.array([[edge + 0.1, 0.0], [0.0, -edge - 0.1], [2.0 * edge, 1.0]]))
    assert (outside == 0.0).all()
    assert (slopes == 0.0).all()


def test_a_press_beyond_the_square_makes_no_rings():
    rings = RadiatedWaves()
    rings.press(0.0, np.array([[WIDEST * LENGTH + 0.1, 0.0]]), np.array([2.0]), np.array([4000.0]), 1000.0)
    assert not rings.sea.ripples.alive
    rings.press(0.0, np.array([[WIDEST * LENGTH - 0.1, 0.0]]), np.array([2.0]), np.array([4000.0]), 1000.0)
    assert rings.sea.ripples.alive


def test_a_lighter_fluid_moves_by_more():
    points = np.random.default_rng(2).uniform(-8.0, 8.0, (20, 2))
    assert laid(points, 800.0)[0] == pytest.approx(laid(points, 1000.0)[0] / 0.8, rel=1e-4, abs=1e-7)
