"""The stain that oil leaves on hulls: a dark skin up to the highest place that it has wetted, by viser's public API."""

from typing import Any

import numpy as np
import viser
from trimesh.intersections import slice_faces_plane

from app.render.handles.viser_inside import set_arrays
from app.render.material import as_linear_bytes
from app.scenes.radial_sea.drawing.materials import rgb_of
from app.scenes.radial_sea.frame import RadialFrame

SKIN = 1.015  # width of the stain over that of the hull, so that it lies outside of it
STAIN_SHADE = 0.55  # of the oil's colour: a film on paint is darker than the oil in the sea
MIN_STAIN, STAIN_STEP = 0.01, 0.005  # [m] smallest that is drawn, and by how much it must grow to be redrawn


class Stains:
    """The stains of all bodies of a frame, a mesh for each body that has one."""

    def __init__(self, server: viser.ViserServer) -> None:
        self.server = server
        self.drawn: dict[int, tuple[Any, float]] = {}  # number of the body -> its mesh and height [m]
        self.made_for: tuple[Any, ...] = ()

    def show(self, frame: RadialFrame) -> None:
        """Draw the stains as they are; call it where a picture is handed over as one."""
        made_for = frame.kinds, frame.params.size, frame.column.oil.colour
        if made_for != self.made_for:
            self.made_for = made_for
            self.clear()
        for i, height in enumerate(frame.stains.tolist()):
            if i in self.drawn and height < self.drawn[i][1]:  # the scene has begun again
                self.drawn.pop(i)[0].remove()
            if height > MIN_STAIN and (i not in self.drawn or height > self.drawn[i][1] + STAIN_STEP):
                self.draw(frame, i, height)
        for i, (mesh, _) in self.drawn.items():
            set_arrays(mesh, batched_positions=frame.positions[i : i + 1], batched_wxyzs=frame.rotations[i : i + 1])

    def draw(self, frame: RadialFrame, i: int, height: float) -> None:
        """Draw the stain of body i up to `height` [m] above its lowest point."""
        hull = frame.hulls[frame.kinds[i]]
        vertices, faces = stain_of(hull.vertices, hull.faces, height)
        red, green, blue = (STAIN_SHADE * rgb_of(frame.column.oil.colour)).tolist()
        if i in self.drawn:
            self.drawn[i][0].remove()
        self.drawn[i] = (
            # A batch of one: its place and its turn are one message, and a page draws them together with the bodies'.
            self.server.scene.add_batched_meshes_simple(
                f"/stains/{i}", vertices, faces, batched_positions=frame.positions[i : i + 1],
                batched_wxyzs=frame.rotations[i : i + 1], batched_colors=as_linear_bytes((red, green, blue)),
                side="double", lod="off", cast_shadow=False, receive_shadow=False,
            ),
            height,
        )  # fmt: skip

    def clear(self) -> None:
        """Remove all of them."""
        for mesh, _ in self.drawn.values():
            mesh.remove()
        self.drawn.clear()


def stain_of(vertices: np.ndarray, faces: np.ndarray, height: float) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (n, 3) [m] and triangles of a hull up to `height` [m] above its lowest point, a little wider."""
    top = float(vertices[:, 2].min()) + height
    below, triangles, _ = slice_faces_plane(vertices, faces, (0.0, 0.0, -1.0), (0.0, 0.0, top))
    return (below * (SKIN, SKIN, 1.0)).astype(np.float32), triangles.astype(np.uint32)
