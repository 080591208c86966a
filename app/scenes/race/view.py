"""The race as drawn: a tube for each rope in its own colour, the reference runs translucent, a label on each root."""

import math
from typing import ClassVar, TypeAlias

import numpy as np
import viser

from app.messages import Snapshot, Vector
from app.render.colormap import lifted, rgb
from app.render.gizmo import Gizmo
from app.render.injection import add_contact_shadow, injector_of
from app.render.meshes import ball, smooth_line, sweep, tube_faces
from app.render.viser_inside import set_arrays, update_node
from app.scenes.charts import PALETTE
from app.scenes.contract import Pieces, PostCommand
from app.scenes.race.entrants import RaceReadings
from app.scenes.race.html import errors_line, results_table
from app.scenes.race.parameters import RaceParams
from app.scenes.race.scene import RaceFrame
from app.scenes.springs.html import step_mark
from app.scenes.springs.net_motion import rope_lengths
from app.scenes.springs.rope_parameters import ROOT, ROPE_RADIUS, build_rope
from app.scenes.springs.view import ROOT_ARROW_LENGTH, SpringView

RING_COUNT = 90  # rings of a drawn tube, about
SIDES = 8  # of a drawn tube
TUBE_RADIUS = 0.75 * ROPE_RADIUS  # [m]
REFERENCE_RADIUS = 0.9 * TUBE_RADIUS  # [m], so that a rope without error hides its reference run
REFERENCE_COLOUR = (70, 76, 88)
REFERENCE_OPACITY = 0.4
COLOUR_SCALE = 0.6  # of a colour's numbers, so that a rope lit from all sides has the colour it has in the charts
DARK_LIFT = 0.15  # share of white that a black rope would get on a dark floor, where dark blue would hardly be seen
FAILED_OPACITY = 0.35  # of a rope that has stopped
LABEL_SCALE = 1.1  # of a label, over viser's own size: letters of 13 pixels
LABEL_SHARE = 0.075  # height of a row of labels, over that of the first view: those of 200 pixels can still be read
FIRST_LABEL, LABEL_AIR = 0.4, 1.3  # rows from a root to the lowest label, and from the highest to the picture's edge

BEARING = math.cos(0.22), math.sin(0.22)  # of the first view: from the front, and as far aside as tells ropes apart
ELEVATION = 0.05  # [rad] of the first view
NEAR = 1.0  # [m] from the camera, where the picture begins: nearer, and depth is too coarse for ropes that far away
SHOWN_SWING = 1.0  # share of the length of a rope to either side that the first view shows: where it starts, level
PULL_OF_FALL = 3.0  # of a rope that falls and swings, over its weight: stretches it by as much as the first view shows
MAX_STRETCH = 3.0  # [m] that the first view shows
BELOW_FLOOR = 0.15  # [m] below a floor that the first view shows: a rope sinks into it, and has a radius
SHOWN_ASPECT = 1.25  # width over height of what the first view shows at least (`js/camera.js`)

RaceSnapshot: TypeAlias = Snapshot[RaceParams, RaceFrame, RaceReadings]


def material_colour(index: int, *, dark: bool = False) -> tuple[int, int, int]:
    """The colour of a rope's material; dark: on a dark floor."""
    colour = np.array([rgb(PALETTE[index])], float)
    red, green, blue = np.rint(lifted(colour, DARK_LIFT) if dark else COLOUR_SCALE * colour)[0].astype(int).tolist()
    return red, green, blue


def linear_colour(colour: tuple[int, int, int]) -> np.ndarray:
    """An sRGB colour in linear numbers, 0 to 255: viser takes the colours of instances and of lines as such."""
    return 255.0 * (np.array(colour) / 255.0) ** 2.2


def label_heights(count: int) -> np.ndarray:
    """Heights (count,) of the labels over the roots, in rows: the first half goes to the left, outer ones are lower."""
    left = np.arange(count)
    return FIRST_LABEL + np.minimum(left, left[::-1])


def label_rows(count: int) -> float:
    """Rows from the roots to the upper edge of the first view."""
    return float(label_heights(count).max()) + LABEL_AIR


def shown_height(params: RaceParams) -> float:
    """Height [m] of the first view: of all ropes, as far as they swing, and of their labels."""
    depth = (params.ropes - 1) * params.spacing
    across = BEARING[0] * 2.0 * params.length * SHOWN_SWING + BEARING[1] * depth
    length, stretch = rope_lengths(build_rope(params, ROOT))  # of rope 1, the softest
    fall = length + min(PULL_OF_FALL * stretch, MAX_STRETCH)
    if params.floor:
        fall = min(fall, ROOT[2] + BELOW_FLOOR)
    fall += 0.5 * depth * ELEVATION  # the nearest rope is drawn lower
    return max(fall / (1.0 - LABEL_SHARE * label_rows(params.ropes)), across / SHOWN_ASPECT)


def bead_colours(count: int, points: int, *, dark: bool = False) -> np.ndarray:
    """The colours (count points, 3) of the beads of all ropes."""
    ropes = [linear_colour(material_colour(i, dark=dark)) for i in range(count)]
    return np.repeat(ropes, points, axis=0).astype(np.uint8)


def tube_vertices(points: np.ndarray, samples: int, radius: float) -> np.ndarray:
    """Vertices (rings SIDES + 2, 3) of a tube of `radius` [m] along points (n, 3) [m], with `samples` rings a link."""
    rings = (len(points) - 1) * samples + 1
    line, vertices = np.zeros((rings, 3)), np.zeros((rings * SIDES + 2, 3), np.float32)
    smooth_line(points, samples, line)
    sweep(line, radius, SIDES, vertices)
    return vertices


class RopesDrawing:
    """The handles of all ropes, made for their number and their points, then assigned to."""

    def __init__(self, server: viser.ViserServer, frame: RaceFrame, row: float) -> None:
        """row: height [m] of a row of labels."""
        count, n, _ = self.shape = frame.ropes.shape
        self.samples = max(1, RING_COUNT // (n - 1))
        faces = tube_faces((n - 1) * self.samples + 1, SIDES)
        scene = server.scene
        tubes = self.tube_meshes(frame.ropes, TUBE_RADIUS)
        self.tubes = [
            scene.add_mesh_simple(f"/race/rope_{i + 1}", tube, faces, color=material_colour(i), side="double")
            for i, tube in enumerate(tubes)
        ]
        for tube in self.tubes:
            add_contact_shadow(server, tube.name)
        each = len(tubes[0])
        self.references = scene.add_mesh_simple(
            "/race/references",
            np.zeros((count * each, 3), np.float32),
            np.concatenate([faces + i * each for i in range(count)]).astype(np.uint32),
            color=REFERENCE_COLOUR,
            opacity=REFERENCE_OPACITY,
            cast_shadow=False,
            visible=False,
        )
        points = frame.ropes.reshape(-1, 3)
        bead_radius = min(1.5 * ROPE_RADIUS, 0.3 / n + 0.8 * ROPE_RADIUS)
        self.beads = scene.add_batched_meshes_simple(
            "/race/points",
            *ball(6),
            batched_wxyzs=np.tile([1.0, 0.0, 0.0, 0.0], (len(points), 1)),
            batched_positions=points,
            batched_scales=np.full(len(points), bead_radius, np.float32),
            batched_colors=bead_colours(count, n),
            lod="off",
        )
        self.poles = scene.add_line_segments(
            "/race/poles",
            self.label_poles(frame, row),
            colors=np.repeat([[linear_colour(rgb(colour))] for colour in PALETTE[:count]], 2, axis=1).astype(np.uint8),
            thickness=2.0,
            thickness_units="screen",
        )
        self.labels = [
            scene.add_label(
                f"/race/label_{i + 1}",
                text,
                font_screen_scale=LABEL_SCALE,
                anchor="bottom-right" if i < count // 2 else "bottom-left",
            )
            for i, text in enumerate(frame.labels)
        ]
        self.shown_poles: np.ndarray | None = None
        self.shown_failed = (False,) * count

    def tube_meshes(self, ropes: np.ndarray, radius: float) -> list[np.ndarray]:
        """The vertices of each rope of (ropes, points, 3) [m]."""
        return [tube_vertices(points, self.samples, radius) for points in ropes]

    def label_poles(self, frame: RaceFrame, row: float) -> np.ndarray:
        """(ropes, 2, 3): from each root up to its label [m]. row: height [m] of a row of labels."""
        poles = np.repeat(frame.ropes[:, :1], 2, axis=1)
        poles[:, 1, 2] += row * label_heights(len(poles))
        return poles

    def show(self, frame: RaceFrame, row: float) -> None:
        """Assign a new frame; call it where a picture is handed over as one. row: height [m] of a row of labels."""
        for i, tube in enumerate(self.tubes):
            if frame.failed[i] and self.shown_failed[i]:
                continue  # it has stopped where it is drawn
            set_arrays(tube, vertices=tube_vertices(frame.ropes[i], self.samples, TUBE_RADIUS))
            if frame.failed[i] != self.shown_failed[i]:
                tube.opacity = FAILED_OPACITY if frame.failed[i] else None
        self.shown_failed = frame.failed
        self.references.visible = frame.references is not None
        if frame.references is not None:
            set_arrays(self.references, vertices=np.concatenate(self.tube_meshes(frame.references, REFERENCE_RADIUS)))
        self.beads.visible = frame.params.show_points
        if frame.params.show_points:
            set_arrays(self.beads, batched_positions=frame.ropes.reshape(-1, 3))
        poles = self.label_poles(frame, row)
        if self.shown_poles is None or not np.array_equal(self.shown_poles, poles):
            self.shown_poles = self.poles.points = poles
            for label, pole in zip(self.labels, poles, strict=True):
                label.position = tuple(pole[1])
        for label, text in zip(self.labels, frame.labels, strict=True):
            if label.text != text:
                label.text = text

    def set_dark(self, client: viser.ClientHandle, dark: bool) -> None:
        """Draw ropes and beads as on a dark floor, or light again, for one browser. The nodes stay the server's."""
        count, n, _ = self.shape
        for i, tube in enumerate(self.tubes):
            update_node(client, tube.name, color=material_colour(i, dark=dark))
        update_node(client, self.beads.name, batched_colors=bead_colours(count, n, dark=dark))

    def remove(self) -> None:
        """Take everything out of the scene."""
        for handle in (*self.tubes, *self.labels, self.references, self.beads, self.poles):
            handle.remove()


class RaceView(SpringView[RaceParams, RaceFrame, RaceReadings]):
    """Draws `RaceFrame`s."""

    FIELD_OF_VIEW = 0.06  # [rad], from so far away that all ropes look equally large
    WARM_UP: ClassVar[Pieces] = {"drawing": lambda: tube_vertices(np.zeros((2, 3), np.float32), 2, TUBE_RADIUS)}

    def __init__(self, server: viser.ViserServer, post: PostCommand) -> None:
        super().__init__(server, post, NEAR)
        self.root = Gizmo(server, post, "root", ROOT_ARROW_LENGTH, position=ROOT)
        injector_of(server)  # its script draws labels dark where a browser asks for it (`js/dark.js`)
        self.ropes: RopesDrawing | None = None
        self.params: RaceParams | None = None  # that the height of a row of labels [m] is of
        self.label_row = 0.0
        self.dark: set[int] = set()  # browsers that draw on a dark floor

    def first_view(self, params: RaceParams) -> tuple[Vector, Vector]:
        """Position and target [m] of a camera that has not been moved: all ropes, as far as they swing, and labels."""
        depth, height = (params.ropes - 1) * params.spacing, shown_height(params)
        distance = 0.5 * height / math.tan(0.5 * self.FIELD_OF_VIEW) + 0.5 * BEARING[0] * depth
        above = LABEL_SHARE * height * label_rows(params.ropes)
        x, y, z = target = 0.0, 0.0, ROOT[2] + above - 0.5 * height
        flat = distance * math.cos(ELEVATION)
        return (x + BEARING[1] * flat, y - BEARING[0] * flat, z + distance * math.sin(ELEVATION)), target

    def show(self, frame: RaceFrame) -> None:
        """Assign a new frame to the handles; call it where a picture is handed over as one."""
        self.points = frame.ropes.reshape(-1, 3)
        if frame.params is not self.params:
            self.params, self.label_row = frame.params, LABEL_SHARE * shown_height(frame.params)
        if self.ropes is not None and self.ropes.shape != frame.ropes.shape:
            self.ropes.remove()
            self.ropes = None
        if self.ropes is None:
            self.ropes = RopesDrawing(self.server, frame, self.label_row)
            self.ropes.beads.on_drag("left")(self.on_bead)  # beads are numbered through, rope after rope
            for tube in self.ropes.tubes:
                tube.on_drag("left")(self.on_surface)
            for number, client in self.server.get_clients().items():
                if number in self.dark:
                    self.ropes.set_dark(client, True)
        self.ropes.show(frame, self.label_row)
        p = frame.params
        self.root.show(frame.root if p.handles else None)
        self.show_surroundings(p.floor, p.grid, frame.grab)

    def figures(self, snapshot: RaceSnapshot) -> str:
        """The ropes that are nearest to the reference and farthest from it."""
        return errors_line(snapshot.readings)

    def marks(self, snapshot: RaceSnapshot) -> dict[str, str]:
        """Parameter -> the line under its control: the largest step of rope 1 that is stable."""
        step = snapshot.readings.results[0].gauge.critical_step
        return {"time_step": step_mark(step)}

    def notes(self, snapshot: RaceSnapshot) -> dict[str, str]:
        """The table of results."""
        return {"Results": results_table(snapshot.readings)}

    def set_dark(self, client: viser.ClientHandle, dark: bool) -> None:
        """Draw sky, floor and ropes dark, or light again, for one browser."""
        super().set_dark(client, dark)
        (self.dark.add if dark else self.dark.discard)(client.client_id)
        if self.ropes is not None:
            self.ropes.set_dark(client, dark)


VIEW = RaceView
