"""A mesh whose vertices move and change colour every frame, which stock viser does not have.

The colours travel in one array with the vertices, behind them, where no face names them, and reach the material through
`app/patch.py`. A browser that the patch does not reach draws the mesh in its plain colour.
"""

from typing import Any

import numpy as np
import viser

from app.render.injection import hidden, patch
from sim.validation import argument_error

SUFFIX = "paint"  # the recipe's name in patch.js


class ColouredMesh:
    """A streaming mesh with a colour at each vertex.

    vertices: (n, 3) [m]. faces: (m, 3). colors: (n, 3), sRGB in 0..1. color: the plain colour, for browsers that the
    patch does not reach. plain: never patch. Further arguments go to viser's `add_mesh_simple`.
    Raises ValueError for colours of another length than the vertices.
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
        self._patch = None if plain else patch(server)
        self._numbers = np.empty((self._count if self._patch is None else 2 * self._count, 3), np.float32)
        self._fill(vertices, colors)
        faces = np.asarray(faces, np.uint32)
        self.mesh = server.scene.add_mesh_simple(name, self._numbers, faces, color=color, **mesh)
        if self._patch is not None:
            hidden(server, f"{name}/{SUFFIX}", np.zeros((1, 3)))
            self._patch.expect(name)

    def set(self, vertices: np.ndarray | None = None, colors: np.ndarray | None = None) -> None:
        """Move the vertices [m], repaint them, or both."""
        self._fill(vertices, colors)
        self.mesh.vertices = self._numbers

    @property
    def alive(self) -> bool | None:
        """True if every browser paints, False if one does not, None while not yet known."""
        return self._patch.alive(self.name) if self._patch is not None else False

    def remove(self) -> None:
        """Take the mesh and its colours out of the scene."""
        if self._patch is not None:
            self._patch.forget(self.name)
        self.mesh.remove()

    def _fill(self, vertices: np.ndarray | None, colors: np.ndarray | None) -> None:
        if colors is not None and np.shape(colors) != (self._count, 3):
            raise argument_error("colors", np.shape(colors), f"shape ({self._count}, 3)")
        if vertices is not None:
            self._numbers[: self._count] = vertices
        if colors is not None and self._patch is not None:
            self._numbers[self._count :] = colors
