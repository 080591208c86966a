"""The lines of the mooring: tubes coloured by tension, brown where they lie, and their shadows on the bed."""

import numpy as np
import viser

from app.render.colormap import SCALE, set_tube_colours
from app.render.coloured_mesh import ColouredMesh
from app.render.handles.viser_inside import set_arrays
from app.render.meshes import smooth_line, sweep, tube_faces
from app.scenes.mooring.arrangement import depth_of, diameter_of, extent
from app.scenes.mooring.frame import MooringFrame

SIDES = 6  # of a tube
RING_COUNT = 90  # rings of a line, about
TUBE_STEP = 2.0**-9  # [m] to which points of a tube are rounded for the page
LINE_SIZE = 0.0055  # radius of a drawn line, in `extent`s: true ones could not be seen
LYING_COLOUR, SHADOW_COLOUR = (44, 28, 16), (52, 72, 76)


def radius_of(far: float) -> float:
    """Radius [m] of a drawn line in a picture of extent `far` [m]."""
    return LINE_SIZE * far


class DrawnLines:
    """All lines."""

    def __init__(self, server: viser.ViserServer, frame: MooringFrame) -> None:
        lines, n, _ = frame.points.shape
        self.samples = max(1, RING_COUNT // (n - 1))
        rings = (n - 1) * self.samples + 1
        self.radius = radius_of(extent(frame.params))
        self.line = np.zeros((rings, 3))
        self.vertices, self.rgb = np.zeros((2, rings * SIDES + 2, 3), np.float32)
        faces = tube_faces(rings, SIDES)
        self.tubes = []
        for i in range(lines):
            self.shape_tube(frame, i)
            self.tubes.append(
                ColouredMesh(
                    server, f"/line_{i + 1}", self.vertices, faces, self.rgb, columns=SIDES, step=TUBE_STEP,
                    side="double",
                )
            )  # fmt: skip
        self.shadows = server.scene.add_line_segments(
            "/shadows", np.zeros((lines * (n - 1), 2, 3), np.float32), colors=SHADOW_COLOUR, thickness=2.0,
            thickness_units="screen",
        )  # fmt: skip

    @property
    def has_colours(self) -> bool:
        """False if a browser draws the lines without their colours."""
        return self.tubes[0].has_shader is not False

    def shape_tube(self, frame: MooringFrame, i: int) -> None:
        """Compute the tube of line i: vertices, and colours by the tension, or brown where it lies on the bed."""
        bed = -depth_of(frame.params)
        smooth_line(frame.points[i], self.samples, self.line)
        lies = self.line[:, 2] <= bed + diameter_of(frame.params)
        # A line is drawn thicker than it is: what lies is drawn on the bed, not half in it.
        self.line[:, 2] = np.maximum(self.line[:, 2], bed + self.radius)
        sweep(self.line, self.radius, SIDES, self.vertices)
        set_tube_colours(frame.tension[i], self.samples, frame.full_scale, SCALE, SIDES, self.rgb)
        brown = np.array(LYING_COLOUR, np.float32) / 255
        self.rgb[:-2].reshape(-1, SIDES, 3)[lies] = brown
        self.rgb[-2:][lies[[0, -1]]] = brown

    def show(self, frame: MooringFrame) -> None:
        """Move and colour them."""
        for i, tube in enumerate(self.tubes):
            self.shape_tube(frame, i)
            tube.set(self.vertices, self.rgb)
        shadows = frame.points.copy()
        shadows[:, :, 2] = -depth_of(frame.params) + 0.3 * self.radius
        set_arrays(self.shadows, points=np.stack([shadows[:, :-1], shadows[:, 1:]], axis=2).reshape(-1, 2, 3))

    def remove(self) -> None:
        """Remove them from the scene."""
        for part in (*self.tubes, self.shadows):
            part.remove()
