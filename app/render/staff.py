"""Staffs with bands of equal height, by which one sees how large other things are; one of a metre is on the floor."""

from typing import Any

import numpy as np
import viser

from app.render.material import as_linear_bytes
from app.render.meshes import rod, tube_faces

PLACE = (0.8, 0.8)  # x, y [m]: in the first views of rope, race and cloth, behind and beside the net
HEIGHT, BANDS = 1.0, 10  # [m], and how many
RADIUS = 0.015  # [m]
COLOURS = (0.72, 0.13, 0.11), (0.55, 0.58, 0.62)  # sRGB of the bands, from below; white would be lost on the floor
FOOT_RADII, FOOT_OPACITY = (0.02, 0.035, 0.05, 0.07), 0.13  # [m] of the discs that darken the floor around its foot
FOOT_HEIGHT = 1e-3  # [m] of the lowest disc, and between two
LABEL = "1 m"
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

    def show(self, shown: bool) -> None:
        """Draw it, or hide it."""
        self.staff.visible = shown
