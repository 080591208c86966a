"""Staffs with bands of equal height, by which one sees how large other things are; one of a metre is on the floor."""

import math
from typing import Any

import numpy as np
import viser

from app.formats.formatting import number
from app.formats.round_step import round_step
from app.messages import Vector
from app.render.material import Waterline, as_linear_bytes
from app.render.meshes import rod, tube_faces

PLACE = (0.8, 0.8)  # x, y [m]: in the first views of rope, race and cloth, behind and beside the net
HEIGHT, BANDS = 1.0, 10  # [m], and how many
RADIUS = 0.015  # [m]
COLOURS = (0.72, 0.13, 0.11), (0.55, 0.58, 0.62)  # sRGB of the bands, from below; white would be lost on the floor
FOOT_RADII, FOOT_OPACITY = (0.02, 0.035, 0.05, 0.07), 0.13  # [m] of the discs that darken the floor around its foot
FOOT_HEIGHT = 1e-3  # [m] of the lowest disc, and between two
LABEL = "1 m"
MIN_WAVES = 1.0  # [m] of the waves, for the bands of a staff in the sea
WAVE_BANDS = 3  # up to the height of the waves, about
SLENDERNESS = 0.12  # radius of a staff in the sea, over the height of a band
LEVEL_COLOUR = (0.96, 0.84, 0.2)  # of the ring at still water
UPRIGHT_SIDES = 24  # of a cylinder
UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0], np.float32)  # quaternion of a thing that is not turned


def add_staff(
    server: viser.ViserServer, name: str, foot: tuple[float, float, float], band: float, bands: range, radius: float
) -> Any:
    """Draw a staff, and return its handle.

    foot: its place [m], from which the bands are counted. band: height of one [m]. bands: numbers of the bands, below 0
    for those under the foot. radius [m].
    """
    x, y, z = foot
    return server.scene.add_batched_meshes_simple(
        name, rod(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, band]]), radius), tube_faces(2),
        batched_wxyzs=np.tile(UPRIGHT, (len(bands), 1)),
        batched_positions=np.array([(x, y, z + i * band) for i in bands], np.float32),
        batched_colors=np.array([as_linear_bytes(COLOURS[i % 2]) for i in bands], np.uint8),
        lod="off",
    )  # fmt: skip


class Staff:
    """The handles of the staff."""

    def __init__(self, server: viser.ViserServer) -> None:
        scene = server.scene
        self.staff = add_staff(server, "/staff", (*PLACE, 0.0), HEIGHT / BANDS, range(BANDS), RADIUS)
        turn = 2.0 * np.pi * np.arange(24) / 24
        disc = np.vstack([np.column_stack([np.cos(turn), np.sin(turn), 0.0 * turn]), np.zeros(3)]).astype(np.float32)
        around = np.arange(24, dtype=np.uint32)
        scene.add_batched_meshes_simple(
            "/staff/foot", disc, np.column_stack([around, np.roll(around, -1), np.full_like(around, 24)]),
            batched_wxyzs=np.tile(UPRIGHT, (len(FOOT_RADII), 1)),
            batched_positions=np.array([(*PLACE, (i + 1) * FOOT_HEIGHT) for i in range(len(FOOT_RADII))], np.float32),
            batched_scales=np.array(FOOT_RADII, np.float32), batched_colors=(0, 0, 0), opacity=FOOT_OPACITY,
            lod="off", cast_shadow=False, receive_shadow=False,
        )  # fmt: skip
        scene.add_label("/staff/label", LABEL, position=(*PLACE, HEIGHT), anchor="bottom-center")

    def show(self, visible: bool) -> None:
        """Draw it, or hide it."""
        self.staff.visible = visible


class WaveStaff:
    """A staff that stands in the sea: bands, a ring at still water, and the height at every second band, left of it."""

    def __init__(self, server: viser.ViserServer, place: Vector) -> None:
        """place: x and y [m], and the significant height of the waves [m], which sets the bands."""
        x, y, height = self.place = place
        band = round_step(max(height, MIN_WAVES) / WAVE_BANDS)
        above, below = math.ceil(2.0 * height / band) + 1, math.ceil(1.5 * height / band) + 1
        radius = SLENDERNESS * band
        scene = server.scene
        self.handles = [
            add_staff(server, "/staff", (x, y, 0.0), band, range(-below, above), radius),
            scene.add_batched_meshes_simple(
                "/staff/level", *upright(1.4 * radius, -0.04 * band, 0.04 * band),
                batched_wxyzs=UPRIGHT[None], batched_positions=np.array([(x, y, 0.0)], np.float32),
                batched_colors=as_linear_bytes(LEVEL_COLOUR), lod="off",
            ),
            *(
                scene.add_label(
                    f"/staff/{i}", f"{number(i * band)} m" if i else "still water", anchor="center-right",
                    position=(x - 1.6 * radius, y, i * band),
                )
                for i in range(0, above + 1, 2)
            ),
        ]  # fmt: skip
        self.waterline = Waterline((x, y), 0.0, (0.0, 0.0), radius, above * band, color=COLOURS[0])

    def remove(self) -> None:
        """Take it away, and with it all that is named below it."""
        self.handles[0].remove()


def upright(radius: float, low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of a cylinder of `radius` between two heights [m]."""
    angle = 2 * math.pi / UPRIGHT_SIDES * np.arange(UPRIGHT_SIDES)
    ring = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    heights = np.repeat([low, high], UPRIGHT_SIDES)[:, None]
    sides = np.hstack([np.concatenate([ring, ring]), heights])
    vertices = np.concatenate([sides, [[0.0, 0.0, low], [0.0, 0.0, high]]])
    return vertices, tube_faces(2, UPRIGHT_SIDES)
