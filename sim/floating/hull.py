"""Hulls: closed triangle meshes of a known shape, or from a mesh file.

A hull is immutable and has no density: that belongs to the body. Its vertices are relative to its centre of mass,
with z up in the pose it is launched in. The mesh of a round shape is scaled to the true volume of the shape (sphere:
the whole mesh; cylinder: its cross-section), so that weight and buoyancy of the mesh are those of the shape. What is
asked of the shape itself (`equilibrium_draft`) uses its closed form and `extents`.
"""

import dataclasses
import os
from pathlib import Path

import numpy as np

from sim.floating.closed_mesh import ClosedMesh, checked_mesh
from sim.floating.linear_table import place_of_table, read_table
from sim.floating.shapes.box import SHAPE as BOX
from sim.floating.shapes.box import box
from sim.floating.shapes.cylinder import SHAPE as CYLINDER
from sim.floating.shapes.cylinder import cylinder
from sim.floating.shapes.record import Appearance, Shape
from sim.floating.shapes.sphere import SHAPE as SPHERE
from sim.floating.shapes.sphere import sphere
from sim.interruption import raise_if_stopped
from sim.validation import argument_error, as_array, check_kind, check_positive, unreadable

FILE_SHAPE = "hull"  # name of the shape that is made of a mesh file, and of its one appearance
FILE_TITLE = "From file"
Y_UP = (".glb", ".gltf")  # +y up and metres (glTF 2.0, section 3.4)
WITH_UNITS = (".dae", ".zae", ".3mf")  # which have a unit and an axis of their own, that trimesh does not apply


@dataclasses.dataclass(frozen=True, eq=False)
class Hull(ClosedMesh):
    """A closed mesh about its centre of mass, and the shape that it stands for."""

    shape: Shape
    # x, y [m] of the vertical axis that the shape's closed forms and linear coefficients are about
    axis: tuple[float, float] = (0.0, 0.0)

    @staticmethod
    def of(shape: Shape, mesh: ClosedMesh) -> "Hull":
        """The hull of a mesh of that shape."""
        return Hull(**{field.name: getattr(mesh, field.name) for field in dataclasses.fields(ClosedMesh)}, shape=shape)

    @staticmethod
    def of_shape(shape: Shape, size: float = 1.0) -> "Hull":
        """A hull as bodies of a scene have it, its lengths times `size`. A shape from a file keeps its own size.

        Raises ValueError for a size that makes a length that is not allowed.
        """
        check_positive("size", size, "")
        raise_if_stopped()
        return Hull.of(shape, shape.build(*(length * size for length in shape.lengths)))

    @staticmethod
    def box(x: float, y: float, z: float) -> "Hull":
        """A box of edges x, y, z [m]. Raises ValueError for an edge that is not 0.001 to 10000 m.

        >>> Hull.box(2.0, 1.0, 0.5).volume  # [m3]
        1.0
        """
        return Hull.of(BOX, box(x, y, z))

    @staticmethod
    def sphere(radius: float, frequency: int = 8) -> "Hull":
        """A sphere [m] of 20 frequency^2 triangles.

        Raises ValueError for a radius that is not 0.001 to 10000 m or a frequency that is not 1 to 64.
        """
        return Hull.of(SPHERE, sphere(radius, frequency))

    @staticmethod
    def cylinder(radius: float, height: float) -> "Hull":
        """A cylinder [m] with its axis along z. Raises ValueError for lengths outside 0.001 to 10000 m."""
        return Hull.of(CYLINDER, cylinder(radius, height))

    @staticmethod
    def load(path: str | Path, own_table: bool = True) -> "Hull":
        """A hull from a mesh file (STL, OBJ, PLY, OFF, GLB, glTF), all of its parts in one, units read as metres.

        glTF and GLB have y up, as their specification says, and are turned; all others are read with z up.
        own_table: with the table of linear coefficients that lies beside the file, if there is one. Raises ValueError
        where the file cannot be read, its mesh is not closed, oriented and finite, or its table is that of another one.
        """
        return Hull.of_shape(shape_from_file(path, own_table))

    @staticmethod
    def from_arrays(vertices: np.ndarray, faces: np.ndarray, name: str = "faces") -> "Hull":
        """A hull from vertices (n, 3) [m] and faces (m, 3). A mesh with all faces inward is turned.

        Raises ValueError, which begins with `name`, where the mesh is not closed, oriented and finite.
        """
        points = as_array("vertices", vertices, "numbers of shape (n, 3) [m]")
        if points.ndim != 2 or points.shape[1] != 3:
            raise argument_error("vertices", points.shape, "numbers of shape (n, 3) [m]")
        mesh = checked_mesh(points, faces, name)
        return Hull.of(Shape("mesh", lambda: mesh, ()), mesh)


def shape_from_file(path: str | Path, own_table: bool = True) -> Shape:
    """The shape of the mesh in a file; its hulls always have the size of the file.

    own_table: with the table of linear coefficients that lies beside the file, if there is one (linear_table.py).

    Raises ValueError as `Hull.load`.
    """
    if not Path(check_kind("path", path, str | os.PathLike, "the name of a file")).exists():
        raise unreadable("path", path, FileNotFoundError())
    ending = Path(path).suffix.lower()
    if ending in WITH_UNITS:
        raise argument_error("path", str(path), "STL, OBJ, PLY, OFF, GLB or glTF, in metres: convert it")
    import trimesh  # reading meshes is rare and the import is slow

    try:
        loaded = trimesh.load(str(path), force="mesh", process=True)
        vertices = np.asarray(loaded.vertices, dtype=float).reshape(-1, 3)  # type: ignore[union-attr]
        faces = np.asarray(loaded.faces, dtype=np.int64).reshape(-1, 3)  # type: ignore[union-attr]
    except Exception as error:  # trimesh's readers raise errors of many types
        raise argument_error("path", str(path), f"a mesh file that can be read ({error})") from error
    if ending in Y_UP:
        vertices = vertices[:, [0, 2, 1]] * [1.0, -1.0, 1.0]
    mesh = checked_mesh(vertices, faces, str(path))
    place = place_of_table(path)
    table = read_table(place, mesh) if own_table and place.is_file() else None
    return Shape(FILE_SHAPE, lambda: mesh, (), (Appearance(FILE_SHAPE, FILE_TITLE),), table=table)
