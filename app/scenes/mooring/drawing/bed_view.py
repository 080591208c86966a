"""The bed of the mooring: mottled sand with lines on it, and in browsers with shaders the light of the waves there."""

import math

import numpy as np
import viser
from numpy.typing import NDArray

from app.messages import Vector
from app.render.coloured_mesh import ColouredMesh
from app.render.injection import add_data_mesh, injector_of
from app.scenes.mooring.arrangement import depth_of, extent
from app.scenes.mooring.drawing.square import square_faces, square_points
from app.scenes.mooring.frame import MooringFrame

SHALLOW_BED, DEEP_BED = (108, 132, 124), (22, 60, 80)  # sand in the light near the surface, and where little is left
LOST_COLOUR = (9, 42, 65)  # of water without light
CELL_COLOUR, SECTION_COLOUR = (88, 122, 134), (58, 92, 106)
LIGHT_REACH = 40.0  # [m] of water that leave 1/e of the light of the sun
BED_ROWS, BED_STEP = 33, 2.0**-7  # points along a side of the bed, and [m] to which they are rounded for the page
BED_MOTTLE = 0.10  # standard deviation of the brightness of the sand
BED_LIT = 0.5, 1.15  # distances from the middle, in half sides, at which the bed begins to be lost in the water, and is
GRID_SIDE = 0.56  # of the side of the bed, where its lines are lost
GRID_ABOVE = 0.0008  # [`extent`s] that the lines of the bed lie above it
WEB_SIZE, MAX_WEB_SIZE = 0.6, 12.0  # of the webs of light that waves focus: in depths, and the largest [m]
CELLS = (1.0, 2.0, 5.0)  # of the bed's lines, times a power of ten


def cell_of(far: float) -> float:
    """Distance [m] of the bed's lines: about ten to the anchors, and round."""
    least = 0.1 * far
    power = 10.0 ** np.floor(np.log10(least))
    return float(next((power * cell for cell in CELLS if power * cell >= least), 10.0 * power))


def mottle(rows: int) -> NDArray[np.float64]:
    """Noise (rows rows, 1) of standard deviation 1 on a square: patches of several sizes, always the same."""
    noise = np.random.default_rng(1).normal(size=(rows, rows))
    k = np.hypot(*np.meshgrid(np.fft.fftfreq(rows), np.fft.fftfreq(rows)))
    patches = np.fft.ifft2(np.fft.fft2(noise) / np.maximum(k, 1.0 / rows)).real
    return ((patches - patches.mean()) / patches.std()).reshape(-1, 1)


def bed_colours(depth: float) -> NDArray[np.float64]:
    """Colours (BED_ROWS BED_ROWS, 3) of sand at a depth [m], sRGB in 0..1: lost in the water towards the sides."""
    shallow, deep, lost = np.array([SHALLOW_BED, DEEP_BED, LOST_COLOUR]) / 255.0
    sand = deep + math.exp(-depth / LIGHT_REACH) * (shallow - deep)
    near, far = BED_LIT
    away = np.clip((np.hypot(*square_points(BED_ROWS).T) - near) / (far - near), 0.0, 1.0)[:, None]
    mottled = sand * (1.0 + BED_MOTTLE * mottle(BED_ROWS))
    return np.clip(mottled + away * away * (3.0 - 2.0 * away) * (lost - mottled), 0.0, 1.0)


class DrawnBed:
    """The bed."""

    def __init__(self, server: viser.ViserServer, frame: MooringFrame, label: Vector) -> None:
        """label: place [m] of the depth in words."""
        p = frame.params
        depth, far = depth_of(p), extent(p)
        cell = cell_of(far)
        self.grid = server.scene.add_grid(
            "/bed", width=frame.side, height=frame.side, cell_size=cell, section_size=5 * cell,
            position=(0.0, 0.0, -depth + GRID_ABOVE * far), fade_distance=GRID_SIDE * frame.side,
            fade_from="origin", shadow_opacity=0.0,
            cell_color=CELL_COLOUR, section_color=SECTION_COLOUR,
        )  # fmt: skip
        places = 0.5 * frame.side * square_points(BED_ROWS)
        self.sand = ColouredMesh(
            server, "/sand", np.column_stack([places, np.full(len(places), -depth)]), square_faces(BED_ROWS),
            bed_colours(depth), columns=BED_ROWS, step=BED_STEP, color=DEEP_BED, side="double",
            cast_shadow=False, receive_shadow=False,
        )  # fmt: skip
        self.label = server.scene.add_label("/depth", f"{depth:g} m deep", position=label, anchor="center-center")
        if injector_of(server) is not None:
            webs = np.array([[1.0, min(WEB_SIZE * depth, MAX_WEB_SIZE), 0.0]])  # as `js/sea/underwater.js` reads it
            add_data_mesh(server, f"{self.sand.name}/underwater", webs)

    def show(self, frame: MooringFrame) -> None:
        """Draw the lines on the sand, or hide them."""
        thickness = 1.0 if frame.params.grid else 0.0
        if self.grid.cell_thickness != thickness:
            self.grid.cell_thickness = self.grid.section_thickness = thickness

    def remove(self) -> None:
        """Remove it from the scene."""
        for part in (self.grid, self.sand, self.label):
            part.remove()
