"""The transparent water of the mooring, with an opening at the body, and a ring at each line that passes through it."""

import numpy as np
import viser
from numpy.typing import NDArray

from app.render.coloured_mesh import ColouredMesh
from app.render.handles.viser_inside import set_arrays
from app.render.injection import add_data_mesh, injector_of
from app.scenes.mooring.arrangement import depth_of, extent, hull_of, is_round, width_of
from app.scenes.mooring.drawing.lines_view import radius_of
from app.scenes.mooring.drawing.square import square_faces, square_points
from app.scenes.mooring.drawing.watch_view import add_stroke
from app.scenes.mooring.frame import MooringFrame
from app.scenes.mooring.parameters import MooringParams
from sim.floating.motion.rotation import heading_angle

WATER_COLOUR, WATER_OPACITY = (64, 120, 156), 0.4  # in browsers without shaders
WATER_STEP = 2.0**-7  # [m] to which points of the water are rounded for the page
RING_SIZE, RING_SIDES = 2.5, 16  # radius of a ring, over that of its line as drawn, and its pieces
RING_COLOUR, RING_THICKNESS = (236, 250, 255), 2.5  # sRGB, [pixels]


def outline_of(params: MooringParams) -> tuple[float, float, float]:
    """The body from above, for `js/sea/open_water.js`: half sides of a box [m], or the radius of a round one."""
    if is_round(params):
        return 0.0, 0.0, 0.5 * width_of(params)
    x, y = hull_of(params).extents[:2, 1].tolist()
    return x, y, 0.0


class SeenWater:
    """The water's surface, which moves with the waves."""

    def __init__(self, server: viser.ViserServer, frame: MooringFrame) -> None:
        rows = len(frame.surface)
        self.places, self.outline = 0.5 * frame.side * square_points(rows), outline_of(frame.params)
        vertices = self.vertices_of(frame)
        self.surface = ColouredMesh(
            server, "/water", vertices, square_faces(rows), np.zeros_like(vertices), columns=rows, step=WATER_STEP,
            color=WATER_COLOUR, opacity=WATER_OPACITY, side="double", cast_shadow=False, receive_shadow=False,
        )  # fmt: skip
        self.around = None
        if injector_of(server) is not None:
            self.around = add_data_mesh(server, f"{self.surface.name}/open_water", self.opening(frame))

    def vertices_of(self, frame: MooringFrame) -> NDArray[np.float32]:
        """Vertices (m m, 3) [m]."""
        return np.column_stack([self.places, frame.surface.ravel()]).astype(np.float32)

    def opening(self, frame: MooringFrame) -> NDArray[np.float64]:
        """Rows for `js/sea/open_water.js`: the water (3,) [m], and the body seen from above (2, 3)."""
        place = (*frame.body[:2].tolist(), heading_angle(frame.rotation))
        return np.array([(0.5 * frame.side, depth_of(frame.params), extent(frame.params)), place, self.outline])

    def show(self, frame: MooringFrame) -> None:
        """Move the surface with the waves, and its opening with the body; or hide it."""
        is_shown = frame.params.surface
        if self.surface.mesh.visible != is_shown:
            self.surface.mesh.visible = is_shown
        if is_shown:
            self.surface.set(self.vertices_of(frame))
        if self.around is not None:
            set_arrays(self.around, vertices=self.opening(frame))

    def remove(self) -> None:
        """Remove it from the scene."""
        self.surface.remove()


class LineRings:
    """A thin bright ring on the water around each place where a line passes through it."""

    def __init__(self, server: viser.ViserServer, frame: MooringFrame) -> None:
        self.radius = RING_SIZE * radius_of(extent(frame.params))
        self.handle = add_stroke(server, "/line_rings", RING_COLOUR, RING_THICKNESS)
        self.handle.visible = False

    def show(self, frame: MooringFrame) -> None:
        """Draw the rings, or hide them; they are hidden with the water."""
        places = crossings(frame) if frame.params.surface else np.empty((0, 3))
        is_shown = len(places) > 0
        if self.handle.visible != is_shown:
            self.handle.visible = is_shown
        if is_shown:
            turn = 2 * np.pi * np.arange(RING_SIDES + 1) / RING_SIDES
            ring = self.radius * np.column_stack([np.cos(turn), np.sin(turn), 0.0 * turn])
            points = places[:, None] + ring
            pieces = np.stack([points[:, :-1], points[:, 1:]], axis=2).reshape(-1, 2, 3)
            set_arrays(self.handle, points=pieces.astype(np.float32))

    def remove(self) -> None:
        """Remove them from the scene."""
        self.handle.remove()


def crossings(frame: MooringFrame) -> NDArray[np.float64]:
    """Places (n, 3) [m] where lines pass through the drawn surface."""
    points = frame.points.astype(float)
    above = points[..., 2] - height_at(frame, points[..., :2])
    start, end = above[:, :-1], above[:, 1:]
    passes = (start > 0.0) != (end > 0.0)
    part = (start[passes] / (start[passes] - end[passes]))[:, None]
    return (1.0 - part) * points[:, :-1][passes] + part * points[:, 1:][passes]


def height_at(frame: MooringFrame, places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Height (...) [m] of the drawn surface at places (..., 2) [m], linear between its points; its edge goes on."""
    rows = len(frame.surface)
    cell = np.clip((places / frame.side + 0.5) * (rows - 1), 0.0, rows - 1)
    low = np.minimum(cell.astype(int), rows - 2)
    (i, j), (u, v) = np.moveaxis(low, -1, 0), np.moveaxis(cell - low, -1, 0)
    near = (1.0 - v) * frame.surface[i, j] + v * frame.surface[i, j + 1]
    far = (1.0 - v) * frame.surface[i + 1, j] + v * frame.surface[i + 1, j + 1]
    return (1.0 - u) * near + u * far
