"""The cloth as a checked fabric or coloured by strain, which can be dragged anywhere; pins and sphere with arrows."""

from typing import Any, TypeAlias

import numpy as np
import viser

from app.formats.formatting import number
from app.formats.packing import compile_packing
from app.messages import Snapshot, Vector
from app.render.colormap import scale_colours
from app.render.coloured_mesh import ColouredMesh
from app.render.dragging import PullLine, SurfaceDrag
from app.render.gizmo import Gizmo
from app.render.html import Html, fill, info, join
from app.render.meshes import ball, rod, tube_faces
from app.render.surroundings import Surroundings, set_dark
from app.render.viser_inside import set_arrays
from app.scenes.cloth.frame import ClothFrame, ClothReadings
from app.scenes.cloth.parameters import Params
from app.scenes.contract import Pieces, PostCommand
from app.scenes.contract import View as SceneView
from app.scenes.springs.html import colour_scale, stability_bar, step_mark

CLOTH_COLOUR = (176, 58, 72)
CHECK_COLOUR, CHECK_SHARES = (240, 226, 208), (0.0, 0.35, 0.75)  # where no, one or both threads have it
CHECKS = 8  # along the longer side
STUDENT_COLOUR, STUDENT_OPACITY = (20, 150, 90), 0.7  # a colour that no strain has
POINT_STEP = 2.0**-15  # [m] to which points are rounded for the page: no grain shows in the light on a fine cloth
SPHERE_ROWS = 24  # of the drawn sphere, from pole to pole
SPHERE_COLOUR = (92, 140, 190)
PIN_COLOUR = (60, 66, 80)
PIN_RADIUS = 0.018  # [m] of the balls that mark the pins
PIN_ARROW_LENGTH, SPHERE_ARROW_LENGTH = 0.22, 0.3  # [m]
SPHERE_ARROW_GAP = 0.3  # [m] between the sphere and its arrows below it, where no cloth lies
POLE_COLOUR = (96, 88, 80)
POLE_WIDTH = 0.03  # [m]
POLE_OVERHANG = 0.06  # of the flag's height, above the flag
MIN_POLE_DROP = 0.1  # [m] smallest height of the flag from which the foot of the pole is computed

ClothSnapshot: TypeAlias = Snapshot[Params, ClothFrame, ClothReadings]


def faces(rows: int, cols: int) -> np.ndarray:
    """(2 (rows - 1) (cols - 1), 3): two triangles a cell, split along alternating diagonals, so that no direction of
    folds is preferred."""
    i, j = (index.ravel() for index in np.meshgrid(np.arange(rows - 1), np.arange(cols - 1), indexing="ij"))
    a = i * cols + j
    b, c, d = a + 1, a + cols, a + cols + 1
    odd = ((i + j) % 2).astype(bool)[:, None]
    first = np.where(odd, np.stack([a, b, d], 1), np.stack([a, b, c], 1))
    second = np.where(odd, np.stack([a, d, c], 1), np.stack([b, d, c], 1))
    return np.concatenate([first, second]).astype(np.uint32)


def checks(rows: int, cols: int) -> np.ndarray:
    """(rows cols, 3) sRGB in 0..1 of a checked fabric, whose folds light and shadow show."""
    side = max(max(rows, cols) // (2 * CHECKS), 1)
    light = (np.arange(rows)[:, None] // side % 2) + (np.arange(cols) // side % 2)
    share = np.array(CHECK_SHARES)[light].reshape(-1, 1)
    return ((1.0 - share) * CLOTH_COLOUR + share * CHECK_COLOUR).astype(np.float32) / 255


STRAIN = "Strain: by how much a thread is longer than at rest. 5 % is 5 mm on 100 mm."


class View(SceneView[Params, ClothFrame, ClothReadings]):
    """Draws `ClothFrame`s."""

    CAMERA = ((0.7, -1.5, 1.9), (0.12, 0.0, 1.12))  # position, target [m]; of a level cloth
    HANGING = ((0.62, -1.55, 1.75), (0.15, 0.0, 1.32))  # the same of one that hangs
    FIELD_OF_VIEW = 1.3  # [rad]

    def __init__(self, server: viser.ViserServer, post: PostCommand) -> None:
        self.server = server
        self.post = post
        self.mesh: ColouredMesh | None = None
        self.shape = (0, 0)
        self.fabric = checks(0, 0)
        self.drag = SurfaceDrag(post)
        scene = server.scene
        self.surroundings = Surroundings(server)
        # The sphere moves by its vertices, as the cloth does: a slow page applies positions of nodes at other times.
        self.unit_ball, triangles = ball(SPHERE_ROWS)
        self.ball = scene.add_mesh_simple("/sphere/ball", self.unit_ball, triangles, color=SPHERE_COLOUR, visible=False)
        self.shown_sphere: tuple[float, float, float, float] | None = None
        self.pins = [Gizmo(server, post, name, PIN_ARROW_LENGTH, visible=False) for name in ("pin a", "pin b")]
        self.sphere = Gizmo(server, post, "sphere", SPHERE_ARROW_LENGTH, visible=False)
        self.pin_balls = [
            scene.add_mesh_simple(f"/pin_{name}", *ball(12), scale=PIN_RADIUS, color=PIN_COLOUR) for name in ("a", "b")
        ]
        self.pole = scene.add_mesh_simple(
            "/pole", rod(np.eye(3)[:2], POLE_WIDTH / 2), tube_faces(2), color=POLE_COLOUR, visible=False
        )
        self.pole_ends = np.zeros((2, 3))
        self.pull = PullLine(server)
        self.student: viser.MeshHandle | None = None  # the student's cloth, once there was one
        self.student_shape = (0, 0)
        self.labels: tuple[viser.LabelHandle, ...] = ()  # of the student's cloth and the program's

    def first_view(self, params: Params) -> tuple[Vector, Vector]:
        """Position and target [m] of a camera that has not been moved."""
        return self.CAMERA if params.start == "level" else self.HANGING

    def build(self, frame: ClothFrame) -> None:
        """Make the mesh for another grid."""
        rows, cols = self.shape = frame.points.shape[0], frame.points.shape[1]
        self.fabric = checks(rows, cols)
        if self.mesh is not None:
            self.mesh.remove()
        self.mesh = ColouredMesh(
            self.server,
            "/cloth",
            frame.points.reshape(-1, 3),
            faces(rows, cols),
            self.colours(frame),
            columns=cols,
            step=POINT_STEP,
            color=CLOTH_COLOUR,
            side="double",
        )
        self.mesh.mesh.on_drag("left")(self.on_cloth)

    async def on_cloth(self, event: Any) -> None:
        """Pull the particle nearest to where the drag began."""
        self.drag.handle(event, self.points)

    def colours(self, frame: ClothFrame) -> np.ndarray:
        """(particles, 3) sRGB in 0..1: fabric, or strain."""
        if frame.colour == "fabric":
            return self.fabric
        return scale_colours(frame.strain.ravel().astype(np.float64), 0.0, frame.full_strain)

    def show(self, frame: ClothFrame) -> None:
        """Assign a new frame to the handles; call it where a picture is handed over as one."""
        self.points = frame.points.reshape(-1, 3)
        if frame.points.shape[:2] != self.shape:
            self.build(frame)
        assert self.mesh is not None
        self.mesh.set(self.points, self.colours(frame))
        if frame.pull is None:
            self.pull.show(None)
        else:
            self.pull.show((self.points[frame.pull.particle], frame.pull.target), frame.pull.load)
        self.show_student(frame.student)
        self.surroundings.show(frame.floor, frame.grid)
        for index, (gizmo, pin_ball) in enumerate(zip(self.pins, self.pin_balls, strict=True)):
            pin_ball.visible = frame.pins is not None
            gizmo.show(None if frame.pins is None or not frame.handles else frame.pins[index])
            if frame.pins is not None:
                pin_ball.position = tuple(frame.points[0, -index])
        self.pole.visible = frame.pole
        if frame.pole:
            top, low = frame.points[0, 0], frame.points[0, -1]
            foot = low + (low - top) * (low[2] / max(float(top[2] - low[2]), MIN_POLE_DROP))
            ends = np.array([top + POLE_OVERHANG * (top - low), foot])
            if not np.array_equal(ends, self.pole_ends):
                self.pole_ends = ends
                set_arrays(self.pole, vertices=rod(ends, POLE_WIDTH / 2))
        self.ball.visible = frame.sphere is not None
        if frame.sphere is None or not frame.handles:
            self.sphere.show(None)
        else:
            self.sphere.show(frame.sphere_home, -frame.sphere[3] - SPHERE_ARROW_GAP)
        if frame.sphere is not None and frame.sphere != self.shown_sphere:
            self.shown_sphere = frame.sphere
            set_arrays(self.ball, vertices=self.unit_ball * frame.sphere[3] + frame.sphere[:3])

    def show_student(self, points: np.ndarray | None) -> None:
        """The student's cloth (rows, cols, 3) [m], translucent; None: there is none."""
        if points is not None:
            shape, vertices = points.shape[:2], points.reshape(-1, 3)
            if self.student is None or shape != self.student_shape:
                self.student_shape = shape
                self.student = self.server.scene.add_mesh_simple(
                    "/student", vertices, faces(*shape), color=STUDENT_COLOUR, opacity=STUDENT_OPACITY, side="double",
                    cast_shadow=False,
                )  # fmt: skip
            else:
                self.student.vertices = vertices
            if not self.labels:
                self.labels = (
                    self.server.scene.add_label("/yours", "yours (translucent)", anchor="top-center"),
                    self.server.scene.add_label("/program", "the program's", anchor="bottom-left"),
                )
            for label, corner in zip(self.labels, (vertices[-1], self.points[-1]), strict=True):
                label.position = tuple(corner.tolist())
        for handle in (self.student, *self.labels):
            if handle is not None:
                handle.visible = points is not None

    def figures(self, snapshot: ClothSnapshot) -> str:
        """The stability bar."""
        return stability_bar(snapshot.readings.stability, exact=snapshot.readings.exact)

    def readout(self, snapshot: ClothSnapshot) -> str:
        """The cost of an implicit step and the colour scale, as HTML."""
        readings, frame = snapshot.readings, snapshot.frame
        parts: list[Html] = []
        if readings.corrections:
            parts.append(fill("<div>{:.1f} Newton iterations a step</div>", readings.corrections))
        if readings.left_out:
            parts.append(fill("<div>too crowded: self-collision left out {} particles</div>", readings.left_out))
        if readings.threads > 1:
            parts.append(fill("<div>forces computed on {} threads</div>", readings.threads))
        if frame.colour == "strain":
            parts.append(colour_scale(
                "0", fill("strain {}", info(STRAIN, "7. Numbers on the screen")),
                f"{number(100 * frame.full_strain)} %",
                clipped=float(frame.strain.max()) > frame.full_strain,
            ))  # fmt: skip
        return join(parts)

    def marks(self, snapshot: ClothSnapshot) -> dict[str, str]:
        """Parameter -> the line under its control: the largest step that is stable with the others as they are."""
        readings = snapshot.readings
        return {"integrator": readings.note, "time_step": step_mark(readings.stability.critical_step)}

    def set_dark(self, client: viser.ClientHandle, dark: bool) -> None:
        """Draw sky and floor dark, or light again, for one browser."""
        set_dark(client, dark)


def warm_up() -> Pieces:
    """Call the kernels of the drawing."""
    return {"packing": compile_packing}
