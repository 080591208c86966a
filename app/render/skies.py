"""The skies: viser's environment maps, and the sun, land and haze of each, so that they fit the water."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from app.render.cameras import set_clipping
from app.render.injection import injector_of
from app.render.material import HAZE_DISTANCE, RGB, Material

NIGHT = "night"
STAR_COUNT = 700
STAR_DISTANCE = 6000.0  # [m]
STAR_SIZE = 0.0022  # [rad]
LOWEST_STAR, CLEAR_AIR = 4.0, 25.0  # [deg] of elevation: of the lowest star, and from which the haze dims none
FAINTEST = 0.12  # brightness of the faintest star over that of the brightest
CAMERA_RANGE = 20_000.0  # [m] at which the camera's view ends; viser's own 1000 m would cut the horizon off


@dataclass(frozen=True)
class Photograph:
    """An environment map of viser: where its sun is, how high its land is, and how it is exposed."""

    sun_column: float  # of the sun, 0..1 from the left edge of the panorama
    sun_height: float  # [deg]
    sun_color: RGB  # sRGB
    sun_strength: float  # as in `Material`
    land_near: float  # [deg] height of the land below the sun
    land_far: float  # [deg] height of the land opposite to the sun
    stretch: float  # slope at the horizon of the photograph's elevation over the drawn elevation
    fold: float  # fraction of the photograph's azimuths that is used
    # Mean radiance, linear, at the horizon and overhead, more towards the sun; between them the share of the second is
    # the square root of the sine of the elevation.
    low: RGB
    high: RGB
    exposure: float = 1.0
    limit: float = 5.0  # radiance that is reduced to its half
    tint: RGB = (1.0, 1.0, 1.0)  # colour filter, linear
    horizon: tuple[int, int, int] = (205, 215, 222)  # sRGB in 0..255: what things fade to in the distance


# Fitted by eye to the photographs.
SKIES = {
    "park": Photograph(
        sun_column=0.600,
        sun_height=10.5,
        sun_color=(1.0, 0.93, 0.80),
        sun_strength=5.0,
        land_near=3.5,
        land_far=10.0,
        stretch=0.6,
        fold=0.65,
        low=(1.60, 1.85, 2.10),
        high=(0.03, 0.07, 0.26),
        exposure=0.64,
        limit=1.2,
        tint=(0.72, 0.91, 1.28),
    ),
    "sunset": Photograph(
        sun_column=0.600,
        sun_height=3.3,
        sun_color=(1.0, 0.62, 0.30),
        sun_strength=4.0,
        land_near=1.5,
        land_far=5.0,
        stretch=0.42,
        fold=0.36,
        low=(5.42, 3.04, 1.51),
        high=(0.17, 0.62, 1.40),
        exposure=0.36,
        limit=9.0,
        tint=(1.0, 0.9, 0.84),
        horizon=(232, 196, 150),
    ),
    "dawn": Photograph(
        sun_column=0.635,
        sun_height=9.5,
        sun_color=(1.0, 0.66, 0.46),
        sun_strength=2.5,
        land_near=7.0,
        land_far=8.0,
        stretch=0.6,
        fold=0.5,
        low=(8.00, 4.60, 5.40),
        high=(0.16, 0.42, 1.44),
        exposure=0.45,
        limit=2.0,
        tint=(1.0, 0.86, 0.9),
        horizon=(232, 190, 196),
    ),
    NIGHT: Photograph(
        sun_column=0.36,
        sun_height=25.0,
        sun_color=(0.75, 0.85, 1.0),
        sun_strength=0.5,
        land_near=12.0,
        land_far=18.0,
        stretch=0.7,
        fold=0.8,
        low=(0.48, 0.44, 0.36),
        high=(0.02, 0.03, 0.04),
        exposure=0.6,
        limit=5.0,
        tint=(0.35, 0.6, 1.0),
        horizon=(34, 44, 52),
    ),
}


def light_scene(server: viser.ViserServer, name: str, **how: Any) -> None:
    """Light the scene by an environment map of viser's. how: as for its `configure_environment_map`.

    Pass a background, or an intensity other than 1: viser's default map, which the page draws until this one arrives,
    has no background and intensity 1, and is told apart by that (`js/scene/photograph.js`).
    """
    injector = injector_of(server)
    if injector is not None:
        injector.expect_sky(name)
    server.scene.configure_environment_map(name, **how)  # type: ignore[arg-type]


def set_sky(server: viser.ViserServer, name: str, azimuth: float = 0.0) -> Material:
    """Set environment map, lights, haze and camera range; returns a material lit by that sky.

    name: a key of `SKIES`. azimuth: [rad] of the sun, from x towards y.
    """
    photo = SKIES[name]
    turn = azimuth - (1.5 * math.pi - 2 * math.pi * (photo.sun_column - 0.5))
    wxyz = (math.cos(turn / 2), 0.0, 0.0, math.sin(turn / 2))
    light_scene(server, name, background=True, background_blurriness=0.3, background_wxyz=wxyz, environment_wxyz=wxyz)
    server.scene.configure_default_lights(enabled=True, cast_shadow=False)
    # This haze is for everything but the water, which has its own.
    server.scene.configure_fog(0.1 * HAZE_DISTANCE, 1.6 * HAZE_DISTANCE, color=photo.horizon)
    set_clipping(server, far=CAMERA_RANGE)
    elevation = drawn_elevation(photo)
    level = math.cos(elevation)
    return Material(
        sun_direction=(level * math.cos(azimuth), level * math.sin(azimuth), math.sin(elevation)),
        sun_color=photo.sun_color,
        sun_strength=photo.sun_strength,
        skyline=(math.radians(photo.land_near), math.radians(photo.land_far), photo.stretch),
        sky_fold=(photo.fold, 0.5, photo.limit),
        exposure=photo.exposure,
        sky_tint=photo.tint,
        sky_low=photo.low,
        sky_high=photo.high,
    )


class Sky:
    """The sky over a sea; a clear night has stars, in the same places every night."""

    def __init__(self, server: viser.ViserServer) -> None:
        self.server = server
        self.shown: tuple[str, float] | None = None  # arguments of the last `set`
        self.stars: viser.PointCloudHandle | None = None  # made in the first night

    def set(self, name: str, azimuth: float) -> Material:
        """Set the sky as `set_sky` does."""
        self.shown = name, azimuth
        return set_sky(self.server, name, azimuth)

    def show_stars(self, *, is_clear: bool) -> None:
        """Draw stars over the whole sky at night, unless clouds hide them."""
        is_visible = is_clear and self.shown is not None and self.shown[0] == NIGHT
        if is_visible and self.stars is None:
            points, colours = star_field()
            self.stars = self.server.scene.add_point_cloud(
                "/stars", points, colours, point_size=STAR_SIZE * STAR_DISTANCE, point_shape="circle",
                precision="float32", point_shading="flat",
            )  # fmt: skip
        if self.stars is not None and self.stars.visible != is_visible:
            self.stars.visible = is_visible


def star_field() -> tuple[NDArray[np.float32], NDArray[np.uint8]]:
    """Points (n, 3) [m] on the upper half of a sphere, and colours (n, 3), sRGB; few are bright, haze dims low ones."""
    rng = np.random.default_rng(1)
    azimuth = 2.0 * np.pi * rng.random(STAR_COUNT)
    height = rng.uniform(math.sin(math.radians(LOWEST_STAR)), 1.0, STAR_COUNT)  # as many in equal parts of the sky
    level = np.sqrt(1.0 - height**2)
    directions = np.column_stack([level * np.cos(azimuth), level * np.sin(azimuth), height])
    brightness = FAINTEST + (1.0 - FAINTEST) * rng.random(STAR_COUNT) ** 4
    brightness *= np.minimum(1.0, np.arcsin(height) / math.radians(CLEAR_AIR))
    warmth = rng.uniform(-0.1, 0.1, STAR_COUNT)
    colours = 255.0 * brightness[:, None] * np.column_stack([0.9 + warmth, np.full(STAR_COUNT, 0.92), 0.9 - warmth])
    return (STAR_DISTANCE * directions).astype(np.float32), np.rint(colours).astype(np.uint8)


def drawn_elevation(photo: Photograph) -> float:
    """The elevation [rad] at which the shader draws the photograph's sun.

    The shader shows at elevation e [deg] what the photograph has at land + e (g + (90 - land - 90 g) e/90^2), with
    the slope g = `stretch`, so that the land lies below the drawn horizon. This is the e of the sun.
    """
    above_land = photo.sun_height - photo.land_near
    g = photo.stretch
    q = (90 - photo.land_near - 90 * g) / 8100
    e = (-g + math.sqrt(g * g + 4 * q * above_land)) / (2 * q) if abs(q) > 1e-9 else above_land / g
    return math.radians(e)
