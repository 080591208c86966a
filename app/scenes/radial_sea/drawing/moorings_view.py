"""The mooring lines of the floating bodies as rods: a stroke that passes the camera would be drawn where it is not."""

import numpy as np
import viser
from numpy.typing import NDArray

from app.render.handles.viser_inside import set_arrays
from app.render.meshes import rod, tube_faces
from app.scenes.radial_sea.drawing.bodies_view import NO_SHADOWS
from app.scenes.radial_sea.frame import RadialFrame

LINE_COLOUR = (191, 158, 92)
LINE_RADIUS, LINE_SIDES = 0.02, 4  # [m] at size 1 of a drawn line, a rod
NEAR_END = [*range(LINE_SIDES), 2 * LINE_SIDES]  # vertices of the rod at the fairlead


class Rods:
    """The rods of the lines of some bodies, as one mesh. Only the rings at the fairleads move."""

    def __init__(
        self, server: viser.ViserServer, anchors: NDArray[np.float64], fairleads: NDArray[np.float32], size: float
    ) -> None:
        """anchors: (bodies, 4, 3) [m] of all bodies. fairleads: (n, 3) [m] of the first n. size: of the bodies."""
        self.all_anchors = anchors
        anchors = anchors[: len(fairleads)]
        radius, (n, lines) = LINE_RADIUS * size, anchors.shape[:2]
        ways = np.stack(np.broadcast_arrays(fairleads[:, None], anchors), axis=2)
        self.vertices = np.array([[rod(way, radius, LINE_SIDES) for way in body] for body in ways])
        self.at_fairleads = self.vertices[:, :, NEAR_END] - fairleads[:, None, None]
        first = self.vertices.shape[2] * np.arange(n * lines, dtype=np.uint32)  # vertex of each rod
        faces = (tube_faces(2, LINE_SIDES) + first[:, None, None]).reshape(-1, 3)
        self.handle = server.scene.add_mesh_simple(
            "/moorings", self.vertices.reshape(-1, 3), faces, color=LINE_COLOUR, **NO_SHADOWS
        )

    def are_of(self, anchors: NDArray[np.float64], count: int) -> bool:
        """True if they are the rods of this number of bodies with these anchors."""
        return count == len(self.vertices) and anchors is self.all_anchors

    def show(self, fairleads: NDArray[np.float32]) -> None:
        """Move the ends at the fairleads (n, 3) [m]."""
        self.vertices[:, :, NEAR_END] = self.at_fairleads + fairleads[:, None, None]
        set_arrays(self.handle, vertices=self.vertices.reshape(-1, 3))


class DrawnMoorings:
    """The lines of all bodies; beside a cutaway those of one, as others would cross it as sticks in the air."""

    def __init__(self, server: viser.ViserServer) -> None:
        self.server = server
        self.rods: Rods | None = None

    def show(self, frame: RadialFrame) -> None:
        """Draw the lines of a frame."""
        fairleads = frame.fairleads if frame.cutaway is None else frame.fairleads[:1]
        if self.rods is not None and not self.rods.are_of(frame.anchors, len(fairleads)):
            self.rods.handle.remove()
            self.rods = None
        if self.rods is None and len(fairleads):
            self.rods = Rods(self.server, frame.anchors, fairleads, frame.params.size)
        if self.rods is not None:
            self.rods.show(fairleads)
