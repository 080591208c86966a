"""Ropes as drawn, in the scenes of one rope and of several: tubes, a bead at each point, and the arrows of the root."""

import abc
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
import viser
from numpy.typing import NDArray

from app.messages import F, P, R
from app.render.cameras import NEAR
from app.render.handles.dragging import GRAB_COLOUR
from app.render.handles.gizmo import Gizmo
from app.render.handles.viser_inside import set_arrays
from app.render.injection import add_contact_shadow
from app.render.meshes import SIDES, ball
from app.render.tubes import Tube
from app.scenes.contract import PostCommand
from app.scenes.springs.drawing.view import SpringView
from app.scenes.springs.grab import GrabFrame
from app.scenes.springs.rope_parameters import ROOT, ROPE_RADIUS

ROOT_ARROW_LENGTH = 0.34  # [m]
MAX_BEAD_RATIO, MIN_BEAD_RATIO = 1.9, 0.5  # radius of a bead over that of its rope
MAX_SMOOTH_BEADS = 200  # beads that are drawn as fine balls, at most
POSITION_TOLERANCE = 2e-4  # [m] that a point may be from where it is drawn: far below a pixel


class RopesDrawing(abc.ABC):
    """Tubes through ropes and beads at their points; made for a number of ropes and of points, then assigned to."""

    RADIUS: ClassVar[float] = ROPE_RADIUS  # [m] of a rope
    RINGS: ClassVar[int]  # of a tube, about
    SIDES: ClassVar[int] = SIDES  # of a ring
    BEADS: ClassVar[str]  # name of the node of the beads
    BEAD_ROWS: ClassVar[int]  # of the ball of a bead, from pole to pole, unless they are many

    def __init__(self, server: viser.ViserServer, frame: Any, ropes: NDArray[np.float32], names: Sequence[str]) -> None:
        """ropes: (ropes, points, 3) [m] of the frame. names: of the nodes of the tubes."""
        self.server, self.points = server, ropes.copy()  # (ropes, points, 3) [m] as drawn
        self.tube = Tube(ropes.shape[1], self.RINGS, self.SIDES)
        self.vertices = [self.tube.vertices(points, self.RADIUS) for points in ropes]
        self.tubes = [self.make_tube(frame, number, name) for number, name in enumerate(names)]
        for name in names:
            add_contact_shadow(server, name)
        points = ropes.reshape(-1, 3)
        count = len(points)
        self.beads = server.scene.add_batched_meshes_simple(
            self.BEADS,
            *ball(self.BEAD_ROWS if count <= MAX_SMOOTH_BEADS else 4),
            batched_wxyzs=np.tile([1.0, 0.0, 0.0, 0.0], (count, 1)),
            batched_positions=points,
            batched_scales=np.full(count, bead_radius(ropes[0], self.RADIUS), np.float32),
            batched_colors=self.bead_colours(),
            lod="off",
        )
        self.shown_grab = -1  # bead that is drawn as grabbed

    @abc.abstractmethod
    def make_tube(self, frame: Any, number: int, name: str) -> Any:
        """The node `name` of a rope's tube, from its `vertices`."""

    @abc.abstractmethod
    def bead_colours(self) -> NDArray[np.uint8]:
        """Colours (ropes points, 3) of the beads, none grabbed."""

    @abc.abstractmethod
    def show(self, frame: Any) -> None:
        """Assign a new frame; called while a picture is handed over as one."""

    @property
    def meshes(self) -> list[Any]:
        """The drawn meshes of the tubes."""
        return self.tubes

    def shape_tubes(self, ropes: NDArray[np.float32], *, always: bool = False) -> None:
        """Compute the vertices of ropes (ropes, points, 3) [m] that have moved. always: of all."""
        moved = np.abs(ropes - self.points).reshape(len(ropes), -1).max(1).tolist()  # [m]
        for number, distance in enumerate(moved):
            if always or distance >= POSITION_TOLERANCE:
                self.points[number] = ropes[number]
                self.vertices[number] = self.tube.vertices(ropes[number], self.RADIUS)

    def show_beads(self, visible: bool, grab: GrabFrame | None) -> bool:
        """Assign the places of the beads, and the colour of the grabbed one. True if a colour has changed."""
        self.beads.visible = visible
        if visible:
            set_arrays(self.beads, batched_positions=self.points.reshape(-1, 3))
        grabbed, last_grab = -1 if grab is None else grab.particle, self.shown_grab
        if grabbed != last_grab:
            self.shown_grab = grabbed
            self.beads.batched_colors = self.with_grabbed(self.bead_colours())
        return grabbed != last_grab

    def with_grabbed(self, colours: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Colours of the beads, with that of the grabbed one."""
        if self.shown_grab >= 0:
            colours[self.shown_grab] = GRAB_COLOUR
        return colours

    def remove(self) -> None:
        """Remove everything from the scene."""
        for node in (*self.tubes, self.beads):
            node.remove()


class RopesView(SpringView[P, F, R]):
    """Ropes that can be dragged at their beads and tubes, and the arrows of their root."""

    def __init__(self, server: viser.ViserServer, post: PostCommand, near: float = NEAR) -> None:
        super().__init__(server, post, near)
        self.root = Gizmo(server, post, "root", ROOT_ARROW_LENGTH, position=ROOT)
        self.ropes: Any = None  # the drawing that `draw` makes

    @abc.abstractmethod
    def draw(self, frame: F) -> RopesDrawing:
        """A drawing for the number of ropes and points of a frame."""

    def show_ropes(self, frame: Any, ropes: NDArray[np.float32]) -> None:
        """Assign a new frame to ropes, root, grab and surroundings. ropes: (ropes, points, 3) [m] of the frame."""
        if self.ropes is not None and self.ropes.points.shape != ropes.shape:
            self.ropes.remove()
            self.ropes = None
        if self.ropes is None:
            self.ropes = self.draw(frame)
            self.ropes.beads.on_drag("left")(self.on_bead)  # beads are numbered through, rope after rope
            for mesh in self.ropes.meshes:
                mesh.on_drag("left")(self.on_surface)
        self.ropes.show(frame)
        self.points = self.ropes.points.reshape(-1, 3)
        p = frame.params
        self.root.show(frame.root if p.handles else None)
        self.show_surroundings(p.floor, p.grid, frame.grab)


def bead_radius(points: NDArray[np.floating], rope_radius: float) -> float:
    """Radius [m] of the beads at points (n, 3) [m]: smaller where they are close to each other."""
    spacing = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum()) / max(len(points) - 1, 1)
    return float(np.clip(0.4 * spacing, MIN_BEAD_RATIO * rope_radius, MAX_BEAD_RATIO * rope_radius))
