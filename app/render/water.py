"""How water looks: a sea mesh with Fresnel mirror, sun glitter, depth colour, foam and haze, in stock viser.

The surface travels as the vertices of one mesh, its slopes and foam as the vertices of a hidden one, everything else
as the vertices of a third, hidden and tiny. `water.js` (through `app/patch.py`) makes water of them in the browser.
Where the patch does not answer, the same mesh is drawn plainly by viser, with a second mesh for the foam.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import viser

from app.render.injection import hidden, patch
from sim.validation import argument_error

RGB = tuple[float, float, float]
RIPPLE_TIME = 1024.0  # [s] after which ripples start over: their phases are single precision in the browser
HAZE = 3000.0  # [m]
FAR = 20_000.0  # [m] where the camera's view ends; viser's own 1000 m cuts the horizon off
FOAM_SINKS = 0.5  # [m] how deep the plain foam mesh lies where there is no foam
FOAM_RISES = 0.02  # [m] how high it stands above the water where there is
FOAM_SHOWS = 0.35  # the foam value from which the plain mesh shows it


@dataclass(frozen=True)
class SlickRegion:
    """A round slick of another fluid on the water. Colours as in `Look`.

    centre (x, y) and radius [m]; calm: factor on the slope of the ripples.
    """

    centre: tuple[float, float]
    radius: float
    deep: RGB
    scatter: RGB
    refractive_index: float
    roughness: float
    calm: float


@dataclass(frozen=True)
class Cutout:
    """A rectangle without surface: a window into the sea, whose walls are another's to draw.

    centre (x, y) [m] of one wall, half its length [m], the way (unit vector) to the wall across and how far it is [m].
    """

    centre: tuple[float, float]
    half: float
    way: tuple[float, float]
    length: float


@dataclass(frozen=True)
class Look:
    """How a fluid looks and how it is lit. Colours are sRGB in 0..1; directions point towards the sun.

    refractive_index sets the Fresnel reflectance; roughness is the rms slope of what neither mesh nor ripples show;
    specular scales every reflection (1 is physics, the lab's oil is below). ripple_slope [rms], ripple_length and
    ripple_shortest [m] of the longest and the shortest ripple, ripple_direction [rad] towards which ripples run,
    gravity [m/s2] that sets how fast. haze [m] is the distance at which a fraction 1 - 1/e of the sea is lost in the
    sky. foam_scale [m] is the size of a patch of bubbles. disc: share of the sun's disc and glitter that shows;
    gloom: how much darker thick cloud is than thin.
    """

    deep: RGB = (0.0, 0.20, 0.31)
    scatter: RGB = (0.10, 0.52, 0.50)
    foam: RGB = (0.93, 0.95, 0.96)
    refractive_index: float = 1.333
    roughness: float = 0.03
    specular: float = 1.0
    ripple_slope: float = 0.2
    ripple_length: float = 1.6
    ripple_shortest: float = 0.05
    ripple_direction: float = 0.0
    gravity: float = 9.81
    foam_scale: float = 2.0
    sun_direction: tuple[float, float, float] = (0.6, 0.3, 0.5)
    sun_color: RGB = (1.0, 0.9, 0.75)
    sun_strength: float = 6.0
    tint: RGB = (1.0, 1.0, 1.0)
    clouds: float = 0.4
    cloud_size: float = 2.2
    disc: float = 1.0
    gloom: float = 0.3
    haze: float = HAZE
    exposure: float = 1.0
    skyline: tuple[float, float, float] = (0.06, 0.2, 0.6)
    fold: tuple[float, float, float] = (1.0, 0.3, 12.0)
    dome: bool = True
    wireframe: bool = False
    wire_color: RGB = (0.95, 0.55, 0.1)
    slick: SlickRegion | None = None
    pit: Cutout | None = None


def linear(color: RGB) -> np.ndarray:
    """Linear light of an sRGB colour in 0..1 (IEC 61966-2-1, to within 1 %)."""
    return np.clip(np.asarray(color, float), 0, 1) ** 2.2


def as_bytes(color: RGB) -> tuple[int, int, int]:
    """An sRGB colour in 0..1 as 0..255."""
    red, green, blue = (round(255 * min(max(c, 0.0), 1.0)) for c in color)
    return red, green, blue


class Water:
    """A sea of rows x cols points that changes every frame.

    Without `faces` the points are a square periodic tile of side length [m]: [i, j] rests at x = i length/rows,
    y = j length/cols, the row and column that close the tile are added here, and tiles x tiles (odd) copies of it are
    drawn from the same buffers. With `faces`, (m, 3) indices into the rows * cols points, it is a mesh of any shape
    about the origin, drawn once, whose radius is length [m]. plain: never patch, public viser only.
    Raises ValueError for an even number of tiles.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        name: str,
        rows: int,
        cols: int,
        length: float,
        *,
        tiles: int = 1,
        faces: np.ndarray | None = None,
        look: Look | None = None,
        plain: bool = False,
    ) -> None:
        if tiles < 1 or tiles % 2 == 0:
            raise argument_error("tiles", tiles, "an odd number")
        self.name = name
        self._server = server
        self._shape = (rows, cols)
        self._length = length
        self._grid = faces is None
        self._tiles = tiles if self._grid else 1
        self._look = look or Look()
        self._state = (0.0, 1.0, 0.0)  # time [s], significant height [m], mean square slope
        if faces is None:
            i, j = np.meshgrid(np.arange(rows + 1), np.arange(cols + 1), indexing="ij")
            rest = np.stack([i * length / rows, j * length / cols, 0.0 * i], axis=-1)
            corner = (i * (cols + 1) + j)[:-1, :-1].ravel()
            a, b, c, d = corner, corner + cols + 1, corner + cols + 2, corner + 1
            self._faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]).astype(np.uint32)
        else:
            rest = np.zeros((rows, cols, 3))
            self._faces = np.asarray(faces, np.uint32)
        self._vertices = rest.astype(np.float32)
        self._aux = np.zeros_like(self._vertices)
        self.mesh = server.scene.add_mesh_simple(
            name,
            self._vertices.reshape(-1, 3),
            self._faces,
            color=as_bytes(self._look.deep),
            cast_shadow=False,
            receive_shadow=False,
        )
        self._stand_ins: dict[str, viser.MeshHandle] = {}
        self._patch = None if plain else patch(server)
        if self._patch is not None:
            self._aux_mesh = hidden(server, f"{name}/water_aux", self._aux.reshape(-1, 3))
            self._look_mesh = hidden(server, f"{name}/water_look", self._uniforms())
            self._patch.expect(name)

    def set_surface(self, vertices: np.ndarray, slopes: np.ndarray, foam: np.ndarray, time: float = 0.0) -> None:
        """Draw this surface; call inside `server.atomic()`. Arrays are copied.

        vertices: (rows, cols, 3) [m]. slopes: (rows, cols, 2), dz/dx and dz/dy of the displaced surface. foam:
        (rows, cols), 0..1. time [s] moves ripples and clouds.
        """
        rows, cols = self._shape
        fields = ((self._vertices, vertices), (self._aux[..., :2], slopes), (self._aux[..., 2], foam))
        for target, source in fields:
            target[:rows, :cols] = source
            if self._grid:
                target[rows, :cols] = source[0]
                target[:, cols] = target[:, 0]
        if self._grid:
            self._vertices[rows, :, 0] += self._length
            self._vertices[:, cols, 1] += self._length
        self.mesh.vertices = self._vertices.reshape(-1, 3)
        if self._patch is not None:
            self._aux_mesh.vertices = self._aux.reshape(-1, 3)
            height = 4.0 * float(np.std(vertices[..., 2]))
            self._state = (float(time) % RIPPLE_TIME, height, float(np.vdot(slopes, slopes)) / (rows * cols))
            self._look_mesh.vertices = self._uniforms()
        self._draw_plain()

    def set_look(self, look: Look) -> None:
        """Change how it looks from the next frame on."""
        self._look = look
        self.mesh.color = as_bytes(look.deep)
        if self._patch is not None:
            self._look_mesh.vertices = self._uniforms()

    @property
    def alive(self) -> bool | None:
        """True if every browser draws it as water, False if one does not, None while not yet known."""
        return self._patch.alive(self.name) if self._patch is not None else False

    def remove(self) -> None:
        """Take it out of the scene."""
        if self._patch is not None:
            self._patch.forget(self.name)
        self.mesh.remove()

    def _uniforms(self) -> np.ndarray:
        """The look as water.js reads it, three numbers a row, in the order of its WATER_UNIFORMS."""
        look = self._look
        sun = np.asarray(look.sun_direction, float)
        rows, cols = (self._shape[0] + 1, self._shape[1] + 1) if self._grid else (0, 0)
        table = [
            linear(look.deep),
            linear(look.scatter),
            linear(look.foam),
            sun / max(float(np.linalg.norm(sun)), 1e-9),
            linear(look.sun_color) * look.sun_strength,
            (look.refractive_index, look.roughness, look.specular),
            (look.haze, look.exposure, look.foam_scale),
            (look.ripple_slope, look.ripple_length, look.ripple_shortest),
            look.skyline,
            look.fold,
            look.tint,
            (look.clouds, look.cloud_size, look.ripple_direction),
            (look.gravity, look.disc, look.gloom),
            self._state,
            (rows, cols, self._length),
            (self._tiles, float(look.dome), float(look.wireframe)),
            linear(look.wire_color),
        ]
        slick, pit = look.slick, look.pit
        if slick is None:
            table += [np.zeros(3)] * 4
        else:
            table += [
                (*slick.centre, slick.radius),
                linear(slick.deep),
                linear(slick.scatter),
                (slick.refractive_index, slick.roughness, slick.calm),
            ]
        table += [np.zeros(3)] * 2 if pit is None else [(*pit.centre, pit.half), (*pit.way, pit.length)]
        return np.array(table, np.float32)

    def _draw_plain(self) -> None:
        """What the public API alone can draw of foam, grid and far sea; nothing while every browser is patched."""
        if self.alive is not False:
            return
        z = self._vertices[..., 2]
        self._stand_in("plain_foam", self._sheet(self._aux[..., 2] > FOAM_SHOWS), self._faces, color=(235, 240, 242))
        slick = self._look.slick
        if slick is not None or "plain_slick" in self._stand_ins:
            (x, y), radius = (slick.centre, slick.radius) if slick is not None else ((0.0, 0.0), 0.0)
            inside = np.hypot(self._vertices[..., 0] - x, self._vertices[..., 1] - y) < radius
            colour = as_bytes(slick.deep if slick is not None else self._look.deep)
            self._stand_in("plain_slick", self._sheet(inside), self._faces, color=colour)
        if self._look.wireframe or "plain_wire" in self._stand_ins:
            wire = self._stand_in("plain_wire", self._vertices.reshape(-1, 3), self._faces, wireframe=True)
            wire.visible = self._look.wireframe
        if self._grid and "plain_sea" not in self._stand_ins:
            x, y = np.array([[-1, 1, 1, -1], [-1, -1, 1, 1]]) * FAR / 4
            low = np.full(4, 2 * float(z.min()) - FOAM_SINKS)
            self._stand_in(
                "plain_sea", np.stack([x, y, low], 1), np.array([[0, 1, 2], [0, 2, 3]]), color=self.mesh.color
            )

    def _sheet(self, shown: np.ndarray) -> np.ndarray:
        """The surface once more, (n, 3): just above itself where it is to show, below elsewhere."""
        sheet = self._vertices.copy()
        sheet[..., 2] += np.where(shown, FOAM_RISES, -FOAM_SINKS)
        return sheet.reshape(-1, 3)

    def _stand_in(self, suffix: str, vertices: np.ndarray, faces: np.ndarray, **mesh: Any) -> viser.MeshHandle:
        """A mesh for browsers without the patch; the others hide it (water.js)."""
        vertices = vertices.astype(np.float32)
        if suffix in self._stand_ins:
            self._stand_ins[suffix].vertices = vertices
        else:
            self._stand_ins[suffix] = self._server.scene.add_mesh_simple(
                f"{self.name}/{suffix}",
                vertices,
                faces.astype(np.uint32),
                cast_shadow=False,
                receive_shadow=False,
                **mesh,
            )
        return self._stand_ins[suffix]


@dataclass(frozen=True)
class Photograph:
    """What there is to know of one of viser's environment maps: where its sun is, and how high its land."""

    sun_column: float  # of the sun, 0..1 from the left edge of the panorama
    sun_height: float  # [deg]
    sun_color: RGB
    sun_strength: float
    land_near: float  # [deg] land below the sun, and opposite to it
    land_far: float
    stretch: float  # how fast elevation in the picture grows with elevation in our sky, at the horizon
    fold: float  # share of the picture's azimuths that are used
    exposure: float = 1.0
    limit: float = 5.0  # radiance at which bright places of the picture are held back to half
    tint: RGB = (1.0, 1.0, 1.0)  # a filter before the lens
    horizon: tuple[int, int, int] = (205, 215, 222)  # what distance fades things to, as drawn


SKIES = {
    "park": Photograph(0.600, 10.5, (1.0, 0.93, 0.80), 5.0, 3.5, 10.0, 0.6, 0.65, 0.64, 1.2, (0.72, 0.91, 1.28)),
    "sunset": Photograph(
        0.600, 3.3, (1.0, 0.62, 0.30), 4.0, 1.5, 5.0, 0.42, 0.36, 0.36, 9.0, (1.0, 0.9, 0.84), (232, 196, 150)
    ),
    "dawn": Photograph(
        0.635, 9.5, (1.0, 0.66, 0.46), 2.5, 7.0, 8.0, 0.6, 0.5, 0.45, 2.0, (1.0, 0.86, 0.9), (232, 190, 196)
    ),
    "night": Photograph(
        0.36, 25.0, (0.75, 0.85, 1.0), 0.5, 12.0, 18.0, 0.7, 0.8, 0.6, 5.0, (0.35, 0.6, 1.0), (34, 44, 52)
    ),
}


def sky(server: viser.ViserServer, name: str, azimuth: float = 0.0) -> Look:
    """Set the environment map, lights and camera range; returns a Look lit by that sky. azimuth [rad] of the sun."""
    photo = SKIES[name]
    turn = azimuth - (1.5 * math.pi - 2 * math.pi * (photo.sun_column - 0.5))
    wxyz = (math.cos(turn / 2), 0.0, 0.0, math.sin(turn / 2))
    server.scene.configure_environment_map(
        name,  # type: ignore[arg-type]
        background=True,
        background_blurriness=0.3,
        background_wxyz=wxyz,
        environment_wxyz=wxyz,
    )
    server.scene.configure_default_lights(enabled=True, cast_shadow=False)
    server.scene.configure_fog(0.1 * HAZE, 1.6 * HAZE, color=photo.horizon)  # everything but the sea
    server.initial_camera.far = FAR
    # The elevation e at which the remapped sky shows the sun: land + e (g + (90 - land - 90 g) e / 90^2) = height.
    high = photo.sun_height - photo.land_near
    g = photo.stretch
    q = (90 - photo.land_near - 90 * g) / 8100
    e = math.radians((-g + math.sqrt(g * g + 4 * q * high)) / (2 * q) if abs(q) > 1e-9 else high / g)
    return Look(
        sun_direction=(math.cos(e) * math.cos(azimuth), math.cos(e) * math.sin(azimuth), math.sin(e)),
        sun_color=photo.sun_color,
        sun_strength=photo.sun_strength,
        skyline=(math.radians(photo.land_near), math.radians(photo.land_far), g),
        fold=(photo.fold, 0.5, photo.limit),
        exposure=photo.exposure,
        tint=photo.tint,
    )
