"""The mesh of a sea: with shaders in browsers that take them, and as stock viser draws it in the others.

The surface travels as packed displacements, slopes and foam (`app/formats/packing.py`), its material as a few numbers,
both as the vertices of hidden meshes. `js/sea/water.js` (see `app/render/injection.py`) makes water of them. A browser
that does not take the shader is sent the vertices themselves and draws them in one colour, with further meshes for
foam, slick and grid.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import viser

from app.formats.surface_fields import SurfaceNumbers, pack_fields, set_surface_fields
from app.render.cameras import lowest_camera
from app.render.handles.viser_inside import set_arrays
from app.render.injection import add_data_mesh, injector_of
from app.render.material import WATER_UNIFORMS, Grid, Material, Waterline, as_bytes, uniform_table, waterline_table
from app.render.skies import CAMERA_RANGE
from sim.ocean.radial.radial_grid import RadialGrid

RIPPLE_PERIOD = 1024.0  # [s] after which ripples start again: their phases are single precision in the browser
MIN_STEP, MAX_STEP = 2.5e-4, 4e-3  # [m] to which displacements are rounded before they are sent
RECORDED_STEP = 2e-3  # [m] the same if there is no camera: in a replay
STEP_ANGLE = 7e-4  # the step over the height of the lowest camera: half a pixel at 1080 rows and 75 degrees
SEA_STATE, GRID_MIDDLE = map(WATER_UNIFORMS.index, ("seaState", "gridMiddle"))  # rows that change in each frame
PLAIN_FOAM_COLOUR = (235, 240, 242)
PLAIN_MESH_DEPTH = 0.5  # [m] below the water at which a plain mesh is hidden
PLAIN_MESH_HEIGHT = 0.02  # [m] above the water at which it shows
PLAIN_FOAM_LIMIT = 0.35  # foam above which the plain foam mesh shows


class Tile(NamedTuple):
    """A square periodic tile of sea."""

    rows: int  # of points along x
    cols: int  # along y
    length: float  # [m] of a side


class DrawnWater:
    """A sea that changes every frame, simulated on the points of `shape`; the browser draws it up to the horizon.

    The points of a tile are (rows, cols): [i, j] rests at x = i length/rows, y = j length/cols. The tile is periodic;
    the row and column that close it are added here. Those of a radial grid are (1, n), in the grid's order.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        name: str,
        shape: Tile | RadialGrid,
        material: Material | None = None,
    ) -> None:
        self.name = name
        self._server = server
        self._material = material or Material()
        self._sea_state = (0.0, 1.0, 0.0)  # time [s], significant height [m], mean square slope
        self._middle = (0.0, 0.0)  # [m] of the rings
        self._is_tile = isinstance(shape, Tile)
        if isinstance(shape, Tile):
            rows, cols, length = shape
            i, j = np.meshgrid(np.arange(rows + 1), np.arange(cols + 1), indexing="ij")
            rest = np.stack([i * length / rows, j * length / cols, 0.0 * i], axis=-1)
            corner = (i * (cols + 1) + j)[:-1, :-1].ravel()
            a, b, c, d = corner, corner + cols + 1, corner + cols + 2, corner + 1
            self._faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]).astype(np.uint32)
            self._grid, self._columns = Grid(rows + 1, cols + 1, length), cols + 1
        else:
            rows, cols = 1, len(shape)
            rest = np.column_stack([shape.x, shape.y, np.zeros(len(shape))])[None]
            self._faces = shape.faces
            self._grid = Grid(shape.rings + 1, shape.spokes, float(shape.radii[-1]), shape.ring_law)
            self._columns = shape.spokes
        points = rest.reshape(-1, 3).astype(np.float32)
        self._rest = np.ascontiguousarray(points[:, :2].T)
        self._fields = np.empty((6, self._rest.shape[1]), np.float32)  # displacement, slopes and foam
        self.mesh = server.scene.add_mesh_simple(
            name, points, self._faces, color=self._plain_color(), cast_shadow=False, receive_shadow=False
        )
        self._plain_meshes: dict[str, viser.MeshHandle] = {}
        self._injector = injector_of(server)
        if self._injector is not None:
            add_data_mesh(server, f"{name}/water_rest", points)
            level = np.ascontiguousarray(rest[:rows, :cols])
            surface = self._set_fields(level, 0.0 * level[..., :2], 0.0 * level[..., 2])
            self._surface_mesh = add_data_mesh(server, f"{name}/water_surface", self._packed(surface))
            self._uniforms = self._uniform_table()
            self._material_mesh = add_data_mesh(server, f"{name}/water_material", self._uniforms)
            self._waterline_mesh = add_data_mesh(server, f"{name}/water_lines", waterline_table(()))
            self._injector.watch(name)

    def set_surface(
        self,
        vertices: np.ndarray,
        slopes: np.ndarray,
        foam: np.ndarray,
        time: float = 0.0,
        middle: tuple[float, float] = (0.0, 0.0),
    ) -> np.ndarray | None:
        """Draw this surface; call it where a picture is handed over as one. Arrays are copied.

        Returns what `pack_fields` made of it for the browsers, to be read only; None if none of them has shaders.

        vertices: (rows, cols, 3) [m]. slopes: (rows, cols, 2), dz/dx and dz/dy of the displaced surface. foam:
        (rows, cols), 0..1. time [s] moves ripples and clouds. middle: x, y [m] of the middle of a radial grid.
        """
        active, packed = self.has_shader, None
        surface = self._set_fields(vertices, slopes, foam)
        if active is not True:
            points = self._points()
            set_arrays(self.mesh, vertices=points)
            if active is False:
                self._draw_plain(points)
        if self._injector is not None:
            packed = self._packed(surface)
            set_arrays(self._surface_mesh, vertices=packed)
            height = 4.0 * math.sqrt(surface.height_variance)
            self._sea_state = float(time) % RIPPLE_PERIOD, height, surface.square_slope
            self._uniforms[SEA_STATE] = self._sea_state
            self._middle = middle
            self._uniforms[GRID_MIDDLE, :2] = middle
            set_arrays(self._material_mesh, vertices=self._uniforms)
        return packed

    def set_material(self, material: Material) -> None:
        """Change how it looks from the next frame on."""
        self._material = material
        self.mesh.color = self._plain_color()
        if self._injector is not None:
            self._uniforms = self._uniform_table()
            set_arrays(self._material_mesh, vertices=self._uniforms)

    def set_waterlines(self, waterlines: Sequence[Waterline]) -> None:
        """Set the bodies in the water from the next frame on; only the shader draws their waterlines."""
        if self._injector is not None:
            set_arrays(self._waterline_mesh, vertices=waterline_table(waterlines))

    @property
    def has_shader(self) -> bool | None:
        """True if every browser draws it with its shader, False if one does not, None while not yet known."""
        return self._injector.is_active(self.name) if self._injector is not None else False

    def remove(self) -> None:
        """Remove it from the scene."""
        if self._injector is not None:
            self._injector.unwatch(self.name)
        self.mesh.remove()

    def _set_fields(self, vertices: np.ndarray, slopes: np.ndarray, foam: np.ndarray) -> SurfaceNumbers:
        """Keep a surface. The row and column that close a tile have the displacement of the first to the last bit."""
        return set_surface_fields(self._fields, vertices, slopes, foam, self._rest)

    def _packed(self, surface: SurfaceNumbers) -> np.ndarray:
        """Displacement, slopes and foam of all vertices, as `js/sea/water.js` reads them.

        Displacements are finer the nearer a camera can be to the water: no drawn point moves by half a pixel.
        """
        camera = lowest_camera(self._server)
        above = (camera or 0.0) - surface.highest
        step = RECORDED_STEP if camera is None else min(max(STEP_ANGLE * above, MIN_STEP), MAX_STEP)
        return pack_fields(self._fields, surface, step, self._columns)

    def _points(self) -> np.ndarray:
        """All vertices (n, 3) [m] of the surface that is kept."""
        return np.stack([self._fields[0] + self._rest[0], self._fields[1] + self._rest[1], self._fields[2]], axis=1)

    def _plain_color(self) -> tuple[int, int, int]:
        """The colour of the sea in browsers without the shader."""
        return as_bytes(self._material.deep_color)

    def _uniform_table(self) -> np.ndarray:
        """The uniforms of the shader, as `material.uniform_table` orders them."""
        return uniform_table(self._material, self._sea_state, self._grid, self._middle)

    def _draw_plain(self, points: np.ndarray) -> None:
        """Draw foam, slick, grid and far sea by viser's public API, for browsers without the shader.

        points: (n, 3) [m], all vertices.
        """
        z = points[:, 2]
        foam = raised(points, self._fields[5] > PLAIN_FOAM_LIMIT)
        self._set_plain_mesh("plain_foam", foam, self._faces, color=PLAIN_FOAM_COLOUR)
        slick = self._material.slick
        if slick is not None or "plain_slick" in self._plain_meshes:
            (x, y), radius = (slick.centre, slick.radius) if slick is not None else ((0.0, 0.0), 0.0)
            inside = np.hypot(points[:, 0] - x, points[:, 1] - y) < radius
            colour = as_bytes(self._material.seen_color(slick.thickness if slick is not None else 0.0))
            self._set_plain_mesh("plain_slick", raised(points, inside), self._faces, color=colour)
        if self._material.wireframe or "plain_wire" in self._plain_meshes:
            wire = self._set_plain_mesh("plain_wire", points, self._faces, wireframe=True)
            wire.visible = self._material.wireframe
        if self._is_tile and "plain_sea" not in self._plain_meshes:
            x, y = np.array([[-1, 1, 1, -1], [-1, -1, 1, 1]]) * CAMERA_RANGE / 4
            corners = np.stack([x, y, np.full(4, 2 * float(z.min()) - PLAIN_MESH_DEPTH)], 1)
            self._set_plain_mesh("plain_sea", corners, np.array([[0, 1, 2], [0, 2, 3]]), color=self.mesh.color)

    def _set_plain_mesh(self, suffix: str, vertices: np.ndarray, faces: np.ndarray, **mesh: Any) -> viser.MeshHandle:
        """Make or move a mesh for browsers without shaders; the others hide it (`js/sea/water.js`)."""
        vertices = vertices.astype(np.float32)
        if suffix in self._plain_meshes:
            set_arrays(self._plain_meshes[suffix], vertices=vertices)
        else:
            self._plain_meshes[suffix] = self._server.scene.add_mesh_simple(
                f"{self.name}/{suffix}",
                vertices,
                faces.astype(np.uint32),
                cast_shadow=False,
                receive_shadow=False,
                **mesh,
            )
        return self._plain_meshes[suffix]


def raised(points: np.ndarray, mask: np.ndarray) -> np.ndarray:
    """A copy of a surface of points (n, 3) [m]: just above it where `mask`, (n,), is true, else below."""
    surface = points.copy()
    surface[:, 2] += np.where(mask, PLAIN_MESH_HEIGHT, -PLAIN_MESH_DEPTH)
    return surface
