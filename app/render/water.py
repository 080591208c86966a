"""The mesh of a sea: with shaders in browsers that take them, and as stock viser draws it in the others.

The surface travels packed, as displacements, slopes and foam (`sim/packing.py`), and its material as a few numbers,
both as the vertices of hidden meshes. `js/water.js` (see `app/render/injection.py`) makes water of them. A browser that
does not take the shader is sent the vertices themselves and draws them in one colour, with further meshes for foam,
slick and grid.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import viser

from app.render.cameras import lowest_camera
from app.render.injection import add_data_mesh, injector_of
from app.render.material import Material, Waterline, as_bytes, uniform_table, waterline_table
from app.render.skies import CAMERA_RANGE
from sim.packing import FOAM_STEP, SLOPE_STEP, pack
from sim.validation import argument_error

RIPPLE_PERIOD = 1024.0  # [s] after which ripples start again: their phases are single precision in the browser
MIN_STEP, MAX_STEP = 2.5e-4, 4e-3  # [m] to which displacements are rounded before they are sent
RECORDED_STEP = 2e-3  # [m] the same where there is no camera: in a replay
STEP_ANGLE = 7e-4  # the step over the height of the lowest camera: half a pixel at 1080 rows and 75 degrees
PLAIN_FOAM_COLOUR = (235, 240, 242)
PLAIN_MESH_DEPTH = 0.5  # [m] below the water at which a plain mesh is hidden
PLAIN_MESH_HEIGHT = 0.02  # [m] above the water at which it shows
PLAIN_FOAM_LIMIT = 0.35  # foam above which the plain foam mesh shows


class Water:
    """A sea of rows x cols points that changes every frame.

    Without `faces` the points are a square periodic tile of side length [m]: [i, j] rests at x = i length/rows,
    y = j length/cols, the row and column that close the tile are added here, and tiles x tiles (odd) copies of it are
    drawn from the same buffers. With `faces`, (m, 3) indices into the rows * cols points, it is a mesh of any shape
    around the origin, drawn once, with radius length [m]; its points rest about `rest`, (rows * cols, 3) [m], which
    lies in rows of `columns` neighbours.
    plain: draw without shaders, by viser's public API. Raises ValueError for an even number of tiles.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        name: str,
        rows: int,
        cols: int,
        length: float,
        *,
        tiles: int = 1,
        faces: np.ndarray | None = None,
        rest: np.ndarray | None = None,
        columns: int = 1,
        material: Material | None = None,
        plain: bool = False,
    ) -> None:
        if tiles < 1 or tiles % 2 == 0:
            raise argument_error("tiles", tiles, "an odd number")
        self.name = name
        self._server = server
        self._shape = (rows, cols)
        self._length = length
        self._grid = faces is None
        self._tiles = tiles if self._grid else 1
        self._material = material or Material()
        self._sea_state = (0.0, 1.0, 0.0)  # time [s], significant height [m], mean square slope
        if faces is None:
            i, j = np.meshgrid(np.arange(rows + 1), np.arange(cols + 1), indexing="ij")
            rest = np.stack([i * length / rows, j * length / cols, 0.0 * i], axis=-1)
            corner = (i * (cols + 1) + j)[:-1, :-1].ravel()
            a, b, c, d = corner, corner + cols + 1, corner + cols + 2, corner + 1
            self._faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]).astype(np.uint32)
        else:
            rest = np.zeros((rows, cols, 3)) if rest is None else rest.reshape(rows, cols, 3)
            self._faces = np.asarray(faces, np.uint32)
        self._vertices = rest.astype(np.float32)
        self._rest = np.ascontiguousarray(self._vertices.reshape(-1, 3).T)  # x, y, z
        self._columns = cols + 1 if self._grid else columns
        self._fields = np.empty((6, self._rest.shape[1]), np.float32)  # displacement, slopes and foam
        self._slope_and_foam = np.zeros_like(self._vertices)
        self.mesh = server.scene.add_mesh_simple(
            name,
            self._vertices.reshape(-1, 3),
            self._faces,
            color=self._plain_color(),
            cast_shadow=False,
            receive_shadow=False,
        )
        self._plain_meshes: dict[str, viser.MeshHandle] = {}
        self._injector = None if plain else injector_of(server)
        if self._injector is not None:
            add_data_mesh(server, f"{name}/water_rest", self._vertices.reshape(-1, 3))
            self._surface_mesh = add_data_mesh(server, f"{name}/water_surface", self._packed())
            self._material_mesh = add_data_mesh(server, f"{name}/water_material", self._uniforms())
            self._waterline_mesh = add_data_mesh(server, f"{name}/water_lines", waterline_table(()))
            self._injector.watch(name)

    def set_surface(self, vertices: np.ndarray, slopes: np.ndarray, foam: np.ndarray, time: float = 0.0) -> None:
        """Draw this surface; call it where a picture is handed over as one. Arrays are copied.

        vertices: (rows, cols, 3) [m]. slopes: (rows, cols, 2), dz/dx and dz/dy of the displaced surface. foam:
        (rows, cols), 0..1. time [s] moves ripples and clouds.
        """
        rows, cols = self._shape
        slope_and_foam = self._slope_and_foam
        fields = ((self._vertices, vertices), (slope_and_foam[..., :2], slopes), (slope_and_foam[..., 2], foam))
        for target, source in fields:
            target[:rows, :cols] = source
            if self._grid:
                target[rows, :cols] = source[0]
                target[:, cols] = target[:, 0]
        if self._grid:
            self._vertices[rows, :, 0] += self._length
            self._vertices[:, cols, 1] += self._length
        active = self.has_shader
        if active is not True:
            self.mesh.vertices = self._vertices.reshape(-1, 3)
        if self._injector is not None:
            self._surface_mesh.vertices = self._packed()
            height = 4.0 * float(np.std(vertices[..., 2]))
            self._sea_state = (float(time) % RIPPLE_PERIOD, height, float(np.vdot(slopes, slopes)) / (rows * cols))
            self._material_mesh.vertices = self._uniforms()
        if active is False:
            self._draw_plain()

    def set_material(self, material: Material) -> None:
        """Change how it looks from the next frame on."""
        self._material = material
        self.mesh.color = self._plain_color()
        if self._injector is not None:
            self._material_mesh.vertices = self._uniforms()

    def set_waterlines(self, waterlines: Sequence[Waterline]) -> None:
        """What stands in the water from the next frame on; browsers without the shader do not draw it."""
        if self._injector is not None:
            self._waterline_mesh.vertices = waterline_table(waterlines)

    @property
    def has_shader(self) -> bool | None:
        """True if every browser draws it with its shader, False if one does not, None while not yet known."""
        return self._injector.is_active(self.name) if self._injector is not None else False

    def remove(self) -> None:
        """Remove it from the scene."""
        if self._injector is not None:
            self._injector.unwatch(self.name)
        self.mesh.remove()

    def _packed(self) -> np.ndarray:
        """Displacement, slopes and foam of all vertices, as `js/water.js` reads them.

        Displacements are finer the nearer a camera can be to the water: no drawn point moves by half a pixel.
        """
        fields = self._fields
        np.subtract(self._vertices.reshape(-1, 3).T, self._rest, out=fields[:3])
        fields[3:] = self._slope_and_foam.reshape(-1, 3).T
        if self._grid:
            # Its last row and column have the displacement of the first to the last bit, or tiles would part.
            whole = fields.reshape(6, self._shape[0] + 1, self._shape[1] + 1)
            whole[:, -1] = whole[:, 0]
            whole[:, :, -1] = whole[:, :, 0]
        centre = np.round(fields[:3].mean(axis=1))  # of a mesh that has moved as a whole
        fields[:3] -= centre[:, None]
        camera = lowest_camera(self._server)
        above = (camera or 0.0) - float(fields[2].max() + centre[2])
        step = RECORDED_STEP if camera is None else min(max(STEP_ANGLE * above, MIN_STEP), MAX_STEP)
        steps = (step, step, step, SLOPE_STEP, SLOPE_STEP, FOAM_STEP)
        return pack(fields, steps, self._columns, (*centre, 0.0, 0.0, 0.0))

    def _plain_color(self) -> tuple[int, int, int]:
        """The colour of the sea in browsers without the shader."""
        return as_bytes(self._material.deep_color)

    def _uniforms(self) -> np.ndarray:
        """The uniforms of the shader, as `material.uniform_table` orders them."""
        rows, cols = (self._shape[0] + 1, self._shape[1] + 1) if self._grid else (0, 0)
        return uniform_table(self._material, self._sea_state, (rows, cols, self._length), self._tiles)

    def _draw_plain(self) -> None:
        """Draw what viser's public API alone can of foam, slick, grid and far sea, where a browser has no shader."""
        z = self._vertices[..., 2]
        foam = self._raised(self._slope_and_foam[..., 2] > PLAIN_FOAM_LIMIT)
        self._set_plain_mesh("plain_foam", foam, self._faces, color=PLAIN_FOAM_COLOUR)
        slick = self._material.slick
        if slick is not None or "plain_slick" in self._plain_meshes:
            (x, y), radius = (slick.centre, slick.radius) if slick is not None else ((0.0, 0.0), 0.0)
            inside = np.hypot(self._vertices[..., 0] - x, self._vertices[..., 1] - y) < radius
            colour = as_bytes(self._material.seen_color(slick.thickness if slick is not None else 0.0))
            self._set_plain_mesh("plain_slick", self._raised(inside), self._faces, color=colour)
        if self._material.wireframe or "plain_wire" in self._plain_meshes:
            wire = self._set_plain_mesh("plain_wire", self._vertices.reshape(-1, 3), self._faces, wireframe=True)
            wire.visible = self._material.wireframe
        if self._grid and "plain_sea" not in self._plain_meshes:
            x, y = np.array([[-1, 1, 1, -1], [-1, -1, 1, 1]]) * CAMERA_RANGE / 4
            corners = np.stack([x, y, np.full(4, 2 * float(z.min()) - PLAIN_MESH_DEPTH)], 1)
            self._set_plain_mesh("plain_sea", corners, np.array([[0, 1, 2], [0, 2, 3]]), color=self.mesh.color)

    def _raised(self, shown: np.ndarray) -> np.ndarray:
        """The surface once more, (n, 3) [m]: just above itself where `shown`, (rows, cols), is true, else below."""
        surface = self._vertices.copy()
        surface[..., 2] += np.where(shown, PLAIN_MESH_HEIGHT, -PLAIN_MESH_DEPTH)
        return surface.reshape(-1, 3)

    def _set_plain_mesh(self, suffix: str, vertices: np.ndarray, faces: np.ndarray, **mesh: Any) -> viser.MeshHandle:
        """Make or move a mesh for browsers without shaders; the others hide it (`js/water.js`)."""
        vertices = vertices.astype(np.float32)
        if suffix in self._plain_meshes:
            self._plain_meshes[suffix].vertices = vertices
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
