"""Rain as it is drawn: a needle for each drop and a crown of points for each splash, in buffers of fixed size.

Needles are a mesh because viser makes lines anew at each update; a mesh of fixed faces is moved in place.
"""

import numpy as np
import viser

from app.shower import LASTING, SPLASHES, RainPicture

EXPOSURE = 1 / 25  # [s] over which a falling drop leaves its streak
THIN = 0.00014  # of the window's side: half the width of a streak
CROWN = 6  # points of a splash
HEIGHT, SPREAD = 0.0045, 0.0022  # of the window's side: how high and how wide a crown goes
BURIED = -1e3  # [m] where points wait that are not shown


class RainMesh:
    """Drops and splashes in the scene. Made for one number of drops."""

    def __init__(self, server: viser.ViserServer, picture: RainPicture) -> None:
        n = len(picture.drops)
        self.count = n
        needle = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1]])
        self.vertices = np.zeros((n, 4, 3), np.float32)
        self.mesh = server.scene.add_mesh_simple(
            "/rain/drops",
            self.vertices.reshape(-1, 3),
            (4 * np.arange(n)[:, None, None] + needle).reshape(-1, 3).astype(np.uint32),
            color=(214, 224, 234),
            opacity=0.42,
            side="double",
            flat_shading=False,
            cast_shadow=False,
            receive_shadow=False,
        )
        self.crowns = server.scene.add_point_cloud(
            "/rain/splashes",
            np.full((SPLASHES * CROWN, 3), BURIED, np.float32),
            (238, 244, 248),
            point_size=0.0002 * picture.span,
            point_shape="circle",
            precision="float32",
        )
        angle = 2.0 * np.pi * (np.arange(CROWN) / CROWN + 0.1)
        lean = np.where(np.arange(CROWN) % 2 == 0, 1.0, 0.55)
        self.ways = np.stack([np.cos(angle) * lean, np.sin(angle) * lean], -1).astype(np.float32)

    def show(self, picture: RainPicture) -> None:
        """Move everything; call inside `server.atomic()`."""
        self.mesh.vertices = needles(picture, self.vertices).reshape(-1, 3)
        self.crowns.points = self.crown_points(picture).reshape(-1, 3)

    def crown_points(self, picture: RainPicture) -> np.ndarray:
        """(SPLASHES, CROWN, 3) [m]: thrown up and out on parabolas."""
        age = picture.splashes[:, 3:] / LASTING  # 0 to 1
        points = np.repeat(picture.splashes[:, None, :3], CROWN, axis=1)
        points[..., :2] += SPREAD * picture.span * age[..., None] * self.ways
        up = 4.0 * age * (1.0 - age) * HEIGHT * picture.span
        points[..., 2] += up * np.where(np.arange(CROWN) % 2 == 0, 1.0, 1.4).astype(np.float32)
        points[picture.splashes[:, 3] < 0.0] = BURIED
        return points

    def remove(self) -> None:
        """Take drops and splashes out of the scene."""
        self.mesh.remove()
        self.crowns.remove()


def needles(picture: RainPicture, out: np.ndarray) -> np.ndarray:
    """Set out (n, 4, 3) [m] to needles: the tail where a drop was EXPOSURE ago, three points about where it is."""
    thin = THIN * picture.span
    out[:, 0] = picture.drops - EXPOSURE * picture.velocity
    for corner, angle in enumerate((0.0, 2.094, 4.189), 1):
        out[:, corner] = picture.drops + np.array([thin * np.cos(angle), thin * np.sin(angle), 0.0], np.float32)
    return out
