"""Common parts of the drawings of rope, race and cloth: surroundings, drags, the sphere, and a net beside another."""

import math
from typing import Any

import numpy as np
import viser

from app.formats.formatting import largest_force
from app.messages import F, P, R, Vector
from app.render.cameras import NEAR
from app.render.handles.dragging import GrabLine, SurfaceDrag, drag
from app.render.handles.gizmo import Gizmo
from app.render.handles.viser_inside import set_arrays
from app.render.meshes import ball
from app.render.surroundings import Surroundings, set_dark
from app.scenes.contract import PostCommand, SceneView
from app.scenes.springs.grab import GrabFrame

SPHERE_ROWS = 24  # of the drawn sphere, from pole to pole
SPHERE_COLOUR = (92, 140, 190)


class SpringView(SceneView[P, F, R]):
    """Surroundings of springs, and drags of their points."""

    points: np.ndarray  # (n, 3) [m] as drawn

    def __init__(self, server: viser.ViserServer, post: PostCommand, near: float = NEAR) -> None:
        """near: [m] from the camera, where the picture begins."""
        self.server, self.post = server, post
        self.surroundings = Surroundings(server, near)
        self.grab, self.surface_drag = GrabLine(server), SurfaceDrag(post)

    async def on_bead(self, event: Any) -> None:
        """Pull the bead that is dragged."""
        drag(self.post, event, event.instance_index)

    async def on_surface(self, event: Any) -> None:
        """Pull the point nearest to where the drag began: beads may be close to each other, or hidden."""
        self.surface_drag.handle(event, self.points)

    def show_surroundings(self, floor: bool, grid: bool, grab: GrabFrame | None) -> None:
        """Assign changes of the floor, of its lines and of the grab, which is on one of `points`."""
        self.surroundings.show(floor, grid)
        if grab is None:
            self.grab.show(None)
        else:
            self.grab.show((self.points[grab.particle], grab.target), grab.load, largest_force(grab.limit))

    def set_dark(self, client: viser.ClientHandle, dark: bool) -> None:
        """Draw sky and floor dark, or light again, for one browser."""
        set_dark(client, dark)


class Sphere:
    """The sphere and its arrows.

    It moves by its vertices, as ropes and cloths do: a slow page applies positions of nodes at other times.
    """

    def __init__(self, server: viser.ViserServer, post: PostCommand, arrow_length: float, gap: float) -> None:
        """arrow_length [m]. gap: [m] from the sphere up to its arrows; below 0 they are under it."""
        self.unit_ball, faces = ball(SPHERE_ROWS)
        self.ball = server.scene.add_mesh_simple(
            "/sphere/ball", self.unit_ball, faces, color=SPHERE_COLOUR, visible=False
        )
        self.arrows, self.gap = Gizmo(server, post, "sphere", arrow_length, visible=False), gap
        self.drawn_sphere: tuple[float, float, float, float] | None = None

    def show(self, sphere: tuple[float, float, float, float] | None, home: Vector | None) -> None:
        """Assign changes. sphere: x, y, z, radius [m]. home: where it is going to [m]; None without arrows."""
        self.ball.visible = sphere is not None
        self.arrows.show(home if sphere else None, self.gap + math.copysign(sphere[3] if sphere else 0.0, self.gap))
        if sphere is not None and sphere != self.drawn_sphere:
            self.drawn_sphere = sphere
            set_arrays(self.ball, vertices=self.unit_ball * sphere[3] + sphere[:3])


class Translucent:
    """A translucent mesh beside the others, which casts no shadow."""

    def __init__(self, server: viser.ViserServer, name: str, **mesh: Any) -> None:
        """mesh: arguments of viser's mesh."""
        self.server, self.name, self.options = server, name, mesh
        self.mesh: viser.MeshHandle | None = None
        self.faces: np.ndarray | None = None

    def show(self, vertices: np.ndarray, faces: np.ndarray) -> None:
        """vertices: (n, 3) [m]. faces: (m, 3); another array makes another mesh."""
        if self.mesh is None or faces is not self.faces:
            self.faces = faces
            self.mesh = self.server.scene.add_mesh_simple(self.name, vertices, faces, cast_shadow=False, **self.options)
        else:
            set_arrays(self.mesh, vertices=vertices)
        self.mesh.visible = True

    def hide(self) -> None:
        """Draw nothing."""
        if self.mesh is not None:
            self.mesh.visible = False


class SecondNet:
    """A translucent net, where the student's and the program's are drawn, and labels of both."""

    def __init__(self, server: viser.ViserServer, name: str, own: str, **mesh: Any) -> None:
        """own: words for the student's. mesh: arguments of viser's mesh."""
        self.server, self.own, self.net = server, own, Translucent(server, name, **mesh)
        self.labels: tuple[viser.LabelHandle, ...] = ()

    def show(self, vertices: np.ndarray, faces: np.ndarray, own_end: np.ndarray, program_end: np.ndarray) -> None:
        """vertices (n, 3) [m] of the translucent net; faces (m, 3): another array is another net; ends (3,) [m]."""
        scene = self.server.scene
        self.net.show(vertices, faces)
        if not self.labels:
            self.labels = (
                scene.add_label("/yours", self.own, anchor="top-center"),
                scene.add_label("/program", "the program's", anchor="bottom-left"),
            )
        for label, end in zip(self.labels, (own_end, program_end), strict=True):
            label.position = tuple(end.tolist())
            label.visible = True

    def hide(self) -> None:
        """Draw nothing."""
        self.net.hide()
        for label in self.labels:
            label.visible = False
