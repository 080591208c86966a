"""Hulls: closed triangle meshes of a known shape, or from a mesh file.

A hull is immutable and has no density: that belongs to the body. Its vertices are relative to its centre of mass,
with z up in the pose it is launched in. The mesh of a round shape is scaled to the true volume of the shape (sphere:
the whole mesh; cylinder: its cross-section), so that weight and buoyancy of the mesh are those of the shape. What is
asked of the shape itself (`equilibrium_draft`) uses its closed form and `extents`.
"""

import dataclasses
import os
from pathlib import Path
from typing import NamedTuple

import numpy as np

from sim.floating.hulls.closed_mesh import MAX_LENGTH, ClosedMesh, checked_mesh, open_edges
from sim.floating.hulls.mesh_repair import place_of_gaps, remedy, repaired
from sim.floating.hulls.panel_files import UNITS, Mesh, read_mesh
from sim.floating.linear.linear_table import place_of_table, read_table
from sim.floating.shapes.box import SHAPE as BOX
from sim.floating.shapes.box import box
from sim.floating.shapes.cylinder import SHAPE as CYLINDER
from sim.floating.shapes.cylinder import cylinder
from sim.floating.shapes.record import Appearance, Shape
from sim.floating.shapes.sphere import SHAPE as SPHERE
from sim.floating.shapes.sphere import sphere
from sim.interruption import raise_if_stopped
from sim.validation import argument_error, as_array, check_choice, check_kind, check_positive

FILE_SHAPE = "hull"  # name of the shape that is made of a mesh file, and of its one appearance
FILE_TITLE = "From file"


class MeshReading(NamedTuple):
    """Reading of a mesh file; see `Hull.load`."""

    unit: str = ""
    weld: float = 0.0  # [m]
    mirror: str = ""
    cap: str = ""


AS_IT_IS = MeshReading()


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
    def load(
        path: str | Path,
        own_table: bool = True,
        unit: str = "",
        weld: float = 0.0,
        mirror: str = "",
        cap: str = "",
    ) -> "Hull":
        """A hull from a mesh file, all of its parts in one; formats are those of `panel_files.py`.

        glTF and GLB have y up, as their specification says, and are turned; all others are read with z up.
        own_table: with the table of linear coefficients that lies beside the file, if there is one. unit: "m", "cm",
        "mm" or "ft", by default that of the format, or metres. An open mesh is closed by weld [m], corners nearer than
        that become one; by mirror, "x" or "y", the plane across which the other half lies; by cap, "deck". Raises
        ValueError if the file cannot be read, its mesh is not closed, oriented and finite, or its table is that of
        another one; ModuleNotFoundError without meshio, where the format needs it.
        """
        return Hull.of_shape(shape_from_file(path, own_table, MeshReading(unit, weld, mirror, cap)))

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


def shape_from_file(path: str | Path, own_table: bool = True, reading: MeshReading = AS_IT_IS) -> Shape:
    """The shape of the mesh in a file; its hulls always have the size of the file.

    own_table: with the table of linear coefficients that lies beside the file, if there is one (linear_table.py).

    Raises ValueError as `Hull.load`.
    """
    mesh = mesh_from_file(path, reading)
    place = place_of_table(path)
    table = read_table(place, mesh) if own_table and place.is_file() else None
    return Shape(FILE_SHAPE, lambda: mesh, (), (Appearance(FILE_SHAPE, FILE_TITLE),), table=table)


def mesh_from_file(path: str | Path, reading: MeshReading = AS_IT_IS) -> ClosedMesh:
    """The closed mesh in a file. Raises ValueError as `Hull.load`."""
    vertices, faces = open_mesh_from_file(path, reading)
    if len(faces) and np.isfinite(vertices).all() and open_edges(faces):
        help = remedy(vertices, faces)
        allowed = "a closed mesh, all faces turned outward or all inward" + (f"; {help} closes it" if help else "")
        raise argument_error(str(path), place_of_gaps(vertices, faces), allowed)
    size = float(np.ptp(vertices, axis=0).max()) if len(faces) else 0.0
    if not reading.unit and size > MAX_LENGTH:
        allowed = f"at most {MAX_LENGTH:g} m; --hull-unit mm reads millimetres"
        raise argument_error(str(path), f"{size:g} m of length", allowed)
    return checked_mesh(vertices, faces, str(path))


def open_mesh_from_file(path: str | Path, reading: MeshReading = AS_IT_IS) -> Mesh:
    """Triangles of a file in metres, with its repairs, closed or not. Raises ValueError if it cannot be read."""
    where = Path(check_kind("path", path, str | os.PathLike, "the name of a file"))
    if reading.unit:
        check_choice("unit", reading.unit, UNITS)
    mesh = read_mesh(where, reading.unit)
    if not len(mesh.faces) or not np.isfinite(mesh.vertices).all() or mesh.faces.max() >= len(mesh.vertices):
        return mesh  # `checked_mesh` says what is wrong with it
    try:
        return Mesh(*repaired(*mesh, reading.weld, reading.mirror, reading.cap))
    except ValueError as error:
        help = remedy(*mesh) if reading.cap and not reading.mirror else ""
        if not help:
            raise
        raise ValueError(f"{error}; {help} closes it") from None
