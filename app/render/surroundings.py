"""Light and floor of rope, race and cloth, bright or dark as each browser asks.

The sky is the background of the page's canvas (`js/page.css`), as these scenes draw none: it follows the browser too.
What a browser draws as a picture has no background, so that it is put behind the picture here.
"""

from typing import NamedTuple

import numpy as np
import viser
from numpy.typing import NDArray

from app.render.cameras import NEAR, set_clipping
from app.render.handles.of_handles import OfHandles
from app.render.handles.viser_inside import update_node
from app.render.skies import light_scene
from app.render.staff import Staff

Colour = tuple[int, int, int]  # sRGB, 0 to 255
FLOOR = "/floor"
SUN, SUN_INTENSITY = (-0.55, -0.6, 1.0), 1.9  # direction towards the lamp: low enough that folds shade each other
FILL, FILL_INTENSITY = (0.5, 0.2, -1.0), 0.4  # from below
FLOOR_REACH = 12.0  # [m] from the middle, where the floor is lost in the sky
NO_FOG = 10.0, 50.0  # [m] where it would begin and be dense: viser's own numbers


class FloorColours(NamedTuple):
    """Colours of the floor, by the names of viser's properties."""

    plane_color: Colour
    cell_color: Colour  # of the lines every 0.25 m
    section_color: Colour  # of the lines every 1 m


LIGHT = FloorColours((222, 227, 233), (209, 215, 223), (187, 195, 206))
DARK = FloorColours((36, 42, 51), (42, 49, 59), (53, 62, 74))


class SkyColours(NamedTuple):
    """Sky behind rope, race and cloth, as in `js/page.css`: bright in the middle, dark at the corners."""

    middle: Colour
    around: Colour  # at AROUND
    corner: Colour

    @property
    def css(self) -> str:
        """The colours as a background in a style sheet."""
        x, y = (f"{100 * part:.0f}%" for part in MIDDLE)
        return f"radial-gradient(at {x} {y}, rgb{self.middle}, rgb{self.around} {100 * AROUND:.0f}%, rgb{self.corner})"

    def pixels(self, height: int, width: int) -> NDArray[np.float64]:
        """(height, width, 3): the ellipse of the style sheet goes through the corners farthest from the middle."""
        x, y = ((np.arange(n) + 0.5) / n - part for n, part in zip((width, height), MIDDLE, strict=True))
        sides = [max(part, 1.0 - part) for part in MIDDLE]
        away = np.hypot(x / sides[0], (y / sides[1])[:, None]) / np.sqrt(2.0)
        return np.stack([np.interp(away, (0.0, AROUND, 1.0), part) for part in zip(*self, strict=True)], axis=-1)


MIDDLE, AROUND = (0.5, 0.42), 0.55  # of width and height of the picture; and of the way to the corners
LIGHT_SKY = SkyColours((240, 243, 246), (190, 206, 224), (112, 140, 172))
DARK_SKY = SkyColours((38, 47, 60), (26, 33, 43), (10, 13, 19))
_dark: OfHandles[bool] = OfHandles()  # browsers that draw dark


class Surroundings:
    """The handles of light and floor."""

    def __init__(self, server: viser.ViserServer, near: float = NEAR) -> None:
        """near: [m] from the camera, where the picture begins."""
        scene = server.scene
        # viser keeps the light and the fog of the scene before, here those of a sea.
        light_scene(server, "studio", background=False, environment_intensity=0.4)
        scene.configure_default_lights(enabled=False, cast_shadow=False)
        self.sun = scene.add_light_directional("/sun", position=SUN, intensity=SUN_INTENSITY, cast_shadow=True)
        scene.add_light_directional("/fill", position=FILL, intensity=FILL_INTENSITY)
        scene.configure_fog(*NO_FOG, enabled=False)
        set_clipping(server, near)
        for client in server.get_clients().values():
            _dark.drop(client)  # the floor begins light: js/panel/display.js requests a dark one
        self.shown: tuple[bool, bool] | None = None
        self.staff = Staff(server)
        self.floor = scene.add_grid(
            FLOOR,
            width=24.0,
            height=24.0,
            infinite_grid=True,
            cell_size=0.25,
            section_size=1.0,
            **LIGHT._asdict(),
            plane_opacity=1.0,
            fade_distance=FLOOR_REACH,
            fade_from="origin",
            shadow_opacity=0.35,
        )

    def show(self, floor: bool, grid: bool) -> None:
        """floor: whether to draw the floor; grid: whether to draw its lines."""
        if (floor, grid) == self.shown:
            return
        self.shown = floor, grid
        self.floor.visible = floor
        self.staff.show(floor)
        self.floor.cell_thickness = self.floor.section_thickness = 1.0 if grid else 0.0


def set_dark(client: viser.ClientHandle, dark: bool) -> None:
    """Draw the floor dark, or light again, for one browser. The node stays that of the server."""
    _dark.put(client, dark)
    update_node(client, FLOOR, **(DARK if dark else LIGHT)._asdict())


def before_sky(client: viser.ClientHandle, pixels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """A picture (height, width, 4) that a browser has drawn without background, before the sky that the browser shows.

    Returns sRGB (height, width, 3). Where a scene draws a sky of its own, nothing of this one is seen.
    """
    sky = (DARK_SKY if _dark.get(client) else LIGHT_SKY).pixels(*pixels.shape[:2])
    alpha = pixels[..., 3:] / 255.0
    return np.rint(alpha * pixels[..., :3] + (1.0 - alpha) * sky).astype(np.uint8)
