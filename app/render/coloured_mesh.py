"""A mesh with vertices that move and change colour in every frame, which stock viser does not have.

The colours travel in one array with the vertices, behind them, where no face refers to them; `js/injection.js` gives
them to the shader (see `app/render/injection.py`). A browser without that shader draws the mesh in one colour.
"""

from typing import Any

import numpy as np
import viser

from app.render.injection import add_data_mesh, injector_of
from sim.validation import argument_error

SUFFIX = "vertex_colors"  # of the hidden mesh that makes the script replace the shader


class ColouredMesh:
    """A streaming mesh with a colour at each vertex.

    vertices: (n, 3) [m]. faces: (m, 3). colors: (n, 3), sRGB in 0..1. color: the only colour in browsers
    without the shader. plain: never send the shader. Further arguments go to viser's `add_mesh_simple`.
    Raises ValueError where there is not one colour a vertex.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        name: str,
        vertices: np.ndarray,
        faces: np.ndarray,
        colors: np.ndarray,
        *,
        color: tuple[int, int, int] = (200, 160, 90),
        plain: bool = False,
        **mesh: Any,
    ) -> None:
        self.name = name
        self._count = len(vertices)
        self._injector = None if plain else injector_of(server)
        rows = self._count if self._injector is None else 2 * self._count
        self._vertices_and_colors = np.empty((rows, 3), np.float32)
        self._fill(vertices, colors)
        faces = np.asarray(faces, np.uint32)
        self.mesh = server.scene.add_mesh_simple(name, self._vertices_and_colors, faces, color=color, **mesh)
        if self._injector is not None:
            add_data_mesh(server, f"{name}/{SUFFIX}", np.zeros((1, 3)))
            self._injector.watch(name)

    def set(self, vertices: np.ndarray | None = None, colors: np.ndarray | None = None) -> None:
        """Set the vertices (n, 3) [m], their colours (n, 3), or both."""
        self._fill(vertices, colors)
        self.mesh.vertices = self._vertices_and_colors

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
        """Write what is given into the array that travels."""
        if colors is not None and np.shape(colors) != (self._count, 3):
            raise argument_error("colors", np.shape(colors), f"shape ({self._count}, 3)")
        if vertices is not None:
            self._vertices_and_colors[: self._count] = vertices
        if colors is not None and self._injector is not None:
            self._vertices_and_colors[self._count :] = colors
