"""Hulls: closed forms of volume, centre and inertia; what a mesh file must be."""

import math
import warnings

import numpy as np
import pytest
import trimesh

from sim.floating import Hull, equilibrium_draft
from sim.floating.shapes import SHAPES
from sim.floating.shapes.box import box
from sim.floating.shapes.record import Appearance, Shape
from sim.floating.shapes.sphere import geodesic
from tests.naive_floating import lumpy, quaternion
from tests.refusals import assert_refused

# Of the box with vertices in the order of `itertools.product`.
SQUARES = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])


def test_box_has_its_closed_forms():
    hull = Hull.box(1.0, 2.0, 3.0)
    assert hull.volume == pytest.approx(6.0, rel=1e-14)
    assert hull.inertia == pytest.approx(np.diag([6 * 13 / 12, 6 * 10 / 12, 6 * 5 / 12]), abs=1e-13)
    assert hull.centre == pytest.approx(np.zeros(3), abs=1e-15)


def test_round_primitives_have_the_true_volume_and_nearly_the_true_inertia():
    sphere = Hull.sphere(0.5)
    assert len(sphere.faces) == 1280
    assert len(Hull.sphere(0.5, frequency=5).faces) == 500
    assert sphere.volume == pytest.approx(4 / 3 * math.pi * 0.125, rel=1e-13)
    assert np.diag(sphere.inertia) == pytest.approx(0.4 * sphere.volume * 0.25, rel=1e-4)
    cylinder = Hull.cylinder(0.5, 2.0)
    assert cylinder.volume == pytest.approx(math.pi * 0.25 * 2, rel=1e-13)
    np.testing.assert_allclose(cylinder.extents, [[-0.5, 0.5], [-0.5, 0.5], [-1.0, 1.0]])
    across = cylinder.volume * (3 * 0.25 + 4) / 12
    assert np.diag(cylinder.inertia) == pytest.approx([across, across, cylinder.volume * 0.125], rel=1e-4)


@pytest.mark.parametrize("name", SHAPES)
def test_a_hull_of_a_shape_has_its_size(name):
    """The first length of a round shape is its radius."""
    whole, half = Hull.of_shape(SHAPES[name]), Hull.of_shape(SHAPES[name], 0.5)
    assert half.size == pytest.approx(whole.size / 2)
    assert half.volume == pytest.approx(whole.volume / 8)
    length = SHAPES[name].lengths[0]
    assert whole.size[0] == pytest.approx(2 * length if name in ("cylinder", "sphere") else length)


def test_a_shape_without_appearances_looks_as_it_is_named():
    shape = Shape("square_pyramid", box, lengths=(1.0, 1.0, 1.0))
    assert shape.appearances == (Appearance("square_pyramid", "Square pyramid"),)


@pytest.mark.parametrize("seed", range(5))
def test_integrals_of_a_lumpy_mesh_match_its_tetrahedra_drawn_by_chance(seed):
    """Against an independent library, in a random frame far from the origin."""
    rng = np.random.default_rng(seed)
    vertices, faces = geodesic(3)
    turn = trimesh.transformations.quaternion_matrix(quaternion(rng))[:3, :3]
    vertices = lumpy(rng, vertices) @ turn.T + rng.uniform(-30, 30, 3)
    hull = Hull.from_arrays(vertices, faces)
    peer = trimesh.Trimesh(vertices, faces, process=False)
    assert hull.volume == pytest.approx(peer.volume, rel=1e-9)
    assert hull.centre == pytest.approx(peer.center_mass, abs=1e-9)
    peer = trimesh.Trimesh(hull.vertices, faces, process=False)
    assert hull.inertia == pytest.approx(peer.moment_inertia, rel=1e-9, abs=1e-9)
    assert np.abs(hull.vertices - (vertices - hull.centre)).max() < 1e-12


@pytest.mark.parametrize("ending", ["stl", "obj", "ply", "glb"])
def test_mesh_files_load_as_what_was_saved(tmp_path, ending):
    path = tmp_path / f"hull.{ending}"
    trimesh.creation.icosphere(subdivisions=2, radius=0.7).apply_translation([1, 2, 3]).export(path)
    hull = Hull.load(path)
    assert len(hull.faces) == 320
    assert hull.volume == pytest.approx(trimesh.creation.icosphere(subdivisions=2, radius=0.7).volume, rel=1e-5)
    assert hull.centre == pytest.approx([1, -3, 2] if ending == "glb" else [1, 2, 3], abs=1e-5)


@pytest.mark.parametrize("ending", ["glb", "gltf"])
def test_a_hull_in_gltf_stands_upright_as_its_specification_says(tmp_path, ending):
    """A wedge written as (x, z, -y), in a node that scales, moves and turns it, is that of the STL."""
    deck = [(0.0, -3.0, 3.0), (20.0, -3.0, 3.0), (20.0, 3.0, 3.0), (0.0, 3.0, 3.0)]
    keel = [(0.0, -1.0, 0.0), (20.0, -1.0, 0.0), (20.0, 1.0, 0.0), (0.0, 1.0, 0.0)]
    faces = [(0, 1, 2), (0, 2, 3), (4, 6, 5), (4, 7, 6)]
    for i in range(4):
        j = (i + 1) % 4
        faces += [(i, i + 4, j), (j, i + 4, j + 4)]
    points = np.array(deck + keel)
    trimesh.Trimesh(points, faces, process=False).export(tmp_path / "wedge.stl")
    wedge = trimesh.Trimesh(1000.0 * points[:, [0, 2, 1]] * [1.0, 1.0, -1.0], faces, process=False)
    scene, scale = trimesh.Scene(), np.diag([0.001, 0.001, 0.001, 1.0])
    turn = trimesh.transformations.rotation_matrix(0.4, [0.0, 1.0, 0.0])  # about the glTF file's upward axis
    scene.add_geometry(wedge, transform=trimesh.transformations.translation_matrix([5.0, 0.0, 0.0]) @ turn @ scale)
    scene.export(str(tmp_path / f"wedge.{ending}"))
    plain, hull = Hull.load(tmp_path / "wedge.stl"), Hull.load(tmp_path / f"wedge.{ending}")
    assert hull.size[2] == pytest.approx(3.0)
    assert equilibrium_draft(hull, 300.0) == pytest.approx(equilibrium_draft(plain, 300.0), abs=1e-4)
    assert equilibrium_draft(hull, 300.0) == pytest.approx(1.242, abs=1e-3)
    c, s = math.cos(0.4), math.sin(0.4)
    wanted = points @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) + [5.0, 0.0, 0.0]
    for corner in wanted:
        assert np.abs(hull.vertices + hull.centre - corner).max(axis=1).min() < 1e-4


@pytest.mark.parametrize("ending", ["dae", "3mf"])
def test_a_file_with_a_unit_and_an_axis_of_its_own_is_refused(tmp_path, ending):
    (tmp_path / f"hull.{ending}").write_text("", "utf-8")
    assert_refused("path", lambda: Hull.load(tmp_path / f"hull.{ending}"), "in metres")


def test_a_mesh_inside_out_is_turned():
    box = Hull.box(1.0, 1.0, 1.0)
    assert Hull.from_arrays(box.vertices, box.faces[:, ::-1]).volume == pytest.approx(1.0)


def test_vertices_that_no_face_has_are_left_out():
    box = Hull.box(1.0, 2.0, 3.0)
    found = Hull.from_arrays(np.concatenate([[[9.0, 9.0, 9.0]], box.vertices]), box.faces + 1)
    assert found.volume == pytest.approx(6.0)
    np.testing.assert_allclose(found.extents, box.extents)


def broken_meshes():
    box = Hull.box(1.0, 1.0, 1.0)
    turned = box.faces.copy()
    turned[3] = turned[3, ::-1]
    infinite = box.vertices.copy()
    infinite[2, 1] = math.inf
    return {
        "open": (box.vertices, box.faces[:-1], "edges without exactly one opposite"),
        "one face turned": (box.vertices, turned, "edges without exactly one opposite"),
        "doubled": (box.vertices, np.concatenate([box.faces, box.faces]), "edges without exactly one opposite"),
        "not finite": (infinite, box.faces, "not finite"),
        "flat": (box.vertices * [1, 1, 0], box.faces, "extents"),
        "no such vertex": (box.vertices, box.faces + 1, "vertex 8"),
        "counted from the end": (box.vertices, box.faces - 1, "vertex -1"),
        "of four corners each": (box.vertices, SQUARES, r"\(8, 3\) vertices, \(6, 4\) faces"),
        "empty": (np.zeros((0, 3)), np.zeros((0, 3), dtype=int), "m at least 4"),
        "huge": (box.vertices * 1e200, box.faces, "extents"),
    }


@pytest.mark.parametrize("fault", list(broken_meshes()))
def test_a_mesh_that_is_no_hull_is_refused(fault):
    vertices, faces, message = broken_meshes()[fault]
    with pytest.raises(ValueError, match=message):
        Hull.from_arrays(vertices, faces)


def test_a_file_that_is_no_hull_is_refused(tmp_path):
    with pytest.raises(ValueError, match=r"path: .*nothing\.stl: no such file"):
        Hull.load(tmp_path / "nothing.stl")
    (tmp_path / "noise.stl").write_bytes(b"\x00\xff" * 100)
    with pytest.raises(ValueError, match=r"noise\.stl"):
        Hull.load(tmp_path / "noise.stl")
    cap = trimesh.creation.icosphere(subdivisions=1)
    cap.update_faces(np.arange(len(cap.faces)) > 5)
    cap.export(tmp_path / "open.stl")
    with pytest.raises(ValueError, match=r"open\.stl.*closed mesh"):
        Hull.load(tmp_path / "open.stl")


def test_a_mesh_with_one_of_two_parts_inside_out_is_refused_without_a_warning():
    box = Hull.box(1.0, 1.0, 1.0)
    points = np.concatenate([box.vertices, box.vertices + [3.0, 0.0, 0.0]])
    faces = np.concatenate([box.faces, box.faces[:, ::-1] + len(box.vertices)])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert_refused("faces", lambda: Hull.from_arrays(points, faces), "encloses a volume")
