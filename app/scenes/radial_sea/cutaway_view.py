"""The walls of the window into the sea: a band of oil over water, and bright lines where the fluids meet."""

import numpy as np
import viser

from app.render.coloured_mesh import ColouredMesh
from app.render.material import RGB, Material
from app.scenes.radial_sea.cutaway import FAR, Section
from app.scenes.radial_sea.materials import blend, rgb_of
from sim.ocean.fluid_column import FluidColumn

SHALLOW: RGB = (0.13, 0.50, 0.60)  # of the water's band under its surface and at the floor, as if lit through
DEEP: RGB = (0.03, 0.16, 0.27)
OILY: RGB = (0.42, 0.27, 0.10)  # what a finger of oil against the light looks like
SURFACE_LINE, INTERFACE_LINE = (235, 246, 250), (255, 196, 64)
BEFORE = 0.02  # [m] that lines stand before the wall


class Walls:
    """Draws `Section`s."""

    def __init__(self, server: viser.ViserServer, name: str, section: Section) -> None:
        n = len(section.points)
        rows = np.arange(n)
        a, b = rows[:-1], rows[1:]
        quads = []
        for high, low in (
            (0, 1),
            (2, 3),
        ):  # bands between rows of vertices; the interface is there twice, for its colours
            h, k = high * n, low * n
            quads += [np.stack([a + h, b + h, a + k], 1), np.stack([b + h, b + k, a + k], 1)]
        floor = np.stack([np.full(n - 1, 4 * n), a + 3 * n, b + 3 * n], 1)
        self.n = n
        self.colours = np.zeros((4 * n + 1, 3), np.float32)
        self.painted: tuple[object, ...] = ()
        self.mesh = ColouredMesh(
            server, name, self.vertices(section), np.concatenate([*quads, floor]).astype(np.uint32), self.colours,
            color=(40, 110, 130), cast_shadow=False, receive_shadow=False,
        )  # fmt: skip
        lines = np.zeros((FAR - 1, 2, 3), np.float32)
        self.lines = [
            server.scene.add_line_segments(
                f"{name}/{part}", lines, colors=colour, thickness=thick, thickness_units="screen"
            )
            for part, colour, thick in (("top", SURFACE_LINE, 2.0), ("interface", INTERFACE_LINE, 3.0))
        ]

    def vertices(self, section: Section) -> np.ndarray:
        """Rows of the top, the interface twice, the floor; and the middle of the floor."""
        heights = (section.top, section.interface, section.interface, np.full(self.n, section.floor))
        rows = [np.column_stack([section.points, z]) for z in heights]
        middle = np.append(section.points[:-1].mean(axis=0), section.floor)
        return np.concatenate([*rows, middle[None]]).astype(np.float32)

    def show(self, section: Section | None, light: Material, column: FluidColumn) -> None:
        """The walls as they are now, or nothing; call inside `server.atomic()`."""
        visible = section is not None
        if self.mesh.mesh.visible != visible:
            self.mesh.mesh.visible = visible
        for line in self.lines:
            line.visible = visible and (line is self.lines[0] or section.oiled)
        if section is None:
            return
        colours = self.paint(light, column)
        self.mesh.set(self.vertices(section), colours)
        for line, height in zip(self.lines, (section.top, section.interface), strict=True):
            at = np.column_stack([section.points[:FAR] + BEFORE * np.array(section.way), height[:FAR]])
            line.points = np.stack([at[:-1], at[1:]], axis=1).astype(np.float32)

    def paint(self, light: Material, column: FluidColumn) -> np.ndarray | None:
        """Colours where they changed, else None."""
        key = (column.kind, column.oil.name, column.fraction)
        if key == self.painted:
            return None
        self.painted = key
        n, oil = self.n, blend(rgb_of(column.oil.colour), OILY, 0.55)
        share = min(1.0, 0.35 + column.fraction) if column.kind == "mixed" else 0.0
        high, low = blend(SHALLOW, oil, share), blend(DEEP, rgb_of(column.oil.colour), share)
        self.colours[: 2 * n] = oil
        self.colours[2 * n : 3 * n] = high
        self.colours[3 * n :] = low
        return self.colours
