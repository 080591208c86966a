"""The cloth as a mesh coloured by strain, to be grabbed anywhere; pins and sphere on gizmos."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import viser

from app.messages import Command, Snapshot
from app.render.colormap import scale_colours
from app.render.coloured_mesh import ColouredMesh
from app.render.dragging import PullLine, drag, nearest
from app.render.gizmo import Gizmo
from app.render.ground import Ground
from app.render.meshes import ball
from app.scenes.cloth.scene import ClothFrame
from app.scenes.springs.report import colour_scale, stability_bar

CLOTH_COLOUR = (176, 58, 72)
GROUND, HAZE, ZENITH = (222, 227, 233), (232, 237, 243), (126, 168, 214)  # sRGB of the floor, and of the sky's ends
GRIP = 0.018  # [m] radius of the balls that pins are drawn as


def sky() -> np.ndarray:
    """(512, 4, 3) sRGB: from the zenith down to the haze on the horizon, and the haze below it."""
    up = np.clip(1.0 - np.linspace(0.0, 1.0, 512) / 0.45, 0.0, 1.0)[:, None]
    column = np.array(HAZE) * (1.0 - up) + np.array(ZENITH) * up
    return np.repeat(column.round().astype(np.uint8)[:, None], 4, axis=1)


def faces(rows: int, cols: int) -> np.ndarray:
    """Two triangles a cell, split along alternating diagonals, so that folds have no favourite direction."""
    i, j = (index.ravel() for index in np.meshgrid(np.arange(rows - 1), np.arange(cols - 1), indexing="ij"))
    a = i * cols + j
    b, c, d = a + 1, a + cols, a + cols + 1
    odd = ((i + j) % 2).astype(bool)[:, None]
    first = np.where(odd, np.stack([a, b, d], 1), np.stack([a, b, c], 1))
    second = np.where(odd, np.stack([a, d, c], 1), np.stack([b, d, c], 1))
    return np.concatenate([first, second]).astype(np.uint32)


class View:
    """Draws `ClothFrame`s."""

    CAMERA = ((1.15, -2.15, 2.05), (0.42, 0.0, 1.3))  # position, target [m]
    FIELD_OF_VIEW = 1.3  # [rad]

    def __init__(self, server: viser.ViserServer, post: Callable[[Command], None]) -> None:
        self.server = server
        self.post = post
        self.mesh: ColouredMesh | None = None
        self.shape = (0, 0)
        self.nearest = 0
        scene = server.scene
        scene.configure_environment_map("studio", background=False, environment_intensity=0.6)
        scene.set_background_image(sky())
        self.ground = Ground(server, GROUND, (190, 198, 208), (160, 170, 184))
        self.ball = scene.add_mesh_simple("/sphere/ball", *ball(48), color=(92, 140, 190), visible=False)
        arrows = {"disable_sliders": True, "visible": False}
        self.pins = [Gizmo(server, post, name, 0.22, **arrows) for name in ("pin a", "pin b")]
        self.sphere = Gizmo(server, post, "sphere", 0.55, **arrows)
        self.grips = [
            scene.add_mesh_simple(f"/grip_{name}", *ball(12), scale=GRIP, color=(60, 66, 80)) for name in ("a", "b")
        ]
        self.pole = scene.add_line_segments(
            "/pole", np.zeros((1, 2, 3), np.float32), colors=(96, 88, 80), thickness=0.03, visible=False
        )
        self.pull = PullLine(server)

    def build(self, picture: ClothFrame) -> None:
        """Make the mesh for another grid."""
        rows, cols = self.shape = picture.points.shape[0], picture.points.shape[1]
        if self.mesh is not None:
            self.mesh.remove()
        self.mesh = ColouredMesh(
            self.server,
            "/cloth",
            picture.points.reshape(-1, 3),
            faces(rows, cols),
            self.colours(picture),
            color=CLOTH_COLOUR,
            side="double",
        )
        self.mesh.mesh.on_drag("left")(self.on_cloth)

    async def on_cloth(self, event: Any) -> None:
        """Pull the particle nearest to where the drag began."""
        if event.phase == "start":
            self.nearest = nearest(self.points, event)
        drag(self.post, event, self.nearest)

    def colours(self, picture: ClothFrame) -> np.ndarray:
        """(particles, 3) sRGB in 0..1: strain, or plain."""
        if picture.colour == "plain":
            return np.tile(np.array(CLOTH_COLOUR, np.float32) / 255, (picture.strain.size, 1))
        return scale_colours(picture.strain.ravel().astype(np.float64), 0.0, picture.full_strain)

    def show(self, picture: ClothFrame) -> None:
        """Assign a new frame to the handles; call inside `server.atomic()`."""
        self.points = picture.points.reshape(-1, 3)
        if picture.points.shape[:2] != self.shape:
            self.build(picture)
        assert self.mesh is not None
        self.mesh.set(self.points, self.colours(picture))
        if picture.pull is None:
            self.pull.show(None)
        else:
            self.pull.show((self.points[picture.pull.particle], picture.pull.target), picture.pull.load)
        self.ground.show(picture.floor, picture.grid)
        for index, (gizmo, grip) in enumerate(zip(self.pins, self.grips, strict=True)):
            grip.visible = picture.pins is not None
            gizmo.show(None if picture.pins is None else picture.pins[index])
            if picture.pins is not None:
                grip.position = tuple(picture.points[0, -index])
        self.pole.visible = picture.pole
        if picture.pole:
            top, low = picture.points[0, 0], picture.points[0, -1]
            foot = low + (low - top) * (low[2] / max(float(top[2] - low[2]), 0.1))
            self.pole.points = np.array([[top + 0.06 * (top - low), foot]], np.float32)
        self.ball.visible = picture.sphere is not None
        self.sphere.show(None if picture.sphere is None else picture.sphere_home)
        if picture.sphere is not None:
            self.ball.position = picture.sphere[:3]
            self.ball.scale = picture.sphere[3]

    def readout(self, snapshot: Snapshot) -> str:
        """The stability gauge, what an implicit step took, and the colour scale, as HTML."""
        gauge, picture = snapshot.readings, snapshot.frame
        taken, scale = "", ""
        if gauge.corrections:
            taken = f"<div>{gauge.corrections:.1f} Newton corrections a step</div>"
        if gauge.threads > 1:
            taken += f"<div>forces on {gauge.threads} threads, which is quicker just now</div>"
        if picture.colour == "strain":
            scale = colour_scale("0", "strain", f"{100 * picture.full_strain:.3g} %")
        return stability_bar(gauge.stability, exact=gauge.exact) + taken + scale

    def marks(self, snapshot: Snapshot) -> dict[str, str]:
        """What is written under a parameter: the largest step that holds with the others as they are."""
        step = snapshot.readings.stability.critical_step
        text = (
            "any step holds" if step == float("inf") else f"holds up to {step:.3g} s" if step > 0 else "no step holds"
        )
        return {"integrator": snapshot.readings.note, "time_step": text}

    def notes(self, snapshot: Snapshot) -> dict[str, str]:
        """No folders."""
        return {}

    def close(self) -> None:
        """Nothing to give back: removing the nodes removes all."""


def warm_up() -> Iterator[str]:
    """Nothing here is compiled."""
    yield from ()
