"""The cloth as a mesh coloured by strain, to be grabbed anywhere; pins and sphere on gizmos."""

import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import viser

from app.colour import css_scale, scale_colours
from app.messages import Command, Grab, Place, Release, Snapshot, finite_vector
from app.paint import Painted
from app.scenes.cloth import ClothPicture
from app.shapes import ball

CLOTH_COLOUR = (176, 58, 72)
GROUND, HAZE, ZENITH = (222, 227, 233), (232, 237, 243), (126, 168, 214)  # sRGB of the floor, and of the sky's ends
HELD_COLOUR = (255, 90, 60)
GRIP = 0.018  # [m] radius of the balls that pins are drawn as
HANDS_OFF = 0.5  # [s] after its last drag that a gizmo is left alone


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


class Picture:
    """Draws `ClothPicture`s."""

    CAMERA = ((1.15, -2.15, 2.05), (0.42, 0.0, 1.3))  # position, target [m]

    def __init__(self, server: viser.ViserServer, post: Callable[[Command], None]) -> None:
        self.server = server
        self.post = post
        self.mesh: Painted | None = None
        self.shape = (0, 0)
        self.nearest = 0
        self.dragged_at = {"pin a": 0.0, "pin b": 0.0, "sphere": 0.0}
        scene = server.scene
        scene.configure_environment_map("studio", background=False, environment_intensity=0.6)
        scene.set_background_image(sky())
        self.floor = scene.add_grid(
            "/floor",
            width=24.0,
            height=24.0,
            infinite_grid=True,
            cell_size=0.25,
            section_size=1.0,
            cell_color=(190, 198, 208),
            section_color=(160, 170, 184),
            plane_color=GROUND,
            plane_opacity=1.0,
            fade_distance=26.0,
            shadow_opacity=0.3,
        )
        self.ball = scene.add_mesh_simple("/sphere/ball", *ball(48), color=(92, 140, 190), visible=False)
        self.gizmos = {
            "pin a": self.add_gizmo("pin a", 0.22),
            "pin b": self.add_gizmo("pin b", 0.22),
            "sphere": self.add_gizmo("sphere", 0.55),
        }
        self.grips = [
            scene.add_mesh_simple(f"/grip_{name}", *ball(12), scale=GRIP, color=(60, 66, 80)) for name in ("a", "b")
        ]
        self.pole = scene.add_line_segments(
            "/pole", np.zeros((1, 2, 3), np.float32), colors=(96, 88, 80), thickness=0.03, visible=False
        )
        # One segment for the pull; its ends move while a particle is held.
        self.pull = scene.add_line_segments(
            "/pull",
            np.zeros((1, 2, 3), np.float32),
            colors=HELD_COLOUR,
            thickness=4.0,
            thickness_units="screen",
            visible=False,
        )

    def add_gizmo(self, thing: str, scale: float) -> viser.TransformControlsHandle:
        gizmo = self.server.scene.add_transform_controls(
            f"/{thing.replace(' ', '_')}_gizmo", scale=scale, disable_rotations=True, disable_sliders=True,
            depth_test=False, visible=False,
        )  # fmt: skip

        @gizmo.on_update
        async def _(event: Any) -> None:
            self.dragged_at[thing] = time.monotonic()
            place = finite_vector(event.target.position)
            if place is not None:
                self.post(Place(thing, place))

        return gizmo

    def build(self, picture: ClothPicture) -> None:
        """Make the mesh for another grid."""
        rows, cols = self.shape = picture.points.shape[0], picture.points.shape[1]
        if self.mesh is not None:
            self.mesh.remove()
        self.mesh = Painted(
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
            self.nearest = int(np.argmin(np.linalg.norm(self.points - event.start_position, axis=1)))
        target = finite_vector(event.end_position)
        if event.phase == "end" or target is None:
            self.post(Release())
        else:
            self.post(Grab(self.nearest, target))

    def colours(self, picture: ClothPicture) -> np.ndarray:
        """(particles, 3) sRGB in 0..1: strain, or plain."""
        if picture.colour == "plain":
            return np.tile(np.array(CLOTH_COLOUR, np.float32) / 255, (picture.strain.size, 1))
        return scale_colours(picture.strain.ravel().astype(np.float64), 0.0, picture.full_strain)

    def show(self, picture: ClothPicture) -> None:
        """Assign a new frame to the handles; call inside `server.atomic()`."""
        self.points = picture.points.reshape(-1, 3)
        if picture.points.shape[:2] != self.shape:
            self.build(picture)
        assert self.mesh is not None
        self.mesh.set(self.points, self.colours(picture))
        self.pull.visible = picture.pull is not None
        if picture.pull is not None:
            self.pull.points = np.array([[self.points[picture.pull.particle], picture.pull.target]], np.float32)
            self.pull.thickness = 2.0 + 5.0 * picture.pull.load
        self.floor.visible = picture.floor
        self.floor.cell_thickness = 1.0 if picture.grid else 0.0
        self.floor.section_thickness = 1.0 if picture.grid else 0.0
        for index, name in enumerate(("pin a", "pin b")):
            self.gizmos[name].visible = self.grips[index].visible = picture.pins is not None
            if picture.pins is not None:
                self.grips[index].position = tuple(picture.points[0, -index])
                self.follow(name, picture.pins[index])
        self.pole.visible = picture.pole
        if picture.pole:
            top, low = picture.points[0, 0], picture.points[0, -1]
            foot = low + (low - top) * (low[2] / max(float(top[2] - low[2]), 0.1))
            self.pole.points = np.array([[top + 0.06 * (top - low), foot]], np.float32)
        self.ball.visible = self.gizmos["sphere"].visible = picture.sphere is not None
        if picture.sphere is not None:
            self.ball.position = picture.sphere[:3]
            self.ball.scale = picture.sphere[3]
            self.follow("sphere", picture.sphere_home)

    def follow(self, thing: str, position: tuple[float, float, float]) -> None:
        """Move a gizmo to where its thing was put by other means, unless it is being dragged."""
        gizmo = self.gizmos[thing]
        if time.monotonic() - self.dragged_at[thing] > HANDS_OFF and not np.allclose(
            gizmo.position, position, atol=1e-4
        ):
            gizmo.position = position


def warm_up() -> Iterator[str]:
    """Nothing here is compiled."""
    yield from ()


def readout(snapshot: Snapshot) -> str:
    """The stability gauge, what an implicit step took, and the colour scale, as HTML."""
    g, picture = snapshot.gauge.stability, snapshot.picture
    part = g.h_omega / g.limit if g.limit > 0 else float("inf")
    width, colour = min(part, 1.0) * 100, "#2b8a3e" if part < 0.8 else "#e67700" if part <= 1.0 else "#c92a2a"
    verdict = "stable" if part <= 1.0 else "unstable" if snapshot.gauge.exact else "may be unstable"
    sign = "=" if snapshot.gauge.exact else "≤"
    limit = f"limit {g.limit:.3g} at ζ = {g.zeta:.2g}" if g.limit < float("inf") else "no limit"
    taken = ""
    if snapshot.gauge.corrections:
        taken = f"<div>{snapshot.gauge.corrections:.1f} Newton corrections a step</div>"
    if snapshot.gauge.threads > 1:
        taken += f"<div>forces on {snapshot.gauge.threads} threads, which is quicker just now</div>"
    scale = ""
    if picture.colour == "strain":
        scale = (
            f'<div style="height:8px;border-radius:4px;background:{css_scale()}"></div>'
            '<div style="display:flex;justify-content:space-between">'
            f"<span>0</span><span>strain</span><span>{100 * picture.full_strain:.3g} %</span></div>"
        )
    return (
        f'<div style="display:flex;justify-content:space-between"><b>h ω {sign} {g.h_omega:.3g}</b>'
        f'<span>{limit}</span><b style="color:{colour}">{verdict}</b></div>'
        '<div style="height:8px;border-radius:4px;background:rgba(128,128,128,.25);margin:2px 0 8px">'
        f'<div style="height:8px;border-radius:4px;width:{width:.0f}%;background:{colour}"></div></div>{taken}{scale}'
    )


def marks(snapshot: Snapshot) -> dict[str, str]:
    """What is written under a knob: the largest step that holds with the others as they are."""
    step = snapshot.gauge.stability.critical_step
    text = "any step holds" if step == float("inf") else f"holds up to {step:.3g} s" if step > 0 else "no step holds"
    return {"integrator": snapshot.gauge.note, "time_step": text}
