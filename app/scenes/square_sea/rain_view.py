"""Rain as it is drawn: a needle for each drop and a crown of needles for each splash, in buffers of fixed size.

Needles are a mesh because viser makes lines anew at each update; a mesh of fixed faces is moved in place. `rain.js`
lets them fade where they are near, keeps them a pixel wide where they are far, and takes their light from the sky.
"""

import numpy as np
import viser

from app.render.injection import hidden, patch
from app.scenes.square_sea.rainfall import MAX_SPLASHES, SPLASH_DURATION, RainFrame

EXPOSURE = 1 / 40  # [s] over which a falling drop leaves its streak
THIN = 0.004  # [m] half the width of a streak
CROWN = 6  # drops thrown up by a splash
HEIGHT, SPREAD = 0.16, 0.09  # [m]: how high and how wide a crown goes
BURIED = -1e3  # [m] where needles wait that are not shown
OPACITY = 0.6
NEAR = 1.0  # [m] within which no streak is drawn where the browser is patched
PIXEL = 0.0007  # [rad] half of about one
ANGLES = np.array([0.0, 2.0944, 4.1888])
ROUND = THIN * np.stack([np.cos(ANGLES), np.sin(ANGLES), 0.0 * ANGLES], -1).astype(np.float32)


class Needles:
    """n needles in one mesh, each from a tail to three points about its head."""

    def __init__(self, server: viser.ViserServer, name: str, n: int, exposure: float) -> None:
        """exposure: of the water's look."""
        faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1]])
        self.vertices = np.full((n, 4, 3), BURIED, np.float32)
        self.mesh = server.scene.add_mesh_simple(
            name,
            self.vertices.reshape(-1, 3),
            (4 * np.arange(n)[:, None, None] + faces).reshape(-1, 3).astype(np.uint32),
            color=(214, 224, 234),
            opacity=OPACITY,
            side="double",
            flat_shading=False,
            cast_shadow=False,
            receive_shadow=False,
        )
        if patch(server) is not None:
            look = np.array([[OPACITY, exposure, NEAR], [THIN, PIXEL, 0.0]])
            self.look = hidden(server, f"{name}/rain_look", look)

    def show(self, tails: np.ndarray, heads: np.ndarray) -> None:
        """tails, heads: (n, 3) [m]."""
        self.vertices[:, 0] = tails
        self.vertices[:, 1:] = heads[:, None] + ROUND
        self.mesh.vertices = self.vertices.reshape(-1, 3)


class RainMesh:
    """Drops and splashes in the scene. Made for one number of drops."""

    def __init__(self, server: viser.ViserServer, picture: RainFrame, exposure: float) -> None:
        """exposure: of the water's look."""
        self.count = len(picture.drops)
        self.drops = Needles(server, "/rain/drops", self.count, exposure)
        self.crowns = Needles(server, "/rain/splashes", MAX_SPLASHES * CROWN, exposure)
        angle = 2.0 * np.pi * (np.arange(CROWN) / CROWN + 0.1)
        lean = np.where(np.arange(CROWN) % 2 == 0, 1.0, 0.55)
        up = np.where(np.arange(CROWN) % 2 == 0, 1.0, 1.4)
        self.ways = np.stack([SPREAD * np.cos(angle) * lean, SPREAD * np.sin(angle) * lean, HEIGHT * up], -1)

    def show(self, picture: RainFrame) -> None:
        """Move everything; call inside `server.atomic()`."""
        self.drops.show(picture.drops - EXPOSURE * picture.velocity, picture.drops)
        age = picture.splashes[:, 3]
        before = np.maximum(age - EXPOSURE, 0.0)
        self.crowns.show(self.crown(picture, before), self.crown(picture, age))

    def crown(self, picture: RainFrame, age: np.ndarray) -> np.ndarray:
        """(MAX_SPLASHES CROWN, 3) [m]: thrown up and out on parabolas, `age` (MAX_SPLASHES) [s] ago."""
        part = (age / SPLASH_DURATION)[:, None]  # 0 to 1
        ways = np.stack([part, part, 4.0 * part * (1.0 - part)], -1) * self.ways
        points = picture.splashes[:, None, :3] + ways
        points[picture.splashes[:, 3] < 0.0] = BURIED
        return points.reshape(-1, 3).astype(np.float32)

    def remove(self) -> None:
        """Take drops and splashes out of the scene."""
        self.drops.mesh.remove()
        self.crowns.mesh.remove()
