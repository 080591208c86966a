"""The walls of the cutaway: a band of oil over water, bright lines where the fluids meet, a ruler and labels."""

import math
import time

import numpy as np
import viser

from app.formats.formatting import number
from app.render.coloured_mesh import ColouredMesh
from app.render.handles.viser_inside import set_arrays
from app.render.injection import add_data_mesh, injector_of
from app.render.material import RGB, blend
from app.scenes.radial_sea.cutaway import DIRECTION, FAR_WALL_POINTS, HALF_WIDTH, Cutaway
from app.scenes.radial_sea.drawing.materials import mixture_share, rgb_of
from app.scenes.radial_sea.frame import RadialFrame
from sim.ocean.fluids.fluid_column import FluidColumn
from sim.ocean.fluids.oil_film import light_through

BRIGHT_WATER: RGB = (0.13, 0.50, 0.60)  # of the water under its surface, as if light came through
DEEP_WATER: RGB = (0.03, 0.16, 0.27)  # of the water at the floor
OIL_AGAINST_LIGHT: RGB = (0.70, 0.42, 0.12)  # light through a few centimetres of oil
OIL_LIGHT_SHARES = 1.0, 0.3  # of that colour in the drawn one, at the oil's surface and where the water begins
WEB_SIZE = 0.7  # [m] at size 1 of the meshes of light that waves focus (`js/sea/underwater.js`)
SURFACE_LINE, INTERFACE_LINE = (235, 246, 250), (255, 196, 64)
LINE_OFFSET = 0.02  # [m] that lines stand before the wall

TICK_SPACING, TICKS_PER_NUMBER = 0.1, 5  # [m] of the ruler's ticks; after this number comes a longer one with a number
TICK_LENGTH = 0.07  # [m] at size 1; one with a number is twice as long
RULER_PLACE, OIL_PLACE, DRAFT_PLACE = -0.8, 0.3, 0.42  # along the far wall, in its half width
LABEL_OFFSET = 0.06  # [m] that ruler and labels stand before the wall
RULER_COLOUR, DRAFT_COLOUR = (235, 246, 250), (255, 236, 140)
# Labels have a size in the scene: seen from far away they shrink with the wall, and none covers another.
LETTER_HEIGHT = 0.12  # [m] at size 1
MAX_LETTER_SHARE = 0.5  # greatest height of a letter over the distance between two numbers of the ruler
LINE_HEIGHT = 0.13  # [m] at size 1 that a label needs
LABEL_STEP = 0.02  # [m] by which ruler and labels move at least: each move is a message of its own
LABEL_INTERVAL = 0.2  # [s] between two texts of a label while the sea moves: faster ones cannot be read

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
        self.underwater = np.zeros((1, 3), np.float32)  # as `js/sea/underwater.js` reads it
        self.underwater_mesh = None
        if injector_of(server) is not None:
            self.underwater_mesh = add_data_mesh(server, f"{name}/underwater", self.underwater)
        lines = np.zeros((FAR_WALL_POINTS - 1, 2, 3), np.float32)
        self.lines = [
            server.scene.add_line_segments(
                f"{name}/{part}", lines, colors=colour, thickness=thick, thickness_units="screen"
            )
            for part, colour, thick in (("top", SURFACE_LINE, 2.0), ("interface", INTERFACE_LINE, 3.0))
        ]
        self.half_width, self.size = cutaway.half_width, cutaway.half_width / HALF_WIDTH
        self.shown_time = self.said_at = -math.inf  # [s] of the frame, and of the clock when labels were written last
        self.ruler_at = (0.0, 0.0, 0.0)  # [m]
        # The ruler is made once; ruler and labels move with the middle of the far wall.
        self.ruler = server.scene.add_line_segments(
            f"{name}/ruler", self.ruler_lines(cutaway.floor), RULER_COLOUR, thickness=1.5, thickness_units="screen"
        )
        spacing = TICK_SPACING * TICKS_PER_NUMBER
        letters = min(LETTER_HEIGHT * self.size, MAX_LETTER_SHARE * spacing)
        for k in range(int(-cutaway.floor / spacing) + 1):
            text, place = f"\N{MINUS SIGN}{k * spacing:.1f} m" if k else "0 m", self.on_wall(RULER_PLACE, -k * spacing)
            server.scene.add_label(
                f"{name}/ruler/tick_{k}", text, position=place, anchor="center-right", font_size_mode="scene",
                font_scene_height=letters,
            )  # fmt: skip
        self.labels = {
            part: server.scene.add_label(
                f"{name}/ruler/{part}", "", anchor="center-left", font_size_mode="scene", font_scene_height=letters
            )
            for part in ("oil", "water", "draft")
        }
        self.arrow = server.scene.add_line_segments(
            f"{name}/ruler/arrow",
            np.zeros((3, 2, 3), np.float32),
            DRAFT_COLOUR,
            thickness=3.0,
            thickness_units="screen",
        )

    def vertices(self, cutaway: Cutaway) -> np.ndarray:
        """Vertices (4 n + 1, 3) [m]: rows of top, interface, interface and floor, and the middle of the floor."""
        heights = (cutaway.top, cutaway.interface, cutaway.interface, np.full(self.n, cutaway.floor))
        rows = [np.column_stack([cutaway.points, z]) for z in heights]
        middle = np.append(cutaway.points[:-1].mean(axis=0), cutaway.floor)
        return np.concatenate([*rows, middle[None]]).astype(np.float32)

    def on_wall(self, along: float, height: float) -> tuple[float, float, float]:
        """Place [m] from the middle of the far wall, a little before it; along: in half widths, to the right."""
        x, y = DIRECTION
        level = along * self.half_width
        return -y * level + LABEL_OFFSET * x, x * level + LABEL_OFFSET * y, height

    def ruler_lines(self, floor: float) -> np.ndarray:
        """Segments (n, 2, 3) [m] of a ruler from the mean level of the sea down to the floor [m]."""
        lines = [[self.on_wall(RULER_PLACE, 0.0), self.on_wall(RULER_PLACE, floor)]]
        for k in range(int(-floor / TICK_SPACING) + 1):
            length = TICK_LENGTH * (2.0 if k % TICKS_PER_NUMBER == 0 else 1.0) * self.size / self.half_width
            ends = RULER_PLACE, RULER_PLACE + length
            lines.append([self.on_wall(along, -k * TICK_SPACING) for along in ends])
        return np.array(lines, np.float32)

    def show_ruler(self, cutaway: Cutaway, keel: float | None, *, say: bool, column: FluidColumn) -> None:
        """Draw ruler and arrow; with `say`, also the labels.

        These are the fluids, and how deep the lowest point of the body lies; keel [m] is its height.
        """
        middle = (*cutaway.middle, 0.0)
        if math.dist(self.ruler_at, middle) > LABEL_STEP:
            self.ruler.position = self.ruler_at = middle
        right = cutaway.points[:FAR_WALL_POINTS] - cutaway.middle
        along = right @ np.array([-DIRECTION[1], DIRECTION[0]]) / cutaway.half_width
        at = {place: int(np.argmin(np.abs(along - place))) for place in (OIL_PLACE, DRAFT_PLACE)}
        surface = float(cutaway.top[at[DRAFT_PLACE]])
        is_wet = keel is not None and keel < surface
        if keel is not None and is_wet:
            head = 0.05 * self.size
            high, deep = self.on_wall(DRAFT_PLACE, surface), self.on_wall(DRAFT_PLACE, keel)
            sides = [self.on_wall(DRAFT_PLACE + side * head / self.half_width, keel + 2.0 * head) for side in (-1, 1)]
            set_arrays(self.arrow, points=np.array([(high, deep), (deep, sides[0]), (deep, sides[1])]))
        if self.arrow.visible != is_wet:
            self.arrow.visible = is_wet
        if not say:
            return
        top, low = float(cutaway.top[at[OIL_PLACE]]), float(cutaway.interface[at[OIL_PLACE]])
        upper = "oil and water, mixed" if column.kind == "mixed" else "oil"
        texts = {
            "oil": f"{upper}, {number(column.surface.density)} kg/m³"
            + (f", {top - low:.2g} m" if cutaway.has_oil else ""),
            "water": f"water, {number(column.water.density)} kg/m³",
        }
        visibility = {
            "oil": cutaway.has_oil or column.kind == "mixed",
            "water": column.kind != "mixed",
            "draft": is_wet,
        }
        places = {
            "oil": self.on_wall(OIL_PLACE + 0.25, 0.5 * (top + low) if cutaway.has_oil else 0.3 * cutaway.floor),
            "water": self.on_wall(OIL_PLACE + 0.25, 0.6 * cutaway.floor),
        }
        if keel is not None and is_wet:
            texts["draft"] = f"lowest point {surface - keel:.2f} m deep"
            # Below the arrow, and so far below the label of the oil that lines of text have room in a small window.
            below = min(keel, places["oil"][2] - LINE_HEIGHT * self.size) - LINE_HEIGHT * self.size
            places["draft"] = self.on_wall(DRAFT_PLACE + 0.03, below)
        for part, label in self.labels.items():
            if label.visible != visibility[part]:
                label.visible = visibility[part]
            if not visibility[part]:
                continue
            if label.text != texts[part]:
                label.text = texts[part]
            if math.dist(label.position, places[part]) > LABEL_STEP:
                label.position = places[part]

    def labels_are_due(self, now: float, step: float) -> bool:
        """True if labels follow at time `now` [s]: a few times a second; paused, or with single steps [s], always."""
        moved, self.shown_time = now - self.shown_time, now
        wall = time.monotonic()
        if moved > 1.5 * step and wall - self.said_at < LABEL_INTERVAL:
            return False
        self.said_at = wall
        return True

    def show(self, frame: RadialFrame, keel: float | None) -> None:
        """Draw the walls as they are now, or hide them; call it where a picture is handed over as one.

        keel: height [m] of the lowest point of the body before the far wall; None if there is no body.
        """
        cutaway, column = frame.cutaway, frame.column
        visible = cutaway is not None
        if self.mesh.mesh.visible != visible:
            self.mesh.mesh.visible = visible
        if self.ruler.visible != visible:
            self.ruler.visible = visible
        for line in self.lines:
            is_shown = visible and (line is self.lines[0] or cutaway.has_oil)
            if line.visible != is_shown:
                line.visible = is_shown
        if cutaway is None:
            return
        say = self.labels_are_due(frame.time, frame.params.time_step)
        self.show_ruler(cutaway, keel, say=say, column=column)
        colours = self.paint(column)
        self.light_water(column)
        self.mesh.set(self.vertices(cutaway), colours)
        for line, height in zip(self.lines, (cutaway.top, cutaway.interface), strict=True):
            at = np.column_stack(
                [cutaway.points[:FAR_WALL_POINTS] + LINE_OFFSET * np.array(cutaway.direction), height[:FAR_WALL_POINTS]]
            )
            set_arrays(line, points=np.stack([at[:-1], at[1:]], axis=1))

    def light_water(self, column: FluidColumn) -> None:
        """Show the webs of light under the waves, as far as the fluid above lets light through."""
        through = 0.0 if column.kind == "mixed" else float(light_through(column.thickness).mean())
        now = np.array([[through, WEB_SIZE * self.size, 0.0]], np.float32)
        if self.underwater_mesh is not None and not np.array_equal(now, self.underwater):
            self.underwater = now
            set_arrays(self.underwater_mesh, vertices=now)

    def paint(self, column: FluidColumn) -> np.ndarray | None:
        """Colours (4 n + 1, 3) where they changed, else None."""
        key = (column.kind, column.oil.name, column.fraction)
        if key == self.painted:
            return None
        self.painted = key
        n, colour = self.n, rgb_of(column.oil.colour)
        lit, oil = (blend(colour, OIL_AGAINST_LIGHT, part) for part in OIL_LIGHT_SHARES)
        share = mixture_share(column) if column.kind == "mixed" else 0.0
        high, low = blend(BRIGHT_WATER, lit, share), blend(DEEP_WATER, rgb_of(column.oil.colour), share)
        self.colours[:n] = lit
        self.colours[n : 2 * n] = oil
        self.colours[2 * n : 3 * n] = high
        self.colours[3 * n :] = low
        return self.colours
