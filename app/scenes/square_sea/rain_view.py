"""Rain as it is drawn: a streak for each drop and a crown of streaks for each splash, in buffers of fixed size.

Streaks are a mesh, because viser replaces lines at each update but moves a mesh of fixed faces in place. The shader
in `js/sea/rain.js` fades streaks near the camera, keeps distant ones a pixel wide, and lights them by the sky.
Where there is a shader, it draws thousands of further drops around the camera, with the same sizes, speeds and wind;
they are sent once and hit nothing.
"""

import numpy as np
import viser

from app.render.handles.viser_inside import set_arrays
from app.render.injection import add_data_mesh, injector_of
from app.render.material import RAIN_UNIFORMS
from app.scenes.square_sea.parameters import RainSettings
from app.scenes.square_sea.rainfall import MAX_SPLASHES, SPLASH_DURATION, RainFrame
from sim.particles.rain import rainfall, slope_parameter
from sim.water import EARTH_GRAVITY

EXPOSURE_TIME = 1 / 30  # [s] over which a moving drop draws its streak
STREAK_HALF_WIDTH = 0.004  # [m]
MIN_STREAK_ANGLE = 0.0007  # [rad] half the width below which the shader draws a streak paler instead: half a pixel
STREAK_COLOUR = (214, 224, 234)
STREAK_OPACITY = 0.6
FADE_DISTANCE = 1.0  # [m] from the camera within which the shader draws no streak
NEAR_DROPS = 8000  # that the shader draws around the camera, at most
NEAR_BOX = 10.0  # [m] side of the box around the camera that they are in
NEAR_HALF_WIDTH = 0.0022  # [m] of such a drop for each millimetre of its diameter
NEAR_OPACITY = 0.85
CROWN_DROPS = 6  # thrown up by a splash
CROWN_HEIGHT, CROWN_RADIUS = 0.16, 0.09  # [m]
HIDDEN_HEIGHT = -1e3  # [m] where unused streaks are kept
CORNER_ANGLES = 2.0 * np.pi / 3.0 * np.arange(3)
HEAD_CORNERS = STREAK_HALF_WIDTH * np.stack(  # (3, 3) [m] around the head of a streak
    [np.cos(CORNER_ANGLES), np.sin(CORNER_ANGLES), 0.0 * CORNER_ANGLES], -1
).astype(np.float32)


class StreakMesh:
    """n streaks in one mesh, each from a tail to three points around its head."""

    def __init__(self, server: viser.ViserServer, name: str, n: int, uniforms: dict[str, tuple[float, ...]]) -> None:
        """uniforms: of the shader, by their names in RAIN_UNIFORMS."""
        faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1]])
        self.vertices = np.full((n, 4, 3), HIDDEN_HEIGHT, np.float32)
        self.mesh = server.scene.add_mesh_simple(
            name,
            self.vertices.reshape(-1, 3),
            (4 * np.arange(n)[:, None, None] + faces).reshape(-1, 3).astype(np.uint32),
            color=STREAK_COLOUR,
            opacity=STREAK_OPACITY,
            side="double",
            flat_shading=False,
            cast_shadow=False,
            receive_shadow=False,
        )
        if injector_of(server) is not None:
            values = np.array([uniforms[uniform] for uniform in RAIN_UNIFORMS])
            add_data_mesh(server, f"{name}/rain_material", values)

    def show(self, tails: np.ndarray, heads: np.ndarray) -> None:
        """tails, heads: (n, 3) [m]."""
        self.vertices[:, 0] = tails
        self.vertices[:, 1:] = heads[:, None] + HEAD_CORNERS
        set_arrays(self.mesh, vertices=self.vertices.reshape(-1, 3))


class RainMesh:
    """Drops and splashes in the scene. Made for one number of drops, and one rain."""

    def __init__(self, server: viser.ViserServer, frame: RainFrame, settings: RainSettings, exposure: float) -> None:
        """exposure: of the water's material."""
        self.count, self.settings = len(frame.drops), settings
        speed_factor = float(np.sqrt(settings.gravity / EARTH_GRAVITY))
        uniforms: dict[str, tuple[float, ...]] = {
            "rain": (STREAK_OPACITY, exposure, FADE_DISTANCE),
            "streak": (STREAK_HALF_WIDTH, MIN_STREAK_ANGLE, 0.0),
            "dropSizes": (1e-3 * slope_parameter(settings.rate), speed_factor, EXPOSURE_TIME),
            "dropMotion": (*settings.wind, 0.0),
        }
        self.drops = StreakMesh(server, "/rain/drops", self.count, uniforms)
        self.crowns = StreakMesh(server, "/rain/splashes", MAX_SPLASHES * CROWN_DROPS, uniforms)
        self.near = None
        if injector_of(server) is not None:
            near = uniforms | {
                "rain": (NEAR_OPACITY, exposure, FADE_DISTANCE),
                "streak": (NEAR_HALF_WIDTH, MIN_STREAK_ANGLE, NEAR_BOX),
            }
            real = rainfall(settings.rate, settings.gravity).concentration * NEAR_BOX**3
            self.near = StreakMesh(server, "/rain/near", min(NEAR_DROPS, round(real)), near)
        number = np.arange(CROWN_DROPS)
        angle = 2.0 * np.pi * (number / CROWN_DROPS + 0.1)
        # Every second drop of a crown flies steeper, so that the crown does not look regular.
        radius = CROWN_RADIUS * np.where(number % 2 == 0, 1.0, 0.55)
        height = CROWN_HEIGHT * np.where(number % 2 == 0, 1.0, 1.4)
        self.reach = np.stack([radius * np.cos(angle), radius * np.sin(angle), height], -1)  # (CROWN_DROPS, 3) [m]

    def show(self, frame: RainFrame) -> None:
        """Move everything; call it where a picture is handed over as one."""
        self.drops.show(frame.drops - EXPOSURE_TIME * frame.velocity, frame.drops)
        age = frame.splashes[:, 3]
        earlier = np.maximum(age - EXPOSURE_TIME, 0.0)
        self.crowns.show(self.crown_drops(frame, earlier), self.crown_drops(frame, age))

    def crown_drops(self, frame: RainFrame, age: np.ndarray) -> np.ndarray:
        """Positions (MAX_SPLASHES CROWN_DROPS, 3) [m] on parabolas, at `age` (MAX_SPLASHES,) [s] of the splashes."""
        part = (age / SPLASH_DURATION)[:, None]  # 0 to 1
        offsets = np.stack([part, part, 4.0 * part * (1.0 - part)], -1) * self.reach
        points = frame.splashes[:, None, :3] + offsets
        points[frame.splashes[:, 3] < 0.0] = HIDDEN_HEIGHT
        return points.reshape(-1, 3).astype(np.float32)

    def remove(self) -> None:
        """Remove drops and splashes from the scene."""
        if self.near is not None:
            self.near.mesh.remove()
        self.drops.mesh.remove()
        self.crowns.mesh.remove()
