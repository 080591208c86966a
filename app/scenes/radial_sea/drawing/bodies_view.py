"""The floating bodies as drawn, and the invisible balls about them that the mouse drags."""

import importlib.resources
from collections.abc import Callable
from typing import Any

import numpy as np
import viser

from app.render.handles.viser_inside import set_arrays
from app.render.meshes import ball
from app.scenes.radial_sea.bodies import BODY_KINDS
from app.scenes.radial_sea.frame import RadialFrame
from sim.floating.shapes import Appearance

HANDLE_RADIUS = 0.75  # [m] at size 1 of the invisible ball about a body, which is dragged
APPEARANCES = {kind.name: kind.appearance for kind in BODY_KINDS}
NO_SHADOWS: dict[str, Any] = {"cast_shadow": False, "receive_shadow": False}


def model(name: str) -> bytes:
    """The GLB file of this name in the assets."""
    return importlib.resources.files("assets").joinpath(f"{name}.glb").read_bytes()


class DrawnBodies:
    """Each kind of body as one batch."""

    def __init__(self, server: viser.ViserServer, on_drag: Callable[[Any], Any]) -> None:
        """on_drag: takes the events of a mouse that drags a body."""
        self.server, self.on_drag = server, on_drag
        self.kinds: tuple[str, ...] = ()
        self.size = 0.0
        self.batches: dict[str, tuple[Any, np.ndarray]] = {}  # kind -> handle, numbers of its bodies
        self.handles: viser.BatchedMeshHandle | None = None

    def show(self, frame: RadialFrame) -> None:
        """Draw each kind of body as one batch, and place the handles that are dragged."""
        if (frame.kinds, frame.params.size) != (self.kinds, self.size):
            for handle, _ in self.batches.values():
                handle.remove()
            self.kinds, self.size = frame.kinds, frame.params.size
            self.batches = {kind: self.add_bodies(frame, kind) for kind in sorted(set(self.kinds))}
            self.add_handles(frame)
        for handle, chosen in self.batches.values():
            set_arrays(handle, batched_positions=frame.positions[chosen], batched_wxyzs=frame.rotations[chosen])
        if self.handles is not None:
            set_arrays(self.handles, batched_positions=frame.positions)

    def add_bodies(self, frame: RadialFrame, kind: str) -> tuple[Any, np.ndarray]:
        """A batch of all bodies of a kind, as its model or else as its hull; and their numbers."""
        chosen = np.array([i for i, other in enumerate(frame.kinds) if other == kind])
        poses: dict[str, Any] = {"batched_wxyzs": frame.rotations[chosen], "batched_positions": frame.positions[chosen]}
        appearance, add = APPEARANCES.get(kind, Appearance(kind, kind)), self.server.scene
        if appearance.model:
            scales = np.full(len(chosen), frame.params.size, np.float32)
            glb = model(appearance.model)
            return add.add_batched_glb(
                f"/bodies/{kind}", glb, batched_scales=scales, lod="off", **poses, **NO_SHADOWS
            ), chosen
        hull = frame.hulls[kind]
        vertices, faces = hull.vertices.astype(np.float32), hull.faces.astype(np.uint32)
        return add.add_batched_meshes_simple(
            f"/bodies/{kind}", vertices, faces, batched_colors=appearance.color, flat_shading=True, lod="off",
            **poses, **NO_SHADOWS,
        ), chosen  # fmt: skip

    def add_handles(self, frame: RadialFrame) -> None:
        """Invisible balls about the bodies, to be dragged: viser 1.1 loses a page that drags instances of a GLB."""
        if self.handles is not None:
            self.handles.remove()
            self.handles = None
        n = len(frame.positions)
        if n == 0:
            return
        vertices, faces = ball(4)
        self.handles = self.server.scene.add_batched_meshes_simple(
            "/handles",
            HANDLE_RADIUS * vertices,
            faces,
            batched_wxyzs=np.tile([1.0, 0.0, 0.0, 0.0], (n, 1)),
            batched_positions=frame.positions,
            batched_scales=np.array([handle_scale(frame, kind) for kind in frame.kinds], np.float32),
            opacity=0.0,
            lod="off",
            **NO_SHADOWS,
        )
        self.handles.on_drag("left")(self.on_drag)


def handle_scale(frame: RadialFrame, kind: str) -> float:
    """Factor on the handle of a body of this kind: by the size of the bodies, or of a hull that has its own."""
    hull = frame.hulls[kind]
    if hull.shape.lengths:
        return frame.params.size
    return 0.5 * float(np.ptp(hull.extents, axis=1).mean()) / HANDLE_RADIUS
