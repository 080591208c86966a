"""The meshes made of a few numbers."""

import numpy as np
import pytest

from app.render.colormap import SCALE, scale_colours, set_tube_colours
from app.render.meshes import SIDES, ball, smooth_line, sweep, tube_faces


def volume(vertices: np.ndarray, faces: np.ndarray) -> float:
    """Signed volume of a closed mesh; positive where its triangles face outwards."""
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    return float((a * np.cross(b, c)).sum() / 6)


def test_a_ball_is_closed_and_faces_outwards() -> None:
    vertices, faces = ball(64)
    assert volume(vertices, faces) == pytest.approx(4 / 3 * np.pi, rel=2e-3)
    np.testing.assert_allclose(np.linalg.norm(vertices, axis=1), 1.0)


def tube(points: np.ndarray, between: int, radius: float) -> tuple[np.ndarray, np.ndarray]:
    rings = (len(points) - 1) * between + 1
    line = np.zeros((rings, 3))
    vertices = np.zeros((rings * SIDES + 2, 3), np.float32)
    smooth_line(points.astype(np.float32), between, line)
    sweep(line, radius, SIDES, vertices)
    return line, vertices


def test_a_straight_tube_is_a_closed_prism() -> None:
    _, vertices = tube(np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]]), 4, 0.1)
    prism = 0.5 * SIDES * np.sin(2 * np.pi / SIDES) * 0.1**2 * 2.0
    assert volume(vertices.astype(float), tube_faces(9)) == pytest.approx(prism, rel=1e-5)


def test_the_line_goes_through_its_points_and_the_tube_keeps_its_radius() -> None:
    angle = np.linspace(0, 5, 12)
    points = np.stack([np.cos(angle), np.sin(angle), 0.3 * angle], axis=1)
    line, vertices = tube(points, 7, 0.05)
    np.testing.assert_allclose(line[::7], points, atol=1e-6)
    rings = vertices[:-2].reshape(len(line), SIDES, 3)
    np.testing.assert_allclose(np.linalg.norm(rings - line[:, None], axis=2), 0.05, rtol=1e-4)


def test_a_tube_does_not_twist() -> None:
    angle = np.linspace(0, 6, 40)
    points = np.stack([np.cos(angle), np.sin(angle), np.zeros(40)], axis=1)
    line, vertices = tube(points, 4, 0.05)
    first = (vertices[:-2].reshape(len(line), SIDES, 3)[:, 0] - line) / 0.05
    # In a plane curve the frame keeps its angle to the plane's normal.
    assert np.ptp(first[:, 2]) < 1e-3


def test_along_a_helix_a_tube_turns_against_the_normal_by_the_torsion() -> None:
    """The frame of least rotation turns by less than the Frenet frame: by the torsion times the length."""
    radius, pitch, turns = 1.0, 0.5, 1.5
    t = np.linspace(0.0, 2.0 * np.pi * turns, 200)
    line, vertices = tube(np.stack([radius * np.cos(t), radius * np.sin(t), pitch * t], axis=1), 2, 0.05)
    inner = slice(4, len(line) - 4)  # the ends of the smooth line are straighter
    own = ((vertices[:-2].reshape(len(line), SIDES, 3)[:, 0] - line) / 0.05)[inner]
    angle = np.unwrap(np.arctan2(line[inner, 1], line[inner, 0]))
    normal = np.stack([-np.cos(angle), -np.sin(angle), 0.0 * angle], axis=1)
    speed = np.hypot(radius, pitch)
    tangent = np.stack([-radius * np.sin(angle), radius * np.cos(angle), pitch + 0.0 * angle], axis=1) / speed
    turned = np.unwrap(np.arctan2((own * np.cross(tangent, normal)).sum(axis=1), (own * normal).sum(axis=1)))
    length = speed * (angle[-1] - angle[0])
    assert abs(turned[-1] - turned[0]) == pytest.approx(pitch / speed**2 * length, rel=1e-2)


@pytest.mark.parametrize("points", [np.zeros((5, 3)), np.array([[0.0, 0, 0], [0, 0, 1], [0, 0, 0], [0, 0, 1]])])
def test_points_on_top_of_each_other_make_no_nan(points: np.ndarray) -> None:
    _, vertices = tube(points, 3, 0.05)
    assert np.isfinite(vertices).all()


@pytest.mark.parametrize("links", [1, 2, 9])
@pytest.mark.parametrize("between", [1, 6])
def test_a_tube_is_painted_by_the_tension_at_the_middle_of_each_link(links: int, between: int) -> None:
    tension = np.random.default_rng(links).uniform(-1.0, 6.0, links).astype(np.float32)
    rings = links * between + 1
    rgb = np.full((rings * SIDES + 2, 3), np.nan, np.float32)
    set_tube_colours(tension, between, 5.0, SCALE, SIDES, rgb)
    along = np.interp(np.arange(rings) / between, np.arange(links) + 0.5, tension)
    each = scale_colours(along, 0.0, 5.0)
    np.testing.assert_allclose(rgb[:-2].reshape(rings, SIDES, 3), np.repeat(each[:, None], SIDES, axis=1), atol=1e-6)
    np.testing.assert_allclose(rgb[-2:], each[[0, -1]], atol=1e-6)
