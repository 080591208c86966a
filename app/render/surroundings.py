"""What rope, race and cloth stand in: one light and one floor, bright or dark as each browser asks.

The sky is the background of the page's canvas (`js/page.css`), as these scenes draw none: it follows the browser too.
"""

from typing import NamedTuple

import viser
from viser._messages import SceneNodeUpdateMessage

from app.render.viser_types import ViserConnection

Colour = tuple[int, int, int]  # sRGB, 0 to 255
FLOOR = "/floor"


class FloorColours(NamedTuple):
    """Colours of the floor, by the names of viser's properties."""

    plane_color: Colour
    cell_color: Colour  # of the lines every 0.25 m
    section_color: Colour  # of the lines every 1 m


LIGHT = FloorColours((222, 227, 233), (196, 203, 212), (160, 170, 184))
DARK = FloorColours((50, 58, 70), (64, 73, 86), (84, 95, 110))


class Surroundings:
    """The handles of light and floor."""

    def __init__(self, server: viser.ViserServer) -> None:
        scene = server.scene
        scene.configure_environment_map("studio", background=False, environment_intensity=0.6)
        self.shown: tuple[bool, bool] | None = None
        self.floor = scene.add_grid(
            FLOOR,
            width=24.0,
            height=24.0,
            infinite_grid=True,
            cell_size=0.25,
            section_size=1.0,
            **LIGHT._asdict(),
            plane_opacity=1.0,
            fade_distance=26.0,
            shadow_opacity=0.3,
        )

    def show(self, floor: bool, grid: bool) -> None:
        """floor: whether to draw the floor; grid: whether to draw its lines."""
        if (floor, grid) == self.shown:
            return
        self.shown = floor, grid
        self.floor.visible = floor
        self.floor.cell_thickness = self.floor.section_thickness = 1.0 if grid else 0.0


def set_dark(client: viser.ClientHandle, dark: bool) -> None:
    """Draw the floor dark, or light again, for one browser. The node stays that of the server."""
    colours = DARK if dark else LIGHT
    connection: ViserConnection = client._websock_connection  # pyright: ignore[reportPrivateUsage]
    connection.queue_message(SceneNodeUpdateMessage(FLOOR, colours._asdict()))
