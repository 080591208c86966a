"""Meshes from files: triangles of CAD programs (by trimesh), panels of boundary-element programs, and those of meshio.

| ending | format | read by |
|---|---|---|
| .stl .obj .ply .off .glb .gltf | triangles | trimesh |
| .gdf | WAMIT | this file |
| .dat | NEMOH | this file |
| .pnl | HAMS | this file |
| .msh .vtu .vtk .inp .med | Gmsh, VTK, Abaqus, Salome | meshio (extra `meshes`) |

Of panels half a hull, or a quarter, may be in a file that names its planes of symmetry: the rest is added. A panel
file has the corners of each panel: those nearer than a millionth of the hull become one.
"""

import contextlib
import importlib
import io
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from sim.floating.hulls.mesh_repair import mirrored, triangles_of, welded
from sim.validation import argument_error, unreadable

Y_UP = (".glb", ".gltf")  # +y up and metres (glTF 2.0, section 3.4)
# DAE and 3MF have a unit and an axis of their own, that trimesh does not apply
BY_TRIMESH = (".stl", ".obj", ".ply", ".off", *Y_UP)
BY_MESHIO = (".msh", ".vtu", ".vtk", ".inp", ".med")
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "ft": 0.3048}  # [m]
FEET_GRAVITY = (30.0, 35.0)  # of a GDF file in feet
SAME_CORNER = 1e-6  # of the size of a hull of panels
MAX_BYTES = 200_000_000
MAX_PANELS = 1_000_000
FORMATS = "STL, OBJ, PLY, OFF, GLB, glTF, GDF, NEMOH's .dat, HAMS's .pnl, or Gmsh's .msh and VTK's .vtu by meshio"


class Mesh(NamedTuple):
    """Triangles of a file, not yet checked."""

    vertices: np.ndarray  # (n, 3) [m], z up
    faces: np.ndarray  # (m, 3)


def read_mesh(path: Path, unit: str = "") -> Mesh:
    """The triangles of a file. unit: one of UNITS, "" for that which the format names, else metres.

    Raises ValueError for a file that cannot be read, ModuleNotFoundError without meshio where the format needs it.
    """
    ending = path.suffix.lower()
    if not path.is_file():
        raise unreadable("path", path, FileNotFoundError() if not path.exists() else IsADirectoryError(21, "a folder"))
    from sim.inputs.kinds import check_file  # reading meshes is rare

    check_file("path", path, ("mesh",), FORMATS)
    if ending in PANELS:
        mesh, own = panels(path, PANELS[ending])
    elif ending in BY_MESHIO:
        mesh, own = by_meshio(path), "m"
    elif ending in BY_TRIMESH:
        mesh, own = by_trimesh(path), "m"
    else:
        raise argument_error("path", str(path), f"{FORMATS}; convert it, in metres")
    return mesh._replace(vertices=mesh.vertices * UNITS[unit or own])


def by_trimesh(path: Path) -> Mesh:
    """Triangles of a file that trimesh reads, all parts in one."""
    import trimesh  # reading meshes is rare and the import is slow

    try:
        loaded = trimesh.load(str(path), force="mesh", process=True)
        vertices = np.asarray(loaded.vertices, dtype=float).reshape(-1, 3)  # type: ignore[union-attr]
        faces = np.asarray(loaded.faces, dtype=np.int64).reshape(-1, 3)  # type: ignore[union-attr]
    except Exception as error:  # its readers raise errors of many types
        raise unread(path, error) from error
    if path.suffix.lower() in Y_UP:
        vertices = vertices[:, [0, 2, 1]] * [1.0, -1.0, 1.0]
    return Mesh(vertices, faces)


def by_meshio(path: Path) -> Mesh:
    """Triangles and quadrangles of a file that meshio reads."""
    meshio: Any = importlib.import_module("meshio")
    said = io.StringIO()  # it prints its errors, and ends the program
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            mesh = meshio.read(path)
        points = np.asarray(mesh.points, float)
        points = points if points.shape[1] == 3 else np.column_stack([points, np.zeros(len(points))])
        kinds = mesh.cells_dict
    except SystemExit as error:
        raise unread(path, said.getvalue()) from error
    except Exception as error:  # its readers raise errors of many types
        raise unread(path, error) from error
    faces = [triangles_of(np.asarray(kinds[kind], np.int64)) for kind in ("triangle", "quad") if kind in kinds]
    if not faces:
        others = ", ".join(sorted(kinds)) or "nothing"
        raise argument_error("path", f"{path} with {others}", "a surface of triangles and quadrangles")
    return Mesh(points, np.concatenate(faces))


def unread(path: Path, error: object) -> ValueError:
    """The error of a mesh that another library cannot read."""
    reason = " ".join(str(error).replace(str(path), "it").split()) or type(error).__name__
    return argument_error("path", str(path), f"a mesh file that can be read ({reason[:120]})")


# --- panels of boundary-element programs ---


def panels(path: Path, read: Callable[["Words"], "Panels"]) -> tuple[Mesh, str]:
    """The whole hull of a file of panels, and its unit."""
    content = read(Words(path))
    vertices, faces = content.vertices, triangles_of(content.corners)
    size = float(np.ptp(vertices, axis=0).max())
    if not np.isfinite(vertices).all() or not size > 0.0:
        raise argument_error("path", str(path), "panels with finite corners that differ")
    vertices, faces = welded(vertices, faces, SAME_CORNER * size)
    for axis in content.mirrors:
        try:
            vertices, faces = mirrored(vertices, faces, axis, SAME_CORNER * size)
        except ValueError as error:
            raise ValueError(f"path: {path}: {error}") from None
    return Mesh(vertices, faces), content.unit


class Panels(NamedTuple):
    """Panels of a file."""

    vertices: np.ndarray  # (n, 3)
    corners: np.ndarray  # (m, 4), a triangle repeats one
    mirrors: tuple[str, ...] = ()  # axes across which the rest lies
    unit: str = "m"


class Words:
    """The words of a text file, one after another."""

    def __init__(self, path: Path) -> None:
        """Raises ValueError for a file that is not of text."""
        self.path = path
        try:
            with path.open("rb") as file:
                content = file.read(MAX_BYTES + 1)
        except OSError as error:
            raise unreadable("path", path, error) from None
        if len(content) > MAX_BYTES or b"\0" in content:
            raise argument_error("path", str(path), FORMATS)
        self.lines = content.decode("utf-8", errors="replace").splitlines()
        self.words: list[str] = []
        self.at = 0

    def begin(self, line: int) -> None:
        """Take the words from this line on."""
        self.words, self.at = [word for text in self.lines[line:] for word in text.split("!")[0].split()], 0

    def of_line(self, line: int) -> None:
        """Take the words of one line only."""
        self.words, self.at = self.lines[line].split() if line < len(self.lines) else [], 0

    def numbers(self, count: int, what: str) -> np.ndarray:
        """The next numbers (count,). Raises ValueError if they are not there."""
        words = self.words[self.at : self.at + count]
        self.at += count
        try:
            numbers = np.array([float(word.replace("D", "E").replace("d", "e")) for word in words])
        except ValueError:
            numbers = np.zeros(0)
        if len(numbers) < count or count == 0:
            raise argument_error("path", str(self.path), f"a mesh with {count or 'some'} numbers of {what}")
        return numbers

    def counts(self, count: int, what: str, low: int, high: int) -> list[int]:
        """The next whole numbers from low to high. Raises ValueError for others."""
        numbers = self.numbers(count, what)
        if not ((numbers == np.rint(numbers)) & (numbers >= low) & (numbers <= high)).all():
            raise argument_error("path", str(self.path), f"whole numbers from {low} to {high} of {what}")
        return [int(one) for one in numbers]


def read_gdf(words: Words) -> Panels:
    """WAMIT's low-order panels: a title, ULEN and GRAV, ISX and ISY, the number of panels, and four corners of each.

    WAMIT user manual, section 6.1. Its lengths are in the unit of GRAV.
    """
    words.of_line(1)  # each line of the head may have words behind its numbers
    _, gravity = words.numbers(2, "ULEN and GRAV")
    words.of_line(2)
    x, y = words.counts(2, "ISX and ISY", 0, 1)
    words.of_line(3)
    count = words.counts(1, "the number of panels", 1, MAX_PANELS)[0]
    words.begin(4)
    vertices = words.numbers(12 * count, "panels").reshape(-1, 3)
    corners = np.arange(4 * count).reshape(-1, 4)
    unit = "ft" if FEET_GRAVITY[0] < gravity < FEET_GRAVITY[1] else "m"
    return Panels(vertices, corners, ("x",) * x + ("y",) * y, unit)


def read_nemoh(words: Words) -> Panels:
    """NEMOH's mesh: 2 and 1 for half a hull, rows of number and place up to 0, rows of four corners up to 0."""
    words.begin(0)
    _, half = words.counts(2, "the first line, 2 and the symmetry", 0, 2)
    places: dict[int, np.ndarray] = {}
    while True:
        number, *place = words.numbers(4, "points, ended by 0 0 0 0")
        if number == 0.0:
            break
        places[int(number)] = np.array(place)
    rows = []
    while (row := words.counts(4, "panels, ended by 0 0 0 0", 0, 10 * MAX_PANELS)) != [0, 0, 0, 0]:
        rows.append(row)
    return Panels(*by_number(words.path, places, rows), ("y",) if half == 1 else ())


def read_hams(words: Words) -> Panels:
    """HAMS's mesh: numbers of panels, nodes and symmetries, rows of nodes, rows of number, count and corners."""
    lines = [i for i, line in enumerate(words.lines) if line.strip() and not line.lstrip().startswith(("#", "-"))]
    if not lines:
        raise argument_error("path", str(words.path), "a mesh of HAMS")
    words.lines = [words.lines[i] for i in lines]
    words.begin(0)
    panel_count, node_count = words.counts(2, "panels and nodes", 1, MAX_PANELS)
    x, y = words.counts(2, "symmetries", 0, 1)
    nodes = words.numbers(4 * node_count, "nodes").reshape(-1, 4)
    rows = []
    for _ in range(panel_count):
        _, corners = words.counts(2, "panels", 1, MAX_PANELS)
        if corners not in (3, 4):
            raise argument_error("path", str(words.path), "panels of three or four corners")
        rows.append(words.counts(corners, "corners", 1, MAX_PANELS))
    places = {int(number): place for number, place in zip(nodes[:, 0], nodes[:, 1:], strict=True)}
    return Panels(*by_number(words.path, places, rows), ("x",) * x + ("y",) * y)


def by_number(path: Path, places: dict[int, np.ndarray], rows: list[list[int]]) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (n, 3) and corners (m, 4) of rows of numbers of places. Raises ValueError for a number without one."""
    unknown = {one for row in rows for one in row} - places.keys()
    if unknown or not rows:
        raise argument_error("path", f"{path}, point {min(unknown, default=0)}", "panels between existing points")
    order = {number: i for i, number in enumerate(places)}
    corners = [[order[one] for one in (row if len(row) == 4 else [*row, row[-1]])] for row in rows]
    return np.array([*places.values()]), np.array(corners, np.int64)


PANELS = {".gdf": read_gdf, ".dat": read_nemoh, ".pnl": read_hams}
