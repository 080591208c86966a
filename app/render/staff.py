"""A staff of one metre with bands of ten centimetres on the floor, by which one sees how large other things are."""

import numpy as np
import viser

from app.render.material import as_linear_bytes
from app.render.meshes import rod, tube_faces

PLACE = (0.8, 0.8)  # x, y [m]: in the first views of rope, race and cloth, behind and beside what hangs there
HEIGHT, BANDS = 1.0, 10  # [m], and how many
RADIUS = 0.015  # [m]
COLOURS = (0.72, 0.13, 0.11), (0.55, 0.58, 0.62)  # sRGB of the bands, from below; white would be lost on the floor
FOOT_RADII, FOOT_OPACITY = (0.02, 0.035, 0.05, 0.07), 0.13  # [m] of the discs that darken the floor around its foot
FOOT_HEIGHT = 1e-3  # [m] of the lowest disc, and between two
LABEL = "1 m"


class Staff:
    """The handles of the staff."""

    def __init__(self, server: viser.ViserServer) -> None:
        band, scene = HEIGHT / BANDS, server.scene
        upright = np.array([1.0, 0.0, 0.0, 0.0], np.float32)
        self.staff = scene.add_batched_meshes_simple(
            "/staff", rod(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, band]]), RADIUS), tube_faces(2),
            batched_wxyzs=np.tile(upright, (BANDS, 1)),
            batched_positions=np.array([(*PLACE, i * band) for i in range(BANDS)], np.float32),
            batched_colors=np.array([as_linear_bytes(COLOURS[i % 2]) for i in range(BANDS)], np.uint8),
            lod="off",
        )  # fmt: skip
        turn = 2.0 * np.pi * np.arange(24) / 24
        disc = np.vstack([np.column_stack([np.cos(turn), np.sin(turn), 0.0 * turn]), np.zeros(3)]).astype(np.float32)
        around = np.arange(24, dtype=np.uint32)
        scene.add_batched_meshes_simple(
            "/staff/foot", disc, np.column_stack([around, np.roll(around, -1), np.full_like(around, 24)]),
            batched_wxyzs=np.tile(upright, (len(FOOT_RADII), 1)),
            batched_positions=np.array([(*PLACE, (i + 1) * FOOT_HEIGHT) for i in range(len(FOOT_RADII))], np.float32),
            batched_scales=np.array(FOOT_RADII, np.float32), batched_colors=(0, 0, 0), opacity=FOOT_OPACITY,
            lod="off", cast_shadow=False, receive_shadow=False,
        )  # fmt: skip
        scene.add_label("/staff/label", LABEL, position=(*PLACE, HEIGHT), anchor="bottom-center")

    def show(self, shown: bool) -> None:
        """Draw it, or hide it."""
        self.staff.visible = shown
