"""The mooring seen above and below the water: surface, bed, lines coloured by tension, body, anchors, watch circle."""

import math
from typing import Any, ClassVar, TypeAlias

import numpy as np
import viser
from numpy.typing import NDArray

from app.formats.packing import compile_packing
from app.messages import RestartStatistics, Snapshot, Vector
from app.render.cameras import set_clipping
from app.render.colormap import SCALE, set_tube_colours
from app.render.coloured_mesh import ColouredMesh
from app.render.dragging import GrabLine, drag
from app.render.gizmo import Gizmo
from app.render.injection import add_data_mesh, injector_of
from app.render.material import as_linear_bytes
from app.render.meshes import ball, smooth_line, sweep, tube_faces
from app.render.tubes import compile_tube
from app.render.viser_inside import set_arrays
from app.scenes.contract import Pieces, PostCommand, SceneView
from app.scenes.mooring.arrangement import depth_of, diameter_of, extent, has_body, hull_of, width_of
from app.scenes.mooring.frame import MooringFrame, MooringReadings
from app.scenes.mooring.parameters import MAX_LINES, MooringParams
from app.scenes.mooring.report import TENSIONS, figures_of, marks_of, notes_of, readout_of
from app.scenes.springs.html import simple_drawing
from sim.floating.rotation import heading_angle, rotation_matrix

SIDES = 6  # of a tube
RING_COUNT = 90  # rings of a line, about
TUBE_STEP = 2.0**-9  # [m] to which points of a tube are rounded for the page
LINE_SIZE = 0.0055  # radius of a drawn line, in `extent`s: true ones could not be seen
ANCHOR_SIZE, FAIRLEAD_SIZE = 0.02, 0.009  # radius, in the same
ARROW_SIZE, SMALL_ARROW_SIZE = 0.12, 0.07
CIRCLE_POINTS = 96
MAX_DRAWN_PATH = 400  # places of the body's path
WATER_COLOUR, WATER_OPACITY = (64, 120, 156), 0.4  # in browsers without shaders
WATER_STEP = 2.0**-7  # [m] to which points of the water are rounded for the page
SHALLOW_BED, DEEP_BED = (108, 132, 124), (22, 60, 80)  # sand in the light near the surface, and where little is left
CELL_COLOUR, SECTION_COLOUR = (58, 92, 106), (36, 68, 84)
LIGHT_REACH = 40.0  # [m] of water that leave 1/e of the light of the sun
BED_ROWS, BED_STEP = 65, 2.0**-7  # points along a side of the bed, and [m] to which they are rounded for the page
BED_MOTTLE = 0.10  # standard deviation of the brightness of the sand
BED_LIT = 0.6, 1.1  # distances from the middle, in half sides, at which the bed begins to be lost in the water, and is
GRID_SIDE = 0.56  # of the side of the bed, where its lines are lost
GRID_ABOVE = 0.0008  # [`extent`s] that the lines of the bed lie above it
WEB_SIZE, MAX_WEB_SIZE = 0.6, 12.0  # of the webs of light that waves focus: in depths, and the largest [m]
# The body as drawn, from below: antifouling up to the waterline, a stripe and paint.
PAINTS = ((1.0, (112, 30, 26)), (1.012, (238, 240, 240)), (1.0, (240, 128, 24)))  # width over the hull's, colour
STRIPE = 0.045  # height, in widths of the hull
# What stands on deck, without weight: width over the hull's, height in widths of the hull, colour.
ON_DECK = ((0.46, 0.18, (236, 238, 238)), (0.06, 0.42, (60, 66, 74)), (0.13, 0.08, (250, 206, 60)))
LYING_COLOUR, LOST_COLOUR = (44, 28, 16), (9, 42, 65)  # of a line on the bed, and of water without light
ANCHOR_COLOUR, LIFTED_COLOUR, FAIRLEAD_COLOUR = (50, 54, 62), (214, 40, 40), (30, 32, 38)
WATCH_COLOUR, PATH_COLOUR, SHADOW_COLOUR = (200, 30, 60), (250, 250, 250), (52, 72, 76)
CELLS = (1.0, 2.0, 5.0)  # of the bed's lines, times a power of ten
FAR_VIEW = 40.0  # where the picture ends, and the bed would, in `extent`s
MooringSnapshot: TypeAlias = Snapshot[MooringParams, MooringFrame, MooringReadings]
Shape: TypeAlias = tuple[Any, ...]


def linear(colour: tuple[int, int, int]) -> tuple[int, int, int]:
    """A colour, sRGB, as batches take it."""
    red, green, blue = (part / 255.0 for part in colour)
    return as_linear_bytes((red, green, blue))


def cell_of(far: float) -> float:
    """Distance [m] of the bed's lines: about ten to the anchors, and round."""
    least = 0.1 * far
    power = 10.0 ** np.floor(np.log10(least))
    return float(next((power * cell for cell in CELLS if power * cell >= least), 10.0 * power))


def square_points(rows: int) -> NDArray[np.float64]:
    """Points (rows rows, 2) of the square from -1 to 1."""
    axis = np.linspace(-1.0, 1.0, rows)
    return np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)


def square_faces(rows: int) -> NDArray[np.int64]:
    """Triangles (m, 3) of a square of rows by rows points."""
    i, j = np.meshgrid(np.arange(rows - 1), np.arange(rows - 1), indexing="ij")
    a = (i * rows + j).ravel()
    return np.concatenate([np.stack([a, a + rows, a + 1], 1), np.stack([a + 1, a + rows, a + rows + 1], 1)])


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


class MooringView(SceneView[MooringParams, MooringFrame, MooringReadings]):
    """Draws `MooringFrame`s."""

    FIELD_OF_VIEW = 0.8  # [rad]
    WARM_UP: ClassVar[Pieces] = {"drawing": compile_tube, "packing": compile_packing}
    BUTTONS: ClassVar = {TENSIONS: {"Restart the statistics": RestartStatistics()}}

    def __init__(self, server: viser.ViserServer, post: PostCommand) -> None:
        self.server, self.post = server, post
        self.built: Shape = ()
        self.nodes: list[Any] = []
        self.tubes: list[ColouredMesh] = []
        scene = server.scene
        scene.configure_environment_map("studio", background=False, environment_intensity=0.4)
        scene.configure_default_lights(enabled=True, cast_shadow=False)
        self.grab = GrabLine(server)
        self.gizmos = {
            name: Gizmo(server, post, name, 1.0, position=(0.0, 0.0, 0.0), visible=False)
            for i in range(1, MAX_LINES + 1)
            for name in (f"anchor {i}", f"fairlead {i}")
        }

    def first_view(self, params: MooringParams) -> tuple[Vector, Vector]:
        """Position and target [m] of a camera that has not been moved: beside the surface, which it sees edge on."""
        far = extent(params)
        return (0.35 * far, -2.2 * far, 0.42 * far), (0.0, 0.0, -0.4 * depth_of(params))

    def build(self, frame: MooringFrame) -> None:
        """Make everything for another arrangement."""
        for node in self.nodes:
            node.remove()
        p, scene = frame.params, self.server.scene
        depth = depth_of(p)
        far, (lines, n, _) = extent(p), frame.points.shape
        set_clipping(self.server, 0.002 * far, FAR_VIEW * far)
        cell = cell_of(far)
        self.bed = scene.add_grid(
            "/bed", width=frame.side, height=frame.side, cell_size=cell, section_size=5 * cell,
            position=(0.0, 0.0, -depth + GRID_ABOVE * far), fade_distance=GRID_SIDE * frame.side,
            fade_from="origin", shadow_opacity=0.0,
            cell_color=CELL_COLOUR, section_color=SECTION_COLOUR,
        )  # fmt: skip
        self.samples = max(1, RING_COUNT // (n - 1))
        rings = (n - 1) * self.samples + 1
        self.radius = LINE_SIZE * far
        self.line = np.zeros((rings, 3))
        self.vertices, self.rgb = np.zeros((2, rings * SIDES + 2, 3), np.float32)
        faces = tube_faces(rings, SIDES)
        self.tubes = []
        for i in range(lines):
            self.shape_tube(frame, i)
            self.tubes.append(
                ColouredMesh(
                    self.server, f"/line_{i + 1}", self.vertices, faces, self.rgb, columns=SIDES, step=TUBE_STEP,
                    side="double",
                )
            )  # fmt: skip
        hull = hull_of(p)
        width, low, high = width_of(p), *(float(edge) for edge in hull.extents[2])
        is_round = bool(p.moordyn_file) or p.body == "buoy"
        line = min(max(-frame.rest[2], low + 2 * STRIPE * width), high - 2 * STRIPE * width)  # as it floats
        edges = [low, line, line + STRIPE * width, high, *(high + width * np.cumsum([part for _, part, _ in ON_DECK]))]
        self.slices = np.array(edges[:-1]) + 0.5 * np.diff(edges)  # heights [m] of their middles over the body's centre
        wide = [part for part, *_ in (*PAINTS, *ON_DECK)]
        self.outline = (0.0, 0.0, 0.5 * width) if is_round else (*hull.extents[:2, 1], 0.0)
        place = self.body_place(frame)
        self.body = scene.add_batched_meshes_simple(
            "/body", (hull.vertices / (1.0, 1.0, high - low)).astype(np.float32), hull.faces.astype(np.uint32),
            flat_shading=not is_round, lod="off", **place,
            batched_scales=np.column_stack([wide, wide, np.diff(edges)]).astype(np.float32),
            batched_colors=np.array([linear(colour) for *_, colour in (*PAINTS, *ON_DECK)], np.uint8),
        )  # fmt: skip
        self.body.visible = has_body(p)
        self.body.on_drag("left")(self.on_body)
        self.anchors = self.balls("/anchors", frame.anchors, ANCHOR_SIZE * far, ANCHOR_COLOUR)
        self.fairleads = self.balls("/fairleads", frame.fairleads, FAIRLEAD_SIZE * far, FAIRLEAD_COLOUR)
        self.shadows = self.strokes("/shadows", lines * (n - 1), SHADOW_COLOUR, 2.0)
        # On the water, and once more on the bed, where the body hides nothing.
        self.watch = [
            (part, self.strokes(f"/watch/{part}_{i}", 1, colour, width), height)
            for i, height in enumerate((0.0, -depth + self.radius))
            for part, colour, width in (("circle", WATCH_COLOUR, 3.5), ("path", PATH_COLOUR, 2.0))
        ]
        self.labels = [
            scene.add_label(f"/number_{i + 1}", str(i + 1), position=tuple(place), anchor="bottom-center")
            for i, place in enumerate((frame.points[:, 0] + (0.0, 0.0, 2 * ANCHOR_SIZE * far)).tolist())
        ]
        behind = -0.35 * far, 0.65 * far, -depth  # as first seen
        self.labels.append(scene.add_label("/depth", f"{depth:g} m deep", position=behind, anchor="bottom-center"))
        rows = len(frame.surface)
        self.places = 0.5 * frame.side * square_points(rows)
        vertices = self.surface_of(frame)
        self.water = ColouredMesh(
            self.server, "/water", vertices, square_faces(rows), np.zeros_like(vertices), columns=rows, step=WATER_STEP,
            color=WATER_COLOUR, opacity=WATER_OPACITY, side="double", cast_shadow=False, receive_shadow=False,
        )  # fmt: skip
        self.sand, self.around = self.add_sand(frame), None
        if injector_of(self.server) is not None:
            webs = np.array([[1.0, min(WEB_SIZE * depth, MAX_WEB_SIZE), 0.0]])  # as `js/underwater.js` reads it
            add_data_mesh(self.server, f"{self.sand.name}/underwater", webs)
            self.around = add_data_mesh(self.server, f"{self.water.name}/open_water", self.open_water(frame))
        self.nodes = [
            self.bed, *self.tubes, self.body, self.anchors, self.fairleads, self.shadows,
            *(handle for _, handle, _ in self.watch), *self.labels, self.water, self.sand,
        ]  # fmt: skip
        self.built = self.shape_of(frame)
        self.lifted = np.zeros(len(frame.anchors), bool)

    def add_sand(self, frame: MooringFrame) -> ColouredMesh:
        """The bed: mottled sand, which is lost in the water with the distance from the middle."""
        places = 0.5 * frame.side * square_points(BED_ROWS)
        depth = depth_of(frame.params)
        return ColouredMesh(
            self.server, "/sand", np.column_stack([places, np.full(len(places), -depth)]), square_faces(BED_ROWS),
            bed_colours(depth), columns=BED_ROWS, step=BED_STEP, color=DEEP_BED, side="double",
            cast_shadow=False, receive_shadow=False,
        )  # fmt: skip

    @staticmethod
    def shape_of(frame: MooringFrame) -> Shape:
        """The inputs of a drawing: all that `build` reads, except for those that `show` assigns."""
        p = frame.params
        return frame.points.shape, p.moordyn_file, p.reach, p.depth, p.body, p.size, frame.surface.shape, frame.rest[2]

    def balls(self, name: str, places: NDArray[np.float32], radius: float, colour: tuple[int, int, int]) -> Any:
        """A ball at each place (n, 3) [m]."""
        vertices, faces = ball(6)
        n = len(places)
        return self.server.scene.add_batched_meshes_simple(
            name, (radius * vertices).astype(np.float32), faces, lod="off",
            batched_wxyzs=np.tile(np.array([1.0, 0.0, 0.0, 0.0], np.float32), (n, 1)), batched_positions=places,
            batched_colors=np.tile(np.array(linear(colour), np.uint8), (n, 1)),
        )  # fmt: skip

    def strokes(self, name: str, count: int, colour: tuple[int, int, int], thickness: float) -> Any:
        """So many pieces of a line."""
        return self.server.scene.add_line_segments(
            name, np.zeros((count, 2, 3), np.float32), colors=colour, thickness=thickness, thickness_units="screen"
        )

    async def on_body(self, event: Any) -> None:
        """Grab the body, and pull it."""
        drag(self.post, event, 0)

    def surface_of(self, frame: MooringFrame) -> NDArray[np.float32]:
        """Vertices (m m, 3) [m] of the water."""
        return np.column_stack([self.places, frame.surface.ravel()]).astype(np.float32)

    def body_place(self, frame: MooringFrame) -> dict[str, Any]:
        """Places and rotations of the slices of the body."""
        places = frame.body + self.slices[:, None] * rotation_matrix(frame.rotation)[:, 2]
        turns = np.tile(frame.rotation, (len(places), 1))
        return {"batched_positions": places.astype(np.float32), "batched_wxyzs": turns}

    def open_water(self, frame: MooringFrame) -> NDArray[np.float64]:
        """Rows for `js/open_water.js`: the water (3,) [m], and the body seen from above (2, 3)."""
        place = (*frame.body[:2].tolist(), heading_angle(frame.rotation))
        return np.array([(0.5 * frame.side, depth_of(frame.params), extent(frame.params)), place, self.outline])

    def shape_tube(self, frame: MooringFrame, i: int) -> None:
        """Compute the tube of line i: vertices, and colours by the tension, or brown where it lies on the bed."""
        bed = -depth_of(frame.params)
        smooth_line(frame.points[i], self.samples, self.line)
        lies = self.line[:, 2] <= bed + diameter_of(frame.params)
        # A line is drawn thicker than it is: what lies is drawn on the bed, not half in it.
        self.line[:, 2] = np.maximum(self.line[:, 2], bed + self.radius)
        sweep(self.line, self.radius, SIDES, self.vertices)
        set_tube_colours(frame.tension[i], self.samples, frame.full_scale, SCALE, SIDES, self.rgb)
        brown = np.array(LYING_COLOUR, np.float32) / 255
        self.rgb[:-2].reshape(-1, SIDES, 3)[lies] = brown
        self.rgb[-2:][lies[[0, -1]]] = brown

    def show(self, frame: MooringFrame) -> None:
        """Assign a new frame to the handles; call it where a picture is handed over as one."""
        if self.shape_of(frame) != self.built:
            self.build(frame)
        p = frame.params
        for i, tube in enumerate(self.tubes):
            self.shape_tube(frame, i)
            tube.set(self.vertices, self.rgb)
        set_arrays(self.body, **self.body_place(frame))
        set_arrays(self.anchors, batched_positions=frame.anchors)
        set_arrays(self.fairleads, batched_positions=frame.fairleads)
        if (frame.uplift != self.lifted).any():
            self.lifted = frame.uplift
            self.anchors.batched_colors = np.array(
                [linear(LIFTED_COLOUR if one else ANCHOR_COLOUR) for one in self.lifted], np.uint8
            )
        shadows = frame.points.copy()
        shadows[:, :, 2] = -depth_of(p) + 0.3 * self.radius
        set_arrays(self.shadows, points=np.stack([shadows[:, :-1], shadows[:, 1:]], axis=2).reshape(-1, 2, 3))
        if self.water.mesh.visible != p.surface:
            self.water.mesh.visible = p.surface
        if p.surface:
            self.water.set(self.surface_of(frame))
        if self.around is not None:
            set_arrays(self.around, vertices=self.open_water(frame))
        thickness = 1.0 if p.grid else 0.0
        if self.bed.cell_thickness != thickness:
            self.bed.cell_thickness = self.bed.section_thickness = thickness
        self.show_watch(frame)
        self.show_handles(frame)
        self.grab.show(None if frame.grab is None else (tuple(frame.body.tolist()), frame.grab))

    def show_watch(self, frame: MooringFrame) -> None:
        """The watch circle, and the path of the body."""
        for _, handle, _ in self.watch:
            if handle.visible != frame.params.watch:
                handle.visible = frame.params.watch
        if not frame.params.watch:
            return
        turn = 2 * np.pi * np.arange(CIRCLE_POINTS + 1) / CIRCLE_POINTS
        ring = np.array(frame.rest[:2]) + frame.offset * np.column_stack([np.cos(turn), np.sin(turn)])
        lines = {"circle": ring, "path": frame.path[-MAX_DRAWN_PATH:]}
        for part, handle, height in self.watch:
            line = lines[part]
            if len(line) > 1:
                level = np.column_stack([line, np.full(len(line), height)]).astype(np.float32)
                set_arrays(handle, points=np.stack([level[:-1], level[1:]], axis=1))

    def show_handles(self, frame: MooringFrame) -> None:
        """The arrows of anchors and fairleads."""
        p, far = frame.params, extent(frame.params)
        for i in range(MAX_LINES):
            is_shown = p.handles and not p.moordyn_file and i < len(frame.points)
            for kind, node, scale in (("anchor", 0, ARROW_SIZE), ("fairlead", -1, SMALL_ARROW_SIZE)):
                gizmo = self.gizmos[f"{kind} {i + 1}"]
                if is_shown and gizmo.handle.scale != scale * far:
                    gizmo.handle.scale = scale * far
                x, y, z = frame.points[i, node].tolist() if is_shown else (0.0, 0.0, 0.0)
                gizmo.show((x, y, z) if is_shown else None)
            if i < len(frame.points):
                x, y, z = frame.points[i, 0].tolist()
                place = x, y, z + 2 * ANCHOR_SIZE * far
                if tuple(self.labels[i].position) != place:
                    self.labels[i].position = place

    def figures(self, snapshot: MooringSnapshot) -> str:
        """The largest tension."""
        return figures_of(snapshot)

    def readout(self, snapshot: MooringSnapshot) -> str:
        """The key of the colours."""
        has_colours = not self.tubes or self.tubes[0].has_shader is not False
        return readout_of(snapshot) if has_colours else simple_drawing("tension")

    def marks(self, snapshot: MooringSnapshot) -> dict[str, str]:
        """Parameter -> the line under its control."""
        return marks_of(snapshot)

    def notes(self, snapshot: MooringSnapshot) -> dict[str, str]:
        """Heading -> HTML of the folders below the controls."""
        return notes_of(snapshot)


VIEW = MooringView
