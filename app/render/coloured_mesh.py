"""A mesh with vertices that move and change colour in every frame, which stock viser does not have.

Vertices and colours travel packed in a hidden mesh. `js/scene/vertex_colors.js` gives them to the drawn mesh and to its
shader (see `app/render/injection.py`). A browser without that shader is sent the vertices themselves, and draws them in
one colour.
"""

from typing import Any

import numpy as np
import viser

from app.formats.packing import pack
from app.render.handles.viser_inside import set_arrays
from app.render.injection import add_data_mesh, injector_of
from sim.validation import argument_error

SUFFIX = "vertex_colors"  # of the hidden mesh that makes the script replace the shader
COLOUR_STEP = 1 / 255


class ColouredMesh:
    """A streaming mesh with a colour at each vertex.

    vertices: (n, 3) [m]. faces: (m, 3). colors: (n, 3), sRGB in 0..1. columns: number of vertices in a row of
    neighbours. step [m]: to which browsers with the shader round the vertices. color: the only colour in browsers
    without it. Further arguments go to viser's `add_mesh_simple`.
    Raises ValueError if there is not one colour a vertex.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        name: str,
        vertices: np.ndarray,
        faces: np.ndarray,
        colors: np.ndarray,
        *,
        columns: int,
        step: float,
        color: tuple[int, int, int] = (200, 160, 90),
        **mesh: Any,
    ) -> None:
        self.name = name
        self._columns, self._step = columns, step
        self._fields = np.empty((6, len(vertices)), np.float32)  # x, y, z and red, green, blue
        self._fill(vertices, colors)
        self._injector = injector_of(server)
        faces = np.asarray(faces, np.uint32)
        self.mesh = server.scene.add_mesh_simple(name, self._vertices(), faces, color=color, **mesh)
        if self._injector is not None:
            self._packed_mesh = add_data_mesh(server, f"{name}/{SUFFIX}", self._packed())
            self._injector.watch(name)

    def set(self, vertices: np.ndarray | None = None, colors: np.ndarray | None = None) -> None:
        """Set the vertices (n, 3) [m], their colours (n, 3), or both."""
        self._fill(vertices, colors)
        if self._injector is not None:
            set_arrays(self._packed_mesh, vertices=self._packed())
        if self.has_shader is not True:
            set_arrays(self.mesh, vertices=self._vertices())

    @property
    def has_shader(self) -> bool | None:
        """True if every browser draws the colours, False if one does not, None while not yet known."""
        return self._injector.is_active(self.name) if self._injector is not None else False

    def remove(self) -> None:
        """Remove the mesh and its colours from the scene."""
        if self._injector is not None:
            self._injector.unwatch(self.name)
        self.mesh.remove()

    def _fill(self, vertices: np.ndarray | None, colors: np.ndarray | None) -> None:
        """Keep the arguments."""
        if colors is not None and np.shape(colors) != (self._fields.shape[1], 3):
            raise argument_error("colors", np.shape(colors), f"shape ({self._fields.shape[1]}, 3)")
        if vertices is not None:
            self._fields[:3] = np.transpose(vertices)
        if colors is not None:
            self._fields[3:] = np.transpose(colors)

    def _vertices(self) -> np.ndarray:
        return np.ascontiguousarray(self._fields[:3].T)

    def _packed(self) -> np.ndarray:
        """Vertices and colours as `js/scene/vertex_colors.js` reads them."""
        return pack(self._fields, (*[self._step] * 3, *[COLOUR_STEP] * 3), self._columns)
