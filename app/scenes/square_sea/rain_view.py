"""Rain and spray as they are drawn: streaks for drops, crowns of streaks for splashes, in buffers of fixed size.

Streaks are a mesh, because viser replaces lines at each update but moves a mesh of fixed faces in place. The shader
in `js/sea/rain.js` fades streaks near the camera, keeps distant ones a pixel wide, and lights them by the sky.
Where there is a shader, it draws thousands of further drops around the camera, with the same sizes, speeds and wind;
they are sent once and hit nothing. So does the spray of breaking crests, which leaves the water where foam is fresh.
"""

from typing import NamedTuple

import numpy as np
import viser

from app.render.handles.viser_inside import set_arrays
from app.render.injection import add_data_mesh, injector_of
from app.render.material import RAIN_UNIFORMS
from app.scenes.square_sea.parameters import RainSettings, SquareSeaParams, rain_settings
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
# Beaufort 7, from which spray is drawn, and 10, from which all of its drops are: by the WMO's code table 1100 spindrift
# leaves the crests at 8, and spray affects the visibility from 9 on.
SPRAY_WIND = 14.0, 26.0  # [m/s]
SPRAY_DROPS = 5000  # at most
SPRAY_BOX = 100.0  # [m] side of the box before the camera that they are in
SPRAY_HALF_WIDTH = 1.5  # [m] of the widest
SPRAY_OPACITY = 0.65
SPRAY_FADE_DISTANCE = 3.0  # [m] from the camera
SPRAY_LIFE, SPRAY_SPEED = 1.6, 5.0  # [s], and [m/s] with which the fastest leave the water
SPRAY_TIME = 1.5  # [s] after a crest has broken in which it throws spray
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
            "spray": (0.0, 0.0, 0.0),
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


class SpraySettings(NamedTuple):
    """The part of the parameters that the spray depends on."""

    wind: tuple[float, float]  # [m/s]
    drops: int
    least_foam: float  # that throws spray: what is left of full foam after SPRAY_TIME


def spray_settings(params: SquareSeaParams) -> SpraySettings | None:
    """The spray of these parameters; None if the wind is too weak for spray or there is no foam."""
    wind = rain_settings(params).wind
    low, high = SPRAY_WIND
    drops = round(SPRAY_DROPS * min(max((float(np.hypot(*wind)) - low) / (high - low), 0.0), 1.0))
    if not params.foam or drops == 0:
        return None
    return SpraySettings(wind, drops, float(np.exp(-SPRAY_TIME / params.foam_fade)))


class SprayMesh:
    """Spray in browsers with shaders, hidden while no crest has just broken."""

    def __init__(self, server: viser.ViserServer, settings: SpraySettings, exposure: float) -> None:
        """exposure: of the water's material."""
        self.settings = settings
        self.mesh = StreakMesh(
            server, "/spray", settings.drops,
            {
                "rain": (SPRAY_OPACITY, exposure, SPRAY_FADE_DISTANCE),
                "streak": (SPRAY_HALF_WIDTH, MIN_STREAK_ANGLE, SPRAY_BOX),
                "dropSizes": (0.0, 0.0, 0.0),
                "dropMotion": (*settings.wind, 0.0),
                "spray": (SPRAY_LIFE, SPRAY_SPEED, settings.least_foam),
            },
        ).mesh  # fmt: skip

    def show(self, foam: np.ndarray) -> None:
        """Draw it if some of this foam, 0 to 1, is fresh; else hide it."""
        is_shown = bool(foam.max() > self.settings.least_foam)
        if self.mesh.visible != is_shown:
            self.mesh.visible = is_shown

    def remove(self) -> None:
        """Remove it from the scene."""
        self.mesh.remove()
