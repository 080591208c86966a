"""The walls of the cutaway: a band of oil over water, and bright lines where the fluids meet."""

import numpy as np
import viser

from app.render.coloured_mesh import ColouredMesh
from app.render.material import RGB, Material
from app.scenes.radial_sea.cutaway import FAR_WALL_POINTS, Cutaway
from app.scenes.radial_sea.materials import blend, mixture_share, rgb_of
from sim.ocean.fluid_column import FluidColumn

BRIGHT_WATER: RGB = (0.13, 0.50, 0.60)  # of the water under its surface, as if light came through
DEEP_WATER: RGB = (0.03, 0.16, 0.27)  # of the water at the floor
OIL_AGAINST_LIGHT: RGB = (0.42, 0.27, 0.10)  # what a few centimetres of oil let through
OIL_LIGHT_SHARE = 0.55  # of that colour in the drawn one
SURFACE_LINE, INTERFACE_LINE = (235, 246, 250), (255, 196, 64)
LINE_OFFSET = 0.02  # [m] that lines stand before the wall

WALL_STEP = 1e-3  # [m] to which points of the walls are rounded for the page


class Walls:
    """Draws `Cutaway`s."""

    def __init__(self, server: viser.ViserServer, name: str, cutaway: Cutaway) -> None:
        n = len(cutaway.points)
        rows = np.arange(n)
        a, b = rows[:-1], rows[1:]
        quads = []
        # Bands between rows of vertices; the interface has two rows, of the colours above and below it.
        for high, low in ((0, 1), (2, 3)):
            h, k = high * n, low * n
            quads += [np.stack([a + h, b + h, a + k], 1), np.stack([b + h, b + k, a + k], 1)]
        floor = np.stack([np.full(n - 1, 4 * n), a + 3 * n, b + 3 * n], 1)
        self.n = n
        self.colours = np.zeros((4 * n + 1, 3), np.float32)
        self.painted: tuple[object, ...] = ()
        self.mesh = ColouredMesh(
            server, name, self.vertices(cutaway), np.concatenate([*quads, floor]).astype(np.uint32), self.colours,
            columns=n, step=WALL_STEP, color=(40, 110, 130), cast_shadow=False, receive_shadow=False,
        )  # fmt: skip
        lines = np.zeros((FAR_WALL_POINTS - 1, 2, 3), np.float32)
        self.lines = [
            server.scene.add_line_segments(
                f"{name}/{part}", lines, colors=colour, thickness=thick, thickness_units="screen"
            )
            for part, colour, thick in (("top", SURFACE_LINE, 2.0), ("interface", INTERFACE_LINE, 3.0))
        ]

    def vertices(self, cutaway: Cutaway) -> np.ndarray:
        """Vertices (4 n + 1, 3) [m]: rows of top, interface, interface and floor, and the middle of the floor."""
        heights = (cutaway.top, cutaway.interface, cutaway.interface, np.full(self.n, cutaway.floor))
        rows = [np.column_stack([cutaway.points, z]) for z in heights]
        middle = np.append(cutaway.points[:-1].mean(axis=0), cutaway.floor)
        return np.concatenate([*rows, middle[None]]).astype(np.float32)

    def show(self, cutaway: Cutaway | None, light: Material, column: FluidColumn) -> None:
        """Draw the walls as they are now, or hide them; call inside `server.atomic()`."""
        visible = cutaway is not None
        if self.mesh.mesh.visible != visible:
            self.mesh.mesh.visible = visible
        for line in self.lines:
            line.visible = visible and (line is self.lines[0] or cutaway.has_oil)
        if cutaway is None:
            return
        colours = self.paint(light, column)
        self.mesh.set(self.vertices(cutaway), colours)
        for line, height in zip(self.lines, (cutaway.top, cutaway.interface), strict=True):
            at = np.column_stack(
                [cutaway.points[:FAR_WALL_POINTS] + LINE_OFFSET * np.array(cutaway.direction), height[:FAR_WALL_POINTS]]
            )
            line.points = np.stack([at[:-1], at[1:]], axis=1).astype(np.float32)

    def paint(self, light: Material, column: FluidColumn) -> np.ndarray | None:
        """Colours (4 n + 1, 3) where they changed, else None."""
        key = (column.kind, column.oil.name, column.fraction)
        if key == self.painted:
            return None
        self.painted = key
        n, oil = self.n, blend(rgb_of(column.oil.colour), OIL_AGAINST_LIGHT, OIL_LIGHT_SHARE)
        share = mixture_share(column) if column.kind == "mixed" else 0.0
        high, low = blend(BRIGHT_WATER, oil, share), blend(DEEP_WATER, rgb_of(column.oil.colour), share)
        self.colours[: 2 * n] = oil
        self.colours[2 * n : 3 * n] = high
        self.colours[3 * n :] = low
        return self.colours
