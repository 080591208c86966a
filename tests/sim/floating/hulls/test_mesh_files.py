"""Meshes as people have them: panels of half hulls, gaps, shells without a deck, other units."""

import math
from pathlib import Path

import numpy as np
import pytest
import trimesh

from sim.floating import Hull, equilibrium_draft
from sim.floating.hulls.closed_mesh import enclosed_volume, open_edges
from sim.floating.hulls.hull import MeshReading, shape_from_file
from sim.floating.hulls.mesh_repair import capped, filled, loops_of, mirrored, open_boundary, remedy, repaired, welded
from tests.refusals import assert_refused

# A wedge 20 m long, 6 m wide, 3 m high, its deck at z = 3 and its bottom 2 m wide: 240 m3.
VERTICES = np.array(
    [[-10, -3, 3], [10, -3, 3], [10, 3, 3], [-10, 3, 3], [-10, -1, 0], [10, -1, 0], [10, 1, 0], [-10, 1, 0]], float
)
DECK = np.array([[0, 1, 2], [0, 2, 3]])
SIDES = np.array(
    [[4, 6, 5], [4, 7, 6], [0, 4, 5], [0, 5, 1], [1, 5, 6], [1, 6, 2], [2, 6, 7], [2, 7, 3], [3, 7, 4], [3, 4, 0]]
)
VOLUME, DRAFT = 240.0, 1.242  # [m3], [m] at 300 kg/m3
# Half of its wet surface, with the deck at the waterline z = 0: bottom, side, bow and stern.
HALF = np.array(
    [[-10, 0, 0], [10, 0, 0], [10, 3, 0], [-10, 3, 0], [-10, 0, -3], [10, 0, -3], [10, 1, -3], [-10, 1, -3]], float
)
PANELS = np.array([[4, 7, 6, 5], [3, 2, 6, 7], [1, 5, 6, 2], [0, 3, 7, 4]])


def stl(path: Path, vertices: np.ndarray, faces: np.ndarray) -> Path:
    """A file of these triangles."""
    trimesh.Trimesh(vertices, faces, process=False).export(path)
    return path


def gdf(scale: float = 1.0, gravity: float = 9.80665) -> str:
    """Panels of the half as WAMIT has them, a mirror at y = 0."""
    corners = "".join("{:g} {:g} {:g}\n".format(*(scale * HALF[i])) for row in PANELS for i in row)
    return f"half a wedge\n1.0 {gravity} ULEN GRAV\n0  1  ISX ISY\n{len(PANELS)}\n{corners}"


def nemoh() -> str:
    """The same as NEMOH has them."""
    points = "".join("{} {:g} {:g} {:g}\n".format(i, *place) for i, place in enumerate(HALF, start=1))
    panels = "".join("{} {} {} {}\n".format(*(row + 1)) for row in PANELS)
    return f"2 1\n{points}0 0. 0. 0.\n{panels}0 0 0 0\n"


def hams() -> str:
    """The same as HAMS has them, one panel as two triangles."""
    points = "".join("{} {:g} {:g} {:g}\n".format(i, *place) for i, place in enumerate(HALF, start=1))
    rows = [*(row + 1 for row in PANELS[:-1]), PANELS[-1][:3] + 1, PANELS[-1][[0, 2, 3]] + 1]
    panels = "".join(f"{i} {len(row)} {' '.join(map(str, row))}\n" for i, row in enumerate(rows, start=1))
    return (
        f"    ------Hull Mesh File------\n\n    # Number of Panels, Nodes, X-Symmetry and Y-Symmetry\n"
        f" {len(rows)} {len(HALF)} 0 1\n\n    #Start Definition of Node Coordinates ! number x y z\n{points}"
        f"   #End Definition of Node Coordinates\n    #Start Definition of Node Relations\n{panels}"
        f"    #End Definition of Node Relations\n    ------End Hull Mesh File------\n"
    )


@pytest.mark.parametrize(("name", "text"), [("a.gdf", gdf()), ("a.dat", nemoh()), ("a.pnl", hams())])
def test_panels_of_half_a_hull_are_completed_by_their_mirror_and_a_deck(tmp_path, name, text):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    assert_refused(str(path), lambda: Hull.load(path), "--cap deck closes it")
    hull = Hull.load(path, cap="deck")
    assert hull.volume == pytest.approx(VOLUME)
    assert hull.size == pytest.approx([20.0, 6.0, 3.0])
    assert hull.centre == pytest.approx([0.0, 0.0, -1.25])


def test_a_gdf_file_in_feet_is_read_in_feet(tmp_path):
    path = tmp_path / "feet.gdf"
    path.write_text(gdf(1 / 0.3048, 32.174), encoding="utf-8")
    assert Hull.load(path, cap="deck").volume == pytest.approx(VOLUME, rel=1e-5)
    assert Hull.load(path, unit="m", cap="deck").size[0] == pytest.approx(20.0 / 0.3048, rel=1e-5)


@pytest.mark.parametrize("ending", ["msh", "vtu", "vtk"])
def test_files_of_meshio_are_read(tmp_path, ending):
    meshio = pytest.importorskip("meshio")
    path = tmp_path / f"wedge.{ending}"
    cells = [("triangle", np.concatenate([DECK, SIDES[2:]])), ("quad", np.array([[4, 7, 6, 5]]))]
    form = {"msh": "gmsh22"}.get(ending)
    meshio.Mesh(VERTICES, cells).write(path, file_format=form)
    assert Hull.load(path).volume == pytest.approx(VOLUME)
    meshio.Mesh(VERTICES, [("line", np.array([[0, 1]]))]).write(path, file_format=form)
    assert_refused("path", lambda: Hull.load(path), "triangles and quadrangles")


def test_a_gap_is_welded(tmp_path):
    corners = VERTICES[np.concatenate([DECK, SIDES])] + np.random.default_rng(1).uniform(-1e-6, 1e-6, (12, 3, 3))
    path = tmp_path / "gaps.obj"
    stl(path, corners.reshape(-1, 3), np.arange(36).reshape(-1, 3))
    assert_refused(str(path), lambda: Hull.load(path), "--weld 1e-6 closes it")
    assert Hull.load(path, weld=1e-5).volume == pytest.approx(VOLUME, rel=1e-5)


@pytest.mark.parametrize("shift", [0.0, 0.3, 0.5, 0.77])
def test_welding_joins_what_is_near_wherever_the_cells_lie(shift):
    points = np.array([[0.0, 0, 0], [0.9, 0, 0], [0, 10, 0], [0, 10.9, 0.3], [50, 0, 0]]) + shift
    _, faces = welded(points, np.array([[0, 2, 4], [1, 3, 4], [0, 1, 4]]), 1.0)
    assert len(faces) == 2
    assert (faces[0] == faces[1]).all()


def test_the_other_half_is_added(tmp_path):
    half = np.vstack([HALF + [0.0, 0.0, 3.0]])
    faces = np.concatenate([PANELS[:, [0, 1, 2]], PANELS[:, [0, 2, 3]], [[0, 1, 2], [0, 2, 3]]])
    path = stl(tmp_path / "half.stl", half, faces)
    assert_refused(str(path), lambda: Hull.load(path), "y 0 to 0")
    assert_refused(str(path), lambda: Hull.load(path), "--mirror y closes it")
    assert equilibrium_draft(Hull.load(path, mirror="y"), 300.0) == pytest.approx(DRAFT, abs=1e-3)
    # with the plane between the halves in the file, too
    closed = np.concatenate([faces, [[0, 4, 5], [0, 5, 1]]])
    assert not open_edges(closed)
    assert enclosed_volume(*mirrored(half, closed, "y", 0.0)) == pytest.approx(2 * enclosed_volume(half, closed))
    assert_refused("mirror", lambda: Hull.load(path, mirror="x"), "x from -10 to 10 m")


def test_a_deck_is_added_and_a_bottom_is_not(tmp_path):
    path = stl(tmp_path / "shell.stl", VERTICES, SIDES)
    assert_refused(
        str(path),
        lambda: Hull.load(path),
        "4 edges without exactly one opposite, at x -10 to 10, y -3 to 3, z 3 to 3 m",
    )
    hull = Hull.load(path, cap="deck")
    assert hull.volume == pytest.approx(VOLUME)
    assert len(hull.faces) == 12
    upside_down = stl(tmp_path / "bell.stl", VERTICES * [1, 1, -1], SIDES[:, ::-1])
    assert_refused("cap", lambda: Hull.load(upside_down, cap="deck"), "upper half")
    assert_refused(str(upside_down), lambda: Hull.load(upside_down), "a closed mesh")


def test_a_deck_with_bays_and_corners_in_line_is_filled_exactly():
    """A star, with a corner in the middle of each side; its area is that of the loop."""
    angle = np.linspace(0.0, 2 * math.pi, 14, endpoint=False)
    radius = np.where(np.arange(14) % 2, 1.0, 3.0)
    star = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    points = np.empty((28, 2))
    points[::2], points[1::2] = star, 0.5 * (star + np.roll(star, -1, axis=0))
    for loop in (list(range(28)), list(range(28))[::-1]):
        found = filled(points, loop)
        a, b, c = (points[found[:, i]] for i in range(3))
        areas = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
        x, y = points[loop].T
        assert areas.sum() == pytest.approx(0.5 * (x * np.roll(y, -1) - np.roll(x, -1) * y).sum())
        assert np.abs(areas).sum() == pytest.approx(abs(areas.sum()))
        assert len(found) == 26
    crossed = np.array([[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 1.0]])
    assert_refused("cap", lambda: filled(crossed, [0, 1, 2, 3]), "cross itself")


def test_each_column_of_a_platform_gets_its_deck():
    other = len(VERTICES)
    vertices, faces = np.concatenate([VERTICES, VERTICES + [0, 20, 0]]), np.concatenate([SIDES, SIDES + other])
    assert len(loops_of(open_boundary(faces))) == 2
    assert enclosed_volume(*capped(vertices, faces)) == pytest.approx(2 * VOLUME)


def test_advice_names_all_options_that_a_mesh_needs():
    half = HALF + [0.0, 0.0, 3.0]
    corners = half[np.concatenate([PANELS[:, [0, 1, 2]], PANELS[:, [0, 2, 3]]])]
    corners = corners + np.random.default_rng(2).uniform(-2e-6, 2e-6, corners.shape) * [1, 0, 1]
    mesh = corners.reshape(-1, 3), np.arange(24).reshape(-1, 3)
    assert remedy(*mesh) == "--weld 1e-5 --mirror y --cap deck"
    assert enclosed_volume(*repaired(*mesh, 1e-5, "y", "deck")) == pytest.approx(VOLUME, rel=1e-5)
    turned = np.concatenate([DECK[:, ::-1], SIDES])
    assert remedy(VERTICES, turned) == ""


@pytest.mark.parametrize(("unit", "scale"), [("m", 1.0), ("cm", 100.0), ("mm", 1000.0), ("ft", 1 / 0.3048)])
def test_a_unit_is_that_of_the_file(tmp_path, unit, scale):
    path = stl(tmp_path / "wedge.stl", scale * VERTICES, np.concatenate([DECK, SIDES]))
    assert Hull.load(path, unit=unit).size == pytest.approx([20.0, 6.0, 3.0], rel=1e-5)
    assert shape_from_file(path, reading=MeshReading(unit)).build().volume == pytest.approx(VOLUME, rel=1e-5)


def test_a_mesh_of_20_km_is_told_of_millimetres(tmp_path):
    path = stl(tmp_path / "wedge.stl", 1000.0 * VERTICES, np.concatenate([DECK, SIDES]))
    assert_refused(str(path), lambda: Hull.load(path), "--hull-unit mm")
    assert_refused("unit", lambda: Hull.load(path, unit="inch"), "m, cm, mm, ft")
    assert_refused("weld", lambda: Hull.load(path, weld=-1.0), "at least 0 m")
    assert_refused("mirror", lambda: Hull.load(path, mirror="z"), "x, y")
    assert_refused("cap", lambda: Hull.load(path, cap="keel"), "deck")


# --- panels whose neighbours do not share nodes ---


def prism(sides: int, pieces: int, bottom: int, radius: float = 5.0, depth: float = 10.0) -> str:
    """GDF of a cylinder of panels, open at the water: on each side `pieces` panels abreast, at the bottom `bottom`."""
    angle = np.linspace(0.0, 2.0 * math.pi, sides + 1)
    corners = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])

    def along(i: int, count: int) -> list[np.ndarray]:
        return [corners[i] + (corners[i + 1] - corners[i]) * share for share in np.linspace(0.0, 1.0, count + 1)]

    panels = []
    for i in range(sides):
        for a, b in zip(along(i, pieces)[:-1], along(i, pieces)[1:], strict=True):
            panels.append([(*a, 0.0), (*a, -depth), (*b, -depth), (*b, 0.0)])
        for a, b in zip(along(i, bottom)[:-1], along(i, bottom)[1:], strict=True):
            panels.append([(0.0, 0.0, -depth), (*b, -depth), (*a, -depth), (*a, -depth)])
    rows = "".join("{:.6f} {:.6f} {:.6f}\n".format(*place) for panel in panels for place in panel)
    return f"a cylinder\n1.0 9.80665\n0 0\n{len(panels)}\n{rows}"


@pytest.mark.parametrize(("sides", "pieces", "bottom"), [(24, 2, 1), (12, 5, 1), (8, 1, 3), (12, 2, 3), (36, 1, 1)])
def test_a_fine_side_on_a_coarse_bottom_is_closed_with_its_volume(tmp_path, sides, pieces, bottom):
    path = tmp_path / "cylinder.gdf"
    path.write_text(prism(sides, pieces, bottom), encoding="utf-8")
    assert_refused(str(path), lambda: Hull.load(path), "--cap deck closes it")
    volume = 0.5 * sides * 25.0 * math.sin(2.0 * math.pi / sides) * 10.0
    assert Hull.load(path, cap="deck").volume == pytest.approx(volume, rel=1e-6)


def test_a_box_with_one_bottom_panel_more_than_its_sides_is_closed(tmp_path):
    """Also where its half is mirrored, and in a file of triangles."""
    sides = [[(-5, 2, -2), (-5, 2, 0), (5, 2, 0), (5, 2, -2)], [(-5, 0, -2), (-5, 0, 0), (-5, 2, 0), (-5, 2, -2)],
             [(5, 2, -2), (5, 2, 0), (5, 0, 0), (5, 0, -2)]]  # fmt: skip
    bottom = [[(x, 0, -2), (x, 2, -2), (x + 2, 2, -2), (x + 2, 0, -2)] for x in range(-5, 5, 2)]
    corners = np.array([*sides, *bottom], float)
    rows = "".join("{:g} {:g} {:g}\n".format(*place) for panel in corners for place in panel)
    path = tmp_path / "box.gdf"
    path.write_text(f"half a box\n1.0 9.80665\n0 0\n{len(corners)}\n{rows}", encoding="utf-8")
    hull = Hull.load(path, mirror="y", cap="deck")
    assert hull.volume == pytest.approx(80.0)
    assert_refused("cap", lambda: Hull.load(path, cap="deck"), "--mirror y --cap deck closes it")
    triangles = corners[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)
    made = stl(tmp_path / "box.stl", triangles, np.arange(len(triangles)).reshape(-1, 3))
    assert Hull.load(made, weld=1e-5, mirror="y", cap="deck").volume == pytest.approx(80.0, rel=1e-5)


def test_a_hole_with_nodes_near_its_edges_stays_open():
    """Edges are divided only where a node lies on them: one that is a centimetre away does not."""
    vertices = np.concatenate([VERTICES, [[0.0, -3.0, 3.01]]])
    faces = np.concatenate([DECK, SIDES[SIDES[:, 0] != 0], [[0, 4, 8], [4, 5, 8], [5, 1, 8]]])
    points, found = repaired(vertices, faces, 0.0, "", "")
    assert open_edges(found)
    vertices[8, 2] = 3.0
    points, found = repaired(vertices, faces, 0.0, "", "")
    assert not open_edges(found)
    assert enclosed_volume(points, found) == pytest.approx(VOLUME)


def test_a_file_with_two_bottom_panels_between_its_sides_is_a_box():
    path = Path(__file__).parent.parent / "field" / "panels_hanging_nodes.gdf"
    assert Hull.load(path, cap="deck").volume == pytest.approx(80.0)
